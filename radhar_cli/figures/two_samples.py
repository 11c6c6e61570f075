"""Two data sets of maps beside each other: distances, distributions, pictures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from radhar_cli.arrays import Float, Levels
from radhar_cli.figures.page import page, page_of_rows, png_bytes

SIMULATED, MEASURED = "C1", "C0"
ACROSS = 4  # distributions per row
BINS = 24
FULL = 2.0  # distance of the strongest colour


def distances_png(distances: Float, rows: Sequence[str], columns: Sequence[str]) -> bytes:
    """Draw distances [statistics, classes] as a table of colours; NaN is left blank."""
    figure = page(1.5 * len(columns) + 3.4, 0.27 * len(rows) + 1.5)
    axes = figure.subplots()
    drawn = axes.imshow(distances, cmap="Reds", vmin=0, vmax=FULL, aspect="auto")
    for (row, column), value in np.ndenumerate(distances):
        if np.isfinite(value):
            dark = value > 0.6 * FULL
            axes.text(
                column,
                row,
                f"{value:.2f}",
                ha="center",
                va="center",
                fontsize=7,
                color="white" if dark else "black",
            )
    axes.set_xticks(range(len(columns)), columns, fontsize=8)
    axes.set_yticks(range(len(rows)), rows, fontsize=8)
    axes.xaxis.tick_top()
    label = "Wasserstein distance (standard deviations)"
    figure.colorbar(drawn, ax=axes, shrink=0.8, extend="max").set_label(label, fontsize=7)
    return png_bytes(figure)


@dataclass(frozen=True)
class Distribution:
    """A statistic of both sides: a title, values [N] and [M] that are finite, their unit."""

    title: str
    simulated: Float
    measured: Float
    unit: str


def distributions_png(some: Sequence[Distribution], title: str) -> bytes:
    """Draw histograms of both sides over each other."""
    down = -(-len(some) // ACROSS)
    figure = page(3.1 * ACROSS, 1.9 * down + 0.6)
    panels = figure.subplots(down, ACROSS, squeeze=False).ravel()
    for axes, one in zip(panels, some, strict=False):
        whole = np.concatenate([one.simulated, one.measured])
        if whole.size:
            low, high = whole.min(), whole.max()
            bins = np.linspace(low, high if high > low else low + 1, BINS + 1)
            for values, colour, name in (
                (one.measured, MEASURED, "measured"),
                (one.simulated, SIMULATED, "simulated"),
            ):
                counts = np.histogram(values, bins)[0] * 100 / max(1, values.size)
                axes.stairs(counts, bins, fill=True, color=colour, alpha=0.55, label=name)
        axes.set_title(one.title, fontsize=8)
        axes.set_xlabel(one.unit, fontsize=7, labelpad=1)
        axes.locator_params(nbins=4)
        axes.tick_params(labelsize=6)
    for axes in panels[len(some) :]:
        axes.set_axis_off()
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", fontsize=8)
    figure.suptitle(title, fontsize=10)
    figure.supylabel("maps (%)", fontsize=8)
    return png_bytes(figure)


@dataclass(frozen=True)
class Picture:
    """Levels [H, W], edges (left, right, bottom, top), and a few words."""

    levels: Levels
    extent: tuple[float, float, float, float]
    words: str


def pictures_png(
    rows: Mapping[str, Sequence[Picture]], title: str, across: str, upwards: str
) -> bytes:
    """Draw rows of maps, each under its name.

    Args:
        across: quantity and unit of the columns of a map.
        upwards: of its rows.
    """
    figure, panels = page_of_rows(rows, (2.0, 1.75), (1.2, 0.8))
    for panel, one in panels:
        panel.imshow(
            one.levels,
            extent=one.extent,
            aspect="auto",
            cmap="viridis",
            vmin=0,
            vmax=255,
            interpolation="nearest",
        )
        panel.set_title(one.words, fontsize=7)
        panel.locator_params(nbins=4)
        panel.tick_params(labelsize=6, length=2)
        panel.label_outer()
    figure.supxlabel(across, fontsize=8)
    figure.supylabel(upwards, fontsize=8)
    figure.suptitle(title, fontsize=10)
    return png_bytes(figure)
