"""ASF/AMC (Acclaim): a skeleton of bones, and for each frame the angles of each.

A bone's axes are R = R_parent C M C^-1 with C = R_z R_y R_x of its `axis` and M = R_z R_y R_x of
its degrees of freedom; it ends at the end of its parent plus R times its direction and length.
Lengths times 0.0254/length m (`:units`); 120 frames a second, which the file does not say.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.motion.files.frames import FRAME_NUMBER, amc_frames, stacked
from radhar_cli.motion.files.recording import (
    LONGEST_NAME,
    MAX_JOINTS,
    applied,
    turn,
    with_ancestors,
    wrong,
)

INCH = 0.0254
RATE = 120.0
MAX_SKELETON = 2**20
_TURNS = ("rx", "ry", "rz")
_MOVES = ("tx", "ty", "tz")


@dataclass
class _Bone:
    name: str
    reach: Float  # direction times length [3]
    axes: Float  # C [3, 3]
    channels: tuple[str, ...] = ()
    parent: int | None = None
    first: int = 0


@dataclass(frozen=True)
class Amc:
    """A `Recording` whose frames are read when positions are asked for; bones in tree order."""

    where: str
    tree: tuple[_Bone, ...]
    unit: float
    data: bytes
    start: int
    line: int

    rate, bones = RATE, True

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(bone.name for bone in self.tree)

    @property
    def parents(self) -> tuple[int | None, ...]:
        return tuple(bone.parent for bone in self.tree)

    @property
    def rest(self) -> Float:
        """Ends [J, 3] of the bones without rotations."""
        found = np.zeros((len(self.tree), 3))
        for number, bone in enumerate(self.tree):
            found[number] = bone.reach + (0 if bone.parent is None else found[bone.parent])
        return found

    def place(self, frame: int) -> str:
        return f"{self.where}: frame {frame + 1}"

    def positions(self, joints: Sequence[int]) -> Float:
        """Positions [frames, len(joints), 3] of ends of bones."""
        return stacked(self._blocks(joints), self.where)

    def _blocks(self, wanted: Sequence[int]) -> Iterator[Float]:
        needed = with_ancestors(wanted, self.parents)
        widths = {bone.name: len(bone.channels) for bone in self.tree if bone.channels}
        for values in amc_frames(self.data, self.start, self.line, widths, self.where):
            axes: dict[int, Float] = {}
            at: dict[int, Float] = {}
            for number in needed:
                bone = self.tree[number]
                own: Float = np.tile(np.eye(3)[:, :, None], len(values))
                begin: Float = np.zeros((3, 1))
                if bone.parent is not None:
                    own, begin = axes[bone.parent].copy(), at[bone.parent]
                angles = {
                    name: values[:, column] for column, name in enumerate(bone.channels, bone.first)
                }
                begin = begin + np.array([angles.get(name, 0 * values[:, 0]) for name in _MOVES])
                own = np.einsum("rcm,cd->rdm", own, bone.axes)
                for name in reversed(_TURNS):
                    if name in angles:
                        turn(own, _TURNS.index(name), angles[name])
                axes[number] = own = np.einsum("rcm,dc->rdm", own, bone.axes)
                at[number] = begin + applied(own, bone.reach[:, None])
            yield np.stack([at[number].T for number in wanted], axis=1)


def read_amc(data: bytes, where: str, skeleton: bytes, skeleton_where: str) -> Amc:
    """Read an AMC file with its ASF skeleton.

    Raises:
        MotionFileError: names file, line and what is missing or odd.
    """
    bones, unit, degrees = _skeleton(skeleton, skeleton_where)
    if not degrees or re.search(rb"(?mi)^:RADIANS", data[:MAX_SKELETON]):
        raise wrong(where, "has its angles in radians; should have degrees")
    first = FRAME_NUMBER.search(data)
    if first is None:
        raise wrong(where, "has no frames: no line with a frame's number")
    tree = tuple(bones)
    column = 0
    for bone in tree:
        bone.first = column
        column += len(bone.channels)
    line = data.count(b"\n", 0, first.start()) + 1
    return Amc(where, tree, unit, data, first.start(), line)


def _skeleton(data: bytes, where: str) -> tuple[list[_Bone], float, bool]:
    """Bones in tree order, length of a unit (m), whether angles are in degrees."""
    if len(data) > MAX_SKELETON:
        raise wrong(where, f"is larger than {MAX_SKELETON} bytes; a skeleton is small")
    section, length, degrees = "", 1.0, True
    bones: dict[str, _Bone] = {"root": _Bone("root", np.zeros(3), np.eye(3), (*_MOVES, *_TURNS))}
    links: list[tuple[str, list[str], int]] = []
    entry: dict[str, list[str]] = {}
    for line, text in enumerate(data.decode("utf-8", "replace").split("\n"), 1):
        words, place = text.split("#")[0].split(), f"{where}:{line}"
        if not words:
            continue
        if words[0].startswith(":"):
            section = words[0].lower()
        elif section == ":units" and words[0] == "length":
            (length,) = _numbers(words[1:], 1, place)
        elif section == ":units" and words[0] == "angle":
            degrees = words[1:2] == ["deg"]
        elif section == ":root" and words[0] == "order":
            bones["root"].channels = _channels(words[1:], place)
        elif section == ":root" and words[0] == "orientation":
            bones["root"].axes = _axes(_numbers(words[1:], 3, place), "XYZ", place)
        elif section == ":bonedata" and words[0] == "end":
            bone = _bone(entry, place)
            if bone.name in bones or len(bones) >= MAX_JOINTS:
                raise wrong(place, f"the bone {bone.name!r} is there twice, or one of too many")
            bones[bone.name], entry = bone, {}
        elif section == ":bonedata" and words[0] != "begin":
            entry[words[0]] = words[1:]
        elif section == ":hierarchy" and words[0] not in ("begin", "end"):
            links.append((words[0], words[1:], line))
    if not 1e-6 < length < 1e6:
        raise wrong(where, f"a unit of length of {length:g} should be above 0, such as 0.45")
    return _in_tree_order(bones, links, where), INCH / length, degrees


def _in_tree_order(
    bones: dict[str, _Bone], links: list[tuple[str, list[str], int]], where: str
) -> list[_Bone]:
    order = ["root"]
    for parent, children, line in links:
        for name in (parent, *children):
            if name not in bones:
                raise wrong(f"{where}:{line}", f"there is no bone {name[:30]!r}")
        if parent not in order:
            raise wrong(f"{where}:{line}", f"{parent} should hang on a bone before it has children")
        for child in children:
            if child in order:
                raise wrong(f"{where}:{line}", f"{child} hangs on two bones")
            bones[child].parent = order.index(parent)
            order.append(child)
    if len(order) < 2:
        raise wrong(where, "has no :hierarchy of bones")
    return [bones[name] for name in order]


def _bone(entry: dict[str, list[str]], place: str) -> _Bone:
    name = " ".join(entry.get("name", ()))
    if not 0 < len(name) <= LONGEST_NAME:
        raise wrong(place, "the bone that ends here should have a name")
    direction = _numbers(entry.get("direction", []), 3, place, "direction")
    (length,) = _numbers(entry.get("length", []), 1, place, "length")
    axis = entry.get("axis", ["0", "0", "0", "XYZ"])
    axes = _axes(_numbers(axis[:3], 3, place, "axis"), "".join(axis[3:4]) or "XYZ", place)
    norm = float(np.linalg.norm(direction)) or 1.0
    reach = np.array(direction) * length / norm
    return _Bone(name, reach, axes, _channels(entry.get("dof", []), place))


def _axes(angles: list[float], order: str, place: str) -> Float:
    """C [3, 3] = R_z R_y R_x for the order XYZ: the first letter turns first, about fixed axes."""
    if sorted(order.upper()) != ["X", "Y", "Z"]:
        raise wrong(place, f"axis {order[:10]!r} should be an order such as XYZ")
    found = np.eye(3)[:, :, None].copy()
    for letter, angle in reversed([*zip(order.upper(), angles, strict=True)]):
        turn(found, "XYZ".index(letter), np.array([angle]))
    return found[:, :, 0]


def _channels(words: list[str], place: str) -> tuple[str, ...]:
    names = tuple(word.lower() for word in words)
    for name in names:
        if name not in (*_MOVES, *_TURNS) or names.count(name) > 1:
            raise wrong(place, f"{name[:20]!r} should be one of {', '.join((*_MOVES, *_TURNS))}")
    return names


def _numbers(words: list[str], count: int, place: str, name: str = "") -> list[float]:
    try:
        values = [float(word) for word in words]
    except ValueError:
        values = []
    if len(values) != count or not np.isfinite(values).all():
        raise wrong(place, f"{name} should have {count} number{'s' * (count > 1)}".strip())
    return values
