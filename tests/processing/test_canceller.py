"""Cancellers: what stands still vanishes, the gain of a Doppler is known."""

import numpy as np
import pytest
from helpers import reference as ref
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.signal import butter, lfilter

from radhar_cli.numerics.accelerators import installed, machine_code
from radhar_cli.processing import canceller as canceller_module
from radhar_cli.processing.canceller import (
    FIRST_DIFFERENCE,
    NO_CANCELLER,
    Fir,
    HighPass,
    MeanRemoval,
)

THREE_PULSE = Fir((1, -2, 1))


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


WHOLE = [
    MeanRemoval(),
    HighPass(4, 0.0075),
    HighPass(4, 0.0075, remove_mean=False),
    HighPass(3, 0.2, zero_phase=True),
    HighPass(10, 1e-4),
]
signals = arrays(
    np.complex128,
    st.tuples(st.integers(1, 3), st.integers(1, 60)),
    elements=st.complex_numbers(max_magnitude=1e3, allow_nan=False, allow_infinity=False),
)


@pytest.mark.parametrize("canceller", WHOLE, ids=repr)
@given(s=signals, a=st.floats(-10, 10))
@settings(max_examples=40, deadline=None)
def test_whole_recordings_are_cancelled_linearly_without_gain(canceller, s, a):
    """Linear in every row, no pulse lost, and no more energy out than in: what bounds an error."""
    y = canceller(s)
    assert y.shape == s.shape
    other = np.roll(s, 1, axis=-1).conj()
    scale = 1e-9 * (1 + np.abs(s).max())
    assert np.abs(canceller(s + a * other) - y - a * canceller(other)).max() < 20 * scale
    assert np.linalg.norm(y) <= np.linalg.norm(s) * (1 + 1e-9) + scale
    assert np.array_equal(canceller(s[0]), y[0])
    assert canceller.lost == canceller.delay == 0


@pytest.mark.skipif(installed("numba") is None, reason="needs radhar[fast]")
@pytest.mark.parametrize("canceller", [c for c in WHOLE if isinstance(c, HighPass)], ids=repr)
@pytest.mark.parametrize("shape", [(8, 500), (2, 5, 20)])
def test_compiled_it_filters_alike(monkeypatch, canceller, shape):
    """Many rows of many pulses, as scipy filters them one by one."""
    s = np.random.default_rng(2).standard_normal((*shape, 2)).view(complex)[..., 0]
    right, calls = canceller(s), []

    def noted(function):
        calls.append(function)
        return machine_code(function)

    monkeypatch.setattr(canceller_module, "MIN_SAMPLES", s.size)
    monkeypatch.setattr(canceller_module, "machine_code", noted)
    assert np.abs(canceller(s) - right).max() < 1e-9 * np.abs(s).max()
    assert len(calls) == 1 + canceller.zero_phase
    calls.clear()
    canceller(s[..., :-1])
    assert not calls


@pytest.mark.parametrize("canceller", [c for c in WHOLE if c.removes_static], ids=repr)
def test_what_does_not_move_vanishes_from_a_whole_recording(canceller):
    clutter = np.repeat(np.exp(1j * np.arange(40))[:, None] * 1e9, 500, axis=1)
    assert not canceller(clutter).any()


def test_a_static_echo_leaves_what_float64_cannot_hold_beside_it():
    """120 dB above what moves: the residue is 1e-16 of the static echo, whatever the canceller."""
    rng = np.random.default_rng(5)
    s, static = rng.standard_normal((4000, 2)) @ [1, 1j], 1e6 * np.exp(0.3j)
    for canceller in (FIRST_DIFFERENCE, *(c for c in WHOLE if c.removes_static)):
        left = canceller(s + static) - canceller(s)
        assert np.abs(left).max() < 1e-9


def test_started_from_rest_a_static_echo_rings():
    left = HighPass(4, 0.0075, remove_mean=False)(np.ones(2000))
    assert left[0] > 0.9
    assert np.abs(left[1000:]).max() < 1e-3


@pytest.mark.parametrize("order", [1, 4, 10])
@pytest.mark.parametrize("cutoff", [1e-4, 0.0075, 0.3, 0.9])
@pytest.mark.parametrize("zero_phase", [False, True])
def test_the_high_pass_is_butterworths(order, cutoff, zero_phase):
    """|H|^2 = 1/(1 + (tan(pi f_c/2)/tan(pi f/2))^(2n)), f over PRF/2; 3 dB at the cut-off."""
    size = int(min(600_000, 400 + 60 * order / cutoff))
    impulse = np.zeros(size)
    impulse[size // 2 if zero_phase else 0] = 1
    found = np.abs(np.fft.rfft(HighPass(order, cutoff, zero_phase, remove_mean=False)(impulse)))
    f = np.arange(found.size) / (found.size - 1)
    with np.errstate(divide="ignore"):
        ratio = np.tan(np.pi * cutoff / 2) / np.tan(np.pi * f / 2)
        right = 1 / np.sqrt(1 + ratio ** (2 * order))
    assert found == pytest.approx(right**2 if zero_phase else right, abs=2e-3)


def test_the_chain_of_the_measured_data_at_5_8_ghz():
    """MATLAB's filter(b, a, x) of butter(4, 0.0075, 'high')."""
    s = np.random.default_rng(2).standard_normal((3000, 2)) @ [1, 1j] + 5
    b, a = butter(4, 0.0075, "high")
    assert HighPass(4, 0.0075, remove_mean=False)(s) == pytest.approx(lfilter(b, a, s), abs=1e-6)
