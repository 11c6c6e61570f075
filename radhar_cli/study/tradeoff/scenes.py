"""Scenes that settings are compared on: samples of a config, drawn again under each setting."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import NamedTuple

from radhar_cli.config import load_config
from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.scene import Scene

# What differs most: a standing person's arms, a walk, a fall.
QUICK = ("punching", "walking", "walking_to_falling")
QUICK_SCENES = 3


class SweepSample(NamedTuple):
    """Sample of the config: slug of its activity, and number within that."""

    slug: str
    number: int = 0


@dataclass(frozen=True)
class Scenes:
    """Scenes of a sweep: samples 0 of the activities of a config file."""

    path: Path  # config file
    overrides: tuple[str, ...]  # of the command line; those of a setting come after them
    quick: bool  # whether three scenes are enough

    def config(self, further: Sequence[str] = ()) -> Config:
        """Config under further overrides.

        Raises:
            ConfigError: the overrides do not fit it.
        """
        return _config(self.path, (*self.overrides, *further))

    def samples(self) -> list[SweepSample]:
        """Samples of which the scenes are: of every activity, or three of boards or where `quick`.

        Cubes of boards of twelve scenes would fill the memory.
        """
        activities = self.config().chosen_activities
        slugs = [activity.slug for activity in activities]
        if self.quick or isinstance(self.config().radar, ArrayRadar):
            slugs = [slug for slug in slugs if slug in QUICK] or slugs[:QUICK_SCENES]
        samples = [SweepSample(slug) for slug in slugs]
        counts = {a.slug: self.config().samples_of(a) for a in activities}
        for number in range(1, QUICK_SCENES):
            further = [SweepSample(slug, number) for slug in slugs if number < counts[slug]]
            samples += further[: max(0, QUICK_SCENES - len(samples))]
        return samples

    def draw(self, sample: SweepSample, config: Config) -> Scene:
        """Scene of a sample; settings of engine, maps and image do not change it."""
        activity = next(a for a in config.chosen_activities if a.slug == sample.slug)
        return draw_valid_scene(config, activity, sample.number)[0]


@cache
def _config(path: Path, overrides: tuple[str, ...]) -> Config:
    return load_config(path, overrides)
