"""scripts/studies/two_in_a_cell.py and kinds_of_ghosts.py: their rows and counts."""

import kinds_of_ghosts
import numpy as np
import pytest
import two_in_a_cell


def test_two_beside_each_other_are_found_without_a_stray() -> None:
    cells = two_in_a_cell.row_of("IWR6843ISK", "azimuth", 6, 3).split("|")
    assert [cell.strip() for cell in cells[1:4]] == ["IWR6843ISK", "azimuth", "0 %"]
    assert cells[5].strip() == "100 %"
    assert float(cells[6]) < 0.5


@pytest.mark.parametrize("axis", ["azimuth", "elevation"])
def test_directions_are_apart_along_one_axis(axis: str) -> None:
    for seed in range(5):
        ways = two_in_a_cell.draw_directions(np.random.default_rng(seed), axis)
        np.testing.assert_allclose(np.linalg.norm(ways, axis=1), 1)
        az = np.degrees(np.arctan2(ways[:, 1], ways[:, 0]))
        el = np.degrees(np.arcsin(ways[:, 2]))
        apart, same = (az, el) if axis == "azimuth" else (el, az)
        assert 20 <= np.ptp(apart) <= 80
        assert np.ptp(same) < 1e-9


def test_ways_of_points_follow_from_the_echoes_of_each() -> None:
    counts = kinds_of_ghosts.count_kinds(2, 5, "torso")
    best = counts["best, ISK"]
    assert sum(best.values()) > 3
    right = sum(n for (true, kind), n in best.items() if true == kind)
    assert right >= 0.7 * sum(n for (true, _), n in best.items() if true >= 0)
