"""Points over bones, seen from several sides, still or as a film."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image, ImageChops
from PIL.GifImagePlugin import getdata, getheader

from radhar_cli.figures.style import LEFT, RADAR, RIGHT, SPEEDS
from radhar_cli.files.replacing import replacing
from radhar_cli.numerics.arrays import Float

Parents: TypeAlias = tuple[int | None, ...]
Advance: TypeAlias = Callable[[int], object]
# {view: (horizontal axis, vertical axis)} of points (ahead, left, up); left is always on the left
VIEWS = {"from the radar": (1, 2), "from the side": (0, 2), "from above": (1, 0)}
KNEES = (9, 11)
UNCHANGED = 255  # colours of a palette, and the number that stands for a pixel as it was
LABELS = {0: "ahead (m)", 1: "left (m)", 2: "up (m)"}


def bones(joints: Float, parents: Parents) -> Float:
    """Ends of bones [..., joint, 2, n], from parent to joint, of joints [..., joint, n]."""
    pairs = [(one if parent is None else parent, one) for one, parent in enumerate(parents)]
    return joints[..., np.array(pairs, int).reshape(-1, 2), :]


def limbs(joints: Float, parents: Parents, hips: Float | None) -> Float:
    """Ends of bones as by `bones`, thighs from the hip joints [..., 2, 3] where there are any."""
    ends = bones(joints, parents)
    if hips is not None:
        ends[..., KNEES, 0, :3] = hips
    return ends


@dataclass(frozen=True)
class StillView:
    """Place of the radar and of what stands around people, in the axes (ahead, left, up), m.

    Attributes:
        radar: place of the radar.
        floor: height of the floor; None where it is not known.
        outlines: corners [n, 2] (ahead, left) of walls and rooms, as seen from above.
    """

    radar: Sequence[float] = (0.0, 0.0, 0.0)
    floor: float | None = None
    outlines: Sequence[Float] = ()


class SideView:
    """Points, coloured by their speed, over bones, coloured by their side, from one side."""

    def __init__(
        self,
        axes: Axes,
        name: str,
        limits: Float,
        fastest: float,
        colours: Sequence[str],
        around: StillView,
    ) -> None:
        """Prepare the axes.

        Args:
            axes: axes to draw in.
            name: view, one of VIEWS.
            limits: lowest and highest (ahead, left, up) [3, 2], m.
            fastest: speed at the ends of the colours, m/s.
            colours: colours of the bones of each body, by joint.
            around: what stands still.
        """
        self.across, self.up = VIEWS[name]
        self.bones = LineCollection([], colors=colours or "0.6", linewidths=2.2)
        axes.add_collection(self.bones, autolim=False)
        look: dict[str, Any] = {"s": 16, "edgecolors": "0.3", "linewidths": 0.3, "zorder": 3}
        look |= {"cmap": SPEEDS, "vmin": -fastest, "vmax": fastest}
        self.points = axes.scatter([], [], c=[], **look)
        axes.set(xlim=limits[self.across], ylim=limits[self.up], aspect="equal", title=name)
        axes.set_xlabel(LABELS[self.across])
        axes.locator_params(nbins=6)
        if name != "from the side":  # which has the heights of the view beside it
            axes.set_ylabel(LABELS[self.up])
        if self.across == 1:
            axes.invert_xaxis()
        _draw_still_view(axes, name, around)

    def show(self, points: Float, speed: Float, ends: Float) -> None:
        """Show points [n, 3], their approaching speed [n], and bones [bone, 2, 3], in m and m/s."""
        self.bones.set_segments(list(ends[..., [self.across, self.up]]))
        self.points.set_offsets(points[:, [self.across, self.up]])
        self.points.set_array(speed)


def _draw_still_view(axes: Axes, name: str, around: StillView) -> None:
    """Draw the floor, or from above the radar and the walls, and say where the radar is."""
    if name == "from above":
        for outline in around.outlines:
            axes.plot(outline[:, 1], outline[:, 0], color="0.45", linewidth=1.2, scalex=False)
        ahead, left, _ = around.radar
        if ahead < axes.get_ylim()[0]:
            below: dict[str, Any] = {"color": RADAR, "transform": axes.transAxes}
            axes.text(0.02, 0.03, "\N{DOWNWARDS ARROW} radar", **below)
            return
        axes.plot(left, ahead, "D", color=RADAR, markersize=7, clip_on=False, zorder=4)
        look: dict[str, Any] = {"color": RADAR, "textcoords": "offset points", "va": "center"}
        axes.annotate("radar", (left, ahead), (8, 0), **look)
        return
    if around.floor is not None:
        axes.axhline(around.floor, color="0.6", linewidth=1.5, zorder=0)
    if name == "from the side":
        corner: dict[str, Any] = {"color": RADAR, "va": "top", "transform": axes.transAxes}
        axes.text(0.02, 0.97, "\N{LEFTWARDS ARROW} radar", **corner)


def side_legend(figure: Figure, colours: Sequence[str], **where: Any) -> None:
    """Add the meaning of the colours of bones to a figure; `where` is that of `Figure.legend`."""
    lines = [
        Line2D([], [], color=colour, linewidth=2.2, label=f"{side} of the body")
        for side, colour in (("right", RIGHT), ("left", LEFT))
        if colour in colours
    ]
    if lines:
        figure.legend(handles=lines, frameon=False, **where)


def colour_bar(figure: Figure, side: SideView, **where: Any) -> None:
    """Add the colour bar of the points' speed to a figure; `where` is that of `Figure.colorbar`."""
    bar = figure.colorbar(side.points, extend="both", **where)
    bar.set_label("approaching (m/s)")


class Film:
    """Film of three sides and a clock, in the left `share` of a wide figure."""

    def __init__(
        self,
        title: str,
        near: Float,
        wide: Float,
        fastest: float,
        colours: Sequence[str],
        around: StillView,
        share: float = 1.0,
    ) -> None:
        """Prepare the figure.

        Args:
            title: line above.
            near: limits [3, 2] of the views from the radar and from the side, m.
            wide: limits [3, 2] of the view from above, m.
            fastest: speed at the ends of the colours, m/s.
            colours: colours of the bones of each body, by joint.
            around: what stands still.
            share: share of the width that is used.
        """
        self.figure = Figure(figsize=(13, 5.2), dpi=80)
        self.figure.suptitle(title)
        self.sides = [
            SideView(
                self.figure.add_axes((share * left, 0.16, share * 0.265, 0.7)),
                *(name, wide if name == "from above" else near, fastest, colours, around),
            )
            for left, name in zip((0.055, 0.345, 0.675), VIEWS, strict=True)
        ]
        cax = self.figure.add_axes((share * 0.955, 0.17, 0.01, 0.66))
        colour_bar(self.figure, self.sides[0], cax=cax)
        side_legend(self.figure, colours, loc="lower left", ncols=3)
        self.clock = self.figure.text(0.62 * share, 0.03, "", ha="center")

    def show(
        self, points: Float, speed: Float, ends: Float, clock: str, centre: Float | None = None
    ) -> None:
        """Show a moment on every side (as `SideView.show`), and the text of the clock.

        Args:
            centre: place (ahead, left, up) from which the near views count, m; None for their
                origin.
        """
        for side, name in zip(self.sides, VIEWS, strict=True):
            away = np.zeros(3) if centre is None or name == "from above" else centre
            side.show(points - away, speed, ends - away)
        self.clock.set_text(clock)

    def write(
        self,
        path: Path,
        show: Callable[[int], None],
        count: int,
        frame_ms: int,
        advance: Advance,
        others: Sequence[Any] = (),
    ) -> None:
        """Write a GIF; what never changes is drawn once.

        Args:
            path: file to write.
            show: function that shows the frame of a number.
            count: number of frames.
            frame_ms: duration of each, ms.
            advance: called with 1 after every frame.
            others: artists that change besides the points, the bones and the clock.
        """
        moving = [self.clock, *others]
        for side in self.sides:
            moving += [side.bones, side.points]
        canvas: Any = FigureCanvasAgg(self.figure)
        for artist in moving:
            artist.set_animated(True)
        canvas.draw()
        background = canvas.copy_from_bbox(self.figure.bbox)

        def frames() -> Iterator[Image.Image]:
            palette: Image.Image | None = None
            for frame in range(count):
                canvas.restore_region(background)
                show(frame)
                for artist in moving:
                    self.figure.draw_artist(artist)
                picture = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
                palette = palette or picture.quantize(UNCHANGED, Image.Quantize.MAXCOVERAGE)
                yield picture.quantize(palette=palette, dither=Image.Dither.NONE)
                advance(1)

        with replacing(path) as unfinished, unfinished.open("wb") as file:
            file.writelines(gif_blocks(frames(), frame_ms))


def gif_blocks(frames: Iterator[Image.Image], frame_ms: int) -> Iterator[bytes]:
    """Encode a GIF that plays in a loop, block by block; Pillow's `save` holds all frames at once.

    Args:
        frames: one or more pictures of the same palette of `UNCHANGED` colours.
        frame_ms: duration of each, ms.
    """
    last = next(frames)
    yield from getheader(last, info={"loop": 0, "duration": frame_ms})[0]
    changed, corner, duration = last, (0, 0), frame_ms  # what is still to be written
    for frame in frames:
        difference = ImageChops.subtract_modulo(frame, last)
        box = difference.getbbox()
        if box is None:  # the last one is shown for longer
            duration += frame_ms
            continue
        yield from getdata(changed, corner, duration=duration, transparency=UNCHANGED)
        changed, corner, duration, last = frame.crop(box), box[:2], frame_ms, frame
        same = difference.crop(box).point([255, *[0] * 255], "1")
        changed.paste(UNCHANGED, mask=same)
    yield from getdata(changed, corner, duration=duration, transparency=UNCHANGED)
    yield b";"
