"""Joints that jump: away and back is bridged and counted, the rest is left out or refused."""

from pathlib import Path

import numpy as np
import pytest
from helpers.poses import COCO, RATE, largest_error, names
from helpers.recorded import frames, write_bvh, write_npz

from radhar_cli.activities.activity import MOVEMENTS
from radhar_cli.errors import MotionFileError
from radhar_cli.motion.files.clip import Clip, make_clip, require_complete
from radhar_cli.motion.files.jumps import bridge_jumps
from radhar_cli.motion.files.keypoints import make_keypoints
from radhar_cli.motion.files.reading import read_motion
from radhar_cli.numerics.arrays import Float

WRIST = names("coco17").index("left_wrist")


def clip_of(p: Float) -> Clip:
    return make_clip(make_keypoints("x.npz", names("coco17"), p, RATE))


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
    beside = r"usable are 0\.00 to 1\.82 s and 2\.15 to 4\.00 s: .*\(--section 2\.15,4\.00\)"
    jump = r"x\.npz: frame 61: \w+ jumps 0\.8\d* m from one frame to the next .* 15 m/s at most"
    with pytest.raises(MotionFileError, match=f"{jump}.*{beside}"):
        require_complete(clip, 0.0, clip.seconds)
    require_complete(clip, 2.2, 4.0)
    path = write_bvh(tmp_path / "x.bvh", frames(seconds=1.0))
    lines = path.read_text().split("\n")
    begin = next(n for n, line in enumerate(lines) if line.startswith("Frame Time")) + 40
    lines[begin:-1] = ["900" + line[line.index(" ") :] for line in lines[begin:-1]]
    path.write_text("\n".join(lines))
    clip = make_clip(read_motion(path).recording("x.bvh"))
    with pytest.raises(MotionFileError, match=rf"x\.bvh:{begin + 1}: \w+ jumps .* 15 m/s at most"):
        require_complete(clip, 0.0, clip.seconds)


def test_a_frame_of_a_bvh_that_is_elsewhere_is_bridged(tmp_path: Path) -> None:
    p = frames(seconds=1.0, rate=60.0)
    q = p.copy()
    q[30] += [0.7, 0, 0]
    own, other = (
        make_clip(read_motion(write_npz(tmp_path / f"{n}.npz", x, 60.0)).recording("x"))
        for n, x in enumerate((p, q))
    )
    assert np.abs(own.positions - other.positions).max() < 0.01


@pytest.mark.parametrize("movement", MOVEMENTS)
@pytest.mark.parametrize("every", [2, 4, 8])
def test_no_movement_is_taken_for_a_jump(movement: str, every: int) -> None:
    """At 60, 30 and 15 frames a second, with 10 mm of noise: punches, kicks, jumps, falls."""
    p = frames(movement, 3.0, 120.0)[::every]
    p = p + np.random.default_rng(5).normal(0, 0.01, p.shape)
    _, is_away = bridge_jumps(p, 120.0 / every, 1.0)
    assert not is_away.any()
