"""Frames and bodies of JSON: joints of each body, their names, and the instant of the frame.

A frame is a list of joints, or an object with joints (`pose_world_landmarks`, `keypoints_3d`, ...)
or with bodies (`bodies`, `body_list`, `instances`, `people`) beside its time. A body is a list of
joints, or an object with them and an identity. A joint is [x, y, z], or an object with x, y and z,
with a Position, or with cameraX. null is a lost frame.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.files.clocks import TIME_WORDS
from radhar_cli.motion.recorded.image_landmarks import two_dimensional
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS
from radhar_cli.motion.recorded.recording import MAX_JOINTS, motion_file_error
from radhar_cli.numerics.arrays import Float

# MediaPipe's landmarks of an image; some write its world landmarks under these names, too.
LANDMARKS = ("landmarks", "pose_landmarks", "poselandmarks", "landmark")
WORLD_LANDMARKS = (
    *("pose_world_landmarks", "poseworldlandmarks", "world_landmarks", "worldlandmarks"),
)
PIXELS = ("keypoints_2d", "keypoints2d", "pose_keypoints_2d")
JOINTS = (
    *WORLD_LANDMARKS,
    *("keypoints_3d", "keypoints3d", "pose_keypoints_3d", "joints_3d", "joints3d", "pose_3d"),
    *("positions", "joint_positions", "joints", "keypoint", "keypoints", "skeleton", "xyz"),
    *("joints19", "joints15", "joints26"),
    *LANDMARKS,
)
BODIES = ("bodies", "body_list", "instances", "people", "persons", "skeletons", "users", "objects")
NORMALISED = (
    "has landmarks of an image, which lie from 0 to 1 and have no scale in depth; write "
    "pose_world_landmarks, which are in m"
)
MAX_BODIES = 50  # in a frame
# {(key of the joints, their number): the set whose maker writes so}
_MAKERS = {
    ("pose_keypoints_3d", 18): "openpose18",
    ("pose_keypoints_3d", 25): "openpose25",
    ("joints19", 19): "panoptic19",
    ("keypoint", 18): "openpose18",
    ("keypoint", 34): "zed34",
    ("keypoint", 38): "zed38",
    ("joint_positions", 32): "azure32",
    **{(key, 33): "blazepose33" for key in (*WORLD_LANDMARKS, *LANDMARKS)},
}
_TIMES = ("time", "timestamp", "t", "times", "timestamps", "univtime", "relativetime", "ts")
_IDENTITIES: tuple[str, ...] = (
    "body_id",
    "bodyid",
    "id",
    "trackingid",
    "tracking_id",
    "track_id",
    "person_id",
    "idx",
    "instance_id",
    "unique_object_id",
    "userid",
)
_CONFIDENCE = (
    "visibility",
    "confidence",
    "score",
    "trackingstate",
    "tracking_state",
    "state",
    "likelihood",
    "confidence_level",
    "confidencelevel",
)
_CONFIDENCES = (
    "keypoint_scores",
    "keypoint_confidence",
    "confidences",
    "joint_confidences",
    "joint_confidence",
    "scores",
    "visibilities",
)
_LABELS = ("name", "jointtype", "joint", "label", "joint_name", "joint_type", "part")
_PLACES = ("position", "pos", "cameraposition", "location", "coordinates", "xyz", "world")
_NOT_TRACKED = frozenset({"nottracked", "not_tracked", "none", "false", "off", "lost"})


class JsonBody(NamedTuple):
    """Joints of a body in a frame."""

    identity: str | None
    joints: Float  # [J, 3]; NaN where a joint is lost
    names: list[str] | None
    are_landmarks: bool = False  # by their key, which is that of landmarks of an image
    up: str | None = None  # axis that points up by the maker who has such a key


class JsonFrame(NamedTuple):
    """Bodies of a frame, and its instant."""

    bodies: list[JsonBody]
    instant: float | str | None
    time_unit: str | None  # key of clocks.TIME_UNITS


def lower_keys(document: Mapping[str, Any]) -> dict[str, Any]:
    """Object whose keys are in lower case."""
    return {str(key).lower(): value for key, value in document.items()}


def is_real(value: Any) -> bool:
    """Whether a value is a number that a coordinate or an instant may be."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 1e300


def read_frame(frame: Any, place: str) -> JsonFrame:
    """Read the bodies of a frame.

    Args:
        frame: What JSON has of it.
        place: File and frame in messages.

    Raises:
        MotionFileError: It has pixels, or no joints where they are expected.
    """
    if frame is None or frame == [] or frame == {}:
        return JsonFrame([], None, None)
    if not isinstance(frame, dict):
        bodies = frame if _is_list_of_bodies(frame) else [frame]
        return JsonFrame(_read_bodies(bodies, place), None, None)
    keys = lower_keys(frame)
    instant, unit = _instant_of(keys)
    bodies = next((keys[key] for key in BODIES if isinstance(keys.get(key), (list, dict))), None)
    if bodies is not None and not any(key in keys for key in JOINTS):
        listed = [*bodies.values()] if isinstance(bodies, dict) else bodies
        return JsonFrame(_read_bodies(listed, place), instant, unit)
    return JsonFrame(_read_bodies([frame], place), instant, unit)


def _instant_of(keys: Mapping[str, Any]) -> tuple[float | str | None, str | None]:
    """Instant of a frame, a number or a text, and the unit that its key names."""
    endings = {"": None, **{f"_{word}": unit for word, unit in TIME_WORDS.items()}}
    for key in _TIMES:
        for ending, unit in endings.items():
            value = keys.get(key + ending)
            if isinstance(value, dict):  # such as {"data_ns": 17...}
                value = next(filter(is_real, value.values()), None)
            if is_real(value) or (isinstance(value, str) and value.strip()):
                return value, "ms" if key == "univtime" else unit
    return None, None


def _is_list_of_bodies(frame: Any) -> bool:
    """Whether a list has bodies, each a list of joints or an object with joints."""
    if not isinstance(frame, list) or not frame:
        return False
    first = next((body for body in frame if body), None)
    if isinstance(first, dict):
        return any(key in lower_keys(first) for key in JOINTS)
    return isinstance(first, list) and isinstance(first[0], (list, dict))


def _read_bodies(bodies: list[Any], place: str) -> list[JsonBody]:
    """Read bodies; those that are not tracked or have no joints are left out."""
    if len(bodies) > MAX_BODIES:
        raise motion_file_error(place, f"has {len(bodies)} people; should be one")
    read = [_read_body(body, place) for body in bodies if body]
    return [body for body in read if body is not None]


def _read_body(body: Any, place: str) -> JsonBody | None:
    """Read a body; None where it is not tracked, or has no joints."""
    if not isinstance(body, dict):
        joints, names = _read_joints(body, place)
        return None if joints is None else JsonBody(None, joints, names)
    keys = lower_keys(body)
    if keys.get("istracked", keys.get("is_tracked", keys.get("tracked", True))) is False:
        return None
    key = next((key for key in JOINTS if key in keys and keys[key] is not None), None)
    is_openpose = bool(keys.get("pose_keypoints_2d"))
    if is_openpose and not keys.get("pose_keypoints_3d"):
        raise motion_file_error(
            place, two_dimensional("is a frame of OpenPose with pose_keypoints_2d")
        )
    if key is None and any(keys.get(name) for name in PIXELS) and not is_openpose:
        raise motion_file_error(place, two_dimensional("has keypoints of an image"))
    if key is None and any(name in keys for name in (*JOINTS, *PIXELS)):
        return None
    if key is None and not _is_joint(next(iter(body.values()), None)):
        raise motion_file_error(place, "should have its joints as pose_world_landmarks")
    value = body if key is None else keys[key]
    width = {"pose_keypoints_3d": 4, "joints19": 4, "joints15": 4, "joints26": 4}.get(key or "")
    joints, names = _read_joints(value, place, width)
    if joints is None:
        return None
    maker = _MAKERS.get((key or "", len(joints))) if names is None else None
    up = JOINT_SETS[maker].up if maker else None
    if maker:
        names = [name.split("|")[0] for name in JOINT_SETS[maker].names]
    confidence = next((keys[name] for name in _CONFIDENCES if name in keys), None)
    if isinstance(confidence, list) and len(confidence) == len(joints):
        is_lost = [is_real(c) and c <= 0 for c in confidence]
        joints[np.array(is_lost, dtype=bool)] = np.nan
    identity = next((str(keys[name]) for name in _IDENTITIES if is_identity(keys.get(name))), None)
    return JsonBody(identity, joints, names, key in LANDMARKS, up)


def is_identity(value: Any) -> bool:
    """Whether a value tells one body from another: not -1, which is none."""
    return isinstance(value, (int, str)) and value not in (-1, "-1", "")


def _is_joint(value: Any) -> bool:
    """Whether a value has three coordinates."""
    if isinstance(value, dict):
        keys = lower_keys(value)
        return {"x", "y", "z"} <= set(keys) or any(name in keys for name in _PLACES)
    return isinstance(value, list) and len(value) in (3, 4) and all(map(is_real, value))


def _read_joints(
    joints: Any, place: str, width: int | None = None
) -> tuple[Float | None, list[str] | None]:
    """Positions [J, 3] of joints, and their names where they have them.

    Args:
        joints: A list, an object {name: joint}, or numbers one after the other.
        place: File and frame in messages.
        width: Numbers of a joint where they are one after the other; None finds it.
    """
    names = None
    if isinstance(joints, dict):
        names, joints = [str(name) for name in joints], [*joints.values()]
        if names and all(name.isdigit() for name in names):
            joints = [joint for _, joint in sorted(zip(map(int, names), joints, strict=True))]
            names = None
    if not joints:
        return None, None
    if isinstance(joints, list) and isinstance(joints[0], list) and len(joints) == 1:
        names, joints = None, joints[0]  # of one person, in a list of people
        if not joints:
            return None, None
    if not isinstance(joints, list) or len(joints) > 5 * MAX_JOINTS:
        raise motion_file_error(place, f"joints should be a list of 1 to {MAX_JOINTS}")
    if all(map(is_real, joints)):
        width = width or (3 if len(joints) % 3 == 0 else 4)
        if len(joints) % width == 0:
            joints = [joints[n : n + width] for n in range(0, len(joints), width)]
    if len(joints) > MAX_JOINTS:
        raise motion_file_error(place, f"joints should be a list of 1 to {MAX_JOINTS}")
    if names is None and all(isinstance(joint, dict) for joint in joints):
        labels = [_label_of(lower_keys(joint)) for joint in joints]
        if all(isinstance(label, str) for label in labels):
            names = [str(label) for label in labels]
        elif all(isinstance(label, int) for label in labels) and len({*labels}) == len(labels):
            order = sorted(range(len(labels)), key=lambda n: labels[n])
            joints = [joints[n] for n in order]
    return np.array([_read_joint(joint, place) for joint in joints], dtype=float), names


def _label_of(keys: Mapping[str, Any]) -> Any:
    """Name or number of a joint; None where it has none."""
    return next((keys[key] for key in _LABELS if isinstance(keys.get(key), (str, int))), None)


def _read_joint(joint: Any, place: str) -> list[float]:
    """Coordinates of a joint; NaN where it is null, or is said to be lost."""
    lost = [float("nan")] * 3
    if joint is None:
        return lost
    if isinstance(joint, dict):
        keys = lower_keys(joint)
        if any(_is_none(keys.get(key)) for key in _CONFIDENCE):
            return lost
        joint = _coordinates(keys)
        if joint[2] is None and None not in joint[:2]:
            raise motion_file_error(place, two_dimensional("a joint has x and y, but no z"))
    if isinstance(joint, list) and len(joint) == 2:
        raise motion_file_error(place, two_dimensional("a joint has two coordinates"))
    if not isinstance(joint, list) or len(joint) not in (3, 4):
        raise motion_file_error(place, "a joint should be [x, y, z], or have x, y and z")
    if not all(value is None or is_real(value) for value in joint):
        raise motion_file_error(place, "coordinates should be numbers")
    if len(joint) == 4 and joint[3] is not None and joint[3] <= 0:  # a confidence
        return lost
    return [float("nan") if value is None else float(value) for value in joint[:3]]


def _is_none(value: Any) -> bool:
    """Whether a confidence says that a joint is lost."""
    if isinstance(value, str):
        return value.strip().lower() in _NOT_TRACKED
    return is_real(value) and value <= 0


def _coordinates(keys: Mapping[str, Any]) -> list[Any]:
    """x, y and z of a joint that is an object: its own, its position's, or those of the camera."""
    place = next((keys[key] for key in _PLACES if isinstance(keys.get(key), (dict, list))), None)
    if isinstance(place, list):
        return [*place, None, None][: max(3, len(place))]
    if isinstance(place, dict):
        keys = lower_keys(place)
    for prefix in ("", "camera", "world", "pos", "position"):
        axes = [keys.get(f"{prefix}{axis}", keys.get(f"{prefix}_{axis}")) for axis in "xyz"]
        if axes[0] is not None and axes[1] is not None:
            return axes
    return [None] * 3
