"""Moving target indication."""

import numpy as np
import pytest
import reference as ref

from radhar_cli.processing.mti import mti


@pytest.mark.parametrize("shape", [(7,), (3, 7), (2, 3, 5)])
def test_first_difference_over_the_pulses(shape):
    s = np.random.default_rng(0).standard_normal((*shape, 2)).view(complex)[..., 0]
    assert mti(s).shape == (*shape[:-1], shape[-1] - 1)
    assert np.array_equal(mti(s), ref.mti(s))


def test_what_does_not_move_vanishes_exactly():
    clutter = np.exp(1j * np.arange(40))[:, None] * 1e9
    assert not mti(np.repeat(clutter, 20, axis=1)).any()


@pytest.mark.parametrize("cycles", [0.01, 0.1, 0.25, 0.5])
def test_gain_of_a_doppler_tone(cycles):
    """|exp(j 2 pi f) - 1| = 2 sin(pi f): blind at 0, doubled at half the PRF."""
    tone = np.exp(2j * np.pi * cycles * np.arange(100))
    assert np.abs(mti(tone)) == pytest.approx(np.full(99, 2 * np.sin(np.pi * cycles)))
