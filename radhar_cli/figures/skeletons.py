"""Skeletons that a network estimated beside the true ones, and the error of every joint."""

from collections.abc import Sequence

import numpy as np

from radhar_cli.figures.page import page, png_bytes
from radhar_cli.figures.sides import Parents, bones
from radhar_cli.numerics.arrays import Float

# What lies across and which way: seen from the radar left is left; from the person's left.
SIDES = {"from the radar": (1, -1), "from the side": (0, 1)}
REACH = np.array([-1.15, 1.15])  # m


def skeletons_png(pairs: Sequence[tuple[Float, Float, str]], parents: Parents, title: str) -> bytes:
    """Draw estimated skeletons over true ones, a column for each pair, from two sides.

    Args:
        pairs: (true joints [joint, 3], estimated ones, caption) of each, m.
        parents: parent of each joint; empty to draw points alone.
        title: line above.

    Returns:
        The PNG file.
    """
    figure = page(2.1 * len(pairs), 5.4)
    grid = figure.subplots(len(SIDES), len(pairs), squeeze=False)
    for row, (side, (across, sign)) in zip(grid, SIDES.items(), strict=True):
        for axes, (true, estimated, caption) in zip(row, pairs, strict=True):
            for joints, colour, name in ((true, "0.6", "true"), (estimated, "tab:red", "found")):
                x, z = sign * joints[:, across], joints[:, 2]
                for bone in bones(joints, parents):
                    axes.plot(sign * bone[:, across], bone[:, 2], color=colour, linewidth=1.6)
                axes.plot(x, z, "o", color=colour, markersize=2.5, label=name)
            x, z = (middle + REACH for middle in (sign * true[:, across].mean(), true[:, 2].mean()))
            axes.set(xlim=x, ylim=z, aspect="equal")
            axes.set_title(caption)
        row[0].set_ylabel(f"{side}, m")
    grid[0, 0].legend()
    figure.suptitle(title)
    return png_bytes(figure)
