"""Joints that jump: seconds across a jump are refused, with the seconds that are usable."""

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
    names,
    npz_bytes,
    trc_text,
)
from helpers.recorded import frames, write_bvh

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.recorded.clip import Clip, require_complete
from radhar_cli.motion.recorded.jumps import find_jumps
from radhar_cli.motion.recorded.keypoints import make_keypoints
from radhar_cli.motion.recorded.names import WANTED
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.reading import read_motion

WRIST = names("coco17").index("left_wrist")


def clip_of(p: Float) -> Clip:
    return answered_clip(make_keypoints("x.npz", names("coco17"), p, RATE))


@pytest.mark.parametrize("far", [0.4, 1.0, 5.0])
@pytest.mark.parametrize("length", [1, 2, 5, 12])
@pytest.mark.parametrize("joints", [[WRIST], [*range(17)]], ids=["a wrist", "all"])
def test_away_and_back_is_refused_with_the_seconds_beside_it(
    far: float, length: int, joints: list[int]
) -> None:
    p = COCO.copy()
    p[50 : 50 + length, joints] += [0, far, 0]
    clip = clip_of(p)
    with pytest.raises(MotionFileError, match=r"frame 51: \w+ jumps .*\(--section ") as refused:
        require_complete(clip, 0.0, clip.seconds)
    assert ("left_hand" in str(refused.value)) == (len(joints) == 1)
    begin, end = section_of(refused.value)
    require_complete(clip, begin, end)
    assert not 50 / RATE < begin < (50 + length) / RATE
    own = clip_of(COCO)
    inside = slice(round(begin * RATE) + 1, round(end * RATE))
    assert np.abs(clip.positions - own.positions)[inside].max() < 0.03


def section_of(refused: MotionFileError) -> tuple[float, float]:
    """Seconds of the command in a message."""
    section = re.search(r"--section ([\d.]+),([\d.]+)", str(refused))
    assert section is not None
    return float(section[1]), float(section[2])


def test_two_wrists_that_are_exchanged_for_a_frame_are_a_jump() -> None:
    p = COCO.copy()
    wrists = [names("coco17").index(f"{side}_wrist") for side in ("right", "left")]
    p[50][wrists] = p[50][wrists[::-1]]
    clip = clip_of(p)
    with pytest.raises(MotionFileError, match=r"frame 51: \w+_hand jumps"):
        require_complete(clip, 0.0, clip.seconds)


def test_somebody_who_stays_elsewhere_leaves_the_seconds_beside_it(tmp_path: Path) -> None:
    p = COCO.copy()
    p[60:] += [0, 0.8, 0]
    clip = clip_of(p)
    beside = r"usable are 0\.00 to 1\.81 s and 2\.15 to 4\.00 s: .*\(--section 2\.15,4\.00\)"
    jump = r"x\.npz: frame 61: \w+ jumps 0\.8\d* m from one frame to the next .*, as nobody"
    with pytest.raises(MotionFileError, match=f"{jump}.*{beside}"):
        require_complete(clip, 0.0, clip.seconds)
    require_complete(clip, 2.2, 4.0)
    path = write_bvh(tmp_path / "x.bvh", frames(seconds=1.0))
    lines = path.read_text().split("\n")
    begin = next(n for n, line in enumerate(lines) if line.startswith("Frame Time")) + 40
    lines[begin:-1] = ["900" + line[line.index(" ") :] for line in lines[begin:-1]]
    path.write_text("\n".join(lines))
    clip = answered_clip(read_motion(path).recording("x.bvh"))
    with pytest.raises(MotionFileError, match=rf"x\.bvh:{begin + 1}: \w+ jumps .*, as nobody"):
        require_complete(clip, 0.0, clip.seconds)


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
def test_a_t_pose_before_or_after_a_walk_is_refused_with_the_seconds_of_the_walk(
    is_end: bool, held: int, file: str, tmp_path: Path
) -> None:
    for at, degrees in (((0.0, 0.0), 0.0), (WALK_BEGINS, 180.0), (WALK_BEGINS, 75.0)):
        poses = np.repeat(t_pose(at, degrees)[None], held, axis=0)
        p = np.concatenate([WALKER, poses] if is_end else [poses, WALKER])
        (tmp_path / file).write_bytes(POSES_WRITERS[file](p))
        clip = answered_clip(read_motion(tmp_path / file).recording(file))
        with pytest.raises(MotionFileError, match=r"\w+ jumps .*section_s: \[") as refused:
            require_complete(clip, 0.0, clip.seconds)
        begin, end = section_of(refused.value)
        first, last = (0, len(WALKER)) if is_end else (held, len(p))
        assert begin == pytest.approx(0 if is_end else first / RATE, abs=0.2)
        assert end == pytest.approx((last - 1) / RATE, abs=0.2)
        require_complete(clip, begin, end)


@pytest.mark.parametrize("rate", [25.0, 30.0, 60.0, 120.0])
def test_a_t_pose_of_a_bvh_is_a_jump(rate: float, tmp_path: Path) -> None:
    p = frames(seconds=3.0, rate=rate)
    path = write_bvh(tmp_path / "x.bvh", np.concatenate([t_pose((0, 0), 0)[None], p]), rate)
    clip = answered_clip(read_motion(path).recording("x.bvh"))
    with pytest.raises(MotionFileError, match="jumps") as refused:
        require_complete(clip, 0.0, clip.seconds)
    assert section_of(refused.value)[0] < 1 / rate + 0.16


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


@pytest.mark.every(6)
@pytest.mark.parametrize("movement", MOVEMENTS)
@pytest.mark.parametrize("every", [2, 4, 8])
def test_no_movement_is_taken_for_a_jump(movement: str, every: int) -> None:
    """At 60, 30 and 15 frames a second, with 10 mm of noise: punches, kicks, jumps, falls."""
    p = frames(movement, 3.0, 120.0)[::every]
    p = p + np.random.default_rng(5).normal(0, 0.01, p.shape)
    file = make_keypoints("x", WANTED, p, 120.0 / every)
    assert find_jumps(file, p, 120.0 / every, 1.0) == ()
