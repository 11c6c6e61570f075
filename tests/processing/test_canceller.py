"""Cancellers: what stands still vanishes, the gain of a Doppler is known."""

import numpy as np
import pytest
import reference as ref

from radhar_cli.processing.canceller import FIRST_DIFFERENCE, NO_CANCELLER, Canceller

THREE_PULSE = Canceller((1, -2, 1))


@pytest.mark.parametrize("shape", [(7,), (3, 7), (2, 3, 5)])
def test_first_difference_over_the_pulses(shape):
    s = np.random.default_rng(0).standard_normal((*shape, 2)).view(complex)[..., 0]
    assert np.array_equal(FIRST_DIFFERENCE(s), ref.mti(s))
    assert np.allclose(THREE_PULSE(s), ref.mti(ref.mti(s)), rtol=1e-14)
    assert NO_CANCELLER(s) is s


def test_what_does_not_move_vanishes_exactly():
    clutter = np.repeat(np.exp(1j * np.arange(40))[:, None] * 1e9, 20, axis=1)
    assert not FIRST_DIFFERENCE(clutter).any()
    assert not THREE_PULSE(clutter).any()


@pytest.mark.parametrize("cycles", [0.01, 0.1, 0.25, 0.5])
def test_gain_of_a_doppler_tone(cycles):
    """|exp(j 2 pi f) - 1| = 2 sin(pi f): blind at 0, doubled at half the PRF."""
    tone = np.exp(2j * np.pi * cycles * np.arange(100))
    gain = 2 * np.sin(np.pi * cycles)
    assert np.abs(FIRST_DIFFERENCE(tone)) == pytest.approx(np.full(99, gain))
    assert np.abs(THREE_PULSE(tone)) == pytest.approx(np.full(98, gain**2))


@pytest.mark.parametrize("canceller", [NO_CANCELLER, FIRST_DIFFERENCE, THREE_PULSE])
def test_an_output_lies_in_the_middle_of_its_pulses(canceller):
    assert canceller.lost == len(canceller.taps) - 1
    assert canceller.delay == canceller.lost / 2
