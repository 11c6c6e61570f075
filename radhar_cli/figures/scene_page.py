"""view.html: skeletons, point clouds and maps of scenes at one instant; it needs no other file."""

import base64
import gzip
from collections.abc import Iterable, Iterator, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any, TypeAlias

from radhar_cli.config.image import ImageConfig
from radhar_cli.figures.maps_panel import title as title_of
from radhar_cli.figures.page_plots import (
    MAX_SIDE,
    LevelScale,
    MapLevels,
    Plot,
    PointFrames,
    plot_map,
    plot_space,
)
from radhar_cli.figures.scene_view import SceneView, view_scene
from radhar_cli.files.replacing import write_text
from radhar_cli.processing.frame_maps import FrameMaps
from radhar_cli.processing.image import levels, reduced_map, signed_levels
from radhar_cli.processing.power_map import Axis, PowerMap
from radhar_cli.scene.scene import scene_numbers
from radhar_cli.scene.single.simulate import Simulation

Entry: TypeAlias = dict[str, Any]  # what JSON holds


def of_simulation(simulation: Simulation) -> Entry:
    """Make the entry of a simulated scene."""
    motions = (simulation.motion, *(other.motion for other in simulation.others))
    view, board, cloud = view_scene(simulation.scene, motions), simulation.board, None
    if board is not None and "cloud" in simulation.frames:
        points = simulation.frames["cloud"]
        cloud = PointFrames(board.middles, points.start, points.points)
    maps = (plot_map(view, map_levels) for map_levels in _maps_of(simulation, view))
    plots = [plot_space(view, cloud, board), *maps]
    numbers = scene_numbers(simulation.scene)
    return make_entry(view, plots, title_of(simulation), simulation.warnings, numbers)


def _maps_of(simulation: Simulation, view: SceneView) -> Iterator[MapLevels]:
    """Yield the maps of a scene, then those of a board's frames."""
    image = simulation.config.image
    for name, power_map in simulation.maps.items():
        yield _map_levels(name, power_map, image, view.farthest)
    for name, maps in simulation.frames.items():
        if isinstance(maps, FrameMaps):
            maps = maps.shown
            grey, scale = (
                levels(maps.power, image.dynamic_range_db),
                LevelScale.of(image, "decibel"),
            )
            yield MapLevels(name, grey, scale, maps.columns, maps.rows, maps.times)


def _map_levels(name: str, power_map: PowerMap, image: ImageConfig, farthest: float) -> MapLevels:
    """Reduce a map to levels of at most MAX_SIDE cells a side, up to the farthest range (m)."""
    rows = power_map.rows
    is_near = (rows.values <= farthest) | (rows.unit != "m")
    cells = power_map.shown[is_near]
    size = (min(MAX_SIDE, len(cells)), min(MAX_SIDE, cells.shape[1]))
    if power_map.real is not None:
        grey, kind = signed_levels(cells, size, image.clipped), "signed"
    else:
        reduced = reduced_map(cells, size, entropy=False).cells
        grey, kind = levels(reduced, image.dynamic_range_db), "decibel"
    near_rows = Axis(rows.name, rows.unit, rows.values[is_near])
    scale = LevelScale.of(image, kind)
    return MapLevels(name, grey[None, ::-1], scale, power_map.columns, near_rows)


def make_entry(
    view: SceneView, plots: list[Plot], title: str, notes: list[str], numbers: Mapping[str, float]
) -> Entry:
    """Make the entry of a scene.

    Args:
        title: line above.
        notes: remarks, a line each.
        numbers: numbers of the scene by config key.
    """
    rounded = {key: f"{value:.6g}" for key, value in numbers.items()}
    return {"title": title, "notes": notes, "numbers": rounded, "time": view.time, "plots": plots}


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
