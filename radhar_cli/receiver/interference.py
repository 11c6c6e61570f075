"""Interference at fixed Doppler frequencies: lines from end to end of a map, or in parts of it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from radhar_cli.arrays import Complex, Float, Index
from radhar_cli.phasor import unit_phasor
from radhar_cli.processing.look import Look
from radhar_cli.radar.waveform import Waveform
from radhar_cli.receiver.impairment import Impairment

BATCH = 256  # switching times drawn at once


@dataclass(frozen=True)
class Line(Impairment):
    """i[n, m] = a c[n] exp(j 2 pi f m/PRF), |c[n]| = 1 of random phase, the same in all pulses.

    So a line, such as a power supply's, lies at all ranges, in each bin with another strength. A
    real one, 2 a c[n] cos(2 pi f m/PRF), is as strong at -f.
    """

    amplitude: float  # a, of a raw sample
    frequency: float  # f, Hz; beyond PRF/2 it aliases
    waveform: Waveform  # the radar
    stream: Callable[[str], np.random.Generator]  # makes the random stream of a name
    name: str  # of the line
    # on, off: mean times for which it is there and is not, s; always there where off is 0
    on: float = 1.0
    off: float = 0.0
    real: bool = False  # whether it is on both sides of zero

    @cached_property
    def code(self) -> Complex:
        """a c[n] [N_ADC]."""
        turns: Float = self.stream(self.name).random(self.waveform.n_adc)
        code: Complex = self.amplitude * np.exp(2j * np.pi * turns)
        return code

    def tone(self, pulses: Index) -> Complex:
        """exp(j 2 pi f m/PRF) of pulse numbers, or twice its real part."""
        tone: Complex = unit_phasor(-np.mod(pulses * (self.frequency / self.waveform.prf), 1))
        if self.real:
            tone += tone.conj()
        if self.off == 0:
            return tone
        passed = np.searchsorted(self.switches, pulses / self.waveform.prf, side="right")
        tone *= passed % 2
        return tone

    @cached_property
    def switches(self) -> Float:
        """When the line goes on, off, on and so on, s: exponential times, from the stationary
        state at 0 s. The first is -inf of a line that is there then."""
        rng, at, times = self.stream(f"{self.name} times"), 0.0, [np.empty(0)]
        already = rng.random() * (self.on + self.off) < self.on
        means = np.tile([self.off, self.on], BATCH)[already:][: 2 * BATCH - 2]
        while at <= self.waveform.n_pulses / self.waveform.prf:
            times.append(at + np.cumsum(rng.exponential(means)))
            at = float(times[-1][-1])
        return np.concatenate([[-np.inf] if already else [], *times])

    def apply(self, x: Complex, look: Look) -> Complex:
        """x + W c[n] times the tone, seen after the canceller."""
        return x + look.fast(self.code[:, None]) * look.taken(self.tone)
