"""frames.png and cloud.gif: frames of a board side by side; its cloud over the skeleton in time."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from radhar_cli.arrays import Float
from radhar_cli.config.schema import ImageConfig
from radhar_cli.figures.maps_panel import title
from radhar_cli.figures.page import page, write_figure
from radhar_cli.figures.stickman import write_animation
from radhar_cli.processing.frame_maps import FrameMaps
from radhar_cli.processing.points import Cloud
from radhar_cli.radar.board import Board
from radhar_cli.simulation.simulate import Simulation

COLUMNS = 6
NAMES = {
    "range_doppler": "range-Doppler",
    "range_azimuth": "range-azimuth",
    "range_elevation": "range-elevation",
}
# {view: (horizontal axis and its sign, vertical axis)} of points (ahead, left, up)
VIEWS = {"from the radar": (1, -1.0, 2), "from the side": (0, 1.0, 2), "from above": (1, -1.0, 0)}
LABELS = {0: "ahead (m)", 1: "right (m)", 2: "up (m)"}


@dataclass(frozen=True)
class Frames:
    """What a page of frames shows, simulated or measured."""

    made: Mapping[str, Any]  # {name: FrameMaps}, and `cloud`, `skeletons` where there are some
    board: Board  # whose frames
    image: ImageConfig  # dynamic range and colours
    title: str  # one line above
    parents: tuple[int | None, ...] = ()  # of the joints
    farthest: float | None = None  # range that maps show, m; None is all


def of_simulation(simulation: Simulation) -> Frames:
    """The frames of a scene."""
    assert simulation.board is not None
    p = simulation.board.aim.to_radar(simulation.truth.positions.transpose(2, 1, 0))
    return Frames(
        simulation.frames,
        simulation.board,
        simulation.config.image,
        title(simulation),
        simulation.motion.parents,
        float(np.sqrt((p**2).sum(axis=0)).max()) * 1.2 + 0.5,
    )


def draw_frames(shown: Frames, path: Path) -> None:
    """Write frames.png: maps in dB below the peak of all frames, and the cloud from the radar."""
    maps = {name: one for name, one in shown.made.items() if isinstance(one, FrameMaps)}
    cloud, middles = shown.made.get("cloud"), shown.board.middles
    chosen = np.linspace(0, shown.board.frames - 1, COLUMNS).round().astype(int).tolist()
    rows = len(maps) + (cloud is not None)
    figure = page(2.6 * COLUMNS + 1, 2.7 * rows + 0.6, apart=0.06)
    grid = figure.subplots(rows, COLUMNS, squeeze=False)
    for row, (name, one) in zip(grid, maps.items(), strict=False):
        drawn = [
            _draw_map(axes, one, frame, shown) for axes, frame in zip(row, chosen, strict=True)
        ]
        for axes, frame in zip(row, chosen, strict=True):
            axes.set_title(f"{NAMES[name]}, {middles[frame]:.2f} s", fontsize=8)
        row[0].set_ylabel("range (m)", fontsize=7)
        figure.colorbar(drawn[0], ax=list(row), pad=0.01, label="dB").ax.tick_params(labelsize=6)
    if cloud is not None:
        skeletons, limits = _joints(shown), _limits(shown)
        views = [_View(axes, "from the radar", limits, shown.parents) for axes in grid[-1]]
        for view, axes, frame in zip(views, grid[-1], chosen, strict=True):
            view.show(_of_frame(cloud, frame), skeletons[frame])
            axes.set_title(f"points, {middles[frame]:.2f} s", fontsize=8)
        bar = figure.colorbar(views[0].points, ax=list(grid[-1]), pad=0.01)
        bar.set_label("approaching (m/s)", fontsize=7)
        bar.ax.tick_params(labelsize=6)
    figure.suptitle(shown.title, fontsize=10)
    write_figure(figure, path, 90)


def _draw_map(axes: Axes, maps: FrameMaps, frame: int, shown: Frames) -> AxesImage:
    with np.errstate(divide="ignore"):
        level = 10 * np.log10(maps.power[frame] / maps.power.max())
    drawn = axes.imshow(
        level,
        extent=(*maps.columns.edges, *maps.rows.edges),
        origin="lower",
        aspect="auto",
        cmap=shown.image.colour_map,
        vmin=-shown.image.dynamic_range_db,
        vmax=0,
    )
    axes.set_ylim(0, min(shown.farthest or np.inf, maps.rows.edges[1]))
    if maps.columns.name == "azimuth":  # left of the radar is left
        axes.invert_xaxis()
    axes.set_xlabel(f"{maps.columns.name} ({maps.columns.unit})", fontsize=7)
    axes.tick_params(labelsize=6)
    return drawn


def draw_cloud(shown: Frames, path: Path, advance: Callable[[int], object]) -> None:
    """Write cloud.gif: every frame's points over its skeleton, from three sides, at true speed."""
    cloud: Cloud = shown.made["cloud"]
    figure = Figure(figsize=(12, 4.6), dpi=80)
    figure.suptitle(shown.title, fontsize=9)
    skeletons, limits, views = _joints(shown), _limits(shown), list[_View]()
    for number, name in enumerate(VIEWS):
        axes = figure.add_axes((0.05 + 0.31 * number, 0.12, 0.26, 0.74))
        views.append(_View(axes, name, limits, shown.parents))
    clock = figure.text(0.5, 0.02, "", ha="center", fontsize=9)
    bar = figure.colorbar(views[0].points, cax=figure.add_axes((0.95, 0.15, 0.01, 0.66)))
    bar.set_label("approaching (m/s)", fontsize=8)

    def show(frame: int) -> None:
        for view in views:
            view.show(_of_frame(cloud, frame), skeletons[frame])
        clock.set_text(f"t = {shown.board.middles[frame]:.2f} s")

    moving: list[Any] = [clock, *(artist for view in views for artist in view.artists)]
    period = round(1000 * shown.board.period)
    write_animation(figure, moving, show, shown.board.frames, period, path, advance)


def _joints(shown: Frames) -> Float:
    """Joints [frame, person, joint, 3]; of captures there are none."""
    skeletons = shown.made.get("skeletons")
    return np.empty((shown.board.frames, 0, 0, 3)) if skeletons is None else skeletons.positions


class _View:
    """Points and skeletons from one side."""

    def __init__(
        self, axes: Axes, name: str, limits: Float, parents: tuple[int | None, ...]
    ) -> None:
        self.across, self.sign, self.up = VIEWS[name]
        self.pairs = [(parent, one) for one, parent in enumerate(parents) if parent is not None]
        (self.bones,) = axes.plot([], [], color="0.6", linewidth=1.5)
        fastest = limits[3, 1]
        self.points = axes.scatter(
            [],
            [],
            c=[],
            s=14,
            cmap="coolwarm",
            vmin=-fastest,
            vmax=fastest,
            edgecolors="0.3",
            linewidths=0.3,
        )
        self.points.set_zorder(3)
        self.artists: list[Any] = [self.bones, self.points]
        axes.set(xlim=sorted(self.sign * limits[self.across]), ylim=limits[self.up], aspect="equal")
        axes.set_title(name, fontsize=9)
        axes.set_xlabel(LABELS[self.across], fontsize=7)
        axes.set_ylabel(LABELS[self.up], fontsize=7)
        axes.tick_params(labelsize=6)

    def show(self, points: Float, skeletons: Float) -> None:
        """Points [n, 8] and joints [person, joint, 3]."""
        ends = [body[list(pair)] for body in skeletons for pair in self.pairs]
        gap = np.full((1, 3), np.nan)
        lines = np.concatenate([part for end in ends for part in (end, gap)] or [gap])
        self.bones.set_data(self.sign * lines[:, self.across], lines[:, self.up])
        self.points.set_offsets(
            np.stack([self.sign * points[:, self.across], points[:, self.up]], axis=1)
        )
        self.points.set_array(points[:, 3])


def _of_frame(cloud: Cloud, frame: int) -> Float:
    return cloud.points[cloud.start[frame] : cloud.start[frame + 1]]


def _limits(shown: Frames) -> Float:
    """Lowest and highest (ahead, left, up, speed) [4, 2] of skeletons and most points."""
    points, joints = shown.made["cloud"].points, _joints(shown).reshape(-1, 3)
    seen = joints if len(joints) else points[:, :3]
    low, high = np.array([(-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)])
    if len(seen):
        low, high = np.nanpercentile(seen, [1, 99], axis=0) + np.array([[-0.4], [0.4]])
    speed = max(float(np.percentile(np.abs(points[:, 3]), 99)), 0.1) if len(points) else 1.0
    return np.array([*zip(low, high, strict=True), (-speed, speed)], float)
