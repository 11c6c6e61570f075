"""Stand-in until merged."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Accuracy:
    name: str
    mean: float
    low: float
    high: float
    seeds: tuple[float, ...]
