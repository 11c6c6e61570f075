"""Put results of `radhar tradeoff` into docs/results/tradeoff.md, their figures into docs/images.

    python scripts/document_tradeoff.py OUT [OUT ...]

Each OUT is a folder that the command wrote; its part of the page is the one between the markers
`<!-- begin NAME -->` and `<!-- end NAME -->`, NAME being that of the config. Parts of which no
folder is named stay.
"""

import argparse
import re
import shutil
from pathlib import Path

from radhar_cli.tradeoff.report import FIGURE, TEXT

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE = DOCS / "results/tradeoff.md"
IMAGES = DOCS / "images/tradeoff"


def part(out: Path) -> tuple[str, str]:
    """Name of a result, and its text one heading lower, with the figure of the documents."""
    text = (out / TEXT).read_text().replace(str(out.parent), "out")
    name = text.partition("\n")[0].rpartition(": ")[2]
    text = text.replace(f"({FIGURE})", f"(../images/tradeoff/{name}.png)")
    return name, re.sub(r"^#", "##", text, flags=re.MULTILINE)


def with_part(page: str, name: str, text: str) -> str:
    """Page in which the part of a name has a text.

    Raises:
        ValueError: the page has no markers for it.
    """
    begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
    head, opened, rest = page.partition(begin)
    _, closed, tail = rest.partition(end)
    if not opened or not closed:
        raise ValueError(f"{PAGE}: has no markers for {name}")
    return f"{head}{begin}\n\n{text.strip()}\n\n{end}{tail}"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("out", type=Path, nargs="+")
    page = PAGE.read_text()
    for out in parser.parse_args().out:
        name, text = part(out)
        try:
            page = with_part(page, name, text)
        except ValueError as error:
            parser.error(str(error))
        shutil.copyfile(out / FIGURE, IMAGES / f"{name}.png")
    PAGE.write_text(page)


if __name__ == "__main__":
    main()
