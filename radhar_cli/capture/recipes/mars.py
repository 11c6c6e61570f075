"""MARS: ten movements in front of an IWR1443, with the joints that a Kinect saw frame by frame.

Rows of `kinect_data_*.csv` belong to the frames of `radar_data_*.csv` in the order of appearance:
all x, all y, all z of 25 joints, right, ahead and up of the Kinect, which stood some 0.2 m beside
the radar. Numbers of frames make large steps, or begin again, from one movement to the next.
"""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

from radhar_cli.capture.recipes.clouds import (
    CloudClip,
    frames_in_order,
    points_of_ti,
    read_table,
    write_clips,
)
from radhar_cli.capture.recipes.recipe import CLOUDS, NoSettings, SetRecipe, Take, find_files
from radhar_cli.errors import CaptureError
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.points.point_frames import in_radhar_axes

FRAME_S = 0.1
LONGEST_LOSS = 100  # frames; a larger step is the next movement
MOVEMENTS = (
    *("left_upper_limb_extension", "right_upper_limb_extension", "both_upper_limb_extension"),
    *("left_front_lunge", "right_front_lunge", "squat", "left_side_lunge", "right_side_lunge"),
    *("left_limb_extension", "right_limb_extension"),
)
SPLITS = {"train": "train", "validate": "validation", "test": "test"}
KINECT_JOINTS = 25
# Place of each of JOINTS among the Kinect's: SpineMid, Head, shoulders, elbows, wrists and so on.
KINECT_PLACES = dict(zip(JOINTS, (1, 3, 8, 9, 10, 4, 5, 6, 0, 17, 18, 13, 14), strict=True))


def list_takes(folder: Path, settings: NoSettings) -> Iterator[Take]:
    """List a take for each subject and part of the authors' split in time."""
    pattern = r"subject(\d+)/timesplit/radar_data_(train|validate|test)\.csv"
    files = [*find_files(folder, pattern)]
    without_outliers = [file for file in files if "wooutlier" in file.inner.lower()]
    for file in without_outliers or files:
        subject, part = int(file.match[1]), file.match[2].lower()
        kinect = file.path.with_name(file.path.name.lower().replace("radar_", "kinect_"))
        sources = (file.path, kinect) if kinect.is_file() else (file.path,)
        write = partial(write_take, sources, str(subject))
        yield Take(f"subject{subject}_{part}", sources, write, SPLITS[part])


def write_take(sources: tuple[Path, ...], person: str, out: Path) -> None:
    """Write the movements of a file one after the other.

    Raises:
        CaptureError: it is damaged, or holds more than ten movements.
    """
    rows, lost_lines = read_table(sources[0], 7)
    order = frames_in_order(rows[:, 0])
    first_rows = np.unique(order, return_index=True)[1]
    number = rows[first_rows, 0].astype(np.int64)
    findings = ["the last line is cut and left out"] * lost_lines
    joints = _read_joints(sources[1]) if len(sources) > 1 else np.empty((0, len(JOINTS), 3))
    if len(joints) != len(number):
        findings.append(f"{len(number)} frames, and joints of {len(joints)}")
        missing = max(len(number) - len(joints), 0)
        nowhere = np.full((missing, *joints.shape[1:]), np.nan)
        joints = np.concatenate([joints, nowhere])[: len(number)]
    steps = np.diff(number)
    cuts = np.flatnonzero((steps <= 0) | (steps > LONGEST_LOSS)) + 1
    if len(cuts) >= len(MOVEMENTS):
        raise CaptureError(
            f"{sources[0]}: has {len(cuts) + 1} stretches of frames; should have one for each of "
            f"{len(MOVEMENTS)} movements"
        )
    clips = []
    for label, places in zip(MOVEMENTS, np.split(np.arange(len(number)), cuts), strict=False):
        if not len(places):
            continue
        is_within = np.isin(order, places)
        received = (number[places] - number[places[0]]).astype(np.intp)
        points, frame = points_of_ti(rows[is_within, 2:7]), order[is_within] - places[0]
        length = int(received[-1]) + 1
        clips.append(
            CloudClip(label, person, points, received[frame], length, received, joints[places])
        )
    write_clips(out, clips, FRAME_S, sources, findings)


def _read_joints(path: Path) -> Float:
    """Joints [frames, 13, 3] of a file of the Kinect, in radhar's axes, m."""
    rows, _ = read_table(path, 3 * KINECT_JOINTS)
    places = rows.reshape(-1, 3, KINECT_JOINTS).transpose(0, 2, 1)[:, [*KINECT_PLACES.values()]]
    return in_radhar_axes(places.reshape(-1, 3)).reshape(places.shape)


RECIPE = SetRecipe(
    source="MARS, github.com/SizheAn/MARS",
    licence="mit",
    holds="40,083 frames, 10 movements with joints, 4 persons",
    tested="files of subject 1, and files written by this layout",
    layout="subject1/timesplit/radar_data_train.csv and kinect_data_train.csv",
    list_takes=list_takes,
    config=CLOUDS,
    count=12,
)
