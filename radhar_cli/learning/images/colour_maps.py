"""Which colour map a picture is drawn in, and the levels behind its colours."""

from collections.abc import Iterable
from functools import cache

import numpy as np
from scipy.spatial import KDTree

from radhar_cli.dataset.png import colour_table
from radhar_cli.numerics.arrays import Float, Levels

# Of Matplotlib, MATLAB and OpenCV, as far as they go from dark to bright or over a rainbow.
KNOWN = ("viridis", "gray", "jet", "turbo", "magma", "inferno", "plasma", "cividis", "hot", "bone")
PICTURES_LOOKED_AT = 4  # from which a colour map is recognised
PIXELS = 2000  # that are looked at in each
CLOSE = 20.0  # mean distance from a table (0 to 441 in RGB) of pictures that JPEG has blurred
APART = 2.0  # factor by which the second table should be farther away
FEWEST = 8  # colours; pictures of fewer say nothing of their colour map


@cache
def _tree(name: str) -> KDTree:
    return KDTree(colour_table(name).astype(float))


def levels_behind(rgb: Levels, name: str) -> Levels:
    """Levels [H, W] whose colours in a colour map are nearest to RGB [H, W, 3]."""
    packed = (rgb.astype(np.uint32) * np.array([1 << 16, 1 << 8, 1], np.uint32)).sum(2)
    colours, colour_number = np.unique(packed, return_inverse=True)
    rgb_colours = np.stack([colours >> 16, colours >> 8 & 255, colours & 255], axis=1)
    level = np.asarray(_tree(name).query(rgb_colours.astype(float))[1], np.uint8)
    levels: Levels = level[colour_number].reshape(rgb.shape[:2])
    return levels


def colour_map_of(pictures: Iterable[Levels]) -> str | None:
    """Known colour map that all RGB pictures [H, W, 3] are drawn in, None if there is none."""
    samples = [_sample_pixels(picture) for picture in pictures]
    pixels = np.concatenate(
        [sample for sample in samples if sample is not None] or [np.zeros((0, 3))]
    )
    if not len(pixels):
        return None
    distance = {name: float(np.mean(_tree(name).query(pixels)[0])) for name in KNOWN}
    nearest, second = sorted(KNOWN, key=distance.__getitem__)[:2]
    if distance[nearest] > CLOSE or distance[second] < APART * distance[nearest] + 1:
        return None
    return nearest


def _sample_pixels(picture: Levels) -> Float | None:
    """Pixels [N, 3] spread evenly over a picture, None where it has too few colours to tell."""
    pixels = picture.reshape(-1, 3)
    chosen = pixels[np.linspace(0, len(pixels) - 1, min(PIXELS, len(pixels))).astype(int)]
    if len(np.unique(chosen, axis=0)) < FEWEST:
        return None
    sample: Float = chosen.astype(float)
    return sample
