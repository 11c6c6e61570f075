"""frames.png and cloud.gif: frames of a board side by side; its cloud over the skeleton in time."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from radhar_cli.arrays import Float
from radhar_cli.figures.maps_panel import title
from radhar_cli.figures.page import page, write_figure
from radhar_cli.figures.stickman import write_animation
from radhar_cli.pipeline.board_products import Skeletons
from radhar_cli.processing.frame_maps import FrameMaps
from radhar_cli.processing.points import Cloud
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


def draw_frames(simulation: Simulation, path: Path) -> None:
    """Write frames.png: maps in dB below the peak of all frames, and the cloud from the radar."""
    maps = {name: one for name, one in simulation.frames.items() if isinstance(one, FrameMaps)}
    cloud, skeletons = simulation.frames.get("cloud"), simulation.frames.get("skeletons")
    assert simulation.board is not None
    shown = np.linspace(0, simulation.board.frames - 1, COLUMNS).round().astype(int)
    rows = len(maps) + (cloud is not None)
    figure = page(2.6 * COLUMNS + 1, 2.7 * rows + 0.6, apart=0.06)
    grid = figure.subplots(rows, COLUMNS, squeeze=False)
    deepest = simulation.config.image.dynamic_range_db
    for row, (name, one) in zip(grid, maps.items(), strict=False):
        drawn = None
        farthest = _farthest(simulation)
        for axes, frame in zip(row, shown, strict=True):
            with np.errstate(divide="ignore"):
                level = 10 * np.log10(one.power[frame] / one.power.max())
            drawn = axes.imshow(
                level,
                extent=(*one.columns.edges, *one.rows.edges),
                origin="lower",
                aspect="auto",
                cmap=simulation.config.image.colour_map,
                vmin=-deepest,
                vmax=0,
            )
            axes.set_ylim(0, min(farthest, one.rows.edges[1]))
            if name == "range_azimuth":
                axes.invert_xaxis()
            axes.set_xlabel(f"{one.columns.name} ({one.columns.unit})", fontsize=7)
            axes.tick_params(labelsize=6)
            axes.set_title(f"{NAMES[name]}, {one.times[frame]:.2f} s", fontsize=8)
        row[0].set_ylabel("range (m)", fontsize=7)
        assert drawn is not None
        figure.colorbar(drawn, ax=list(row), pad=0.01).ax.tick_params(labelsize=6)
    if cloud is not None and skeletons is not None:
        limits = _limits(cloud, skeletons)
        for axes, frame in zip(grid[-1], shown, strict=True):
            view = _View(axes, "from the radar", limits, simulation.motion.parents)
            view.show(_of_frame(cloud, frame), skeletons.positions[frame])
            axes.set_title(f"points, {simulation.board.middles[frame]:.2f} s", fontsize=8)
        figure.colorbar(view.points, ax=list(grid[-1]), pad=0.01, label="approaching (m/s)")
    figure.suptitle(title(simulation), fontsize=10)
    write_figure(figure, path, 90)


def draw_cloud(simulation: Simulation, path: Path, advance: Callable[[int], object]) -> None:
    """Write cloud.gif: every frame's points over its skeleton, from three sides, at true speed."""
    cloud: Cloud = simulation.frames["cloud"]
    skeletons: Skeletons = simulation.frames["skeletons"]
    assert simulation.board is not None
    figure = Figure(figsize=(12, 4.6), dpi=80)
    figure.suptitle(title(simulation), fontsize=9)
    limits, views = _limits(cloud, skeletons), list[_View]()
    for number, name in enumerate(VIEWS):
        axes = figure.add_axes((0.05 + 0.31 * number, 0.12, 0.26, 0.74))
        views.append(_View(axes, name, limits, simulation.motion.parents))
    clock = figure.text(0.5, 0.02, "", ha="center", fontsize=9)
    bar = figure.colorbar(views[0].points, cax=figure.add_axes((0.95, 0.15, 0.01, 0.66)))
    bar.set_label("approaching (m/s)", fontsize=8)

    def show(frame: int) -> None:
        for view in views:
            view.show(_of_frame(cloud, frame), skeletons.positions[frame])
        clock.set_text(f"t = {simulation.board.middles[frame]:.2f} s" if simulation.board else "")

    moving: list[Any] = [clock, *(artist for view in views for artist in view.artists)]
    period = round(1000 * simulation.board.period)
    write_animation(figure, moving, show, simulation.board.frames, period, path, advance)


class _View:
    """Points and skeletons from one side."""

    def __init__(
        self, axes: Axes, name: str, limits: Float, parents: tuple[int | None, ...]
    ) -> None:
        self.across, self.sign, self.up = VIEWS[name]
        self.pairs = [(parent, one) for one, parent in enumerate(parents) if parent is not None]
        (self.bones,) = axes.plot([], [], color="0.6", linewidth=1.5)
        fastest = max(limits[3, 1], 0.1)
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


def _limits(cloud: Cloud, skeletons: Skeletons) -> Float:
    """Lowest and highest (ahead, left, up, speed) [4, 2] of skeletons and most points."""
    joints = skeletons.positions.reshape(-1, 3)
    low, high = np.nanmin(joints, axis=0) - 0.4, np.nanmax(joints, axis=0) + 0.4
    speed = np.percentile(np.abs(cloud.points[:, 3]), 99) if len(cloud.points) else 1.0
    return np.array([*zip(low, high, strict=True), (-speed, speed)], float)


def _farthest(simulation: Simulation) -> float:
    """Range that maps show, m."""
    assert simulation.board is not None
    p = simulation.board.aim.to_radar(simulation.truth.positions.transpose(2, 1, 0))
    return float(np.sqrt((p**2).sum(axis=0)).max()) * 1.2 + 0.5
