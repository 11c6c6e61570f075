"""stickman.gif: the thirteen joints in 3-D, beside a Doppler-time map with a moving cursor."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from radhar_cli.arrays import Float
from radhar_cli.figures.maps_panel import draw_map, of_simulation, title
from radhar_cli.replacing import replacing
from radhar_cli.simulation.simulate import Simulation
from radhar_cli.simulation.truth import WHOLE

FRAMES_PER_SECOND = 20
SHOWN_BESIDE = ("stft", "fsst", "stft_compensated", "rtm")


def frame_count(simulation: Simulation) -> int:
    """Frames of the animation at true speed."""
    return max(2, round(simulation.waveform.duration * FRAMES_PER_SECOND))


def draw_stickman(simulation: Simulation, path: Path, advance: Callable[[int], object]) -> None:
    """Write the animation.

    What never changes is drawn once; a frame draws the body, the clock and the cursor over it.

    Args:
        path: ends in .gif.
        advance: called with 1 after every frame.
    """
    figure = Figure(figsize=(13, 4.6), dpi=80)
    figure.suptitle(title(simulation), fontsize=9)
    stage = _Stage(figure, simulation)
    cursor = _cursor(figure, simulation)
    moving: list[Any] = [*stage.artists, *cursor]

    def show(frame: int) -> None:
        t = frame / FRAMES_PER_SECOND
        stage.show(t)
        for line in cursor:
            line.set_xdata([t, t])

    write_animation(
        figure, moving, show, frame_count(simulation), 1000 // FRAMES_PER_SECOND, path, advance
    )


def write_animation(
    figure: Figure,
    moving: list[Any],
    show: Callable[[int], None],
    count: int,
    frame_ms: int,
    path: Path,
    advance: Callable[[int], object],
) -> None:
    """Write a GIF whose frames differ in some artists alone.

    Args:
        figure: with all that is drawn.
        moving: the artists that change.
        show: makes them show a frame.
        count: of frames.
        frame_ms: duration of each.
        path: ends in .gif.
        advance: called with 1 after every frame.
    """
    canvas: Any = FigureCanvasAgg(figure)
    for artist in moving:
        artist.set_animated(True)
    canvas.draw()
    background = canvas.copy_from_bbox(figure.bbox)
    frames: list[Image.Image] = []
    palette: Image.Image | None = None
    for frame in range(count):
        canvas.restore_region(background)
        show(frame)
        for artist in moving:
            figure.draw_artist(artist)
        picture = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
        palette = palette or picture.quantize(256, Image.Quantize.MAXCOVERAGE)
        frames.append(picture.quantize(palette=palette, dither=Image.Dither.NONE))
        advance(1)
    with replacing(path) as unfinished:
        frames[0].save(
            unfinished,
            format="GIF",
            save_all=True,
            append_images=frames[1:],
            duration=frame_ms,
            loop=0,
        )


def _cursor(figure: Figure, simulation: Simulation) -> list[Line2D]:
    """Draw a map beside the body; return its line at the current time."""
    shown = [name for name in SHOWN_BESIDE if name in simulation.maps] or list(simulation.maps)
    if not shown:
        return []
    axes = figure.add_axes((0.73, 0.14, 0.22, 0.7))
    draw_map(axes, shown[0], of_simulation(simulation, overlay=False))
    return [axes.axvline(0, color="white", linewidth=1)]


class _Stage:
    """The body from the side and as the radar sees it, followed; and its way through the room."""

    def __init__(self, figure: Figure, simulation: Simulation) -> None:
        self.truth, self.parents = simulation.truth, simulation.motion.parents
        p = self.truth.positions
        self.middle = p.mean(axis=1)
        self.others = [
            (one.truth.positions, _pairs(one.motion.parents)) for one in simulation.others
        ]
        ways = [self.middle, *(positions.mean(axis=1) for positions, _ in self.others)]
        self.ways = np.stack(ways)  # [person, M, 3]
        radar = np.array([simulation.antennas.tx, simulation.antennas.rx])
        room: dict[str, Any] = {"antennas": radar, "wall": None}
        if simulation.wall is not None:  # its outline from the side, closed, and its extent along y
            (x0, x1), (y0, y1), (z0, z1) = simulation.wall.bounds
            corners = [[x0, y0, z0], [x1, y1, z0], [x1, y1, z1], [x0, y0, z1], [x0, y0, z0]]
            room["wall"] = np.array(corners)
        half = max(1.2, float(np.abs(p - self.middle[:, None])[..., :2].max()) + 0.15)
        top, low = max(2.1, float(p[..., 2].max()) + 0.15), min(-0.1, float(p[..., 2].min()))
        views = {"from the side": (0, 1.0, 0.02), "from the radar": (1, -1.0, 0.265)}
        self.views = []
        for name, (axis, sign, left) in views.items():
            axes = figure.add_axes((left, 0.1, 0.235, 0.76))
            axes.set(xlim=(-half, half), ylim=(low, top), aspect="equal", anchor="S")
            axes.set_title(name, fontsize=9)
            axes.set_axis_off()
            colours = simulation.motion.cross_sections(self.truth.time[:1])[:, 0]
            self.views.append(_View(axes, axis, sign, half, self.parents, colours, room))
        self.clock = figure.text(0.265, 0.05, "", ha="center", fontsize=9, animated=True)
        bar = figure.colorbar(self.views[0].joints, cax=figure.add_axes((0.625, 0.15, 0.008, 0.3)))
        bar.set_label("RCS (m²)", fontsize=7)
        bar.ax.tick_params(labelsize=6)
        self.here = _plan(figure, self.ways, room)

    @property
    def artists(self) -> list[Any]:
        """What changes from frame to frame."""
        return [one for view in self.views for one in view.artists] + [self.clock, self.here]

    def show(self, t: float) -> None:
        """Put the body where it is at time t."""
        pulse = int(np.searchsorted(self.truth.time, t).clip(max=self.truth.time.size - 1))
        hips = None if self.truth.hip_joints is None else self.truth.hip_joints[pulse]
        for view in self.views:
            view.show(self.truth.positions[pulse], hips, self.middle[pulse])
            view.show_others([(p[pulse], pairs) for p, pairs in self.others], self.middle[pulse])
        self.here.set_data(-self.ways[:, pulse, 1], self.ways[:, pulse, 0])
        under_way = self.truth.phases[self.truth.phase_label[pulse]]
        what = "" if under_way == WHOLE else f"   {under_way}"
        self.clock.set_text(f"t = {t:.2f} s{what}")


class _View:
    """The body in a plane of the room: range and height, or cross-range and height."""

    def __init__(
        self,
        axes: Axes,
        axis: int,
        sign: float,
        half: float,
        parents: tuple[int | None, ...],
        colours: Float,
        room: dict[str, Any],
    ) -> None:
        self.axis, self.sign, self.half = axis, sign, half
        self.pairs = _pairs(parents)
        self.antennas, self.wall = room["antennas"], room["wall"]
        axes.axhline(0, color="0.6", linewidth=1)
        (self.floor,) = axes.plot([], [], color="0.6", linewidth=1)
        (self.radar,) = axes.plot([], [], "^", color="black", markersize=5)
        (self.slab,) = axes.plot([], [], color="firebrick", linewidth=1)
        (self.links,) = axes.plot([], [], color="0.35", linewidth=2)
        self.joints = axes.scatter(
            0 * colours, colours, c=colours, cmap="plasma", s=30, edgecolors="black", linewidths=0.4
        )
        self.joints.set_zorder(3)
        (self.crowd,) = axes.plot([], [], color="tab:blue", linewidth=1.5, alpha=0.6)
        lines = [self.floor, self.radar, self.slab, self.crowd, self.links]
        self.artists: list[Any] = [*lines, self.joints]

    def _across(self, points: Float, middle: Float) -> Float:
        seen: Float = self.sign * (points[..., self.axis] - middle[self.axis])
        return seen

    def show_others(self, people: list[tuple[Float, list[tuple[int, int]]]], middle: Float) -> None:
        """Joints [I, 3] and pairs of them of everybody else who is near `middle` [3]."""
        lines = [
            np.stack([p[a], p[b], np.full(3, np.nan)]) for p, pairs in people for a, b in pairs
        ]
        if lines:
            drawn = np.concatenate(lines)
            x = self._across(drawn, middle)
            self.crowd.set_data(np.where(np.abs(x) <= self.half, x, np.nan), drawn[:, 2])

    def show(self, p: Float, hips: Float | None, middle: Float) -> None:
        """Joints [I, 3] and hip joints [2, 3], where there are, seen from `middle` [3]."""
        across = partial(self._across, middle=middle)
        starts = np.array([p[parent] for parent, _ in self.pairs])
        ends = np.array([p[one] for _, one in self.pairs])
        if hips is not None:  # thighs hang on the hip joints, which the hip point carries
            for hip, knee in zip(hips, (9, 11), strict=True):
                starts[[one for _, one in self.pairs].index(knee)] = hip
        gap = np.full_like(starts, np.nan)
        lines = np.stack([starts, ends, gap], axis=1).reshape(-1, 3)
        self.links.set_data(across(lines), lines[:, 2])
        self.joints.set_offsets(np.stack([across(p), p[:, 2]], axis=1))
        marks = 0.5 * np.arange(np.ceil(-self.half * 2), self.half * 2 + 1)
        marks = np.repeat(marks - self.sign * middle[self.axis] % 0.5, 3)
        self.floor.set_data(marks, np.tile([0.0, -0.05, np.nan], marks.size // 3))
        self.radar.set_data(across(self.antennas), self.antennas[:, 2])
        if self.wall is not None and self.axis == 0:
            self.slab.set_data(across(self.wall), self.wall[:, 2])


def _pairs(parents: tuple[int | None, ...]) -> list[tuple[int, int]]:
    """(parent, scatterer) of every bone."""
    return [(parent, one) for one, parent in enumerate(parents) if parent is not None]


def _plan(figure: Figure, ways: Float, room: dict[str, Any]) -> Line2D:
    """Draw the room and the ways [person, M, 3] from above, range upwards.

    Returns:
        The marks of where everybody is.
    """
    axes = figure.add_axes((0.535, 0.15, 0.08, 0.66))
    radar, wall = room["antennas"], room["wall"]
    axes.plot(-radar[:, 1], radar[:, 0], "^", color="black", markersize=4)
    for way in ways:
        axes.plot(-way[:, 1], way[:, 0], color="0.6", linewidth=1)
    across = np.abs(np.append(ways[..., 1], radar[:, 1])).max() + 0.4
    if wall is not None:
        (x0, y0, _), (x1, y1, _) = wall[0], wall[1]
        y0, y1 = max(y0, -across), min(y1, across)
        axes.fill([-y0, -y1, -y1, -y0], [x0, x0, x1, x1], color="firebrick", linewidth=0)
    (here,) = axes.plot([], [], "o", color="tab:blue", markersize=6)
    ends = np.append(ways[..., 0], radar[:, 0])
    axes.set(xlim=(-across, across), ylim=(min(0.0, ends.min() - 0.2), ends.max() + 0.3))
    axes.set_title("from above", fontsize=9)
    axes.set_ylabel("range x (m)", fontsize=8, labelpad=1)
    axes.set_xlabel("-y (m)", fontsize=8)
    axes.tick_params(labelsize=7, pad=1)
    return here
