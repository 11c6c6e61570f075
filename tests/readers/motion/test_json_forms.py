"""JSON of recorders, networks and depth cameras, and folders of a file a frame."""

import json
from pathlib import Path
from typing import Any

import joint_set_errors
import numpy as np
import pytest
from helpers.json_forms import JSON_FORMS, azure
from helpers.poses import (
    BLAZE,
    COCO,
    RATE,
    WALKER,
    T,
    camera,
    clip_of,
    joint_errors,
    largest_error,
    names,
)

from radhar_cli.errors import FolderError, MotionFileError
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS
from radhar_cli.readers.motion.reading import read_motion

SETS = ("coco17", "h36m17", "kinect2_25", "azure32", "zed38", "blazepose33")
PIXELS = (500 + 300 * camera(COCO)[..., :2]).round(1)
OPENPOSE = joint_set_errors.poses_of(JOINT_SETS["openpose25"], WALKER)


@pytest.mark.every(4)
@pytest.mark.parametrize("form", JSON_FORMS)
@pytest.mark.parametrize("key", SETS)
def test_the_walker_comes_back_from_every_json(form: str, key: str, tmp_path: Path) -> None:
    suffix, write = JSON_FORMS[form]
    p = joint_set_errors.poses_of(JOINT_SETS[key], WALKER)
    said = {"joints": key} if form == "ZED" else {}  # whose objects have any of its sets
    clip = clip_of(tmp_path / f"x{suffix}", write(p, names(key)), **said)
    errors = joint_errors(clip)
    assert errors.mean() < 0.03
    assert errors.max() < 0.07
    assert clip.rate == pytest.approx(RATE, rel=2e-3)
    assert not clip.bridged
    assert [r.startswith("of 2 bodies") for r in clip.remarks] == [True] * (form == "Azure Kinect")


def test_two_bodies_that_stay_are_refused(tmp_path: Path) -> None:
    document = azure(COCO, names("coco17"))
    for frame in document["frames"]:
        frame["bodies"] = [
            {"body_id": n, "joint_positions": frame["bodies"][-1]["joint_positions"]}
            for n in (1, 2)
        ]
    with pytest.raises(MotionFileError, match="frame 1: has 2 people; should be one: keep the"):
        clip_of(tmp_path / "x.json", json.dumps(document).encode())


def test_frames_without_a_body_are_a_gap(tmp_path: Path) -> None:
    document = azure(COCO, names("coco17"))
    for frame in document["frames"][40:45]:
        frame["bodies"] = []
    clip = clip_of(tmp_path / "x.json", json.dumps(document).encode())
    assert clip.bridged.startswith("14 gaps of up to 0.5 s, 70 frames of 0.0333 s")
    assert largest_error(clip) < 0.03


FLAT = [[v for x, y in frame for v in (x, y, 0.9)] for frame in PIXELS.tolist()]
IMAGES: dict[str, Any] = {
    "AlphaPose": [
        {"image_id": f"{n}.jpg", "keypoints": k, "score": 2.9} for n, k in enumerate(FLAT)
    ],
    "AlphaPose as CMU": {f"{n}.jpg": {"bodies": [{"joints": k}]} for n, k in enumerate(FLAT)},
    "MMPose": {
        "instance_info": [
            {"frame_id": n, "instances": [{"keypoints": k}]} for n, k in enumerate(PIXELS.tolist())
        ]
    },
    "HuPR": [{"joints": k, "image": f"{n:09d}.jpg"} for n, k in enumerate(PIXELS.tolist())],
    "COCO": {
        "images": [{"id": 1}],
        "annotations": [{"id": n, "image_id": n, "keypoints": k} for n, k in enumerate(FLAT)],
        "categories": [{"id": 1, "name": "person", "keypoints": names("coco17")}],
    },
    "OpenPose": [{"version": 1.3, "people": [{"pose_keypoints_2d": k}]} for k in FLAT],
}


@pytest.mark.parametrize("form", IMAGES)
def test_pixels_are_refused_as_such(form: str, tmp_path: Path) -> None:
    with pytest.raises(MotionFileError, match=r"pixels of an image; a radar needs 3-D positions"):
        clip_of(tmp_path / "x.json", json.dumps(IMAGES[form]).encode())


def write_folder(folder: Path, frames: list[Any]) -> Path:
    folder.mkdir()
    for n, frame in enumerate(frames):
        (folder / f"walk_{n:012d}_keypoints.json").write_text(json.dumps(frame))
    return folder


def openpose_frames() -> list[Any]:
    return [
        {"people": [{"person_id": [-1], "pose_keypoints_3d": [v for x in f for v in (*x, 0.9)]}]}
        for f in camera(OPENPOSE).tolist()
    ]


def test_a_folder_of_frames_is_one_recording(tmp_path: Path) -> None:
    clip = clip_of(write_folder(tmp_path / "openpose.3d", openpose_frames()), rate=RATE)
    assert largest_error(clip) < 0.01
    assert clip.remarks == ()
    marks = [
        {"pose_world_landmarks": [dict(zip("xyz", xyz, strict=True)) for xyz in f]}
        for f in camera(BLAZE).tolist()
    ]
    assert largest_error(clip_of(write_folder(tmp_path / "mediapipe", marks), rate=RATE)) < 0.01


def test_a_frame_that_a_folder_leaves_out_is_lost(tmp_path: Path) -> None:
    folder = write_folder(tmp_path / "x", openpose_frames())
    for n in (50, 51, 52):
        (folder / f"walk_{n:012d}_keypoints.json").unlink()
    clip = clip_of(folder, rate=RATE)
    assert len(clip.positions) == len(T)
    assert clip.bridged.startswith("15 gaps of up to 0.5 s, 45 frames of 0.0333 s")
    assert largest_error(clip) < 0.03


def test_a_folder_of_pixels_or_of_other_files_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MotionFileError, match=r"x: frame 1: is a frame of OpenPose .*pixels of an"):
        clip_of(write_folder(tmp_path / "x", IMAGES["OpenPose"]))
    for name, message in (
        ("a.png", "folder of .png images; a pose network makes joints"),
        ("a.npy", r"p = np\.stack\(\[np\.load\(f\) for f in sorted"),
        ("a.bvh", r"name one of them, or all in a class, files: \[FOLDER/\*\.bvh\]"),
        (".hidden", "is a folder without files"),
    ):
        folder = tmp_path / f"of{name}"
        folder.mkdir()
        (folder / name).write_bytes(b"")
        with pytest.raises(MotionFileError, match=message):
            read_motion(folder)


def test_a_folder_reads_nothing_outside(tmp_path: Path) -> None:
    folder = write_folder(tmp_path / "x", openpose_frames()[:3])
    (tmp_path / "secret.json").write_text("[]")
    (folder / "link_4.json").symlink_to(tmp_path / "secret.json")
    with pytest.raises(FolderError, match="lies outside"):
        read_motion(folder)


def test_one_frame_of_a_folder_is_told_to_be_one(tmp_path: Path) -> None:
    with pytest.raises(MotionFileError, match=r"one frame of several; name the folder .*--motion"):
        clip_of(tmp_path / "x.json", json.dumps(openpose_frames()[0]).encode())


def test_joints_by_number_are_ordered_by_it(tmp_path: Path) -> None:
    order = np.random.default_rng(0).permutation(17)
    frames = [
        {"t": t, "joints": [{"JointType": int(n), "Position": body[n]} for n in order]}
        for t, body in zip(T.tolist(), COCO.tolist(), strict=True)
    ]
    data = json.dumps(frames).encode()
    assert largest_error(clip_of(tmp_path / "x.json", data, joints="coco17")) < 0.01
