"""Joints that jump: away and back is bridged and counted, the rest is left out or refused."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from helpers.poses import (
    COCO,
    RATE,
    WALKER,
    answered_clip,
    c3d_bytes,
    largest_error,
    names,
    npz_bytes,
    trc_text,
)
from helpers.recorded import frames, write_bvh, write_npz

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.recorded.clip import Clip, require_complete
from radhar_cli.motion.recorded.jumps import bridge_jumps, find_poses_apart
from radhar_cli.motion.recorded.keypoints import make_keypoints
from radhar_cli.motion.recorded.names import WANTED
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.reading import read_motion

WRIST = names("coco17").index("left_wrist")


def clip_of(p: Float) -> Clip:
    return answered_clip(make_keypoints("x.npz", names("coco17"), p, RATE))


@pytest.mark.parametrize("far", [0.3, 1.0, 5.0])
@pytest.mark.parametrize("length", [1, 2, 5, 12])
@pytest.mark.parametrize("joints", [[WRIST], [*range(17)]], ids=["a wrist", "all"])
def test_away_and_back_is_bridged_and_counted(far: float, length: int, joints: list[int]) -> None:
    if far < 0.5 and length > 1:
        pytest.skip("0.3 m for several frames of 1/30 s is what a limb may do")
    p = COCO.copy()
    p[50 : 50 + length, joints] += [0, far, 0]
    clip = clip_of(p)
    assert largest_error(clip) < 0.03
    (remark,) = clip.remarks
    assert f"within 0.5 s in {length} frames of 0.0333 s, which are bridged" in remark
    assert ("left_hand" in remark) == (len(joints) == 1)
    require_complete(clip, 0.0, clip.seconds)


def test_two_wrists_that_are_exchanged_for_a_frame_are_bridged() -> None:
    p = COCO.copy()
    ankles = [names("coco17").index(f"{side}_wrist") for side in ("right", "left")]
    p[50][ankles] = p[50][ankles[::-1]]
    clip = clip_of(p)
    assert largest_error(clip) < 0.02
    assert "right_hand, left_hand" in clip.remarks[0]


def test_somebody_who_stays_elsewhere_leaves_the_seconds_beside_it(tmp_path: Path) -> None:
    p = COCO.copy()
    p[60:] += [0, 0.8, 0]
    clip = clip_of(p)
    beside = r"usable are 0\.00 to 1\.81 s and 2\.15 to 4\.00 s: .*\(--section 2\.15,4\.00\)"
    jump = r"x\.npz: frame 61: \w+ jumps 0\.8\d* m from one frame to the next .* 15 m/s at most"
    with pytest.raises(MotionFileError, match=f"{jump}.*{beside}"):
        require_complete(clip, 0.0, clip.seconds)
    require_complete(clip, 2.2, 4.0)
    path = write_bvh(tmp_path / "x.bvh", frames(seconds=1.0))
    lines = path.read_text().split("\n")
    begin = next(n for n, line in enumerate(lines) if line.startswith("Frame Time")) + 40
    lines[begin:-1] = ["900" + line[line.index(" ") :] for line in lines[begin:-1]]
    path.write_text("\n".join(lines))
    clip = answered_clip(read_motion(path).recording("x.bvh"))
    with pytest.raises(MotionFileError, match=rf"x\.bvh:{begin + 1}: \w+ jumps .* 15 m/s at most"):
        require_complete(clip, 0.0, clip.seconds)


def test_a_frame_of_a_bvh_that_is_elsewhere_is_bridged(tmp_path: Path) -> None:
    p = frames(seconds=1.0, rate=60.0)
    q = p.copy()
    q[30] += [0.7, 0, 0]
    own, other = (
        answered_clip(read_motion(write_npz(tmp_path / f"{n}.npz", x, 60.0)).recording("x"))
        for n, x in enumerate((p, q))
    )
    assert np.abs(own.positions - other.positions).max() < 0.01


def t_pose(at: tuple[float, float], degrees: float) -> Float:
    """Somebody who stands with arms held out to the sides, [15, 3] in m."""
    halves = {"shoulder": (0.18, 1.43), "elbow": (0.47, 1.43), "hand": (0.73, 1.43)}
    halves |= {"hip_joint": (0.08, 0.93), "knee": (0.08, 0.5), "ankle": (0.08, 0.07)}
    middle = {"hip": (0.0, 0.93), "torso": (0.0, 1.25), "head": (0.0, 1.6)}
    sides = {f"{s}_{part}": (k * y, z) for s, k in SIDES for part, (y, z) in halves.items()}
    places = {**middle, **sides}
    p = np.array([[0.0, *places[name]] for name in WANTED])
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turned: Float = p @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [*at, 0.0]
    return turned


SIDES = (("left", 1), ("right", -1))
WALK_BEGINS = (float(WALKER[0, 8, 0]), float(WALKER[0, 8, 1]))
POSES_WRITERS = {
    "x.csv": lambda p: rows_of_csv(p).encode(),
    "x.trc": lambda p: trc_text(p, list(WANTED)).encode(),
    "x.c3d": lambda p: c3d_bytes(p, list(WANTED)),
    "x.npz": lambda p: npz_bytes(names=WANTED, positions=p, rate=RATE),
    "x.json": lambda p: json.dumps(
        {"names": WANTED, "positions": p.tolist(), "rate": RATE}
    ).encode(),
}


def rows_of_csv(p: Float) -> str:
    """Table of more frames than those of the walker."""
    head = ",".join(["time", *(f"{name}_{axis}" for name in WANTED for axis in "xyz")])
    rows = [",".join(f"{v:.5f}" for v in [n / RATE, *f.ravel()]) for n, f in enumerate(p)]
    return "\n".join([head, *rows])


@pytest.mark.parametrize("file", POSES_WRITERS)
@pytest.mark.parametrize("held", [1, 2, 30])
@pytest.mark.parametrize("is_end", [False, True], ids=["before", "after"])
def test_a_t_pose_before_or_after_a_walk_is_left_out(
    is_end: bool, held: int, file: str, tmp_path: Path
) -> None:
    for at, degrees in (((0.0, 0.0), 0.0), (WALK_BEGINS, 180.0), (WALK_BEGINS, 75.0)):
        poses = np.repeat(t_pose(at, degrees)[None], held, axis=0)
        p = np.concatenate([WALKER, poses] if is_end else [poses, WALKER])
        (tmp_path / file).write_bytes(POSES_WRITERS[file](p))
        clip = answered_clip(read_motion(tmp_path / file).recording(file))
        assert len(clip.positions) == len(WALKER)
        assert largest_error(clip) < 0.01
        (remark,) = clip.remarks
        count = "frame is" if held == 1 else f"{held} frames are"
        assert f"its {'last' if is_end else 'first'} {count} left out" in remark
        assert is_end or f"seconds count from frame {held + 1}" in remark
        require_complete(clip, 0.0, clip.seconds)


@pytest.mark.parametrize("rate", [10.0, 15.0, 25.0, 30.0, 60.0, 120.0])
def test_a_t_pose_of_a_bvh_is_left_out(rate: float, tmp_path: Path) -> None:
    p = frames(seconds=3.0, rate=rate)
    path = write_bvh(tmp_path / "x.bvh", np.concatenate([t_pose((0, 0), 0)[None], p]), rate)
    clip = answered_clip(read_motion(path).recording("x.bvh"))
    own = answered_clip(read_motion(write_npz(tmp_path / "y.npz", p, rate)).recording("x"))
    assert np.abs(clip.positions - own.positions).max() < 1e-5
    assert not clip.lost


def test_no_usable_seconds_end_before_they_begin() -> None:
    """Jumps near the beginning, near each other, and beside a joint that is lost for long."""
    p = COCO.copy()
    p[2:, :, 1] += 3
    p[4:, :, 0] -= 4
    p[50:90, WRIST] = np.nan
    p[60:] += 2
    p[-2:] -= 5
    clip = clip_of(p)
    with pytest.raises(MotionFileError) as refused:
        require_complete(clip, 0.0, clip.seconds)
    pairs = re.findall(r"(-?[\d.]+) to (-?[\d.]+) s", str(refused.value).split("usable are")[1])
    assert pairs
    edges = [float(edge) for pair in pairs for edge in pair]
    assert edges == sorted(edges)
    assert all(a < b for a, b in zip(edges[::2], edges[1::2], strict=True))
    assert edges[0] >= 0
    for a, b in zip(edges[::2], edges[1::2], strict=True):
        require_complete(clip, a, b)


@pytest.mark.parametrize("movement", MOVEMENTS)
@pytest.mark.parametrize("every", [2, 4, 8])
def test_no_movement_has_a_pose_apart(movement: str, every: int) -> None:
    p = frames(movement, 3.0, 120.0)
    for first in (0, 17, 90):
        q = p[first::every]
        assert find_poses_apart(q, 120.0 / every, 1.0) == (0, len(q) - 1, ())


@pytest.mark.parametrize("movement", MOVEMENTS)
@pytest.mark.parametrize("every", [2, 4, 8])
def test_no_movement_is_taken_for_a_jump(movement: str, every: int) -> None:
    """At 60, 30 and 15 frames a second, with 10 mm of noise: punches, kicks, jumps, falls."""
    p = frames(movement, 3.0, 120.0)[::every]
    p = p + np.random.default_rng(5).normal(0, 0.01, p.shape)
    _, is_away = bridge_jumps(p, 120.0 / every, 1.0)
    assert not is_away.any()
