"""Find the limits of a config: every number that acts, both sides, within a time."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cache, partial

from radhar_cli.config.data_set import Config
from radhar_cli.errors import ConfigError, did_you_mean
from radhar_cli.processes.progress import Progress
from radhar_cli.processes.time_limit import time_limit
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.study.limits.judging import (
    CLEAN,
    ConfigTrial,
    Consequence,
    Judgement,
    Origin,
    Place,
    judge_sample,
    refusal_of,
)
from radhar_cli.study.limits.keys import NumberKey, acting_numbers
from radhar_cli.study.limits.margins import (
    Margin,
    Reach,
    counted_work,
    margins_of,
    reach_of,
    work_ratio,
)
from radhar_cli.study.limits.search import Path, find_end_at_zero, halve
from radhar_cli.study.trials import Budget, TriedSetting, try_settings

SLOW = 10.0  # times the work of a sample of the config, from which on it counts as slower
NOTED = 1.5  # times as slow, from which on it is said
SHARE = 0.1  # of the time, that one simulated sample may take
COORDINATE_KEY = re.compile(r"_m\.\d$")
FIRST_SHARE = 0.75  # of the time, in which limits are looked for without simulating
REPAIRS = 3  # how often a way is gone again because another sample fails at its end
MOST_SIMULATED = 6  # samples simulated on the way to an end that simulation alone shows
KEY_ENDS = Judgement(Consequence.REFUSED, Origin.KEY, "as far as the key goes")


class RangeSide(StrEnum):
    """Side of the range of a number."""

    LOW = "below"
    HIGH = "above"


@dataclass(frozen=True)
class Limit:
    """Limit of a number on one side."""

    number: NumberKey
    side: RangeSide
    # last number, of three digits, of which nothing new happens; None where there is none, not even
    # that of the config
    value: float | None
    beyond: Judgement
    # last number that is not refused, where farther numbers are but warned of; None where the next
    # is refused, or none is known
    last_accepted: float | None = None
    refusal: Judgement | None = None  # what happens beyond that
    # duration of a sample there over that of the config's own; None if it was not timed
    times: float | None = None
    simulated: bool = False  # whether a sample was simulated there

    @property
    def key(self) -> str:
        """Dotted key of the number."""
        return self.number.key

    def beyond_in_words(self, says_source: bool = False) -> str:
        """Describe the consequence beyond, with its origin if `says_source`."""
        text = self.beyond.sentence
        if says_source and self.beyond.source is not Origin.KEY:
            text += f" [{self.beyond.source}]"
        if self.times is not None and self.times >= NOTED:
            text += f"; there {self.times:.2g} times as slow"
        if self.refusal is not None and self.last_accepted is not None:
            beyond = "beyond" if self.side is RangeSide.HIGH else "below"
            text += f"; {beyond} {number_text(self.last_accepted)} {self.refusal.sentence}"
        return text

    @property
    def sentence(self) -> str:
        """The limit in words: "up to 7.4 (a joint is faster than the Doppler PRF/2: warned)"."""
        words = "up to" if self.side is RangeSide.HIGH else "down to"
        end = "no number fits" if self.value is None else f"{words} {number_text(self.value)}"
        return f"{end} ({self.beyond_in_words()})"


def number_text(value: float) -> str:
    """Text of a number of three digits, whole up to a million."""
    return str(int(value)) if value == int(value) and abs(value) < 1e6 else f"{value:.6g}"


@dataclass(frozen=True)
class KeySide:
    """Setting of the study: one side of a number."""

    number: NumberKey
    side: RangeSide

    def path_from(self, start: float) -> Path:
        """Way from a number to the bound of the key on this side."""
        bound = self.number.low if self.side is RangeSide.LOW else self.number.high
        return Path(start, bound, self.number.is_whole)

    @property
    def first(self) -> float:
        """End of the range that the config draws from now."""
        return self.number.range[self.side is RangeSide.HIGH]


@dataclass
class LimitsStudy:
    """Limits of a config, as far as they were found."""

    trial: ConfigTrial
    numbers: tuple[NumberKey, ...]  # all that are looked for
    budget: Budget
    margins: list[Margin] = field(default_factory=list)
    # by key and side, in the order of the schema
    limits: dict[tuple[str, RangeSide], Limit] = field(default_factory=dict)
    sample_s: float | None = None  # processor time of a sample of the config, s
    base_work: dict[str, float] = field(default_factory=dict)  # of a sample of the config
    reaches: dict[Place, Reach] = field(default_factory=dict)

    @property
    def unfinished(self) -> list[tuple[str, RangeSide]]:
        """Keys and sides whose limits are not known."""
        places = ((number.key, side) for number in self.numbers for side in RangeSide)
        return [place for place in places if place not in self.limits]

    @property
    def not_simulated(self) -> list[tuple[str, RangeSide]]:
        """Keys and sides at whose limits no sample was simulated."""
        return [place for place, limit in self.limits.items() if not limit.simulated]

    def run(self, seconds: float, progress: Progress) -> None:
        """Look for limits without simulating, then simulate at each, as far as the time goes."""
        first = Budget(FIRST_SHARE * seconds)
        sides = [KeySide(number, side) for number in self.numbers for side in RangeSide]
        sides.sort(key=lambda each: bool(COORDINATE_KEY.search(each.number.key)))  # take longest
        with time_limit(first.left):
            self._look_at_config()
        if not self.margins:
            return
        progress.stage("limits", len(sides), 0, "limit")
        self._keep(try_settings(sides, self._find_limit, first, progress))
        known = [each for each in sides if (each.number.key, each.side) in self.limits]
        progress.stage("simulating", len(known), 0, "limit")
        with time_limit(self.budget.left):
            self._time_sample()
        self._keep(try_settings(known, self._simulate_limit, self.budget, progress))

    def _keep(self, trials: Iterator[TriedSetting[KeySide, Limit]]) -> None:
        for trial in trials:
            if trial.result is not None:
                self.limits[trial.result.key, trial.result.side] = trial.result

    def _look_at_config(self) -> None:
        """Find the work, the reaches and the margins of the config as it is."""
        self.base_work = counted_work(self.trial.config)
        places = self.trial.places("")
        scenes = [draw_valid_scene(self.trial.config, *place)[0] for place in places]
        self.reaches = {place: reach_of(s) for place, s in zip(places, scenes, strict=True)}
        self.margins = margins_of(scenes, list(self.reaches.values()))

    def _find_limit(self, side: KeySide) -> Iterator[Limit]:
        """Yield a limit without simulating: by checks, then counted work, then by scenes within."""
        places, number = self.trial.places(side.number.key), side.number
        few = self._extreme_places(places)
        accept, afford, judge = (
            cache(partial(self._judge, number.key, drawn)) for drawn in (None, (), tuple(few))
        )
        start = next((x for x in (side.first, *number.middles) if judge(x).is_clean), None)
        if start is None:
            yield Limit(number, side.side, None, judge(number.middles[0]))
            return
        path = side.path_from(start)
        end = farthest = find_end_at_zero(afford, path)
        if end.outside is not None and end.judgement.effect is not Consequence.REFUSED:
            farthest = find_end_at_zero(accept, replace(path, start=end.outside))
        path = replace(path, bound=end.inside)
        drawn = find_end_at_zero(judge, path)
        end = end if drawn.outside is None else drawn
        others = [place for place in places if place not in few and place[1] == 0]
        for _ in range(REPAIRS):
            config = self.trial.config_with(number.key, end.inside)
            scenes = ((place, self.trial.judge_scene(config, place)) for place in others)
            failing = next((place for place, judged in scenes if not judged.is_clean), None)
            if failing is None:
                break
            end = find_end_at_zero(
                partial(self._judge, number.key, (failing,)), replace(path, bound=end.inside)
            )
        is_warned = end.outside is not None and end.judgement.effect is Consequence.WARNED
        if is_warned and judge(farthest.inside).is_refused:  # the last that can be drawn
            beyond = Path(end.outside or 0.0, farthest.inside, number.is_whole)
            farthest = find_end_at_zero(_refusals_of(judge), beyond)
        refusal = KEY_ENDS if farthest.outside is None else farthest.judgement
        if end.outside is None or end.inside == farthest.inside:
            yield Limit(number, side.side, end.inside, refusal)
        elif end.judgement.is_refused:
            yield Limit(number, side.side, end.inside, end.judgement)
        else:
            yield Limit(number, side.side, end.inside, end.judgement, farthest.inside, refusal)

    def _judge(self, key: str, places: tuple[Place, ...] | None, number: float) -> Judgement:
        """Judge a number by checks, by counted work, and by warnings and scenes.

        Args:
            key: dotted key of the number.
            places: samples that are drawn; () for checks and work alone, None for checks alone.
        """
        try:
            config = self.trial.config_with(key, number)
        except ConfigError as error:
            return refusal_of(error, key)
        if places is not None and work_ratio(config, self.base_work) > SLOW:  # before drawing
            return Judgement(Consequence.SLOWER, Origin.TIME, f"{SLOW:.0f} times the work")
        return self.trial.judge(config, places) if places else CLEAN

    def _extreme_places(self, places: list[Place]) -> list[Place]:
        """Samples that stand for all: the farthest, the fastest and the nearest, of few classes."""
        if not places:
            return []
        chosen = (
            max(places, key=lambda place: self.reaches[place].fastest),
            max(places, key=lambda place: self.reaches[place].farthest),
            min(places, key=lambda place: self.reaches[place].nearest),
        )
        return list(dict.fromkeys(chosen))

    def _time_sample(self) -> None:
        """Time a sample of the config itself, after a first one that loads and compiles."""
        place = self.trial.places("")[0]
        judged = [judge_sample(self.trial.config, place) for _ in range(3)]
        if judged[0][0].effect is not Consequence.REFUSED:
            self.sample_s = max(min(seconds for _, seconds in judged[1:]), 1e-4)

    def _simulate_limit(self, side: KeySide) -> Iterator[Limit]:
        """Simulate at a limit; where that shows an end, or is too slow, find the nearer one."""
        key, base_s = side.number.key, self.sample_s
        limit = self.limits[key, side.side]
        places = self._extreme_places(self.trial.places(key))
        if limit.value is None or base_s is None or not places:
            return
        work = work_ratio(self.trial.config_with(key, limit.value), self.base_work)
        if work * base_s > SHARE * self.budget.left:
            return
        times = dict[float, float]()

        def judge(number: float) -> Judgement:
            config = self.trial.config_with(key, number)
            judgement, seconds = judge_sample(config, places[0])
            if judgement.is_clean and seconds > NOTED * base_s:  # as the first one may compile
                seconds = min(seconds, judge_sample(config, places[0])[1])
            times[number] = seconds / base_s
            if judgement.is_clean and times[number] > SLOW:
                reason = f"a sample takes {times[number]:.2g} times as long"
                return Judgement(Consequence.SLOWER, Origin.TIME, reason)
            return judgement

        judgement = judge(limit.value)
        if judgement.is_clean:
            yield replace(limit, simulated=True, times=times[limit.value])
            return
        path = Path(side.first, limit.value, side.number.is_whole)
        end = halve(judge, path, (0.0, 1.0), judgement, MOST_SIMULATED)
        yield replace(
            Limit(side.number, side.side, end.inside, end.judgement, limit.value, limit.beyond),
            times=times.get(end.inside),
            simulated=True,
        )


def _refusals_of(judge: Callable[[float], Judgement]) -> Callable[[float], Judgement]:
    """Judge for which a number that is but warned of is fine."""

    def judge_refusals(number: float) -> Judgement:
        judgement = judge(number)
        return judgement if judgement.is_refused else CLEAN

    return judge_refusals


def study_limits(
    trial: ConfigTrial, keys: Sequence[str] | None, seconds: float, progress: Progress
) -> LimitsStudy:
    """Find how far every number of a config may go.

    Args:
        keys: dotted keys that are looked at, or sections; None for all.
        seconds: time for all of it, s; what is found by then counts.
        progress: is told of every limit.

    Raises:
        ConfigError: a key is no number that has an effect.
    """
    study = LimitsStudy(trial, chosen_numbers(trial.config, keys), Budget(seconds))
    study.run(seconds, progress)
    return study


def chosen_numbers(config: Config, keys: Sequence[str] | None) -> tuple[NumberKey, ...]:
    """Numbers of a config by key or section; all where none is named.

    Raises:
        ConfigError: a name is of none of them.
    """
    numbers, chosen = acting_numbers(config), set[str]()
    for name in keys or ():
        named = {number.key for number in numbers if f"{number.key}.".startswith(f"{name}.")}
        if not named:
            known = [number.key for number in numbers]
            raise ConfigError(
                f"--key {name}: is no number that has an effect with this config; "
                + did_you_mean(name, known, f"some that have: {', '.join(known[:8])}")
            )
        chosen |= named
    return tuple(number for number in numbers if not keys or number.key in chosen)
