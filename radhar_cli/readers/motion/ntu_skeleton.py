"""`.skeleton` of NTU RGB+D: 25 joints of a Kinect v2 as text, 30 frames a second, several bodies.

A file is its number of frames; a frame its number of bodies; a body a line with its identity, a
line with its number of joints, and a line for each joint: x, y, z (m), eight numbers of images and
orientation, and the state of tracking, of which 0 is lost (Shahroudy et al., CVPR 2016).
"""

from collections.abc import Iterator
from typing import TypeAlias

import numpy as np

from radhar_cli.motion.recorded.joint_sets import JOINT_SETS
from radhar_cli.motion.recorded.keypoints import Keypoints, make_keypoints
from radhar_cli.motion.recorded.recording import MAX_FRAMES, motion_file_error

RATE = 30.0
MAX_TEXT = 2**26  # bytes
MAX_BODIES = 20  # in a frame
NEAR, WALK = 0.3, 2.0  # m and m/s: how far a body goes on that is counted anew
NAMES = JOINT_SETS["ntu25"].names
OFTEN = 0.5  # share of the frames of the main body from which another one is a second person


_Body: TypeAlias = dict[int, np.ndarray[tuple[int, ...], np.dtype[np.float64]]]


class _SkeletonLines:
    """Lines of a text, one after the other, by their numbers."""

    def __init__(self, data: bytes, where: str) -> None:
        self.where, self.number = where, 0
        self._lines: Iterator[bytes] = iter(data.splitlines())

    def words(self, meaning: str) -> list[bytes]:
        """Words of the next line that is not empty.

        Raises:
            MotionFileError: There is none; `meaning` says what should be there.
        """
        for line in self._lines:
            self.number += 1
            if line.strip():
                return line.split()
        raise motion_file_error(self.where, f"ends before {meaning}")

    def count(self, meaning: str, largest: int) -> int:
        """Whole number on the next line."""
        words = self.words(meaning)
        if len(words) != 1 or not words[0].isdigit() or not len(words[0]) < 9:
            raise self.error(f"should be {meaning}")
        number = int(words[0])
        if number > largest:
            raise self.error(f"{meaning} is {number}; should be at most {largest}")
        return number

    def error(self, problem: str) -> Exception:
        """Error about the line that was read last."""
        return motion_file_error(f"{self.where}:{self.number}", problem)


def read_ntu_skeleton(data: bytes, where: str) -> Keypoints:
    """Read the joints of the body that is there in most frames.

    Args:
        data: Bytes of the file.
        where: Name of the file in messages.

    Raises:
        MotionFileError: Names the line and what is odd, or two people are there.
    """
    if len(data) > MAX_TEXT:
        raise motion_file_error(where, f"is {len(data)} bytes; should be at most {MAX_TEXT}")
    lines = _SkeletonLines(data, where)
    frames = lines.count("the number of frames", MAX_FRAMES)
    bodies: dict[bytes, _Body] = {}
    for frame in range(frames):
        for _ in range(lines.count(f"the number of bodies of frame {frame + 1}", MAX_BODIES)):
            identity = lines.words("a line with a body's identity")[0]
            if lines.count("the number of joints", len(NAMES)) != len(NAMES):
                raise lines.error(f"should be {len(NAMES)} joints")
            bodies.setdefault(identity, {})[frame] = _read_joints(lines)
    if not bodies:
        raise motion_file_error(where, "has no body in any frame")
    first, *others = sorted(bodies.values(), key=len, reverse=True)
    first, others, joins = _join_bodies(first, others)
    often = [body for body in others if len(body) > OFTEN * len(first)]
    if often:
        raise motion_file_error(
            where,
            f"has {1 + len(often)} people; should be one: write the joints of one as npz "
            "(docs/guide/motion_files.md)",
        )
    values = np.full((frames, len(NAMES), 3), np.nan)
    for frame, joints in first.items():
        values[frame] = joints
    remarks = list[str]()
    if others:
        remarks.append(f"of {len(bodies)} bodies the one is taken that is there in most frames")
    if joins:
        remarks.append(
            f"a body that is lost and seen again as another, {joins} times, is one person"
        )
    return make_keypoints(where, NAMES, values, RATE, remarks=remarks)


def _join_bodies(first: _Body, others: list[_Body]) -> tuple[_Body, list[_Body], int]:
    """Join bodies that begin where another one is lost, near it: a sensor counts them anew.

    Returns:
        The main body, those that are others, and how many were joined.
    """
    joined, rest = dict(first), list[_Body]()
    for body in others:
        is_apart = joined.keys().isdisjoint(body)
        near = min(
            joined, key=lambda frame: min(abs(frame - end) for end in (min(body), max(body)))
        )
        end = min((min(body), max(body)), key=lambda frame: abs(frame - near))
        steps = np.linalg.norm(joined[near] - body[end], axis=1)
        known = steps[np.isfinite(steps)]
        far = NEAR + WALK * abs(near - end) / RATE
        if is_apart and known.size and float(np.median(known)) < far:
            joined |= body
        else:
            rest.append(body)
    return joined, rest, len(others) - len(rest)


def _read_joints(lines: _SkeletonLines) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Positions [25, 3] of a body; NaN where a joint is not tracked."""
    joints = np.full((len(NAMES), 3), np.nan)
    for row in range(len(NAMES)):
        words = lines.words("the lines of its joints")
        try:
            numbers = [float(word) for word in words]
        except ValueError:
            raise lines.error("should be numbers of a joint") from None
        if len(numbers) not in (11, 12):
            raise lines.error(f"has {len(numbers)} numbers; a joint has 12")
        if len(numbers) == 11 or numbers[11] != 0:
            joints[row] = numbers[:3]
    return joints
