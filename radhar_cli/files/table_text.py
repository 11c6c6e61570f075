"""Tables as text: CSV for programs, Markdown for people."""

import csv
import io
from collections.abc import Iterable, Sequence


def csv_text(header: Sequence[object], rows: Iterable[Iterable[object]]) -> str:
    """Text of a table as CSV; cells are quoted where they need it."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue()


def markdown_table(header: Sequence[object], rows: Iterable[Iterable[object]]) -> str:
    """Text of a table as Markdown, in whose cells bars are escaped."""
    lines = [header, ["---"] * len(header), *rows]
    cells = ([str(cell).replace("|", "\\|") for cell in line] for line in lines)
    return "\n".join(f"| {' | '.join(line)} |" for line in cells)
