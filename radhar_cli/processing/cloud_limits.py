"""Points of a cloud that lie within limits: of a field of view, or of a box in the room."""

import numpy as np

from radhar_cli.numerics.arrays import Bool
from radhar_cli.processing.points import Cloud
from radhar_cli.radar.board import Board
from radhar_cli.radar.detection import Detection
from radhar_cli.radar.room import RoomBox


def keep_in_view(cloud: Cloud, detection: Detection) -> Cloud:
    """Keep the points of a cloud within the limits of angles, range and speed of a .cfg."""
    x, y, z, doppler = cloud.points[:, :4].T
    values = (
        (np.degrees(np.arctan2(y, x)), detection.azimuth_deg, -1),
        (np.degrees(np.arctan2(z, np.hypot(x, y))), detection.elevation_deg, 1),
        (np.sqrt(x * x + y * y + z * z), detection.range_m, 1),
        (doppler, detection.doppler_mps, -1),
    )
    is_inside = np.ones(len(cloud.points), bool)
    for value, limits, sign in values:  # TI's angles are to the right, its speeds recede
        if limits is not None:
            is_inside &= (sign * value >= limits[0]) & (sign * value <= limits[1])
    return _only(cloud, is_inside)


def keep_in_box(cloud: Cloud, box: RoomBox, board: Board) -> Cloud:
    """Keep the points of a cloud within a box of the room, by the pose of the board."""
    ahead, left, up = (cloud.points[:, :3] @ np.array(board.upright.axes)).T
    height = up + board.position[2]
    is_inside = np.ones(len(cloud.points), bool)
    for value, limits in ((ahead, box.ahead_m), (left, box.left_m), (height, box.up_m)):
        is_inside &= (value >= limits[0]) & (value <= limits[1])
    return _only(cloud, is_inside)


def _only(cloud: Cloud, chosen: Bool) -> Cloud:
    """Keep the chosen points [N] of a cloud."""
    counts = np.concatenate([[0], np.cumsum(chosen)])
    return Cloud(cloud.points[chosen], counts[cloud.start].astype(np.int64))
