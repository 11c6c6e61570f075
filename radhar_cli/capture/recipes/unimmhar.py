"""UniMM-HAR: clips of 32 frames out of mRI, MM-Fi and RadHAR, by protocols across persons and sets.

`CSub/train/D000A003P000S0001.npz` holds `pointcloud` [32, 64, 5]: x, y, z, Doppler, intensity as
the set of origin (D) has them. Points were drawn again to fill up frames, and zeros fill up clips:
both are taken out. Frames were thinned out to 32, so that FRAME_S says little.
"""

from collections.abc import Iterator
from functools import partial
from itertools import groupby
from pathlib import Path

import numpy as np

from radhar_cli.capture.recipes.axes import OF_ROS, OF_TI, Axes, AxesSettings, to_radhar_axes
from radhar_cli.capture.recipes.clouds import MAX_TABLE, CloudClip, points_of, write_clips
from radhar_cli.capture.recipes.recipe import CLOUDS, MatchedFile, SetRecipe, Take, find_files
from radhar_cli.errors import CaptureError
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.captures.array_files import read_npz_array

FRAMES, FRAME_S = 32, 0.1
LONGEST = 1000  # frames or points of a clip
ARRAY = "pointcloud"
PROTOCOLS = ("csub", "cset", "all")
AXES_OF_SET: dict[int, Axes | None] = {0: OF_TI, 1: None, 2: OF_ROS}  # mRI, MM-Fi, RadHAR
CLASSES = (
    *("walk", "jump", "squat", "stretch", "jumping_jack", "box", "left_upper_limb_extension"),
    *("right_upper_limb_extension", "both_upper_limb_extension", "left_front_lunge"),
    *("right_front_lunge", "left_side_lunge", "right_side_lunge", "left_limb_extension"),
    *("right_limb_extension", "horizontal_chest_expansion", "vertical_chest_expansion"),
    *("left_twist", "right_twist", "mark_time", "both_limb_extension", "raising_left_hand"),
    *("raising_right_hand", "waving_left_hand", "waving_right_hand", "picking_up"),
    *("throwing_left", "throwing_right", "kicking_left", "kicking_right", "left_body_extension"),
    *("right_body_extension", "bowing"),
)


def list_takes(folder: Path, settings: AxesSettings) -> Iterator[Take]:
    """List a take for each set of origin and person in each part of the split.

    Raises:
        CaptureError: there are two protocols, or clips of MM-Fi without axes.
    """
    files = [*find_files(folder, r"D(\d+)A(\d+)(?:E\d+)?(?:P(\d+))?S(\d+)\.npz")]
    protocols = {part for file in files for part in _folders(file) if part in PROTOCOLS}
    if len(protocols) > 1:
        raise CaptureError(
            f"{folder}: holds several protocols, which share clips: name the folder of one, "
            f"{folder / 'CSub'} or {folder / 'CSet'}"
        )
    for (split, origin, person), clips in groupby(sorted(files, key=_group), key=_group):
        if AXES_OF_SET.get(origin) is None:
            settings.require("unimmhar: of MM-Fi, the authors' description")
        sources = {file.path: int(file.match[2]) for file in clips}
        person_of_set = f"D{origin:03d}P{person}" if person else None
        name = "/".join(filter(None, (split, person_of_set or f"D{origin:03d}")))
        write = partial(write_take, sources, origin, person_of_set, settings)
        yield Take(name, tuple(sources), write, split or None)


def _folders(file: MatchedFile) -> list[str]:
    """Folders of a file, in lower case."""
    return file.inner.lower().split("/")[:-1]


def _group(file: MatchedFile) -> tuple[str, int, str]:
    """Part of the split, set of origin and person of a clip."""
    split = next((part for part in _folders(file) if part in ("train", "test")), "")
    return split, int(file.match[1]), file.match[3] or ""


def write_take(
    sources: dict[Path, int], origin: int, person: str | None, settings: AxesSettings, out: Path
) -> None:
    """Write the clips of a person, class after class.

    Raises:
        CaptureError: there is no such class, or a file does not hold a clip.
    """
    known = AXES_OF_SET.get(origin)
    axes = known or settings.axes
    assert axes is not None  # as `list_takes` found
    clips = []
    for label, files in groupby(sorted(sources, key=lambda path: sources[path]), sources.get):
        if label is None or label >= len(CLASSES):
            raise CaptureError(
                f"{out.stem}: class {label}: there are classes 0 to {len(CLASSES) - 1}"
            )
        points, frames, length = list[Float](), list[Float](), 0
        for path in files:
            clip = _read_clip(path)
            for number, rows in enumerate(clip):
                rows = np.unique(rows[rows.any(axis=1)], axis=0)
                doppler = rows[:, 3] if known else settings.receding(rows[:, 3])
                points.append(points_of(to_radhar_axes(rows[:, :3], axes), doppler, rows[:, 4]))
                frames.append(np.full(len(rows), length + number))
            length += len(clip)
        frame = np.concatenate(frames).astype(np.intp)
        clips.append(
            CloudClip(
                CLASSES[label], person, np.concatenate(points), frame, length, np.arange(length)
            )
        )
    write_clips(out, clips, FRAME_S, [*sources])


def _read_clip(path: Path) -> Float:
    """Clip [frames, points, 5] of a file."""
    clip = read_npz_array(path, ARRAY, MAX_TABLE)
    if clip.ndim != 3 or clip.shape[2] != 5 or max(clip.shape) > LONGEST or not min(clip.shape):
        raise CaptureError(f"{path}: {ARRAY} has the shape {[*clip.shape]}; should be [32, 64, 5]")
    return clip.astype(float)


RECIPE = SetRecipe(
    source="UniMM-HAR, github.com/jolin830/DAP-Net, arXiv 2605.09604",
    licence="",
    holds="33 classes of mRI, MM-Fi and RadHAR by protocols C-Sub and C-Set",
    tested="files written by the layout of its README, none of its own",
    layout="CSub/train/D000A003P000S0001.npz, or CSet, and test",
    list_takes=list_takes,
    config=CLOUDS | {"recordings": {"window_s": FRAMES * FRAME_S, "hop_s": FRAMES * FRAME_S}},
    settings=AxesSettings,
)
