"""Arms: swung from the shoulders, or with hands that are where they should be."""

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.pose import SIDES, Axes
from radhar_cli.motion.human.two_link import two_link

# To where elbows bend, ahead, left and up: of a guard, and above a floor on which the hands are.
OUTWARDS = np.concatenate([np.full((1, 2), -0.2), 0.45 * SIDES.T, np.full((1, 2), -1.0)])
STRETCHED = 0.93  # of the arm's length, which a hand on the floor does not exceed
UPWARDS = np.concatenate([np.full((1, 2), -0.9), 0.6 * SIDES.T, np.full((1, 2), -0.5)])
SOFTNESS = 25.0  # of that bound, 1/m


def swung(trunk: Axes, shoulder: Float, elbow: Float) -> tuple[Float, Float]:
    """Unit vectors of upper arms and forearms [3, 2, M] that hang from a trunk.

    Shoulders are flexed ahead and elbows by angles [2, M], right and left, rad.
    """
    angles = np.array([shoulder, shoulder + elbow])
    ahead, down = np.sin(angles), np.cos(angles)
    x, z = trunk.ahead[:, None], trunk.up[:, None]
    return ahead[0] * x - down[0] * z, ahead[1] * x - down[1] * z


def raised(trunk: Axes, shoulder: Float, elbow: Float, outwards: Float) -> tuple[Float, Float]:
    """`swung` arms that are raised outwards too, by angles [2, M], rad."""
    upper, fore = swung(trunk, shoulder, elbow)
    beside = SIDES * trunk.left[:, None]
    return (
        np.cos(outwards) * upper + np.sin(outwards) * beside,
        np.cos(outwards) * fore + np.sin(outwards) * beside,
    )


def directed(trunk: Axes, hands: Float, poles: Float, arm: float) -> tuple[Float, Float]:
    """Unit vectors of upper arms and forearms [3, 2, M] whose hands are where they should be.

    In the trunk's frame (ahead, left, up) [3, 2, M]: hands relative to the shoulders, m, and
    poles, to where the elbows bend. `arm` is the length of upper arm, and of forearm, m.
    """
    elbows = two_link(np.zeros_like(hands), hands, arm, arm, poles)
    frame = np.stack([trunk.ahead, trunk.left, trunk.up], axis=1)
    upper = np.einsum("xam,aim->xim", frame, elbows / arm)
    fore = np.einsum("xam,aim->xim", frame, (hands - elbows) / arm)
    return upper, fore


def hanging(body: Physique, shoulder: Float, elbow: Float) -> tuple[Float, Float]:
    """Hands of `swung` arms relative to the shoulders, and to where their elbows bend [3, 2, M].

    Both in the trunk's frame; flexion of shoulders and elbows [2, M], rad.
    """
    fore, nothing = shoulder + elbow, np.zeros_like(shoulder)
    hands = body.arm * np.array(
        [np.sin(shoulder) + np.sin(fore), nothing, -np.cos(shoulder) - np.cos(fore)]
    )
    return hands, np.array([-np.cos(shoulder), nothing, -np.sin(shoulder)])


def supported(
    body: Physique,
    trunk: Axes,
    shoulders: Float,
    flexion: tuple[Float, Float],
    floor: Float,
    share: Float,
    elbows: Float = UPWARDS,
) -> tuple[Float, Float]:
    """Arms between hanging (share 0) and hands on the floor (1), as far as they reach.

    A hand is on the line from shoulder to floor, at a distance below both the floor's and the
    stretched arm's: -ln(exp(-k d) + exp(-k d_max))/k. Shoulders, floor [3, 2, M] in m; flexion of
    hanging shoulders and elbows [2, M] in rad; share [M]. In the trunk's frame [3, 2] `elbows` is
    to where they bend when the hands are down.
    """
    frame = np.array([trunk.ahead, trunk.left, trunk.up])
    way = np.einsum("axm,xim->aim", frame, floor - shoulders)
    distance = np.sqrt(np.einsum("aim,aim->im", way, way))
    longest = STRETCHED * 2 * body.arm
    reached = -np.log(np.exp(-SOFTNESS * distance) + np.exp(-SOFTNESS * longest)) / SOFTNESS
    hands, poles = hanging(body, *flexion)
    hands += share * (way * (reached / distance) - hands)
    poles += share * (elbows[:, :, None] - poles)
    return directed(trunk, hands, poles, body.arm)
