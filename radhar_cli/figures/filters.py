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
    figure = page(2.4 * columns + 0.8, 2.4 * len(runs) + 0.7)
    panels = figure.subplots(len(runs), columns, squeeze=False)
    for column in range(columns):
        drawn = [filters[column] for filters in runs.values() if column < len(filters)]
        low, high = min(f.min() for f in drawn), max(f.max() for f in drawn)
        for row, (name, filters) in enumerate(runs.items()):
            panel = panels[row, column]
            if column >= len(filters):
                panel.set_axis_off()
                continue
            height, width = filters[column].shape
            image = panel.imshow(
                np.fft.fftshift(filters[column]),
                # Pixel centres are whole frequencies: -N/2 to N/2 - 1.
                extent=(-width / 2 - 0.5, width / 2 - 0.5, -height / 2 - 0.5, height / 2 - 0.5),
                origin="lower",
                cmap="viridis",
                vmin=low,
                vmax=high,
            )
            panel.set_title(f"filter {column + 1}, {height} x {width}", fontsize=8)
            panel.tick_params(labelsize=7)
            if column == 0:
                panel.set_ylabel(name, fontsize=7)
        figure.colorbar(image, ax=panels[:, column], shrink=0.7, location="bottom").ax.tick_params(
            labelsize=6
        )
    figure.supxlabel("horizontal frequency (cycles an image)", fontsize=8)
    figure.supylabel("vertical frequency (cycles an image)", fontsize=8)
    return png_bytes(figure)
