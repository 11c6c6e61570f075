"""The vertical of a file that does not say it: found, or said to be assumed, or refused."""

from collections.abc import Callable

import numpy as np
import pytest
from helpers.recorded import frames

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.files.clip import Clip, make_clip
from radhar_cli.motion.files.keypoints import Keypoints
from radhar_cli.motion.files.names import WANTED
from radhar_cli.numerics.arrays import Float

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
