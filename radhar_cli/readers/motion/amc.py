"""ASF/AMC (Acclaim): a skeleton of bones, and for each frame the angles of each.

A bone's axes are R = R_parent C M C^-1, with C of its `axis` and M of its degrees of freedom
(`dof`; of the root, `order`), both turning about fixed axes in the order in which they are listed:
for XYZ, and for rx ry rz, R_z R_y R_x. It ends at the end of its parent plus R times its direction
times its length. A unit of length is 0.0254/length m (`length` of `:units`; CMU's 0.45: 0.0564 m).
The file has no frame rate: CMU's have 120 frames a second.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from radhar_cli.motion.recorded.recording import (
    LONGEST_NAME,
    MAX_JOINTS,
    apply_axes,
    motion_file_error,
    turn,
    with_ancestors,
)
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.amc_frames import FRAME_NUMBER, amc_frames
from radhar_cli.readers.motion.frames import concatenate_blocks

INCH = 0.0254  # m
RATE = 120.0  # frames per second
MAX_SKELETON = 2**20  # bytes of an ASF
_TURNS = ("rx", "ry", "rz")
_MOVES = ("tx", "ty", "tz")


@dataclass
class _Bone:
    name: str
    reach: Float  # direction times length [3]
    axes: Float  # C [3, 3]
    channels: tuple[str, ...] = ()
    parent: int | None = None
    first: int = 0  # column of its first channel


@dataclass(frozen=True)
class Amc:
    """A `MotionRecording` of the ends of bones.

    Its frames are read when positions are asked for.
    """

    where: str  # name of the file in messages
    tree: tuple[_Bone, ...]  # bones, parents first
    unit: float  # length of a unit, m
    to_degrees: float  # factor from angles in the frames to degrees
    data: bytes
    # start, line: byte and line at which the frames begin
    start: int
    line: int
    first_frame: int  # number of the first frame

    up, rate, at_bone_ends = "y", RATE, True

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(bone.name for bone in self.tree)

    @property
    def parents(self) -> tuple[int | None, ...]:
        return tuple(bone.parent for bone in self.tree)

    def place(self, frame: int) -> str:
        return f"{self.where}: frame {self.first_frame + frame}"

    def positions(self, joints: Sequence[int]) -> Float:
        """Positions [frames, len(joints), 3] of the ends of some bones."""
        return concatenate_blocks(self._blocks(joints), self.where)

    def _blocks(self, joints: Sequence[int]) -> Iterator[Float]:
        """Positions [frames, len(joints), 3] of the ends of some bones, block by block."""
        needed = with_ancestors(joints, self.parents)
        widths = {bone.name: len(bone.channels) for bone in self.tree if bone.channels}
        for values in amc_frames(self.data, self.start, self.line, widths, self.where):
            axes: dict[int, Float] = {}
            ends: dict[int, Float] = {}
            for number in needed:
                axes[number], ends[number] = self._bone(number, values, axes, ends)
            yield np.stack([ends[number].T for number in joints], axis=1)

    def _bone(
        self, number: int, values: Float, axes: dict[int, Float], ends: dict[int, Float]
    ) -> tuple[Float, Float]:
        """Axes [3, 3, M] and end [3, M] of a bone whose parent's are known."""
        bone, count = self.tree[number], len(values)
        parent_axes: Float = np.tile(np.eye(3)[:, :, None], count)
        begin: Float = np.zeros((3, count))
        if bone.parent is not None:
            parent_axes, begin = axes[bone.parent], ends[bone.parent]
        columns = {name: values[:, c] for c, name in enumerate(bone.channels, bone.first)}
        displacement = np.array([columns.get(name, np.zeros(count)) for name in _MOVES])
        begin = begin + apply_axes(parent_axes, displacement)
        bone_axes: Float = np.einsum("rcm,cd->rdm", parent_axes, bone.axes)
        for name in reversed(bone.channels):  # the first listed turns first, about fixed axes
            if name in _TURNS:
                turn(bone_axes, _TURNS.index(name), self.to_degrees * columns[name])
        bone_axes = np.einsum("rcm,dc->rdm", bone_axes, bone.axes)
        return bone_axes, begin + apply_axes(bone_axes, bone.reach[:, None])


def read_amc(data: bytes, where: str, skeleton: bytes, skeleton_where: str) -> Amc:
    """Read an AMC file with its ASF skeleton.

    Args:
        data: Bytes of the AMC.
        where: Name of the AMC in messages.
        skeleton: Bytes of the ASF.
        skeleton_where: Name of the ASF in messages.

    Raises:
        MotionFileError: Names file, line and what is missing or odd.
    """
    asf = _read_skeleton(skeleton, skeleton_where)
    first = FRAME_NUMBER.search(data)
    if first is None:
        raise motion_file_error(
            where, "is not an AMC file: it has no line with the number of a frame"
        )
    stated_unit = re.search(rb"(?mi)^:(RADIANS|DEGREES)", data[: min(first.start(), MAX_SKELETON)])
    radians = asf.radians if stated_unit is None else stated_unit[1].upper() == b"RADIANS"
    column = 0
    for bone in asf.tree:
        bone.first = column
        column += len(bone.channels)
    if not column:
        raise motion_file_error(
            skeleton_where, "has no bone that moves: no dof, and no order of the root"
        )
    factor = 180 / np.pi if radians else 1.0
    line = data.count(b"\n", 0, first.start()) + 1
    return Amc(where, asf.tree, asf.unit, factor, data, first.start(), line, int(first[1]))


@dataclass(frozen=True)
class _Skeleton:
    tree: tuple[_Bone, ...]  # parents first
    unit: float  # m
    radians: bool


def _read_skeleton(data: bytes, where: str) -> _Skeleton:
    """Read the bones of an ASF."""
    section, length, radians, order = "", 1.0, False, "XYZ"
    bones: dict[str, _Bone] = {"root": _Bone("root", np.zeros(3), np.eye(3), (*_MOVES, *_TURNS))}
    orientation = [0.0, 0.0, 0.0]  # of the root
    links: list[tuple[str, list[str], int]] = []
    entry: dict[str, list[str]] = {}
    for line, text in enumerate(data.decode("utf-8", "replace").split("\n"), 1):
        words, place = text.split("#")[0].split(), f"{where}:{line}"
        if not words:
            continue
        word, values = words[0], words[1:]
        if word.startswith(":"):
            section = word.lower()
        elif section == ":units" and word == "length":
            (length,) = _numbers(values, 1, place)
            if not 1e-6 < length < 1e6:
                raise motion_file_error(
                    place, f"a length of {length:g} should be above 0, such as 0.45"
                )
        elif section == ":units" and word == "angle":
            if values[:1] not in (["deg"], ["rad"]):
                raise motion_file_error(place, "angle should be deg or rad")
            radians = values[0] == "rad"
        elif section == ":root" and word == "order":
            bones["root"].channels = _channels(values, place)
        elif section == ":root" and word == "axis":
            order = "".join(values[:1])
        elif section == ":root" and word == "orientation":
            orientation = _numbers(values, 3, place)
        elif section == ":bonedata" and word == "end":
            bone = _bone(entry, radians, place)
            if bone.name in bones or len(bones) >= MAX_JOINTS:
                bone_name = bone.name[:30]
                raise motion_file_error(
                    place, f"the bone {bone_name!r} is there twice, or one of too many"
                )
            bones[bone.name], entry = bone, {}
        elif section == ":bonedata" and word != "begin":
            entry[word] = values
        elif section == ":hierarchy" and word not in ("begin", "end"):
            links.append((word, values, line))
    bones["root"].axes = _axes(orientation, order, radians, where)
    return _Skeleton(_in_tree_order(bones, links, where), INCH / length, radians)


def _in_tree_order(
    bones: dict[str, _Bone], links: list[tuple[str, list[str], int]], where: str
) -> tuple[_Bone, ...]:
    """Hang bones on each other by links (parent, children, line), and order them parents first."""
    places = {"root": 0}
    for parent, children, line in links:
        for name in (parent, *children):
            if name not in bones:
                raise motion_file_error(f"{where}:{line}", f"there is no bone {name[:30]!r}")
        if parent not in places:
            raise motion_file_error(
                f"{where}:{line}", f"{parent} should hang on a bone before it has children"
            )
        for child in children:
            if child in places:
                raise motion_file_error(f"{where}:{line}", f"{child} hangs on two bones")
            bones[child].parent = places[parent]
            places[child] = len(places)
    if len(places) < 2:
        raise motion_file_error(where, "is not an ASF file: it has no :hierarchy of bones")
    return tuple(bones[name] for name in places)


def _bone(entry: dict[str, list[str]], radians: bool, place: str) -> _Bone:
    """Make a bone of the words under its `begin`."""
    name = " ".join(entry.get("name", ()))
    if not 0 < len(name) <= LONGEST_NAME or not name.isascii() or " " in name:
        raise motion_file_error(
            place,
            f"the bone that ends here should have a name of 1 to {LONGEST_NAME} letters, digits "
            "and signs",
        )
    direction = _numbers(entry.get("direction", []), 3, place, "direction")
    (length,) = _numbers(entry.get("length", []), 1, place, "length")
    axis = entry.get("axis", ["0", "0", "0", "XYZ"])
    angles, order = _numbers(axis[:3], 3, place, "axis"), "".join(axis[3:4]) or "XYZ"
    norm = float(np.linalg.norm(direction)) or 1.0
    reach = np.array(direction) / norm * length
    channels = _channels(entry.get("dof", []), place)
    return _Bone(name, reach, _axes(angles, order, radians, place), channels)


def _axes(angles: list[float], order: str, radians: bool, place: str) -> Float:
    """Axes C [3, 3], R_z R_y R_x for the order XYZ: the first letter turns first, about fixed axes.

    Angles are listed in the order of the letters.
    """
    if sorted(order.upper()) != ["X", "Y", "Z"]:
        raise motion_file_error(place, f"axis {order[:10]!r} should be an order such as XYZ")
    turned = np.eye(3)[:, :, None].copy()
    factor = 180 / np.pi if radians else 1.0
    for letter, angle in reversed([*zip(order.upper(), angles, strict=True)]):
        turn(turned, "XYZ".index(letter), np.array([factor * angle]))
    return turned[:, :, 0]


def _channels(words: list[str], place: str) -> tuple[str, ...]:
    """Check the names of a bone's degrees of freedom."""
    names = tuple(word.lower() for word in words[:7])
    for name in names:
        if name not in (*_MOVES, *_TURNS) or names.count(name) > 1:
            raise motion_file_error(
                place, f"{name[:20]!r} should be one of {', '.join((*_MOVES, *_TURNS))}, once"
            )
    return names


def _numbers(words: list[str], count: int, place: str, name: str = "") -> list[float]:
    """Read so many numbers; an error names what they are."""
    try:
        values = [float(word) for word in words[: count + 1]]
    except ValueError:
        values = []
    if len(values) != count or not all(abs(value) < 1e9 for value in values):
        raise motion_file_error(
            place, f"{name} should have {count} number{'s' * (count > 1)}".strip()
        )
    return values
