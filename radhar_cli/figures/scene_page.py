"""view.html: skeletons, point clouds and maps of scenes at one instant; it needs no other file."""

import base64
import gzip
import json
from collections.abc import Iterable, Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex

from radhar_cli.arrays import Float, Index, Levels
from radhar_cli.config.schema import ImageConfig
from radhar_cli.figures.frames_panel import NAMES
from radhar_cli.figures.maps_panel import TITLES, described, folded
from radhar_cli.figures.maps_panel import title as title_of
from radhar_cli.figures.stickman import KNEES
from radhar_cli.motion.protocol import Motion
from radhar_cli.pipeline.motion_paths import point_delay
from radhar_cli.pipeline.run import record
from radhar_cli.plain_json import plain
from radhar_cli.processing.frame_maps import FrameMaps
from radhar_cli.processing.image import levels, reduced_map, signed_levels
from radhar_cli.processing.power_map import Axis, PowerMap
from radhar_cli.radar.board import Board
from radhar_cli.radar.waveform import SPEED_OF_LIGHT
from radhar_cli.replacing import write_text
from radhar_cli.scene import Numbers, Scene, scene_numbers
from radhar_cli.simulation.simulate import Simulation
from radhar_cli.simulation.truth import WHOLE, Truth, truth

FRAMES_PER_SECOND, MAX_FRAMES = 25, 600
FINER = 4  # points of a Doppler curve a frame
MAX_SIDE = 400  # cells of a map
MAX_CELLS = 4_000_000  # of all frames of a board's map
Entry: TypeAlias = dict[str, Any]  # what JSON holds


def of_simulation(simulation: Simulation) -> Entry:
    """What the page shows of a simulated scene."""
    config, board = simulation.config, simulation.board
    motions = (simulation.motion, *(one.motion for one in simulation.others))
    made = moving(simulation.scene, motions)
    farthest = made["farthest"]
    maps = [
        map_entry(name, one, config.image, simulation.waveform.f0, farthest)
        for name, one in simulation.maps.items()
    ]
    for name, one in simulation.frames.items():
        if isinstance(one, FrameMaps):
            scale = scale_of("decibel", config.image.dynamic_range_db)
            grey = levels(one.power, config.image.dynamic_range_db)
            axes = (one.columns, one.rows)
            maps.append(frames_entry(name, grey, scale, *axes, one.times, farthest))
    if board is not None and "cloud" in simulation.frames:
        cloud = simulation.frames["cloud"]
        made["cloud"] = cloud_entry(cloud.points, cloud.start, board.middles, board)
    return made | {
        "title": title_of(simulation).replace("   |   ", " | "),
        "notes": list(simulation.warnings),
        "maps": maps,
        "colours": colours(config.image),
    }


def moving(scene: Scene, motions: tuple[Motion, ...]) -> Entry:
    """Skeletons, their true Doppler, what stands around, and the times of the page."""
    seen = record(scene, ("antennas", "wall", "waveform"), motions=motions)
    antennas, wall, w = seen["antennas"], seen["wall"], seen["waveform"]
    end = float(w.times(np.array([w.n_pulses - 1.0]))[0])
    fine = np.linspace(0, end, FINER * (clock(0, end).size - 1) + 1)
    true = [truth(motion, antennas, wall, w, fine) for motion in motions]
    everybody = list(zip(scene.people, motions, true, strict=True))
    doppler = np.concatenate([one.doppler for one in true], axis=1)
    owners = [f"{person.number} " if len(true) > 1 else "" for person, _, _ in everybody]
    names = [who + joint for who, one in zip(owners, motions, strict=True) for joint in one.names]
    phases = [name if name != WHOLE else "" for name in true[0].phases]
    far = max(point_delay(one.positions.T, antennas, wall).max() for one in true)
    boxes = {} if wall is None else {"wall": wall.bounds}
    if scene.config.room.faces is not None:
        box = Numbers(scene.config.room).box_m
        boxes["room"] = (box.x, box.y, (0.0, box.height))
    return {
        "title": " | ".join(described(scene, w)),
        "numbers": scene_numbers(scene),
        "f0": w.f0,
        "farthest": round(1.3 * far * SPEED_OF_LIGHT / 2 + 0.5, 2),
        "time": fine[::FINER],
        "people": [_person(f"{p.activity.label} {p.activity.slug}", m, t) for p, m, t in everybody],
        "curves": {
            "time": fine,
            "names": names,
            "plain": folded(doppler, w.prf).T.round(1),
            "compensated": folded(doppler - true[0].doppler[:, :1], w.prf).T.round(1),
        },
        "phase": [phases[number] for number in true[0].phase_label[::FINER]],
        "radar": [antennas.tx, antennas.rx],
        "boxes": boxes,
        "axes": ["x, range (m)", "y, cross-range (m)", "z, height (m)"],
    }


def clock(start: float, end: float) -> Float:
    """Times at which the page shows something, s."""
    count = min(int((end - start) * FRAMES_PER_SECOND) + 2, MAX_FRAMES)
    return np.linspace(start, end, count)


def _person(label: str, motion: Motion, true: Truth) -> Entry:
    """A body: joints, bones as pairs of places, and how fast each joint approaches."""
    places = true.positions
    bones = [[parent, one] for one, parent in enumerate(motion.parents) if parent is not None]
    if true.hip_joints is not None:  # thighs hang on the hip joints
        places = np.concatenate([places, true.hip_joints], axis=1)
        for hip, knee in enumerate(KNEES):
            next(bone for bone in bones if bone[1] == knee)[0] = len(motion.names) + hip
        bones.append([len(motion.names), len(motion.names) + 1])
    return {
        "label": label,
        "joints": motion.names,
        "bones": bones,
        "places": places[::FINER].round(3),
        "speed": -true.radial_velocity[::FINER].round(2),
    }


def map_entry(
    name: str, power_map: PowerMap, image: ImageConfig, f0: float, farthest: float
) -> Entry:
    """A map, of ranges up to `farthest` (m), in at most MAX_SIDE cells a side."""
    rows, values = power_map.rows, power_map.shown
    if rows.unit == "m":
        near = rows.values <= farthest
        rows, values = Axis(rows.name, rows.unit, rows.values[near]), values[near]
    size = min(MAX_SIDE, values.shape[0]), min(MAX_SIDE, values.shape[1])
    if power_map.real is not None:
        grey, kind = signed_levels(values, size, image.clipped), "signed"
    else:
        cells = reduced_map(values, size, entropy=False).cells
        grey, kind = levels(cells, image.dynamic_range_db), "decibel"
    scale = scale_of(kind, image.dynamic_range_db)
    return image_entry(name, grey, scale, power_map.columns, rows, f0)


def scale_of(kind: str, dynamic_range_db: float) -> tuple[float, float, str]:
    """What the lowest and the highest grey level of an image stand for, and the unit."""
    fixed = {"signed": (-1.0, 1.0, "relative amplitude"), "cfar": (0.0, 1.0, "detected")}
    return fixed.get(kind, (-dynamic_range_db, 0.0, "dB re peak"))


def image_entry(
    name: str,
    grey: Levels,
    scale: tuple[float, float, str],
    columns: Axis,
    rows: Axis,
    f0: float | None,
) -> Entry:
    """Grey levels [height, width], row 0 at the top; of axes the edges count."""
    doppler = rows.unit == "Hz"
    return _entry(TITLES.get(name, name), grey[None, ::-1], scale, columns, rows) | {
        "cursor": columns.unit == "s",
        "curves": ("compensated" if "compensated" in name else "plain") if doppler else None,
        "mps": SPEED_OF_LIGHT / (2 * f0) if doppler and f0 else None,
    }


def frames_entry(
    name: str,
    grey: Levels,
    scale: tuple[float, float, str],
    columns: Axis,
    rows: Axis,
    times: Float,
    farthest: float = np.inf,
) -> Entry:
    """Frames of a board [frame, range, column], nearest first, below the peak of all of them."""
    near = rows.values <= farthest
    every = -(-grey[:, near].size // MAX_CELLS)
    rows = Axis(rows.name, rows.unit, rows.values[near])
    return _entry(NAMES.get(name, name), grey[::every, near], scale, columns, rows) | {
        "times": times[::every],
        "mirrored": columns.name == "azimuth",  # left of the radar is left
    }


def _entry(
    name: str, grey: Levels, scale: tuple[float, float, str], columns: Axis, rows: Axis
) -> Entry:
    called = {"s": "time", "Hz": "Doppler", "m/s": "approaching"}
    x, y = (
        [*axis.edges, f"{called.get(axis.unit, axis.name)} ({axis.unit})"]
        for axis in (columns, rows)
    )
    packed = base64.b64encode(np.ascontiguousarray(grey).tobytes()).decode()
    return {"title": name, "levels": packed, "shape": grey.shape, "scale": scale, "x": x, "y": y}


def cloud_entry(points: Float, start: Index, times: Float, board: Board | None) -> Entry:
    """Points of frames; in the axes of the scene where the board's place there is known."""
    xyz = points[:, :3].astype(float)
    if board is not None:
        xyz = xyz @ np.array(board.aim.axes) + board.position
    return {
        "times": times[: len(start) - 1],
        "start": start,
        "points": np.concatenate([xyz, points[:, 3:4]], axis=1).round(3),
    }


def colours(image: ImageConfig) -> list[list[Any]]:
    """The colour map of images, as plotly has it."""
    shares = np.linspace(0, 1, 33)
    return [[share, to_hex(colormaps[image.colour_map](share))] for share in shares.tolist()]


def write_page(scenes: Iterable[Mapping[str, Any]], path: Path) -> None:
    """Write the page.

    What scenes say is text from strangers: it is packed in base64, and the page's script gives it
    to the browser as text alone.
    """
    from plotly.offline import get_plotlyjs

    document = json.dumps(plain(_lists(list(scenes))), allow_nan=False, separators=(",", ":"))
    page = files(__package__).joinpath("scene_page.html").read_text(encoding="utf-8")
    for name, text in (("PLOTLY", get_plotlyjs()), ("SCENES", document)):
        packed = gzip.compress(text.encode(), mtime=0)
        page = page.replace(f"@{name}@", base64.b64encode(packed).decode())
    write_text(path, page)


def _lists(value: Any) -> Any:
    """Arrays as lists."""
    if isinstance(value, Mapping):
        return {key: _lists(inner) for key, inner in value.items()}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_lists(inner) for inner in value]
    return value
