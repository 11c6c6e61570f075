"""The sweep: setting after setting is compared and timed, within a budget of time."""

import os
import re
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, cached_property
from math import inf, isfinite

from radhar_cli.config.radar import ImpulseRadar
from radhar_cli.errors import RadharError
from radhar_cli.processes.progress import Progress
from radhar_cli.processes.time_limit import time_limit
from radhar_cli.study.tradeoff.differences import compare_pictures, compare_points, signal_error
from radhar_cli.study.tradeoff.floor import visible_errors
from radhar_cli.study.tradeoff.pictures import WORDS, Raw, Recorder, Shown, draw_shown
from radhar_cli.study.tradeoff.row import Row, SceneDifference
from radhar_cli.study.tradeoff.scenes import Scenes
from radhar_cli.study.tradeoff.setting import DEFAULT, Change, Overrides, Setting, Worth
from radhar_cli.study.tradeoff.settings import settings_of
from radhar_cli.study.tradeoff.sweep import Omission, Sweep
from radhar_cli.study.tradeoff.timing import LEAST_ROUNDS, Ratio, Times, time_setting
from radhar_cli.study.trials import Budget, TriedSetting, try_settings

AS_IT_IS = Setting("default", DEFAULT, effect=Change.ERROR, worth=Worth.SAVES)
EXACT = ("engine.kind=cube", "engine.precision=double")
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

    def __init__(self, recorder: Recorder, is_exact: bool) -> None:
        """Compare on the sample of a recorder, without error in the config as it is if exact."""
        self._recorder, self._is_exact = recorder, is_exact
        self._base = cache(self._draw)

    @cached_property
    def raw(self) -> Raw:
        """Raw products of the config as it is, and its noise."""
        return self._recorder.simulate((), with_noise=True)

    @cached_property
    def _exact(self) -> tuple[Raw, Shown]:
        raw = self.raw if self._is_exact else self._recorder.simulate(EXACT)
        return raw, draw_shown(raw, self.raw.noise)

    def compare(self, setting: Setting) -> SceneDifference | None:
        """Compare what a setting shows with what it should show, or with its base.

        Errors are those of pictures with the same noise on both sides. Other pictures are compared
        without noise, but for masks and settings of the noise.

        Returns:
            The difference; None where the scene under the setting is another one.

        Raises:
            RadharError: the scene cannot be simulated so.
        """
        if setting.effect is Change.ERROR:
            base_raw, base = self._exact
            if setting.overrides == EXACT[:1]:
                raw = base_raw
            elif setting.overrides:
                raw = self._recorder.simulate(setting.overrides)
            else:
                raw = self.raw
            return _difference(raw, draw_shown(raw, self.raw.noise), base_raw, base)
        if self._recorder.draw(setting.overrides).attempt != self._recorder.attempt:
            return None
        is_noisy = setting.is_noisy or self.raw.scene.config.image.kind == "cfar"
        raw, visible = self._draw(setting.overrides, is_noisy)
        return _difference(raw, visible, *self._base(setting.base, is_noisy))

    def _draw(self, overrides: Overrides, is_noisy: bool) -> tuple[Raw, Shown]:
        raw = self._recorder.simulate(overrides, is_noisy) if overrides else self.raw
        return raw, draw_shown(raw, raw.noise if is_noisy else None)


def _difference(raw: Raw, visible: Shown, base_raw: Raw, base: Shown) -> SceneDifference:
    """Difference of what a setting shows from its base."""
    name, error_db = signal_error(raw, base_raw)
    maps = {
        map_name: compare_pictures(picture, base.pictures[map_name])
        for map_name, picture in visible.pictures.items()
        if map_name in base.pictures
    }
    points = None
    if visible.cloud is not None and base.cloud is not None:
        points = compare_points(visible.cloud, base.cloud)
    return SceneDifference(WORDS.get(name, name), error_db, raw.stated_db, maps, points)


@dataclass
class TradeoffStudy:
    """A sweep of the settings of a config."""

    scenes: Scenes
    sweep: Sweep  # what is measured already, and grows
    budget: Budget
    progress: Progress  # is told of settings that are done and left out
    save: Callable[[], None]  # keeps the sweep as it is; called after every setting

    def run(self) -> None:
        """Measure what is not measured yet, as far as the time goes.

        Raises:
            RadharError: the config as it is cannot be simulated.
        """
        self.sweep.loads.append(load_average())
        settings = self._allowed_settings()
        start = time.monotonic()
        if self.sweep.row_of(DEFAULT) is None:
            row = self._measure(AS_IT_IS, inf, refuse=True)
            assert row is not None
            self.sweep.rows.append(row)
        self._tell_estimate(len(settings), time.monotonic() - start)
        self.save()
        self._measure_floors()
        waiting = [each for each in settings if self.sweep.row_of(each.name) is None]
        self.progress.stage("settings", len(settings), len(settings) - len(waiting), "setting")
        trials = try_settings(waiting, self._measure, self.budget, self.progress, SHARES)
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
    def _comparisons(self) -> list[SceneComparison]:
        config = self.scenes.config()
        is_exact = config.engine.kind == "cube" or isinstance(config.radar, ImpulseRadar)
        default = self.sweep.row_of(DEFAULT)
        samples = self.scenes.samples()[: default.scenes if default else None]
        return [SceneComparison(Recorder(self.scenes, sample), is_exact) for sample in samples]

    @cached_property
    def _level_db(self) -> float | None:
        """Decibels of a grey level; None where pictures show no decibels."""
        image = self.scenes.config().image
        return image.dynamic_range_db / 255 if image.kind == "decibel" else None

    def _allowed_settings(self) -> list[Setting]:
        """Settings that the config allows; the others are noted, with the reason."""
        settings = []
        for setting in settings_of(self.scenes.config()):
            try:
                self.scenes.config(setting.overrides)
                self.scenes.config(setting.base)
            except RadharError as error:
                self._leave_out(setting.name, error)
                continue
            settings.append(setting)
        return settings

    def _leave_out(self, name: str, error: RadharError) -> None:
        omission = Omission(name, reason_of(error))
        self.sweep.left_out.append(omission)
        self.progress.say(f"left out: {omission.name}: {omission.reason}")

    def _tell_estimate(self, count: int, seconds: float) -> None:
        """Say how long the sweep is likely to take."""
        row = self.sweep.row_of(DEFAULT)
        if row is None or row.sample_ms is None:
            return
        sample_s, samples = row.sample_ms / 1e3, len(self.scenes.samples())
        rounds = LEAST_ROUNDS if self.scenes.quick else FULL_ROUNDS
        each = sample_s * (3 * samples + 4 * rounds * min(samples, 1 + 0.3 / sample_s))
        needed = (seconds + count * each) / 60
        within = self.budget.left / 60
        limit = f", of which there are {within:.1f}" if isfinite(within) else ""
        sample = f"{count} settings; {row.sample_ms:.0f} ms a sample"
        self.progress.say(f"{sample}: about {max(needed, 0.1):.1f} minutes{limit}")

    def _measure_floors(self) -> None:
        """Find the error that images show at least, of as many scenes as there is time for."""
        if self.sweep.floor_scenes or self.budget.left == 0:
            return
        seconds = FLOOR_SHARE * self.budget.left
        with time_limit(seconds):
            for comparison in self._comparisons:
                for name, floor_db in visible_errors(comparison.raw):
                    known = self.sweep.floors.get(name, floor_db)
                    self.sweep.floors[name] = min(known, floor_db)
                self.sweep.floor_scenes += 1
        self.save()

    def _time_against_itself(self) -> None:
        """Time the config as it is against itself."""
        rounds: list[Times] = []
        if self.budget.left == 0:
            return
        with time_limit(self.budget.share(4, SHARES)):
            self._time(AS_IT_IS, rounds)
        if rounds:
            self.sweep.pairs.append(Ratio.of(rounds))

    def _measure(self, setting: Setting, limit: float, refuse: bool = False) -> Row | None:
        """Measure a setting within a time, s; None where that was too short.

        Of several scenes one that cannot be simulated is left out, but where `refuse`.

        Raises:
            RadharError: none of its scenes can be simulated.
        """
        scenes: list[SceneDifference] = []
        rounds: list[Times] = []
        notes: list[str] = []
        start, base_s = time.monotonic(), BASE_SHARE * self.budget.left
        with time_limit(limit):
            for number, comparison in enumerate(self._comparisons):
                try:
                    difference = comparison.compare(setting)
                except RadharError:
                    if refuse or (number == len(self._comparisons) - 1 and not scenes):
                        raise
                    notes.append("a scene is refused")
                    continue
                if difference is None:
                    notes.append("a scene is another one, as this one is invalid")
                else:
                    scenes.append(difference)
                if number == 0:
                    if setting is AS_IT_IS:  # whose first sample imports and fills caches
                        time_setting(self.scenes, setting, 0)
                    rounds.append(time_setting(self.scenes, setting, 0))
                spent = time.monotonic() - start
                if setting is AS_IT_IS and spent * (number + 2) / (number + 1) > base_s:
                    del self._comparisons[number + 1 :]  # which would leave no time for settings
            self._time(setting, rounds)
        if not rounds or not (scenes or notes):
            return None
        note = "; ".join(dict.fromkeys(notes))
        return Row.of(setting, Ratio.of(rounds), scenes, self._level_db, note)

    def _time(self, setting: Setting, rounds: list[Times]) -> None:
        """Add rounds of timing to some."""
        start, quick = time.monotonic(), self.scenes.quick
        most_rounds = MOST_ROUNDS if quick else FULL_ROUNDS
        while len(rounds) < most_rounds:
            spent = time.monotonic() - start
            if quick and len(rounds) >= LEAST_ROUNDS and spent > ROUNDS_S:
                break
            rounds.append(time_setting(self.scenes, setting, len(rounds)))


def load_average() -> float:
    """Load of the machine in the last minute, processes; NaN where nobody counts them."""
    with suppress(OSError, AttributeError):
        return round(os.getloadavg()[0], 2)
    return float("nan")


def reason_of(error: RadharError) -> str:
    """Reason why a config does not allow a setting: a short line without keys of the file."""
    lines: Sequence[str] = str(error).splitlines() or [""]
    reason = re.split(r"(?:^|: )should be ", lines[0], maxsplit=1)[-1]
    reason = re.sub(r"^\S+:\d+: ", "", reason)
    if reason.startswith("some of ") and ": " in reason:  # a list of names, and then why
        reason = reason.rpartition(": ")[2]
    elif reason != lines[0]:
        reason = f"should be {reason}" if "should be " in lines[0] else reason
    return reason if len(reason) <= MAX_REASON else f"{reason[:MAX_REASON].rsplit(' ', 1)[0]} ..."
