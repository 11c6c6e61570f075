"""A clip that is repeated: where its end goes over into its beginning, and where people are then.

The seam lies where the end of the clip is most like its beginning, as the transitions of motion
graphs do (Kovar, Gleicher and Pighin 2002). Over half a second one cycle fades into the next. Where
people stand and how they are turned at the end of a cycle is where the next begins: walkers
walk on, and turns go on.
"""

from dataclasses import dataclass
from math import atan2, cos, floor, pi, sin

import numpy as np

from radhar_cli.motion.recorded.clip import Clip
from radhar_cli.motion.recorded.recording import motion_file_error
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float

BLEND = 0.5  # s in which one cycle fades into the next
SHORTEST = 0.5  # least share of the section that a cycle has
LEAST_FRAMES = 12
COMPARED = 9  # number of instants of a seam that are compared
STRAIGHT = pi / 12  # turns from cycle to cycle below this are none: people walk on straight
_HIP = JOINTS.index("hip")
_RIGHT = [JOINTS.index("right_shoulder"), len(JOINTS)]
_LEFT = [JOINTS.index("left_shoulder"), len(JOINTS) + 1]


@dataclass(frozen=True)
class Cycle:
    """The seconds of a clip that are repeated.

    From `begin` on for `blend` seconds a cycle fades in, while the one before it goes on from
    `begin + period` to the end of its seconds.
    """

    begin: float  # second of the clip
    period: float  # time from the beginning of a cycle to that of the next, s
    blend: float  # time in which a cycle fades in, s
    gap: float  # largest distance of a joint from where the next cycle has it, over the stature

    @property
    def end(self) -> float:
        """Second of the clip beyond which nothing of it is used."""
        return self.begin + self.period + self.blend


def find_cycle(clip: Clip, begin: float, end: float) -> Cycle:
    """Find the longest part of a section that fits best to itself at its ends, at least half of it.

    Args:
        clip: Recording.
        begin: Beginning of the section, s.
        end: End of the section, s.

    Raises:
        MotionFileError: The section is too short to be repeated.
    """
    first, last = int(np.ceil(begin * clip.rate - 1e-9)), floor(end * clip.rate + 1e-9)
    last = min(last, len(clip.positions) - 1)
    count = last - first + 1
    if count < LEAST_FRAMES or (last - first) / clip.rate < BLEND:
        raise motion_file_error(
            clip.where,
            f"has {max(0, last - first) / clip.rate:.3g} s to repeat (past_end: loop); should have "
            f"{BLEND:g} s and {LEAST_FRAMES} frames or more",
        )
    blend = max(2, min(round(BLEND * clip.rate), (count - 1) // 4))  # frames
    p = clip.positions[first : last + 1]
    poses = _in_own_axes(p)
    offsets = np.unique(np.linspace(0, blend, COMPARED).round().astype(int))
    periods = np.arange(int(SHORTEST * (count - 1)), count - blend)
    error = np.zeros(len(periods))
    for offset in offsets:
        difference = poses[periods + offset] - poses[offset]
        error += np.einsum("fja,fja->f", difference, difference)
    # of seams as good as the best but for a millimetre in the mean, the last
    is_best = error <= error.min() + offsets.size * p.shape[1] * 1e-6
    period = int(periods[np.flatnonzero(is_best)[-1]])
    seam = np.arange(blend + 1)
    carried_seam = carry(p[seam], *carry_between(p[seam], p[seam + period]))
    gap = float(np.linalg.norm(carried_seam - p[seam + period], axis=2).max())
    return Cycle(first / clip.rate, period / clip.rate, blend / clip.rate, gap)


def carry_between(early: Float, late: Float) -> tuple[float, Float]:
    """Turn about the vertical (rad) and shift [2] that bring poses to others, in least squares.

    Args:
        early: Positions [frames, joints, 3].
        late: Positions of the same joints; heights do not matter.
    """
    a, b = early[..., :2].reshape(-1, 2), late[..., :2].reshape(-1, 2)
    centre_a, centre_b = a.mean(axis=0), b.mean(axis=0)
    a, b = a - centre_a, b - centre_b
    turn = atan2(float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()), float((a * b).sum()))
    turn = 0.0 if abs(turn) < STRAIGHT else turn
    return turn, centre_b - _turned(centre_a, turn)


def carry(p: Float, turn: float, shift: Float) -> Float:
    """Positions [..., 3] turned about the vertical through the origin (rad) and shifted [2]."""
    moved = p.copy()
    moved[..., :2] = _turned(p[..., :2], turn) + shift
    return moved


def repeated_carry(turn: float, shift: Float, times: int) -> tuple[float, Float]:
    """Turn (rad) and shift [2] of a carry that is repeated so many times."""
    total = np.zeros(2)
    for _ in range(times):
        total = _turned(total, turn) + shift
    return turn * times, total


def _turned(xy: Float, angle: float) -> Float:
    c, s = cos(angle), sin(angle)
    turned: Float = xy @ np.array([[c, s], [-s, c]])
    return turned


def _in_own_axes(p: Float) -> Float:
    """Positions [frames, 15, 3] about the hip, with x ahead of the body; heights stay."""
    left = (p[:, _LEFT] - p[:, _RIGHT])[..., :2].sum(axis=1)
    angle = np.arctan2(-left[:, 0], left[:, 1])  # of what is ahead: left turned by -90 degrees
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    x, y = (p[..., axis] - p[:, _HIP, None, axis] for axis in (0, 1))
    return np.stack([c * x + s * y, c * y - s * x, p[..., 2]], axis=2)
