"""Paths at knots, from which those at all other pulses are interpolated."""

from collections.abc import Callable, Iterator
from functools import lru_cache
from math import inf
from typing import NamedTuple

import numpy as np

from radhar_cli.echo.interpolation import (
    AFTER,
    BEFORE,
    NO_STENCIL,
    REACH,
    SHIFTED_BY,
    TAPS,
    lagrange_weights,
    shifts,
    stencils,
    upsample,
)
from radhar_cli.echo.paths import Paths, PathSource
from radhar_cli.numerics.arrays import Bool, Float, Index
from radhar_cli.radar.fmcw import Waveform

CHUNK_KNOTS, BLOCK = 32768, 2**15
MIN_KNOTS = 64  # per recording
COMPARED = 64  # of many paths some are compared from knot to knot: neighbours move alike
PROJECTIONS = 4  # sums of paths with random signs, whose curvature stands for that of all
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
        return self.paths if self.step == 1 else self.paths.at_times(slice(BEFORE, -AFTER))

    def moving(self, since: Paths) -> Bool:
        """Whether paths [I] differ at any pulse from the first column of `since`."""
        return _differ(self.at_pulses, since) | _differ(self.exact, since)

    def power(self) -> float:
        """Sum of A_i^2 over paths and pulses."""
        amplitude, exact = self.paths.amplitude, self.exact.amplitude
        powers, exact_powers = (np.einsum("im,im->m", a, a) for a in (amplitude, exact))
        if self.step == 1:
            return float(powers.sum())
        last = self.pulses[1] - self.pulses[0] - (self.shift.size - 1) * self.step
        weights = lagrange_weights(self.step)
        around = stencils(powers, self.shift)
        sums = weights.sum(axis=1) @ around
        sums[-1] = weights[:, :last].sum(axis=1) @ around[:, -1]
        return float(sums[self.shift != NO_STENCIL].sum() + exact_powers.sum())

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
    """Density of the knots that an accuracy needs.

    There are `per_second`, or more, so that from one to the next an amplitude changes by at most
    `amplitude_change` of itself, or of its usual size where it passes zero, and G's fastest
    component by at most `phase_change` cycles.
    """

    per_second: float
    amplitude_change: float
    phase_change: float


class Roughness(NamedTuple):
    """Squared error of interpolation in each segment of pulses."""

    step: int  # number of pulses of a segment
    squares: Float  # up to a factor [segments]; empty where nothing is interpolated


EVEN = Roughness(1, np.empty(0))
# By how much squared errors grow where a stencil is shifted; segments with NO_STENCIL have none.
_SQUARES_BY = np.zeros(NO_STENCIL + 1)
_SQUARES_BY[: REACH + 1] = np.square(SHIFTED_BY)


class PathsAtKnots(NamedTuple):
    """Knots that resolve the motion of a recording, and the motion that they show."""

    step: int  # pulses from knot to knot; 1 where nothing is interpolated
    moving: Bool  # which paths change at all [I]
    power: float  # mean over the pulses of sum_i A_i^2
    largest: float  # amplitude
    chunk: Knots | None  # the knots, where one chunk of them is all
    roughness: Roughness  # where interpolation is likely to err

    def knots(self, source: PathSource, waveform: Waveform) -> Iterator[Knots]:
        """The knots of the whole recording."""
        return iter([self.chunk]) if self.chunk else all_knots(source, waveform, self.step)

    def at_pulses(self, source: PathSource, waveform: Waveform) -> Callable[[Float], Paths]:
        """The source at times of pulses; where all of them are kept, they are looked up."""
        if self.step > 1 or self.chunk is None:
            return source
        paths = self.chunk.paths
        return lambda t: paths.at_times(np.rint(t * waveform.prf).astype(np.intp))


def resolve(
    source: PathSource, waveform: Waveform, spacing: Spacing, least: int = MIN_STEP
) -> PathsAtKnots:
    """Place knots that resolve the motion of a source.

    They are as far apart as the spacing allows, and `least` pulses or at all of them.
    """
    step = widest_step(waveform, spacing.per_second)
    while True:
        step = step if source.smooth and step >= least else 1
        first, chunk, moving, power, largest = None, None, np.zeros(1, bool), 0.0, 0.0
        squares: list[Float] = [EVEN.squares]
        for knots in all_knots(source, waveform, step):
            if step > 1 and (excess := _excess(knots.paths, waveform, spacing)) > 1:
                step = min(step - 1, int(step / excess))
                break
            first, chunk = first or knots.at_pulses, None if first else knots
            moving = moving | knots.moving(first)
            power += knots.power()
            largest = max(largest, float(knots.paths.amplitude.max(initial=0.0)))
            if step > 1:
                squares.append(_rough_squares(knots, waveform))
        else:
            mean = power / waveform.n_pulses
            roughness = Roughness(step, np.concatenate(squares))
            return PathsAtKnots(step, moving, mean, largest, chunk, roughness)


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
    """The largest change from one knot to the next, over the change that the spacing allows."""
    moved, least, every = 0.0, 1.0, max(1, len(paths.delay) // COMPARED)
    rows = every * max(1, BLOCK // paths.delay.shape[1])
    for start in range(0, len(paths.delay), rows):  # so that it stays in the cache
        delay, a = (part[start : start + rows : every] for part in paths[:2])
        delay = np.diff(delay, axis=1)
        moved = max(moved, float(delay.max(initial=0.0)), -float(delay.min(initial=0.0)))
        least = min(least, _least_left(a))
    return max(
        (1 - least) / spacing.amplitude_change, _fastest_cycles(w) * moved / spacing.phase_change
    )


def _least_left(a: Float) -> float:
    """Least fraction of amplitudes [I, knots] that is left from one knot to the next.

    Of those that pass zero changes are fractions of their usual size: a zero passed smoothly is no
    edge, however large the relative change.
    """
    least, low, high = 1.0, a.min(axis=1), a.max(axis=1)
    size = np.sqrt(np.einsum("im,im->i", a, a) / a.shape[1])
    through_zero = (low < NEAR_ZERO * size) & (high > -NEAR_ZERO * size)
    if through_zero.any():
        crossing, floor = np.abs(a[through_zero]), SMALL * size[through_zero, None]
        largest = np.maximum(np.maximum(crossing[:, 1:], crossing[:, :-1]), floor)
        change = np.abs(np.diff(a[through_zero], axis=1)) / largest
        least = 1 - float(change.max(initial=0.0))
    away = ~through_zero & (size > 0)
    a = a if away.all() else a[away]
    ratio = a[:, 1:] / a[:, :-1]
    return min(least, float(ratio.min(initial=1.0)), 1 / float(ratio.max(initial=1.0)))


def _rough_squares(knots: Knots, w: Waveform) -> Float:
    """Estimate the squared error of interpolation in each segment [segments], up to a factor.

    Six-point interpolation errs by 5/1024 of the sixth differences of 2 pi f0 tau A and of A. Those
    of the paths add with the phases of the paths; here they add with PROJECTIONS random signs.
    Those across a breakpoint do not count; where the stencil is shifted, the error is as much
    larger as `upsample` says.
    """
    delay, amplitude = knots.paths[:2]
    size = np.sqrt(np.einsum("im,im->i", amplitude, amplitude) / amplitude.shape[1])
    of_delay, of_amplitude = _signs(len(delay))
    mixed = (of_delay * (2 * np.pi * w.f0 * size)) @ delay + of_amplitude @ amplitude
    differences = np.diff(mixed, TAPS, axis=1)
    squares: Float = np.einsum("pm,pm->m", differences, differences)
    special = np.flatnonzero(knots.shift)  # segments beside a breakpoint, or that hold one
    broken = special[knots.shift[special] == NO_STENCIL]
    for before in range(TAPS):
        squares[(broken + BEFORE - before).clip(0, squares.size - 1)] = 0.0
    # Higher differences matter where a limb passes something within few knots: each counts for
    # its neighbours, too.
    squares = np.convolve(squares, (1.0, 1.0, 1.0), "same")
    first, count = BEFORE - REACH - 1, knots.shift.size
    largest: Float = np.maximum(
        squares[first : first + count], squares[first + 1 : first + 1 + count]
    )
    shift = knots.shift[special]
    around = special + np.where(shift == NO_STENCIL, 0, shift) + first
    pair = squares[around.clip(0)], squares[(around + 1).clip(max=squares.size - 1)]
    largest[special] = np.maximum(*pair) * _SQUARES_BY[np.abs(shift)]
    return largest


@lru_cache(maxsize=16)
def _signs(count: int) -> tuple[Float, Float]:
    """Random signs of delays and of amplitudes of `count` paths [PROJECTIONS, count] each."""
    words = np.random.SeedSequence(0).generate_state(2 * PROJECTIONS * count)
    delay, amplitude = 1.0 - 2.0 * (words & 1).reshape(2, PROJECTIONS, count)
    return delay, amplitude


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
        return Knots(1, pulses, paths, nowhere, nowhere, paths.at_times(slice(0, 0)))
    segments = -(-(last - first) // step)
    pulse = first + (np.arange(BEFORE + segments + AFTER) - BEFORE) * step
    t = waveform.times(pulse.astype(float))
    shift = shifts(t, source.breakpoints)
    exact = (first + np.flatnonzero(shift == NO_STENCIL)[:, None] * step + np.arange(step)).ravel()
    exact = exact[exact < last]
    both = source(np.concatenate([t, waveform.times(exact.astype(float))]))
    knots, exact_paths = both.at_times(slice(t.size)), both.at_times(slice(t.size, None))
    return Knots(step, pulses, knots, shift, exact, exact_paths)


def all_knots(source: PathSource, waveform: Waveform, step: int) -> Iterator[Knots]:
    """Knots for the whole recording, in chunks that bound the memory."""
    length, count = CHUNK_KNOTS * step, waveform.n_pulses
    for first in range(0, count, length):
        yield knots_of(source, waveform, step, (first, min(first + length, count)))


def select_paths(source: Callable[[Float], Paths], chosen: Bool) -> Callable[[Float], Paths]:
    """Make a source of the chosen paths [I] of another."""
    return lambda t: source(t).only(chosen)


def _differ(paths: Paths, since: Paths) -> Bool:
    """Whether paths [I] differ at any time from the first column of `since`."""
    few = slice(None, None, max(1, paths.delay.shape[1] // 16))
    differs: Bool = np.zeros(len(paths.delay), bool)
    for part, first in zip(paths[:2], since[:2], strict=True):
        for times in few, slice(None):
            same = np.flatnonzero(~differs)
            differs[same] = (part[same, times] != first[same, :1]).any(axis=1)
    return differs
