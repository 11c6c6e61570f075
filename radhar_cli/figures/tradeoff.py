"""Time against difference of settings: savings, their price, and costs."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import log10
from typing import Literal

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Annotation, Text
from matplotlib.transforms import Bbox

from radhar_cli.figures.page import page, png_bytes

DEFAULT_NAME = "default"
LEAST_LEVELS = 0.003  # which the axis shows; less is "none"
COLOURS = {"error": "#0072B2", "picture": "#E69F00", "default": "#D55E00"}
MAX_NAME = 34  # characters
FONT = 7.5
STEP_PT = 9.0  # between places that a name may take
RINGS = 14  # of such places


@dataclass(frozen=True)
class SettingMark:
    """A setting in the figure."""

    name: str
    ratio: float  # time of a sample over the default's
    levels: float  # rms difference of the map that differs most, grey levels
    is_error: bool  # whether the difference is an error of computation
    has_all_maps: bool = True  # whether it shows all that the default shows
    saves: bool = False  # whether it saves time beyond doubt


def tradeoff_png(marks: Sequence[SettingMark], title: str) -> bytes:
    """Draw settings by time and difference, with the frontier of those that save time.

    Returns:
        The PNG file.
    """
    figure = page(10.5, 6.8)
    axes = figure.subplots()
    axes.set_xscale("log")
    axes.set_yscale("log")
    drawn = [mark for mark in marks if mark.ratio > 0]
    for mark in drawn:
        kind = "default" if mark.name == DEFAULT_NAME else "error" if mark.is_error else "picture"
        shape = {"default": "D", "error": "o", "picture": "^"}[kind]
        colour = COLOURS[kind]
        inner, rim = (colour, "0.2") if mark.has_all_maps else ("none", colour)
        axes.plot(mark.ratio, _height(mark), shape, ms=6, mew=0.6, mfc=inner, mec=rim)
    _label_axes(axes, drawn, title)
    _draw_frontier(axes, drawn)
    axes.legend(loc="upper right", fontsize=7.5, framealpha=0.9)
    figure.canvas.draw()
    place_names(axes, drawn)
    return png_bytes(figure)


def frontier(marks: Sequence[SettingMark]) -> list[SettingMark]:
    """Settings that save time, of which no other both takes less and differs less; by time.

    The default is its end.
    """
    edge = list[SettingMark]()
    candidates = [mark for mark in marks if mark.has_all_maps and mark.saves]
    for mark in sorted(candidates, key=lambda mark: (mark.ratio, mark.levels)):
        if not edge or mark.levels < edge[-1].levels:
            edge.append(mark)
    return [*edge, *(mark for mark in marks if mark.name == DEFAULT_NAME)]


def _draw_frontier(axes: Axes, marks: Sequence[SettingMark]) -> None:
    """Draw a line along the frontier, with its entry in the legend, where it has two marks."""
    edge = frontier(marks)
    if len(edge) > 1:
        ratios, heights = [mark.ratio for mark in edge], [_height(mark) for mark in edge]
        label = "saves time; no other is both faster and nearer"
        axes.plot(ratios, heights, "--", color="0.6", lw=1, zorder=-1, label=label)


def _height(mark: SettingMark) -> float:
    return max(mark.levels, LEAST_LEVELS)


def _label_axes(axes: Axes, marks: Sequence[SettingMark], title: str) -> None:
    """Write titles and limits, leave room for names, and explain the marks."""
    ratios = [mark.ratio for mark in marks] or [1.0]
    low, high = min(*ratios, 0.8), max(*ratios, 1.5)
    span = log10(high / low)
    axes.set_xlim(low * 10 ** (-0.08 * span - 0.03), high * 10 ** (0.28 * span + 0.03))
    axes.set_ylim(LEAST_LEVELS * 0.5, 400)
    step = 0.05 if span < 0.3 else 0.1
    fine = [step * n for n in range(2, round(1.6 / step))] if span < 0.7 else []
    steps = [0.1, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5, 10, 20, 50, 100, 200, 500, 1000]
    ticks = [tick for tick in fine or steps if low <= tick <= high]
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    axes.set_yticks(
        [LEAST_LEVELS, 0.01, 0.1, 1, 10, 100], ["none", "0.01", "0.1", "1 level", "10", "100"]
    )
    axes.grid(alpha=0.25)
    axes.axvline(1, color="0.75", lw=0.8, zorder=0)
    axes.axhline(1, color="0.75", lw=0.8, zorder=0)
    axes.set_xlabel("time of a sample, over the default's")
    axes.set_ylabel("rms difference of the map that differs most (grey levels of 255)")
    axes.set_title(f"{title}: time against what is shown", fontsize=11)
    for words, shape, kind in (
        ("the config as it is", "D", "default"),
        ("error: the same physics", "o", "error"),
        ("another picture: other physics or parameters", "^", "picture"),
        ("fewer maps", "^", "none"),
    ):
        rim = COLOURS["picture"] if kind == "none" else "0.2"
        axes.plot([], [], shape, mfc=COLOURS.get(kind, "none"), mec=rim, mew=0.6, label=words)


def place_names(axes: Axes, marks: Sequence[SettingMark]) -> list[Annotation]:
    """Write the names of marks beside them, so that none lies on another or on a mark.

    The nearest free place is taken, ring by ring; a thin line leads to a name that is far. A name
    for which none is free is left out.
    """
    legend = axes.get_legend()
    inside = axes.get_window_extent()
    boxes = [] if legend is None else [legend.get_window_extent()]
    centres = axes.transData.transform([(mark.ratio, _height(mark)) for mark in marks])
    boxes += [Bbox.from_bounds(x - 5, y - 5, 10, 10) for x, y in centres]
    placed = list[Annotation]()
    for mark in sorted(marks, key=lambda mark: mark.name != DEFAULT_NAME):
        text = axes.annotate(
            _short(mark.name),
            (mark.ratio, _height(mark)),
            xytext=(0, 0),
            textcoords="offset points",
            fontsize=FONT,
            va="center",
            arrowprops={"arrowstyle": "-", "lw": 0.4, "color": "0.6", "shrinkA": 0, "shrinkB": 2},
            weight="bold" if mark.name == DEFAULT_NAME else "normal",
        )
        box = _free_place(text, boxes, inside)
        if box is None:
            text.remove()
        else:
            boxes.append(box)
            placed.append(text)
    return placed


def _free_place(text: Annotation, boxes: Sequence[Bbox], inside: Bbox) -> Bbox | None:
    """Move a name to the nearest place that is free, and return its box; None where none is."""
    canvas = text.get_figure(root=True).canvas  # type: ignore[union-attr]
    assert isinstance(canvas, FigureCanvasAgg)
    renderer = canvas.get_renderer()  # type: ignore[no-untyped-call]
    for x, y, side in _places():
        text.set_position((x, y))
        text.set_horizontalalignment(side)
        text.update_positions(renderer)
        box = Text.get_window_extent(text, renderer)  # of the words, without the line
        is_inside = box.x0 > inside.x0 and box.x1 < inside.x1
        is_inside = is_inside and box.y0 > inside.y0 and box.y1 < inside.y1
        if is_inside and not any(box.overlaps(other) for other in boxes):
            return box
    return None


def _places() -> Iterator[tuple[float, float, Literal["left", "right"]]]:
    """Yield offsets of a name from its mark, points, and its side there: the nearest first."""
    for ring in range(RINGS):
        rise = STEP_PT * ring
        for y in (rise, -rise) if ring else (0.0,):
            yield 6 + 0.6 * rise, y, "left"
            yield -6 - 0.6 * rise, y, "right"


def _short(name: str) -> str:
    """Name without its section, cut where it is long."""
    key, colon, value = name.partition(": ")
    name = f"{key.rpartition('.')[2]}{colon}{value}" if colon and " " not in key else name
    return name if len(name) <= MAX_NAME else f"{name[: MAX_NAME - 1]}\N{HORIZONTAL ELLIPSIS}"
