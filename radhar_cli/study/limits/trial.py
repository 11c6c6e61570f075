"""What a config with another number comes to: refused, warned of, drawn, simulated."""

import re
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from time import process_time
from typing import Any

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
from radhar_cli.study.limits.limit import CLEAN, Consequence, Judgement, Origin

ATTEMPTS = 8  # draws of a scene on the way to a limit, where a data set takes a thousand
SAMPLES = 2  # of each class that are drawn at a limit
NOISE_ALONE = "noise alone"
FINAL = "nothing is drawn again"
LAST_DRAW = re.compile(r"no scene inside the model in .*; the last: ")
PLACE_DRAWN = re.compile(r", with (?:people\.\d+\.)?motion\.\S+ = .*$")
REACHES = re.compile(r" \(this one reaches from .*?\)")
CURES = re.compile(r"; (?:a (?:smaller|longer|radar)|motion\.|people\.|on_invalid|their ).*$")
SAMPLE = re.compile(r"^(?:sample )?([\w.-]+/\d+): ")

Place = tuple[Activity, int]  # class of a sample, and its number within the class


@dataclass
class ConfigTrial:
    """A config file, and what it comes to with other numbers."""

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
        trial.known = {_without_numbers(line) for line in _config_lines(trial.config)}
        error: RadharError | None = None
        for activity in trial.config.chosen_activities:
            for index in range(SAMPLES):
                try:
                    flags = draw_valid_scene(trial.config, activity, index)[1]
                except RadharError as refusal:
                    error, trial.troubled[activity.slug] = refusal, _in_short(str(refusal))
                    break
                trial.known |= {_without_numbers(one) for one in _flag_lines(flags, trial.config)}
        if error is not None and len(trial.troubled) == len(trial.config.chosen_activities):
            raise error
        return trial

    def places(self, key: str, samples: int = SAMPLES) -> list[Place]:
        """Samples of every class that depends on a key: the first of each, then the second."""
        classes = [
            activity
            for activity in self.config.chosen_activities
            if activity.slug not in self.troubled
            and (not key.startswith(OF_PEOPLE) or self.config.depends_on(activity, key))
        ]
        return [(activity, index) for index in range(samples) for activity in classes]

    def config_with(self, key: str, number: float) -> Config:
        """Config with a number in place of a key's.

        Raises:
            ConfigError: it is refused.
        """
        return config_of_values(with_number(self.values, self.config, key, number), self.folder)

    def judge(self, config: Config, places: Iterable[Place]) -> Judgement:
        """Judge a config with another number, without simulating: by warnings and by scenes."""
        warned = CLEAN
        for line in _config_lines(config):
            if _without_numbers(line) not in self.known:
                source = Origin.NOISE if NOISE_ALONE in line else Origin.MODEL
                warned = Judgement(Consequence.WARNED, source, _in_short(line))
                break
        for activity, index in places:
            judgement = self.judge_scene(config, activity, index)
            if judgement.effect in (Consequence.REFUSED, Consequence.REDRAWN):
                return judgement
            warned = judgement if warned.is_clean else warned
        return warned

    def judge_scene(self, config: Config, activity: Activity, index: int) -> Judgement:
        """Judge whether a scene can be drawn, and what is warned of in it."""
        same = next((a for a in config.chosen_activities if a.slug == activity.slug), None)
        if same is None:
            return CLEAN
        try:
            with _overflows() as messages:
                flags = draw_valid_scene(config, same, index, ATTEMPTS)[1]
        except RadharError as error:
            is_redrawn = LAST_DRAW.search(str(error)) and FINAL not in str(error)
            effect = Consequence.REDRAWN if is_redrawn else Consequence.REFUSED
            return Judgement(effect, Origin.MODEL, _in_short(str(error)))
        if messages:
            return Judgement(Consequence.INEXACT, Origin.ARITHMETIC, messages[0])
        for line in _flag_lines(flags, config):
            if _without_numbers(line) not in self.known:
                return Judgement(
                    Consequence.WARNED, Origin.MODEL, f"{same.slug}: {_in_short(line)}"
                )
        return CLEAN

    def simulate(self, key: str, number: float, place: Place) -> tuple[Judgement, float]:
        """Simulate a sample; judge it, and return the processor time that it took, s."""
        config = self.config_with(key, number)
        try:
            return judge_sample(config, place)
        except RadharError as error:
            return Judgement(Consequence.REFUSED, Origin.ENGINE, _in_short(str(error))), 0.0


def judge_sample(config: Config, place: Place) -> tuple[Judgement, float]:
    """Simulate a sample; judge whether it is whole, and return the processor time, s.

    Raises:
        RadharError: it is refused.
    """
    slug, index = place[0].slug, place[1]
    activity = next(one for one in config.chosen_activities if one.slug == slug)
    scene = draw_valid_scene(config, activity, index, ATTEMPTS)[0]
    start = process_time()
    with _overflows() as messages:
        sample = synthesise(scene, plan_images(config), config)
    seconds = process_time() - start
    if messages:
        return Judgement(Consequence.INEXACT, Origin.ARITHMETIC, messages[0]), seconds
    for name, value in sample.columns.items():
        array = np.asarray(value)
        if array.dtype.kind == "f" and np.isnan(array).any() and not name.startswith("entropy/"):
            reason = f"{name} is no number"
            return Judgement(Consequence.INEXACT, Origin.ARITHMETIC, reason), seconds
    black = [name for name, image in sample.images.items() if not image.levels.any()]
    if black and not scene.is_empty:
        return Judgement(Consequence.BLACK, Origin.MODEL, ", ".join(black)), seconds
    if sample.fell_back:
        reason = "engine.tolerance_db cannot be kept"
        return Judgement(Consequence.EXACT_ENGINE, Origin.ENGINE, reason), seconds
    return CLEAN, seconds


@contextmanager
def _overflows() -> Iterator[list[str]]:
    """Context that collects what NumPy says of numbers that end: overflow, division by zero."""
    messages = list[str]()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield messages
    messages += [str(one.message) for one in caught if issubclass(one.category, RuntimeWarning)]


def _config_lines(config: Config) -> list[str]:
    return [*warnings_of_signal(config), *timing_warnings(config)]


def _flag_lines(flags: Flags, config: Config) -> list[str]:
    return [describe_flag(flag, config) for flag in Flags if flag in flags]


def _without_numbers(line: str) -> str:
    """A warning without its numbers, so that the same one of another number counts as the same."""
    return re.sub(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?", "#", line)


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
    """A message without the sample, its place and cures that it names, at most 160 characters."""
    text = LAST_DRAW.sub("", message.splitlines()[0])
    sample = SAMPLE.match(text)
    if sample is not None:
        text = f"{sample[1].partition('/')[0]}: {text[sample.end() :]}"
    text = REACHES.sub("", CURES.sub("", text))
    text = PLACE_DRAWN.sub("", text)
    return text if len(text) <= 160 else f"{text[:157]}..."
