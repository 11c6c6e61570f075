"""Aids and loads in the hands of a walker: stick, lifted frame, rollator, box, bag.

Only the hands follow it; the aid or load itself does not scatter.
"""

from dataclasses import dataclass

import numpy as np

from radhar_cli.motion.human.arms import UPWARDS
from radhar_cli.motion.human.physique import Physique
from radhar_cli.numerics.arrays import Float

# Elbows of a person who holds a box: down and outwards; in the trunk's axes, right and left [3, 2].
DOWNWARDS = np.array([[-0.3, -0.3], [-0.35, 0.35], [-1.0, -1.0]])
STRETCHED, SOFTNESS = 0.97, 60.0  # of arms: of their length at most; of that bound, 1/m
TILT = 0.75  # of how far a hand is from above the tip of its stick, how far it is beside that
TILTED = 0.5  # most of that over the length of the stick (30 degrees)


@dataclass(frozen=True)
class HeldLoad:
    """Load before or beside the trunk: places of hands, seen from their shoulders.

    Lengths are in lengths of the stretched arm: ahead, outwards and up.
    """

    sides: tuple[int, ...]  # 0 for the right hand, 1 for the left
    place: tuple[float, float, float]

    def hands(self, body: Physique) -> Float:
        """Places of both hands relative to their shoulders, in the trunk's axes [3, 2, 1], m."""
        ahead, outwards, up = (2 * body.arm * length for length in self.place)
        return np.array([[ahead, ahead], [-outwards, outwards], [up, up]])[:, :, None]


@dataclass(frozen=True)
class Aid:
    """Aid that is set on the floor ahead, or rolled; lengths are over the stature.

    A stick is as high as the wrist of a hanging arm, so that the elbow is bent by 20 to 30 degrees
    (Kumar, Roe and Scremin, Arch. Phys. Med. Rehabil. 76 (1995) 1173), and is set down with the
    painful leg; phases, and how it is tilted, are guesses.
    """

    sides: tuple[int, ...]  # 0 for the right hand, 1 for the left
    ahead: float  # distance of the hands ahead of the hip
    beside: float  # distance of a hand beside the middle
    height: float  # height of the hands above the floor
    down: float | None = None  # phase of the stride at which it is set down; None for a rolled one
    up: float = 0.58  # how much later it is lifted, fraction of a stride
    lift: float = 0.02  # height of its swing
    tilts: bool = False  # whether it tilts about its tip, as a stick does


def limit_to_reach(body: Physique, hands: Float) -> Float:
    """Places of hands relative to their shoulders [3, 2, M] (m), drawn near where no arm reaches.

    The distance d becomes -ln(exp(-k d) + exp(-k d_max))/k.
    """
    distance = np.sqrt(np.einsum("aim,aim->im", hands, hands))
    stretched = STRETCHED * 2 * body.arm
    reached = -np.log(np.exp(-SOFTNESS * distance) + np.exp(-SOFTNESS * stretched)) / SOFTNESS
    limited: Float = hands * (reached / distance)
    return limited


def hands_of_aid(aid: Aid, body: Physique, foot: Float | None, hip_ahead: Float) -> Float:
    """Hands on an aid [3, 2, M], seen by the walker, m.

    Args:
        foot: Place of the aid's foot, ahead, to the left and up [3, M], m; None: rolled.
        hip_ahead: Distance of the hip ahead of the walker's place [M], m.
    """
    over = body.stature
    beside = np.array([[-1.0], [1.0]]) * aid.beside * over
    ahead, up = aid.ahead * over + 0 * hip_ahead, aid.height * over + 0 * hip_ahead
    if foot is not None:
        if aid.tilts:
            length = aid.height * over
            tilt = TILT * (aid.ahead * over + hip_ahead - foot[0]) / length
            tilt = tilt / (1 + (tilt / TILTED) ** 4) ** 0.25
            ahead = foot[0] + length * tilt
            up = foot[2] + length * np.sqrt(1 - tilt**2)
        else:
            ahead, up = foot[0], up + foot[2]
    return np.array([np.stack([ahead, ahead]), beside + 0 * up, np.stack([up, up])])


def elbow_directions(held: "HeldLoad | Aid") -> Float:
    """Directions in which elbows of hands that hold something bend, in the trunk's axes [3, 2]."""
    return DOWNWARDS if isinstance(held, HeldLoad) else UPWARDS
