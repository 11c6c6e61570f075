"""Panels of frames: what colours tell apart, and labels of axes."""

import numpy as np
import pytest

from radhar_cli.figures.frames_panel import label_of, speed_of_colours
from radhar_cli.processing.power_map import Axis


def test_colours_follow_the_points_and_not_the_fastest_of_them() -> None:
    speeds = np.r_[np.linspace(-1.5, 1.5, 95), [60.0] * 5]  # a few points of noise
    assert 1.2 < speed_of_colours(speeds) < 1.6


@pytest.mark.parametrize("speeds", [np.zeros(0), np.zeros(4)])
def test_colours_have_ends_without_points_and_of_points_at_rest(speeds: np.ndarray) -> None:
    assert speed_of_colours(speeds) > 0


def test_the_axis_of_one_chirp_says_that_it_has_no_speed() -> None:
    assert label_of(Axis("radial speed", "m/s", np.zeros(1), 12.0)).startswith("no radial speed")
    assert label_of(Axis("range", "m", np.arange(4.0))) == "range (m)"
    assert label_of(Axis("radial speed", "m/s", np.arange(4.0))) == "approaching (m/s)"
