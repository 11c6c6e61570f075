"""A person who makes movements as usual: keys at their middle, nothing that differs by chance."""

from dataclasses import dataclass

import numpy as np

from radhar_cli.config import Config
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.motion.human.part import Movement
from radhar_cli.motion.movements.catalogue import MOVEMENTS, name_of
from radhar_cli.motion.movements.kind import S
from radhar_cli.scene.scene import nominal_scene


@dataclass(frozen=True)
class UsualMover:
    """The `Mover` of a nominal scene."""

    name: str
    duration: float
    place: int = 0
    seconds: float = 6.0
    stature: float = 1.7
    is_in_bed: bool = False

    def numbers(self, section: type[S]) -> S:
        """Numbers of a nominal scene of the movement."""
        config = Config.model_validate({"activities": [self.name]})
        numbers: S = getattr(
            nominal_scene(config, activity_named(self.name)).config.motion, name_of(section)
        )
        return numbers

    def stream(self, name: str) -> np.random.Generator:
        """Random stream, the same for every name."""
        return np.random.default_rng(1)


def usual_movement(name: str, duration: float | None = None) -> Movement:
    """Make a movement as usual, within its usual duration or another one (s)."""
    kind = MOVEMENTS[name]
    seconds = duration if duration is not None else kind.seconds
    assert seconds is not None
    return kind.make(UsualMover(name, seconds))
