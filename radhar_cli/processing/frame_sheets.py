"""Sheets of frames: one image a sample of a board's maps, points and skeletons, for looking."""

from collections.abc import Iterator
from itertools import pairwise, product
from math import ceil, sqrt
from typing import TypeAlias

import numpy as np
from PIL import Image, ImageDraw

from radhar_cli.numerics.arrays import Float, Index, Levels
from radhar_cli.processing.entropy import entropy_bits
from radhar_cli.processing.frame_maps import FrameMaps
from radhar_cli.processing.image import binary_exponent, levels, reduced
from radhar_cli.processing.points import Cloud
from radhar_cli.processing.power_map import MapImage
from radhar_cli.processing.scale import DecibelScale

MOST_TILES = 16
BONE, LEAST, GAP = 70, 120, 1  # grey of bones, of the weakest point; pixels between tiles
FRONT_M = ((-1.25, 1.25), (-1.25, 1.25))  # limits of a front view to the left and up, m
Size: TypeAlias = tuple[int, int]


def _tiles(frames: int, size: Size) -> tuple[Index, list[tuple[slice, slice]]]:
    """Numbers of the frames to show, spread evenly, and their tiles row by row."""
    across = ceil(sqrt(min(frames, MOST_TILES)))
    chosen = np.unique(np.linspace(0, frames - 1, min(frames, across * across)).round().astype(int))
    rows = np.linspace(0, size[0], across + 1).astype(int).tolist()
    columns = np.linspace(0, size[1], across + 1).astype(int).tolist()
    high = [slice(start, stop - GAP) for start, stop in pairwise(rows)]
    wide = [slice(start, stop - GAP) for start, stop in pairwise(columns)]
    return chosen, list(product(high, wide))[: chosen.size]


def maps_sheet(maps: FrameMaps, scale: DecibelScale, size: Size) -> MapImage:
    """Sheet of frames side by side, on the scale of all of them; row 0 is the farthest."""
    maps = maps.shown
    chosen, places = _tiles(len(maps.power), size)
    cells = np.zeros(size, np.float32)
    exponent = binary_exponent(maps.power)
    scaled = np.ldexp(maps.power[chosen].astype(float), -exponent)
    span = None if maps.limits is None else maps.rows.places_of(maps.limits)
    for power, (rows, columns) in zip(scaled, places, strict=True):
        shape = rows.stop - rows.start, columns.stop - columns.start
        if min(shape) > 0:
            small = reduced([power.T], power.shape[1], shape, entropy=False, rows=span)
            cells[rows, columns] = small.cells
    white = float(np.ldexp(scale.white(maps.power), -exponent))
    return MapImage(levels(cells, scale.range_db, white), entropy_bits(maps.power), maps.extent)


def cloud_sheet(cloud: Cloud, size: Size) -> MapImage:
    """Sheet of front views of the points of frames, as the radar sees them."""
    # Measured points may have no intensity.
    intensity = np.nan_to_num(np.maximum(cloud.points[:, 4], 0))
    sheet, strongest = np.zeros(size, np.uint8), intensity.max(initial=1e-30)
    for frame, draw, shape in _drawings(sheet, len(cloud.start) - 1):
        rows = slice(cloud.start[frame], cloud.start[frame + 1])
        points = cloud.points[rows]
        grey = LEAST + (255 - LEAST) * (intensity[rows] / strongest) ** 0.25
        for (x, y), level in zip(_pixels(points[:, :3], shape), grey.astype(int), strict=True):
            draw.rectangle([x, y, x + 1, y + 1], fill=int(level))
    return MapImage(sheet, entropy_bits(sheet.astype(float)), (*FRONT_M[0], *FRONT_M[1]))


def bones_sheet(skeletons: Float, parents: tuple[int | None, ...], size: Size) -> Levels:
    """Sheet of the skeletons [frame, person, joint, 3] (m) of the frames of `cloud_sheet`.

    They are the truth: to look at beneath the points, never in the images of data sets.
    """
    sheet = np.zeros(size, np.uint8)
    for frame, draw, shape in _drawings(sheet, len(skeletons)):
        for joints in _pixels(skeletons[frame], shape):
            for joint, parent in enumerate(parents):
                if parent is not None and np.isfinite(joints[[joint, parent]]).all():
                    draw.line([*joints[joint], *joints[parent]], fill=BONE)
    return sheet


def _drawings(sheet: Levels, frames: int) -> Iterator[tuple[int, ImageDraw.ImageDraw, Size]]:
    """Yield the frames of a sheet, with what draws on their tiles and the sizes of these."""
    chosen, places = _tiles(frames, sheet.shape)
    for frame, (rows, columns) in zip(chosen.tolist(), places, strict=True):
        shape = rows.stop - rows.start, columns.stop - columns.start
        if min(shape) > 0:
            image = Image.fromarray(np.zeros(shape, np.uint8))
            yield frame, ImageDraw.Draw(image), shape
            sheet[rows, columns] = np.asarray(image)


def _pixels(p: Float, shape: Size) -> Float:
    """Pixels (x, y) [..., 2] of points [..., 3] (m) in a front view; left of the radar is left."""
    (right, left), (low, high) = FRONT_M
    x = (left - p[..., 1]) / (left - right) * (shape[1] - 1)
    y = (high - p[..., 2]) / (high - low) * (shape[0] - 1)
    return np.stack([x, y], axis=-1)
