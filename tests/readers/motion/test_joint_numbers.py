"""Joints that a config gives by their numbers: tables of a walker in all orders of columns."""

from pathlib import Path

import joint_set_errors
import numpy as np
import pytest
from helpers.poses import RATE, WALKER, clip_of, npy_bytes, npz_bytes

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.recorded.clip import Clip
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS
from radhar_cli.motion.recorded.names import WANTED
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


def table_of(p: Float) -> Float:
    """Columns [frames, 3 J] of positions: x, y, z of each joint."""
    return p.reshape(len(p), -1)


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


@pytest.mark.parametrize("frames", [40, 60])
@pytest.mark.parametrize("count", BODIES)
@pytest.mark.parametrize("name", WRITERS)
def test_columns_of_numbered_joints(name: str, count: int, frames: int, tmp_path: Path) -> None:
    """60 columns divide by 3 as well as 60 frames do: frames are rows."""
    table = table_of(BODIES[count][0][:frames])
    check(read_numbered(tmp_path / name, WRITERS[name](table), count), frames)


@pytest.mark.parametrize("frames", [39, 60])
@pytest.mark.parametrize("count", BODIES)
def test_axes_of_numbered_joints(count: int, frames: int, tmp_path: Path) -> None:
    array = BODIES[count][0][:frames]
    check(read_numbered(tmp_path / "x.npy", npy_bytes(array), count), frames)


def test_numbered_joints_in_another_order_of_axes_make_no_body(tmp_path: Path) -> None:
    table = np.swapaxes(BODIES[17][0], 1, 2).reshape(len(WALKER), -1)
    with pytest.raises(MotionFileError, match=r"as no body has; .*--joints"):
        read_numbered(tmp_path / "x.npy", npy_bytes(table), 17)


@pytest.mark.parametrize("key", ["coco17", "kinect1_20", "ntu25", "mars19"])
def test_a_joint_set_says_whose_joints_are_in_columns(key: str, tmp_path: Path) -> None:
    p = joint_set_errors.poses_of(JOINT_SETS[key], WALKER)
    rows = np.swapaxes(p, 1, 2) if JOINT_SETS[key].is_by_axis else p
    data = npy_bytes(rows.reshape(len(p), -1))
    check(clip_of(tmp_path / "x.npy", data, rate=RATE, joints=key), len(WALKER))


def test_a_number_of_joints_of_no_set_is_asked_for(tmp_path: Path) -> None:
    data = npy_bytes(table_of(BODIES[13][0][:60]))
    with pytest.raises(MotionFileError, match="has 13 joints without names; no set that is known"):
        clip_of(tmp_path / "x.npy", data, rate=RATE)
