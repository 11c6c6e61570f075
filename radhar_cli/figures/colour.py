"""Colour maps as look-up tables."""

import difflib

import numpy as np

from radhar_cli.arrays import Levels
from radhar_cli.errors import ConfigError


def colour_table(name: str) -> Levels:
    """RGB [256, 3] of a Matplotlib colour map.

    Raises:
        ConfigError: no such colour map.
    """
    from matplotlib import colormaps

    if name not in colormaps:
        near = difflib.get_close_matches(name, list(colormaps), n=1)
        hint = f"did you mean {near[0]!r}?" if near else "viridis, gray, turbo and jet are some"
        raise ConfigError(f"image.colour_map = {name!r}: should be a Matplotlib colour map; {hint}")
    rgb = colormaps[name](np.arange(256))[:, :3]
    return np.floor(rgb * 255 + 0.5).astype(np.uint8)
