"""`.npz` with `names` [J], `positions` [frames, J, 3] and `rate` (Hz), from any source.

Arrays are read by their declared size, which is bounded, and never as Python objects.
"""

import io
import struct
import zipfile
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.motion.files.recording import (
    LONGEST_NAME,
    MAX_BYTES,
    MAX_FRAMES,
    MAX_JOINTS,
    RATES,
    motion_file_error,
)
from radhar_cli.numerics.arrays import Float

MAX_NAMES_BYTES = 2**20
_PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # as NumPy writes; others can ask for memory
_DAMAGE = (
    *(zipfile.BadZipFile, zlib.error, struct.error, RuntimeError),
    *(EOFError, ValueError, OSError),
)


@dataclass(frozen=True)
class Npz:
    """A `MotionRecording` of positions."""

    where: str
    names: tuple[str, ...]
    rate: float
    values: NDArray[Any]

    rest, unit, at_bone_ends = None, None, False

    @property
    def parents(self) -> tuple[int | None, ...]:
        return (None,) * len(self.names)

    def positions(self, joints: Sequence[int]) -> Float:
        """Positions [frames, len(joints), 3] of some joints."""
        points: Float = self.values[:, list(joints)].astype(float)
        bad = np.argwhere(~(np.abs(points) < 1e9))
        if bad.size:
            frame, joint, axis = bad[0].tolist()
            value = points[frame, joint, axis]
            name = self.names[joints[joint]]
            raise motion_file_error(
                self.place(frame), f"{name} {'xyz'[axis]} is {value}; should be a number"
            )
        return points

    def place(self, frame: int) -> str:
        return f"{self.where}: frame {frame + 1}"


def read_npz(data: bytes, where: str) -> Npz:
    """Read an npz file with `names`, `positions` and `rate`.

    Args:
        data: Bytes of the file.
        where: Name of the file in messages.

    Raises:
        MotionFileError: Names the file, the array and what is missing or odd.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            names = _read_array(archive, "names", MAX_NAMES_BYTES, where)
            rate = _read_array(archive, "rate", 1024, where)
            positions = _read_array(archive, "positions", MAX_BYTES, where)
    except _DAMAGE as error:
        raise motion_file_error(where, f"is not a complete npz file ({str(error)[:120]})") from None
    if names.dtype.kind not in "US" or names.ndim != 1 or not 0 < names.size <= MAX_JOINTS:
        raise motion_file_error(
            where, f"names should be 1 to {MAX_JOINTS} texts, not {_kind(names)}"
        )
    joint_names = [
        n.decode("utf-8", "replace") if isinstance(n, bytes) else n for n in names.tolist()
    ]
    if any(len(name) > LONGEST_NAME for name in joint_names):
        raise motion_file_error(where, f"names should have at most {LONGEST_NAME} characters each")
    if rate.size != 1 or rate.dtype.kind not in "iuf" or not RATES[0] <= rate.item() <= RATES[1]:
        raise motion_file_error(
            where, f"rate should be one number of {RATES[0]:g} to {RATES[1]:g} Hz"
        )
    if positions.dtype.kind not in "iuf" or positions.shape[1:] != (len(joint_names), 3):
        raise motion_file_error(
            where,
            f"positions should be numbers [frames, {len(joint_names)}, 3], not {_kind(positions)}",
        )
    if not 0 < len(positions) <= MAX_FRAMES:
        raise motion_file_error(
            where, f"has {len(positions)} frames; should have 1 to {MAX_FRAMES}"
        )
    return Npz(where, tuple(joint_names), float(rate.item()), positions)


def _kind(array: NDArray[Any]) -> str:
    return f"{array.dtype} {list(array.shape)}"


def _read_array(archive: zipfile.ZipFile, name: str, max_bytes: int, where: str) -> NDArray[Any]:
    """Read one array of numbers of at most `max_bytes`."""
    try:
        member = archive.getinfo(f"{name}.npy")
    except KeyError:
        raise motion_file_error(
            where, f"has no array {name!r}; should have names, positions, rate"
        ) from None
    if member.compress_type not in _PACKED:
        raise motion_file_error(where, f"{name} is packed in another way than NumPy's")
    if member.file_size > max_bytes:
        raise motion_file_error(
            where, f"{name} has {member.file_size} bytes; should have at most {max_bytes}"
        )
    with archive.open(member) as file:
        data = io.BytesIO(file.read(max_bytes))
    try:
        version = np.lib.format.read_magic(data)
        if version not in ((1, 0), (2, 0)):
            raise ValueError(f"of version {version}")
        npy_format, is_version_1 = np.lib.format, version == (1, 0)
        read_header = (
            npy_format.read_array_header_1_0 if is_version_1 else npy_format.read_array_header_2_0
        )
        shape, fortran, dtype = read_header(data)
        if dtype.hasobject:
            raise ValueError("of Python objects, which are not read")
        content = data.read()
        if dtype.itemsize * prod(shape) != len(content):
            raise ValueError("shorter or longer than it says")
        flat = np.frombuffer(content, dtype)
        return flat.reshape(shape, order="F" if fortran else "C")
    except (ValueError, TypeError, OverflowError, SyntaxError, MemoryError) as error:
        reason = str(error).splitlines()[0][:120] if str(error) else "damaged"
        raise motion_file_error(where, f"{name} is not an array of numbers ({reason})") from None
