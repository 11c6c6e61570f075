"""The echo of an impulse radar."""

from dataclasses import replace

import numpy as np
import pytest

from radhar_cli.echo.impulse import impulse_echo, impulse_power
from radhar_cli.echo.paths import Paths, Through
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.radar.impulse import Impulse
from radhar_cli.radar.layers import Layer, Layers

RADAR = Impulse(1e9, 2e9, 2e-9, 1e9, 100.0, 0.05, profile=(0.0, 4.8), samples=256)
DELAY, AMPLITUDE = [2e-8, 2.15e-8], [1.0, -0.4]
# of a reference, at these samples
SAMPLES = {
    140: 8.930773637204855e-24,
    155: 0.006793845504449629,
    160: 0.9832845599833726,
    163: 0.04815262505957498,
    167: -0.002752893302871251,
    171: -0.06664087164030597,
    172: -0.3922779006988382,
    175: -0.020520406564594123,
    180: -5.6722336660656137e-05,
    190: 2.939933412541426e-20,
}
AIR = Layers((Layer(0.2, 1 + 0j),), False)


class Fixed:
    """Two echoes at all times."""

    breakpoints, highest_frequency, smooth = (), 1.0, True

    def __init__(self, delay=DELAY, layers: Layers | None = None) -> None:
        self.delay, self.layers = delay, layers

    def __call__(self, t: np.ndarray) -> Paths:
        cosine = None if self.layers is None else np.full((2, 2, t.size), 1.0)
        each = (np.tile(np.array(values)[:, None], t.size) for values in (self.delay, AMPLITUDE))
        return Paths(*each, Through.of(self.layers, cosine))


def test_samples_are_those_of_the_reference() -> None:
    r = impulse_echo(Fixed(), RADAR)
    assert r.shape == (256, 5)
    for sample, right in SAMPLES.items():
        assert r[sample] == pytest.approx(right, abs=1e-12)


def test_its_spectrum_is_10_dB_down_at_the_ends_of_the_band() -> None:
    low, middle, high = RADAR.spectrum(np.array([1e9, 2e9, 3e9]))
    assert 20 * np.log10(low / middle) == pytest.approx(-10, abs=1e-9)
    assert high == pytest.approx(low)


def test_the_sum_over_frequencies_is_the_closed_form() -> None:
    # The integral leaves out f < 0, of which a pulse as wide as its carrier has -40 dB.
    r, right = impulse_echo(Fixed(layers=AIR), RADAR), impulse_echo(Fixed(), RADAR)
    assert np.linalg.norm(r - right) < 1e-2 * np.linalg.norm(right)
    narrow = replace(RADAR, fc=2e9, bandwidth=1e9)
    r, right = impulse_echo(Fixed(layers=AIR), narrow), impulse_echo(Fixed(), narrow)
    assert np.linalg.norm(r - right) < 1e-6 * np.linalg.norm(right)


def test_a_wall_delays_and_rings() -> None:
    wall = Layers((Layer(0.24, 6 - 0.18j),), False)
    near = impulse_echo(Fixed([1e-8, 1e-8], wall), RADAR)[:, 0]
    air = impulse_echo(Fixed([1e-8, 1e-8]), RADAR)[:, 0]
    ranges = RADAR.range_axis()
    first = ranges[np.abs(near).argmax()] - ranges[np.abs(air).argmax()]
    assert first == pytest.approx(0.24 * (np.sqrt(6) - 1), abs=0.03)  # both legs, once
    # The second pass of either leg, of -15.2 dB in the middle of the band and more below it.
    behind = np.where(ranges > ranges[np.abs(near).argmax()] + 0.4, np.abs(near), 0)
    assert -16 < 20 * np.log10(behind.max() / np.abs(near).max()) < -11
    apart = ranges[behind.argmax()] - ranges[np.abs(near).argmax()]
    assert apart == pytest.approx(0.24 * np.sqrt(6), abs=0.06)


@pytest.mark.parametrize("delay", [-1e-7, 0.0, 3.2e-8, 1.0])
def test_echoes_beyond_the_axis_are_not_folded(delay) -> None:
    r = impulse_echo(Fixed([delay, delay]), RADAR)
    t = 2 * RADAR.range_axis() / SPEED_OF_LIGHT
    assert r[:, 0] == pytest.approx(0.6 * RADAR.pulse(t - delay), abs=1e-15)


def test_power_is_half_of_the_squares() -> None:
    assert impulse_power(Fixed(), RADAR) == pytest.approx((1 + 0.16) / 2)
    assert impulse_power(Fixed(layers=AIR), RADAR) == pytest.approx((1 + 0.16) / 2)


IQ = replace(RADAR, is_iq=True)


def test_complex_samples_are_the_pulse_mixed_down() -> None:
    """Each echo is g(t - tau) exp(-j 2 pi fm tau); mixed up again its real part is the pulse."""
    t = 2 * IQ.range_axis()[:, None] / SPEED_OF_LIGHT
    tau, amplitude = np.array(DELAY), np.array(AMPLITUDE)
    envelopes = np.exp(-(((t - tau) / IQ.width) ** 2) / 2)
    right = envelopes @ (amplitude * np.exp(-2j * np.pi * 2e9 * tau))
    r = impulse_echo(Fixed(), IQ)
    assert r[:, 2] == pytest.approx(right, abs=1e-12)
    up = (r * np.exp(2j * np.pi * IQ.f0 * t)).real
    assert up == pytest.approx(impulse_echo(Fixed(), RADAR), abs=1e-12)


def test_complex_samples_may_be_as_sparse_as_the_resolution() -> None:
    """They are those of a finer axis, at any step."""
    step = SPEED_OF_LIGHT / (2 * IQ.bandwidth)
    assert IQ.coarsest_step == pytest.approx(step)
    sparse = replace(IQ, profile=(0.0, 60 * step), samples=60)
    finer = replace(sparse, samples=60 * 8)
    assert impulse_echo(Fixed(), sparse) == pytest.approx(impulse_echo(Fixed(), finer)[::8])


def test_complex_samples_through_layers_are_mixed_down_too() -> None:
    radar = replace(RADAR, fc=2e9, bandwidth=1e9)
    iq = replace(radar, is_iq=True)
    t = 2 * iq.range_axis()[:, None] / SPEED_OF_LIGHT
    wall = Fixed(layers=Layers((Layer(0.24, 6 - 0.18j),), False))
    up = (impulse_echo(wall, iq) * np.exp(2j * np.pi * iq.f0 * t)).real
    assert up == pytest.approx(impulse_echo(wall, radar), abs=1e-12)


def test_power_of_complex_samples_is_that_of_the_squares() -> None:
    assert impulse_power(Fixed(), IQ) == pytest.approx(1 + 0.16)


def test_the_doppler_of_who_approaches_is_positive() -> None:
    """The phase of the sum over range rises by 2 v fm/c cycles a second: 13.3 Hz at 1 m/s."""

    class Approaching(Fixed):
        """An echo from 2 m, 1 m/s nearer every second."""

        def __call__(self, t: np.ndarray) -> Paths:
            return Paths(2 * (2 - t)[None] / SPEED_OF_LIGHT, np.ones((1, t.size)))

    slow = impulse_echo(Approaching(), replace(IQ, prf=1000.0)).sum(axis=0)
    rate = np.diff(np.unwrap(np.angle(slow))).mean() * 1000 / (2 * np.pi)
    assert rate == pytest.approx(2 * 2e9 / SPEED_OF_LIGHT, rel=1e-3)


@pytest.mark.parametrize("is_iq", [True, False])
@pytest.mark.parametrize("bandwidth", [2e8, 1e6])
def test_a_pulse_that_is_longer_than_the_axis_is_that_of_its_formula(
    bandwidth: float, is_iq: bool
) -> None:
    radar = replace(RADAR, bandwidth=bandwidth, samples=64, is_iq=is_iq)
    t = 2 * radar.range_axis() / SPEED_OF_LIGHT
    expected = np.zeros(t.size, complex)
    for delay, amplitude in zip(DELAY, AMPLITUDE, strict=True):
        turn = np.exp(-2j * np.pi * radar.f0 * delay)
        shape = radar.envelope(t - delay) * turn if is_iq else radar.pulse(t - delay)
        expected += amplitude * shape
    profiles = impulse_echo(Fixed(), radar)
    assert profiles.shape == (64, radar.n_pulses)
    assert np.abs(profiles - expected[:, None]).max() < 1e-12
