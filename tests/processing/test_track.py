"""Tracks of a torso are functions of time."""

import numpy as np
import pytest

from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.processing.track import PulseTrack, StandingTrack


def test_a_track_known_at_pulses_is_that_of_the_nearest_pulse() -> None:
    delay = np.array([1e-8, 3e-8, 2e-8])
    track = PulseTrack(np.array([0.0, 0.1, 0.2]), delay)
    times = np.array([[0.0, 0.04], [0.11, 0.9]])
    assert np.array_equal(track.delay_at(times), delay[[[0, 0], [1, 2]]])
    assert track.range_at(times) == pytest.approx(track.delay_at(times) * SPEED_OF_LIGHT / 2)


def test_a_track_known_at_pulses_with_a_gap_is_that_of_the_pulse_nearest_by_number() -> None:
    track = PulseTrack(np.array([0.0, 1.0, 5.0]), np.array([1e-8, 2e-8, 3e-8]))
    assert track.delay_at(np.array([2.9, 3.1])).tolist() == [2e-8, 3e-8]


def test_one_who_stands_has_the_same_range_at_all_times() -> None:
    track = StandingTrack(5.0)
    assert track.range_at(np.linspace(-1, 9, 4)) == pytest.approx(np.full(4, 5.0))
