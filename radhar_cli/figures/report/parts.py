"""Parts of a report: sentences, tables, figures, and texts that are folded away."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import NamedTuple, TypeAlias


class Sentences(NamedTuple):
    """Sentences below each other, as a list or as paragraphs; `words` in them are code."""

    texts: Sequence[str]
    is_list: bool = False


class ReportTable(NamedTuple):
    """Rows of cells under a header: a CSV file, a table of the pages, or both.

    Attributes:
        header: names of the columns.
        rows: cells, row by row.
        title: heading on the pages.
        file: name of the CSV file; "" leaves the table to the pages.
        is_shown: whether the pages have it; else only its file.
        about: sentence below the heading.
    """

    header: Sequence[object]
    rows: Sequence[Sequence[object]]
    title: str = ""
    file: str = ""
    is_shown: bool = True
    about: str = ""


class ReportFigure(NamedTuple):
    """A figure: name of its file, caption, and content of the PNG."""

    file: str
    caption: str
    png: bytes


class Details(NamedTuple):
    """A text that a page folds away until a reader opens it."""

    title: str
    text: str


Part: TypeAlias = Sentences | ReportTable | ReportFigure | Details


@dataclass
class ReportSection:
    """Parts of a report under a heading, in their order."""

    title: str
    parts: list[Part] = field(default_factory=list)


def number_text(value: object, digits: int = 4) -> str:
    """Text of a cell: a number as a person reads it, with narrow spaces; nothing for None.

    Args:
        digits: significant digits of a number that is not whole.
    """
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return "" if value is None else str(value)
    if isfinite(value) and value == int(value):
        return f"{int(value):,}".replace(",", "\u202f")
    return f"{value:.{digits}g}"
