"""Our motions as BVH, for Blender and others: Mixamo's names, y up, cm, degrees.

The rest pose stands with its arms to the sides. Each joint turns, from its parent's axes, the
shortest way in which its bones point as they should (several bones: the best fit, Kabsch 1976).
Where a link changes its length, as at a torso that breathes, the joint has position channels too.
"""

from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np

from radhar_cli.motion.recorded.names import HIP_JOINTS
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float

PER_METRE = 100.0
STIFF = 1e-8  # m; links that change less have no position channels
_EULER: Literal["ZXY"] = "ZXY"


class _Node(NamedTuple):
    name: str
    joint: str
    parent: int | None
    # where its link points in the rest pose: y up, z ahead, x left
    rest: tuple[float, float, float]


_ARM = (("Arm", "shoulder"), ("ForeArm", "elbow"), ("Hand", "hand"))
_LEG = (("UpLeg", "hip_joint"), ("Leg", "knee"), ("Foot", "ankle"))


def _make_nodes() -> Iterator[_Node]:
    """Nodes in the order of the file, parents first."""
    yield _Node("Hips", "hip", None, (0, 0, 0))
    yield _Node("Spine2", "torso", 0, (0, 1, 0))
    yield _Node("Head", "head", 1, (0, 1, 0))
    number = 3  # in the order of the file: what hangs on the torso, then what hangs on the hips
    for parent, parts in ((1, _ARM), (0, _LEG)):
        for side, x in (("Right", -1.0), ("Left", 1.0)):
            for place, (bone, joint) in enumerate(parts):
                out = (x, float(parent), 0.0)
                along = (x, 0.0, 0.0) if parent else (0.0, -1.0, 0.0)
                above, rest = (number - 1, along) if place else (parent, out)
                yield _Node(side + bone, f"{side.lower()}_{joint}", above, rest)
                number += 1


NODES = tuple(_make_nodes())
_NUMBERS = [(*JOINTS, *HIP_JOINTS).index(node.joint) for node in NODES]


def bvh_text(positions: Float, rate: float) -> str:
    """Write a BVH file of joints over frames; each link comes back to 1e-7 m.

    Args:
        positions: The thirteen joints, then right and left hip joint [frames, 15, 3], m; x ahead, y
            left, z up.
        rate: Frames per second.
    """
    p = PER_METRE * positions[:, _NUMBERS][..., [1, 2, 0]]  # x left, y up, z ahead
    parents = [node.parent for node in NODES]
    links = p - p[:, [0 if parent is None else parent for parent in parents]]
    directions = np.array([node.rest for node in NODES], dtype=float)
    length = np.linalg.norm(directions, axis=1, keepdims=True)
    directions /= np.where(length > 0, length, 1)
    rest = directions * np.linalg.norm(links, axis=2).mean(axis=0)[:, None]
    columns: list[Float] = []
    channels: list[list[str]] = []
    axes: list[Float] = []
    for number, parent in enumerate(parents):
        parent_axes = np.tile(np.eye(3), (len(p), 1, 1)) if parent is None else axes[parent]
        children = [n for n, other_parent in enumerate(parents) if other_parent == number]
        axes.append(_fit_axes(parent_axes, rest[children], links[:, children]))
        local = p[:, number] if parent is None else _to_local(parent_axes, links[:, number])
        moves = parent is None or np.ptp(local, axis=0).max() > STIFF * PER_METRE
        if moves:
            columns.append(local)
        else:
            rest[number] = local.mean(axis=0)
        if children or moves:
            columns.append(_euler_angles(parent_axes, axes[number]))
        names = ["Xposition", "Yposition", "Zposition"] if moves else []
        channels.append(names + [f"{a}rotation" for a in _EULER] if children or moves else [])
    rows = np.concatenate(columns, axis=1)
    head = "\n".join(["HIERARCHY", *_hierarchy_lines(0, rest, channels, ""), "MOTION"])
    lines = "\n".join(" ".join(f"{value:.7f}" for value in row) for row in rows.tolist())
    return f"{head}\nFrames: {len(p)}\nFrame Time: {1 / rate:.10f}\n{lines}\n"


def _to_local(axes: Float, vectors: Float) -> Float:
    """Vectors R^T v [frames, 3] in axes [frames, 3, 3]."""
    local: Float = np.einsum("frc,fr->fc", axes, vectors)
    return local


def _fit_axes(outer: Float, rest: Float, links: Float) -> Float:
    """Axes [frames, 3, 3] that point `rest` [children, 3] along `links` [frames, children, 3]."""
    from scipy.spatial.transform import Rotation

    local = np.einsum("frc,fkr->fkc", outer, links)
    sizes = np.linalg.norm(rest, axis=1)
    if not (sizes > 0).any():
        return outer
    if len(rest) == 1:
        a = rest[0] / sizes[0]
        b = local[:, 0] / np.linalg.norm(local[:, 0], axis=1, keepdims=True)
        axis, cosine = np.cross(a, b), b @ a
        size = np.linalg.norm(axis, axis=1, keepdims=True)
        angle = np.arctan2(size, cosine[:, None])
        vector = np.where(size > 1e-15, axis / np.maximum(size, 1e-15), 0.0) * angle
        return outer @ Rotation.from_rotvec(vector).as_matrix()
    u, _, vh = np.linalg.svd(np.einsum("fkr,kc->frc", local, rest))
    u[:, :, 2] *= np.sign(np.linalg.det(u @ vh))[:, None]
    fitted: Float = outer @ (u @ vh)
    return fitted


def _euler_angles(outer: Float, axes: Float) -> Float:
    """Angles [frames, 3] in degrees, of the rotation channels in their order."""
    from scipy.spatial.transform import Rotation

    inner = np.einsum("frc,frd->fcd", outer, axes)
    return Rotation.from_matrix(inner).as_euler(_EULER, degrees=True)


def _hierarchy_lines(
    number: int, rest: Float, channels: list[list[str]], indent: str
) -> Iterator[str]:
    """Lines of the hierarchy from one node on."""
    node, names = NODES[number], channels[number]
    inner = indent + "  "
    yield f"{indent}{'ROOT' if node.parent is None else 'JOINT'} {node.name}"
    yield indent + "{"
    yield f"{inner}OFFSET {' '.join(f'{value:.9f}' for value in rest[number].tolist())}"
    yield f"{inner}CHANNELS {len(names)} {' '.join(names)}".rstrip()
    children = [n for n, other in enumerate(NODES) if other.parent == number]
    for child in children:
        yield from _hierarchy_lines(child, rest, channels, inner)
    if not children:
        yield from (f"{inner}End Site", inner + "{", f"{inner}  OFFSET 0 0 0", inner + "}")
    yield indent + "}"
