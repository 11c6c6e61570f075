"""Joints that a config gives by their numbers: tables of a walker in all orders of columns."""

from pathlib import Path

import joint_set_errors
import numpy as np
import pytest
from helpers.poses import RATE, WALKER, clip_of, npy_bytes, npz_bytes

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.files.clip import Clip
from radhar_cli.motion.files.joint_sets import JOINT_SETS
from radhar_cli.motion.files.names import WANTED
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float

_LIMBS = {"shoulder": 5, "elbow": 7, "hand": 9, "hip_joint": 11, "knee": 13, "ankle": 15}
# {joints: (positions [frames, J, 3], numbers of ours)}; 20 are in no order of a joint set.
BODIES: dict[int, tuple[Float, dict[str, str | list[str]]]] = {
    13: (WALKER[:, :13], {name: str(n) for n, name in enumerate(JOINTS)}),
    17: (
        joint_set_errors.poses_of(JOINT_SETS["coco17"], WALKER),
        {
            "head": ["3", "4"],
            **{f"left_{part}": str(n) for part, n in _LIMBS.items()},
            **{f"right_{part}": str(n + 1) for part, n in _LIMBS.items()},
        },
    ),
    20: (
        np.concatenate([WALKER[:, ::-1], WALKER[:, :5] + 0.05], axis=1),
        {name: str(14 - n) for n, name in enumerate(WANTED)},
    ),
}


def table_of(p: Float, by_axis: bool) -> Float:
    """Columns [frames, 3 J] of positions: x, y, z of each joint, or all x, all y, all z."""
    return (np.swapaxes(p, 1, 2) if by_axis else p).reshape(len(p), -1)


def csv_bytes(table: Float) -> bytes:
    return "\n".join(",".join(map(str, row)) for row in table.tolist()).encode()


def read_numbered(path: Path, data: bytes, count: int) -> Clip:
    return clip_of(path, data, rate=RATE, joints=BODIES[count][1])


def check(clip: Clip, frames: int) -> None:
    """The clip is that of so many frames of the walker."""
    assert len(clip.positions) == frames
    errors = joint_set_errors.joint_errors(WALKER[:frames, :13], clip.positions[:, :13])
    assert errors.max() < 0.02


WRITERS = {
    "x.npy": npy_bytes,
    "x.npz": lambda table: npz_bytes(positions=table),
    "only.npz": lambda table: npz_bytes(arr_0=table),
    "x.csv": csv_bytes,
}


@pytest.mark.parametrize("by_axis", [False, True])
@pytest.mark.parametrize("frames", [40, 50, 60, 90])
@pytest.mark.parametrize("count", BODIES)
@pytest.mark.parametrize("name", WRITERS)
def test_columns_of_numbered_joints(
    name: str, count: int, frames: int, by_axis: bool, tmp_path: Path
) -> None:
    """60 columns divide by 3 as well as 60 frames do: only one of the two makes a body."""
    table = table_of(BODIES[count][0][:frames], by_axis)
    check(read_numbered(tmp_path / name, WRITERS[name](table), count), frames)


@pytest.mark.parametrize("by_axis", [False, True])
@pytest.mark.parametrize("frames", [50, 60, 90])
@pytest.mark.parametrize("count", BODIES)
def test_rows_of_numbered_joints(count: int, frames: int, by_axis: bool, tmp_path: Path) -> None:
    table = table_of(BODIES[count][0][:frames], by_axis).T
    check(read_numbered(tmp_path / "x.npy", npy_bytes(table), count), frames)


@pytest.mark.parametrize("frames", [39, 52, 55, 60, 99])
@pytest.mark.parametrize("count", BODIES)
@pytest.mark.parametrize("axes", [(0, 1, 2), (1, 0, 2), (0, 2, 1), (1, 2, 0), (2, 0, 1), (2, 1, 0)])
def test_axes_of_numbered_joints(
    axes: tuple[int, ...], count: int, frames: int, tmp_path: Path
) -> None:
    """As many frames as a joint set has joints are still frames."""
    array = np.transpose(BODIES[count][0][:frames], axes)
    check(read_numbered(tmp_path / "x.npy", npy_bytes(array), count), frames)


@pytest.mark.parametrize("frames", [50, 60])
@pytest.mark.parametrize("count", BODIES)
def test_confidences_beside_numbered_joints(count: int, frames: int, tmp_path: Path) -> None:
    p = BODIES[count][0][:frames]
    table = np.concatenate([p, np.full((frames, count, 1), 0.9)], axis=2).reshape(frames, -1)
    check(read_numbered(tmp_path / "x.npy", npy_bytes(table), count), frames)


@pytest.mark.parametrize("frames", [57, 60, 75])
@pytest.mark.parametrize("key", ["coco17", "kinect1_20", "ntu25", "mars19"])
@pytest.mark.parametrize("by_axis", [False, True])
@pytest.mark.parametrize("turned", [False, True])
def test_without_numbers_a_body_decides_what_frames_are(
    turned: bool, by_axis: bool, key: str, frames: int, tmp_path: Path
) -> None:
    table = table_of(joint_set_errors.poses_of(JOINT_SETS[key], WALKER[:frames]), by_axis)
    data = npy_bytes(table.T if turned else table)
    clip = clip_of(tmp_path / "x.npy", data, rate=RATE)
    assert len(clip.positions) == frames
    of_set = clip_of(tmp_path / "x.npy", data, rate=RATE, joints=key)
    assert np.array_equal(of_set.positions, clip.positions)


def test_frames_are_rows_where_nothing_makes_a_body(tmp_path: Path) -> None:
    """It was said to have 20 joints."""
    data = npy_bytes(table_of(BODIES[13][0][:60], by_axis=False))
    with pytest.raises(MotionFileError, match="has 13 joints without names"):
        clip_of(tmp_path / "x.npy", data, rate=RATE)


def test_named_joints_without_hip_joints_may_be_by_axis(tmp_path: Path) -> None:
    table = table_of(BODIES[13][0], by_axis=True)
    data = npz_bytes(names=list(JOINTS), positions=table, rate=RATE)
    check(clip_of(tmp_path / "x.npz", data), len(WALKER))
