"""RadHAR: five activities in front of an IWR1443, messages of a ROS driver as text.

A message is a point, in ROS's axes (ahead, left, up); a frame begins where `point_id` begins again.
Frames often come in pairs, 30 a second on average. Velocities are receding, as TI's. The
persons have no names.
"""

import re
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

from radhar_cli.capture.recipes.clouds import MAX_TABLE, CloudClip, points_of, write_clips
from radhar_cli.capture.recipes.recipe import (
    CLOUDS,
    NoSettings,
    SetRecipe,
    Take,
    as_name,
    find_files,
)
from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import bytes_of
from radhar_cli.numerics.arrays import Float, Index

FRAME_S = 1 / 30
KEYS = ("point_id", "x", "y", "z", "range", "velocity", "doppler_bin", "bearing", "intensity")
_NUMBER = rb"\s+([-+\d.eE]+)\s+"
_MESSAGE = re.compile(
    rb"\bsecs:"
    + _NUMBER
    + rb"nsecs:"
    + _NUMBER
    + rb"frame_id:[^\n]*\s+"
    + b"".join(key.encode() + b":" + _NUMBER for key in KEYS[:-1])
    + rb"intensity:\s+([-+\d.eE]+)[ \r]*\n"
)


def list_takes(folder: Path, settings: NoSettings) -> Iterator[Take]:
    """List a take for each file, in the folder of its activity, below Train or Test."""
    for file in find_files(folder, r"(boxing|jack|jump|squats|walk)/[^/]+\.txt"):
        parts = file.inner.lower().split("/")
        split = next((part for part in parts if part in ("train", "test")), None)
        name = as_name(str(Path(file.inner).with_suffix("")))
        yield Take(name, (file.path,), partial(write_take, file.path, parts[-2]), split)


def write_take(path: Path, label: str, out: Path) -> None:
    """Write the points of a file.

    Raises:
        CaptureError: it holds no message.
    """
    text = bytes_of(path, MAX_TABLE, CaptureError)
    rows = np.array(_MESSAGE.findall(text + b"\n"), dtype=np.float64).reshape(-1, 2 + len(KEYS))
    if not len(rows):
        raise CaptureError(f"{path}: holds no message with {', '.join(KEYS)}")
    damaged = text.count(b"point_id:") - len(rows)
    findings = [f"{damaged} messages are cut and left out"] * bool(damaged)
    points = points_of(rows[:, 3:6], rows[:, 7], snr_db=rows[:, 10])
    frame = _number_frames(rows)
    write_clips(
        out, [CloudClip(label, None, points, frame, int(frame[-1]) + 1)], FRAME_S, [path], findings
    )


def _number_frames(rows: Float) -> Index:
    """Number of the frame of each message [n], from 0; numbers of lost frames stay free."""
    begins = np.concatenate([[True], np.diff(rows[:, 2]) <= 0])
    times = (rows[begins, 0] - rows[0, 0]) + 1e-9 * (rows[begins, 1] - rows[0, 1])
    by_clock = np.round(times / FRAME_S).astype(np.int64)
    # Messages come in pairs: the second one is the next frame, whatever its clock says.
    place = np.arange(len(by_clock))
    numbers: Index = (place + np.maximum.accumulate(by_clock - place)).astype(np.intp)
    of_rows: Index = numbers[np.cumsum(begins) - 1]
    return of_rows


RECIPE = SetRecipe(
    source="RadHAR, github.com/nesl/RadHAR",
    licence="bsd-3-clause",
    holds="5 activities, 2 persons who are not named",
    tested="a file of each activity, and files written by this layout",
    layout="Data/Train/boxing/*.txt, and jack, jump, squats, walk, and Test",
    list_takes=list_takes,
    config=CLOUDS,
)
