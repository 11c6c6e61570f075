"""`.json` and `.jsonl` of poses: frames of joints as trackers and networks write them.

A file is a list of frames, or an object with `frames`, or with `names`, `positions` and `rate`, or
{instant or number: frame}, or {joint: its positions}; `.jsonl` has a frame a line. Of a folder,
each file is a frame. What a frame is, `json_bodies` says.
"""

import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from radhar_cli.files.clocks import TIME_UNITS, seconds_of_texts
from radhar_cli.motion.recorded.image_landmarks import share_in_picture
from radhar_cli.motion.recorded.keypoints import Keypoints, make_keypoints
from radhar_cli.motion.recorded.recording import MAX_FRAMES, MAX_JOINTS, RATES, motion_file_error
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.json_bodies import (
    BODIES,
    JOINTS,
    LANDMARKS,
    NORMALISED,
    PIXELS,
    WORLD_LANDMARKS,
    JsonBody,
    JsonFrame,
    is_real,
    lower_keys,
    read_frame,
)
from radhar_cli.readers.motion.text_tables import MAX_TEXT
from radhar_cli.readers.text_table import text_of_bytes

MAX_JSON = 2**25  # bytes
# Least share of joints in the picture of landmarks of an image, whose feet are often below it; of
# world landmarks, whose origin is the hip, most are not.
MOSTLY = 0.7
OFTEN = 0.5  # share of the frames of the main body from which another one is a second person
_FRAMES = ("frames", "poses", "data", "results", "instance_info", "annotations", "sequence")
_RATES = ("rate", "rate_hz", "fps", "frame_rate", "framerate")
_NAMES = ("names", "joint_names", "keypoint_names", "jointnames", "keypoints_name")
_OF_ALL = ("meta_info", "metadata", "meta", "info", "header")  # objects that say the rate or names
_FRAME_KEY = re.compile(r"^\D{0,30}\d+\D{0,12}$")
ONE_FRAME = (
    "is one frame of several; name the folder of all instead (--motion FOLDER, files: [FOLDER/]), "
    "or make one file: frames = [json.load(open(f)) for f in sorted(glob.glob('FOLDER/*.json'))]; "
    "json.dump(frames, open('clip.json', 'w'))"
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
    names, rate, times = None, None, None
    if isinstance(document, dict):
        keys = lower_keys(document)
        for key in (*_OF_ALL, "categories"):
            value = keys.get(key)
            value = value[0] if isinstance(value, list) and value else value
            keys = {**lower_keys(value), **keys} if isinstance(value, dict) else keys
        names, rate = _names(keys, where), _rate(keys, where)
        document, times = _frames_of(document, keys, where)
    if not isinstance(document, list) or not document:
        raise motion_file_error(
            where, "should be a list of frames, or an object with names, positions and rate"
        )
    if len(document) > MAX_FRAMES:
        raise motion_file_error(where, f"has {len(document)} frames; should have 1 to {MAX_FRAMES}")
    return _recording(document, times, names, rate, where)


def _frames_of(document: Mapping[str, Any], keys: Mapping[str, Any], where: str) -> tuple[Any, Any]:
    """Frames of an object, and their instants where it has them apart."""
    times = next((keys[key] for key in ("times", "timestamps") if key in keys), None)
    for key in (*_FRAMES, *JOINTS):
        value = keys.get(key)
        if isinstance(value, list) and not (key == "joints" and _is_texts(value)):
            if key in JOINTS and _is_flat(value):
                break
            is_of_maker = key in (*WORLD_LANDMARKS, *LANDMARKS)
            return [{key: frame} for frame in value] if is_of_maker else value, times
        if isinstance(value, dict) and key in _FRAMES:
            return _frames_of(value, lower_keys(value), where)
    by_joint = _frames_by_joint(document)
    if by_joint is not None:
        return by_joint, times
    if all(_FRAME_KEY.match(key) for key in document) and len(document) > 1:
        instants = [*document] if all(key.isdigit() for key in document) else None
        are_instants = instants is not None and len(instants[0]) > 9
        return [*document.values()], [int(key) for key in document] if are_instants else times
    if any(key in keys for key in (*BODIES, *JOINTS)):
        read_frame(document, where)  # which refuses pixels
        raise motion_file_error(where, ONE_FRAME)
    if any(keys.get(key) for key in PIXELS):
        read_frame(document, where)  # which refuses them
    return None, None


def _is_texts(values: list[Any]) -> bool:
    return bool(values) and all(isinstance(value, str) for value in values)


def _is_flat(values: list[Any]) -> bool:
    """Whether joints are those of one frame: numbers, or joints as [x, y, z] or objects."""
    first = values[0] if values else None
    if isinstance(first, dict):
        return not any(key in lower_keys(first) for key in JOINTS)
    return is_real(first) or (isinstance(first, list) and bool(first) and is_real(first[0]))


def _frames_by_joint(document: Mapping[str, Any]) -> list[dict[str, Any]] | None:
    """Frames of {joint: [x, y, z] of each frame}, or {joint: {x: [...], y: ..., z: ...}}, if so."""
    series = dict[str, list[Any]]()
    for name, value in document.items():
        if isinstance(value, dict) and {"x", "y", "z"} <= set(keys := lower_keys(value)):
            axes = [keys[axis] for axis in "xyz"]
            if all(isinstance(axis, list) and len(axis) == len(axes[0]) for axis in axes):
                series[name] = [[*xyz] for xyz in zip(*axes, strict=True)]
        elif isinstance(value, list) and value and _is_triple(value[0]):
            series[name] = value
    lengths = {len(value) for value in series.values()}
    if len(series) < 5 or len(lengths) != 1 or lengths.pop() < 2:
        return None
    return [dict(zip(series, joints, strict=True)) for joints in zip(*series.values(), strict=True)]


def _is_triple(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 3 and all(map(is_real, value))


def _recording(
    series: Sequence[Any], times: Any, names: list[str] | None, rate: float | None, where: str
) -> Keypoints:
    """Recording of frames as JSON has them."""
    frames = [read_frame(frame, f"{where}: frame {n}") for n, frame in enumerate(series, 1)]
    bodies, remarks = _choose_body(frames, where)
    known = [body for body in bodies if body is not None]
    if not known:
        raise motion_file_error(where, "has no joints in any frame")
    shape = known[0].joints.shape
    for number, body in enumerate(bodies, 1):
        if body is not None and body.joints.shape != shape:
            raise motion_file_error(
                f"{where}: frame {number}",
                f"has {len(body.joints)} joints; others have {shape[0]}",
            )
    lost = np.full(shape, np.nan)
    values = np.stack([lost if body is None else body.joints for body in bodies])
    if any(body.are_landmarks for body in known) and share_in_picture(values) > MOSTLY:
        raise motion_file_error(where, NORMALISED)
    names = next((body.names for body in known if body.names), names)
    if names is not None and len(names) != shape[0]:
        names = None
    unit = next((frame.time_unit for frame in frames if frame.time_unit), None)
    seconds = None if rate is not None else _seconds(times, frames, unit, where)
    keypoints = make_keypoints(where, names, values, rate, seconds, None, remarks)
    return replace(keypoints, up=known[0].up)


def _choose_body(
    frames: Sequence[JsonFrame], where: str
) -> tuple[list[JsonBody | None], tuple[str, ...]]:
    """Bodies [frames] of the person who is there in most frames, and a remark where others are.

    Raises:
        MotionFileError: Another person is there in more than half as many.
    """
    counts = Counter(
        body.identity or str(n) for frame in frames for n, body in enumerate(frame.bodies)
    )
    if not counts:
        return [None] * len(frames), ()
    (first, frequency), *others = counts.most_common()
    if max((len(frame.bodies) for frame in frames), default=0) < 2:
        return [frame.bodies[0] if frame.bodies else None for frame in frames], ()
    often = [name for name, count in others if count > OFTEN * frequency]
    if often:
        number = next(n for n, frame in enumerate(frames, 1) if len(frame.bodies) > 1)
        raise motion_file_error(
            f"{where}: frame {number}",
            f"has {len(frames[number - 1].bodies)} people; should be one: keep the body of one "
            "identity in each frame",
        )
    chosen = [
        next((b for n, b in enumerate(f.bodies) if (b.identity or str(n)) == first), None)
        for f in frames
    ]
    return chosen, (f"of {len(counts)} bodies the one is taken that is there in most frames",)


def _seconds(times: Any, frames: Sequence[JsonFrame], unit: str | None, where: str) -> Float | None:
    """Instants [frames] in s, or in a unit that a camera's rate tells; None without any."""
    if times is not None:
        if not isinstance(times, list) or not all(map(is_real, times)):
            raise motion_file_error(where, "times should be numbers, one a frame")
        return np.array(times, dtype=float)
    instants = [frame.instant for frame in frames]
    if all(isinstance(instant, str) for instant in instants):
        texts = [str(instant) for instant in instants]
        if not all(re.fullmatch(r"\s*\d+(\.\d+)?\s*", text) for text in texts):
            return seconds_of_texts(texts)
        instants = [float(text) for text in texts]
    if not all(map(is_real, instants)):
        return None
    seconds = np.array(instants, dtype=float)
    return seconds if unit is None else (seconds - seconds[0]) * TIME_UNITS[unit]


def _parse(data: bytes, where: str) -> Any:
    """Value of a JSON text of bounded length; a list where each line is one."""
    if len(data) > MAX_JSON:
        raise motion_file_error(where, f"is {len(data)} bytes; should be at most {MAX_JSON}")
    text = text_of_bytes(data, where, MAX_TEXT, motion_file_error)
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        lines = [line for line in text.splitlines() if line.strip()]
        if len(lines) > 1 and lines[0].rstrip().endswith(("}", "]")):
            return _parse_lines(lines, where)
        reason = str(error).splitlines()[0][:120] if str(error) else "damaged"
        raise motion_file_error(where, f"is not JSON ({reason})") from None


def _parse_lines(lines: Sequence[str], where: str) -> list[Any]:
    """Values of lines that are JSON each."""
    values = []
    for number, line in enumerate(lines, 1):
        try:
            values.append(json.loads(line))
        except (ValueError, RecursionError):
            raise motion_file_error(f"{where}:{number}", "is not JSON") from None
    return values


def _names(keys: Mapping[str, Any], where: str) -> list[str] | None:
    """Names of the joints that a document has."""
    by_number = keys.get("keypoint_id2name")
    if isinstance(by_number, dict) and _is_texts([*by_number.values()]):
        numbered = sorted(
            by_number.items(), key=lambda pair: int(pair[0]) if pair[0].isdigit() else 0
        )
        return [name for _, name in numbered][:MAX_JOINTS]
    if isinstance(keys.get("keypoints"), list) and _is_texts(keys["keypoints"]):
        return list(keys["keypoints"][:MAX_JOINTS])
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
