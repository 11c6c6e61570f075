"""Find the limits of a config: every number that acts, both sides, within a time."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from math import inf
from typing import TypeAlias

from radhar_cli.config.data_set import Config
from radhar_cli.errors import ConfigError, RadharError, did_you_mean
from radhar_cli.processes.progress import Progress
from radhar_cli.processes.time_limit import time_limit
from radhar_cli.scene import Scene
from radhar_cli.scene_checks.drawing import draw_valid_scene
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
from radhar_cli.study.limits.search import End, Path, find_end_at_zero
from radhar_cli.study.limits.trial import ConfigTrial, Place, judge_sample, refusal_of
from radhar_cli.study.limits.work import Counts, counted_work, work_ratio
from radhar_cli.study.trials import Budget, Trial, try_settings

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
    """Limits of a config, as far as they were found.

    Attributes:
        limits: by key and side, in the order of the schema.
        keys: all keys that were looked for.
        margins: what is drawn beside where the radar ends.
        troubled: classes without a scene that can be drawn, and why.
        sample_s: processor time of a sample of the config, s.
        unfinished: keys and sides whose limits are not known.
        not_simulated: keys and sides at whose limits no sample was simulated.
    """

    keys: tuple[NumberKey, ...]
    margins: list[Margin] = field(default_factory=list)
    limits: dict[tuple[str, RangeSide], Limit] = field(default_factory=dict)
    troubled: dict[str, str] = field(default_factory=dict)
    sample_s: float | None = None

    @property
    def unfinished(self) -> list[tuple[str, RangeSide]]:
        places = ((number.key, side) for number in self.keys for side in RangeSide)
        return [place for place in places if place not in self.limits]

    @property
    def not_simulated(self) -> list[tuple[str, RangeSide]]:
        return [place for place, limit in self.limits.items() if not limit.simulated]

    def keep(self, tried: Trial[KeySide, Limit]) -> None:
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
    if not keys:
        return tuple(numbers)
    for name in keys:
        if not any(f"{number.key}.".startswith(f"{name}.") for number in numbers):
            known = [number.key for number in numbers]
            raise ConfigError(
                f"--key {name}: is no number that has an effect with this config; "
                + did_you_mean(name, known, f"some that have: {', '.join(known[:8])}")
            )
    return tuple(
        number
        for number in numbers
        if any(f"{number.key}.".startswith(f"{name}.") for name in keys)
    )


def _last_drawn(judge: Callable[[float], Judgement], end: End, farthest: End, path: Path) -> End:
    """Find the last number whose scenes can be drawn, of those that are but warned of.

    Args:
        judge: judges a number.
        end: end of what nothing is said of.
        farthest: end of what checks accept.
        path: way to the end.
    """
    if end.outside is None or end.judgement.effect is not Consequence.WARNED:
        return farthest
    if judge(farthest.inside).effect not in REFUSING:
        return farthest
    beyond = Path(end.outside, farthest.inside, path.is_whole)
    return find_end_at_zero(judge, beyond, lambda judged: judged.effect not in REFUSING)


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
        """Find a limit without simulating: by checks and counted work, then by scenes within."""
        places = self.trial.places(key.key)
        few = self._extreme_places(places)

        @cache
        def judge(number: float) -> Judgement:
            return self._judge(key, number, few)

        first = key.range[0 if side is RangeSide.LOW else 1]
        start = next((x for x in (first, *key.middles) if judge(x).is_clean), None)
        if start is None:
            return Limit(key.key, side, None, judge(key.middles[0]))
        path = Path(start, key.low if side is RangeSide.LOW else key.high, key.is_whole)
        end = find_end_at_zero(cache(lambda number: self._judge(key, number, [])), path)
        farthest = self._farthest(key, end, path)
        path = replace(path, bound=end.inside)
        drawn = find_end_at_zero(judge, path)
        end = end if drawn.outside is None else drawn
        others = [place for place in places if place not in few and place[1] == 0]
        for _ in range(REPAIRS):
            failing = self._failing(key, end.inside, others)
            if failing is None:
                break
            end = find_end_at_zero(
                lambda number, place=failing: self._judge(key, number, [place]),  # type: ignore[misc]
                replace(path, bound=end.inside),
            )
        return self._as_limit(key, side, end, _last_drawn(judge, end, farthest, path))

    def _judge(self, key: NumberKey, number: float, places: Sequence[Place]) -> Judgement:
        """Judge a number by checks, counted work, and warnings and scenes where there are places.

        Where there are none, warnings are not looked at either.
        """
        try:
            config = self.trial.config_with(key.key, number)
        except ConfigError as error:
            return refusal_of(error, key.key)
        if work_ratio(config, self.base_work) > SLOW:  # before its scenes are drawn
            return Judgement(Consequence.SLOWER, Origin.TIME, f"{SLOW:.0f} times the work")
        return self.trial.judge(config, places) if places else CLEAN

    def _farthest(self, key: NumberKey, end: End, path: Path) -> End:
        """Find the end of what checks accept, where counted work ends before."""
        if end.outside is None or end.judgement.effect is Consequence.REFUSED:
            return end

        def accepted(number: float) -> Judgement:
            try:
                self.trial.config_with(key.key, number)
            except ConfigError as error:
                return refusal_of(error, key.key)
            return CLEAN

        return find_end_at_zero(cache(accepted), replace(path, start=end.outside))

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

    def _as_limit(self, key: NumberKey, side: RangeSide, end: End, farthest: End) -> Limit:
        """Limit of an end; where farther numbers are accepted, say where they are not."""
        refusal = KEY_ENDS if farthest.outside is None else farthest.judgement
        if end.outside is None or end.inside == farthest.inside:
            return Limit(key.key, side, end.inside, refusal)
        beyond = end.judgement
        if beyond.effect in REFUSING:
            return Limit(key.key, side, end.inside, beyond)
        return Limit(key.key, side, end.inside, beyond, farthest.inside, refusal)

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
        work = self._work(key, limit.value)
        if work * base_s > SHARE * self.budget.left:
            return limit
        judgement, times = self._simulate(key, limit.value, places[0])
        if judgement.is_clean:
            return replace(limit, simulated=True, times=times)
        return self._nearer(key, side, limit, places[0], judgement)

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
            return Judgement(Consequence.SLOWER, Origin.TIME, reason), seconds / base_s
        return judgement, seconds / base_s

    def _work(self, key: NumberKey, number: float) -> float:
        try:
            return work_ratio(self.trial.config_with(key.key, number), self.base_work)
        except ConfigError:
            return inf

    def _nearer(
        self, key: NumberKey, side: RangeSide, limit: Limit, place: Place, judgement: Judgement
    ) -> Limit:
        """Find the end that simulation shows, between the config's own number and a limit."""
        assert limit.value is not None
        inside, outside = 0.0, 1.0
        path = Path(key.range[0 if side is RangeSide.LOW else 1], limit.value, key.is_whole)
        times: float | None = None
        for _ in range(MOST_SIMULATED):
            middle = 0.5 * (inside + outside)
            number = path.number(middle)
            if number in (path.number(inside), path.number(outside)):
                break
            tried, tried_times = self._simulate(key, number, place)
            if tried.is_clean:
                inside, times = middle, tried_times
            else:
                outside, judgement = middle, tried
        return replace(
            limit,
            value=path.number(inside),
            beyond=judgement,
            last_accepted=limit.value,
            refusal=limit.beyond,
            times=times,
            simulated=True,
        )
