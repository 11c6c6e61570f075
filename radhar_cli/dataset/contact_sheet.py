"""A contact sheet: some samples of every class of a data set."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from radhar_cli.arrays import Levels
from radhar_cli.dataset.reading import Dataset
from radhar_cli.figures.page import page

MAX_SIDE = 1024  # px of a panel


def draw_contact_sheet(data: Dataset, name: str, per_class: int, path: Path) -> None:
    """Write a PNG with a row of `per_class` maps `name` for every class that is present."""
    labels = np.asarray(data.label[:])
    present = sorted(set(labels.tolist()))
    columns = min(per_class, int(np.bincount(labels).max()))
    figure = page(1.5 * columns + 1.6, 1.4 * len(present) + 0.7)
    panels = figure.subplots(len(present), columns, squeeze=False)
    image, images, extent = data.config.image, data.maps[name], data.extent(name)
    every = tuple(slice(None, None, -(-side // MAX_SIDE)) for side in image.size_px)
    for row, label in zip(panels, present, strict=True):
        chosen = np.flatnonzero(labels == label)[:columns]
        for panel in row:
            panel.set_axis_off()
        for panel, sample in zip(row, chosen, strict=False):
            panel.set_axis_on()
            panel.imshow(
                images[int(sample)][every],
                extent=extent,
                aspect="auto",
                cmap=image.colour_map,
                vmin=0,
                vmax=255,
            )
            panel.tick_params(labelsize=5, length=2)
            panel.label_outer()
        row[0].set_ylabel(data.class_slugs[label].replace("_", "\n"), fontsize=7)
    unit = "range (m)" if name == "rtm" else "Doppler frequency (Hz)"
    figure.supxlabel("time (s)", fontsize=8)
    figure.supylabel(unit, fontsize=8)
    power = f"power, {image.dynamic_range_db:g} dB down from the largest of each map"
    shown = "cells that the CFAR sets" if image.kind == "cfar" else power
    figure.suptitle(f"{name}: {shown}", fontsize=9)
    figure.savefig(path, dpi=110)


def draw_image_sheet(classes: Mapping[str, Sequence[Levels]], title: str, path: Path) -> None:
    """Write a PNG with a row of RGB images [H, W, 3], of any sizes, for every class."""
    columns = max(map(len, classes.values()))
    figure = page(1.5 * columns + 1.6, 1.5 * len(classes) + 0.5)
    panels = figure.subplots(len(classes), columns, squeeze=False)
    for row, (name, images) in zip(panels, classes.items(), strict=True):
        for panel in row[len(images) :]:
            panel.set_axis_off()
        for panel, image in zip(row, images, strict=False):
            panel.imshow(image)
            panel.set(xticks=[], yticks=[])
        row[0].set_ylabel(name.replace("_", "\n"), fontsize=7, parse_math=False)
    figure.suptitle(title, fontsize=9, parse_math=False)
    figure.savefig(path, dpi=110)
