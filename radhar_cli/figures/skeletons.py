"""Skeletons that a network estimated beside the true ones, and the error of every joint."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from radhar_cli.figures.page import page, png_bytes
from radhar_cli.figures.sides import LABELS, VIEWS, Parents, bones
from radhar_cli.figures.style import RADAR
from radhar_cli.numerics.arrays import Float

SIDES = ("from the radar", "from the side")
REACH = np.array([-1.05, 1.05])  # m


def skeletons_png(pairs: Sequence[tuple[Float, Float, str]], parents: Parents, title: str) -> bytes:
    """Draw estimated skeletons over true ones, a column for each pair, from two sides.

    Args:
        pairs: (true joints [joint, 3], estimated ones, caption) of each, m.
        parents: parent of each joint; empty to draw points alone.
        title: line above.

    Returns:
        The PNG file.
    """
    figure = page(2.3 * len(pairs), 5.4)
    grid = figure.subplots(len(SIDES), len(pairs), squeeze=False)
    for row, side in zip(grid, SIDES, strict=True):
        across, up = VIEWS[side]
        for axes, (true, estimated, caption) in zip(row, pairs, strict=True):
            for joints, colour, name in ((true, "0.6", "true"), (estimated, "tab:red", "found")):
                for bone in bones(joints, parents):
                    axes.plot(bone[:, across], bone[:, up], color=colour, linewidth=1.8)
                axes.plot(joints[:, across], joints[:, up], "o", color=colour, ms=3, label=name)
            x, z = (true[:, axis].mean() + REACH for axis in (across, up))
            axes.set(xlim=x[::-1] if across == 1 else x, ylim=z, aspect="equal")
            axes.set_xlabel(LABELS[across])
            axes.locator_params(nbins=5)
            if side == SIDES[0]:
                axes.set_title(caption)
        row[0].set_ylabel(f"{side}\n{LABELS[up]}")
    corner: dict[str, Any] = {"color": RADAR, "va": "top", "transform": grid[1, 0].transAxes}
    grid[1, 0].text(0.03, 0.97, "\N{LEFTWARDS ARROW} radar", **corner)
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    figure.suptitle(title)
    return png_bytes(figure)
