"""Point clouds, and skeletons that were found in them, from the radar, the side and above."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from radhar_cli.figures.page import page, png_bytes
from radhar_cli.figures.sides import VIEWS, Parents, SideView, StillView, bones, colour_bar
from radhar_cli.numerics.arrays import Float

REACH_M = 1.2  # from the middle of the body, or of the points
FASTEST = 2.0  # m/s, at the ends of the colours


class CloudPicture(NamedTuple):
    """A cloud to draw: points [n, 4] as x, y, z (m) and Doppler (m/s), joints, and a caption."""

    points: Float
    joints: Float  # [joint, 3], m; [0, 3] without a skeleton
    words: str


def clouds_png(pictures: Sequence[CloudPicture], parents: Parents, title: str) -> bytes:
    """Draw clouds, a column each, from three sides, with bones over them.

    Args:
        pictures: what to draw.
        parents: parent of each joint; empty to draw joints alone.
        title: line above.

    Returns:
        The PNG file.
    """
    figure = page(2.4 * len(pictures) + 0.8, 7.6)
    grid = figure.subplots(len(VIEWS), len(pictures), squeeze=False)
    for column, picture in zip(grid.T, pictures, strict=True):
        places = picture.joints if len(picture.joints) else picture.points[:, :3]
        middle = np.median(places, axis=0) if len(places) else np.array([2.0, 0.0, 0.0])
        limits = middle[:, None] + [-REACH_M, REACH_M]
        for axes, view in zip(column, VIEWS, strict=True):
            side = SideView(axes, view, limits, FASTEST, [], StillView())
            ends = bones(picture.joints, parents) if parents else np.zeros((0, 2, 3))
            side.show(picture.points[:, :3], picture.points[:, 3], ends)
            across, up = (picture.joints[:, axis] for axis in (side.across, side.up))
            axes.plot(across, up, "o", color="0.3", markersize=2)
        column[0].set_title(f"{picture.words}\n{next(iter(VIEWS))}")
    colour_bar(figure, side, ax=grid, shrink=0.5)
    figure.suptitle(title)
    return png_bytes(figure)
