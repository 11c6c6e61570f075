"""Maps of long recordings with their labels in time below: true ones, and those that were found."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from radhar_cli.figures.page import page
from radhar_cli.figures.style import SMALL, Colour, distinct_colours
from radhar_cli.numerics.arrays import Index, Levels

INCHES_A_SECOND, NARROWEST, WIDEST = 0.16, 7.0, 16.0
MAP_HEIGHT, STRIP_HEIGHT = 1.7, 0.24  # inches
LETTER_INCH = 0.085  # width of a letter of a name
AT_REST = {"pause": "#f0f0f0", "transition": "#bdbdbd"}


@dataclass(frozen=True)
class LabelledMap:
    """A map over time, and labels of its columns."""

    title: str
    levels: Levels  # [H, W]
    extent: Sequence[float]  # left, right (s), bottom, top
    rows: str  # quantity and unit of the rows
    strips: Mapping[str, Index]  # {what they are: labels [W], -1 for none}


def draw_labelled_maps(
    maps: Sequence[LabelledMap], names: Sequence[str], colour_map: str, across: str = "time (s)"
) -> Figure:
    """Draw maps one below the other, each with its labels as coloured strips.

    Args:
        maps: maps with their labels.
        names: names of the labels.
        colour_map: colour map of the levels.
        across: quantity and unit of the columns.
    """
    seconds = max(labelled.extent[1] - labelled.extent[0] for labelled in maps)
    width = float(np.clip(INCHES_A_SECOND * seconds, NARROWEST, WIDEST))
    heights = [h for labelled in maps for h in (MAP_HEIGHT, *[STRIP_HEIGHT] * len(labelled.strips))]
    figure = page(width + 1.5, sum(heights) + 0.45 * len(maps) + 0.4, apart=0.01)
    panels = figure.subplots(len(heights), 1, squeeze=False, height_ratios=heights)[:, 0]
    colours, panel = label_colours(names), iter(panels)
    for labelled in maps:
        axes = next(panel)
        axes.imshow(
            labelled.levels,
            cmap=colour_map,
            vmin=0,
            vmax=255,
            aspect="auto",
            extent=labelled.extent,
        )
        axes.set_title(labelled.title, loc="left", pad=2)
        axes.set_ylabel(labelled.rows)
        axes.tick_params(length=2, labelbottom=False)
        for strip, labels in labelled.strips.items():
            axes = next(panel)
            _draw_strip(axes, labels, labelled.extent, names, colours, LETTER_INCH / width)
            axes.set_ylabel(strip, rotation=0, ha="right", va="center")
            axes.tick_params(length=2, labelbottom=False)
        axes.tick_params(labelbottom=True)
    axes.set_xlabel(across)
    present = np.unique(np.concatenate([labels for m in maps for labels in m.strips.values()]))
    handles = [
        Patch(color=colours[n], label=_legend(n, names[n])) for n in present.tolist() if n >= 0
    ]
    figure.legend(handles=handles, loc="outside right upper", frameon=False)
    return figure


def label_colours(names: Sequence[str]) -> list[Colour]:
    """Colour of each label; pauses and transitions alone are grey."""
    colours = iter(distinct_colours(len(names)))
    return [AT_REST.get(name) or next(colours) for name in names]


def _legend(number: int, name: str) -> str:
    """Name of a label with its number, which stands in strips that are too short for the name."""
    words = name.replace("_", " ")
    return words if name in AT_REST else f"{number + 1}  {words}"


def _draw_strip(
    axes: Axes,
    labels: Index,
    extent: Sequence[float],
    names: Sequence[str],
    colours: Sequence[Colour],
    letter: float,
) -> None:
    """Draw labels [W] of columns as bars, with their names, or numbers, where there is room.

    A letter takes the share `letter` of the width.
    """
    left, right = extent[:2]
    cuts = [0, *(np.flatnonzero(np.diff(labels)) + 1).tolist(), labels.size]
    step = (right - left) / labels.size
    for start, stop in pairwise(cuts):
        label = int(labels[start])
        if label < 0:
            continue
        axes.axvspan(left + start * step, left + stop * step, color=colours[label], lw=0)
        name = names[label].replace("_", " ")
        room, middle = (stop - start) / labels.size / letter, left + 0.5 * (start + stop) * step
        words = name if room > len(name) else str(label + 1)
        if name not in AT_REST and room > len(words):
            red, green, blue = to_rgb(colours[label])
            is_dark = 0.3 * red + 0.59 * green + 0.11 * blue < 0.55
            look: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": SMALL}
            axes.text(middle, 0.48, words, color="white" if is_dark else "black", **look)
    axes.set_xlim(left, right)
    axes.set_ylim(0, 1)
    axes.set_yticks([])
