"""Recordings of motion files: names of joints, their parents, positions of some of them."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from radhar_cli.errors import MotionFileError
from radhar_cli.numerics.arrays import Float

MAX_BYTES = 2**28  # of a file
MAX_JOINTS = 1000
MAX_FRAMES = 500_000  # 69 min at 120 Hz
LONGEST_NAME = 100
RATES = (1.0, 10_000.0)  # frames per second


class MotionRecording(Protocol):
    """Joints over frames as a file has them, in its own units and axes.

    Attributes:
        where: Name of the file in messages.
        names: Names of the J joints.
        parents: Number of the joint that each one hangs on, None for a root.
        up: Axis that points up by the format, such as "y"; None where it says none.
        rate: Frames per second; None where the file does not say.
        unit: Length of a file unit, m; None where the file does not say.
        at_bone_ends: Whether the joint of a name is where its bone ends, as in ASF; else it is
            where its bone begins.
    """

    @property
    def where(self) -> str: ...
    @property
    def names(self) -> tuple[str, ...]: ...
    @property
    def parents(self) -> tuple[int | None, ...]: ...
    @property
    def up(self) -> str | None: ...
    @property
    def rate(self) -> float | None: ...
    @property
    def unit(self) -> float | None: ...
    @property
    def at_bone_ends(self) -> bool: ...

    def positions(self, joints: Sequence[int]) -> Float:
        """Positions [frames, len(joints), 3] of some joints, in units of the file.

        Raises:
            MotionFileError: A frame cannot be read; the message names file and line.
        """
        ...

    def place(self, frame: int) -> str:
        """Name of a frame in messages: file and line, or file and frame."""
        ...


def motion_file_error(where: str, problem: str) -> MotionFileError:
    """Error to raise about a file, or about a file and a line.

    Args:
        where: FILE, or FILE:LINE.
        problem: The problem there, and what would be right.
    """
    return MotionFileError(f"{where}: {problem}")


def with_ancestors(joints: Sequence[int], parents: Sequence[int | None]) -> list[int]:
    """Numbers of the joints and of all that they hang on, parents first."""
    numbers: set[int] = set()
    for joint in joints:
        ancestor: int | None = joint
        while ancestor is not None and ancestor not in numbers:
            numbers.add(ancestor)
            ancestor = parents[ancestor]
    return sorted(numbers)


def turn(axes: Float, axis: int, degrees: Float) -> None:
    """Turn axes [3, 3, M] (columns) about their own x, y or z (0, 1, 2), angles [M], in place."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    first = c * axes[:, i] + s * axes[:, j]
    axes[:, j] = c * axes[:, j] - s * axes[:, i]
    axes[:, i] = first


def apply_axes(axes: Float, vector: Float) -> Float:
    """Products R v [3, M] of axes R [3, 3, M] and vectors v [3, 1 or M]."""
    product: Float = np.einsum("rcm,cm->rm", axes, np.broadcast_to(vector, (3, axes.shape[2])))
    return product
