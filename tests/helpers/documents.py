"""What the documents say: fenced blocks, commands in the text, the defaults of their tables."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from textwrap import dedent
from typing import Any, NamedTuple, get_args

from pydantic import BaseModel

ROOT = Path(__file__).resolve().parents[2]
DOCS = sorted((ROOT / "docs").rglob("*.md"))
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *DOCS]


class Block(NamedTuple):
    """A fenced block: page and line of its fence, language, text."""

    page: str
    line: int
    language: str
    text: str

    def __str__(self) -> str:
        return f"{self.page}:{self.line}"


def blocks(page: Path) -> list[Block]:
    """The fenced blocks of a page, also those of a list's items."""
    text = page.read_text()
    return [
        Block(page.name, text[: one.start()].count("\n") + 1, one[2], dedent(one[3]))
        for one in re.finditer(r"^( *)```(\w*)\n(.*?)^\1```", text, re.MULTILINE | re.DOTALL)
    ]


def commands(page: Path) -> Iterator[list[str]]:
    """Words of every `radhar ...` and `python scripts/...` of a page, in blocks or in the text."""
    text = re.sub(r"^ *```.*?^ *```", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    lines = [" ".join(span.split()) for span in re.findall(r"`([^`]+)`", text)]
    for block in blocks(page):
        lines += block.text.replace("\\\n", " ").splitlines()
    for line in lines:
        found = re.search(r"(?:^|\s|['\"])((?:radhar|python scripts/\w+\.py)(?: .*)?$)", line)
        if found:
            yield re.split(r"\s#|[|;]", found[1])[0].split()


class Row(NamedTuple):
    """A row of a table of keys."""

    keys: list[str]
    default: str


def rows(page: Path) -> Iterator[Row]:
    """Rows of the tables that say `key | default | meaning`; a key takes the row's section."""
    inside = False
    for line in page.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split(" | ")]
        if cells[:2] == ["key", "default"]:
            inside = True
        elif not line.startswith("|"):
            inside = False
        elif inside and "`" in cells[0]:
            first, *more = re.findall(r"`([\w.]+)`", cells[0])
            section = first.rpartition(".")[0]
            whole = [key if "." in key or not section else f"{section}.{key}" for key in more]
            yield Row([first, *whole], cells[1] if len(cells) > 2 else "")


def value_at(section: BaseModel, key: str) -> Any:
    """The value of a dotted key; of a section that is null, what it would have by default."""
    found: Any = section
    for name in key.split("."):
        field = type(found).model_fields[name]
        found = getattr(found, name)
        if found is None and name != key.rpartition(".")[2]:
            kinds = [field.annotation, *get_args(field.annotation)]
            found = next(k for k in kinds if isinstance(k, type) and issubclass(k, BaseModel))()
    return found.model_dump() if isinstance(found, BaseModel) else found


def leaves(value: object, bounds: bool) -> set[object]:
    """What a value is made of, with or without the bounds at which a distribution is cut.

    Numbers are floats; null, true, false and nothing at all are texts as in YAML.
    """
    if isinstance(value, BaseModel):
        value = value.model_dump()
    if isinstance(value, dict):
        kept = [inner for key, inner in value.items() if bounds or key not in ("min", "max")]
        value = [inner for inner in kept if inner is not None]
    if isinstance(value, (list, tuple)):
        return set().union(*(leaves(inner, bounds) for inner in value)) or {"null"}
    if isinstance(value, (bool, type(None))):
        return {json.dumps(value)}
    return {float(value) if isinstance(value, (int, float)) else value}


def written(cell: str) -> set[object]:
    """The same of a cell: `+-20 %` is 0.2, S12 is no number, of words there are those of YAML."""
    plain = re.sub(r"\bS\d+", "", cell).replace("+-", " ")
    number = r"(?<![\w.])(-?\d[\d.]*(?:e-?\d+)?)( %)?"
    found = {float(n) / (100 if percent else 1) for n, percent in re.findall(number, plain)}
    words = plain.replace("none", "null").replace("{}", "null")
    return {*found, *re.findall(r"\b(?:null|true|false)\b", words)}
