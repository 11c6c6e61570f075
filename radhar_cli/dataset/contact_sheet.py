"""A contact sheet: some samples of every class of a data set."""

from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np

from radhar_cli.config.radar import ArrayRadar
from radhar_cli.dataset.file_description import describe_levels
from radhar_cli.dataset.layout import row_axis
from radhar_cli.dataset.reading import Dataset
from radhar_cli.figures.page import DPI, page_of_rows, write_figure
from radhar_cli.figures.style import SIGNED
from radhar_cli.motion.skeleton import JOINTS, PARENTS
from radhar_cli.numerics.arrays import Levels
from radhar_cli.processing.frame_sheets import bones_sheet

MAX_SIDE = 1024  # px of a panel
LETTERS_AN_INCH = 12  # of a title


def draw_contact_sheet(data: Dataset, name: str, per_class: int, path: Path) -> None:
    """Write a PNG file with a row of maps for every class that is present.

    Points are drawn over the true skeletons, which the images of the data set lack.

    Args:
        data: the data set.
        name: the map.
        per_class: number of samples of each class.
        path: file to write.
    """
    image, images, extent = data.config.image, data.maps[name], data.extent(name)
    strides = tuple(slice(None, None, -(-side // MAX_SIDE)) for side in image.size_px)
    rows = {
        data.class_slugs[label].replace("_", "\n"): np.flatnonzero(data.label == label).tolist()
        for label in np.unique(data.label)
    }
    rows = {name: samples[:per_class] for name, samples in rows.items()}
    figure, panels = page_of_rows(rows, (1.7, 1.4), (2.0, 0.8))
    colours = SIGNED if image.kind == "signed" else image.colour_map
    look: dict[str, Any] = {"cmap": colours, "vmin": 0, "vmax": 255, "aspect": "auto"}
    for panel, sample in panels:
        levels = images[sample]
        if name == "points":
            levels = over_bones(data, sample, levels)
        drawn = panel.imshow(levels[strides], extent=extent, **look)
        panel.tick_params(length=2)
        panel.label_outer()
    figure.supxlabel("time (s)")
    figure.supylabel("{} ({})".format(*row_axis(name)))
    power = describe_levels(image, "brightest", "darkest")
    meaning = "cells that the CFAR sets" if image.kind == "cfar" else power
    bar = figure.colorbar(drawn, ax=[panel for panel, _ in panels], aspect=60, pad=0.02)
    bar.set_label("grey level")
    width = round(LETTERS_AN_INCH * figure.get_figwidth())
    figure.suptitle("\n".join(wrap(f"{name}: {meaning}", width)))
    write_figure(figure, path, DPI)


def over_bones(data: Dataset, sample: int, points: Levels) -> Levels:
    """Draw a sheet of points [H, W] over its frames' true skeletons, if the joints are known."""
    radar = data.config.radar  # points are those of the subframe that images are of
    name = "skeleton" + (radar.ends_in_files[""] if isinstance(radar, ArrayRadar) else "")
    skeletons = data.products[name][sample] if name in data.products else None
    if skeletons is None or skeletons.shape[2] != len(JOINTS):
        return points
    return np.where(points > 0, points, bones_sheet(skeletons, PARENTS, points.shape))
