"""view.html: skeletons, point clouds and maps of scenes at one instant; it needs no other file."""

import base64
import gzip
from collections.abc import Iterable, Mapping, Sequence
from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex

from radhar_cli.bodies.motion_paths import point_delay
from radhar_cli.config.image import ImageConfig
from radhar_cli.figures.maps_panel import TITLES, alias_doppler
from radhar_cli.figures.maps_panel import title as title_of
from radhar_cli.figures.sides import limbs
from radhar_cli.files.replacing import write_text
from radhar_cli.motion.protocol import Motion
from radhar_cli.numerics.arrays import Float, Index, Levels
from radhar_cli.processing.frame_maps import FRAME_MAP_KINDS, FrameMaps
from radhar_cli.processing.image import levels, reduced_map, signed_levels
from radhar_cli.processing.power_map import Axis
from radhar_cli.products.run import record
from radhar_cli.radar.board import Board
from radhar_cli.radar.waveform import SPEED_OF_LIGHT
from radhar_cli.scene import Scene, scene_numbers
from radhar_cli.single_scene.simulate import Simulation
from radhar_cli.single_scene.truth import truth

FRAMES_PER_SECOND, MAX_FRAMES = 25, 600
FINER = 4  # points of a Doppler curve a frame
MAX_SIDE = 400  # cells of a map
MAX_CELLS = 4_000_000  # of all frames of a board's map
SCALES = {"signed": (-1.0, 1.0, "relative amplitude"), "cfar": (0.0, 1.0, "detected")}
CALLED = {"s": "time", "Hz": "Doppler", "m/s": "approaching"}
Entry: TypeAlias = dict[str, Any]  # what JSON holds
Points: TypeAlias = tuple[Float, Index, Float]  # times and starts of frames, points of all


class ShownBody(NamedTuple):
    """A person: name, names of joints, bones (x, y, z, approaching speed) [time, joint, 2, 4]."""

    name: str
    joints: Sequence[str]
    bones: Float


class SceneView(NamedTuple):
    """View of a scene besides its maps: bodies, true Doppler and the radar."""

    time: Float  # at which something is shown, s
    bodies: Sequence[ShownBody] = ()
    axes: Sequence[str] = ("x, range (m)", "y, cross-range (m)", "z, height (m)")
    radar: Any = ((0.0, 0.0, 0.0),)  # places of antennas, m
    curves: Mapping[str, Float] = {}  # true Doppler of joints, the torso's first, Hz
    prf: float = 1.0  # to which they are alias_doppler, Hz
    hertz: float = 0.0  # Doppler of 1 m/s, 0 where it is not known
    farthest: float = np.inf  # range that maps show, m


def of_simulation(simulation: Simulation) -> Entry:
    """Make the entry of a simulated scene."""
    image, board, frames = simulation.config.image, simulation.board, simulation.frames
    motions = (simulation.motion, *(one.motion for one in simulation.others))
    seen, plots, cloud = moving(simulation.scene, motions), list[Entry](), None
    for name, one in simulation.maps.items():
        kept = (one.rows.values <= seen.farthest) | (one.rows.unit != "m")
        rows, cells = Axis(one.rows.name, one.rows.unit, one.rows.values[kept]), one.shown[kept]
        size, kind = (min(MAX_SIDE, len(cells)), min(MAX_SIDE, cells.shape[1])), "signed"
        if one.real is not None:
            grey = signed_levels(cells, size, image.clipped)
        else:
            cells, kind = reduced_map(cells, size, entropy=False).cells, "decibel"
            grey = levels(cells, image.dynamic_range_db)
        plots.append(heat(seen, name, grey[None, ::-1], (image, kind), (one.columns, rows)))
    for name, one in frames.items():
        if isinstance(one, FrameMaps):
            grey, axes = levels(one.power, image.dynamic_range_db), (one.columns, one.rows)
            plots.append(heat(seen, name, grey, (image, "decibel"), axes, one.times))
    if board is not None and "cloud" in frames:
        cloud = board.middles, frames["cloud"].start, frames["cloud"].points
    plots, numbers = [space(seen, cloud, board), *plots], scene_numbers(simulation.scene)
    return entry(seen, plots, title_of(simulation), simulation.warnings, numbers)


def entry(
    seen: SceneView, plots: list[Entry], title: str, notes: list[str], numbers: Mapping[str, float]
) -> Entry:
    """Make the entry of a scene.

    Args:
        seen: view of the scene.
        plots: its plots.
        title: line above.
        notes: remarks, a line each.
        numbers: numbers of the scene by config key.
    """
    shown = {key: f"{value:.6g}" for key, value in numbers.items()}
    return {"title": title, "notes": notes, "numbers": shown, "time": seen.time, "plots": plots}


def moving(scene: Scene, motions: Sequence[Motion]) -> SceneView:
    """Compute the view of a scene: everybody's skeleton and true Doppler, in order of `motions`."""
    made = record(scene, ("antennas", "wall", "waveform"), motions=tuple(motions))
    antennas, wall, w = made["antennas"], made["wall"], made["waveform"]
    time = clock(0, float(w.times(np.array([w.n_pulses - 1.0]))[0]))
    fine = np.linspace(0, time[-1], FINER * (time.size - 1) + 1)
    bodies, curves, far = [], dict[str, Float](), 0.0
    for person, motion in zip(scene.people, motions, strict=True):
        true = truth(motion, antennas, wall, w, fine)
        joints = np.concatenate([true.positions, -true.radial_velocity[..., None]], axis=2)
        ends = limbs(joints, motion.parents, true.hip_joints)[::FINER]
        bodies.append(
            ShownBody(f"{person.activity.label} {person.activity.slug}", motion.names, ends)
        )
        who = f"{person.number} " if len(motions) > 1 else ""
        curves |= {who + one: true.doppler[:, n] for n, one in enumerate(motion.names)}
        far = max(far, point_delay(true.positions.T, antennas, wall).max() * SPEED_OF_LIGHT / 2)
    seen = SceneView(time, bodies, radar=(antennas.tx, antennas.rx), curves=curves, prf=w.prf)
    return seen._replace(hertz=2 * w.f0 / SPEED_OF_LIGHT, farthest=1.3 * far + 0.5)


def clock(start: float, end: float) -> Float:
    """Times from `start` to `end` at which the page shows something, s."""
    return np.linspace(start, end, min(int((end - start) * FRAMES_PER_SECOND) + 2, MAX_FRAMES))


def space(seen: SceneView, cloud: Points | None, board: Board | None) -> Entry:
    """Plot skeletons and points in 3-D.

    Args:
        seen: view of the scene.
        cloud: times and starts of frames, and points (ahead, left, up, approaching); None for none.
        board: board whose place is known, so that points are in the axes of the scene; else None.
    """
    traces, moves = list[Entry](), list[Entry]()
    around, fastest = [np.array(seen.radar)], 0.5
    for body in seen.bodies:
        bones = np.insert(body.bones, 2, np.nan, axis=2).reshape(len(seen.time), -1, 4)  # with gaps
        around.append(bones[..., :3].reshape(-1, 3))
        fastest = max(fastest, float(np.nanmax(np.abs(bones[..., 3]), initial=0)))
        text = [name.replace("_", " ") for name in body.joints for _ in range(3)]
        traces.append({"name": body.name, "mode": "lines+markers", "text": text})
        moves.append(_moves(np.arange(len(bones)), bones))
    if cloud is not None:
        times, start, points = cloud
        if board is not None:
            xyz = points[:, :3] @ np.array(board.aim.axes) + board.position
            points = np.concatenate([xyz, points[:, 3:4]], axis=1)
        if not seen.bodies and len(points):
            around.append(np.percentile(points[:, :3], [2, 98], axis=0))
        traces.append({"name": "points", "mode": "markers", "marker": {"symbol": "square"}})
        frames = [points[a:b] for a, b in pairwise(start)]
        moves.append(_moves(_nearest(times[: len(frames)], seen.time), frames))
    place = dict(zip("xyz", around[0].T, strict=True))
    red = {"symbol": "diamond", "color": "#d62728"}
    traces.append({"name": "radar", "mode": "markers", "marker": red, **place})
    low, high = (edge(np.concatenate(around), axis=0) for edge in (np.nanmin, np.nanmax))
    box = {
        f"{letter}axis": {"title": {"text": name}, "range": (least - 0.3, most + 0.3)}
        for letter, name, least, most in zip("xyz", seen.axes, low, high, strict=True)
    }
    layout = {"scene": box, "coloraxis": {"cmin": -fastest, "cmax": fastest}}
    traces = [{"type": "scatter3d", **one} for one in traces]
    return {"data": traces, "layout": layout, "moves": moves}


def _moves(at: Index, frames: Sequence[Float] | Float) -> Entry:
    """Move of a trace: frames of (x, y, z, approaching speed), and the frame at each time."""
    keys, exact = enumerate(("x", "y", "z", "marker.color")), [one.astype(float) for one in frames]
    return {"at": at, "frames": {key: [one[:, n].round(3) for one in exact] for n, key in keys}}


def _nearest(times: Float, instants: Float) -> Index:
    """Index of the time nearest to each instant [instant]."""
    index: Index = np.abs(times - instants[:, None]).argmin(axis=1)
    return index


def heat(
    seen: SceneView,
    name: str,
    grey: Levels,
    look: tuple[ImageConfig, str],
    axes: tuple[Axis, Axis],
    times: Float | None = None,
) -> Entry:
    """Plot a map.

    Args:
        seen: view of the scene.
        name: name of the map.
        grey: levels [frame, row, column], lowest row first.
        look: settings of images, and the kind of this one.
        axes: axes of columns and rows.
        times: times of the frames [frame], s, to show the frame of each instant; None shows a
            cursor where the columns are times.
    """
    (image, kind), more = look, ""
    low, high, unit = SCALES.get(kind, (-image.dynamic_range_db, 0.0, "dB re peak"))
    every = [-(-grey.size // MAX_CELLS), *(-(-cells // MAX_SIDE) for cells in grey.shape[1:])]
    values = low + (high - low) / 255 * grey[:: every[0], :: every[1], :: every[2]]
    packed = (base64.b64encode(one.astype("<f4").tobytes()).decode() for one in values)
    shape = "{}, {}".format(*values.shape[1:])
    z = [{"dtype": "f4", "bdata": data, "shape": shape} for data in packed]
    frame_map = FRAME_MAP_KINDS.get(name)
    title = TITLES.get(name, name) if frame_map is None else frame_map.title
    colours = [(n / 32, to_hex(colormaps[image.colour_map](n / 32))) for n in range(33)]
    trace: Entry = {"type": "heatmap", "name": title, "z": z[0], "colorscale": colours}
    trace |= {"zmin": low, "zmax": high, "colorbar": {"title": {"text": unit}}}
    layout: Entry = {"title": {"text": title}}
    for letter, axis, cells in zip("xy", axes, values.shape[:0:-1], strict=True):
        (first, last), label = axis.edges, CALLED.get(axis.unit, axis.name) + f" ({axis.unit})"
        if axis.unit == "Hz" and seen.hertz:
            first, last, more = first / seen.hertz, last / seen.hertz, f"{seen.hertz:.3g} Hz"
            label = f"approaching (m/s), 1 m/s = {more}"
        step = (last - first) / cells
        trace |= {f"{letter}0": first + step / 2, f"d{letter}": step}
        last = min(last, seen.farthest) if axis.unit == "m" else last
        ends = (last, first) if axis.name == "azimuth" else (first, last)  # left is left
        layout[f"{letter}axis"] = {"title": {"text": label}, "range": ends}
    plot: Entry = {"data": [trace], "layout": layout, "moves": []}
    if times is not None:
        at = _nearest(times[: len(grey)][:: every[0]], seen.time)
        return plot | {"moves": [{"at": at, "frames": {"z": z}}]}
    plot["data"] += _curves(seen, "compensated" in name) if more and seen.curves else []
    return plot | {"cursor": axes[0].unit == "s"}


def _curves(seen: SceneView, compensated: bool) -> list[Entry]:
    """Traces of the true Doppler of the joints, aliased by the radar, shown by a click."""
    doppler = np.stack(list(seen.curves.values()), axis=1)
    shown = alias_doppler(doppler - doppler[:, :1] * compensated, seen.prf).T / seen.hertz
    look = {"type": "scatter", "dx": seen.time[-1] / (len(doppler) - 1)}
    named = zip(seen.curves, shown.round(2), strict=True)
    key = {**look, "y": [None], "name": "true Doppler: click", "showlegend": True}
    return [key, *({**look, "y": y, "name": name, "showlegend": False} for name, y in named)]


def write_page(scenes: Iterable[Entry], path: Path) -> None:
    """Write the page of scenes.

    What scenes say is text from strangers: it is packed in base64, and the page's script gives it
    to the browser as text alone.
    """
    from plotly.io.json import to_json_plotly
    from plotly.offline import get_plotlyjs

    document = to_json_plotly(list(scenes), engine="json")
    page = files(__package__).joinpath("scene_page.html").read_text(encoding="utf-8")
    for name, text in (("PLOTLY", get_plotlyjs()), ("SCENES", document)):
        packed = gzip.compress(text.encode(), mtime=0)
        page = page.replace(f"@{name}@", base64.b64encode(packed).decode())
    write_text(path, page)
