"""Arms: swung from the shoulders, or with hands that are where they should be."""

import numpy as np

from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.pose import SIDES, Axes
from radhar_cli.motion.human.two_link import two_link
from radhar_cli.numerics.arrays import Float

# Directions in which elbows bend, ahead, left and up: in a guard; with hands on the floor, over it
# and along it.
OUTWARDS = np.concatenate([np.full((1, 2), -0.2), 0.45 * SIDES.T, np.full((1, 2), -1.0)])
STRETCHED = 0.93  # of the arm's length, which a hand on the floor does not exceed
UPWARDS = np.concatenate([np.full((1, 2), -0.9), 0.6 * SIDES.T, np.full((1, 2), -0.5)])
ALONG_FLOOR = np.concatenate([np.full((1, 2), -0.1), 1.0 * SIDES.T, np.full((1, 2), -0.4)])
SOFTNESS = 25.0  # of that bound, 1/m


def arm_directions(trunk: Axes, shoulder: Float, elbow: Float) -> tuple[Float, Float]:
    """Unit vectors of upper arms and forearms [3, 2, M] that hang from a trunk.

    Args:
        shoulder: Flexion ahead of the right and left shoulder [2, M], rad.
        elbow: Flexion of the elbows [2, M], rad.
    """
    angles = np.array([shoulder, shoulder + elbow])
    ahead, down = np.sin(angles), np.cos(angles)
    x, z = trunk.ahead[:, None], trunk.up[:, None]
    return ahead[0] * x - down[0] * z, ahead[1] * x - down[1] * z


def raised_arm_directions(
    trunk: Axes, shoulder: Float, elbow: Float, outwards: Float
) -> tuple[Float, Float]:
    """Unit vectors [3, 2, M] of `arm_directions` raised outwards by angles [2, M], rad."""
    upper, fore = arm_directions(trunk, shoulder, elbow)
    beside = SIDES * trunk.left[:, None]
    return (
        np.cos(outwards) * upper + np.sin(outwards) * beside,
        np.cos(outwards) * fore + np.sin(outwards) * beside,
    )


def arm_directions_to_hands(
    trunk: Axes, hands: Float, poles: Float, arm: float
) -> tuple[Float, Float]:
    """Unit vectors of upper arms and forearms [3, 2, M] between shoulders and hands.

    Args:
        hands: Hands relative to the shoulders, in the trunk's axes (ahead, left, up) [3, 2, M], m.
        poles: Directions in which the elbows bend, in the trunk's axes [3, 2, M].
        arm: Length of the upper arm, and of the forearm, m.
    """
    elbows = two_link(np.zeros_like(hands), hands, arm, arm, poles)
    frame = np.stack([trunk.ahead, trunk.left, trunk.up], axis=1)
    upper = np.einsum("xam,aim->xim", frame, elbows / arm)
    fore = np.einsum("xam,aim->xim", frame, (hands - elbows) / arm)
    return upper, fore


def hanging_hands(body: Physique, shoulder: Float, elbow: Float) -> tuple[Float, Float]:
    """Place hands that hang by angles, and return the directions in which their elbows bend.

    Args:
        shoulder: Flexion of the right and left shoulder [2, M], rad.
        elbow: Flexion of the elbows [2, M], rad.

    Returns:
        Hands relative to the shoulders (m) and directions, both in the trunk's axes [3, 2, M].
    """
    fore, zero = shoulder + elbow, np.zeros_like(shoulder)
    hands = body.arm * np.array(
        [np.sin(shoulder) + np.sin(fore), zero, -np.cos(shoulder) - np.cos(fore)]
    )
    return hands, np.array([-np.cos(shoulder), zero, -np.sin(shoulder)])


def arm_directions_near_floor(
    body: Physique,
    trunk: Axes,
    shoulders: Float,
    flexion: tuple[Float, Float],
    floor: Float,
    share: Float,
    elbows: Float = UPWARDS,
) -> tuple[Float, Float]:
    """Unit vectors of arms between hanging (share 0) and hands on the floor (1), if they reach.

    A hand is on the line from shoulder to floor, at a distance below both the floor's and the
    stretched arm's: -ln(exp(-k d) + exp(-k d_max))/k.

    Args:
        shoulders: Right and left shoulder [3, 2, M], m.
        flexion: Flexion of shoulders and of elbows where the arms hang, each [2, M], rad.
        floor: Points on the floor that the hands reach for [3, 2, M], m.
        share: Share of the way of the hands to the floor [M].
        elbows: Directions in which the elbows bend with hands on the floor, in the trunk's axes [3,
            2] or [3, 2, M].

    Returns:
        Upper arms and forearms [3, 2, M].
    """
    frame = np.array([trunk.ahead, trunk.left, trunk.up])
    to_floor = np.einsum("axm,xim->aim", frame, floor - shoulders)
    distance = np.sqrt(np.einsum("aim,aim->im", to_floor, to_floor))
    stretched = STRETCHED * 2 * body.arm
    reached = -np.log(np.exp(-SOFTNESS * distance) + np.exp(-SOFTNESS * stretched)) / SOFTNESS
    hands, poles = hanging_hands(body, *flexion)
    hands += share * (to_floor * (reached / distance) - hands)
    poles += share * ((elbows if elbows.ndim == 3 else elbows[:, :, None]) - poles)
    return arm_directions_to_hands(trunk, hands, poles, body.arm)
