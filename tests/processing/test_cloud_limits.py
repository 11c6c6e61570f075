"""Points within a field of view, and within a box of the room."""

from dataclasses import replace

import numpy as np
from helpers.boards import CFG, MARS

from radhar_cli.processing.cloud_limits import keep_in_box, keep_in_view
from radhar_cli.processing.points import COLUMNS, Cloud
from radhar_cli.radar.room import RoomBox
from radhar_cli.readers.ti.ti_cfg import parse_ti_cfg

BOX = "boundaryBox -1 2 0.5 6 0 2\n"


def cloud_of(*frames: list[tuple[float, float, float, float]]) -> Cloud:
    """Cloud of frames of points (ahead, left, up, Doppler) in the axes of the radar."""
    return Cloud.of(
        [
            np.pad(np.array(one, float).reshape(-1, 4), ((0, 0), (0, len(COLUMNS) - 4)))
            for one in frames
        ]
    )


def test_a_box_is_read_in_the_axes_of_scenes() -> None:
    """Of people tracking x is to the right; people counting has no heights."""
    assert parse_ti_cfg(CFG).box is None
    assert parse_ti_cfg(CFG + BOX).box == RoomBox((0.5, 6), (-2, 1), (0, 2))
    scenery = parse_ti_cfg(f"{CFG}SceneryParam -6 5 0.05 7\n").box
    assert scenery == RoomBox((0.05, 7), (-5, 6), (-np.inf, np.inf))


def test_points_outside_a_box_of_the_room_are_left_out() -> None:
    """Two metres up and looking down by 30 degrees, what lies ahead is near the floor."""
    box = parse_ti_cfg(CFG + BOX).box
    assert box is not None
    board = replace(MARS, position=(0, 0, 2.0), tilt=np.radians(30))
    cloud = cloud_of(
        [(3, 0, 0, 0), (5, 0, 0, 0)],  # 0.5 m above the floor, 0.5 m below it
        [],
        [(3, 0.9, 0, 0), (3, 1.1, 0, 0), (3, -1.9, 0, 0), (3, -2.1, 0, 0), (0.3, 0, 0, 0)],
    )
    kept = keep_in_box(cloud, box, board)
    assert kept.start.tolist() == [0, 1, 1, 3]
    np.testing.assert_allclose(kept.points[:, 1], [0, 0.9, -1.9], atol=1e-6)
    turned = replace(board, yaw=np.pi / 2)  # to the left: what lies ahead of it is left
    assert keep_in_box(cloud_of([(3, 0, 0, 0)]), box, turned).points.shape == (0, 8)


def test_limits_of_a_field_of_view_are_to_the_right_and_receding() -> None:
    lines = "aoaFovCfg -1 -20 40 -90 90\ncfarFovCfg -1 0 1 6\ncfarFovCfg -1 1 -2 0.5\n"
    detection = parse_ti_cfg(CFG + lines).detection
    cloud = cloud_of(
        [(3, 1, 0, 0), (3, 2, 0, 0), (3, -2, 0, 0), (3, -3, 0, 0)],  # 18, 34, -34, -45 degrees
        [
            (0.9, 0, 0, 0),
            (5.9, 0, 0, 0),
            (6.1, 0, 0, 0),
            (3, 0, 0, 1.9),
            (3, 0, 0, 2.1),
            (3, 0, 0, -1),
        ],
    )
    kept = keep_in_view(cloud, detection)
    assert kept.start.tolist() == [0, 2, 4]
    np.testing.assert_allclose(kept.points[:, 1], [1, -2, 0, 0])
    low_power = "chirpComnCfg 15 5 0 128 1 34 3\nchirpTimingCfg 6 26 1 47.95 60\n"
    frame = f"channelCfg 7 3 0\n{low_power}frameCfg 2 0 600 64 200 0\nrangeSelCfg 0.5 4\n"
    assert parse_ti_cfg(frame).detection.range_m == (0.5, 4)
