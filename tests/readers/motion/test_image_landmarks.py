"""Poses of a picture are never taken for poses in space, in any file; units are said."""

import json
from collections.abc import Callable
from pathlib import Path

import joint_set_errors
import numpy as np
import pytest
from helpers.poses import (
    BLAZE,
    COCO,
    RATE,
    WALKER,
    T,
    answered_clip,
    camera,
    clip_of,
    csv_text,
    names,
    npy_bytes,
    npz_bytes,
    trc_text,
)

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS
from radhar_cli.motion.recorded.keypoints import make_keypoints
from radhar_cli.numerics.arrays import Float

SETS = ("blazepose33", "coco17", "h36m17")
# {name: (share of the picture's height that the body fills, width, height; None: from 0 to 1)}
PICTURES: dict[str, tuple[float, tuple[int, int] | None]] = {
    "from 0 to 1": (0.5, None),
    "from 0 to 1, tall": (0.57, None),
    "full HD": (0.5, (1920, 1080)),
    "full HD upright": (0.5, (1080, 1920)),
    "VGA": (0.5, (640, 480)),
    "small": (0.5, (320, 240)),
}


def picture_of(p: Float, key: str, name: str) -> Float:
    """Landmarks [frames, J, 3] of a picture: depth about the hips in the scale of x."""
    scale, size = PICTURES[name]
    width, height = size or (16, 9)
    hips = (WALKER[:, 13] + WALKER[:, 14])[:, None] / 2
    body = camera(p) - camera(hips)
    aspect = height / width
    across = np.linspace(-0.1, 0.1, len(p))[:, None]
    x = 0.5 + across + scale * aspect * body[..., 0]
    y, z = 0.5 + scale * body[..., 1], scale * aspect * body[..., 2]
    landmarks: Float = np.stack([x, y, z], axis=-1)
    return landmarks * ((1, 1, 1) if size is None else (width, height, width))


def json_bytes(p: Float, joints: list[str]) -> bytes:
    frames = [dict(zip(joints, frame, strict=True)) for frame in p.tolist()]
    return json.dumps({"fps": RATE, "frames": [{"joints": frame} for frame in frames]}).encode()


FILES: dict[str, tuple[str, Callable[[Float, list[str]], bytes]]] = {
    "npy": ("x.npy", lambda p, joints: npy_bytes(p)),
    "npz": ("x.npz", lambda p, joints: npz_bytes(names=joints, positions=p, rate=RATE)),
    "csv": ("x.csv", lambda p, joints: csv_text(p, joints).encode()),
    "json": ("x.json", json_bytes),
}


@pytest.mark.every(4)
@pytest.mark.parametrize("file", FILES)
@pytest.mark.parametrize("picture", PICTURES)
@pytest.mark.parametrize("key", SETS)
def test_landmarks_of_a_picture_are_refused(
    key: str, picture: str, file: str, tmp_path: Path
) -> None:
    p = picture_of(joint_set_errors.poses_of(JOINT_SETS[key], WALKER), key, picture)
    name, write = FILES[file]
    how = {"rate": RATE, "joints": key} if file == "npy" else {}
    with pytest.raises(MotionFileError) as refused:
        clip_of(tmp_path / name, write(p, names(key)), **how)
    message = str(refused.value)
    assert message.startswith(name)
    if PICTURES[picture][1] is None:
        assert "has x and y from 0 to 1, as landmarks of an image have" in message
        assert "pose_world_landmarks" in message
    elif "legs of" not in message and "as no body has" not in message:
        assert "hips without depth at other places than the origin, as pixels" in message


@pytest.mark.parametrize("file", FILES)
def test_who_says_the_unit_is_believed(file: str, tmp_path: Path) -> None:
    name, write = FILES[file]
    p = picture_of(BLAZE, "blazepose33", "from 0 to 1, tall")
    data = write(p, names("blazepose33"))
    how = {"rate": RATE, "joints": "blazepose33"} if file == "npy" else {}
    assert clip_of(tmp_path / name, data, unit=1.7, **how).stature > 1.6


def test_world_landmarks_and_rooms_are_read() -> None:
    """About the hips, and at places of positive x and y."""
    for p in (camera(BLAZE) - camera(BLAZE)[:, 23:25].mean(axis=1, keepdims=True), BLAZE + 3):
        clip = answered_clip(make_keypoints("x", names("blazepose33"), p, RATE))
        assert 1.7 < clip.stature < 1.85


def test_who_grows_as_he_comes_nearer_is_said() -> None:
    distance = np.linspace(4, 2, len(T))[:, None, None]
    p = 700 * (camera(COCO) - [0, 0.2, 0]) / distance
    p[..., 2] = 400 * (camera(COCO)[..., 2] + distance[..., 0])
    clip = answered_clip(make_keypoints("x", names("coco17"), p, RATE), unit=0.0025, up="-y")
    assert any("same bones are up to 1." in remark for remark in clip.remarks)


def test_a_unit_that_makes_no_person_is_asked_for(tmp_path: Path) -> None:
    text = trc_text(COCO, names("coco17")).replace("\tmm\t", "\tm\t")
    with pytest.raises(MotionFileError, match=r"of 1\.7\de\+03 m in 1 m; .*\(--unit M"):
        clip_of(tmp_path / "x.trc", text.encode())
    assert 1.7 < clip_of(tmp_path / "x.trc", unit=0.001).stature < 1.85


WORLD = camera(BLAZE) - camera(BLAZE)[:, 23:25].mean(axis=1, keepdims=True)
KEYS = ("landmarks", "pose_landmarks", "poseLandmarks", "pose_world_landmarks")


def landmark_files(key: str, p: Float) -> dict[str, object]:
    """JSON of landmarks under a key: objects and lists, in frames, lists of people, at the top."""
    lists = p.tolist()
    frames = [
        [dict(zip("xyz", xyz, strict=True), visibility=0.9) for xyz in body] for body in lists
    ]
    return {
        "a frame each": [{"time": n / RATE, key: frame} for n, frame in enumerate(frames)],
        "people": {"fps": RATE, "frames": [{key: [frame]} for frame in frames]},
        "lists": {"fps": RATE, "frames": [{key: frame} for frame in lists]},
        "at the top": {"fps": RATE, key: frames},
        "of a protocol": {"fps": RATE, "frames": [{key: {"landmark": frame}} for frame in frames]},
    }


@pytest.mark.parametrize("form", landmark_files("landmarks", WORLD))
@pytest.mark.parametrize("key", KEYS)
def test_values_tell_world_landmarks_of_any_key(key: str, form: str, tmp_path: Path) -> None:
    """Metres about the hips, of which half are negative, are no landmarks of an image."""
    assert WORLD.min() < -0.5
    data = json.dumps(landmark_files(key, WORLD)[form]).encode()
    clip = clip_of(tmp_path / "x.json", data)
    true = answered_clip(make_keypoints("x", names("blazepose33"), WORLD, RATE))
    assert clip.stature == pytest.approx(true.stature)
    assert np.abs(clip.positions - true.positions).max() < 1e-9


@pytest.mark.every(4)
@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.1, 0.35), (-0.5, 0.0), (0.42, 0.0)])
@pytest.mark.parametrize("form", landmark_files("landmarks", WORLD))
@pytest.mark.parametrize("key", KEYS[:3])
def test_landmarks_of_who_is_partly_outside_of_the_image_are_refused(
    key: str, form: str, shift: tuple[float, float], tmp_path: Path
) -> None:
    p = picture_of(BLAZE, "blazepose33", "from 0 to 1, tall") + np.append(shift, 0.0)
    with pytest.raises(MotionFileError, match=r"landmarks of an image.*pose_world_landmarks"):
        clip_of(tmp_path / "x.json", json.dumps(landmark_files(key, p)[form]).encode())


@pytest.mark.parametrize("suffix", ["npy", "npz", "csv"])
def test_world_landmarks_are_read_from_other_files(suffix: str, tmp_path: Path) -> None:
    name, write = FILES[suffix]
    how = {"rate": RATE, "joints": "blazepose33"} if suffix == "npy" else {}
    clip = clip_of(tmp_path / name, write(WORLD, names("blazepose33")), **how)
    assert 1.7 < clip.stature < 1.85
