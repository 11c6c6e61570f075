"""Paths at knots, from which those at all other pulses are interpolated."""

from collections.abc import Callable, Iterator
from math import inf
from typing import NamedTuple

import numpy as np

from radhar_cli.echo.interpolation import (
    AFTER,
    BEFORE,
    EXACT,
    REACH,
    SHIFTED_BY,
    TAPS,
    shifts,
    upsample,
)
from radhar_cli.echo.paths import Paths, PathSource
from radhar_cli.numerics.arrays import Bool, Float, Index
from radhar_cli.radar.waveform import Waveform

CHUNK_KNOTS, BLOCK = 32768, 2**15
MIN_KNOTS = 64  # per recording
SEEN = 64  # of many paths some are compared from knot to knot: neighbours move alike
POWER_CHANGE = 0.1  # of amplitudes from knot to knot, where the mean power is all that is asked for
# Of an amplitude, relative to its root mean square: below which it passes zero, as that of a bounce
# at Brewster's angle; and of which its changes are then fractions at least.
NEAR_ZERO, SMALL = 1e-4, 0.3
MIN_STEP = 3  # fewer pulses from knot to knot are not worth interpolating


class Knots(NamedTuple):
    """Paths every `step` pulses, and exactly in the segments that hold a breakpoint."""

    step: int  # pulses from knot to knot; 1 where paths are taken at every pulse
    pulses: tuple[int, int]  # first and last + 1 of the pulses that they are for
    paths: Paths  # at the knots [I, BEFORE + segments + AFTER], or at the pulses for step 1
    shift: Index  # of the stencil of every segment
    exact_pulses: Index  # those of the segments that cannot be interpolated
    exact: Paths  # paths there

    @property
    def at_pulses(self) -> Paths:
        """The paths at those knots that are pulses: the first of every segment."""
        return self.paths if self.step == 1 else columns(self.paths, slice(BEFORE, -AFTER))

    def moving(self, since: Paths) -> Bool:
        """Whether paths [I] differ at any pulse from the first column of `since`."""
        return _differ(self.at_pulses, since) | _differ(self.exact, since)

    def power(self) -> float:
        """Sum of A_i^2 over paths and pulses."""
        at, exact = self.paths.amplitude, self.exact.amplitude
        powers = np.einsum("im,im->m", at, at), np.einsum("im,im->m", exact, exact)
        return float(self.interpolated(*powers).sum())

    def interpolated(self, at_knots: Float, exact: Float) -> Float:
        """Interpolate a quantity to all the pulses [M].

        Args:
            at_knots: Its values at the knots.
            exact: Its values at `exact_pulses`.
        """
        if self.step == 1:
            return at_knots
        first, last = self.pulses
        values = upsample(at_knots, self.step, self.shift)[: last - first]
        values[self.exact_pulses - first] = exact
        return values


class Spacing(NamedTuple):
    """How close knots must be: `per_second`, and so close that from one to the next an amplitude
    changes by at most `amplitude_change` of itself, or of its usual size where it passes zero, and
    G's fastest component by at most `phase_change` cycles."""

    per_second: float
    amplitude_change: float
    phase_change: float


class PathsAtKnots(NamedTuple):
    """Knots that resolve the motion of a recording, and what they show."""

    step: int  # pulses from knot to knot; 1 where nothing is interpolated
    moving: Bool  # which paths change at all [I]
    power: float  # mean over the pulses of sum_i A_i^2
    largest: float  # amplitude
    kept: Knots | None  # the knots, where one chunk of them is all
    # how large the squared error of interpolation is in each segment, up to a factor; empty where
    # nothing is interpolated
    roughness: Float

    def knots(self, source: PathSource, waveform: Waveform) -> Iterator[Knots]:
        """The knots of the whole recording."""
        return iter([self.kept]) if self.kept else all_knots(source, waveform, self.step)

    @property
    def likely_error(self) -> Float:
        """How large the squared error is at each pulse, up to a factor; empty where it is even."""
        return np.repeat(self.roughness, self.step)

    def at_pulses(self, source: PathSource, waveform: Waveform) -> Callable[[Float], Paths]:
        """The source at times of pulses; where all of them are kept, they are looked up."""
        if self.step > 1 or self.kept is None:
            return source
        paths = self.kept.paths
        return lambda t: columns(paths, np.rint(t * waveform.prf).astype(np.intp))


def resolve(
    source: PathSource, waveform: Waveform, spacing: Spacing, least: int = MIN_STEP
) -> PathsAtKnots:
    """Place knots that resolve the motion of a source: as far apart as the spacing allows, and
    `least` pulses or at all of them."""
    step = widest_step(waveform, spacing.per_second)
    while True:
        step = step if source.smooth and step >= least else 1
        first, kept, moving, power, largest = None, None, np.zeros(1, bool), 0.0, 0.0
        rough: list[Float] = [np.empty(0)]
        for knots in all_knots(source, waveform, step):
            if step > 1 and (excess := _excess(knots.paths, waveform, spacing)) > 1:
                step = min(step - 1, int(step / excess))
                break
            first, kept = first or knots.at_pulses, None if first else knots
            moving = moving | knots.moving(first)
            power += knots.power()
            largest = max(largest, float(knots.paths.amplitude.max(initial=0.0)))
            if step > 1:
                rough.append(_roughness(knots, waveform))
        else:
            mean = power / waveform.n_pulses
            return PathsAtKnots(step, moving, mean, largest, kept, np.concatenate(rough))


def widest_step(waveform: Waveform, per_second: float) -> int:
    """Largest number of pulses from knot to knot for `per_second` knots, and MIN_KNOTS in all."""
    return int(min(waveform.prf // per_second, waveform.n_pulses // MIN_KNOTS))


def delay_track(source: PathSource, waveform: Waveform, per_second: float) -> Float:
    """Delay [M] (s) of the one path of a source at every pulse, by way of knots."""
    step = widest_step(waveform, per_second)
    step = step if source.smooth and step >= MIN_STEP else 1
    parts = (
        knots.interpolated(knots.paths.delay[0], knots.exact.delay[0])
        for knots in all_knots(source, waveform, step)
    )
    return np.concatenate(list(parts))


def mean_power(source: PathSource, waveform: Waveform, per_second: float) -> float:
    """Mean P_s over the pulses of sum_i A_i^2, by way of knots."""
    return resolve(source, waveform, Spacing(per_second, POWER_CHANGE, inf)).power


def _excess(paths: Paths, w: Waveform, spacing: Spacing) -> float:
    """The largest change from one knot to the next, in units of what the spacing allows."""
    moved, least, few = 0.0, 1.0, max(1, len(paths.delay) // SEEN)
    rows = few * max(1, BLOCK // paths.delay.shape[1])
    for start in range(0, len(paths.delay), rows):  # so that it stays in the cache
        delay, a = (part[start : start + rows : few] for part in paths[:2])
        delay = np.diff(delay, axis=1)
        moved = max(moved, float(delay.max(initial=0.0)), -float(delay.min(initial=0.0)))
        size = np.sqrt(np.mean(a * a, axis=1))
        through_zero = np.abs(a).min(axis=1, initial=inf) < NEAR_ZERO * size
        through_zero |= (a < 0).any(axis=1) & (a > 0).any(axis=1)
        if through_zero.any():
            # A zero passed smoothly is no edge, however large the relative change.
            some, floor = np.abs(a[through_zero]), SMALL * size[through_zero, None]
            largest = np.maximum(np.maximum(some[:, 1:], some[:, :-1]), floor)
            change = np.abs(np.diff(a[through_zero], axis=1)) / largest
            least = min(least, 1 - float(change.max(initial=0.0)))
            a = a[~through_zero]
        with np.errstate(invalid="ignore"):  # 0/0 is no change
            kept = np.minimum(a[:, 1:], a[:, :-1]) / np.maximum(a[:, 1:], a[:, :-1])
        least = float(np.fmin.reduce(kept, axis=None, initial=least))
    return max(
        (1 - least) / spacing.amplitude_change, _fastest_cycles(w) * moved / spacing.phase_change
    )


def _roughness(knots: Knots, w: Waveform) -> Float:
    """Sum over the paths of the squared sixth differences of 2 pi f0 tau A and of A [segments].

    Six-point interpolation errs by 5/1024 of them. Those across a breakpoint do not count; where
    the stencil is shifted, the error is as much larger as `upsample` says.
    """
    delay, amplitude = knots.paths.delay, knots.paths.amplitude
    few, count = max(1, len(delay) // SEEN), delay.shape[1] - TAPS
    squares = np.zeros(count)
    rows = few * max(1, BLOCK // delay.shape[1])
    for start in range(0, len(delay), rows):  # so that it stays in the cache
        tau, a = (part[start : start + rows : few] for part in (delay, amplitude))
        phase = 2 * np.pi * w.f0 * np.diff(tau, TAPS, axis=1) * a[:, TAPS // 2 : -TAPS // 2]
        size = np.diff(a, TAPS, axis=1)
        squares += np.einsum("im,im->m", phase, phase) + np.einsum("im,im->m", size, size)
    broken = np.pad(knots.shift == EXACT, (BEFORE, AFTER - 1))
    windows = np.lib.stride_tricks.sliding_window_view(broken, TAPS)
    squares[windows.any(axis=1)] = 0.0
    segment, shift = np.arange(knots.shift.size), np.where(knots.shift == EXACT, 0, knots.shift)
    first = segment + shift + BEFORE - REACH - 1
    largest = np.maximum(squares[first.clip(0)], squares[(first + 1).clip(max=count - 1)])
    rough: Float = largest * np.array(SHIFTED_BY)[np.abs(shift)] ** 2
    rough[knots.shift == EXACT] = 0.0
    return rough


def _fastest_cycles(w: Waveform) -> float:
    """Turns of G's fastest component for a delay, cycles/s."""
    # Referred to mid-chirp, the ends of the chirp, which turn fastest, weigh next to nothing.
    return w.bandwidth / 4 if w.centred else w.bandwidth


def knots_of(source: PathSource, waveform: Waveform, step: int, pulses: tuple[int, int]) -> Knots:
    """Paths for pulses first to last - 1, every `step` of them."""
    first, last = pulses
    nowhere = np.empty(0, dtype=np.intp)
    if step == 1:
        paths = source(waveform.times(np.arange(first, last, dtype=float)))
        return Knots(1, pulses, paths, nowhere, nowhere, columns(paths, slice(0, 0)))
    segments = -(-(last - first) // step)
    at = first + (np.arange(BEFORE + segments + AFTER) - BEFORE) * step
    t = waveform.times(at.astype(float))
    shift = shifts(t, source.breakpoints)
    exact = (first + np.flatnonzero(shift == EXACT)[:, None] * step + np.arange(step)).ravel()
    exact = exact[exact < last]
    both = source(np.concatenate([t, waveform.times(exact.astype(float))]))
    knots, there = columns(both, slice(t.size)), columns(both, slice(t.size, None))
    return Knots(step, pulses, knots, shift, exact, there)


def all_knots(source: PathSource, waveform: Waveform, step: int) -> Iterator[Knots]:
    """Knots for the whole recording, in chunks that bound the memory."""
    length, count = CHUNK_KNOTS * step, waveform.n_pulses
    for first in range(0, count, length):
        yield knots_of(source, waveform, step, (first, min(first + length, count)))


def columns(paths: Paths, some: slice | Index) -> Paths:
    """The paths at some of their times."""
    return paths.only(slice(None), some)


def only(kept: Bool, source: Callable[[Float], Paths]) -> Callable[[Float], Paths]:
    """Source of some of the paths [I] of another."""
    return lambda t: source(t).only(kept)


def _differ(paths: Paths, since: Paths) -> Bool:
    """Whether paths [I] differ at any time from the first column of `since`."""
    few = slice(None, None, max(1, paths.delay.shape[1] // 16))
    differs: Bool = np.zeros(len(paths.delay), bool)
    for part, first in zip(paths[:2], since[:2], strict=True):
        for times in few, slice(None):
            same = np.flatnonzero(~differs)
            differs[same] = (part[same, times] != first[same, :1]).any(axis=1)
    return differs
