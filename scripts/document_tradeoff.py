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

from page_parts import replace_part

from radhar_cli.study.tradeoff.report import FIGURE, SETTINGS, TEXT

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE, TABLES = DOCS / "results/tradeoff.md", DOCS / "records/tradeoff_tables.md"
IMAGES = DOCS / "images/tradeoff"


def read_result(out: Path) -> tuple[str, str, str]:
    """Read a result: its name, its recommendation with the figure of the documents, its tables."""
    text = (out / TEXT).read_text().replace(str(out.parent), "out")
    recommendation, _, tables = text.partition(f"## {SETTINGS}")
    title, _, recommendation = recommendation.partition("\n")
    name = title.rpartition(": ")[2]
    figure = f"(../images/tradeoff/{name}.png)"
    recommendation = recommendation.replace(f"({FIGURE})", figure)
    tables = re.sub(r"^###", "####", tables, flags=re.MULTILINE)
    return name, f"## {name}\n{recommendation}", f"## {name}\n{tables}"


def main() -> None:
    """Write the parts of both pages, and the figures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("out", type=Path, nargs="+")
    pages = {path: path.read_text() for path in (PAGE, TABLES)}
    for out in parser.parse_args().out:
        name, *texts = read_result(out)
        for path, text in zip(pages, texts, strict=True):
            try:
                pages[path] = replace_part(pages[path], name, f"\n{text.strip()}\n")
            except ValueError as error:
                parser.error(f"{path}: {error}")
        shutil.copyfile(out / FIGURE, IMAGES / f"{name}.png")
    for path, text in pages.items():
        path.write_text(text)


if __name__ == "__main__":
    main()
