"""`.npz` and `.npy` with positions of joints [frames, J, 3], from any source.

An npz may also hold names [J], and a rate (Hz) or the instants of its frames. Arrays are read by
their declared size, which is bounded, and never as Python objects.
"""

import io
import struct
import zipfile
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.errors import MotionFileError
from radhar_cli.files.clocks import TIME_UNITS, seconds_of_texts
from radhar_cli.files.plain_text import decode_text
from radhar_cli.motion.recorded.keypoints import (
    Keypoints,
    describe_array,
    make_keypoints,
)
from radhar_cli.motion.recorded.recording import MAX_BYTES, MAX_JOINTS, RATES, motion_file_error
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.position_arrays import arrange_positions

MAX_NAMES_BYTES = 2**20
_PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # as NumPy writes; others can ask for memory
_DAMAGE = (
    *(zipfile.BadZipFile, zlib.error, struct.error, RuntimeError),
    *(EOFError, ValueError, OSError, NotImplementedError),
)
_POSITIONS = (
    *("positions", "keypoints", "keypoints_3d", "joints", "joints_3d", "joint_positions"),
    *("landmarks", "world_landmarks", "pose_world_landmarks", "skeleton"),
)
_NAMES = ("names", "joint_names", "keypoint_names")
_RATES = (
    *("rate", "rate_hz", "fps", "frame_rate", "framerate", "hz", "fs", "freq"),
    *("mocap_framerate", "mocap_frame_rate"),
    *("frequency", "sampling_rate", "samplingrate", "sample_rate", "samplerate"),
    *("frames_per_second", "video_fps", "camera_fps"),
)
_STEPS = ("dt", "frame_time", "frametime", "frame_interval")  # s from frame to frame
_TIMES = ("times", "time", "timestamps", "timestamp", "t", "ts", "frame_times")
_CONFIDENCES = (
    *("confidence", "confidences", "scores", "tracking_state", "visibility", "score", "conf"),
    *("keypoint_scores", "likelihood", "valid", "tracked"),
)
_BODY_MODEL = frozenset({"poses", "pose_body", "root_orient", "betas", "fullpose", "body_pose"})
_BODY_MODEL |= frozenset({"smpl_poses", "smpl_trans", "global_orient", "transl"})
_ANGLES = ("poses", "fullpose", "smpl_poses", "pose_body", "body_pose")  # of a body model, by frame
_MODELS = {72: "smpl", 156: "smplh", 165: "smplx"}  # {columns of all angles: the body model}


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
    return _make(parse_array(data, "it", where), None, where)


def _make(
    array: NDArray[Any],
    names: Sequence[str] | None,
    where: str,
    rate: float | None = None,
    times: Float | None = None,
) -> Keypoints:
    """Make a recording of an array of positions."""
    values = arrange_positions(array, names, where)
    are_columns = sum(size != 1 for size in array.shape) < 3
    return replace(make_keypoints(where, names, values, rate, times), are_columns=are_columns)


def _read_archive(archive: zipfile.ZipFile, where: str) -> Keypoints:
    """Read the arrays of an npz file."""
    members = [name.removesuffix(".npy") for name in archive.namelist() if name.endswith(".npy")]
    key = _first_of(_NAMES, members)
    texts = None if key is None else _read_array(archive, key, MAX_NAMES_BYTES, where)
    names = None if texts is None else _names(texts, str(key), where)
    array = _find_positions(archive, members, where)
    times, rate = _times(archive, members, where), _rate(archive, members, where)
    confidence_key = _first_of(_CONFIDENCES, members)
    if confidence_key is not None:
        confidence = _read_array(archive, confidence_key, MAX_BYTES, where).squeeze()
        array = arrange_positions(array, names, where)
        if array.shape[:2] == confidence.shape and confidence.dtype.kind in "iufb":
            is_lost = (confidence == 0)[..., None]
            array = np.where(is_lost, np.nan, array[..., :3].astype(float))
    return _make(array, names, where, rate, None if rate else times)


def _find_positions(archive: zipfile.ZipFile, members: Sequence[str], where: str) -> NDArray[Any]:
    """Array of positions: of a usual name, or the only one of numbers in two axes or more.

    Raises:
        MotionFileError: There is none, or several arrays may be.
    """
    key = _first_of(_POSITIONS, members)
    is_body_model = len(_BODY_MODEL & {name.lower() for name in members}) > 1
    if key is None and is_body_model:
        raise motion_file_error(where, _describe_body_model(archive, members, where))
    arrays = {name: _try_array(archive, name, where) for name in members if key is None}
    possible = [
        array
        for array in arrays.values()
        if array is not None and array.dtype.kind in "iuf" and array.ndim > 1
    ]
    if key is not None:
        return _read_array(archive, key, MAX_BYTES, where)
    if len(possible) == 1:
        return possible[0]
    listed = ", ".join(name[:30] for name in members[:10]) or "nothing"
    raise motion_file_error(
        where,
        "has no array 'positions'; should have names [J], positions [frames, J, 3] and rate "
        f"(or times); it has {listed}: np.savez('clip.npz', names=[...], positions=p['NAME'], "
        "rate=30) names them, with p = np.load(FILE)",
    )


def _describe_body_model(archive: zipfile.ZipFile, members: Sequence[str], where: str) -> str:
    """Describe three lines of NumPy that make joints of a body model's parameters, as AMASS has."""
    frames = _first_of(_ANGLES, members) or "poses"
    angles = _try_array(archive, frames, where) if frames in members else None
    key = _first_of(("surface_model_type", "model_type"), members)
    kind = None if key is None else _try_array(archive, key, where)
    model = str(kind.item()).lower() if kind is not None and kind.size == 1 else ""
    if model not in _MODELS.values():
        columns = 0 if angles is None or angles.ndim != 2 else angles.shape[1]
        model = _MODELS.get(columns, "smplh")
    rate = _first_of(_RATES, members)
    return (
        "has parameters of a body model (SMPL: poses, betas, trans), no joints; its model makes "
        f"them: p = np.load(FILE); j = smplx.create(MODELS, '{model}', batch_size=len(p['{frames}"
        "']))(body_pose=..., global_orient=..., transl=...).joints.detach().numpy()[:, :22]; "
        "np.savez(OUT, names=smplx.joint_names.JOINT_NAMES[:22], positions=j, rate="
        + (f"p['{rate}']" if rate else "HZ")
        + ") (docs/guide/poses.md)"
    )


def _try_array(archive: zipfile.ZipFile, name: str, where: str) -> NDArray[Any] | None:
    """Array of an archive; None where it is none of numbers or texts."""
    try:
        return _read_array(archive, name, MAX_BYTES, where)
    except MotionFileError:
        return None


def _names(names: NDArray[Any], key: str, where: str) -> list[str]:
    """Names of joints."""
    if names.dtype.kind not in "US" or names.ndim != 1 or not 0 < names.size <= MAX_JOINTS:
        raise motion_file_error(
            where, f"{key} should be 1 to {MAX_JOINTS} texts, not {describe_array(names)}"
        )
    return [decode_text(n) if isinstance(n, bytes) else n for n in names.tolist()]


def _rate(archive: zipfile.ZipFile, members: Iterable[str], where: str) -> float | None:
    """Frames per second that an npz has; None where it has none."""
    members = list(members)
    rate_key, step_key = _first_of(_RATES, members), _first_of(_STEPS, members)
    key = rate_key or step_key
    if key is None:
        return None
    numbers = np.unique(_read_array(archive, key, MAX_BYTES // 16, where))
    rate = None
    if numbers.size == 1 and numbers.dtype.kind in "iufUS":
        try:
            rate = float(numbers.item())
        except ValueError:
            rate = None
    if rate and key == step_key:
        rate = 1 / rate
    if rate is None or not RATES[0] <= rate <= RATES[1]:
        raise motion_file_error(
            where, f"{key} should be one number of {RATES[0]:g} to {RATES[1]:g} Hz"
        )
    return rate


def _times(archive: zipfile.ZipFile, members: Iterable[str], where: str) -> Float | None:
    """Instants of the frames that an npz has; in s where the key ends in a unit."""
    members = list(members)
    for unit, seconds in (("", None), *TIME_UNITS.items()):
        ending = f"_{unit}" if unit else ""
        key = _first_of([name + ending for name in _TIMES], members)
        if key is None:
            continue
        times = _read_array(archive, key, MAX_BYTES // 16, where).ravel()
        if times.dtype.kind in "US":
            instants = seconds_of_texts(_texts_of(times))
            return times if instants is None else instants
        if times.dtype.kind == "M":
            nanoseconds = times.astype("datetime64[ns]").astype(np.int64)
            return np.asarray((nanoseconds - nanoseconds[:1]) * 1e-9)
        return times if seconds is None or times.dtype.kind not in "iuf" else times * seconds
    return None


def _texts_of(values: NDArray[Any]) -> list[str]:
    """Texts of an array [N] of texts, or of bytes."""
    return [v.decode("ascii", "replace") if isinstance(v, bytes) else v for v in values.tolist()]


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
            raise ValueError(
                "of Python objects, which are not read; np.savez(OUT, "
                "names=[str(n) for n in names], ...) writes texts"
                if name != "it"
                else "of Python objects, which are not read: save an array of numbers"
            )
        numbers = data.read()
        if dtype.itemsize * prod(shape) != len(numbers):
            raise ValueError("shorter or longer than it says")
        flat = np.frombuffer(numbers, dtype)
        return flat.reshape(shape, order="F" if fortran else "C")
    except (ValueError, TypeError, OverflowError, SyntaxError, MemoryError) as error:
        reason = str(error).splitlines()[0][:120] if str(error) else "damaged"
        raise motion_file_error(where, f"{name} is not an array of numbers ({reason})") from None
