"""The beat at the pulses that a range-time map shows."""

from dataclasses import asdict
from math import floor

import numpy as np
import pytest
from helpers import reference as ref

from radhar_cli.echo.exact import beat_at
from radhar_cli.processing.signal import shown_pulses
from radhar_cli.radar.fmcw import Waveform


@pytest.mark.parametrize(
    ("count", "width"), [(19999, 256), (511, 256), (257, 256), (1000, 7), (3, 2), (100, 99)]
)
def test_shown_pulses_are_spread_evenly(count, width):
    """m_j = floor((j + 1/2)(M - 1)/W): the middles of W equal parts of the recording."""
    found = shown_pulses(count, width)
    assert found.tolist() == [floor((j + 0.5) * count / width) for j in range(width)]
    assert np.diff(found).min() >= 1
    assert found[0] >= 0
    assert found[-1] < count


@pytest.mark.parametrize(("count", "width"), [(256, 256), (255, 256), (10, 256), (1, 2)])
def test_all_are_shown_where_there_are_few(count, width):
    assert shown_pulses(count, width).tolist() == list(range(count))


@pytest.mark.parametrize("mti", [True, False])
def test_beat_is_exact_and_computed_there_alone(mti):
    """Pairs that share a pulse compute it once."""
    radar = ref.Radar(24e9, 1e9, 97e-6, 1e6, 1000, 0.5)
    pulses = np.array([0, 3, 4, 250, 498])
    source = ref.Points(lambda t: np.array([[1.5], [4.0]]) + np.array([[2.0], [-3.0]]) * t)
    found = beat_at(source, Waveform(**asdict(radar)), pulses, (-1.0, 1.0) if mti else (1.0,))
    needed = [0, 1, 3, 4, 5, 250, 251, 498, 499] if mti else pulses
    assert [t.tolist() for t in source.asked] == [(np.array(needed) / radar.prf).tolist()]
    paths = source(radar.times)
    beat = ref.beat_matrix(paths.delay, paths.amplitude, radar)
    right = (ref.mti(beat) if mti else beat)[:, pulses]
    assert np.abs(found - right).max() < 1e-11 * np.abs(beat).max()
