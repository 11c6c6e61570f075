"""`.npz` and `.npy` with positions of joints [frames, J, 3], from any source.

An npz may also hold names [J], and a rate (Hz) or the instants of its frames. Arrays are read by
their declared size, which is bounded, and never as Python objects.
"""

import io
import struct
import zipfile
import zlib
from collections.abc import Collection, Iterable
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.motion.files.keypoints import TIME_UNITS, Keypoints, describe_array, make_keypoints
from radhar_cli.motion.files.recording import MAX_BYTES, MAX_JOINTS, RATES, motion_file_error
from radhar_cli.numerics.arrays import Float

MAX_NAMES_BYTES = 2**20
_PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # as NumPy writes; others can ask for memory
_DAMAGE = (
    *(zipfile.BadZipFile, zlib.error, struct.error, RuntimeError),
    *(EOFError, ValueError, OSError, NotImplementedError),
)
_POSITIONS = (
    *("positions", "keypoints", "keypoints_3d", "keypoints3d", "joints", "joints_3d", "joints3d"),
    *("poses_3d", "poses3d", "pose_3d", "pose3d", "points", "xyz", "skeleton", "skeletons"),
    *("landmarks", "world_landmarks", "pose_world_landmarks", "positions_3d", "joint_positions"),
    "data",
)
_NAMES = ("names", "joint_names", "keypoint_names")
_RATES = ("rate", "rate_hz", "fps", "frame_rate", "framerate", "mocap_framerate")
_TIMES = ("times", "time", "timestamps", "timestamp", "t")
_CONFIDENCES = ("confidence", "confidences", "scores", "tracking_state")
_BODY_MODEL = frozenset({"poses", "pose_body", "root_orient", "betas", "fullpose", "body_pose"})
_BODY_MODEL |= frozenset({"smpl_poses", "smpl_trans", "global_orient", "transl"})
# The three lines of NumPy that make joints of what AMASS has.
OF_BODY_MODEL = (
    "has parameters of a body model (SMPL: poses, betas, trans), no joints; its model makes them: "
    "p = np.load(FILE); j = smplx.create(MODELS, 'smplh', batch_size=len(p['poses']))("
    "body_pose=..., global_orient=..., transl=...).joints.detach().numpy()[:, :22]; "
    "np.savez(OUT, names=smplx.joint_names.JOINT_NAMES[:22], positions=j, "
    "rate=p['mocap_framerate']) (docs/guide/motion_files.md)"
)


def read_npz(data: bytes, where: str) -> Keypoints:
    """Read an npz file with positions, and names, rate or times of them where it has them.

    Args:
        data: Bytes of the file.
        where: Name of the file in messages.

    Raises:
        MotionFileError: Names the file, the array and what is missing or odd.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            return _read_archive(archive, where)
    except _DAMAGE as error:
        raise motion_file_error(where, f"is not a complete npz file ({str(error)[:120]})") from None


def read_npy(data: bytes, where: str) -> Keypoints:
    """Read positions [frames, J, 3] of an npy file, which has neither names nor a rate.

    Raises:
        MotionFileError: Names the file and what is odd.
    """
    positions = parse_array(data, "it", where)
    return make_keypoints(where, None, shape_positions(positions, None, where))


def shape_positions(
    positions: NDArray[Any], names: Collection[str] | None, where: str
) -> NDArray[Any]:
    """Positions [frames, J, 3 or 4] of an array that has them in another usual shape.

    That is [frames, 3 J], [3, frames, J] (ST-GCN's) or [frames, 3, J]; axes of one are dropped.

    Raises:
        MotionFileError: The array has two coordinates, or several people.
    """
    if positions.ndim > 3:
        axes = [n for n in positions.shape[1:-1] if n != 1]
        positions = positions.reshape(positions.shape[0], *axes, positions.shape[-1])
        if positions.ndim > 3 and positions.shape[-1] == 1:
            positions = positions[..., 0]
    if positions.ndim == 2 and positions.shape[1] and positions.shape[1] % 3 == 0:
        positions = positions.reshape(len(positions), -1, 3)
    if positions.ndim != 3:
        problem = (
            f"positions should be [frames, J, 3] of one person, not {describe_array(positions)}"
        )
        raise motion_file_error(where, problem)
    shape = positions.shape
    fits = names is None or shape[1] == len(names)
    if shape[2] in (3, 4) and fits:
        return positions
    if shape[0] == 3 and shape[2] > 4:
        return np.moveaxis(positions, 0, 2)
    if shape[1] == 3 and shape[2] > 4:
        return np.moveaxis(positions, 1, 2)
    if shape[2] == 2:
        raise motion_file_error(where, two_dimensional("positions have two coordinates"))
    return positions


def two_dimensional(finding: str) -> str:
    """What to say of poses in the plane of an image."""
    return (
        f"{finding}: pixels of an image; a radar needs 3-D positions in m, cm or mm, as "
        "MediaPipe's world landmarks, a depth camera, several cameras or a lifting network give"
    )


def _read_archive(archive: zipfile.ZipFile, where: str) -> Keypoints:
    """Read the arrays of an npz file."""
    members = [name.removesuffix(".npy") for name in archive.namelist() if name.endswith(".npy")]
    key = _first_of(_POSITIONS, members)
    if key is None and _BODY_MODEL & set(members):
        raise motion_file_error(where, OF_BODY_MODEL)
    if key is None:
        listed = ", ".join(name[:30] for name in members[:10]) or "nothing"
        raise motion_file_error(
            where,
            "has no array 'positions'; should have names [J], positions [frames, J, 3] and rate "
            f"(or times); it has {listed}",
        )
    names_key, names = _first_of(_NAMES, members), None
    if names_key is not None:
        names = _names(_read_array(archive, names_key, MAX_NAMES_BYTES, where), where)
    positions = _read_array(archive, key, MAX_BYTES, where)
    times, rate = _times(archive, members, where), _rate(archive, members, where)
    values = shape_positions(positions, names, where)
    confidence_key = _first_of(_CONFIDENCES, members)
    if confidence_key is not None:
        confidence = _read_array(archive, confidence_key, MAX_BYTES, where)
        if confidence.shape == values.shape[:2] and confidence.dtype.kind in "iuf":
            is_lost = (confidence == 0)[..., None]
            values = np.where(is_lost, np.nan, values[..., :3].astype(float))
    return make_keypoints(where, names, values, rate, None if rate else times)


def _names(names: NDArray[Any], where: str) -> list[str]:
    """Names of joints."""
    if names.dtype.kind not in "US" or names.ndim != 1 or not 0 < names.size <= MAX_JOINTS:
        raise motion_file_error(
            where, f"names should be 1 to {MAX_JOINTS} texts, not {describe_array(names)}"
        )
    return [n.decode("utf-8", "replace") if isinstance(n, bytes) else n for n in names.tolist()]


def _rate(archive: zipfile.ZipFile, members: Iterable[str], where: str) -> float | None:
    """Frames per second that an npz has; None where it has none."""
    key = _first_of(_RATES, members)
    if key is None:
        return None
    rate = _read_array(archive, key, 1024, where)
    if rate.size != 1 or rate.dtype.kind not in "iuf" or not RATES[0] <= rate.item() <= RATES[1]:
        raise motion_file_error(
            where, f"{key} should be one number of {RATES[0]:g} to {RATES[1]:g} Hz"
        )
    return float(rate.item())


def _times(archive: zipfile.ZipFile, members: Iterable[str], where: str) -> Float | None:
    """Instants of the frames that an npz has; in s where the key ends in a unit."""
    members = list(members)
    for unit, seconds in (("", None), *TIME_UNITS.items()):
        ending = f"_{unit}" if unit else ""
        key = _first_of([name + ending for name in _TIMES], members)
        if key is None:
            continue
        times = _read_array(archive, key, MAX_BYTES // 16, where).ravel()
        return times if seconds is None or times.dtype.kind not in "iuf" else times * seconds
    return None


def _first_of(keys: Iterable[str], members: Iterable[str]) -> str | None:
    """First of some keys that an archive has, in any case."""
    known = {name.lower(): name for name in members}
    return next((known[key] for key in keys if key in known), None)


def _read_array(archive: zipfile.ZipFile, name: str, max_bytes: int, where: str) -> NDArray[Any]:
    """Read one array of numbers of at most `max_bytes`."""
    member = archive.getinfo(f"{name}.npy")
    if member.compress_type not in _PACKED:
        raise motion_file_error(where, f"{name} is packed in another way than NumPy's")
    if member.file_size > max_bytes:
        raise motion_file_error(
            where, f"{name} has {member.file_size} bytes; should have at most {max_bytes}"
        )
    with archive.open(member) as file:
        return parse_array(file.read(max_bytes), name, where)


def parse_array(content: bytes, name: str, where: str) -> NDArray[Any]:
    """Array of numbers or texts in NumPy's format.

    Args:
        content: Bytes of an npy file.
        name: What messages call the array.
        where: Name of the file in messages.

    Raises:
        MotionFileError: It is damaged, or holds Python objects.
    """
    data = io.BytesIO(content)
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
        numbers = data.read()
        if dtype.itemsize * prod(shape) != len(numbers):
            raise ValueError("shorter or longer than it says")
        flat = np.frombuffer(numbers, dtype)
        return flat.reshape(shape, order="F" if fortran else "C")
    except (ValueError, TypeError, OverflowError, SyntaxError, MemoryError) as error:
        reason = str(error).splitlines()[0][:120] if str(error) else "damaged"
        raise motion_file_error(where, f"{name} is not an array of numbers ({reason})") from None
