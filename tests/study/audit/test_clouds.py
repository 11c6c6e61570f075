"""Clouds of boards: where they are, and what lies far from the body."""

import numpy as np

from radhar_cli.study.audit.clouds import cloud_evidence, has_clouds


class Board:
    """A data set with clouds of two classes, of which one stands farther away."""

    def __init__(self, products):
        self.products = products


def board(count=12):
    rng = np.random.default_rng(0)
    clouds, starts = [], []
    for number in range(count):
        frames = rng.integers(0, 6, 10)
        points = rng.normal(0, 0.2, (frames.sum(), 8)).astype(np.float32)
        points[:, 0] += 2 + 2 * (number % 2)  # ahead
        if len(points):
            points[0, 1] = 4.0
        clouds.append(points)
        starts.append(np.r_[0, np.cumsum(frames)])
    clouds[3] = np.zeros((0, 8), np.float32)
    starts[3] = np.zeros(11, int)
    return Board({"points": clouds, "points_start": starts})


def test_features_of_clouds():
    place, ends, counts, far = cloud_evidence(board(), np.arange(12))
    assert place.values.shape == (12, 4)
    assert np.isnan(place.values[3]).all(), "a sample without a point"
    middle = np.delete(place.values[:, 0], 3)
    assert (np.abs(middle - np.delete([2, 4] * 6, 3)) < 0.3).all()
    assert (counts.values[:, 0] == 10).all()
    assert counts.values[3, 1] == 0
    assert np.nanmin(far.values[:, 0]) > 0
    assert ends.may_be_movement
    assert not place.may_be_movement
    assert "range_m: {uniform: [1.94, 4.05]}" in place.cure
    measured = cloud_evidence(board(), np.arange(12), is_simulated=False)
    assert not any(
        "motion." in evidence.cure or "timing." in evidence.cure for evidence in measured
    )


def test_points_without_doppler_leave_that_of_the_others():
    data = board()
    data.products["points"][0][:-1, 3] = np.nan
    data.products["points"][0][-1, 3] = -1.5
    _, ends, _, _ = cloud_evidence(data, np.arange(12))
    assert ends.values[0, 3] == 1.5


def test_what_has_clouds():
    assert has_clouds(board())
    assert not has_clouds(Board({"points": []}))
