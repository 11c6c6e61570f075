"""frames.png and cloud.gif: frames of a board side by side; its cloud over the skeleton in time."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.image import AxesImage

from radhar_cli.config.image import ImageConfig
from radhar_cli.figures.maps_panel import title
from radhar_cli.figures.page import page, write_figure
from radhar_cli.figures.sides import (
    Advance,
    Film,
    SideView,
    StillView,
    bones,
    colour_bar,
    side_legend,
)
from radhar_cli.figures.stickman import near_limits, wide_limits
from radhar_cli.figures.style import joint_colours
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.frame_maps import FRAME_MAP_KINDS, SPEED, FrameMaps
from radhar_cli.processing.points import Cloud
from radhar_cli.processing.power_map import Axis
from radhar_cli.radar.board import Board
from radhar_cli.scene.single.simulate import Simulation

COLUMNS = 6
SLOWER = 90  # per cent of the points whose speeds the colours tell apart
TINY = float(np.finfo(np.float32).tiny)  # instead of the largest power of black maps


@dataclass(frozen=True)
class BoardFrames:
    """Content of a page of frames of a board, simulated or measured."""

    # {name: FrameMaps}, and `cloud`, `skeletons` where there are some
    products: Mapping[str, Any]
    board: Board  # whose frames
    image: ImageConfig  # dynamic range and colours
    title: str  # one line above
    parents: tuple[int | None, ...] = ()  # of the joints
    farthest: float | None = None  # range that maps show, m; None is all


def of_simulation(simulation: Simulation) -> BoardFrames:
    """Content of the page of a simulated scene with a board."""
    assert simulation.board is not None
    p = simulation.board.upright.to_radar(simulation.truth.positions.transpose(2, 1, 0))
    return BoardFrames(
        simulation.frames,
        simulation.board,
        simulation.config.image,
        title(simulation),
        simulation.motion.parents,
        None if simulation.scene.is_empty else float(np.sqrt((p**2).sum(axis=0)).max()) * 1.2 + 0.5,
    )


def draw_frames(content: BoardFrames, path: Path) -> None:
    """Write frames.png: maps in dB below the peak of all frames, and the cloud from the radar."""
    maps = {
        name: map_.shown for name, map_ in content.products.items() if isinstance(map_, FrameMaps)
    }
    middles = content.board.middles
    has_cloud = content.products.get("cloud") is not None
    chosen = np.unique(np.linspace(0, content.board.frames - 1, COLUMNS).round().astype(int))
    rows = len(maps) + has_cloud
    figure = page(2.2 * max(chosen.size, 3) + 1, 2.4 * rows + 0.6, apart=0.06)
    grid = figure.subplots(rows, chosen.size, squeeze=False)
    for row, (name, frame_maps) in zip(grid, maps.items(), strict=False):
        for axes, frame in zip(row, chosen, strict=True):
            drawn = _draw_map(axes, frame_maps, frame, content)
            axes.set_title("")
        row[0].set_ylabel(f"{FRAME_MAP_KINDS[name].title}\n{label_of(frame_maps.rows)}")
        figure.colorbar(drawn, ax=list(row), pad=0.01, label="dB below the peak")
    if has_cloud:
        near, _, fastest = _limits(content)
        look, centres = (fastest, _colours(content), _still_view(content)), _centres(content)
        sides = [
            SideView(axes, "from the radar", near + centres[frame][:, None], *look)
            for axes, frame in zip(grid[-1], chosen, strict=True)
        ]
        for side, axes, frame in zip(sides, grid[-1], chosen, strict=True):
            side.show(*_moment(content, frame))
            axes.set(
                title="", ylabel="points from the radar\nup (m)" if axes is grid[-1][0] else ""
            )
        colour_bar(figure, sides[0], ax=list(grid[-1]), pad=0.01)
        side_legend(figure, _colours(content), loc="outside lower center", ncols=2)
    for axes, frame in zip(grid[0], chosen, strict=True):
        axes.set_title(f"{middles[frame]:.2f} s")
    figure.suptitle(content.title)
    write_figure(figure, path, 90)


def _draw_map(axes: Axes, maps: FrameMaps, frame: int, content: BoardFrames) -> AxesImage:
    """Draw the map of one frame, in dB below the peak of all."""
    with np.errstate(divide="ignore"):
        level = 10 * np.log10(maps.power[frame] / maps.power.max(initial=TINY))
    look: dict[str, Any] = {"cmap": content.image.colour_map, "origin": "lower", "aspect": "auto"}
    extent = (*maps.columns.edges, *maps.rows.edges)
    lowest = -content.image.dynamic_range_db
    drawn = axes.imshow(level, extent=extent, vmin=lowest, vmax=0, **look)
    if maps.rows.name == "range":
        axes.set_ylim(maps.limits or (0, min(content.farthest or np.inf, maps.rows.edges[1])))
    if maps.columns.name == "azimuth":  # left of the radar is left
        axes.invert_xaxis()
    axes.set_xlabel(label_of(maps.columns))
    if maps.columns.values.size == 1:  # whose cell is as wide as the panel
        axes.set_xticks([])
    if maps.rows.values.size == 1:
        axes.set_yticks([])
    return drawn


def label_of(axis: Axis) -> str:
    """Label of an axis of a frame map; of a single value, the Doppler of one chirp, that it is."""
    if axis.values.size == 1:
        return f"no {axis.name}: one chirp a frame"
    name = "approaching" if axis.name == SPEED.quantity else axis.name
    return f"{name} ({axis.unit})"


def draw_cloud(content: BoardFrames, path: Path, advance: Advance) -> None:
    """Write cloud.gif: every frame's points over its skeleton, at true speed."""
    centres = _centres(content)
    film = Film(content.title, *_limits(content), _colours(content), _still_view(content))

    def show(frame: int) -> None:
        clock = f"t = {content.board.middles[frame]:.2f} s"
        film.show(*_moment(content, frame), clock, centres[frame])

    film.write(path, show, content.board.frames, round(1000 * content.board.period_s), advance)


def _joints(content: BoardFrames) -> Float:
    """Joints [frame, person, joint, 3], m; nobody where none are known, as in captures."""
    skeletons = content.products.get("skeletons")
    return np.empty((content.board.frames, 0, 0, 3)) if skeletons is None else skeletons.positions


def _moment(content: BoardFrames, frame: int) -> tuple[Float, Float, Float]:
    """Points [n, 3], their speeds [n] and bones [bone, 2, 3] of a frame, m and m/s."""
    cloud: Cloud = content.products["cloud"]
    points = cloud.points[cloud.start[frame] : cloud.start[frame + 1]]
    ends = [bones(body, content.parents) for body in _joints(content)[frame]]
    return points[:, :3], points[:, 3], np.concatenate([np.empty((0, 2, 3)), *ends])


def _centres(content: BoardFrames) -> Float:
    """Place [frame, 3] of a person who is alone, at no height, from which near views count, m."""
    joints = _joints(content)
    if joints.shape[1] != 1 or not np.isfinite(joints).all():
        return np.zeros((content.board.frames, 3))
    centres: Float = joints[:, 0].mean(axis=1) * (1, 1, 0)
    return centres


def _colours(content: BoardFrames) -> list[str]:
    """Colours of the bones of each body; none where its joints are not known."""
    return joint_colours(JOINTS) if len(content.parents) == len(JOINTS) else []


def _still_view(content: BoardFrames) -> StillView:
    """Radar at the origin, and the floor below it where it does not look up or down."""
    board = content.board
    return StillView(floor=None if board.tilt else -board.position[2])


def _limits(content: BoardFrames) -> tuple[Float, Float, float]:
    """Limits [3, 2] of near views and of the one from above, m, and the highest speed, m/s."""
    points, joints = content.products["cloud"].points, _joints(content)
    moved = (joints - _centres(content)[:, None, None]).reshape(-1, 3)
    places: Float = joints.reshape(-1, 3)
    is_known = np.isfinite(places).all(axis=1)
    places, near = places[is_known], moved[is_known]
    if not len(places):
        places = near = points[:, :3] if len(points) else np.zeros((1, 3))
    return near_limits(near), wide_limits(places, StillView()), speed_of_colours(points[:, 3])


def speed_of_colours(speeds: Float) -> float:
    """Speed at the ends of the colours of points, m/s: nine points in ten do not exceed it.

    A few fast points, as of noise, which may be as fast as the radar sees, leave it as it is.

    Args:
        speeds: Approaching speeds of the points [n], m/s.
    """
    return max(float(np.percentile(np.abs(speeds), SLOWER)), 0.1) if len(speeds) else 1.0
