"""Put results of `radhar tradeoff` into docs/results/tradeoff.md and a page of their tables.

    python scripts/document_tradeoff.py OUT [OUT ...]

Each OUT is a folder that the command wrote. Its recommendation and figure go into the first page,
its tables into the second, between the markers `<!-- begin NAME -->` and `<!-- end NAME -->`, NAME
being that of the config; the figure itself goes into docs/images. Parts of which no folder is named
stay.
"""

import argparse
import re
import shutil
from pathlib import Path

from radhar_cli.tradeoff.report import FIGURE, SETTINGS, TEXT

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE, TABLES = DOCS / "results/tradeoff.md", DOCS / "records/tradeoff_tables.md"
IMAGES = DOCS / "images/tradeoff"


def part(out: Path) -> tuple[str, str, str]:
    """Name of a result, what it recommends with the figure of the documents, and its tables."""
    text = (out / TEXT).read_text().replace(str(out.parent), "out")
    said, _, tables = text.partition(SETTINGS)
    title, _, said = said.partition("\n")
    name = title.rpartition(": ")[2]
    said = said.replace(f"({FIGURE})", f"(../images/tradeoff/{name}.png)")
    tables = re.sub(r"^###", "####", tables, flags=re.MULTILINE)
    return name, f"## {name}\n{said}", f"## {name}\n{tables}"


def with_part(page: str, name: str, text: str) -> str:
    """Page in which the part of a name has a text.

    Raises:
        ValueError: the page has no markers for it.
    """
    begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
    head, opened, rest = page.partition(begin)
    _, closed, tail = rest.partition(end)
    if not opened or not closed:
        raise ValueError(f"has no markers for {name}")
    return f"{head}{begin}\n\n{text.strip()}\n\n{end}{tail}"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("out", type=Path, nargs="+")
    pages = {path: path.read_text() for path in (PAGE, TABLES)}
    for out in parser.parse_args().out:
        name, *texts = part(out)
        for path, text in zip(pages, texts, strict=True):
            try:
                pages[path] = with_part(pages[path], name, text)
            except ValueError as error:
                parser.error(f"{path}: {error}")
        shutil.copyfile(out / FIGURE, IMAGES / f"{name}.png")
    for path, text in pages.items():
        path.write_text(text)


if __name__ == "__main__":
    main()
