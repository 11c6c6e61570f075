"""Find the limits of a config: every number that acts, both sides, within a time."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import TypeAlias

from radhar_cli.config.data_set import Config
from radhar_cli.errors import ConfigError, RadharError, did_you_mean
from radhar_cli.processes.progress import Progress
from radhar_cli.processes.time_limit import time_limit
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.scene import Scene
from radhar_cli.study.limits.keys import NumberKey, acting_numbers
from radhar_cli.study.limits.limit import (
    CLEAN,
    KEY_ENDS,
    NOTED,
    Consequence,
    Judgement,
    Limit,
    Origin,
    RangeSide,
)
from radhar_cli.study.limits.margins import Margin, Reach, margins_of, reach_of
from radhar_cli.study.limits.search import End, Path, find_end_at_zero, halve
from radhar_cli.study.limits.trial import ConfigTrial, Place, judge_sample, refusal_of
from radhar_cli.study.limits.work import Counts, counted_work, work_ratio
from radhar_cli.study.trials import Budget, TriedSetting, try_settings

SLOW = 10.0  # times the work of a sample of the config, from which on it counts as slower
SHARE = 0.1  # of the time, that one simulated sample may take
FEW = 3  # samples that stand for all on the way to a limit; all are drawn at its end
COORDINATE_KEY = re.compile(r"_m\.\d$")
REFUSING = (Consequence.REFUSED, Consequence.REDRAWN)
FIRST_SHARE = 0.75  # of the time, in which limits are looked for without simulating
REPAIRS = 3  # how often a way is gone again because another sample fails at its end
MOST_SIMULATED = 6  # samples simulated on the way to an end that simulation alone shows

KeySide: TypeAlias = tuple[NumberKey, RangeSide]


@dataclass
class Study:
    """Limits of a config, as far as they were found."""

    keys: tuple[NumberKey, ...]  # all keys that were looked for
    margins: list[Margin] = field(default_factory=list)
    # by key and side, in the order of the schema
    limits: dict[tuple[str, RangeSide], Limit] = field(default_factory=dict)
    # classes without a scene that can be drawn, and why
    troubled: dict[str, str] = field(default_factory=dict)
    sample_s: float | None = None  # processor time of a sample of the config, s

    @property
    def unfinished(self) -> list[tuple[str, RangeSide]]:
        """Keys and sides whose limits are not known."""
        places = ((number.key, side) for number in self.keys for side in RangeSide)
        return [place for place in places if place not in self.limits]

    @property
    def not_simulated(self) -> list[tuple[str, RangeSide]]:
        """Keys and sides at whose limits no sample was simulated."""
        return [place for place, limit in self.limits.items() if not limit.simulated]

    def keep(self, tried: TriedSetting[KeySide, Limit]) -> None:
        """Keep the limit of a number, where one was found."""
        if tried.result is not None:
            number, side = tried.setting
            self.limits[number.key, side] = tried.result

    def limits_of(self, number: NumberKey) -> list[Limit | None]:
        """Limits of a number below and above; None where there was no time."""
        return [self.limits.get((number.key, side)) for side in RangeSide]


def study_limits(
    trial: ConfigTrial, keys: Sequence[str] | None, seconds: float, progress: Progress
) -> Study:
    """Find how far every number of a config may go.

    Args:
        trial: the config.
        keys: dotted keys that are looked at, or sections; None for all.
        seconds: time for all of it, s; what is found by then counts.
        progress: is told of every limit.

    Raises:
        ConfigError: a key is no number that has an effect.
    """
    study = Study(chosen_numbers(trial.config, keys), troubled=trial.troubled)
    budget, first = Budget(seconds), Budget(FIRST_SHARE * seconds)
    places = [(number, side) for number in study.keys for side in RangeSide]
    places.sort(key=lambda place: bool(COORDINATE_KEY.search(place[0].key)))  # which take longest
    search: _Search | None = None
    with time_limit(first.left):
        search = _Search(trial, study, budget)
    if search is None:
        return study
    progress.stage("limits", len(places), 0, "limit")
    for tried in try_settings(places, search.find_limit, first, progress):
        study.keep(tried)
    known = [(number, side) for number, side in places if (number.key, side) in study.limits]
    progress.stage("simulating", len(known), 0, "limit")
    with time_limit(budget.left):
        search.time_sample()
    for tried in try_settings(known, search.simulate_limit, budget, progress):
        study.keep(tried)
    return study


def chosen_numbers(config: Config, keys: Sequence[str] | None) -> tuple[NumberKey, ...]:
    """Numbers of a config by key or section; all where none is named.

    Raises:
        ConfigError: a name is of none of them.
    """
    numbers = acting_numbers(config)

    def numbers_named(name: str) -> list[NumberKey]:
        return [number for number in numbers if f"{number.key}.".startswith(f"{name}.")]

    for name in keys or ():
        if not numbers_named(name):
            known = [number.key for number in numbers]
            raise ConfigError(
                f"--key {name}: is no number that has an effect with this config; "
                + did_you_mean(name, known, f"some that have: {', '.join(known[:8])}")
            )
    named = [number for name in keys or () for number in numbers_named(name)]
    return tuple(number for number in numbers if not keys or number in named)


class _Search:
    """Search for the limits of a config."""

    def __init__(self, trial: ConfigTrial, study: Study, budget: Budget) -> None:
        self.trial, self.study, self.budget = trial, study, budget
        self.base_work: Counts = counted_work(trial.config)
        self.reaches: dict[Place, Reach] = {}
        scenes = list[Scene]()
        for place in trial.places(""):
            scene = draw_valid_scene(trial.config, *place)[0]
            self.reaches[place] = reach_of(scene)
            scenes.append(scene)
        study.margins = margins_of(scenes, list(self.reaches.values()))

    def find_limit(self, place: KeySide, seconds: float) -> Limit | None:
        """Find a limit without simulating; None where the time, s, is too short."""
        with time_limit(seconds):
            return self._find_limit(*place)
        return None

    def _find_limit(self, key: NumberKey, side: RangeSide) -> Limit:
        """Find a limit without simulating: by checks, then counted work, then by scenes within."""
        places = self.trial.places(key.key)
        few = self._extreme_places(places)
        accept, afford, judge = (
            cache(partial(self._judge, key, bound)) for bound in (None, (), tuple(few))
        )
        first = key.range[0 if side is RangeSide.LOW else 1]
        start = next((x for x in (first, *key.middles) if judge(x).is_clean), None)
        if start is None:
            return Limit(key.key, side, None, judge(key.middles[0]))
        path = Path(start, key.low if side is RangeSide.LOW else key.high, key.is_whole)
        end = farthest = find_end_at_zero(afford, path)
        if end.outside is not None and end.judgement.effect is not Consequence.REFUSED:
            farthest = find_end_at_zero(accept, replace(path, start=end.outside))
        path = replace(path, bound=end.inside)
        drawn = find_end_at_zero(judge, path)
        end = end if drawn.outside is None else drawn
        others = [place for place in places if place not in few and place[1] == 0]
        for _ in range(REPAIRS):
            failing = self._failing(key, end.inside, others)
            if failing is None:
                break
            judge_failing = partial(self._judge, key, (failing,))
            end = find_end_at_zero(judge_failing, replace(path, bound=end.inside))
        is_warned = end.outside is not None and end.judgement.effect is Consequence.WARNED
        if is_warned and judge(farthest.inside).effect in REFUSING:  # the last that can be drawn
            beyond = Path(end.outside or 0.0, farthest.inside, key.is_whole)
            farthest = find_end_at_zero(judge, beyond, lambda each: each.effect not in REFUSING)
        return _as_limit(key, side, end, farthest)

    def _judge(self, key: NumberKey, places: tuple[Place, ...] | None, number: float) -> Judgement:
        """Judge a number by checks, by counted work, and by warnings and scenes.

        Args:
            key: key of the number.
            places: samples that are drawn; () for checks and work alone, None for checks alone.
            number: the number.
        """
        try:
            config = self.trial.config_with(key.key, number)
        except ConfigError as error:
            return refusal_of(error, key.key)
        if places is not None and work_ratio(config, self.base_work) > SLOW:  # before drawing
            return Judgement(Consequence.SLOWER, Origin.TIME, f"{SLOW:.0f} times the work")
        return self.trial.judge(config, places) if places else CLEAN

    def _extreme_places(self, places: list[Place]) -> list[Place]:
        """Samples that stand for all: the farthest, the fastest and the nearest, of few classes."""
        if not places:
            return []
        chosen = [
            max(places, key=lambda place: self.reaches[place].fastest),
            max(places, key=lambda place: self.reaches[place].farthest),
            min(places, key=lambda place: self.reaches[place].nearest),
        ]
        return list(dict.fromkeys(chosen))[:FEW]

    def _failing(self, key: NumberKey, number: float, places: list[Place]) -> Place | None:
        """First sample that shows something new with a number, or None."""
        config = self.trial.config_with(key.key, number)
        for place in places:
            if not self.trial.judge_scene(config, *place).is_clean:
                return place
        return None

    def time_sample(self) -> None:
        """Time a sample of the config itself, after a first one that loads and compiles."""
        place = self.trial.places("")[0]
        try:
            times = [judge_sample(self.trial.config, place)[1] for _ in range(3)]
        except RadharError:
            return
        self.study.sample_s = max(min(times[1:]), 1e-4)

    def simulate_limit(self, place: KeySide, seconds: float) -> Limit | None:
        """Simulate at a limit; None where the time, s, is too short."""
        with time_limit(seconds):
            return self._simulate_limit(*place)
        return None

    def _simulate_limit(self, key: NumberKey, side: RangeSide) -> Limit:
        """Simulate at a limit; where that shows an end, or is too slow, find the nearer one."""
        limit, base_s = self.study.limits[key.key, side], self.study.sample_s
        places = self._extreme_places(self.trial.places(key.key))
        if limit.value is None or base_s is None or not places:
            return limit
        work = work_ratio(self.trial.config_with(key.key, limit.value), self.base_work)
        if work * base_s > SHARE * self.budget.left:
            return limit
        times = dict[float, float]()

        def judge(number: float) -> Judgement:
            judgement, times[number] = self._simulate(key, number, places[0])
            return judgement

        judgement = judge(limit.value)
        if judgement.is_clean:
            return replace(limit, simulated=True, times=times[limit.value])
        path = Path(key.range[0 if side is RangeSide.LOW else 1], limit.value, key.is_whole)
        end = halve(judge, path, (0.0, 1.0), judgement, steps=MOST_SIMULATED)
        return replace(
            limit,
            value=end.inside,
            beyond=end.judgement,
            last_accepted=limit.value,
            refusal=limit.beyond,
            times=times.get(end.inside),
            simulated=True,
        )

    def _simulate(self, key: NumberKey, number: float, place: Place) -> tuple[Judgement, float]:
        """Simulate a sample; judge it, and return how many times as long as the config's it took.

        What took too long is timed once more, as the first sample of its kind may load or compile.
        """
        base_s = self.study.sample_s or 1.0
        judgement, seconds = self.trial.simulate(key.key, number, place)
        if judgement.is_clean and seconds > NOTED * base_s:
            seconds = min(seconds, self.trial.simulate(key.key, number, place)[1])
        if judgement.is_clean and seconds > SLOW * base_s:
            reason = f"a sample takes {seconds / base_s:.2g} times as long"
            judgement = Judgement(Consequence.SLOWER, Origin.TIME, reason)
        return judgement, seconds / base_s


def _as_limit(key: NumberKey, side: RangeSide, end: End, farthest: End) -> Limit:
    """Limit of an end; where farther numbers are accepted, say where they are not."""
    refusal = KEY_ENDS if farthest.outside is None else farthest.judgement
    if end.outside is None or end.inside == farthest.inside:
        return Limit(key.key, side, end.inside, refusal)
    if end.judgement.effect in REFUSING:
        return Limit(key.key, side, end.inside, end.judgement)
    return Limit(key.key, side, end.inside, end.judgement, farthest.inside, refusal)
