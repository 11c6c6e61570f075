"""Joints that jump: the seconds across a jump are left out.

A network exchanges two people, or a wrist for a shadow, for some frames; a marker is labelled as
another one; a suit writes a T-pose before the movement. A joint of a person is bounded in what it
does between two frames: so far it goes in no single one, and so hard it is not accelerated.
"""

from dataclasses import replace

import numpy as np

from radhar_cli.motion.recorded.joint_frames import LostSection
from radhar_cli.motion.recorded.recording import MotionRecording
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Bool, Float

# m/s^2; more than a limb has that hits: fists of boxers reach 9 m/s (Piorkowski, Lees & Barton
# 2011) in some 0.1 s, 90 m/s^2 on the way
HARDEST = 300.0
FARTHEST = 0.1  # m; so far noise alone carries no joint
FASTEST = 30.0  # m/s, of any joint
TRUNK_FASTEST = 15.0  # m/s; sprinters run at 12
JUMP_MARGIN_S = 0.15  # before and after a jump, for which a low-pass remembers it
_SHOULDERS = ("right_shoulder", "left_shoulder")
_TRUNK = [JOINTS.index(name) for name in ("torso", "head", "hip", *_SHOULDERS)]


def find_jumps(
    file: MotionRecording, p: Float, rate: float, metres: float
) -> tuple[LostSection, ...]:
    """Find seconds in which a joint is faster, or accelerated harder, than people are.

    Args:
        file: Recording.
        p: Positions [frames, 15, 3].
        rate: Frames per second.
        metres: Length of their unit.
    """
    p = p[:, : len(JOINTS)] * metres
    steps = np.linalg.norm(np.diff(p, axis=0), axis=2)
    limits = np.full(len(JOINTS), FASTEST)
    limits[_TRUNK] = TRUNK_FASTEST
    is_jump = (steps * rate > limits) | _is_hard(p, steps, rate)
    sections = list[LostSection]()
    for step in np.flatnonzero(is_jump.any(axis=1)).tolist():
        begin, end = max(0.0, step / rate - JUMP_MARGIN_S), (step + 1) / rate + JUMP_MARGIN_S
        if sections and begin <= sections[-1].end:
            sections[-1] = replace(sections[-1], end=end)
            continue
        joint = int(np.argmax(np.where(is_jump[step], steps[step] / limits, 0)))
        jump = (
            f"{JOINTS[joint]} jumps {steps[step, joint]:.3g} m from one frame to the next "
            f"({steps[step, joint] * rate:.3g} m/s), as nobody moves"
        )
        sections.append(LostSection(JOINTS[joint], begin, end, jump, file.place(step + 1)))
    return tuple(sections)


def _is_hard(p: Float, steps: Float, rate: float) -> Bool:
    """Whether a joint is accelerated in a step [frames - 1, joints] as no joint of a person is.

    Of the steps beside a frame that is far from the middle of its neighbours, the longer one is.
    """
    off = np.linalg.norm(p[1:-1] - (p[2:] + p[:-2]) / 2, axis=2)
    is_off = off > max(FARTHEST, HARDEST / (2 * rate**2))
    is_hard = np.zeros(steps.shape, dtype=bool)
    is_hard[:-1] |= is_off & (steps[:-1] >= steps[1:])
    is_hard[1:] |= is_off & (steps[1:] >= steps[:-1])
    return is_hard
