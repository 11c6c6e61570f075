"""Plots of the page of a scene, as plotly's JSON: skeletons and points in 3-D, and maps."""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex

from radhar_cli.config.image import ImageConfig
from radhar_cli.figures.maps_panel import TITLES, alias_doppler
from radhar_cli.figures.scene_view import MovingBody, SceneView
from radhar_cli.figures.style import SIGNED
from radhar_cli.numerics.arrays import Float, Index, Levels
from radhar_cli.processing.frame_maps import FRAME_MAP_KINDS
from radhar_cli.processing.map_kind import treatment_of
from radhar_cli.processing.power_map import Axis
from radhar_cli.radar.board import Board

MAX_SIDE = 400  # cells of a map
MAX_CELLS = 4_000_000  # of all frames of a board's map
SCALES = {"signed": (-1.0, 1.0, "relative amplitude"), "cfar": (0.0, 1.0, "detected")}
QUANTITIES = {"s": "time", "Hz": "Doppler", "m/s": "approaching"}  # by unit
Plot: TypeAlias = dict[str, Any]  # data and layout of plotly, and `moves`: what changes in time


class PointFrames(NamedTuple):
    """Points of a board's frames."""

    times: Float  # of the frames [frame], s
    start: Index  # first point of each frame, and last the number of all [frame + 1]
    points: Float  # ahead, left, up (m), approaching (m/s) and more [point, ...]


@dataclass(frozen=True)
class LevelScale:
    """Values and colours of the 255 levels of a map."""

    low: float  # value of level 0
    high: float  # value of level 255
    unit: str
    colour_map: str

    @classmethod
    def of(cls, image: ImageConfig, kind: str) -> "LevelScale":
        """Scale of maps that a page draws, by their kind (decibel, signed, cfar) and their peak."""
        low, high, unit = SCALES.get(kind, (-image.dynamic_range_db, 0.0, "dB re peak"))
        return cls(low, high, unit, SIGNED if kind == "signed" else image.colour_map)

    @classmethod
    def of_data_set(cls, image: ImageConfig, kind: str) -> "LevelScale":
        """Scale of the images of a data set, by their kind (decibel or cfar) and `reference`."""
        if kind != "decibel" or image.reference == "peak":
            return cls.of(image, kind)
        if image.reference == "noise":
            return cls(0.0, image.dynamic_range_db, "dB above level 0", image.colour_map)
        white = image.reference.dbm
        return cls(white - image.dynamic_range_db, white, "dBm", image.colour_map)

    def colours(self) -> list[tuple[float, str]]:
        """Colours of plotly: places from 0 to 1, and the colour there."""
        table = colormaps[self.colour_map]
        return [(n / 32, to_hex(table(n / 32))) for n in range(33)]


@dataclass(frozen=True)
class MapLevels:
    """A map to plot.

    Attributes:
        name: name of the map.
        levels: levels [frame, row, column], lowest row first.
        scale: values and colours of the levels.
        columns, rows: axes.
        times: times of the frames [frame], s, to show the frame of each instant; None shows a
            cursor where the columns are times.
    """

    name: str
    levels: Levels
    scale: LevelScale
    columns: Axis
    rows: Axis
    times: Float | None = None


def plot_space(view: SceneView, cloud: PointFrames | None, board: Board | None) -> Plot:
    """Plot skeletons and points in 3-D.

    Args:
        cloud: points of frames; None for none.
        board: board whose place is known, so that points are in the axes of the scene; else None.
    """
    traces, moves, surroundings = list[Plot](), list[Plot](), [np.array(view.radar)]
    for body in view.bodies:
        bones = _with_gaps(body, len(view.time))
        surroundings.append(bones[..., :3].reshape(-1, 3))
        text = [name.replace("_", " ") for name in body.joints for _ in range(3)]
        traces.append({"name": body.name, "mode": "lines+markers", "text": text})
        moves.append(_moves(np.arange(len(bones)), bones))
    if cloud is not None:
        points = cloud.points if board is None else _in_scene(cloud.points, board)
        if not view.bodies and len(points):
            surroundings.append(np.percentile(points[:, :3], [2, 98], axis=0))
        traces.append({"name": "points", "mode": "markers", "marker": {"symbol": "square"}})
        frames = [points[start:stop] for start, stop in pairwise(cloud.start)]
        moves.append(_moves(_nearest(cloud.times[: len(frames)], view.time), frames))
    place = dict(zip("xyz", surroundings[0].T, strict=True))
    red = {"symbol": "diamond", "color": "#d62728"}
    traces.append({"name": "radar", "mode": "markers", "marker": red, **place})
    layout = _space_layout(view, np.concatenate(surroundings))
    return {
        "data": [{"type": "scatter3d", **trace} for trace in traces],
        "layout": layout,
        "moves": moves,
    }


def _with_gaps(body: MovingBody, times: int) -> Float:
    """Ends of bones [time, 3 bone, 4], with NaN after each bone, so that a line has gaps."""
    return np.insert(body.bones, 2, np.nan, axis=2).reshape(times, -1, 4)


def _in_scene(points: Float, board: Board) -> Float:
    """Points (x, y, z, approaching) in the axes of the scene, of those in a board's axes."""
    xyz = points[:, :3] @ np.array(board.upright.axes) + board.position
    return np.concatenate([xyz, points[:, 3:4]], axis=1)


def _space_layout(view: SceneView, surroundings: Float) -> Plot:
    """Layout in which all places [n, 3] (m) are seen, and speeds up to the fastest."""
    speeds = (np.nanmax(np.abs(body.bones[..., 3]), initial=0) for body in view.bodies)
    fastest = max([0.5, *map(float, speeds)])
    lowest, highest = np.nanmin(surroundings, axis=0), np.nanmax(surroundings, axis=0)
    box = {
        f"{letter}axis": {"title": {"text": name}, "range": (low - 0.3, high + 0.3)}
        for letter, name, low, high in zip("xyz", view.axes, lowest, highest, strict=True)
    }
    return {"scene": box, "coloraxis": {"cmin": -fastest, "cmax": fastest}}


def _moves(frame_numbers: Index, frames: Sequence[Float] | Float) -> Plot:
    """Move of a trace: frames of (x, y, z, approaching speed), and the frame at each time."""
    keys = enumerate(("x", "y", "z", "marker.color"))
    exact = [frame.astype(float) for frame in frames]
    return {
        "at": frame_numbers,
        "frames": {key: [frame[:, n].round(3) for frame in exact] for n, key in keys},
    }


def _nearest(times: Float, instants: Float) -> Index:
    """Index of the time nearest to each instant [instant]."""
    index: Index = np.abs(times - instants[:, None]).argmin(axis=1)
    return index


def plot_map(view: SceneView, map_levels: MapLevels) -> Plot:
    """Plot a map, with a cursor, or with a frame at each instant."""
    scale, levels = map_levels.scale, map_levels.levels
    frame_step = -(-levels.size // MAX_CELLS)
    row_step, column_step = (-(-cells // MAX_SIDE) for cells in levels.shape[1:])
    thinned = levels[::frame_step, ::row_step, ::column_step]
    values = scale.low + (scale.high - scale.low) / 255 * thinned
    frames = _packed_frames(values)
    frame_map = FRAME_MAP_KINDS.get(map_levels.name)
    title = TITLES.get(map_levels.name, map_levels.name) if frame_map is None else frame_map.title
    trace: Plot = {"type": "heatmap", "name": title, "z": frames[0], "colorscale": scale.colours()}
    trace |= {"zmin": scale.low, "zmax": scale.high, "colorbar": {"title": {"text": scale.unit}}}
    layout: Plot = {"title": {"text": title}}
    axes = (map_levels.columns, map_levels.rows)
    for letter, axis, cells in zip("xy", axes, values.shape[:0:-1], strict=True):
        grid, layout[f"{letter}axis"] = _plot_axis(view, axis, cells)
        trace |= {f"{letter}0": grid[0], f"d{letter}": grid[1]}
    plot: Plot = {"data": [trace], "layout": layout, "moves": []}
    if map_levels.times is not None:
        times = map_levels.times[: len(levels)][::frame_step]
        return plot | {"moves": [{"at": _nearest(times, view.time), "frames": {"z": frames}}]}
    if (
        view.curves
        and map_levels.columns.name != "cadence"
        and any(_shows_speed(view, axis) for axis in axes)
    ):
        plot["data"] += _curves(view, treatment_of(map_levels.name).compensated)
    return plot | {"cursor": map_levels.columns.unit == "s"}


def _packed_frames(values: Float) -> list[Plot]:
    """Frames [frame, row, column] as plotly takes binary arrays."""
    shape = "{}, {}".format(*values.shape[1:])
    packed = (base64.b64encode(frame.astype("<f4").tobytes()).decode() for frame in values)
    return [{"dtype": "f4", "bdata": data, "shape": shape} for data in packed]


def _shows_speed(view: SceneView, axis: Axis) -> bool:
    """Whether an axis of Doppler is drawn in m/s."""
    return axis.unit == "Hz" and axis.name != "cadence" and bool(view.hertz)


def _plot_axis(view: SceneView, axis: Axis, cells: int) -> tuple[tuple[float, float], Plot]:
    """Middle of the first cell and the step of an axis of so many cells, and its layout."""
    first, last = axis.edges
    quantity = axis.name if axis.name == "cadence" else QUANTITIES.get(axis.unit, axis.name)
    label = quantity + f" ({axis.unit})"
    if _shows_speed(view, axis):
        first, last = first / view.hertz, last / view.hertz
        label = f"approaching (m/s), 1 m/s = {view.hertz:.3g} Hz"
    step = (last - first) / cells
    end = min(last, view.farthest) if axis.unit == "m" else last
    ends = (end, first) if axis.name == "azimuth" else (first, end)  # left is left
    return (first + step / 2, step), {"title": {"text": label}, "range": ends}


def _curves(view: SceneView, compensated: bool) -> list[Plot]:
    """Traces of the true Doppler of the joints, aliased by the radar, shown by a click."""
    doppler = np.stack(list(view.curves.values()), axis=1)
    speeds = alias_doppler(doppler - doppler[:, :1] * compensated, view.prf).T / view.hertz
    look: Mapping[str, Any] = {"type": "scatter", "dx": view.time[-1] / (len(doppler) - 1)}
    named = zip(view.curves, speeds.round(2), strict=True)
    key = {**look, "y": [None], "name": "true Doppler: click", "showlegend": True}
    return [key, *({**look, "y": y, "name": name, "showlegend": False} for name, y in named)]
