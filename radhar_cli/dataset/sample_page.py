"""What the page of `radhar view` shows of samples of a data set."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.arrays import Float
from radhar_cli.config.schema import FRAME_MAPS
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.layout import SPLIT_FOLDERS, SPLITS, Rows, column_axis, row_axis
from radhar_cli.dataset.reading import Dataset
from radhar_cli.errors import FolderError, RadharError
from radhar_cli.figures import scene_page
from radhar_cli.figures.scene_page import MAX_SIDE, Entry
from radhar_cli.motion.skeleton import JOINTS, PARENTS
from radhar_cli.pipeline.physics import board_of, motion_of
from radhar_cli.pipeline.validity import draw_valid_scene
from radhar_cli.processing.frame_maps import doppler_axis, range_axis
from radhar_cli.processing.power_map import Axis
from radhar_cli.radar.board import Board
from radhar_cli.scene import Scene, nominal_scene

MOST = 50  # samples of a page


def chosen_rows(data: Dataset, samples: Sequence[str], split: str | None) -> list[int]:
    """Rows of samples CLASS/INDEX, or of the first one of each class, of a split if one is named.

    Raises:
        FolderError: there is no such sample or split, or there are too many.
    """
    rows = Rows.of(data.config)
    if samples:
        found = [_row(data, rows, one) for one in samples]
    else:
        names = (*SPLIT_FOLDERS, "all")
        if split not in (*names, None):
            raise FolderError(f"--split {split}: should be one of {', '.join(names)}")
        inside = np.full(len(data), True)
        if split in SPLIT_FOLDERS:
            inside = data.split == SPLIT_FOLDERS.index(split)
        labels = np.where(inside, data.label.astype(int), -1)
        found = [int(np.flatnonzero(labels == one)[0]) for one in np.unique(labels[inside])]
        if not found:
            raise FolderError(f"{data.path}: has no samples in --split {split}")
        found = found[:MOST]
    if len(found) > MOST:
        raise FolderError(f"--sample: {len(found)} samples; a page holds {MOST} at most")
    return found


def _row(data: Dataset, rows: Rows, name: str) -> int:
    slug, _, index = name.partition("/")
    known = {activity.slug: part for activity, part in rows.classes()}
    known |= {activity.label: part for activity, part in rows.classes()}
    part = known.get(slug)
    if part is None:
        raise FolderError(f"--sample {name}: no such class; there are {', '.join(known)}")
    if not index.isdecimal() or int(index) >= part.stop - part.start:
        last = part.stop - part.start - 1
        raise FolderError(f"--sample {name}: should be {slug}/0 to {slug}/{last}")
    return int(part.start) + int(index)


def of_samples(data: Dataset, rows: Sequence[int]) -> list[Entry]:
    """What the page shows of these rows: what is stored, and the truth of simulated scenes."""
    extents = {name: data.extents(name) for name in data.maps}
    return [_of_sample(data, row, {name: extents[name][row] for name in extents}) for row in rows]


def _of_sample(data: Dataset, row: int, extents: dict[str, NDArray[Any]]) -> Entry:
    config, (activity, index) = data.config, Rows.of(data.config)[row]
    where = f"{activity.label} {activity.slug}/{index}, {SPLITS[data.split[row]]}"
    made, notes = Entry(), list[str]()
    scene = _scene(data, row, notes)
    if scene is not None:
        made = scene_page.moving(scene, tuple(map(motion_of, scene.people)))
        where = f"{where} | {made['title'].partition(' | ')[2]}"
    stored = {f.key: data.scene[f.name].rows(row, row + 1)[0] / f.factor for f in data.fields}
    numbers = {key: value for key, value in stored.items() if np.isfinite(value)}
    scale = scene_page.scale_of(config.image.kind, config.image.dynamic_range_db)
    maps = []
    for name in data.maps:
        if name not in FRAME_MAPS:  # whose images are sheets of what is stored as frames
            (left, right, bottom, top), grey = extents[name], data.maps[name][row]
            grey = grey[tuple(slice(None, None, -(-side // MAX_SIDE)) for side in grey.shape)]
            columns = _axis(column_axis(name), left, right, grey.shape[1])
            rows = _axis(row_axis(name), bottom, top, grey.shape[0])
            f0 = made.get("f0")
            maps.append(scene_page.image_entry(name, grey, scale, columns, rows, f0))
    if config.radar.cfg is not None:
        board = board_of((scene or nominal_scene(config, activity)).config)
        made |= {} if scene is not None else _stored_joints(data, row, board)
        maps += _frames(data, row, board, made.get("farthest", np.inf))
        if "points" in data.products:
            points, start = _product(data, row, "points", (8,)), _product(data, row, "points_start")
            pose = board if scene is not None else None
            made["cloud"] = scene_page.cloud_entry(
                points, start, _times(board, len(start) - 1), pose
            )
    if "time" not in made:
        edges = [extents[name][:2] for name in data.maps if column_axis(name)[1] == "s"]
        made["time"] = scene_page.clock(*(edges[0] if edges else (0.0, 0.0)))
    return made | {
        "title": where,
        "numbers": numbers,
        "notes": notes,
        "maps": maps,
        "colours": scene_page.colours(config.image),
    }


def _times(board: Board, frames: int) -> Float:
    """Middles of frames, s; a recorded sample may have others than its config says."""
    return np.arange(frames) * board.period + board.loops * board.loop / 2


def _product(data: Dataset, row: int, name: str, shape: tuple[int | None, ...] = ()) -> Any:
    """A stored array [n, *shape] of numbers.

    Raises:
        FolderError: it is not of that shape.
    """
    values = data.products[name][row]
    same = len(values.shape) == 1 + len(shape) and all(
        right in (None, n) for right, n in zip(shape, values.shape[1:], strict=True)
    )
    if not same or values.dtype.kind not in "iuf":
        wanted = ", ".join(["n", *("any" if n is None else str(n) for n in shape)])
        raise FolderError(f"{data.path}: /products/{name}: should be numbers [{wanted}]")
    return values


def _frames(data: Dataset, row: int, board: Board, farthest: float) -> Iterator[Entry]:
    """Frame maps that are stored, as grey levels."""
    scale = scene_page.scale_of("decibel", data.config.image.dynamic_range_db)
    for name in FRAME_MAPS[:3]:
        if name in data.products:
            columns = doppler_axis(board)
            if name != "range_doppler":
                columns = Axis(name.removeprefix("range_"), "degree", np.arange(-90.0, 91.0))
            grey = _product(data, row, name, (board.n_fft, columns.values.size))
            axes, times = (columns, range_axis(board)), _times(board, len(grey))
            yield scene_page.frames_entry(name, grey, scale, *axes, times, farthest)


def _stored_joints(data: Dataset, row: int, board: Board) -> Entry:
    """Joints that are stored, in the axes of the radar, where the scene is not drawn again."""
    made: Entry = {"axes": ["ahead (m)", "left (m)", "up of the radar (m)"]}
    if "skeleton" in data.products:
        joints = _product(data, row, "skeleton", (None, None, 3))
        known = joints.shape[2] == len(JOINTS)
        bones = [[up, n] for n, up in enumerate(PARENTS) if up is not None] if known else []
        names = JOINTS if known else [f"joint {n}" for n in range(joints.shape[2])]
        made["time"] = _times(board, len(joints))
        made["people"] = [
            {"label": f"person {n}", "joints": names, "bones": bones, "places": one.round(3)}
            for n, one in enumerate(np.moveaxis(joints, 1, 0).astype(float))
        ]
    return made


def _axis(named: tuple[str, str], low: float, high: float, cells: int) -> Axis:
    return Axis(*named, low + (np.arange(cells) + 0.5) * (high - low) / cells)


def _scene(data: Dataset, row: int, notes: list[str]) -> Scene | None:
    """The scene of a sample, drawn again; None, and why, where that is not the one stored."""
    config, (activity, index) = data.config, Rows.of(data.config)[row]
    if config.recorded is not None:
        notes.append("Measured: there are no true joints.")
        return None
    if config.files_of(activity) is not None:
        kept = "those that are stored" if "skeleton" in data.products else "not known"
        notes.append(f"Motion files are not opened: joints are {kept}.")
        return None
    try:
        scene, _ = draw_valid_scene(config, activity, index)
    except RadharError as error:
        notes.append(f"No skeleton: {error}")
        return None
    columns = [field for field in data.fields if field is not scene_fields.ERROR]
    drawn = scene_fields.values(scene, tuple(columns))
    there = [data.scene[f.name].rows(row, row + 1)[0] / f.factor for f in columns]
    if np.allclose(drawn, there, rtol=1e-9, atol=0, equal_nan=True):
        return scene
    notes.append("No skeleton: this version of radhar draws another scene than the one stored.")
    return None
