"""BVH (Biovision hierarchy): joints with offsets, channels of positions and Euler angles.

A joint's axes are those of its parent turned by its rotation channels in the order in which they
are listed, R = R_parent R_1 R_2 R_3; its position is that of its parent plus R_parent times its
offset, or times its position channels where it has them.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.motion.files.frames import bvh_frames, stacked
from radhar_cli.motion.files.recording import (
    LONGEST_NAME,
    MAX_FRAMES,
    MAX_JOINTS,
    RATES,
    applied,
    turn,
    with_ancestors,
    wrong,
)

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

    where: str
    joints: tuple[_Joint, ...]
    rate: float
    frames: int
    data: bytes
    start: int
    line: int

    unit, at_bone_ends = None, False

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(joint.name for joint in self.joints)

    @property
    def parents(self) -> tuple[int | None, ...]:
        return tuple(joint.parent for joint in self.joints)

    @property
    def rest(self) -> Float:
        """Positions [J, 3] by the offsets alone."""
        found = np.zeros((len(self.joints), 3))
        for number, joint in enumerate(self.joints):
            found[number] = joint.offset
            if joint.parent is not None:
                found[number] += found[joint.parent]
        return found

    def place(self, frame: int) -> str:
        return f"{self.where}:{self.line + frame}"

    def positions(self, joints: Sequence[int]) -> Float:
        """Positions [frames, len(joints), 3]."""
        points = stacked(self._blocks(joints), self.where)
        if len(points) != self.frames:
            last = self.place(len(points))
            raise wrong(last, f"ends after {len(points)} frames; 'Frames:' says {self.frames}")
        return points

    def _blocks(self, wanted: Sequence[int]) -> Iterator[Float]:
        needed = with_ancestors(wanted, self.parents)
        columns = sum(len(joint.channels) for joint in self.joints)
        for values in bvh_frames(self.data, self.start, self.line, columns, self.where):
            axes: dict[int, Float] = {}
            at: dict[int, Float] = {}
            for number in needed:
                axes[number], at[number] = self._joint(number, values, axes, at)
            yield np.stack([at[number].T for number in wanted], axis=1)

    def _joint(
        self, number: int, values: Float, axes: dict[int, Float], at: dict[int, Float]
    ) -> tuple[Float, Float]:
        """Axes [3, 3, M] and position [3, M] of a joint whose parent's are known."""
        joint, count = self.joints[number], len(values)
        local = np.tile(np.array(joint.offset)[:, None], count)
        own: Float = np.tile(np.eye(3)[:, :, None], count)
        position: Float = np.zeros((3, count))
        if joint.parent is not None:
            own, position = axes[joint.parent].copy(), at[joint.parent]
        outer = own.copy()
        for column, (kind, axis) in enumerate(joint.channels, joint.first):
            if kind == "position":
                local[axis] = values[:, column]
            else:
                turn(own, axis, values[:, column])
        return own, position + applied(outer, local)


def read_bvh(data: bytes, where: str) -> Bvh:
    """Read the hierarchy of a BVH file, and where its frames begin.

    Raises:
        MotionFileError: names file, line and what is missing or odd.
    """
    motion = _MOTION.search(data, 0, MAX_HEADER)
    if motion is None:
        what = "has no line MOTION" if b"HIERARCHY" in data[:MAX_HEADER] else "is not a BVH file"
        raise wrong(where, f"{what} in its first MiB")
    joints = _hierarchy(data[: motion.start()].decode("utf-8", "replace"), where)
    line = data.count(b"\n", 0, motion.start()) + 1
    head = _FRAMES.match(data, motion.end())
    if head is None:
        raise wrong(f"{where}:{line + 1}", "should be 'Frames: N', then 'Frame Time: seconds'")
    frames = int(head[1])
    try:
        rate = 1 / float(head[2])
    except (ValueError, ZeroDivisionError):
        rate = 0.0
    last = data.count(b"\n", 0, head.end(2)) + 1
    if not RATES[0] <= rate <= RATES[1]:
        shown = head[2].decode("ascii", "replace")
        raise wrong(f"{where}:{last}", f"a frame time of {shown} s should be 0.0001 to 1 s")
    if not 0 < frames <= MAX_FRAMES:
        raise wrong(f"{where}:{line + 1}", f"has {frames} frames; should have 1 to {MAX_FRAMES}")
    # 0.033333 and 0.0083333 are rounded 1/30 and 1/120.
    rate = round(rate) if abs(rate - round(rate)) < 1e-3 * rate else rate
    return Bvh(where, joints, rate, frames, data, head.end(), last + 1)


def _hierarchy(text: str, where: str) -> tuple[_Joint, ...]:
    joints: list[_Joint] = []
    stack: list[int] = []
    pending: _Joint | None = None
    columns, begun = 0, False
    for line, written in enumerate(text.split("\n"), 1):
        place = f"{where}:{line}"
        for part in filter(None, map(str.strip, re.split(r"([{}])", written))):
            word, *rest = part.split(None, 1)
            values = rest[0].split() if rest else []
            if not begun:
                if word != "HIERARCHY":
                    raise wrong(place, f"should be HIERARCHY, is {part[:30]!r}")
                begun = True
            elif word in ("ROOT", "JOINT", "End"):
                if (word == "ROOT") != (not joints) or (joints and not stack):
                    raise wrong(place, f"{part[:30]!r} is a second tree; should be one person")
                pending = _named(word, rest, joints, stack, place)
            elif word == "{":
                if pending is None or len(joints) >= MAX_JOINTS:
                    raise wrong(place, f"{{ should follow ROOT, JOINT or End Site ({MAX_JOINTS})")
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
                raise wrong(place, f"{part[:30]!r} has no meaning here")
    if stack or not joints or not columns:
        raise wrong(f"{where}:{line}", "the hierarchy ends before its last }")
    return tuple(joints)


def _named(
    word: str, rest: list[str], joints: list[_Joint], stack: list[int], place: str
) -> _Joint:
    parent = stack[-1] if stack else None
    name = rest[0].strip() if rest else ""
    if word == "End" and parent is not None:
        name = f"{joints[parent].name}.end"
    if not 0 < len(name) <= LONGEST_NAME:
        raise wrong(place, f"a joint should have a name of 1 to {LONGEST_NAME} characters")
    return _Joint(name, parent)


def _offset(values: list[str], place: str) -> tuple[float, ...]:
    try:
        offset = tuple(map(float, values))
    except ValueError:
        offset = ()
    if len(offset) != 3 or not np.isfinite(offset).all():
        raise wrong(place, "OFFSET should have three numbers")
    return offset


def _channels(values: list[str], place: str) -> tuple[tuple[str, int], ...]:
    names = [name.lower() for name in values[1:]]
    if not values or values[0] != str(len(names)) or len(names) > 6 or len({*names}) < len(names):
        raise wrong(place, "CHANNELS should have a number up to 6 and as many different names")
    for name in names:
        if name not in _CHANNELS:
            raise wrong(place, f"{name[:30]!r} is not a channel such as Xposition or Zrotation")
    return tuple(_CHANNELS[name] for name in names)
