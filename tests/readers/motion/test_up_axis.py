"""The vertical of a file that does not say it: found, or said to be assumed, or refused."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from helpers.recorded import frames

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.recorded.clip import Clip, make_clip
from radhar_cli.motion.recorded.keypoints import Keypoints
from radhar_cli.motion.recorded.names import WANTED
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.reading import read_motion

RATE = 30.0
AXES: dict[str, Callable[[Float], Float]] = {
    "z": lambda p: p,
    "y": lambda p: np.stack([p[..., 1], p[..., 2], p[..., 0]], axis=-1),
    "-y": lambda p: np.stack([-p[..., 1], -p[..., 2], p[..., 0]], axis=-1),
}


def clip_of(p: Float) -> Clip:
    return make_clip(Keypoints("x.npz", WANTED, p, RATE))


@pytest.mark.parametrize("up", AXES)
@pytest.mark.parametrize("activity", ["falling", "falling_on_hands", "falling_on_rising"])
def test_who_falls_and_lies_for_most_of_it_stood_before(activity: str, up: str) -> None:
    p = frames(activity, 2.0, RATE)
    lies = np.repeat(p[-1:], 150, axis=0)
    one = clip_of(AXES[up](np.concatenate([p, lies])))
    assert one.up == up
    (remark,) = one.remarks
    assert f"if {up} points up" in remark
    assert "--up " in remark


@pytest.mark.parametrize("up", AXES)
@pytest.mark.parametrize(
    "activity", ["lying", "turning_over", "trying_to_get_up", "crawling", "getting_up"]
)
def test_who_lies_or_crawls_is_never_stood_up_in_silence(activity: str, up: str) -> None:
    p = AXES[up](frames(activity, 2.0, RATE))
    try:
        one = clip_of(p)
    except MotionFileError as refused:
        assert "--up" in str(refused)  # noqa: PT017
    else:
        assert one.up == up or any(f"{one.up} is assumed" in remark for remark in one.remarks)


@pytest.mark.parametrize("up", AXES)
def test_who_crawls_away_tells_no_vertical(up: str) -> None:
    with pytest.raises(MotionFileError, match=r"which axis points up.*\(--up y\)"):
        clip_of(AXES[up](frames("crawling", 6.0, RATE)))


def test_of_two_axes_that_fit_both_are_named() -> None:
    """Who gets up slowly along y of a file might as well lie down along its z."""
    with pytest.raises(MotionFileError, match="somebody is upright along y and z"):
        clip_of(AXES["y"](frames("getting_up", 6.0, RATE)))


@pytest.mark.parametrize("up", AXES)
@pytest.mark.parametrize("activity", ["walking", "squatting", "jumping", "running"])
def test_who_walks_or_squats_needs_no_remark(activity: str, up: str) -> None:
    one = clip_of(AXES[up](frames(activity, 3.0, RATE)))
    assert one.up == up
    assert one.remarks == ()


@pytest.mark.parametrize("activity", ["sitting", "stationary"])
def test_who_stays_has_the_axis_that_is_assumed_said(activity: str) -> None:
    one = clip_of(AXES["y"](frames(activity, 2.0, RATE)))
    assert one.up == "y"
    assert "y is assumed to point up" in one.remarks[0]


# Angles and places that were not looked at when the thresholds of up_axis.py were chosen; what
# came out of these movements at other angles was.
OFTEN_LOW = ["lying_down", "getting_up_from_bed", "getting_on_fours", "kneeling", "drinking_seated"]
OFTEN_LOW += ["waving", "punching", "raising_left_leg", "writing", "clapping"]
PLACES = {"a room": (1.7, -0.6, 0.0), "a bed": (-0.9, 2.2, 0.55), "a camera": (2.6, 0.3, -1.1)}


def turned(p: Float, degrees: float, place: tuple[float, float, float]) -> Float:
    """Positions turned about the vertical, at a place."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    shifted: Float = (p - [2, 0, 0]) @ turn + np.array(place)
    return shifted


def clip_unless_asked(p: Float) -> Clip | None:
    try:
        return clip_of(p)
    except MotionFileError as refused:
        assert "--up" in str(refused)  # noqa: PT017
        return None


@pytest.mark.parametrize("up", AXES)
@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("activity", OFTEN_LOW)
def test_at_other_angles_and_places_no_vertical_is_wrong(
    activity: str, place: str, up: str
) -> None:
    for degrees in (8, 61, 143, 262, 300):
        p = turned(frames(activity, 2.0, RATE), degrees, PLACES[place])
        one = clip_unless_asked(AXES[up](p))
        assert one is None or one.up == up, (degrees, one.remarks)


@pytest.mark.parametrize("up", AXES)
@pytest.mark.parametrize("place", ["a room", "a bed"])
@pytest.mark.parametrize("activity", ["lying", "turning_over", "crawling", "trying_to_get_up"])
def test_who_lies_or_crawls_for_two_seconds_is_asked_for(
    activity: str, place: str, up: str
) -> None:
    for degrees in (0, 8, 90, 180, 262):
        p = turned(frames(activity, 2.0, RATE), degrees, PLACES[place])
        assert clip_unless_asked(AXES[up](p)) is None, degrees


def test_who_stands_in_front_of_a_camera_is_not_asked_for() -> None:
    for activity in ("waving", "punching", "clapping", "raising_arms"):
        for degrees in (0, 90, 180):
            p = turned(frames(activity, 2.0, RATE), degrees, PLACES["a camera"])
            one = clip_unless_asked(AXES["-y"](p))
            assert one is not None
            assert one.up == "-y"


@dataclass(frozen=True)
class Posed(Keypoints):
    """Positions with a rest pose of their own."""

    rest: Float | None = None  # type: ignore[assignment]


def rest_along(axis: str) -> Float:
    """Positions [15, 3] of somebody who stands along an axis."""
    p, number = frames("stationary", 0.1, RATE)[0], "xyz".index(axis[-1])
    sign = -1 if axis[0] == "-" else 1
    rest: Float = np.roll(p * [1, sign, sign], number - 2, axis=1)
    return rest


@pytest.mark.parametrize("up", AXES)
@pytest.mark.parametrize("rest", ["x", "-x", "y", "z", "-z"])
@pytest.mark.parametrize("activity", ["waving", "stationary", "raising_arms"])
def test_frames_go_before_the_rest_pose(activity: str, rest: str, up: str) -> None:
    """In public data sets bones are along x in the rest pose; frames turn the root."""
    p = AXES[up](frames(activity, 2.0, RATE))
    one = make_clip(Posed("x.bvh", WANTED, p, RATE, rest=rest_along(rest)))
    assert one.up == up
    remarks = [remark for remark in one.remarks if f"{up} is assumed to point up" in remark]
    assert len(remarks) == (rest != up)


@pytest.mark.parametrize("rest", ["x", "-x", "y"])
@pytest.mark.parametrize("activity", ["lying", "turning_over", "crawling", "trying_to_get_up"])
def test_who_lies_is_not_stood_up_by_a_rest_pose(activity: str, rest: str) -> None:
    for degrees in (0, 8, 90, 180, 262):
        p = AXES["y"](turned(frames(activity, 2.0, RATE), degrees, PLACES["a room"]))
        file = Posed("x.bvh", WANTED, p, RATE, rest=rest_along(rest))
        try:
            assert make_clip(file).up == "y"
        except MotionFileError as refused:
            assert "--up" in str(refused)  # noqa: PT017


def test_another_vertical_than_a_standing_rest_pose_needs_a_floor() -> None:
    """Who is straight along z of a file whose rest pose stands along y may as well lie."""
    p = frames("waving", 2.0, RATE)
    for shift, is_asked in ((0.0, False), (0.9, True)):
        file = Posed("x.bvh", WANTED, p - [0, 0, shift], RATE, rest=rest_along("y"))
        try:
            assert make_clip(file).up == "z"
        except MotionFileError as refused:
            assert is_asked
            assert "upright along z and y in its rest pose" in str(refused)  # noqa: PT017
        else:
            assert not is_asked


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
    assert "y is assumed to point up" in one.remarks[0]
    p = one.positions
    assert 1.6 < one.stature < 1.85
    assert p[:, WANTED.index("head"), 2].min() > 0.85
    assert np.ptp(p[:, WANTED.index("right_hand")], axis=0).max() > 0.05
