"""What the page of `radhar view` shows of samples of a data set."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.config.schema import FRAME_MAPS, Config, MeasuredConfig
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.layout import SPLITS, Rows, column_axis, row_axis
from radhar_cli.dataset.reading import Dataset
from radhar_cli.errors import FolderError, RadharError
from radhar_cli.figures import scene_page
from radhar_cli.figures.scene_page import Entry, SceneView, ShownBody
from radhar_cli.figures.sides import bones
from radhar_cli.motion.skeleton import JOINTS, PARENTS
from radhar_cli.pipeline.physics import board_of, motion_of
from radhar_cli.pipeline.validity import draw_valid_scene
from radhar_cli.processing.frame_maps import doppler_axis, range_axis
from radhar_cli.processing.power_map import Axis
from radhar_cli.radar.board import Board
from radhar_cli.scene import Scene, nominal_scene
from radhar_cli.vocabulary import FROM_FILES, advice_on

MOST = 50  # samples of a page


def chosen_rows(data: Dataset, samples: Sequence[str]) -> list[int]:
    """Rows of samples CLASS/INDEX, or of the first of each class, stationary people last.

    Raises:
        FolderError: there is no such sample, or there are too many.
    """
    classes = sorted(Rows.of(data.config).classes(), key=lambda part: part[0].slug == "stationary")
    if len(samples) > MOST:
        raise FolderError(f"--sample: {len(samples)} samples; a page holds {MOST} at most")
    if not samples:
        return [part.start for _, part in classes if part.stop > part.start][:MOST]
    known = {name: part for one, part in classes for name in (one.slug, one.label)}
    rows = []
    for sample in samples:
        slug, _, index = sample.partition("/")
        if slug not in known:
            names = [one.slug for one, _ in classes]
            there = f"there are {', '.join(sorted(names))}"
            meant = advice_on(slug, names, there)
            hint = there if meant == FROM_FILES else meant
            raise FolderError(f"--sample {sample}: no such class; {hint}")
        start, stop = known[slug].start, known[slug].stop
        if not index.isdecimal() or int(index) >= stop - start:
            wanted = f"{slug}/0 to {slug}/{stop - start - 1}"
            raise FolderError(f"--sample {sample}: should be {wanted}")
        rows.append(start + int(index))
    return rows


def of_samples(data: Dataset, rows: Sequence[int]) -> list[Entry]:
    """What the page shows of these rows: what is stored, and the truth of simulated scenes."""
    extents = {name: data.extents(name) for name in data.maps}
    return [_of_sample(data, row, {name: extents[name][row] for name in extents}) for row in rows]


def _of_sample(data: Dataset, row: int, extents: dict[str, NDArray[Any]]) -> Entry:
    config, (activity, index) = data.config, Rows.of(data.config)[row]
    scene, notes = _scene(data, row)
    spans = (extents[name][:2] for name in data.maps if column_axis(name)[1] == "s")
    seen, maps, cloud = SceneView(scene_page.clock(*next(spans, (0.0, 0.0)))), list[Entry](), None
    if scene is not None:
        seen = scene_page.moving(scene, tuple(map(motion_of, scene.people)))
    board = None
    if isinstance(config, Config) and config.radar.cfg is not None:
        drawn = scene or nominal_scene(config, activity)
        board = board_of(drawn.radar, drawn.seconds)
        seen = seen if scene is not None else _stored_joints(data, row, board, seen)
    for name in data.maps:
        if name not in FRAME_MAPS:  # whose images are sheets of what is stored as frames
            grey, (left, right, bottom, top) = data.maps[name][row], extents[name]
            columns = Axis(*column_axis(name), _cells(left, right, grey.shape[1]))
            axes = columns, Axis(*row_axis(name), _cells(bottom, top, grey.shape[0]))
            look = (config.image, config.image.kind)
            maps.append(scene_page.heat(seen, name, grey[None, ::-1], look, axes))
    if board is not None:
        maps += _frames(data, row, board, seen)
        if "points" in data.products:
            points, start = _product(data, row, "points", (8,)), _product(data, row, "points_start")
            cloud = _times(board, len(start) - 1), start.astype(int), points
    stored = {f.key: data.scene[f.name].rows(row, row + 1)[0] / f.factor for f in data.fields}
    numbers = {key: value for key, value in stored.items() if np.isfinite(value)}
    title = f"{activity.label} {activity.slug}/{index}, {SPLITS[data.split[row]]}"
    if seen.bodies or cloud:
        maps = [scene_page.space(seen, cloud, board if scene is not None else None), *maps]
    return scene_page.entry(seen, maps, title, notes, numbers)


def _cells(low: float, high: float, cells: int) -> NDArray[Any]:
    """Middles of cells."""
    return low + (np.arange(cells) + 0.5) * (high - low) / cells


def _times(board: Board, frames: int) -> NDArray[Any]:
    """Middles of frames, s; a recorded sample may have others than its config says."""
    return np.arange(frames) * board.period + board.loops * board.loop / 2


def _product(data: Dataset, row: int, name: str, shape: tuple[int | None, ...] = ()) -> Any:
    """A stored array [n, *shape] of numbers; FolderError of another."""
    values = np.atleast_1d(data.products[name][row])
    there = values.shape[1:]
    wanted = tuple(n or there[at] if at < len(there) else n for at, n in enumerate(shape))
    least = {"points": 0, "points_start": 2}.get(name, 1)
    if there != wanted or len(values) < least or values.dtype.kind not in "iuf":
        named = ", ".join(["n", *(str(n or "any") for n in shape)])
        raise FolderError(f"{data.path}: /products/{name}: should be numbers [{named}]")
    return values


def _frames(data: Dataset, row: int, board: Board, seen: SceneView) -> Iterator[Entry]:
    """Frame maps that are stored, as grey levels."""
    for name in FRAME_MAPS[:3]:
        if name in data.products:
            columns = doppler_axis(board)
            if name != "range_doppler":
                columns = Axis(name.removeprefix("range_"), "degree", np.arange(-90.0, 91.0))
            grey = _product(data, row, name, (board.n_fft, columns.values.size))
            look, axes = (data.config.image, "decibel"), (columns, range_axis(board))
            yield scene_page.heat(seen, name, grey, look, axes, _times(board, len(grey)))


def _stored_joints(data: Dataset, row: int, board: Board, seen: SceneView) -> SceneView:
    """Joints that are stored, in the axes of the radar, where the scene is not drawn again."""
    seen = seen._replace(axes=("ahead (m)", "left (m)", "up of the radar (m)"))
    if "skeleton" not in data.products:
        return seen
    joints = _product(data, row, "skeleton", (None, None, 3)).astype(float)
    count = joints.shape[2]
    known = count == len(JOINTS)
    names = JOINTS if known else [f"joint {n}" for n in range(count)]
    still = np.concatenate([joints, np.zeros((*joints.shape[:3], 1))], axis=3)
    ends = bones(still, PARENTS if known else (None,) * count)
    bodies = [ShownBody(f"person {n}", names, ends[:, n]) for n in range(ends.shape[1])]
    return seen._replace(time=_times(board, len(joints)), bodies=bodies)


def _scene(data: Dataset, row: int) -> tuple[Scene | None, list[str]]:
    """The scene of a sample, drawn again; None, and why, where that is not the one stored."""
    config, (activity, index) = data.config, Rows.of(data.config)[row]
    if isinstance(config, MeasuredConfig):
        return None, ["Measured: there are no true joints."]
    if config.files_of(activity) is not None:
        kept = "those that are stored" if "skeleton" in data.products else "not known"
        return None, [f"Motion files are not opened: joints are {kept}."]
    try:
        scene, _ = draw_valid_scene(config, activity, index)
    except RadharError as error:
        return None, [f"No skeleton: {error}"]
    columns = [field for field in data.fields if field is not scene_fields.ERROR]
    drawn = scene_fields.values(scene, tuple(columns))
    there = [data.scene[f.name].rows(row, row + 1)[0] / f.factor for f in columns]
    if np.allclose(drawn, there, rtol=1e-9, atol=0, equal_nan=True):
        return scene, []
    why = "this version of radhar draws another scene than the one stored"
    return None, [f"No skeleton: {why}."]
