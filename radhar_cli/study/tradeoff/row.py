"""Rows of the table: what a setting costs and what it changes, as plain numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from math import inf
from statistics import median
from typing import Annotated, Any, NamedTuple, TypeAlias

from pydantic import BeforeValidator, TypeAdapter

from radhar_cli.study.tradeoff.differences import MapDifference, PointDifference, worst_maps
from radhar_cli.study.tradeoff.setting import Change, Setting
from radhar_cli.study.tradeoff.timing import Ratio

EXACT = "exact"  # a file's word for an error of -inf dB
Decibels: TypeAlias = Annotated[
    float | None, BeforeValidator(lambda value: -inf if value == EXACT else value)
]


class SceneDifference(NamedTuple):
    """What a setting changes of one scene."""

    error_of: str  # signal whose error is measured, in words
    # its relative error, dB; -inf of none, None where there is none to compare
    error_db: float | None
    stated_db: float | None  # error that the engine states itself
    maps: Mapping[str, MapDifference]
    points: PointDifference | None


@dataclass(frozen=True)
class MapNumbers:
    """Differences of a map over scenes: the worst scene's, and medians."""

    changed: float  # share of the pixels whose level differs
    over_one: float  # share of those that differ by more than one level
    ssim: float | None  # smallest SSIM; None where it is not defined
    rms_levels: float  # root mean square of the difference, levels
    rms_db: float | None  # the same in dB; None of pictures that show no decibels
    over_one_median: float  # median over scenes of `over_one`
    rms_levels_median: float  # median over scenes of `rms_levels`

    @classmethod
    def of(cls, differences: Sequence[MapDifference], level_db: float | None) -> "MapNumbers":
        """Numbers of a map in several scenes, whose grey levels are so many dB, if any."""
        worst = worst_maps(differences)
        return cls(
            *worst,
            None if level_db is None else level_db * worst.rms_levels,
            median(difference.over_one for difference in differences),
            median(difference.rms_levels for difference in differences),
        )

    @property
    def rms_median_db(self) -> float | None:
        """`rms_levels_median` in dB; None of pictures that show no decibels, or the same ones."""
        if self.rms_db is None or self.rms_levels == 0:
            return None
        return self.rms_db * self.rms_levels_median / self.rms_levels


@dataclass(frozen=True)
class AccuracyNumbers:
    """Accuracy of a network that learned from data of a setting, 0 to 1, with its interval."""

    by_seed: tuple[float, ...]
    mean: float
    low: float  # lower end of a 95 % interval of the mean
    high: float  # upper end
    tested_on: str = "default"  # data that it was tested on, in a word


@dataclass(frozen=True)
class Row:
    """One row of the table."""

    group: str
    name: str  # key and value, or what is changed in words
    overrides: tuple[str, ...]  # overrides that make the setting
    base_name: str  # what time and picture are compared with
    effect: Change  # whether data differ by an error, or by design
    is_default: bool = False  # whether it is the config as it is
    sample_ms: float | None = None  # time of a sample, ms
    ratio: float | None = None  # that time over the time of what it is compared with
    ratio_low: float | None = None  # lower end of its interval
    ratio_high: float | None = None
    rounds: int = 0
    scenes: int = 0  # scenes that were compared
    error_of: str = ""  # signal whose error is measured, in words
    error_db: Decibels = None  # relative error of it, worst scene, dB; -inf of none
    error_median_db: Decibels = None  # median over the scenes
    stated_db: Decibels = None  # error that the engine stated, worst scene
    maps: Mapping[str, MapNumbers] = field(default_factory=dict)  # {map: differences}
    points: PointDifference | None = None
    note: str = ""
    accuracy: AccuracyNumbers | None = None

    @classmethod
    def of(
        cls,
        setting: Setting,
        ratio: Ratio | None,
        scenes: Sequence[SceneDifference],
        level_db: float | None,
        note: str = "",
    ) -> "Row":
        """Row of a setting: its time, differences of scenes, and what is to be known besides.

        A grey level is `level_db` decibels; None of pictures that show none.
        """
        errors = [scene.error_db for scene in scenes if scene.error_db is not None]
        stated = [scene.stated_db for scene in scenes if scene.stated_db is not None]
        names = dict.fromkeys(name for scene in scenes for name in scene.maps)
        points = [scene.points for scene in scenes if scene.points is not None]
        times: dict[str, Any] = {}
        if ratio is not None:
            times = {"sample_ms": ratio.sample_ms, "ratio": ratio.value, "rounds": ratio.rounds}
            times |= {"ratio_low": ratio.low, "ratio_high": ratio.high}
        return cls(
            setting.group,
            setting.name,
            setting.overrides,
            setting.base_name,
            setting.effect,
            is_default=not setting.overrides,
            **times,
            scenes=len(scenes),
            error_of=next((scene.error_of for scene in scenes), ""),
            error_db=max(errors, default=None),
            error_median_db=median(errors) if errors else None,
            stated_db=max(stated, default=None),
            maps={
                name: MapNumbers.of(
                    [scene.maps[name] for scene in scenes if name in scene.maps], level_db
                )
                for name in names
            },
            points=max(points, key=lambda difference: difference.moved, default=None),
            note=note,
        )

    @property
    def is_error(self) -> bool:
        """Whether its data differ by an error of computation."""
        return self.effect is Change.ERROR

    @property
    def over_one(self) -> float | None:
        """Largest share of the pixels of a map that differ by more than a level, or of points."""
        shares = [numbers.over_one for numbers in self.maps.values()]
        if self.points is not None:
            shares.append(self.points.moved)
        return max(shares, default=None)

    def numbers(self) -> dict[str, Any]:
        """Plain values for JSON; an error of -inf is EXACT."""
        plain = asdict(self)
        for key in ("error_db", "error_median_db", "stated_db"):
            plain[key] = EXACT if plain[key] == -inf else plain[key]
        if self.points is not None:
            plain["points"] = self.points._asdict()
        return plain

    @classmethod
    def read(cls, numbers: Mapping[str, Any]) -> "Row":
        """Row of plain values that `numbers` gave.

        Raises:
            ValueError: they are others.
        """
        return TypeAdapter(cls).validate_python(numbers)
