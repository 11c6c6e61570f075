"""Samples of a data set as entries of the page of `radhar view`."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.config.data_set import Config, MeasuredConfig
from radhar_cli.config.maps import FRAME_MAPS
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.layout import SPLITS, Rows, column_axis, row_axis
from radhar_cli.dataset.reading import Dataset
from radhar_cli.errors import FolderError, RadharError
from radhar_cli.figures.page_plots import LevelScale, MapLevels, PointFrames, plot_map, plot_space
from radhar_cli.figures.scene_page import Entry, make_entry
from radhar_cli.figures.scene_view import MovingBody, SceneView, frame_times, view_scene
from radhar_cli.figures.sides import bones
from radhar_cli.motion.activities.vocabulary import FROM_FILES, advice_on, meaning_of
from radhar_cli.motion.skeleton import JOINTS, PARENTS
from radhar_cli.processing.frame_maps import FRAME_MAP_KINDS
from radhar_cli.processing.power_map import Axis
from radhar_cli.radar.board import Board
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.radar import board_of
from radhar_cli.scene.scene import Scene, fixed_radar, nominal_scene

MOST = 50  # samples of a page
OF_RADAR = ("ahead (m)", "left (m)", "up of the radar (m)")  # axes of points


def choose_rows(data: Dataset, samples: Sequence[str]) -> list[int]:
    """Choose the rows of samples CLASS/INDEX, or the first row of each class, `stationary` last.

    Raises:
        FolderError: there is no such sample, or more than MOST are named.
    """
    classes = sorted(
        Rows.of(data.config).classes(), key=lambda part: part[0].movements == ("stationary",)
    )
    if len(samples) > MOST:
        raise FolderError(f"--sample: {len(samples)} samples; a page holds {MOST} at most")
    if not samples:
        return [part.start for _, part in classes if part.stop > part.start][:MOST]
    known = {name: part for activity, part in classes for name in (activity.slug, activity.label)}
    rows = []
    for sample in samples:
        slug, _, index = sample.partition("/")
        slug = slug if slug in known else meaning_of(slug, known) or slug
        if slug not in known:
            names = [activity.slug for activity, _ in classes]
            known_classes = f"there are {', '.join(sorted(names))}"
            advice = advice_on(slug, names, known_classes)
            hint = known_classes if advice == FROM_FILES else advice
            raise FolderError(f"--sample {sample}: no such class; {hint}")
        start, stop = known[slug].start, known[slug].stop
        if not index.isdecimal() or int(index) >= stop - start:
            allowed = f"{slug}/0 to {slug}/{stop - start - 1}"
            raise FolderError(f"--sample {sample}: should be {allowed}")
        rows.append(start + int(index))
    return rows


def sample_entries(data: Dataset, rows: Sequence[int]) -> list[Entry]:
    """Make the entries of the page for rows: stored maps, and the truth of simulated scenes."""
    extents = {name: data.extents(name) for name in data.maps}
    return [
        _sample_entry(data, row, {name: extents[name][row] for name in extents}) for row in rows
    ]


def _sample_entry(data: Dataset, row: int, extents: dict[str, NDArray[Any]]) -> Entry:
    """Make the entry of a row, whose maps have these edges by name."""
    config, (activity, index) = data.config, Rows.of(data.config)[row]
    scene, notes = _scene(data, row)
    board, likely_scene = None, scene
    if scene is None and isinstance(config, Config):
        likely_scene = nominal_scene(config, activity)
    if likely_scene is not None and isinstance(likely_scene.radar, ArrayRadar):
        radar = likely_scene.radar.first_subframe  # that has the plain names
        board = board_of(radar, likely_scene.seconds)
    if isinstance(config, MeasuredConfig) and "points" not in data.products:
        board = _recorded_board(config)
    if scene is not None:
        view = view_scene(scene, tuple(map(motion_of, scene.people)))
    else:
        spans = (extents[name][:2] for name in data.maps if column_axis(name)[1] == "s")
        view = SceneView(frame_times(*next(spans, (0.0, 0.0))))
        view = view if board is None else _stored_joints(data, row, board, view)
    plots = [plot_map(view, stored_map) for stored_map in _maps(data, row, extents)]
    cloud, of_points = None, "points" in data.products
    if board is not None:
        plots += [plot_map(view, frames) for frames in _frames(data, row, board)]
        cloud = _stored_points(data, row, partial(_times, board)) if of_points else None
    elif of_points and isinstance(config, MeasuredConfig):
        view = view._replace(axes=OF_RADAR)
        cloud = _stored_points(data, row, partial(_recorded_times, config))
        view = view._replace(time=frame_times(0.0, float(cloud.times[-1])))
    if view.bodies or cloud is not None:
        plots = [plot_space(view, cloud, board if scene is not None else None), *plots]
    stored = {f.key: data.scene[f.name].rows(row, row + 1)[0] / f.factor for f in data.fields}
    numbers = {key: value for key, value in stored.items() if np.isfinite(value)}
    title = f"{activity.label} {activity.slug}/{index}, {SPLITS[data.split[row]]}"
    return make_entry(view, plots, title, notes, numbers)


def _maps(data: Dataset, row: int, extents: dict[str, NDArray[Any]]) -> Iterator[MapLevels]:
    """Yield the stored maps of a row, but for sheets of maps that are stored as frames."""
    image = data.config.image
    for name in data.maps:
        if name not in FRAME_MAPS:
            grey, (left, right, bottom, top) = data.maps[name][row], extents[name]
            columns = Axis(*column_axis(name), _cells(left, right, grey.shape[1]))
            rows = Axis(*row_axis(name), _cells(bottom, top, grey.shape[0]))
            scale = LevelScale.of_data_set(image, image.kind)
            yield MapLevels(name, grey[None, ::-1], scale, columns, rows)


def _stored_points(data: Dataset, row: int, times_of: Callable[[int], NDArray[Any]]) -> PointFrames:
    """Read the stored points of a row, whose frames have times by their number."""
    points, start = _product(data, row, "points", (8,)), _product(data, row, "points_start")
    return PointFrames(times_of(len(start) - 1), start.astype(int), np.nan_to_num(points))


def _recorded_board(config: MeasuredConfig) -> Board | None:
    """Board of a data set of recordings of samples; None of a radar without frames."""
    radar = fixed_radar(config)
    return board_of(radar, config.duration_s) if isinstance(radar, ArrayRadar) else None


def _recorded_times(config: MeasuredConfig, frames: int) -> NDArray[Any]:
    """Times of `frames` frames of a recording of points, from the start of its window, s."""
    return np.arange(frames) * (config.recordings.frame_s or 1.0)


def _cells(low: float, high: float, cells: int) -> NDArray[Any]:
    """Middles of `cells` equal cells from `low` to `high` [cell]."""
    return low + (np.arange(cells) + 0.5) * (high - low) / cells


def _times(board: Board, frames: int) -> NDArray[Any]:
    """Middles of `frames` frames, s; a recorded sample may have other frames than its config."""
    return np.arange(frames) * board.period_s + board.loops * board.loop_s / 2


def _product(data: Dataset, row: int, name: str, shape: tuple[int | None, ...] = ()) -> Any:
    """Read a stored array of numbers [n, *shape]; None in the shape is any length.

    Raises:
        FolderError: it has another shape or type.
    """
    values = np.atleast_1d(data.products[name][row])
    stored_shape = values.shape[1:]
    expected_shape = tuple(
        n or stored_shape[axis] if axis < len(stored_shape) else n for axis, n in enumerate(shape)
    )
    least = {"points": 0, "points_start": 2}.get(name, 1)
    if stored_shape != expected_shape or len(values) < least or values.dtype.kind not in "iuf":
        axes = ", ".join(["n", *(str(n or "any") for n in shape)])
        raise FolderError(f"{data.path}: /products/{name}: should be numbers [{axes}]")
    return values


def _frames(data: Dataset, row: int, board: Board) -> Iterator[MapLevels]:
    """Yield the stored frame maps of a row."""
    scale = LevelScale.of_data_set(data.config.image, "decibel")
    for name, kind in FRAME_MAP_KINDS.items():
        if name in data.products:
            rows, columns = kind.rows.of(board), kind.columns.of(board)
            limits = data.config.image.range_limits_m
            if rows.name == "range" and limits is not None:
                rows = rows.only(rows.cells_within(limits))
            grey = _product(data, row, name, (rows.values.size, columns.values.size))
            yield MapLevels(name, grey, scale, columns, rows, _times(board, len(grey)))


def _stored_joints(data: Dataset, row: int, board: Board, view: SceneView) -> SceneView:
    """Add the stored joints, in the axes of the radar, to the view of a scene."""
    view = view._replace(axes=OF_RADAR)
    if "skeleton" not in data.products:
        return view
    joints = _product(data, row, "skeleton", (None, None, 3)).astype(float)
    count = joints.shape[2]
    known = count == len(JOINTS)
    names = JOINTS if known else [f"joint {n}" for n in range(count)]
    still = np.concatenate([joints, np.zeros((*joints.shape[:3], 1))], axis=3)
    ends = bones(still, PARENTS if known else (None,) * count)
    bodies = [MovingBody(f"person {n}", names, ends[:, n]) for n in range(ends.shape[1])]
    return view._replace(time=_times(board, len(joints)), bodies=bodies)


def _scene(data: Dataset, row: int) -> tuple[Scene | None, list[str]]:
    """Draw the scene of a sample again; None, and notes why, where it is not the one stored."""
    config, (activity, index) = data.config, Rows.of(data.config)[row]
    if isinstance(config, MeasuredConfig):
        return None, ["Measured: there are no true joints."]
    if config.files_of(activity) is not None:
        joints = "those that are stored" if "skeleton" in data.products else "not known"
        return None, [f"Motion files are not opened: joints are {joints}."]
    try:
        scene, _ = draw_valid_scene(config, activity, index)
    except RadharError as error:
        return None, [f"No skeleton: {error}"]
    columns = [field for field in data.fields if field is not scene_fields.ERROR]
    drawn = scene_fields.values(scene, tuple(columns))
    stored = [data.scene[f.name].rows(row, row + 1)[0] / f.factor for f in columns]
    if np.allclose(drawn, stored, rtol=1e-9, atol=0, equal_nan=True):
        return scene, []
    why = "this version of radhar draws another scene than the one stored"
    return None, [f"No skeleton: {why}."]
