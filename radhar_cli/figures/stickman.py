"""stickman.gif: the thirteen joints in 3-D, beside a Doppler-time map with a moving cursor."""

from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from radhar_cli.arrays import Float
from radhar_cli.figures.maps_panel import draw_map, title
from radhar_cli.simulation.simulate import Simulation
from radhar_cli.simulation.truth import WHOLE

FRAMES_PER_SECOND = 20
SHOWN_BESIDE = ("stft", "fsst", "stft_compensated", "rtm")
WIDEST = 1.5


def frame_count(simulation: Simulation) -> int:
    """Frames of the animation at true speed."""
    return max(2, round(simulation.waveform.duration * FRAMES_PER_SECOND))


def draw_stickman(simulation: Simulation, path: Path, advance: Callable[[int], object]) -> None:
    """Write the animation.

    What never changes is drawn once; a frame draws the body, the clock and the cursor over it.

    Args:
        simulation: the scene.
        path: ends in .gif.
        advance: called with 1 after every frame.
    """
    figure = Figure(figsize=(11, 5), dpi=80)
    canvas: Any = FigureCanvasAgg(figure)
    figure.suptitle(title(simulation), fontsize=9)
    stage = _Stage(figure, simulation)
    cursor = _cursor(figure, simulation)
    moving: list[Any] = [*stage.artists, *cursor]
    for artist in moving:
        artist.set_animated(True)
    canvas.draw()
    background = canvas.copy_from_bbox(figure.bbox)
    frames: list[Image.Image] = []
    palette: Image.Image | None = None
    for frame in range(frame_count(simulation)):
        t = frame / FRAMES_PER_SECOND
        canvas.restore_region(background)
        stage.show(t)
        for line in cursor:
            line.set_xdata([t, t])
        for artist in moving:
            figure.draw_artist(artist)
        picture = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
        palette = palette or picture.quantize(256, Image.Quantize.MAXCOVERAGE)
        frames.append(picture.quantize(palette=palette, dither=Image.Dither.NONE))
        advance(1)
    frames[0].save(
        path, save_all=True, append_images=frames[1:], duration=1000 // FRAMES_PER_SECOND, loop=0
    )


def _cursor(figure: Figure, simulation: Simulation) -> list[Line2D]:
    """Draw a map beside the body; return its line at the current time."""
    shown = [name for name in SHOWN_BESIDE if name in simulation.maps] or list(simulation.maps)
    if not shown:
        return []
    axes = figure.add_axes((0.69, 0.12, 0.255, 0.76))
    draw_map(axes, shown[0], simulation, overlay=False)
    return [axes.axvline(0, color="white", linewidth=1)]


class _Stage:
    """The room: floor grid, antennas, wall, and the body at one time."""

    def __init__(self, figure: Figure, simulation: Simulation) -> None:
        self.truth, self.parents = simulation.truth, simulation.motion.parents
        new_axes: Any = figure.add_axes
        self.axes = new_axes((-0.02, 0.0, 0.53, 0.94), projection="3d")
        antennas, wall = simulation.antennas, simulation.wall
        for position in (antennas.tx, antennas.rx):
            self.axes.scatter(*position, marker="^", color="black", s=30)
        middle = np.mean([antennas.tx, antennas.rx], axis=0)
        self.axes.text(*middle, "TX, RX  ", fontsize=7, ha="right")
        if wall is not None:
            self._draw_wall(wall.bounds)
        points = [self.truth.positions.reshape(-1, 3), np.array([antennas.tx, antennas.rx])]
        self._frame(np.concatenate(points), wall is not None)
        self.links: list[Any] = [
            self.axes.plot([0], [0], [0], color="0.35", linewidth=2)[0]
            for parent in self.parents
            if parent is not None
        ]
        self.joints: Any = self.axes.scatter(
            *self.truth.positions[0].T,
            c=simulation.motion.cross_sections(self.truth.time[:1])[:, 0],
            cmap="plasma",
            s=32,
            depthshade=False,
            edgecolors="black",
            linewidths=0.4,
        )
        bar = figure.colorbar(self.joints, cax=figure.add_axes((0.575, 0.25, 0.01, 0.5)))
        bar.set_label("RCS (m$^2$)", fontsize=8)
        bar.ax.tick_params(labelsize=7)
        self.clock = self.axes.text2D(0.5, 0.97, "", transform=self.axes.transAxes, ha="center")

    @property
    def artists(self) -> list[Any]:
        """What changes from frame to frame."""
        return [*self.links, self.joints, self.clock]

    def _draw_wall(self, bounds: tuple[tuple[float, float], ...]) -> None:
        x, y, z = bounds
        y = (max(y[0], -WIDEST), min(y[1], WIDEST))  # a wide wall would make the body small
        corners = list(product(x, y, z))
        for a, b in product(corners, corners):
            if a < b and sum(p != q for p, q in zip(a, b, strict=True)) == 1:
                self.axes.plot(*zip(a, b, strict=True), color="firebrick", linewidth=0.8)

    def _frame(self, points: Float, walled: bool) -> None:
        low, high = points.min(axis=0), points.max(axis=0)
        half = max(WIDEST if walled else 0.8, float(np.abs(points[:, 1]).max()) + 0.2)
        low = np.array([min(low[0], 0), -half, min(low[2], 0)])
        high = np.array([high[0] + 0.2, half, max(high[2], 2)])
        limits = (self.axes.set_xlim, self.axes.set_ylim, self.axes.set_zlim)
        for set_limits, a, b in zip(limits, low, high, strict=True):
            set_limits(a, b)
        self.axes.set_box_aspect(high - low, zoom=1.15)
        grid: dict[str, Any] = {"color": "0.75", "linewidth": 0.5}
        for x in np.arange(np.ceil(low[0]), high[0], 0.5):
            self.axes.plot([x, x], [low[1], high[1]], [0, 0], **grid)
        for y in np.arange(np.ceil(low[1] * 2) / 2, high[1], 0.5):
            self.axes.plot([low[0], high[0]], [y, y], [0, 0], **grid)
        self.axes.set_yticks(np.arange(np.ceil(low[1]), high[1]))
        self.axes.set_zticks(np.arange(np.ceil(low[2]), high[2] + 0.1))
        self.axes.set_xlabel("range x (m)", fontsize=8)
        self.axes.set_ylabel("y (m)", fontsize=8)
        self.axes.set_zlabel("z (m)", fontsize=8)
        self.axes.tick_params(labelsize=7, pad=0)
        self.axes.view_init(elev=12, azim=-65)

    def show(self, t: float) -> None:
        """Put the body where it is at time t."""
        pulse = int(np.searchsorted(self.truth.time, t).clip(max=self.truth.time.size - 1))
        p = self.truth.positions[pulse]
        pairs = [(parent, joint) for joint, parent in enumerate(self.parents) if parent is not None]
        for line, (parent, joint) in zip(self.links, pairs, strict=True):
            line.set_data_3d(*np.stack([p[parent], p[joint]], axis=1))
        self.joints._offsets3d = tuple(p.T)  # Matplotlib has no public setter for 3-D offsets
        self.joints.do_3d_projection()
        under_way = self.truth.phases[self.truth.phase_label[pulse]]
        what = "" if under_way == WHOLE else f"   {under_way}"
        self.clock.set_text(f"t = {t:.2f} s{what}")
