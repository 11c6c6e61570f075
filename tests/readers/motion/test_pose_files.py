"""Poses in the formats that people have: the joints of a known walker come back from each."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import joint_set_errors
import numpy as np
import pytest
from helpers.poses import (
    BLAZE,
    COCO,
    NTU,
    RATE,
    WALKER,
    T,
    c3d_bytes,
    camera,
    clip_of,
    csv_text,
    landmarks,
    largest_error,
    names,
    npy_bytes,
    npz_bytes,
    skeleton_text,
    trc_text,
)
from helpers.recorded import frames, write_bvh
from helpers.tables import long_form, vicon

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS
from radhar_cli.numerics.arrays import Float

PREFIXES = ["Character1_", "Bob.", "actor-01 ", "Skel|", "person2", "Left", "hip_"]
PREFIXED: dict[str, tuple[str, Callable[[list[str]], bytes]]] = {
    "npz": ("x.npz", lambda n: npz_bytes(names=n, positions=COCO, rate=RATE)),
    "csv": ("x.csv", lambda n: csv_text(COCO, n).encode()),
    "trc": ("x.trc", lambda n: trc_text(COCO, n).encode()),
    "json": (
        "x.json",
        lambda n: json.dumps({"names": n, "positions": COCO.tolist(), "rate": RATE}).encode(),
    ),
    "Vicon": ("x.csv", lambda n: vicon(COCO, n)),
    "long": ("x.csv", lambda n: long_form(COCO, n)),
}


@pytest.mark.parametrize("form", PREFIXED)
@pytest.mark.parametrize("prefix", PREFIXES)
def test_what_all_names_begin_with_is_no_part_of_them(
    prefix: str, form: str, tmp_path: Path
) -> None:
    name, write = PREFIXED[form]
    data = write([prefix + joint for joint in names("coco17")])
    assert largest_error(clip_of(tmp_path / name, data)) < 0.01


def test_a_prefixed_hip_that_is_the_origin_is_not_lost(tmp_path: Path) -> None:
    prefixed = [f"Anna_{name}" for name in names("h36m17")]
    data = npz_bytes(names=prefixed, positions=H36M - H36M[:, :1], rate=30)
    clip = clip_of(tmp_path / "x.npz", data)
    assert not clip.bridged
    assert clip.marches


@pytest.mark.parametrize("pattern", ["Character1_{}", "{}_jnt", "Bob:{}", "a.b_{}", "x{}"])
@pytest.mark.parametrize("root", [None, "Reference"])
def test_a_bvh_whose_joints_have_a_prefix(pattern: str, root: str | None, tmp_path: Path) -> None:
    p = frames(seconds=1.0)
    text = write_bvh(tmp_path / "x.bvh", p).read_text()
    text = re.sub(r"(ROOT|JOINT) (\w+)", lambda m: f"{m[1]} {pattern.format(m[2])}", text)
    own = clip_of(write_bvh(tmp_path / "y.bvh", p)).positions
    if root is not None:  # a joint that hangs on one of another name
        head, rest = text.split("\n", 1)
        outer = f"{head}\nROOT {root}\n{{\nOFFSET 0 0 0\nCHANNELS 0\n"
        text = outer + rest.replace("ROOT ", "JOINT ", 1).replace("\nMOTION", "\n}\nMOTION")
    (tmp_path / "x.bvh").write_text(text)
    assert np.abs(clip_of(tmp_path / "x.bvh").positions - own).max() < 1e-9


H36M = joint_set_errors.poses_of(JOINT_SETS["h36m17"], WALKER)
OPENPOSE = joint_set_errors.poses_of(JOINT_SETS["openpose25"], WALKER)
TICKS = np.round(1e7 * T).astype(np.int64) + 635_000_000_000_000_000
FILES: dict[str, tuple[str, Callable[[], bytes]]] = {
    "NTU": ("x.skeleton", lambda: skeleton_text([camera(NTU) * [-1, -1, 1]]).encode()),
    "TRC": ("x.trc", lambda: trc_text(OPENPOSE, names("openpose25")).encode()),
    "C3D": ("x.c3d", lambda: c3d_bytes(COCO, names("coco17"))),
    "C3D of integers": ("x.c3d", lambda: c3d_bytes(COCO, names("coco17"), integers=True)),
    "C3D in cm": (
        "x.c3d",
        lambda: c3d_bytes(COCO / 10, names("coco17")).replace(b"\x01\x02mm", b"\x01\x02cm"),
    ),
    "C3D of MIPS": ("x.c3d", lambda: c3d_bytes(COCO, names("coco17"), order=">")),
    "CSV": ("x.csv", lambda: csv_text(COCO, names("coco17")).encode()),
    "CSV as nose.X;": ("x.csv", lambda: csv_text(COCO, names("coco17"), "{}.{}", ";").encode()),
    "CSV as x_nose": (
        "x.csv",
        lambda: csv_text(COCO, names("coco17"), "{1}_{0}", "\t").replace("{}", "").encode(),
    ),
    "CSV as x1, y1": (
        "x.csv",
        lambda: csv_text(BLAZE, [str(n) for n in range(33)], "{1}{0}").encode(),
    ),
    "MediaPipe": ("x.json", lambda: json.dumps(landmarks(BLAZE)).encode()),
    "MediaPipe in an object": ("x.json", lambda: json.dumps({"frames": landmarks(BLAZE)}).encode()),
    "JSON of arrays": (
        "x.json",
        lambda: json.dumps(
            {"names": names("coco17"), "positions": COCO.tolist(), "rate": RATE}
        ).encode(),
    ),
    "JSON of people": (
        "x.json",
        lambda: json.dumps(
            [
                {"t": t, "keypoints": [frame.tolist()]}
                for t, frame in zip(T.tolist(), BLAZE, strict=True)
            ]
        ).encode(),
    ),
    "npz with ticks": (
        "x.npz",
        lambda: npz_bytes(names=names("kinect2_25"), positions=NTU, timestamps=TICKS),
    ),
    "npz with ms": (
        "x.npz",
        lambda: npz_bytes(joint_names=names("coco17"), keypoints=1000 * COCO, time_ms=1000 * T),
    ),
    "npz without names": ("x.npz", lambda: npz_bytes(positions_3d=BLAZE, fps=30)),
    "npz of one person": (
        "x.npz",
        lambda: npz_bytes(names=names("coco17"), positions=COCO[:, None], rate=30),
    ),
}


WITHOUT_NAMES = ("CSV as x1, y1", "JSON of people", "npz without names")


@pytest.mark.parametrize("name", FILES)
def test_the_walker_comes_back(name: str, tmp_path: Path) -> None:
    file, data = FILES[name]
    (tmp_path / file).write_bytes(data())
    if name in WITHOUT_NAMES:
        with pytest.raises(MotionFileError, match=r"33 joints without .*--joints blazepose33"):
            clip_of(tmp_path / file)
    clip = clip_of(tmp_path / file, joints="blazepose33" if name in WITHOUT_NAMES else None)
    assert largest_error(clip) < 0.045
    assert clip.rate == pytest.approx(RATE, rel=2e-3)
    assert not clip.bridged


@pytest.mark.parametrize("array", [COCO, COCO.reshape(len(COCO), -1)], ids=["axes", "columns"])
def test_npy_has_neither_names_nor_a_rate(array: Float, tmp_path: Path) -> None:
    (tmp_path / "x.npy").write_bytes(npy_bytes(array))
    with pytest.raises(MotionFileError, match=r"17 joints without names; .*--joints coco17"):
        clip_of(tmp_path / "x.npy", rate=RATE)
    assert largest_error(clip_of(tmp_path / "x.npy", rate=RATE, joints="coco17")) < 0.01
    with pytest.raises(MotionFileError, match=r"should have a frame rate .*--rate HZ"):
        clip_of(tmp_path / "x.npy", joints="coco17")


def test_frames_at_uneven_instants_are_brought_to_an_even_rate(tmp_path: Path) -> None:
    """A Kinect's frames jitter by some ms, and some are dropped."""
    fine = joint_set_errors.walker(rate=600.0)
    rng = np.random.default_rng(3)
    rows = np.arange(0, len(fine), 20) + rng.integers(-3, 4, len(T))
    rows = np.delete(np.clip(rows, 0, len(fine) - 1), [20, 21, 70])
    p = joint_set_errors.poses_of(JOINT_SETS["kinect2_25"], fine)[rows]
    np.savez(tmp_path / "x.npz", names=names("kinect2_25"), positions=p, times=rows / 600)
    clip = clip_of(tmp_path / "x.npz", rate=None)
    at = np.arange(len(clip.positions)) / clip.rate + rows[0] / 600
    true = fine[np.clip(np.round(600 * at).astype(int), 0, len(fine) - 1), :13]
    errors = joint_set_errors.joint_errors(true, clip.positions[:, :13])
    assert errors.max() < 0.01
    assert "bridged" in clip.bridged


@pytest.mark.parametrize(
    ("file", "data", "message"),
    [
        (
            "x.json",
            json.dumps({"version": 1.3, "people": [{"pose_keypoints_2d": [1.0] * 75}]}),
            "is a frame of OpenPose with pose_keypoints_2d: pixels of an image",
        ),
        ("x.json", json.dumps([{"landmarks": [{"x": 0.1, "y": 0.2, "z": 0}]}]), "from 0 to 1"),
        ("x.json", json.dumps([[[1, 2], [3, 4]]]), "two coordinates: pixels"),
        ("x.json", "{", "is not JSON"),
        ("x.json", "[[1, 2, 3]]", "has 1 joints without names; no set"),
        ("x.csv", "time,a_x,a_y\n0,1,2\n", "a has x and y, but no z: pixels"),
        ("x.csv", "a,b\n1,2\n", r"x\.csv:1: should name its columns"),
        ("x.csv", "t,a_x,a_y,a_z\n0,1,2,3\n1,x,2,3\n", r"x\.csv:3: 'x' should be a number"),
        ("x.csv", "t,a_x,a_y,a_z\n0,1,2\n", r"x\.csv:2: has 3 columns; .* have 4"),
        ("x.trc", "hello\n", "is not a TRC file"),
        ("x.c3d", "hello", "is not a C3D file"),
        ("x.skeleton", "2\n1\n", "ends before a line with a body"),
        ("x.skeleton", "two\n", r"x\.skeleton:1: should be the number of frames"),
    ],
)
def test_what_cannot_be_read_is_refused_in_a_line(
    file: str, data: str, message: str, tmp_path: Path
) -> None:
    (tmp_path / file).write_text(data)
    with pytest.raises(MotionFileError, match=message) as refused:
        clip_of(tmp_path / file)
    assert str(refused.value).startswith("x.")
    assert "\n" not in str(refused.value)


def test_parameters_of_a_body_model_are_told_how_to_become_joints(tmp_path: Path) -> None:
    arrays = {"poses": np.zeros((9, 156)), "betas": np.zeros(16), "trans": np.zeros((9, 3))}
    np.savez(tmp_path / "x.npz", **arrays, mocap_framerate=120.0)  # type: ignore[arg-type]
    with pytest.raises(
        MotionFileError, match=r"body model .*smplx\.create.*np\.savez\(OUT, names="
    ):
        clip_of(tmp_path / "x.npz")


@pytest.mark.parametrize(
    ("columns", "kind", "rate_key", "model"),
    [
        (156, None, "mocap_framerate", "smplh"),
        (156, "smplh", "mocap_frame_rate", "smplh"),
        (165, "smplx", "mocap_frame_rate", "smplx"),
        (165, None, "mocap_frame_rate", "smplx"),
        (165, "SMPLX", "mocap_framerate", "smplx"),
        (72, None, "fps", "smpl"),
    ],
)
def test_the_lines_for_a_body_model_fit_the_file(
    columns: int, kind: str | None, rate_key: str, model: str, tmp_path: Path
) -> None:
    arrays = {"poses": np.zeros((9, columns)), "betas": np.zeros(16), "trans": np.zeros((9, 3))}
    arrays |= {rate_key: np.array(120.0), "gender": np.array("neutral")}
    arrays |= {} if kind is None else {"surface_model_type": np.array(kind)}
    with pytest.raises(MotionFileError) as refused:
        clip_of(tmp_path / "x.npz", npz_bytes(**arrays))
    assert f"smplx.create(MODELS, '{model}', batch_size=len(p['poses']))" in str(refused.value)
    assert f"rate=p['{rate_key}'])" in str(refused.value)


def test_the_lines_for_a_body_model_name_what_is_there(tmp_path: Path) -> None:
    data = npz_bytes(pose_body=np.zeros((9, 63)), betas=np.zeros(16), root_orient=np.zeros((9, 3)))
    with pytest.raises(MotionFileError, match=r"len\(p\['pose_body'\]\).* rate=HZ\)"):
        clip_of(tmp_path / "x.npz", data)


def test_a_second_body_that_is_there_briefly_is_no_person(tmp_path: Path) -> None:
    body = camera(NTU) * [-1, -1, 1]
    ghost = np.full_like(body, np.nan)
    ghost[10:30] = body[10:30] + 1
    (tmp_path / "x.skeleton").write_text(skeleton_text([ghost, body]))
    clip = clip_of(tmp_path / "x.skeleton")
    assert largest_error(clip) < 0.01
    assert "of 2 bodies" in clip.remarks[0]
    (tmp_path / "x.skeleton").write_text(skeleton_text([body + 1, body]))
    with pytest.raises(MotionFileError, match="has 2 people; should be one"):
        clip_of(tmp_path / "x.skeleton")


def test_a_body_that_is_counted_anew_is_one_person(tmp_path: Path) -> None:
    body = camera(NTU) * [-1, -1, 1]
    early, late = body.copy(), body.copy()
    early[60:], late[:63] = np.nan, np.nan
    (tmp_path / "x.skeleton").write_text(skeleton_text([early, late]))
    clip = clip_of(tmp_path / "x.skeleton")
    assert largest_error(clip) < 0.03
    assert "is one person" in clip.remarks[0]
    (tmp_path / "x.skeleton").write_text(skeleton_text([early, late + 2]))
    with pytest.raises(MotionFileError, match="has 2 people"):
        clip_of(tmp_path / "x.skeleton")


def write_coco(path: Path, p: Float) -> Path:
    np.savez(path, names=names("coco17"), positions=p, rate=RATE)
    return path


ELBOW, HIP = names("coco17").index("left_elbow"), names("coco17").index("right_hip")


@pytest.mark.parametrize("lost", [np.nan, 0.0])
def test_short_gaps_are_bridged_and_counted(lost: float, tmp_path: Path) -> None:
    p = COCO.copy()
    p[40:46, ELBOW] = lost
    p[80:83, ELBOW] = lost
    clip = clip_of(write_coco(tmp_path / "x.npz", p))
    assert clip.bridged.startswith("2 gaps of up to 0.5 s, 9 frames of 0.0333 s in all, bridged: ")
    assert clip.bridged.endswith("left_elbow")
    assert largest_error(clip) < 0.02
    assert not clip.lost


def test_long_gaps_are_refused_with_the_seconds_that_are_usable(tmp_path: Path) -> None:
    from radhar_cli.motion.recorded.clip import require_complete

    p = COCO.copy()
    p[30:60, HIP] = np.nan
    clip = clip_of(write_coco(tmp_path / "x.npz", p))
    with pytest.raises(MotionFileError, match=r"right_hip is lost from 0\.97 to 2\.00 s; .*usable"):
        require_complete(clip, 0.0, clip.seconds)
    with pytest.raises(
        MotionFileError, match=r"section_s: \[2\.00, 4\.00\] .*--section 2\.00,4\.00"
    ):
        require_complete(clip, 0.5, 1.5)
    require_complete(clip, 2.0, 4.0)
    require_complete(clip, 0.0, 0.96)


def test_frames_before_and_after_a_person_is_there_are_left_out(tmp_path: Path) -> None:
    p = COCO.copy()
    p[:9] = np.nan
    p[-15:] = 0
    clip = clip_of(write_coco(tmp_path / "x.npz", p))
    assert clip.usable == pytest.approx((9 / RATE, (len(p) - 16) / RATE))
    p[:] = np.nan
    with pytest.raises(MotionFileError, match=r"is lost .* in every frame"):
        clip_of(write_coco(tmp_path / "x.npz", p))


def test_a_hip_that_is_the_origin_is_not_lost(tmp_path: Path) -> None:
    p = H36M - H36M[:, :1]
    np.savez(tmp_path / "x.npz", names=names("h36m17"), positions=1000 * p, rate=30)
    clip = clip_of(tmp_path / "x.npz")
    assert not clip.bridged
    assert clip.marches


def test_who_never_moves_while_the_feet_step_marches(tmp_path: Path) -> None:
    hips = COCO[:, [HIP, HIP - 1]].mean(axis=1, keepdims=True)
    centred = write_coco(tmp_path / "x.npz", COCO - hips)
    assert clip_of(centred).marches
    assert not clip_of(write_coco(tmp_path / "y.npz", COCO)).marches


@pytest.mark.parametrize("noise", [0.0, 0.005])
def test_feet_on_the_floor_tell_the_path_of_the_hips(noise: float, tmp_path: Path) -> None:
    """Of hip-centred poses the walk comes back, 6 % short, and the bob of the hips."""
    hips = COCO[:, [HIP, HIP - 1]].mean(axis=1, keepdims=True)
    centred = COCO - hips + np.random.default_rng(0).normal(0, noise, COCO.shape)
    path = write_coco(tmp_path / "x.npz", centred)
    followed, true = clip_of(path, travel="feet"), clip_of(write_coco(tmp_path / "y.npz", COCO))
    hip = 8
    way = [np.linalg.norm(np.ptp(c.positions[:, hip, :2], axis=0)) for c in (followed, true)]
    assert 0.9 < way[0] / way[1] < 1.02
    assert not followed.marches
    assert np.std(followed.positions[:, hip, 2] - true.positions[:, hip, 2]) < 0.012
    velocity = [np.diff(c.positions[:, hip, :2], axis=0) * RATE for c in (followed, true)]
    assert np.abs(velocity[0] - velocity[1]).mean() < 0.075  # statures per second
