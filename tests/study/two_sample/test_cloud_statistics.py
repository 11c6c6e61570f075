"""Statistics of point clouds of one sample, and how far clouds are from each other."""

import numpy as np
import pytest

from radhar_cli.study.two_sample.cloud_statistics import (
    MOST_POINTS,
    centred_places,
    chamfer_distances,
    cloud_statistics,
)


def cloud(places, doppler=0.0, snr=np.nan):
    """Points [N, 8] at places [N, 3]."""
    points = np.full((len(places), 8), np.nan)
    points[:, :3], points[:, 3], points[:, 5] = places, doppler, snr
    return points


def test_a_cloud_is_described_by_what_it_was_made_of():
    rng = np.random.default_rng(2)
    counts = [200, 0, 100]
    centres = np.repeat([[2, 0, 1], [9, 9, 9], [3, 1, 1]], counts, 0)
    places = rng.normal(centres, (0.1, 0.2, 0.4))
    doppler = np.where(np.arange(300) % 4 == 0, 0, -2.0)
    found = cloud_statistics(cloud(places, doppler, 15), np.array([0, 200, 200, 300]))
    assert found["points"] == pytest.approx(100)
    assert found["points_sd"] == pytest.approx(np.std(counts))
    assert found["empty"] == pytest.approx(100 / 3)
    for name, sd in (("ahead", 0.1), ("left", 0.2), ("up", 0.4)):
        assert found[f"spread_{name}"] == pytest.approx(sd, rel=0.15), "frames move, not the spread"
    assert found["height"] == pytest.approx(1, abs=0.1)
    assert (found["still"], found["speed"], found["speed_95"]) == (25, 1.5, 2)
    assert (found["snr"], found["snr_sd"]) == (15, 0)


def test_what_is_not_known_is_undefined():
    found = cloud_statistics(cloud(np.ones((3, 3)), np.nan), np.array([0, 3]))
    assert np.isnan([found["snr"], found["speed"], found["still"]]).all()
    assert found["points"] == 3
    empty = cloud_statistics(cloud(np.zeros((0, 3))), np.array([0, 0]))
    assert (empty["points"], empty["empty"]) == (0, 100)
    assert np.isnan(empty["range"])


def test_clouds_are_as_far_apart_as_they_are_shifted():
    rng = np.random.default_rng(1)
    grid = np.stack(np.meshgrid(*[np.arange(4.0)] * 3), -1).reshape(-1, 3)
    assert chamfer_distances([grid], [grid], same=False)[0] == 0
    shifted = grid + np.array([0.25, 0, 0])
    assert chamfer_distances([shifted], [grid], same=False)[0] == pytest.approx(0.25)
    both = chamfer_distances([grid, shifted], [grid, shifted], same=True)
    np.testing.assert_allclose(both, 0.25, err_msg="a measured cloud is not set beside itself")
    assert np.isnan(chamfer_distances([np.zeros((0, 3))], [grid], same=False)[0])
    assert np.isnan(chamfer_distances([grid], [grid], same=True)[0])
    far = centred_places(cloud(grid + 100), rng)
    assert chamfer_distances([far], [centred_places(cloud(grid), rng)], same=False)[0] < 1e-9
    assert len(centred_places(cloud(rng.normal(size=(2000, 3))), rng)) == MOST_POINTS


def test_what_is_missing_counts_as_what_should_not_be_there():
    near, far = np.zeros((5, 3)), np.full((5, 3), 3.0)
    both = np.concatenate([near, far])
    missing = chamfer_distances([near], [both], same=False)[0]
    added = chamfer_distances([both], [near], same=False)[0]
    assert missing == added == pytest.approx(np.sqrt(27) / 4)
