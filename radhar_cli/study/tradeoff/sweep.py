"""What a sweep has measured so far: rows, floors of images, and how far the machine blurred it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import nan
from typing import Any, NamedTuple

from pydantic import TypeAdapter

from radhar_cli.study.tradeoff.row import Row
from radhar_cli.study.tradeoff.timing import Ratio

LEAST_BLUR = 0.01  # of processor time, whatever pairs say


class Omission(NamedTuple):
    """A setting without a row, and why."""

    name: str
    reason: str


@dataclass
class Sweep:
    """Results of a sweep, which grow."""

    # rows in the order of measuring, the config as it is first
    rows: list[Row] = field(default_factory=list)
    # {map: error of the signal, dB, that it shows at least}, the worst scene's
    floors: dict[str, int] = field(default_factory=dict)
    floor_scenes: int = 0  # number of scenes of the floors
    pairs: list[Ratio] = field(default_factory=list)  # times of the config as it is against itself
    # load averages of the machine in the course of it
    loads: list[float] = field(default_factory=list)
    # settings that the config does not allow
    left_out: list[Omission] = field(default_factory=list)
    unmeasured: list[Omission] = field(default_factory=list)  # settings for which there was no time

    @property
    def blur(self) -> float:
        """Largest difference of the config as it is from itself, as a share of its time."""
        return max([LEAST_BLUR, *(abs(pair.value - 1) for pair in self.pairs)])

    def row_of(self, name: str) -> Row | None:
        """Row of a setting; None where it is not measured."""
        return next((row for row in self.rows if row.name == name), None)

    def numbers(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "settings": [row.numbers() for row in self.rows],
            "floors_db": self.floors,
            "floor_scenes": self.floor_scenes,
            "pairs": [pair._asdict() for pair in self.pairs],
            "blur": self.blur,
            "loads": self.loads,
            "left_out": [omission._asdict() for omission in self.left_out],
            "unmeasured": [omission._asdict() for omission in self.unmeasured],
        }

    @classmethod
    def read(cls, numbers: Mapping[str, Any]) -> "Sweep":
        """Sweep of plain values that `numbers` gave.

        Raises:
            KeyError, TypeError, ValueError: they are others.
        """
        return cls(
            [Row.read(row) for row in numbers["settings"]],
            TypeAdapter(dict[str, int]).validate_python(numbers["floors_db"]),
            int(numbers["floor_scenes"]),
            TypeAdapter(list[Ratio]).validate_python(numbers["pairs"]),
            [nan if load is None else float(load) for load in numbers["loads"]],
        )


def omissions_text(omissions: Sequence[Omission]) -> str:
    """Settings and reasons in a line, those of one reason together."""
    by_reason = dict[str, list[str]]()
    for name, reason in omissions:
        by_reason.setdefault(reason, []).append(name)
    return "; ".join(f"{', '.join(names)} ({reason})" for reason, names in by_reason.items())
