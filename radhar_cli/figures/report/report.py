"""A report: numbers for programs, pages for people, tables and figures as files of their own."""

import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeAlias

from radhar_cli.errors import FolderError
from radhar_cli.figures.report.pages import html_page, markdown_page
from radhar_cli.figures.report.parts import (
    Part,
    ReportFigure,
    ReportSection,
    ReportTable,
    Sentences,
)
from radhar_cli.files.plain_json import plain
from radhar_cli.files.replacing import write_result
from radhar_cli.files.table_text import csv_text
from radhar_cli.files.untrusted import read_json

Format: TypeAlias = Literal["md", "html"]
NUMBERS = "report.json"  # of reports that are called by no name of their own


@dataclass
class Report:
    """Numbers of a report, and its sentences, tables and figures in the order of the pages.

    Attributes:
        numbers: numbers for programs.
        title: title of the pages.
        about: line below the title.
        stem: name of the numbers and of the pages, without a suffix.
        formats: pages that are written.
        lists_files: whether the numbers list the files of figures and tables, by which the next
            report in the folder removes those that it lacks.
        sections: parts of the pages; the first has no heading.
    """

    numbers: dict[str, Any]
    title: str = ""
    about: str = ""
    stem: str = "report"
    formats: tuple[Format, ...] = ()
    lists_files: bool = False
    sections: list[ReportSection] = field(default_factory=lambda: [ReportSection("")])

    def section(self, title: str) -> None:
        """Begin a part of the pages, below whose heading the next parts are added."""
        self.sections.append(ReportSection(title))

    def line(self, text: str) -> None:
        """Add a sentence to those at the top of the pages."""
        self.sections[0].parts.append(Sentences([text]))

    def add(self, *parts: Part) -> None:
        """Add parts to the last section."""
        self.sections[-1].parts.extend(parts)

    @property
    def lines(self) -> list[str]:
        """Sentences at the top of the pages."""
        parts = self.sections[0].parts
        return [text for part in parts if isinstance(part, Sentences) for text in part.texts]

    @property
    def figures(self) -> list[ReportFigure]:
        """Figures in the order of the pages."""
        return [part for part in self._parts() if isinstance(part, ReportFigure)]

    def _parts(self) -> Iterator[Part]:
        return (part for section in self.sections for part in section.parts)

    def write(self, folder: Path) -> list[Path]:
        """Write figures, tables and pages, and the numbers last; return all paths.

        Raises:
            FolderError: a file cannot be written.
        """
        files = dict[str, bytes]()
        for part in self._parts():
            if isinstance(part, ReportFigure):
                files[part.file] = part.png
            elif isinstance(part, ReportTable) and part.file:
                text = csv_text(part.header, part.rows)
                files[part.file] = text.encode("utf-8", "surrogateescape")
        numbers = folder / f"{self.stem}.json"
        values = self.numbers
        if self.lists_files:
            for name in listed_files(numbers) - set(files):
                (folder / name).unlink(missing_ok=True)
            values = {**values, "files": sorted(files)}
        files |= {f"{self.stem}.{form}": self._page(form) for form in self.formats}
        text = json.dumps(plain(values), indent=2) + "\n"
        for name, content in (*files.items(), (numbers.name, text.encode())):
            write_result(folder, folder / name, content)
        return [numbers, *(folder / name for name in files)]

    def _page(self, form: Format) -> bytes:
        """A page, for which sections without parts are left out."""
        sections = [section for section in self.sections if section.parts]
        if form == "md":
            return markdown_page(self.title, self.about, sections).encode()
        note = (
            f"The same numbers for programs: {self.stem}.json; each figure and table is a file "
            "beside this page."
        )
        page = html_page(self.title, self.about, sections, note)
        return page.encode("utf-8", "backslashreplace")


def listed_files(numbers: Path) -> set[str]:
    """Names of the figures and tables that the numbers of an earlier report list."""
    try:
        names = read_json(numbers)["files"]
        return {n for n in names if Path(n).name == n and Path(n).suffix in (".png", ".csv")}
    except (FolderError, KeyError, TypeError):
        return set()
