"""Maps of long recordings with their labels in time below: true ones, and those that were found."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from radhar_cli.figures.page import page
from radhar_cli.numerics.arrays import Index, Levels

INCHES_A_SECOND, NARROWEST, WIDEST = 0.16, 7.0, 16.0
MAP_HEIGHT, STRIP_HEIGHT = 1.7, 0.22  # inches
NAMED_SHARE = 0.011  # of the width, that a letter of a name takes
AT_REST = {"pause": "#e6e6e6", "transition": "#9a9a9a"}


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
        axes.set_title(labelled.title, fontsize=8, loc="left", pad=2)
        axes.set_ylabel(labelled.rows, fontsize=7)
        axes.tick_params(labelsize=6, length=2, labelbottom=False)
        for strip, labels in labelled.strips.items():
            axes = next(panel)
            _draw_strip(axes, labels, labelled.extent, names, colours)
            axes.set_ylabel(strip, fontsize=7, rotation=0, ha="right", va="center")
            axes.tick_params(labelsize=6, length=2, labelbottom=False)
        axes.tick_params(labelbottom=True)
    axes.set_xlabel(across, fontsize=7)
    present = np.unique(np.concatenate([labels for m in maps for labels in m.strips.values()]))
    handles = [Patch(color=colours[n], label=names[n]) for n in present.tolist() if n >= 0]
    figure.legend(handles=handles, loc="outside right upper", fontsize=7, frameon=False)
    return figure


def label_colours(names: Sequence[str]) -> list[str | tuple[float, ...]]:
    """Colour of each label; pauses and transitions are grey."""
    table = colormaps["tab10" if len(names) <= 12 else "tab20"]
    numbers = {name: n for n, name in enumerate(name for name in names if name not in AT_REST)}
    return [AT_REST.get(name) or table(numbers[name] % table.N) for name in names]


def _draw_strip(
    axes: Axes,
    labels: Index,
    extent: Sequence[float],
    names: Sequence[str],
    colours: Sequence[str | tuple[float, ...]],
) -> None:
    """Draw labels [W] of columns as bars, named where there is room."""
    left, right = extent[:2]
    cuts = [0, *(np.flatnonzero(np.diff(labels)) + 1).tolist(), labels.size]
    step = (right - left) / labels.size
    for start, stop in pairwise(cuts):
        label = int(labels[start])
        if label < 0:
            continue
        axes.axvspan(left + start * step, left + stop * step, color=colours[label], lw=0)
        name = names[label].replace("_", " ")
        if name not in AT_REST and (stop - start) / labels.size > NAMED_SHARE * len(name):
            middle = left + 0.5 * (start + stop) * step
            axes.text(middle, 0.5, name, fontsize=6, ha="center", va="center")
    axes.set_xlim(left, right)
    axes.set_ylim(0, 1)
    axes.set_yticks([])
