"""Measurements of a sweep: a row for each setting, floors of images, the blur of the machine."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, nan, sqrt
from statistics import mean, median, stdev
from typing import Annotated, Any, NamedTuple, TypeAlias

from pydantic import BeforeValidator, Field, PlainSerializer, TypeAdapter

from radhar_cli.study.tradeoff.differences import MapDifference, PointDifference, SceneDifference
from radhar_cli.study.tradeoff.settings import DEFAULT, Change, Setting

EXACT = "exact"  # a file's word for an error of -inf dB
Decibels: TypeAlias = Annotated[
    float | None,
    BeforeValidator(lambda value: -inf if value == EXACT else value),
    PlainSerializer(lambda value: EXACT if value == -inf else value),
]
LEAST_BLUR = 0.01  # of processor time, whatever pairs say
LEAST_ROUNDS = 3  # of timing, without which nothing is concluded
MANY_ROUNDS = 6  # from which on the interval leaves out the outermost ones


@dataclass(frozen=True)
class Ratio:
    """Time of a setting over that of its base, over some rounds."""

    sample_ms: float  # median time of a sample, ms
    value: float
    low: float  # lower end of an interval of the median; the smallest of few rounds
    high: float
    rounds: int

    @classmethod
    def of(cls, rounds: Sequence[tuple[float, float]]) -> "Ratio":
        """Ratio of rounds, one at least: time of a sample, ms, and over that of its base.

        The interval of six rounds or more leaves out the smallest and the largest, and so on: it
        holds the median in nine of ten cases or more.
        """
        ratios = sorted(ratio for _, ratio in rounds)
        cut = 0 if len(ratios) < MANY_ROUNDS else (len(ratios) - 3) // 3
        sample_ms = median(sample_ms for sample_ms, _ in rounds)
        return cls(sample_ms, median(ratios), ratios[cut], ratios[-1 - cut], len(ratios))


@dataclass(frozen=True)
class MapNumbers(MapDifference):
    """Differences of a map over scenes: the worst scene's, and medians."""

    rms_db: float | None  # `rms_levels` in dB; None of pictures that show no decibels
    over_one_median: float  # median over scenes of `over_one`
    rms_levels_median: float  # median over scenes of `rms_levels`

    @classmethod
    def of(cls, differences: Sequence[MapDifference], level_db: float | None) -> "MapNumbers":
        """Numbers of a map in several scenes, whose grey levels are so many dB, if any."""
        over_one, rms = (
            [getattr(d, key) for d in differences] for key in ("over_one", "rms_levels")
        )
        return cls(
            changed=max(difference.changed for difference in differences),
            over_one=max(over_one),
            ssim=min((d.ssim for d in differences if d.ssim is not None), default=None),
            rms_levels=max(rms),
            rms_db=None if level_db is None else level_db * max(rms),
            over_one_median=median(over_one),
            rms_levels_median=median(rms),
        )

    def shown(self, is_worst: bool) -> tuple[float, str]:
        """Share of the pixels over a level, and rms in words: the worst scene's, or medians."""
        levels = self.rms_levels if is_worst else self.rms_levels_median
        over_one = self.over_one if is_worst else self.over_one_median
        if self.rms_db is None or self.rms_levels == 0:
            return over_one, f"{levels:.2g} levels"
        return over_one, f"{self.rms_db * levels / self.rms_levels:.2g} dB rms"


class Interval(NamedTuple):
    """Mean with the ends of its interval of 95 %, which are NaN where a single value gives none."""

    mean: float
    low: float
    high: float

    @classmethod
    def of(cls, values: Sequence[float]) -> "Interval":
        """Interval of the mean of values, one at least, that are independent and normal."""
        middle, count = mean(values), len(values)
        if count == 1:
            return cls(middle, nan, nan)
        from scipy.special import stdtrit

        half = float(stdtrit(count - 1, 0.975)) * stdev(values) / sqrt(count)
        return cls(middle, middle - half, middle + half)


@dataclass(frozen=True)
class AccuracyNumbers:
    """Accuracy of networks that learned from data of a setting, 0 to 1, with its interval."""

    by_seed: tuple[float, ...]
    mean: float
    low: float  # lower end of a 95 % interval of the mean
    high: float  # upper end
    tested_on: str = "default"  # data that it was tested on: of the config as it is, or its own

    def loss_of(self, other: "AccuracyNumbers") -> Interval:
        """Accuracy that another one loses against this one, over the seeds that both have.

        What a seed draws, scenes and first weights, is the same in both and is not counted as
        chance.
        """
        pairs = zip(self.by_seed, other.by_seed, strict=False)
        return Interval.of([usual - accuracy for usual, accuracy in pairs])


@dataclass(frozen=True)
class Row:
    """One row of the table: the cost of a setting and its changes."""

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
        ratio: Ratio,
        scenes: Sequence[SceneDifference],
        level_db: float | None,
        note: str = "",
    ) -> "Row":
        """Row of a setting: its time, differences of scenes, and notes.

        A grey level is `level_db` decibels; None of pictures that show none.
        """
        errors = [scene.error_db for scene in scenes if scene.error_db is not None]
        stated = [scene.stated_db for scene in scenes if scene.stated_db is not None]
        points = [scene.points for scene in scenes if scene.points is not None]
        by_map = dict[str, list[MapDifference]]()
        for scene in scenes:
            for name, difference in scene.maps.items():
                by_map.setdefault(name, []).append(difference)
        return cls(
            *(setting.group, setting.name, setting.overrides, setting.base_name, setting.effect),
            is_default=not setting.overrides,
            sample_ms=ratio.sample_ms,
            ratio=ratio.value,
            ratio_low=ratio.low,
            ratio_high=ratio.high,
            rounds=ratio.rounds,
            scenes=len(scenes),
            error_of=next((scene.error_of for scene in scenes), ""),
            error_db=max(errors, default=None),
            error_median_db=median(errors) if errors else None,
            stated_db=max(stated, default=None),
            maps={name: MapNumbers.of(several, level_db) for name, several in by_map.items()},
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
        shares += [] if self.points is None else [self.points.moved]
        return max(shares, default=None)

    @property
    def drops_map(self) -> bool:
        """Whether it has fewer maps than the config, so that what stays is not all."""
        return self.name.startswith("maps without ")

    def saves(self, blur: float, least_rounds: int = LEAST_ROUNDS) -> bool:
        """Whether it takes less time than the config as it is, beyond its interval and the blur.

        Args:
            blur: share by which the config as it is differs from itself.
            least_rounds: rounds of timing without which nothing is concluded.
        """
        is_compared = self.base_name == DEFAULT and not self.is_default
        is_timed = self.ratio_high is not None and self.rounds >= least_rounds
        return is_compared and is_timed and (self.ratio_high or 0) < 1 - blur

    def costs(self, blur: float) -> bool:
        """Whether it takes more time than its base, beyond interval and blur."""
        is_timed = not self.is_default and self.rounds >= LEAST_ROUNDS
        return is_timed and (self.ratio_low or 0) > 1 + blur


@dataclass(frozen=True)
class Omission:
    """A setting without a row, and why."""

    name: str
    reason: str


@dataclass
class Sweep:
    """Results of a sweep, which grow."""

    # rows in the order of measuring, the config as it is first
    rows: Annotated[list[Row], Field(alias="settings")] = field(default_factory=list)
    # {map: error of the signal, dB, that it shows at least}, the worst scene's
    floors_db: dict[str, int] = field(default_factory=dict)
    floor_scenes: int = 0  # number of scenes of the floors
    pairs: list[Ratio] = field(default_factory=list)  # times of the config as it is against itself
    # load averages of the machine in the course of it; None where nobody counts them
    loads: list[float | None] = field(default_factory=list)
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
        """Plain values for JSON; an error of -inf is EXACT."""
        return {**_SWEEP.dump_python(self, by_alias=True), "blur": self.blur}

    @classmethod
    def read(cls, numbers: Mapping[str, Any]) -> "Sweep":
        """Sweep of plain values that `numbers` gave; what was left out is tried again.

        Raises:
            ValueError: they are others.
        """
        return _SWEEP.validate_python({**numbers, "left_out": [], "unmeasured": []})


_SWEEP = TypeAdapter(Sweep)
