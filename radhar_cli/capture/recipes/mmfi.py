"""MM-Fi: 27 actions of 40 persons in four rooms, a file a frame of an IWR6843.

Files hold float64 rows of x, y, z, Doppler, intensity. Which way the axes point is documented
nowhere (issues 26 and 28 there), and is asked for. `ground_truth.npy` is in axes of the camera,
whose place beside the radar is not known: joints are left out.
"""

from collections.abc import Iterator
from functools import partial
from itertools import groupby
from pathlib import Path

import numpy as np

from radhar_cli.capture.recipes.axes import AxesSettings, to_radhar_axes
from radhar_cli.capture.recipes.clouds import MAX_TABLE, CloudClip, points_of, write_clips
from radhar_cli.capture.recipes.recipe import (
    BY_PERSON,
    CLOUDS,
    MatchedFile,
    SetRecipe,
    Take,
    find_files,
)
from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import bytes_of
from radhar_cli.numerics.arrays import Float

FRAME_S, FRAMES = 0.1, 297
ROW = 5  # float64
ACTIONS = (
    *("stretching_and_relaxing", "horizontal_chest_expansion", "vertical_chest_expansion"),
    *("left_twist", "right_twist", "mark_time", "left_limb_extension", "right_limb_extension"),
    *("left_front_lunge", "right_front_lunge", "both_limb_extension", "squat", "raising_left_hand"),
    *("raising_right_hand", "left_side_lunge", "right_side_lunge", "waving_left_hand"),
    *("waving_right_hand", "picking_up", "throwing_left", "throwing_right", "kicking_left"),
    *("kicking_right", "left_body_extension", "right_body_extension", "jumping_up", "bowing"),
)


def list_takes(folder: Path, settings: AxesSettings) -> Iterator[Take]:
    """List a take for each room, person and action.

    Raises:
        CaptureError: the settings do not say which way the axes point.
    """
    files = find_files(folder, r"E0*(\d+)/S(\d+)/A(\d+)/mmwave/frame(\d+)\.bin")
    for sequence, frames in groupby(files, key=_sequence):
        settings.require("mmfi")
        room, person, action = sequence
        sources = {int(file.match[4]): file.path for file in frames}
        name = f"E{room:02d}_S{person:02d}_A{action:02d}"
        write = partial(write_take, sources, action, f"S{person:02d}", settings)
        yield Take(name, tuple(sources.values()), write)


def _sequence(file: MatchedFile) -> tuple[int, int, int]:
    """Room, person and action of a frame."""
    return int(file.match[1]), int(file.match[2]), int(file.match[3])


def write_take(
    sources: dict[int, Path], action: int, person: str, settings: AxesSettings, out: Path
) -> None:
    """Write the frames of a sequence; those without a file are lost.

    Raises:
        CaptureError: there is no such action, or a file is no rows of five float64.
    """
    if not 1 <= action <= len(ACTIONS):
        raise CaptureError(f"{out.stem}: there are actions 1 to {len(ACTIONS)}")
    numbers = sorted(sources)
    frames = [_read_frame(sources[number]) for number in numbers]
    received = np.array(numbers) - numbers[0]
    frame = np.repeat(received, [len(rows) for rows in frames])
    rows = np.concatenate(frames)
    assert settings.axes is not None  # as `list_takes` found
    places, receding = (
        to_radhar_axes(rows[:, :3], settings.axes),
        settings.receding(rows[:, 3]),
    )
    points = points_of(places, receding, rows[:, 4])
    missing = FRAMES - len(numbers)
    findings = [f"{missing} of {FRAMES} frames have no file"] * (missing > 0)
    length = max(int(received[-1]) + 1, FRAMES if missing > 0 and numbers[0] <= 1 else 0)
    clip = CloudClip(ACTIONS[action - 1], person, points, frame, length, received)
    write_clips(out, [clip], FRAME_S, [sources[numbers[0]].parent], findings)


def _read_frame(path: Path) -> Float:
    """Rows [n, 5] of a frame."""
    data = bytes_of(path, MAX_TABLE, CaptureError)
    if len(data) % (8 * ROW):
        raise CaptureError(f"{path}: has {len(data)} bytes; should be rows of five float64")
    return np.frombuffer(data, "<f8").reshape(-1, ROW)


RECIPE = SetRecipe(
    source="MM-Fi, doi 10.5281/zenodo.7983467",
    licence="cc-by-nc-4.0",
    holds="1,080 sequences of 297 frames, 27 actions, 40 persons; not for commercial use",
    tested="files written by this layout, none of its own",
    layout="E01/S01/A01/mmwave/frame001.bin",
    list_takes=list_takes,
    config=CLOUDS | {"split": BY_PERSON},
    settings=AxesSettings,
    count=1080,
)
