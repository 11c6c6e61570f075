"""Colour maps as look-up tables."""

import numpy as np

from radhar_cli.arrays import Levels


def colour_table(name: str) -> Levels:
    """RGB [256, 3] of a Matplotlib colour map, whose name the config has checked."""
    from matplotlib import colormaps

    rgb = colormaps[name](np.arange(256))[:, :3]
    return np.floor(rgb * 255 + 0.5).astype(np.uint8)
