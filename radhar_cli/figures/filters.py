"""What the global filters weigh: magnitude by spatial frequency, layer by layer."""

from collections.abc import Mapping, Sequence

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.figures.page import page, png_bytes


def filters_png(runs: Mapping[str, Sequence[Float]]) -> bytes:
    """Draw a row for every run and a column for every layer.

    Args:
        runs: name of each run and its filters, each [H, W]: magnitude of the effective weight in
            FFT order, averaged over channels.
    """
    columns = max(len(filters) for filters in runs.values())
    figure = page(2.3 * columns + 0.8, 2.2 * len(runs) + 0.6)
    panels = figure.subplots(len(runs), columns, squeeze=False)
    for row, (name, filters) in zip(panels, runs.items(), strict=True):
        for panel in row[len(filters) :]:
            panel.set_axis_off()
        for number, (panel, magnitude) in enumerate(zip(row, filters, strict=False)):
            height, width = magnitude.shape
            drawn = panel.imshow(
                np.fft.fftshift(magnitude),
                extent=(-width / 2, width / 2, -height / 2, height / 2),
                origin="lower",
                aspect="auto",
                cmap="viridis",
            )
            figure.colorbar(drawn, ax=panel, shrink=0.8).ax.tick_params(labelsize=5)
            panel.set_title(f"filter {number + 1}, {height} x {width}", fontsize=7)
            panel.tick_params(labelsize=5)
        row[0].set_ylabel(f"{name}\nvertical (cycles an image)", fontsize=6)
    figure.supxlabel("cycles an image along the slow-time axis", fontsize=8)
    return png_bytes(figure)
