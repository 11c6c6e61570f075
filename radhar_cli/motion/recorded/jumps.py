"""Joints that jump: away and back within half a second is bridged as gaps are, else left out.

A network exchanges two people, or a wrist for a shadow, for some frames; a marker is labelled as
another one. A joint of a person is bounded in what it does between two frames: so far it goes in
no single one from rest, and so hard it is not accelerated.
"""

from dataclasses import replace

import numpy as np

from radhar_cli.motion.recorded.gaps import BRIDGED_S, bridge_gaps, true_runs
from radhar_cli.motion.recorded.joint_frames import MIN_FRAMES, LostSection
from radhar_cli.motion.recorded.recording import MotionRecording
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Bool, Float

# m/s^2; more than a limb has that hits: fists of boxers reach 9 m/s (Piorkowski, Lees & Barton
# 2011) in some 0.1 s, 90 m/s^2 on the way
HARDEST = 300.0
FARTHEST = 0.1  # m; so far noise alone carries no joint
FAST = 11.0  # m/s; a joint that is faster in one frame, but not in those beside it, has jumped
FASTEST = 30.0  # m/s, of any joint
TRUNK_FASTEST = 15.0  # m/s; sprinters run at 12
JUMP_MARGIN_S = 0.15  # before and after a jump, for which a low-pass remembers it
OPPOSITE = -0.8  # most cosine of a jump and the one that undoes it
WALK = 3.0  # m/s, at which a joint may have gone on in the meantime
_SHOULDERS = ("right_shoulder", "left_shoulder")
_TRUNK = [JOINTS.index(name) for name in ("torso", "head", "hip", *_SHOULDERS)]
STILL = 0.001  # m; farther no joint goes in a pose that is held
ABRUPT = 3.0  # times as far in a frame as in the frame before


def find_poses_apart(p: Float, rate: float, metres: float) -> tuple[int, int, tuple[str, ...]]:
    """Find poses at the ends that are no part of the movement, such as a T-pose before it.

    They are held, for a frame or more, and in the frame beside them somebody is elsewhere at once.

    Args:
        p: Positions [frames, joints, 3].
        rate: Frames per second.
        metres: Length of their unit.

    Returns:
        First and last frame of the movement, and remarks on the frames that are left out.
    """
    first, after = _held_frames(p * metres, rate), _held_frames(p[::-1] * metres, rate)
    if len(p) - first - after < MIN_FRAMES:
        return 0, len(p) - 1, ()
    remarks = list[str]()
    for count, word, so in (
        (first, "first", f"; seconds count from frame {first + 1}"),
        (after, "last", ""),
    ):
        if count:
            frames = "frame is" if count == 1 else f"{count} frames are"
            remarks.append(
                f"its {word} {frames} left out, a pose apart such as the T-pose of a suit{so}"
            )
    return first, len(p) - 1 - after, tuple(remarks)


def bridge_jumps(p: Float, rate: float, metres: float) -> tuple[Float, Bool]:
    """Positions in which joints that jump away and back are bridged by monotone cubics.

    Args:
        p: Positions [frames, joints, 3].
        rate: Frames per second.
        metres: Length of their unit.

    Returns:
        Positions [frames, joints, 3], and whether each joint was elsewhere [frames, joints].
    """
    is_away = np.stack(
        [_frames_away(p[:, joint] * metres, rate) for joint in range(p.shape[1])], axis=1
    )
    if not is_away.any():
        return p, is_away
    known = np.where(is_away[..., None], np.nan, p)
    bridged = bridge_gaps(known, np.arange(len(p)) / rate, rate).positions
    return np.where(np.isfinite(bridged), bridged, p), is_away


def describe_jumps(is_away: Bool, rate: float) -> tuple[str, ...]:
    """Describe the frames that are bridged, and the joints that jump in them; () without any.

    Args:
        is_away: Whether each joint was elsewhere [frames, joints].
        rate: Frames per second.
    """
    joints = [joint for joint in range(len(JOINTS)) if is_away[:, joint].any()]
    if not is_away.any():
        return ()
    frames = int(is_away.any(axis=1).sum())
    names = ", ".join(JOINTS[joint] for joint in joints[:5]) + ", ..." * (len(joints) > 5)
    return (
        f"joints jump away and back within {BRIDGED_S:g} s in {frames} frames of {1 / rate:.3g} s, "
        f"which are bridged: {names or 'hip joints'}",
    )


def find_jumps(
    file: MotionRecording, p: Float, rate: float, metres: float, first: int = 0
) -> tuple[LostSection, ...]:
    """Find seconds in which a joint is faster than people are.

    Args:
        p: Positions [frames, 15, 3].
        rate: Frames per second.
        metres: Length of their unit.
        first: Frame of the recording that is the first of the positions.
    """
    steps = np.linalg.norm(np.diff(p[:, : len(JOINTS)], axis=0), axis=2) * metres
    limits = np.full(len(JOINTS), FASTEST)
    limits[_TRUNK] = TRUNK_FASTEST
    is_fast = steps * rate > limits
    fast = np.flatnonzero(is_fast.any(axis=1))
    sections = list[LostSection]()
    for step in fast.tolist():
        begin, end = max(0.0, step / rate - JUMP_MARGIN_S), (step + 1) / rate + JUMP_MARGIN_S
        if sections and begin <= sections[-1].end:
            sections[-1] = replace(sections[-1], end=end)
            continue
        joint = int(np.argmax(np.where(is_fast[step], steps[step] / limits, 0)))
        jump = (
            f"{JOINTS[joint]} jumps {steps[step, joint]:.3g} m from one frame to the next "
            f"({steps[step, joint] * rate:.3g} m/s); should move {limits[joint]:g} m/s at most"
        )
        sections.append(LostSection(JOINTS[joint], begin, end, jump, file.place(first + step + 1)))
    return tuple(sections)


def _held_frames(p: Float, rate: float) -> int:
    """Number of frames p [frames, joints, 3] (m) for which a pose is held that ends by a jump."""
    is_other = np.linalg.norm(p - p[0], axis=2).max(axis=1) > STILL
    count = int(np.argmax(is_other))
    if not 0 < count < len(p) - 1:
        return 0
    leave, onward = np.linalg.norm(np.diff(p[count - 1 : count + 2], axis=0), axis=2)
    is_abrupt = (leave > FARTHEST) & (leave > ABRUPT * onward)
    is_hard = (leave - onward) * rate**2 > HARDEST
    is_whole = bool((is_abrupt & (leave * rate > FAST)).all())  # at few frames a second
    return count if is_whole or (is_abrupt & is_hard).any() else 0


def _frames_away(p: Float, rate: float) -> Bool:
    """Frames [frames] in which a joint p [frames, 3] (m) is away, between a jump and one back."""
    is_away = np.zeros(len(p), dtype=bool)
    spread = np.linalg.norm(p[1:-1] - (p[2:] + p[:-2]) / 2, axis=1)
    is_spike = (spread > FARTHEST) & (2 * spread * rate**2 > HARDEST)
    back = np.linalg.norm(p[2:] - p[:-2], axis=1)
    is_away[1:-1] = is_spike & (back < spread)
    steps = np.linalg.norm(np.diff(p, axis=0), axis=1)
    before = np.concatenate([[0.0], steps[:-1]])
    after = np.concatenate([steps[1:], [0.0]])
    far = steps > max(FAST / rate, FARTHEST)
    leaves = np.flatnonzero(far & (steps > ABRUPT * before))
    returns = np.flatnonzero(far & (steps > ABRUPT * after))
    longest = int(BRIDGED_S * rate)
    for leave in leaves:
        for place in returns[(returns > leave) & (returns <= leave + longest)]:
            if _comes_back(p, int(leave), int(place), rate):
                is_away[leave + 1 : place + 1] = True
                break
    return _short_runs(is_away, longest)


def _comes_back(p: Float, leave: int, place: int, rate: float) -> bool:
    """Whether the step after a frame is undone by the step after a later one, but for a walk."""
    out, back = p[leave + 1] - p[leave], p[place + 1] - p[place]
    sizes = float(np.linalg.norm(out)), float(np.linalg.norm(back))
    walk = float(np.linalg.norm(p[place + 1] - p[leave]))
    is_opposite = float(out @ back) < OPPOSITE * sizes[0] * sizes[1]
    return bool(walk < max(min(sizes) / 2, is_opposite * WALK * (place + 1 - leave) / rate))


def _short_runs(mask: Bool, longest: int) -> Bool:
    """Mask without the runs that are too long to be bridged, or at an end."""
    short = np.zeros_like(mask)
    for first, last in true_runs(mask):
        if first and last < len(mask) - 1 and last - first < longest:
            short[first : last + 1] = True
    return short
