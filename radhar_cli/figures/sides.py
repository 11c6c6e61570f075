"""Points over bones, seen from several sides, still or as a film."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image, ImageChops
from PIL.GifImagePlugin import getdata, getheader

from radhar_cli.files.replacing import replacing
from radhar_cli.numerics.arrays import Float

Parents: TypeAlias = tuple[int | None, ...]
Advance: TypeAlias = Callable[[int], object]
# {view: (horizontal axis and its sign, vertical axis)} of points (ahead, left, up)
VIEWS = {"from the radar": (1, -1.0, 2), "from the side": (0, 1.0, 2), "from above": (1, -1.0, 0)}
KNEES = (9, 11)
UNCHANGED = 255  # colours of a palette, and the number that stands for a pixel as it was
LABELS = {0: "ahead (m)", 1: "right (m)", 2: "up (m)"}


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


class SideView:
    """Points, coloured by their speed, over bones, from one side."""

    def __init__(self, axes: Axes, name: str, limits: Float, fastest: float) -> None:
        """Prepare the axes.

        Args:
            axes: axes to draw in.
            name: view, one of VIEWS.
            limits: lowest and highest (ahead, left, up) [3, 2], m.
            fastest: speed at the ends of the colours, m/s.
        """
        self.across, self.sign, self.up = VIEWS[name]
        (self.bones,) = axes.plot([], [], color="0.6", linewidth=1.5)
        look: dict[str, Any] = {"s": 14, "edgecolors": "0.3", "linewidths": 0.3, "zorder": 3}
        look |= {"cmap": "coolwarm", "vmin": -fastest, "vmax": fastest}
        self.points = axes.scatter([], [], c=[], **look)
        axes.set(xlim=sorted(self.sign * limits[self.across]), ylim=limits[self.up], aspect="equal")
        axes.set_title(name, fontsize=9)
        axes.set_xlabel(LABELS[self.across], fontsize=7)
        axes.set_ylabel(LABELS[self.up], fontsize=7)
        axes.tick_params(labelsize=6)

    def show(self, points: Float, speed: Float, ends: Float) -> None:
        """Show points [n, 3], their approaching speed [n], and bones [bone, 2, 3], in m and m/s."""
        lines = np.insert(ends, 2, np.nan, axis=1).reshape(-1, 3)
        self.bones.set_data(self.sign * lines[:, self.across], lines[:, self.up])
        places = points[:, [self.across, self.up]] * (self.sign, 1)
        self.points.set_offsets(places)
        self.points.set_array(speed)


def colour_bar(figure: Figure, side: SideView, **where: Any) -> None:
    """Add the colour bar of the points' speed to a figure; `where` is that of `Figure.colorbar`."""
    bar = figure.colorbar(side.points, extend="both", **where)
    bar.set_label("approaching (m/s); faster in the tips", fontsize=7)
    bar.ax.tick_params(labelsize=6)


class Film:
    """Film of three sides and a clock, in the left `share` of a wide figure."""

    def __init__(self, title: str, limits: Float, fastest: float, share: float = 1.0) -> None:
        self.figure = Figure(figsize=(13, 4.6), dpi=80)
        self.figure.suptitle(title, fontsize=9)
        self.sides = [
            SideView(
                self.figure.add_axes((share * (0.06 + 0.31 * number), 0.14, share * 0.24, 0.7)),
                *(name, limits, fastest),
            )
            for number, name in enumerate(VIEWS)
        ]
        cax = self.figure.add_axes((share * 0.95, 0.15, 0.01, 0.66))
        colour_bar(self.figure, self.sides[0], cax=cax)
        self.clock = self.figure.text(share / 2, 0.02, "", ha="center", fontsize=9)

    def show(self, points: Float, speed: Float, ends: Float, clock: str) -> None:
        """Show a moment on every side (as `SideView.show`), and the text of the clock."""
        for side in self.sides:
            side.show(points, speed, ends)
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
