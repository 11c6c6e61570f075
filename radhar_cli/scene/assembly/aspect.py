"""Aspect of a person: the angle between where they face and the line of sight to a radar."""

import numpy as np

from radhar_cli.motion.protocol import Motion
from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.propagation import Antennas
from radhar_cli.scene.assembly.motion import moving
from radhar_cli.scene.assembly.radar import antennas_of
from radhar_cli.scene.scene import Person, Scene

SHOULDERS = ("right_shoulder", "left_shoulder")


def aspect_of(motion: Motion, antennas: Antennas, t: Float) -> Float:
    """Angle from where a person faces to the middle of the antennas, in the horizontal plane, rad.

    A person faces square to the line of the shoulders, their left being to the left. Someone at
    aspect 0 faces the radar, at pi or -pi has their back to it; it is positive where the radar is
    to their left.

    Args:
        motion: motion of the person.
        antennas: antennas of the radar.
        t: times [M], s.

    Returns:
        Angles [M] from -pi to pi; NaN where no shoulders are known.
    """
    if not set(SHOULDERS) <= set(motion.names):
        return np.full(t.size, np.nan)
    positions, torso = motion.positions(t), motion.torso(t)[:2, 0]
    right, left = (positions[:2, motion.names.index(name)] for name in SHOULDERS)
    to_left = left - right
    facing = np.arctan2(-to_left[0], to_left[1])
    to_radar = np.mean(antennas.places, axis=0)[:2, None] - torso
    angle = np.arctan2(to_radar[1], to_radar[0]) - facing
    wrapped: Float = np.arctan2(np.sin(angle), np.cos(angle))
    return wrapped


def aspect_at_middle(scene: Scene, person: Person) -> float:
    """Aspect of a person of a scene to its radar in the middle of the recording, rad."""
    t = np.array([scene.seconds / 2])
    return float(aspect_of(moving(person), antennas_of(scene), t)[0])
