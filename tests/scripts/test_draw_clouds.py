"""scripts/draw_clouds.py: points and skeletons of a frame, from above and as seen."""

import draw_clouds
import numpy as np
import pytest


@pytest.mark.parametrize(("speed", "colour"), [(1.0, "RED"), (-1.0, "BLUE"), (0.0, "BLACK")])
def test_points_are_left_and_up_where_they_are(speed: float, colour: str) -> None:
    points = np.zeros((1, 8))
    points[0, :4] = 3.0, 1.0, -0.5, speed  # 1 m to the left, 0.5 m below the radar
    picture = np.asarray(draw_clouds.draw_frame(points, np.full((1, 13, 3), np.nan), ""))
    scale = draw_clouds.PIXELS_PER_METRE
    row, column = np.argwhere((picture == getattr(draw_clouds, colour)).all(axis=2)[12:]).T
    row += 12  # behind the title
    near = column < draw_clouds.WIDTH_M * scale / 2
    assert near.all()
    assert np.median(column) == pytest.approx((draw_clouds.WIDTH_M / 2 - 1) * scale, abs=1.5)
    above = round(draw_clouds.FAR_M * scale)
    assert np.median(row[row < above]) == pytest.approx(above - 3 * scale, abs=1.5)
    height = (above + round(draw_clouds.TALL_M * scale) - np.median(row[row > above])) / scale
    assert height == pytest.approx(draw_clouds.HEIGHT_M - 0.5, abs=0.05)


def test_two_chains_see_one_who_falls() -> None:
    motion = {"range_m": 3.0, "angle_deg": 90}
    clouds, skeletons = draw_clouds.make_clouds("falling", motion, [], 14, 1)
    counts = {chain: np.diff(cloud.start) for chain, cloud in clouds.items()}
    assert len(skeletons) == 14
    assert counts["people tracking"][8:].mean() > 10 * counts["out of box"][8:].mean() > 0
