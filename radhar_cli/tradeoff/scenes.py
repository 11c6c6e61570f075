"""The scenes of a sweep, and their samples under any setting."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from radhar_cli.config import load_config
from radhar_cli.config.schema import Config
from radhar_cli.pipeline.validity import draw_valid_scene
from radhar_cli.scene import Scene

# Of what differs most: a standing person's arms, a walk, a fall.
QUICK = ("punching", "walking", "walking_to_falling")


@dataclass(frozen=True)
class Scenes:
    """Samples 0 of the activities of a config file.

    Attributes:
        path: of the config file.
        overrides: of the command line; a setting's come after them.
        quick: whether three activities are enough.
    """

    path: Path
    overrides: tuple[str, ...]
    quick: bool

    def config(self, more: Sequence[str] = ()) -> Config:
        """The config under further overrides."""
        return _config(self.path, (*self.overrides, *more))

    def names(self) -> list[str]:
        """The activities, by slug."""
        chosen = [activity.slug for activity in self.config().chosen_activities]
        few = [slug for slug in chosen if slug in QUICK] or chosen[: len(QUICK)]
        return few if self.quick else chosen

    def draw(self, slug: str, config: Config) -> Scene:
        """Sample 0 of an activity; settings of engine, maps and image leave it as it is."""
        activity = next(a for a in config.chosen_activities if a.slug == slug)
        return draw_valid_scene(config, activity, 0)[0]


@cache
def _config(path: Path, overrides: tuple[str, ...]) -> Config:
    return load_config(path, overrides)
