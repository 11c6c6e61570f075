"""The echo of an impulse radar: r[k, m] = sum_i A_i p(2 R_k/c - tau_i).

Through a layered wall it is Re of the integral of P(f) S(f) exp(j 2 pi f t) over f > 0, with the
echo S(f) of `dispersion.py` at even frequencies. Complex samples are sum_i A_i g(2 R_k/c - tau_i)
exp(-j 2 pi fm tau_i), or the integral itself, mixed down by exp(-j 2 pi fm t).
"""

from collections.abc import Callable, Iterator
from typing import TypeAlias

import numpy as np

from radhar_cli.echo.dispersion import beat_of, power_of
from radhar_cli.echo.paths import Paths, PathSource
from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.numerics.phasor import unit_phasor
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT, Waveform
from radhar_cli.radar.impulse import Impulse

CHUNK = 2**10  # pulses at once
REACH = 9.0  # of a pulse to both sides, in s: exp(-REACH^2/2) is 3e-18
LONGEST = 2.0  # times the end of the range axis, up to which echoes do not fold
Transfer: TypeAlias = Callable[[Float], Complex]  # at frequencies, Hz
Profiles: TypeAlias = Float | Complex  # [samples, M], complex of a radar with IQ samples
BAND = 64  # frequencies within 10 dB of the middle, over which a wall's loss is averaged


def impulse_echo(source: PathSource, waveform: Impulse) -> Profiles:
    """Range profiles r [samples, M] at all pulses, without noise."""
    r = np.zeros((waveform.samples, waveform.n_pulses), complex if waveform.is_iq else float)
    for pulses, paths in _chunks(source, waveform):
        r[:, pulses] = profiles_of(paths, waveform)
    return r


def profiles_of(paths: Paths, waveform: Impulse) -> Profiles:
    """Range profiles r [samples, M] of paths, through a layered wall or not."""
    return _spectral(paths, waveform) if paths.through else _pulses(paths, waveform)


def impulse_power(source: PathSource, waveform: Impulse) -> float:
    """Mean P_s over the pulses of sum_i A_i^2/2; through a layered wall also over the band.

    Of complex samples it is twice that, sum_i A_i^2.
    """
    band = Waveform(waveform.fc, waveform.bandwidth, 1e-6, BAND * 1e6, 1.0, 1.0)
    chunks = _chunks(source, waveform)
    return (
        sum(float(power_of(paths, band).sum()) for _, paths in chunks)
        / waveform.n_pulses
        / waveform.peak_to_power
    )


def steady_profile(
    delay: float, amplitude: float, waveform: Impulse, reflected: Transfer | None = None
) -> Profiles:
    """Range profile r [samples, 1] of a path that does not move.

    Args:
        delay: Delay of the path, s.
        amplitude: Amplitude for unit transmit power, without the reflection.
        reflected: Coefficient of reflection at frequencies [N] (Hz), [N]; None is 1 at all of them.
    """
    path = Paths(np.array([[delay]]), np.array([[amplitude]]))
    if reflected is None:
        return _pulses(path, waveform)
    stepped = waveform.stepped(waveform.profile[1] * LONGEST)
    echo = beat_of(path, stepped) * reflected(stepped.frequencies())[:, None]
    return _sum_over_frequencies(echo, waveform)


def _chunks(source: PathSource, waveform: Impulse) -> Iterator[tuple[slice, Paths]]:
    """Yield slices of pulses and their paths."""
    for first in range(0, waveform.n_pulses, CHUNK):
        pulses = np.arange(first, min(first + CHUNK, waveform.n_pulses))
        yield slice(first, first + pulses.size), source(waveform.times(pulses.astype(float)))


def _pulses(paths: Paths, waveform: Impulse) -> Profiles:
    """Range profiles r [samples, M], each pulse added at its delay."""
    step, (first, _) = 2 * waveform.range_step / SPEED_OF_LIGHT, waveform.profile
    half = int(REACH * waveform.width / step) + 1
    if 2 * half + 1 > waveform.samples:
        return _long_pulses(paths, waveform, half)
    around, pulse = np.arange(-half, half + 1)[:, None], np.arange(paths.delay.shape[1])
    type_ = complex if waveform.is_iq else float
    r = np.zeros((waveform.samples + 2 * half + 1, pulse.size), type_)  # those beyond the axis, too
    shape = waveform.envelope if waveform.is_iq else waveform.pulse
    for delay, a in zip(paths.delay, paths.amplitude, strict=True):
        tau = delay - 2 * first / SPEED_OF_LIGHT
        middle: Index = np.clip(np.rint(tau / step), -half - 1, waveform.samples + half).astype(int)
        rows = middle + around
        within = (rows >= 0) & (rows < waveform.samples)
        turned = a * unit_phasor(waveform.f0 * delay) if waveform.is_iq else a
        r[np.where(within, rows, waveform.samples), pulse] += turned * shape(rows * step - tau)
    return r[: waveform.samples]


def _long_pulses(paths: Paths, waveform: Impulse, half: int) -> Profiles:
    """Range profiles r [samples, M] of pulses that are longer than the axis.

    Args:
        paths: Paths, each pulse added at its delay.
        half: Samples to both sides of its middle at which a pulse is computed.
    """
    step, (first, _) = 2 * waveform.range_step / SPEED_OF_LIGHT, waveform.profile
    rows = np.arange(waveform.samples)[:, None]
    r = np.zeros((rows.size, paths.delay.shape[1]), complex if waveform.is_iq else float)
    shape = waveform.envelope if waveform.is_iq else waveform.pulse
    for delay, a in zip(paths.delay, paths.amplitude, strict=True):
        tau = delay - 2 * first / SPEED_OF_LIGHT
        near = np.abs(rows - np.rint(tau / step)) <= half
        turned = a * unit_phasor(waveform.f0 * delay) if waveform.is_iq else a
        r += np.where(near, turned * shape(rows * step - tau), 0)
    return r


def _spectral(paths: Paths, waveform: Impulse) -> Profiles:
    """Range profiles r [samples, M] from the echo at even frequencies."""
    stepped = waveform.stepped(waveform.profile[1] * LONGEST)
    return _sum_over_frequencies(beat_of(paths, stepped), waveform)


def _sum_over_frequencies(echo: Complex, waveform: Impulse) -> Profiles:
    """Range profiles r [samples, M] of an echo S [N, M] at the frequencies of `stepped`."""
    f = waveform.stepped(waveform.profile[1] * LONGEST).frequencies()
    t = 2 * waveform.range_axis() / SPEED_OF_LIGHT
    mixed_by = waveform.f0 if waveform.is_iq else 0.0
    back = np.exp(2j * np.pi * np.outer(t, f - mixed_by)) * (waveform.spectrum(f) * (f[1] - f[0]))
    r: Complex = back @ echo
    return r if waveform.is_iq else r.real
