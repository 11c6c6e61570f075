"""Judgement of a config with another number: refused, warned of, drawn, simulated."""

import re
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from time import process_time
from typing import Any, TypeAlias

import numpy as np

from radhar_cli.config.checks.doubts import timing_warnings
from radhar_cli.config.data_set import Config
from radhar_cli.config.reading import config_of_values, load_config, read_values
from radhar_cli.dataset.sample import synthesise
from radhar_cli.errors import ConfigError, RadharError
from radhar_cli.motion.activities.activity import Activity
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.checks.flags import Flags, describe_flag
from radhar_cli.scene.checks.warnings import warnings_of_signal
from radhar_cli.scene.products.table import plan_images
from radhar_cli.study.limits.keys import OF_PEOPLE, with_number

ATTEMPTS = 8  # draws of a scene on the way to a limit, where a data set takes a thousand
SAMPLES = 2  # of each class that are drawn at a limit
NOISE_ALONE = "noise alone"
FINAL = "nothing is drawn again"
LAST_DRAW = re.compile(r"no scene inside the model in .*; the last: ")
SAMPLE = re.compile(r"^(?:sample )?([\w.-]+)/\d+: ")
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
# What a message says of this sample alone, and how it might be cured.
DETAILS = re.compile(
    r" \(this one reaches from .*?\)|, with (?:people\.\d+\.)?motion\.\S+ = .*$"
    r"|; (?:a (?:smaller|longer|radar)|motion\.|people\.|on_invalid|their ).*$"
)
MOST_WORDS = 160  # characters of a reason

Place: TypeAlias = tuple[Activity, int]  # class of a sample, and its number within the class


class Consequence(StrEnum):
    """Consequence of a number beyond a limit."""

    REFUSED = "refused"
    WARNED = "warned"
    REDRAWN = "drawn again, in vain"
    SLOWER = "slower"
    EXACT_ENGINE = "computed by the exact engine"
    BLACK = "a map is black"
    INEXACT = "numbers end"


class Origin(StrEnum):
    """Origin of a limit."""

    KEY = "bounds of the key"
    MODEL = "model"
    NOISE = "noise"
    ENGINE = "engine"
    ARITHMETIC = "arithmetic"
    TIME = "time"


@dataclass(frozen=True)
class Judgement:
    """Consequence of another number in a config, with its origin and reason."""

    effect: Consequence | None = None  # what happens; None where it is as with the present number
    source: Origin = Origin.MODEL  # what has ended
    reason: str = ""

    @property
    def is_clean(self) -> bool:
        """Whether nothing happens that does not happen with the present number."""
        return self.effect is None

    @property
    def is_refused(self) -> bool:
        """Whether there is no sample."""
        return self.effect in (Consequence.REFUSED, Consequence.REDRAWN)

    @property
    def sentence(self) -> str:
        """Consequence and reason, as they stand in brackets."""
        return f"{self.reason}: {self.effect}" if self.reason else f"{self.effect}"


CLEAN = Judgement()


@dataclass
class ConfigTrial:
    """A config file, and its judgements with other numbers."""

    values: dict[str, Any]  # plain values of the file
    folder: Path
    config: Config
    known: set[str] = field(default_factory=set)  # warnings of it, without their numbers
    # classes whose scenes cannot be drawn with it, and why
    troubled: dict[str, str] = field(default_factory=dict)

    @classmethod
    def of_file(cls, path: Path, overrides: Iterable[str]) -> "ConfigTrial":
        """Read a config file and draw its scenes.

        Raises:
            ConfigError: it is no config; the message names file and line.
            SceneError: no class of it has a scene that can be drawn.
        """
        overrides = tuple(overrides)
        load_config(path, overrides)
        return cls.of_values(read_values(path, overrides), path.parent)

    @classmethod
    def of_values(cls, values: dict[str, Any], folder: Path) -> "ConfigTrial":
        """Make a config of plain values and draw its scenes; motion files are named from a folder.

        Raises:
            ConfigError: it is no config.
            SceneError: no class of it has a scene that can be drawn.
        """
        trial = cls(values, folder, config_of_values(values, folder))
        lines, error = _config_lines(trial.config), None
        for activity in trial.config.chosen_activities:
            try:
                for index in range(SAMPLES):
                    flags = draw_valid_scene(trial.config, activity, index)[1]
                    lines += _flag_lines(flags, trial.config)
            except RadharError as refusal:
                error, trial.troubled[activity.slug] = refusal, _in_short(str(refusal))
        if error is not None and len(trial.troubled) == len(trial.config.chosen_activities):
            raise error
        trial.known = {NUMBER.sub("#", line) for line in lines}
        return trial

    def places(self, key: str) -> list[Place]:
        """Samples of every class that depends on a key: the first of each, then the second."""
        classes = [
            activity
            for activity in self.config.chosen_activities
            if activity.slug not in self.troubled
            and (not key.startswith(OF_PEOPLE) or self.config.depends_on(activity, key))
        ]
        return [(activity, index) for index in range(SAMPLES) for activity in classes]

    def config_with(self, key: str, number: float) -> Config:
        """Config with a number in place of a key's.

        Raises:
            ConfigError: it is refused.
        """
        return config_of_values(with_number(self.values, self.config, key, number), self.folder)

    def judge(self, config: Config, places: Iterable[Place]) -> Judgement:
        """Judge a config with another number, without simulating: by warnings and by scenes."""
        warned, line = CLEAN, self._first_new(_config_lines(config))
        if line is not None:
            source = Origin.NOISE if NOISE_ALONE in line else Origin.MODEL
            warned = Judgement(Consequence.WARNED, source, _in_short(line))
        for place in places:
            judgement = self.judge_scene(config, place)
            if judgement.is_refused:
                return judgement
            warned = judgement if warned.is_clean else warned
        return warned

    def judge_scene(self, config: Config, place: Place) -> Judgement:
        """Judge whether a scene can be drawn, and what is warned of in it."""
        (slug, index), classes = (place[0].slug, place[1]), config.chosen_activities
        activity = next((each for each in classes if each.slug == slug), None)
        if activity is None:
            return CLEAN
        try:
            with _overflows() as messages:
                flags = draw_valid_scene(config, activity, index, ATTEMPTS)[1]
        except RadharError as error:
            is_redrawn = LAST_DRAW.search(str(error)) and FINAL not in str(error)
            effect = Consequence.REDRAWN if is_redrawn else Consequence.REFUSED
            return Judgement(effect, Origin.MODEL, _in_short(str(error)))
        if messages:
            return Judgement(Consequence.INEXACT, Origin.ARITHMETIC, messages[0])
        line = self._first_new(_flag_lines(flags, config))
        if line is None:
            return CLEAN
        return Judgement(Consequence.WARNED, Origin.MODEL, f"{slug}: {_in_short(line)}")

    def _first_new(self, lines: Iterable[str]) -> str | None:
        """First of some warnings that the config itself does not give, whatever their numbers."""
        return next((line for line in lines if NUMBER.sub("#", line) not in self.known), None)


def judge_sample(config: Config, place: Place) -> tuple[Judgement, float]:
    """Simulate a sample; judge whether it is whole, and return the processor time, s."""
    slug, start = place[0].slug, process_time()
    try:
        activity = next(each for each in config.chosen_activities if each.slug == slug)
        scene = draw_valid_scene(config, activity, place[1], ATTEMPTS)[0]
        start = process_time()
        with _overflows() as messages:
            sample = synthesise(scene, plan_images(config), config)
    except RadharError as error:
        return Judgement(Consequence.REFUSED, Origin.ENGINE, _in_short(str(error))), 0.0
    seconds = process_time() - start
    for name, value in sample.columns.items():
        array = np.asarray(value)
        if array.dtype.kind == "f" and np.isnan(array).any() and not name.startswith("entropy/"):
            messages.append(f"{name} is no number")
    black = [name for name, image in sample.images.items() if not image.levels.any()]
    judgement = CLEAN
    if messages:
        judgement = Judgement(Consequence.INEXACT, Origin.ARITHMETIC, messages[0])
    elif black and not scene.is_empty:
        judgement = Judgement(Consequence.BLACK, Origin.MODEL, ", ".join(black))
    elif sample.fell_back:
        reason = "engine.tolerance_db cannot be kept"
        judgement = Judgement(Consequence.EXACT_ENGINE, Origin.ENGINE, reason)
    return judgement, seconds


@contextmanager
def _overflows() -> Iterator[list[str]]:
    """Context that collects what NumPy says of numbers that end: overflow, division by zero."""
    messages = list[str]()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield messages
    messages += [str(each.message) for each in caught if issubclass(each.category, RuntimeWarning)]


def _config_lines(config: Config) -> list[str]:
    return [*warnings_of_signal(config), *timing_warnings(config)]


def _flag_lines(flags: Flags, config: Config) -> list[str]:
    return [describe_flag(flag, config) for flag in Flags if flag in flags]


def refusal_of(error: ConfigError, key: str) -> Judgement:
    """Judgement of a config that is refused: what would be right, and of which key if of another.

    The line of a message that names the key counts, else the first.
    """
    lines = str(error).splitlines()
    line = next((line for line in lines if line.startswith(f"{key} ")), lines[0])
    named, _, end = line.partition(" = ")
    right = end.partition(": ")[2]
    if named != key:
        right = f"{named} {right}" if right else line
    source = Origin.KEY if named == key and end else Origin.MODEL
    return Judgement(Consequence.REFUSED, source, _in_short(right or line))


def _in_short(message: str) -> str:
    """A message without the sample, its place and cures that it names."""
    text = SAMPLE.sub(r"\1: ", LAST_DRAW.sub("", message.splitlines()[0]))
    text = DETAILS.sub("", text)
    return text if len(text) <= MOST_WORDS else f"{text[: MOST_WORDS - 3]}..."
