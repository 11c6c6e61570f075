"""The vertical of a file: that of its maker's document, or of the config, or asked for."""

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from helpers.poses import COCO, NTU, RATE, c3d_bytes, clip_of, names, npz_bytes, trc_text
from helpers.recorded import frames, write_amc, write_bvh

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.recorded.clip import Clip, make_clip
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS
from radhar_cli.motion.recorded.keypoints import Keypoints, make_keypoints
from radhar_cli.motion.recorded.names import WANTED
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.reading import read_motion

AXES: dict[str, Callable[[Float], Float]] = {
    "z": lambda p: p,
    "y": lambda p: np.stack([p[..., 1], p[..., 2], p[..., 0]], axis=-1),
    "-y": lambda p: np.stack([-p[..., 1], -p[..., 2], p[..., 0]], axis=-1),
}
OFTEN_LOW = ["lying", "turning_over", "trying_to_get_up", "crawling", "getting_up", "lying_down"]


def clip_in(p: Float, up: str | None = None) -> Clip:
    return make_clip(Keypoints("x.npz", WANTED, p, RATE), up=up)


@pytest.mark.parametrize("up", AXES)
@pytest.mark.parametrize("activity", ["walking", "waving", "falling", "sitting", *OFTEN_LOW])
def test_positions_alone_tell_no_vertical(activity: str, up: str) -> None:
    """Who lies straight looks as somebody who stands along another axis."""
    p = AXES[up](frames(activity, 2.0, RATE))
    with pytest.raises(MotionFileError, match=r"^x\.npz: .* which axis points up .*\(--up -?\w\)"):
        clip_in(p)
    assert clip_in(p, up).up == up


@pytest.mark.parametrize("up", AXES)
def test_the_axis_that_is_proposed_is_that_of_who_stands(up: str) -> None:
    with pytest.raises(MotionFileError, match=rf"along {up} in 100% of .*up: {up} of .*--up {up}"):
        clip_in(AXES[up](frames("walking", 2.0, RATE)))


KINECT, AZURE = names("kinect2_25"), names("azure32")


@pytest.mark.parametrize("activity", ["walking", "falling", "sitting", "squatting"])
def test_joints_of_a_maker_who_says_it_are_read(activity: str) -> None:
    """Kinect's y is up, and that of the Azure Kinect and of MediaPipe down, in its documents."""
    assert {key: s.up for key, s in JOINT_SETS.items() if s.up} == {
        **{"kinect1_20": "y", "kinect2_25": "y", "ntu25": "y", "humaneva15": "z", "xsens23": "z"},
        **{"blazepose33": "-y", "azure32": "-y", "panoptic19": "-y"},
    }
    file = make_keypoints("x", KINECT, AXES["y"](NTU), RATE)
    assert make_clip(file).up == "y"
    assert make_clip(make_keypoints("x", None, AXES["y"](NTU), RATE), "kinect2_25").up == "y"
    few = [n for n, name in enumerate(KINECT) if "Hand" not in name]
    with pytest.raises(MotionFileError, match="does not say which axis"):
        make_clip(make_keypoints("x", [KINECT[n] for n in few], AXES["y"](NTU)[:, few], RATE))


def test_who_stands_along_another_axis_than_the_documented_one_is_asked_for() -> None:
    """Joints of a Kinect that somebody turned to z up, or somebody who lies before one."""
    file = make_keypoints("x", KINECT, NTU, RATE)
    with pytest.raises(
        MotionFileError, match=r"has y up by its kind, but .* along z in 100%.*\(--up z\).*--up y"
    ):
        make_clip(file)
    assert make_clip(file, up="z").up == "z"


def test_bvh_amc_and_trc_have_y_up(tmp_path: Path) -> None:
    p = frames("sitting_down", 1.0, RATE)
    for path in (write_bvh(tmp_path / "x.bvh", p, RATE), write_amc(tmp_path / "x.amc", p)):
        assert make_clip(read_motion(path).recording("x")).up == "y"
    (tmp_path / "x.trc").write_text(trc_text(COCO, names("coco17")))
    assert make_clip(read_motion(tmp_path / "x.trc").recording("x")).up == "y"


def test_a_bvh_with_z_up_is_asked_for(tmp_path: Path) -> None:
    text = write_bvh(tmp_path / "x.bvh", AXES["y"](frames("walking", 1.0, RATE)), RATE).read_text()
    (tmp_path / "x.bvh").write_text(text)
    with pytest.raises(MotionFileError, match=r"has y up by its kind, but .*\(--up -?[xz]\)"):
        make_clip(read_motion(tmp_path / "x.bvh").recording("x"))


def with_screen(data: bytes, screen: bytes) -> bytes:
    """C3D whose POINT:Y_SCREEN says which axis points up; its name takes the place of a label."""
    body = struct.pack("<bBB", -1, 1, len(screen)) + screen + b"\0"
    entry = struct.pack("<bb", 8, 1) + b"Y_SCREEN" + struct.pack("<H", 0) + body
    at = data.index(b"UNITS")
    units = data[at - 2 : at + 5] + struct.pack("<H", 9) + data[at + 7 : at + 14]
    whole = units + entry
    return data[: at - 2] + whole + data[at - 2 + len(whole) :]


@pytest.mark.parametrize("screen", [b"+Z", b"+Y", b"-Y"])
def test_a_c3d_has_the_axis_of_its_screen(screen: bytes, tmp_path: Path) -> None:
    up = screen.decode().lower().lstrip("+")
    data = with_screen(c3d_bytes(AXES[up](COCO), names("coco17")), screen)
    path = tmp_path / "x.c3d"
    path.write_bytes(data)
    assert make_clip(read_motion(path).recording("x")).up == up
    path.write_bytes(c3d_bytes(AXES[up](COCO), names("coco17")))
    with pytest.raises(MotionFileError, match=rf"\(--up {up}\)"):
        make_clip(read_motion(path).recording("x"))


C3D_UNITS = {b"m ": 1.0, b"cm": 0.01, b"mm": 0.001, b"in": 0.0254}


@pytest.mark.parametrize("unit", C3D_UNITS)
@pytest.mark.parametrize("stature", [0.95, 1.75, 2.2])
def test_a_c3d_has_the_unit_that_it_says(unit: bytes, stature: float, tmp_path: Path) -> None:
    """POINT:UNITS in cm are cm, not what makes the likeliest person."""
    p = COCO * stature / 1.75 / C3D_UNITS[unit] / 1000
    data = c3d_bytes(p, names("coco17")).replace(b"\x01\x02mm", b"\x01\x02" + unit)
    clip = clip_of(tmp_path / "x.c3d", data)
    assert clip.unit == C3D_UNITS[unit]
    assert clip.stature == pytest.approx(stature, rel=0.1)
    assert read_motion(tmp_path / "x.c3d").recording("x").unit == C3D_UNITS[unit]


def test_a_c3d_whose_unit_makes_nobody_is_asked_for(tmp_path: Path) -> None:
    data = c3d_bytes(COCO, names("coco17")).replace(b"\x01\x02mm", b"\x01\x02cm")
    with pytest.raises(MotionFileError, match=r"of 17\.\d m in 0\.01 m; .*unit_m .*--unit M"):
        clip_of(tmp_path / "x.c3d", data)
    assert clip_of(tmp_path / "x.c3d", data, unit=0.001).unit == 0.001


@pytest.mark.parametrize("unit", [0.0254, 0.0254 / 0.45])
def test_units_that_are_no_decade_are_asked_for(unit: float, tmp_path: Path) -> None:
    data = npz_bytes(names=names("coco17"), positions=COCO / unit, rate=RATE)
    with pytest.raises(MotionFileError, match=r"in m or of .* in cm or of .* in mm.*--unit M"):
        clip_of(tmp_path / "x.npz", data)
    assert clip_of(tmp_path / "x.npz", data, unit=unit).stature == pytest.approx(1.75, rel=0.05)


def rest_along_x_bvh() -> str:
    """BVH whose bones are along x; its frames turn the root so that somebody stands along y."""
    arm = ("{}Arm 12 0 0", "{}ForeArm 30 0 0", "{}Hand 24 0 0")
    leg = ("{}UpLeg 0.1 1.5 {}", "{}Leg 43 0 0", "{}Foot 42 0 0", "{}Toe 17 0 0")
    lines, turns = ["HIERARCHY", "ROOT Hips", "{", "OFFSET 0 0 0"], ["0 94.5 120 90 0 0"]
    channels = "Zrotation Yrotation Xrotation"
    lines.append(f"CHANNELS 6 Xposition Yposition Zposition {channels}")

    def chain(joints: list[str], angles: list[str]) -> list[str]:
        text = []
        for joint, angle in zip(joints, angles, strict=True):
            name, offset = joint.split(" ", 1)
            text += [f"JOINT {name}", "{", f"OFFSET {offset}", f"CHANNELS 3 {channels}"]
            turns.append(angle)
        return [*text, "End Site", "{", "OFFSET 5 0 0", "}", *["}"] * len(joints)]

    for side, z in (("Left", "9"), ("Right", "-9")):
        angles = ["180 0 0", "0 0 0", "0 0 0", "80 0 0"]
        lines += chain([name.format(side, z) for name in leg], angles)
    spine = ["Spine 7 0 0", "Spine1 12 0 0", "Spine2 12 0 0"]
    for joint in spine:
        name, offset = joint.split(" ", 1)
        lines += [f"JOINT {name}", "{", f"OFFSET {offset}", f"CHANNELS 3 {channels}"]
        turns.append("0 0 0")
    lines += chain(["Neck 25 0 0", "Head 12 0 0"], ["0 0 0", "0 0 0"])
    for side, z, first in (("Left", "5", "0 -80 0"), ("Right", "-5", "0 80 0")):
        joints = [f"{side}Shoulder 18 0 {z}", *(name.format(side) for name in arm)]
        lines += chain(joints, [first, "{0} 0 0", "0 0 0", "0 0 0"])
    rows = [" ".join(turns).format(f"{20 * np.sin(n / 5):.3f}") for n in range(60)]
    end = ["}"] * 4
    return "\n".join([*lines, *end, "MOTION", "Frames: 60", "Frame Time: 0.033333", *rows, ""])


def test_a_bvh_with_bones_along_x_stands_along_y(tmp_path: Path) -> None:
    (tmp_path / "x.bvh").write_text(rest_along_x_bvh())
    one = make_clip(read_motion(tmp_path / "x.bvh").recording("x.bvh"))
    assert one.up == "y"
    p = one.positions
    assert 1.6 < one.stature < 1.85
    assert p[:, WANTED.index("head"), 2].min() > 0.85
    assert np.ptp(p[:, WANTED.index("right_hand")], axis=0).max() > 0.05
