"""Interference at fixed Doppler frequencies: lines from end to end of a map, or in parts of it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.numerics.phasor import unit_phasor
from radhar_cli.processing.look import Look
from radhar_cli.radar.fmcw import Waveform

BATCH = 256  # switching times drawn at once


@dataclass(frozen=True)
class InterferenceLine(Impairment):
    """Tone i[n, m] = a c[n] exp(j 2 pi f m/PRF), |c[n]| = 1 of random phase, the same each pulse.

    So a line, such as a power supply's, lies at all ranges, in each bin with another strength. A
    real one, 2 a c[n] cos(2 pi f m/PRF), is as strong at -f.
    """

    amplitude: float  # a in a raw sample
    frequency: float  # f, Hz; beyond PRF/2 it aliases
    waveform: Waveform  # the radar
    stream: Callable[[str], np.random.Generator]  # makes the random stream of a name
    name: str  # name of the line
    mean_on_s: float = 1.0  # mean time for which it is on, s
    mean_off_s: float = 0.0  # mean time for which it is off, s; 0 if it is always on
    real: bool = False  # whether it is on both sides of zero

    @cached_property
    def code(self) -> Complex:
        """Amplitude and phase a c[n] [N_ADC] of a pulse."""
        turns: Float = self.stream(self.name).random(self.waveform.raw_samples)
        code: Complex = self.amplitude * np.exp(2j * np.pi * turns)
        return code

    def tone(self, pulses: Index) -> Complex:
        """Tone exp(j 2 pi f m/PRF), or twice its real part, at pulses m; 0 while it is off."""
        tone: Complex = unit_phasor(-np.mod(pulses * (self.frequency / self.waveform.prf), 1))
        if self.real:
            tone += tone.conj()
        if self.mean_off_s == 0:
            return tone
        passed = np.searchsorted(self.switches, pulses / self.waveform.prf, side="right")
        tone *= passed % 2
        return tone

    @cached_property
    def switches(self) -> Float:
        """Times (s) at which the line goes on, off, on and so on.

        Intervals are exponential, the state at 0 s is the stationary one. The first time is -inf
        for a line that is on then.
        """
        rng, last = self.stream(f"{self.name} times"), 0.0
        times = [np.empty(0)]
        starts_on = rng.random() * (self.mean_on_s + self.mean_off_s) < self.mean_on_s
        means = np.tile([self.mean_off_s, self.mean_on_s], BATCH)[starts_on:][: 2 * BATCH - 2]
        while last <= self.waveform.n_pulses / self.waveform.prf:
            times.append(last + np.cumsum(rng.exponential(means)))
            last = float(times[-1][-1])
        return np.concatenate([[-np.inf] if starts_on else [], *times])

    def apply(self, x: Complex, look: Look) -> Complex:
        """Add the line to x [K, M]: W c[n] times the tone, after the canceller."""
        return x + look.fast(self.code[:, None]) * look.after_taps(self.tone)
