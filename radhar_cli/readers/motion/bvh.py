"""BVH (Biovision hierarchy): joints with offsets, channels of positions and Euler angles.

A joint's axes are those of its parent turned by its rotation channels in the order in which they
are listed, R = R_parent R_1 R_2 R_3; its position is that of its parent plus R_parent times its
offset, or times its position channels where it has them.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from radhar_cli.files.plain_text import decode_text
from radhar_cli.motion.recorded.plain_names import END_SITE
from radhar_cli.motion.recorded.recording import (
    LONGEST_NAME,
    MAX_FRAMES,
    MAX_JOINTS,
    RATES,
    apply_axes,
    motion_file_error,
    turn,
    with_ancestors,
)
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.frames import bvh_frames, concatenate_blocks

MAX_HEADER = 2**20
_CHANNELS = {
    f"{axis}{kind}": (kind, "xyz".index(axis))
    for axis in "xyz"
    for kind in ("position", "rotation")
}
_MOTION = re.compile(rb"(?m)^[ \t]*MOTION[ \t\r]*$")
_FRAMES = re.compile(
    rb"\s*Frames:[ \t]*(\d{1,18})[ \t\r]*\n\s*Frame Time:[ \t]*(\S{1,40})[ \t\r]*(?:\n|$)"
)


@dataclass
class _Joint:
    name: str
    parent: int | None
    offset: tuple[float, ...] = (0.0, 0.0, 0.0)
    channels: tuple[tuple[str, int], ...] = ()
    first: int = 0  # column of its first channel


@dataclass(frozen=True)
class Bvh:
    """A `MotionRecording` whose frames are read when positions are asked for."""

    where: str  # name of the file in messages
    joints: tuple[_Joint, ...]  # parents first
    rate: float  # frames per second
    frames: int  # number of frames
    data: bytes
    # start, line: byte and line at which the frames begin
    start: int
    line: int

    # Y is up by convention; a unit is what its program has.
    up, unit, at_bone_ends = "y", None, False

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(joint.name for joint in self.joints)

    @property
    def parents(self) -> tuple[int | None, ...]:
        return tuple(joint.parent for joint in self.joints)

    def place(self, frame: int) -> str:
        return f"{self.where}:{self.line + frame}"

    def positions(self, joints: Sequence[int]) -> Float:
        """Positions [frames, len(joints), 3] of some joints."""
        points = concatenate_blocks(self._blocks(joints), self.where)
        if len(points) != self.frames:
            last = self.place(len(points))
            raise motion_file_error(
                last, f"ends after {len(points)} frames; 'Frames:' says {self.frames}"
            )
        return points

    def _blocks(self, joints: Sequence[int]) -> Iterator[Float]:
        """Positions [frames, len(joints), 3] of some joints, block by block."""
        needed = with_ancestors(joints, self.parents)
        columns = sum(len(joint.channels) for joint in self.joints)
        for values in bvh_frames(self.data, self.start, self.line, columns, self.where):
            axes: dict[int, Float] = {}
            points: dict[int, Float] = {}
            for number in needed:
                axes[number], points[number] = self._joint(number, values, axes, points)
            yield np.stack([points[number].T for number in joints], axis=1)

    def _joint(
        self, number: int, values: Float, axes: dict[int, Float], points: dict[int, Float]
    ) -> tuple[Float, Float]:
        """Axes [3, 3, M] and position [3, M] of a joint whose parent's are known."""
        joint, count = self.joints[number], len(values)
        local = np.tile(np.array(joint.offset)[:, None], count)
        joint_axes: Float = np.tile(np.eye(3)[:, :, None], count)
        position: Float = np.zeros((3, count))
        if joint.parent is not None:
            joint_axes, position = axes[joint.parent].copy(), points[joint.parent]
        parent_axes = joint_axes.copy()
        for column, (kind, axis) in enumerate(joint.channels, joint.first):
            if kind == "position":
                local[axis] = values[:, column]
            else:
                turn(joint_axes, axis, values[:, column])
        return joint_axes, position + apply_axes(parent_axes, local)


def read_bvh(data: bytes, where: str) -> Bvh:
    """Read the hierarchy of a BVH file, and where its frames begin.

    Args:
        data: Bytes of the file.
        where: Name of the file in messages.

    Raises:
        MotionFileError: Names file, line and what is missing or odd.
    """
    motion = _MOTION.search(data, 0, MAX_HEADER)
    if motion is None:
        problem = "has no line MOTION" if b"HIERARCHY" in data[:MAX_HEADER] else "is not a BVH file"
        raise motion_file_error(where, f"{problem} in its first MiB")
    try:
        header = decode_text(data[: motion.start()])
    except ValueError as error:
        raise motion_file_error(where, str(error)) from None
    joints = _hierarchy(header, where)
    line = data.count(b"\n", 0, motion.start()) + 1
    head = _FRAMES.match(data, motion.end())
    if head is None:
        raise motion_file_error(
            f"{where}:{line + 1}", "should be 'Frames: N', then 'Frame Time: seconds'"
        )
    frames = int(head[1])
    try:
        rate = 1 / float(head[2])
    except (ValueError, ZeroDivisionError):
        rate = 0.0
    last = data.count(b"\n", 0, head.end(2)) + 1
    if not RATES[0] <= rate <= RATES[1]:
        frame_time = head[2].decode("ascii", "replace")
        raise motion_file_error(
            f"{where}:{last}", f"a frame time of {frame_time} s should be 0.0001 to 1 s"
        )
    if not 0 < frames <= MAX_FRAMES:
        raise motion_file_error(
            f"{where}:{line + 1}", f"has {frames} frames; should have 1 to {MAX_FRAMES}"
        )
    # 0.033333 and 0.0083333 are rounded 1/30 and 1/120.
    rate = round(rate) if abs(rate - round(rate)) < 1e-3 * rate else rate
    return Bvh(where, joints, rate, frames, data, head.end(), last + 1)


def _hierarchy(text: str, where: str) -> tuple[_Joint, ...]:
    """Read the joints of the text before MOTION, parents first."""
    joints: list[_Joint] = []
    stack: list[int] = []
    pending: _Joint | None = None
    columns, has_begun = 0, False
    for line, line_text in enumerate(text.split("\n"), 1):
        place = f"{where}:{line}"
        for part in filter(None, map(str.strip, re.split(r"([{}])", line_text))):
            word, *further_words = part.split(None, 1)
            values = further_words[0].split() if further_words else []
            if not has_begun:
                if word != "HIERARCHY":
                    raise motion_file_error(place, f"should be HIERARCHY, is {part[:30]!r}")
                has_begun = True
            elif word in ("ROOT", "JOINT", "End"):
                if (word == "ROOT") != (not joints) or (joints and not stack):
                    raise motion_file_error(
                        place, f"{part[:30]!r} is a second tree; should be one person"
                    )
                pending = _make_joint(word, further_words, joints, stack, place)
            elif word == "{":
                if pending is None or len(joints) >= MAX_JOINTS:
                    raise motion_file_error(
                        place, f"{{ should follow ROOT, JOINT or End Site ({MAX_JOINTS})"
                    )
                stack.append(len(joints))
                joints.append(pending)
                pending = None
            elif word == "}" and stack:
                stack.pop()
            elif word == "OFFSET" and stack:
                joints[stack[-1]].offset = _offset(values, place)
            elif word == "CHANNELS" and stack:
                joint = joints[stack[-1]]
                joint.channels, joint.first = _channels(values, place), columns
                columns += len(joint.channels)
            else:
                raise motion_file_error(place, f"{part[:30]!r} has no meaning here")
    if stack or not joints or not columns:
        raise motion_file_error(f"{where}:{line}", "the hierarchy ends before its last }")
    return tuple(joints)


def _make_joint(
    word: str, name_words: list[str], joints: list[_Joint], stack: list[int], place: str
) -> _Joint:
    """Make the joint of a line ROOT, JOINT or End Site, which hangs on the last of the stack."""
    parent = stack[-1] if stack else None
    name = name_words[0].strip() if name_words else ""
    if word == "End" and parent is not None:
        name = f"{joints[parent].name}{END_SITE}"
    if not 0 < len(name) <= LONGEST_NAME:
        raise motion_file_error(
            place, f"a joint should have a name of 1 to {LONGEST_NAME} characters"
        )
    return _Joint(name, parent)


def _offset(values: list[str], place: str) -> tuple[float, ...]:
    try:
        offset = tuple(map(float, values))
    except ValueError:
        offset = ()
    if len(offset) != 3 or not np.isfinite(offset).all():
        raise motion_file_error(place, "OFFSET should have three numbers")
    return offset


def _channels(values: list[str], place: str) -> tuple[tuple[str, int], ...]:
    names = [name.lower() for name in values[1:]]
    if not values or values[0] != str(len(names)) or len(names) > 6 or len({*names}) < len(names):
        raise motion_file_error(
            place, "CHANNELS should have a number up to 6 and as many different names"
        )
    for name in names:
        if name not in _CHANNELS:
            raise motion_file_error(
                place, f"{name[:30]!r} is not a channel such as Xposition or Zrotation"
            )
    return tuple(_CHANNELS[name] for name in names)
