"""`.json` of poses: frames of joints as MediaPipe's world landmarks, or names and positions.

A file is a list of frames, or an object with `frames`, or with `names`, `positions` and `rate`. A
frame is a list of joints, or an object that holds one (`pose_world_landmarks`, `keypoints_3d`, ...)
beside its `time`. A joint is [x, y, z], or an object with x, y and z. null is a lost frame.
"""

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from radhar_cli.motion.files.keypoints import TIME_UNITS, Keypoints, make_keypoints
from radhar_cli.motion.files.position_arrays import shape_positions, two_dimensional
from radhar_cli.motion.files.recording import MAX_FRAMES, MAX_JOINTS, RATES, motion_file_error
from radhar_cli.numerics.arrays import Float

MAX_JSON = 2**25  # bytes
_WORLD = ("pose_world_landmarks", "poseworldlandmarks", "world_landmarks", "worldlandmarks")
_JOINTS = (
    *_WORLD,
    *("keypoints_3d", "keypoints3d", "pose_keypoints_3d", "joints_3d", "joints3d", "pose_3d"),
    *("positions", "joint_positions", "joints", "keypoint", "keypoints", "skeleton", "xyz"),
)
_IMAGE = ("landmarks", "pose_landmarks", "poselandmarks", "keypoints_2d", "pose_keypoints_2d")
_FRAMES = ("frames", "poses", "data", "results")
_RATES = ("rate", "rate_hz", "fps", "frame_rate", "framerate")
_TIMES = ("time", "timestamp", "t", "times", "timestamps")
_NAMES = ("names", "joint_names", "keypoint_names")
NORMALISED = (
    "has landmarks of an image, which lie from 0 to 1 and have no scale in depth; write "
    "pose_world_landmarks, which are in m"
)
ONE_FRAME = (
    "is one frame of CMU Panoptic; make one file of all: frames = [json.load(open(f)) for f in "
    "sorted(glob.glob('FOLDER/*.json'))]; json.dump(frames, open('clip.json', 'w'))"
)


def read_json_poses(data: bytes, where: str) -> Keypoints:
    """Read poses from JSON.

    Args:
        data: Bytes of the file.
        where: Name of the file in messages.

    Raises:
        MotionFileError: Names the file and what is missing or odd; pixels are refused.
    """
    document = _parse(data, where)
    names, rate = None, None
    if isinstance(document, dict):
        keys = _lower(document)
        if "people" in keys:
            raise motion_file_error(where, _of_openpose(keys["people"]))
        if "bodies" in keys:
            raise motion_file_error(where, ONE_FRAME)
        names, rate = _names(keys, where), _rate(keys, where)
        series = next((keys[key] for key in (*_FRAMES, *_JOINTS) if key in keys), None)
        if series is None and any(key in keys for key in _IMAGE):
            raise motion_file_error(where, NORMALISED)
        times = next((keys[key] for key in ("times", "timestamps") if key in keys), None)
    else:
        series, times = document, None
    if not isinstance(series, list) or not series:
        raise motion_file_error(
            where, "should be a list of frames, or an object with names, positions and rate"
        )
    if len(series) > MAX_FRAMES:
        raise motion_file_error(where, f"has {len(series)} frames; should have 1 to {MAX_FRAMES}")
    return _recording(series, times, names, rate, where)


def _recording(
    series: Sequence[Any], times: Any, names: list[str] | None, rate: float | None, where: str
) -> Keypoints:
    """Recording of frames as JSON has them."""
    frames, instants, unit = list[Float | None](), list[Any](), None
    for number, frame in enumerate(series, 1):
        place = f"{where}: frame {number}"
        joints, instant, unit_here, own_names = _read_frame(frame, place)
        names, unit = names or own_names, unit or unit_here
        instants.append(instant)
        frames.append(joints)
    known = [joints for joints in frames if joints is not None]
    if not known:
        raise motion_file_error(where, "has no joints in any frame")
    shape = known[0].shape
    for number, joints in enumerate(frames, 1):
        if joints is not None and joints.shape != shape:
            raise motion_file_error(
                f"{where}: frame {number}", f"has {len(joints)} joints; others have {shape[0]}"
            )
    lost = np.full(shape, np.nan)
    values = np.stack([lost if joints is None else joints for joints in frames])
    clock = times if times is not None else instants if None not in instants else None
    seconds = None if clock is None or rate is not None else _instants(clock, where)
    if seconds is not None and unit is not None:
        seconds = seconds * TIME_UNITS[unit]
    return make_keypoints(where, names, shape_positions(values, names, where), rate, seconds)


def _parse(data: bytes, where: str) -> Any:
    """Value of a JSON text of bounded length."""
    if len(data) > MAX_JSON:
        raise motion_file_error(where, f"is {len(data)} bytes; should be at most {MAX_JSON}")
    try:
        return json.loads(data)
    except (ValueError, RecursionError) as error:
        reason = str(error).splitlines()[0][:120] if str(error) else "damaged"
        raise motion_file_error(where, f"is not JSON ({reason})") from None


def _lower(document: Mapping[str, Any]) -> dict[str, Any]:
    return {key.lower(): value for key, value in document.items()}


def _of_openpose(people: Any) -> str:
    """What to say of a frame of OpenPose, which has pixels unless it has 3-D joints."""
    frames = people if isinstance(people, list) else []
    has_3d = any(isinstance(p, dict) and p.get("pose_keypoints_3d") for p in frames)
    if has_3d:
        return (
            "is one frame of OpenPose with 3-D joints; write those of all frames into one npz: "
            "names, positions [frames, 25, 3], rate"
        )
    return two_dimensional("is a frame of OpenPose with pose_keypoints_2d")


def _names(keys: Mapping[str, Any], where: str) -> list[str] | None:
    """Names of the joints that a document has."""
    names = next((keys[key] for key in _NAMES if key in keys), None)
    if names is None:
        return None
    is_list = isinstance(names, list) and 0 < len(names) <= MAX_JOINTS
    if not is_list or not all(isinstance(name, str) for name in names):
        raise motion_file_error(where, f"names should be 1 to {MAX_JOINTS} texts")
    return list(names)


def _rate(keys: Mapping[str, Any], where: str) -> float | None:
    """Frames per second that a document has."""
    key = next((key for key in _RATES if key in keys), None)
    if key is None:
        return None
    rate = keys[key]
    if not isinstance(rate, (int, float)) or not RATES[0] <= rate <= RATES[1]:
        raise motion_file_error(
            where, f"{key} should be one number of {RATES[0]:g} to {RATES[1]:g} Hz"
        )
    return float(rate)


def _instants(times: Any, where: str) -> Float:
    """Instants [frames] of a list of numbers."""
    if not isinstance(times, list) or not all(_is_number(time) for time in times):
        raise motion_file_error(where, "times should be numbers, one a frame")
    return np.array(times, dtype=float)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and abs(value) < 1e300


def _read_frame(frame: Any, place: str) -> tuple[Float | None, Any, str | None, list[str] | None]:
    """Joints [J, 3 or 4] of a frame, its time and that time's unit, and names of the joints."""
    if frame is None or frame == []:
        return None, None, None, None
    instant, unit = None, None
    if isinstance(frame, dict):
        keys = _lower(frame)
        if "people" in keys:
            raise motion_file_error(place, _of_openpose(keys["people"]))
        keys = _of_panoptic(keys, place)
        for key in _TIMES:
            for ending in ("", *(f"_{unit}" for unit in TIME_UNITS)):
                if instant is None and _is_number(keys.get(key + ending)):
                    instant, unit = keys[key + ending], ending[1:] or None
        joints = next((keys[key] for key in _JOINTS if key in keys), _NOTHING)
        if joints is _NOTHING:
            if any(key in keys for key in _IMAGE):
                raise motion_file_error(place, NORMALISED)
            joints = frame if _is_joint(next(iter(frame.values()), None)) else _NOTHING
        if joints is _NOTHING:
            raise motion_file_error(place, "should have its joints as pose_world_landmarks")
        frame = joints
    positions, names = _read_joints(frame, place)
    return positions, instant, unit, names


_NOTHING = object()


def _of_panoptic(keys: dict[str, Any], place: str) -> dict[str, Any]:
    """Keys of a frame of CMU Panoptic with its only body's joints [19][4] as `joints`.

    Raises:
        MotionFileError: It has several bodies.
    """
    bodies = keys.get("bodies")
    if not isinstance(bodies, list):
        return keys
    if len(bodies) > 1:
        raise motion_file_error(place, f"has {len(bodies)} people; should be one")
    body = _lower(bodies[0]) if bodies and isinstance(bodies[0], dict) else {}
    flat = next((body[key] for key in ("joints19", "joints15", "joints26") if key in body), None)
    rows = [flat[n : n + 4] for n in range(0, len(flat), 4)] if isinstance(flat, list) else []
    instant = {"timestamp_ms": keys["univtime"]} if "univtime" in keys else {}
    return {**keys, **instant, "joints": [None if row[-1:] == [-1] else row for row in rows]}


def _is_joint(value: Any) -> bool:
    """Whether a value has three coordinates."""
    if isinstance(value, dict):
        return {"x", "y", "z"} <= {str(key).lower() for key in value}
    return isinstance(value, list) and len(value) in (3, 4) and all(map(_is_number, value))


def _read_joints(joints: Any, place: str) -> tuple[Float | None, list[str] | None]:
    """Positions [J, 3 or 4] of joints, and their names where they have them."""
    names = None
    if isinstance(joints, dict):
        names, joints = [str(name) for name in joints], [*joints.values()]
    if not joints:
        return None, None
    if isinstance(joints, list) and isinstance(joints[0], list) and len(joints) == 1:
        joints = joints[0]  # of one person, in a list of people
        if not joints:
            return None, None
    if not isinstance(joints, list) or len(joints) > MAX_JOINTS:
        raise motion_file_error(place, f"joints should be a list of 1 to {MAX_JOINTS}")
    if all(_is_number(value) for value in joints) and len(joints) % 3 == 0:
        return np.array(joints, dtype=float).reshape(-1, 3), names
    if names is None and all(isinstance(joint, dict) and "name" in joint for joint in joints):
        names = [str(joint["name"]) for joint in joints]
    return np.array([_read_joint(joint, place) for joint in joints], dtype=float), names


def _read_joint(joint: Any, place: str) -> list[float]:
    """Coordinates of a joint; NaN where it is null."""
    if joint is None:
        return [float("nan")] * 3
    if isinstance(joint, dict):
        keys = _lower(joint)
        if any(keys.get(key, 1) == 0 for key in ("visibility", "confidence", "score")):
            return [float("nan")] * 3
        joint = [keys.get(axis) for axis in "xyz"]
        if joint[2] is None and None not in joint[:2]:
            raise motion_file_error(place, two_dimensional("a joint has x and y, but no z"))
    if isinstance(joint, list) and len(joint) == 2:
        raise motion_file_error(place, two_dimensional("a joint has two coordinates"))
    if not isinstance(joint, list) or len(joint) not in (3, 4):
        raise motion_file_error(place, "a joint should be [x, y, z], or have x, y and z")
    if not all(value is None or _is_number(value) for value in joint):
        raise motion_file_error(place, "coordinates should be numbers")
    if len(joint) == 4 and joint[3] == 0:  # a confidence
        return [float("nan")] * 3
    return [float("nan") if value is None else float(value) for value in joint[:3]]
