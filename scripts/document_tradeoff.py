"""Put the results of `radhar tradeoff` into docs/results/tradeoff.md, between its markers.

    python scripts/document_tradeoff.py OUT [OUT ...]

Each OUT is a folder that the command wrote; its part of the page is the one between the markers
`<!-- begin NAME -->` and `<!-- end NAME -->`, NAME being the title of its tradeoff.md.
"""

import argparse
import re
from pathlib import Path

from radhar_cli.tradeoff.report import TEXT

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE = DOCS / "results/tradeoff.md"


def part(out: Path) -> tuple[str, str]:
    """Name of a result, and its text one heading lower."""
    text = (out / TEXT).read_text()
    heading = text.partition("\n")[0]
    name = heading.rpartition(": ")[2]
    return name, re.sub(r"^#", "##", text, flags=re.MULTILINE)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("out", type=Path, nargs="+")
    page = PAGE.read_text()
    for out in parser.parse_args().out:
        name, text = part(out)
        begin, end = f"<!-- begin {name} -->", f"<!-- end {name} -->"
        head, _, rest = page.partition(begin)
        _, found, tail = rest.partition(end)
        if not found:
            parser.error(f"{PAGE}: has no markers for {name}")
        page = f"{head}{begin}\n\n{text}\n{end}{tail}"
    PAGE.write_text(page)


if __name__ == "__main__":
    main()
