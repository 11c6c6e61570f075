"""The coarsest knots that resolve a motion: where every look at a recording begins."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from radhar_cli.echo.knots import CHUNK_KNOTS, Knots, all_knots, knots_of
from radhar_cli.echo.paths import PathSource
from radhar_cli.radar.waveform import Waveform

PER_SECOND, PER_CYCLE, LEAST = 40.0, 40, 64
# Fewer pulses from knot to knot are not worth interpolating.
LEAST_STEP = 3
# An amplitude that changes by more from knot to knot is not resolved.
MOST_FOLD = 0.2


class Motion(NamedTuple):
    """How far things move from one knot to the next, at most.

    Attributes:
        fold: relative change of an amplitude.
        turn: turning of the fastest component of G, cycles.
    """

    fold: float
    turn: float


class CoarseKnots(NamedTuple):
    """Knots that resolve a motion.

    Attributes:
        source, waveform: whose they are.
        step: pulses from knot to knot; 1 where nothing is interpolated.
        motion: from knot to knot.
        kept: the knots, where one chunk of them is all.
    """

    source: PathSource
    waveform: Waveform
    step: int
    motion: Motion
    kept: Knots | None

    def chunks(self) -> Iterator[Knots]:
        """The knots of the whole recording."""
        if self.kept is not None:
            yield self.kept
        else:
            yield from all_knots(self.source, self.waveform, self.step)

    def mean_power(self) -> float:
        """Mean over the pulses of the power that the SNR refers to."""
        total = sum(
            float(knots.dense(knots.paths.power, knots.exact.power).sum())
            for knots in self.chunks()
        )
        return total / self.waveform.n_pulses


def coarse_knots(source: PathSource, waveform: Waveform) -> CoarseKnots:
    """Look for the coarsest knots, from 40 a second, 40 a cycle and 64 a recording on."""
    rate = max(PER_SECOND, PER_CYCLE * source.highest_frequency)
    step = min(int(waveform.prf // rate), waveform.n_pulses // LEAST)
    while source.smooth and step >= LEAST_STEP:
        seen, kept, count = Motion(0.0, 0.0), None, 0
        for knots in all_knots(source, waveform, step):
            seen = Motion(*np.maximum(seen, _motion(knots, waveform)).tolist())
            kept, count = (knots if count == 0 else None), count + 1
        if seen.fold <= MOST_FOLD:
            return CoarseKnots(source, waveform, step, seen, kept)
        step = min(step - 1, int(step * MOST_FOLD / seen.fold))
    return every_pulse(source, waveform)


def every_pulse(source: PathSource, waveform: Waveform) -> CoarseKnots:
    """Paths at every pulse, kept where they are few enough."""
    few = waveform.n_pulses <= CHUNK_KNOTS
    kept = knots_of(source, waveform, 1, (0, waveform.n_pulses)) if few else None
    return CoarseKnots(source, waveform, 1, Motion(0.0, 0.0), kept)


def _motion(knots: Knots, w: Waveform) -> Motion:
    a = knots.paths.amplitude
    least = np.minimum(a[:, 1:], a[:, :-1])
    change = np.abs(np.diff(a, axis=1)) / np.where(least > 0, least, np.inf)
    reach = max(w.n_adc - w.n0, w.n0) / w.adc_rate * w.slope
    turn = reach * np.abs(np.diff(knots.paths.delay, axis=1))
    return Motion(float(change.max(initial=0.0)), float(turn.max(initial=0.0)))
