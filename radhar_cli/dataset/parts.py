"""Parts of a data set, built separately and merged by `radhar merge`.

Part K of N holds the rows from (K - 1) rows/N to K rows/N, rounded down, in a folder of its own:
lock, identity and shards are as in a build, so a part that was killed resumes.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from radhar_cli.dataset.layout import PARTS
from radhar_cli.errors import FolderError

_NAME = re.compile(r"([1-9]\d{0,8})-of-([1-9]\d{0,8})")
_TEXT = re.compile(r"([1-9]\d{0,8})/([1-9]\d{0,8})")


@dataclass(frozen=True, order=True)
class DataSetPart:
    """A part of a data set: number `number` of `of`, counted from 1."""

    of: int
    number: int

    @classmethod
    def parse(cls, text: str, where: str = "--shard") -> "DataSetPart":
        """Read a part from its text K/N.

        Args:
            where: option or file, for the message.

        Raises:
            FolderError: it is not K/N.
        """
        match = _TEXT.fullmatch(text)
        if match is None or int(match[1]) > int(match[2]):
            raise FolderError(f"{where} {text}: should be K/N with K from 1 to N, such as 3/8")
        return cls(int(match[2]), int(match[1]))

    def __str__(self) -> str:
        return f"{self.number}/{self.of}"

    def rows(self, count: int) -> range:
        """Range of the part's rows in a data set of `count`."""
        return range(count * (self.number - 1) // self.of, count * self.number // self.of)

    def folder(self, out: Path) -> Path:
        """Folder of the part below an output folder."""
        return out / PARTS / f"{self.number}-of-{self.of}"


def refuse_other_cuts(out: Path, part: DataSetPart) -> None:
    """Refuse a part where there are parts of another N: their rows would overlap."""
    place = out / PARTS
    names = (_NAME.fullmatch(path.name) for path in (place.iterdir() if place.is_dir() else ()))
    others = {int(name[2]) for name in names if name} - {part.of}
    if others:
        raise FolderError(
            f"{place}: holds parts of {min(others)}; this would be part {part}. To make one of "
            f"them again give --shard K/{min(others)}; for another N choose another folder"
        )


def rows_by_part(runs: Sequence[tuple[int, int]], of: int, count: int) -> list[DataSetPart]:
    """List the parts in which runs of rows lie.

    Args:
        runs: (first row, past-last row) of each.
        of: number of parts.
        count: number of rows of the data set.
    """
    parts = [(part, part.rows(count)) for part in (DataSetPart(of, n) for n in range(1, of + 1))]
    return [
        part
        for part, rows in parts
        if any(first < rows.stop and stop > rows.start for first, stop in runs)
    ]
