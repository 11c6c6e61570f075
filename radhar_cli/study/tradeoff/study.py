"""The sweep: setting after setting is compared and timed, within a budget of time."""

import os
import re
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, cached_property
from textwrap import shorten
from time import process_time

from radhar_cli.config.radar import ImpulseRadar
from radhar_cli.errors import RadharError
from radhar_cli.processes.progress import Progress
from radhar_cli.scene.products.run import run
from radhar_cli.scene.products.table import plan_images
from radhar_cli.study.tradeoff.differences import SceneDifference, compare_scene, visible_errors
from radhar_cli.study.tradeoff.samples import Raw, ScenePlace, Scenes, Shown, draw_shown
from radhar_cli.study.tradeoff.settings import (
    AS_IT_IS,
    CUBE,
    DEFAULT,
    Change,
    Overrides,
    Setting,
    settings_of,
)
from radhar_cli.study.tradeoff.sweep import LEAST_ROUNDS, Omission, Ratio, Row, Sweep
from radhar_cli.study.trials import Budget, TriedSetting, last_within, try_settings

EXACT = (*CUBE, "engine.precision=double")
ROUND_S = 0.6  # length of a round of a setting at which no further scene is begun
MOST_ROUNDS, FULL_ROUNDS = 7, 9  # with --quick, and without
ROUNDS_S = 2.0  # of the rounds of a setting with --quick, beyond the least number
PAIRS_EVERY = 6  # settings between two timings of the config against itself
LEAST_PAIRS = 4
FLOOR_SHARE = 0.12  # of the budget
BASE_SHARE = 0.25  # of the budget, in which scenes are compared as they are; at least one is
SHARES = 3.0  # of its equal part of the time left that a setting may take
MAX_REASON = 100  # characters


class SceneComparison:
    """Compares settings on one sample; what several of them refer to is made once."""

    def __init__(self, place: ScenePlace) -> None:
        self._place, self._show = place, cache(self._simulate)

    @cached_property
    def raw(self) -> Raw:
        """Raw products of the config as it is, and its noise."""
        return self._place.simulate((), with_noise=True)

    @cached_property
    def _exact(self) -> tuple[Raw, Shown]:
        """Exact sum in float64, with the noise of the config."""
        config = self._place.scenes.config()
        is_exact = config.engine.kind == "cube" or isinstance(config.radar, ImpulseRadar)
        raw = self.raw if is_exact else self._place.simulate(EXACT)
        return raw, draw_shown(raw, self.raw.noise)

    def compare(self, setting: Setting) -> SceneDifference | None:
        """Compare the pictures and points of a setting with the exact ones, or with its base.

        Errors are those of pictures with the same noise on both sides. Other pictures are compared
        without noise, but for masks and settings of the noise.

        Returns:
            The difference; None where the scene under the setting is another one.

        Raises:
            RadharError: the scene cannot be simulated so.
        """
        if setting.effect is Change.ERROR:
            raw, base = self.raw, self._exact
            if setting.overrides:
                is_base = setting.overrides == CUBE
                raw = base[0] if is_base else self._place.simulate(setting.overrides)
            return compare_scene(raw, draw_shown(raw, self.raw.noise), *base)
        if self._place.draw(setting.overrides).attempt != self.raw.scene.attempt:
            return None
        is_noisy = setting.is_noisy or self.raw.scene.config.image.kind == "cfar"
        base = self._show(setting.base, is_noisy)
        return compare_scene(*self._simulate(setting.overrides, is_noisy), *base)

    def _simulate(self, overrides: Overrides, is_noisy: bool) -> tuple[Raw, Shown]:
        raw = self._place.simulate(overrides, is_noisy) if overrides else self.raw
        return raw, draw_shown(raw, raw.noise if is_noisy else None)


@dataclass
class TradeoffStudy:
    """A sweep of the settings of a config."""

    scenes: Scenes
    sweep: Sweep  # what is measured already, and grows
    budget: Budget
    progress: Progress  # is told of settings that are done and left out
    save: Callable[[], None]  # keeps the sweep as it is; called after every setting

    def run(self) -> None:
        """Measure the missing rows, as far as the time goes.

        Raises:
            RadharError: the config as it is cannot be simulated.
        """
        self.sweep.loads.append(load_average())
        settings = self.allowed_settings()
        if self.sweep.row_of(DEFAULT) is None:
            *_, row = self.measure(AS_IT_IS)
            self.sweep.rows.append(row)
        self.save()
        self._measure_floors()
        waiting = [setting for setting in settings if self.sweep.row_of(setting.name) is None]
        self.progress.stage("settings", len(settings), len(settings) - len(waiting), "setting")
        trials = try_settings(waiting, self.measure, self.budget, self.progress, SHARES)
        for number, trial in enumerate(trials):
            self._keep(trial)
            if number % PAIRS_EVERY == 0:
                self._time_against_itself()
        while len(self.sweep.pairs) < LEAST_PAIRS and self.budget.left > 0:
            self._time_against_itself()
        self.sweep.loads.append(load_average())
        self.save()

    def _keep(self, trial: TriedSetting[Setting, Row]) -> None:
        """Keep the row of a setting, or the reason why it has none."""
        name = trial.setting.name
        if trial.refusal is not None:
            self._leave_out(name, trial.refusal)
        elif trial.result is not None:
            self.sweep.rows.append(trial.result)
        else:
            reason = f"more than {trial.seconds:.0f} s" if trial.seconds else "no time was left"
            self.sweep.unmeasured.append(Omission(name, reason))
        self.save()

    @cached_property
    def comparisons(self) -> list[SceneComparison]:
        """Comparisons on the scenes: all, or as many as those of the config as it is."""
        default = self.sweep.row_of(DEFAULT)
        return [*map(SceneComparison, self.scenes.samples()[: default.scenes if default else None])]

    @cached_property
    def _level_db(self) -> float | None:
        """Decibels of a grey level; None where pictures show no decibels."""
        image = self.scenes.config().image
        return image.dynamic_range_db / 255 if image.kind == "decibel" else None

    def allowed_settings(self) -> list[Setting]:
        """Settings that the config allows; the others are noted, with the reason."""
        settings = []
        for setting in settings_of(self.scenes.config()):
            try:
                self.scenes.config(setting.overrides)
                self.scenes.config(setting.base)
            except RadharError as error:
                self._leave_out(setting.name, error)
            else:
                settings.append(setting)
        return settings

    def _leave_out(self, name: str, error: RadharError) -> None:
        omission = Omission(name, reason_of(error))
        self.sweep.left_out.append(omission)
        self.progress.say(f"left out: {omission.name}: {omission.reason}")

    def _measure_floors(self) -> None:
        """Find the error that images show at least, of as many scenes as there is time for."""
        if self.sweep.floor_scenes or self.budget.left == 0:
            return
        floors = self.sweep.floors_db

        def measure() -> Iterator[int]:
            for number, comparison in enumerate(self.comparisons, 1):
                for name, floor_db in visible_errors(comparison.raw):
                    floors[name] = min(floors.get(name, floor_db), floor_db)
                yield number

        self.sweep.floor_scenes = last_within(FLOOR_SHARE * self.budget.left, measure()) or 0
        self.save()

    def _time_against_itself(self) -> None:
        """Time the config as it is against itself."""
        if self.budget.left == 0:
            return
        seconds, rounds = self.budget.share(4, SHARES), self._time(AS_IT_IS, [])
        ratio = last_within(seconds, rounds)
        self.sweep.pairs += [] if ratio is None else [ratio]

    def measure(self, setting: Setting) -> Iterator[Row]:
        """Yield the row of a setting: of ever more scenes, then of more rounds of timing.

        Of several scenes one that cannot be simulated is left out, but for the config as it is.

        Raises:
            RadharError: none of its scenes can be simulated.
        """
        scenes, rounds, notes = (
            list[SceneDifference](),
            list[tuple[float, float]](),
            dict[str, None](),
        )
        start, base_s = time.monotonic(), BASE_SHARE * self.budget.left

        def row(ratio: Ratio) -> Row:
            return Row.of(setting, ratio, scenes, self._level_db, "; ".join(notes))

        for number, comparison in enumerate(self.comparisons, 1):
            try:
                difference = comparison.compare(setting)
            except RadharError:
                if setting is AS_IT_IS or (number == len(self.comparisons) and not scenes):
                    raise
                notes["a scene is refused"] = None
                continue
            if difference is None:
                notes["a scene is another one, as this one is invalid"] = None
            else:
                scenes.append(difference)
            if not rounds:
                if setting is AS_IT_IS:  # whose first sample imports and fills caches
                    time_setting(self.scenes, setting, 0)
                rounds.append(time_setting(self.scenes, setting, 0))
            yield row(Ratio.of(rounds))
            spent = time.monotonic() - start
            if setting is AS_IT_IS and spent * (number + 1) / number > base_s:
                del self.comparisons[number:]  # which would leave no time for settings
        yield from map(row, self._time(setting, rounds))

    def _time(self, setting: Setting, rounds: list[tuple[float, float]]) -> Iterator[Ratio]:
        """Time a setting in further rounds, and yield the ratio of all of them after each."""
        start, quick = time.monotonic(), self.scenes.quick
        while len(rounds) < (MOST_ROUNDS if quick else FULL_ROUNDS):
            if quick and len(rounds) >= LEAST_ROUNDS and time.monotonic() - start > ROUNDS_S:
                break
            rounds.append(time_setting(self.scenes, setting, len(rounds)))
            yield Ratio.of(rounds)


def time_setting(scenes: Scenes, setting: Setting, turn: int) -> tuple[float, float]:
    """Time a setting and its base in turns, scene by scene: ms a sample, and ratio.

    Args:
        turn: number of the round, which decides with which scene it begins.
    """
    places = scenes.samples()
    setting_s = base_s = 0.0
    for step in range(turn, turn + len(places)):
        place = places[step % len(places)]
        if step % 2:
            base_s += sample_seconds(place, setting.base)
        setting_s += sample_seconds(place, setting.overrides)
        if not step % 2:
            base_s += sample_seconds(place, setting.base)
        if setting_s + base_s > ROUND_S:
            break
    return 1e3 * setting_s / (step - turn + 1), setting_s / base_s


def sample_seconds(place: ScenePlace, overrides: Overrides) -> float:
    """Processor time of a sample: drawn, checked, simulated, and its images made, s."""
    steps = plan_images(place.scenes.config(overrides))
    start = process_time()
    run(steps, {"scene": place.draw(overrides)})
    return process_time() - start


def load_average() -> float | None:
    """Load of the machine in the last minute, processes; None where nobody counts them."""
    with suppress(OSError, AttributeError):
        return round(os.getloadavg()[0], 2)
    return None


def reason_of(error: RadharError) -> str:
    """Reason why a config does not allow a setting: a short line without its place in the file."""
    line = (str(error).splitlines() or [""])[0]
    right = line.partition(": should be ")[2]
    reason = re.sub(r"^some of [^:]*: ", "", right)  # a list of names, and then why
    if reason == right:
        reason = f"should be {right}" if right else re.sub(r"^\S+:\d+: ", "", line)
    return shorten(reason, MAX_REASON, placeholder=" ...")
