"""A clip becomes a person in a room: axes, size, floor, low-pass, heading, ends."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from helpers.poses import answered_clip
from helpers.recorded import frames, write_npz

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.recorded.clip import Clip, make_clip
from radhar_cli.motion.recorded.cycle import find_cycle
from radhar_cli.motion.recorded.keypoints import Keypoints
from radhar_cli.motion.recorded.motion import FileMotion
from radhar_cli.motion.recorded.names import WANTED
from radhar_cli.motion.skeleton import ANKLE_HEIGHT, JOINTS, PARENTS, leg_length
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.reading import read_motion

ANKLES = [JOINTS.index("right_ankle"), JOINTS.index("left_ankle")]
HIP, HEAD = JOINTS.index("hip"), JOINTS.index("head")


def clip(positions: Float, rate: float = 120.0, **how: object) -> Clip:
    return answered_clip(Keypoints("x.npz", WANTED, positions, rate), **how)  # type: ignore[arg-type]


def mover(one: Clip, **how: object) -> FileMotion:
    numbers = {"stature": one.stature, "weight": 80.0, "start": (0.0, 0.0), "heading": 0.0}
    return FileMotion(one, **{**numbers, "seconds": one.seconds, **how})  # type: ignore[arg-type]


@pytest.mark.parametrize("up", ["x", "y", "z", "-x", "-y", "-z"])
def test_any_axis_may_be_up_and_any_unit_will_do(up: str) -> None:
    """The same motion in six frames of axes and in cm is the same clip; the axis is asked for."""
    p = frames(seconds=1.0)
    right = clip(p)
    axis, sign = "xyz".index(up[-1]), -1 if up[0] == "-" else 1
    q = np.empty_like(p)
    # Ahead, left, up go to axes that keep the frame right-handed.
    q[..., axis] = sign * p[..., 2]
    q[..., (axis + 1) % 3], q[..., (axis + 2) % 3] = p[..., 0], sign * p[..., 1]
    found = clip(100 * q)
    a, b = (mover(one).positions(np.linspace(0, 1, 9)) for one in (right, found))
    np.testing.assert_allclose(a, b, atol=1e-9)
    assert found.stature == pytest.approx(right.stature)
    assert clip(100 * q, up=up).positions[:, 0, 2].mean() > 0


def test_a_camera_whose_y_points_down(tmp_path: Path) -> None:
    """x to the right, y down, z ahead of the camera; the person walks away from it."""
    p = frames(seconds=1.0)
    seen = np.stack([-p[..., 1], -p[..., 2], p[..., 0]], axis=2)
    one = clip(seen)
    assert one.up == "-y"
    np.testing.assert_allclose(one.positions, clip(p).positions, atol=1e-9)


@pytest.mark.parametrize("activity", ["walking", "punching", "kicking", "sitting_down", "grabbing"])
def test_a_mirror_image_is_asked_for_and_turned_back(activity: str) -> None:
    """Of left-handed axes (y up in Unity), or of a camera that mirrors: knees bend forwards."""
    p = frames(activity, 2.5)
    unity = np.stack([-p[..., 1], p[..., 2], p[..., 0]], axis=2)  # x right, y up, z ahead
    right_handed = np.stack([p[..., 1], p[..., 2], p[..., 0]], axis=2)
    assert clip(right_handed).up == "y"
    with pytest.raises(MotionFileError, match=r"knees that bend backwards.*\(--left-handed\)"):
        clip(unity)
    one = clip(unity, left_handed=True)
    t = np.linspace(0, 2, 9)
    a, b = (mover(each).positions(t) for each in (clip(p), one))
    np.testing.assert_allclose(a, b, atol=1e-9)


def test_where_nobody_stands_the_axis_is_asked_for() -> None:
    p = frames("stationary", 1.0)
    turned = np.linspace(0, 2 * np.pi, len(p))
    c, s = np.cos(turned)[:, None], np.sin(turned)[:, None]
    middle = p.mean(axis=(0, 1))
    q = p - middle
    rolls = np.stack([c * q[..., 0] - s * q[..., 2], q[..., 1], s * q[..., 0] + c * q[..., 2]], 2)
    with pytest.raises(MotionFileError, match=r"which axis points up .* \(--up -?[xyz]\)"):
        make_clip(Keypoints("x.npz", WANTED, rolls, 120.0))
    assert clip(rolls, up="y").up == "y"


def test_legs_give_the_stature_and_ankles_the_floor() -> None:
    """Contract: the human model's leg of that stature, lowest ankle at 0.039 of it."""
    one = clip(frames())
    p = one.positions
    legs = np.linalg.norm(p[:, 13] - p[:, 9], axis=1) + np.linalg.norm(p[:, 9] - p[:, 10], axis=1)
    assert np.median(legs) == pytest.approx(leg_length(one.stature) / one.stature, abs=1e-4)
    assert p[:, ANKLES, 2].min() == pytest.approx(ANKLE_HEIGHT)
    assert one.stature == pytest.approx(1.75, abs=1e-3)
    tall = mover(one, stature=2.0).positions(np.array([0.5]))[:, :, 0]
    small = mover(one, stature=1.6).positions(np.array([0.5]))[:, :, 0]
    np.testing.assert_allclose(tall - tall[:, :1], 1.25 * (small - small[:, :1]), atol=1e-9)


@pytest.mark.parametrize("rate", [60.0, 120.0])
def test_the_low_pass_is_8_hz_and_moves_nothing_in_time(rate: float) -> None:
    t, p = np.arange(round(6 * rate)) / rate, np.tile(frames(seconds=0.5)[:1], (1, 1, 1))
    rest, middle = np.repeat(p, t.size, axis=0), slice(round(2 * rate), round(4 * rate))
    for hertz, gain in ((1.0, 1.0), (8.0, 0.5**0.5), (25.0, 0.011)):
        moving = rest.copy()
        wave = 0.01 * np.sin(2 * np.pi * hertz * t)
        moving[:, 0, 0] += wave
        one = clip(moving, rate)
        found = (one.positions[:, 0, 0] - one.positions[:, HIP, 0]) * one.stature
        found = found - found.mean()
        measured = np.dot(found[middle], wave[middle]) / np.dot(wave[middle], wave[middle])
        assert measured == pytest.approx(gain, abs=0.015), hertz
    assert np.ptp(clip(moving, rate, low_pass=None).positions[:, 0, 0]) > 0.01


def test_heading_is_the_direction_of_travel_or_else_of_facing() -> None:
    there = np.array([0.7, -0.2, 0.0])
    for activity, turn in (("walking", 0.4), ("walking", 2.5), ("punching", 0.4)):
        p = frames(activity)
        c, s = np.cos(turn), np.sin(turn)
        turned = p @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + there
        q = mover(clip(turned), start=(2.0, 0.5), heading=np.pi / 2).positions(np.array([0.0, 2.9]))
        np.testing.assert_allclose(q[:2, ANKLES, 0].mean(axis=1), [2.0, 0.5], atol=1e-9)
        if activity == "walking":
            along = (q[:, HIP, 1] - q[:, HIP, 0])[:2]
            assert along[1] > 3
            assert abs(along[0]) < 0.02 * along[1]
        else:
            left = (
                q[:2, JOINTS.index("left_shoulder"), 0] - q[:2, JOINTS.index("right_shoulder"), 0]
            )
            assert left[0] < 0
            assert abs(left[1]) < 0.5 * abs(left[0])


def test_a_mirror_image_swaps_sides_and_speed_scales_time() -> None:
    one = clip(frames("kicking"))
    t = np.linspace(0, 1.4, 50)
    plain, mirrored = mover(one).positions(t), mover(one, mirrored=True).positions(t)
    swapped = [JOINTS.index(n.replace("right", "L").replace("left", "right").replace("L", "left"))
               for n in JOINTS]  # fmt: skip
    np.testing.assert_allclose(mirrored, plain[:, swapped] * [[[1]], [[-1]], [[1]]], atol=1e-9)
    fast = mover(one, speed=2.0, seconds=1.4).positions(t)
    np.testing.assert_allclose(fast, mover(one).positions(2 * t), atol=1e-9)
    later = mover(one, begin=0.5, seconds=1.0).positions(t[:10])
    shifted = mover(one).positions(t[:10] + 0.5)
    np.testing.assert_allclose(np.diff(later), np.diff(shifted), atol=1e-6)


LINKS = [(j, parent) for j, parent in enumerate(PARENTS) if parent is not None]


def link_lengths(p: Float) -> Float:
    """Lengths [links, M] of positions [3, 13, M]."""
    return np.stack([np.linalg.norm(p[:, j] - p[:, parent], axis=0) for j, parent in LINKS])


def test_past_its_end_a_motion_comes_to_rest() -> None:
    one = clip(frames("walking", 2.0))
    t = np.linspace(0, 4, 4001)
    motion = mover(one, seconds=4.0)
    assert motion.stops
    p = motion.positions(t)
    np.testing.assert_allclose(p[..., 2251:], np.repeat(p[..., -1:], 1750, axis=2), atol=1e-9)
    assert np.abs(np.diff(p, 2, axis=2)).max() * 1e6 < 120  # m/s^2: no jolt
    np.testing.assert_allclose(p[..., 4000], one.stature * _placed_last(one), atol=1e-6)
    early = t < 1.7
    np.testing.assert_allclose(p[..., early], mover(one).positions(t)[..., early], atol=1e-9)
    lengths, right = link_lengths(p), link_lengths(mover(one).positions(t[:2000]))
    assert lengths.max(axis=1) == pytest.approx(right.max(axis=1), abs=1e-3)
    assert not mover(clip(frames("stationary", 2.0)), seconds=4.0).stops
    assert not mover(one).stops


def _placed_last(one: Clip) -> Float:
    """The last frame [3, 13] of a walk along x from the origin, over the stature."""
    return (mover(one).positions(np.array([one.seconds])) / one.stature)[..., 0]


def looped(one: Clip, begin: float = 0.0, end: float | None = None, **how: object) -> FileMotion:
    cycle = find_cycle(one, begin, one.seconds if end is None else end)
    return mover(one, **{"begin": begin, "cycle": cycle, **how})


def test_a_walk_in_a_loop_walks_on() -> None:
    """2.7 s of a walk last for 20 s: as fast, straight on, in step, and nobody is torn apart."""
    one = clip(frames("walking", 2.7))
    motion = looped(one, seconds=20.0)
    assert motion.cycle is not None
    assert not motion.slides
    t = np.linspace(0, 20, 20_001)
    p = motion.positions(t)
    hip = p[:, HIP]
    speed = (hip[0, -1] - hip[0, 0]) / 20
    source = mover(one).positions(np.array([0.0, 2.7]))[0, HIP]
    assert speed == pytest.approx((source[1] - source[0]) / 2.7, rel=0.05)
    assert np.ptp(hip[1]) < 0.15
    v = np.diff(p, axis=2) * 1000
    alone = np.diff(mover(one).positions(t[:2700]), axis=2) * 1000
    assert np.linalg.norm(v, axis=0).max() < 1.1 * np.linalg.norm(alone, axis=0).max()
    a, own = np.abs(np.diff(v, axis=2)).max() * 1e3, np.abs(np.diff(alone, axis=2)).max() * 1e3
    assert a < 1.5 * own
    lengths = link_lengths(p) / link_lengths(p[..., :1])
    assert np.abs(lengths - 1).max() < 0.05
    assert p[2, ANKLES].min() > 0.9 * ANKLE_HEIGHT * one.stature
    # the feet still stand: whichever is lower is slow most of the time
    lower = p[2, ANKLES].argmin(axis=0)
    slow = np.linalg.norm(np.take_along_axis(v[:, ANKLES], lower[None, None, 1:], axis=1), axis=0)
    assert np.median(slow) < 0.15


def test_a_loop_plays_the_file_between_its_seams() -> None:
    one = clip(frames("walking", 2.7))
    motion = looped(one, seconds=20.0)
    cycle = motion.cycle
    assert cycle is not None
    assert 1.35 <= cycle.period <= 2.2 + 1e-9
    for number in (0, 1, 5):
        t = np.linspace(cycle.blend, cycle.period, 50)
        p = motion.positions(t + number * cycle.period)
        q = mover(one).positions(t)
        # relative to the hip, since the next cycle begins where the last one ended
        np.testing.assert_allclose(p - p[:, [HIP]], q - q[:, [HIP]], atol=5e-3)


def test_a_loop_of_a_turn_turns_on() -> None:
    """Somebody who goes a quarter of a circle in a file goes round in the loop."""
    p, rate = frames("walking", 3.0), 120.0
    distance = p[:, WANTED.index("hip"), 0]
    angle, radius = distance / 2.0, 2.0
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    ahead = p[..., 0] - distance[:, None]
    # about a centre 2 m to the left
    across = p[..., 1] - radius
    circle = np.stack([c * ahead - s * across, s * ahead + c * across, p[..., 2]], axis=2)
    motion = looped(clip(circle, rate), seconds=30.0)
    q = motion.positions(np.linspace(0, 30, 3001))[:2, HIP]
    assert np.ptp(q[0]) == pytest.approx(4, abs=0.5)
    assert np.ptp(q[1]) == pytest.approx(4, abs=0.5)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("heading", [0.0, 2.0])
def test_a_loop_leads_where_it_should(heading: float, mirrored: bool) -> None:
    one = clip(frames("walking", 2.7))
    motion = looped(one, seconds=12.0, heading=heading, mirrored=mirrored, start=(3.0, 1.0))
    p = motion.positions(np.array([0.0, 12.0]))[:2]
    np.testing.assert_allclose(p[:, ANKLES, 0].mean(axis=1), [3, 1], atol=1e-9)
    way = p[:, HIP, 1] - p[:, HIP, 0]
    assert np.arctan2(way[1], way[0]) == pytest.approx(heading, abs=0.02)


def test_a_loop_of_what_does_not_fit_is_warned_of() -> None:
    """Somebody who has sat down is not where somebody stands who sits down."""
    assert looped(clip(frames("sitting_down", 3.0)), seconds=10.0).slides
    assert not looped(clip(frames("stationary", 3.0)), seconds=10.0).slides
    with pytest.raises(MotionFileError, match=r"has 0\.25 s to repeat \(past_end: loop\)"):
        looped(clip(frames("walking", 3.0)), 1.0, 1.25)


@pytest.mark.parametrize("rate", [30.0, 60.0, 120.0])
def test_an_exported_walk_is_read_back_smoothly(rate: float) -> None:
    """Velocities are continuous, and those of the walk to some cm/s."""
    p = frames("walking", 4.0, rate)
    fine, one = frames("walking", 4.0, 1000.0), clip(p, rate)
    found = mover(one).positions(np.arange(1000, 3001) / 1000)
    right = fine[1000:3001, :13].transpose(2, 1, 0)
    error = np.gradient(found - right, 1e-3, axis=2)[:, ANKLES]
    assert np.sqrt((error**2).sum(axis=0).mean()) < (0.1 if rate == 30 else 0.03)
    jumps = np.abs(np.diff(found, 3, axis=2)).max() * 1e9
    assert jumps < 5e4


def test_torso_is_that_of_positions() -> None:
    motion, t = mover(clip(frames())), np.linspace(-0.2, 3.2, 400)
    np.testing.assert_allclose(motion.torso(t), motion.positions(t)[:, :1], atol=1e-12)
    marks = motion.landmark_positions(t)
    np.testing.assert_allclose(marks[:, 13:], motion.hip_joints(t), atol=1e-12)
    np.testing.assert_allclose(marks[:, :13], motion.positions(t), atol=1e-12)
    assert motion.cross_sections(t).shape == (13, 1)


def test_a_rig_without_hip_joints_has_them_at_the_hip(tmp_path: Path) -> None:
    p = frames(seconds=1.0)
    one = answered_clip(
        read_motion(write_npz(tmp_path / "x.npz", p[:, :13], names=JOINTS)).recording()
    )
    motion, t = mover(one), np.array([0.3])
    np.testing.assert_allclose(motion.hip_joints(t)[:, 0], motion.positions(t)[:, HIP], atol=1e-12)
    assert not one.hip_joints
    assert replace(one, rate=60.0).seconds == 2 * one.seconds
