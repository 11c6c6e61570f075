"""Paths at some pulses, from which those at all others are interpolated."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from radhar_cli.arrays import Bool, Float, Index
from radhar_cli.echo.interpolation import AFTER, BEFORE, EXACT, after_first, shifts, upsample
from radhar_cli.echo.paths import Paths, PathSource
from radhar_cli.radar.waveform import Waveform

CHUNK_KNOTS = 32768


class Knots(NamedTuple):
    """Paths every `step` pulses, and exactly in the segments that hold a kink.

    Attributes:
        step: pulses from knot to knot; 1 where paths are taken at every pulse.
        pulses: first and last + 1 of the pulses that they are for.
        times: of the knots, s.
        paths: at the knots [I, BEFORE + segments + AFTER], or at the pulses for step 1.
        shift: of the stencil of every segment.
        exact_pulses: those of the segments that cannot be interpolated.
        exact: paths there.
    """

    step: int
    pulses: tuple[int, int]
    times: Float
    paths: Paths
    shift: Index
    exact_pulses: Index
    exact: Paths

    @property
    def at_pulses(self) -> Paths:
        """The paths at those knots that are pulses: the first of every segment."""
        return self.paths if self.step == 1 else columns(self.paths, slice(BEFORE, -AFTER))

    def dense(self, knots: Float, exact: Float) -> Float:
        """Interpolate a quantity of the paths, given at the knots and at the exact pulses."""
        first, last = self.pulses
        if self.step == 1:
            return knots
        values = np.asarray(upsample(knots, self.step, self.shift)[..., : last - first])
        values[..., self.exact_pulses - first] = exact
        return values

    def neighbours(self) -> "Neighbours":
        """Paths at some pulses and at the pulse after each: every knot, every exact pulse."""
        if self.step == 1:
            count = max(self.paths.power.size - 1, 0)
            now, after = slice(None, -1), slice(1, None)
            return Neighbours(columns(self.paths, now), columns(self.paths, after), np.ones(count))
        after_knots = Paths(*(after_first(part, self.step) for part in self.paths))
        still = ~_differ(self.paths, self.paths)  # what is interpolated may differ by an ulp
        after_knots.delay[still] = self.at_pulses.delay[still]
        after_knots.amplitude[still] = self.at_pulses.amplitude[still]
        smooth = np.flatnonzero(self.shift != EXACT)
        pair = np.flatnonzero(np.diff(self.exact_pulses) == 1)
        return Neighbours(
            _joined(columns(self.at_pulses, smooth), columns(self.exact, pair)),
            _joined(columns(after_knots, smooth), columns(self.exact, pair + 1)),
            np.concatenate([np.full(smooth.size, float(self.step)), np.ones(pair.size)]),
        )

    def changes(self, since: Paths) -> Bool:
        """Which paths [I] differ at any pulse seen from the first column of `since`."""
        return _differ(self.at_pulses, since) | _differ(self.exact, since)


class Neighbours(NamedTuple):
    """Paths at some pulses and at the pulse after each.

    Attributes:
        now, after: the paths.
        weight: how many pulses each of them stands for [K].
    """

    now: Paths
    after: Paths
    weight: Float

    def alone(self) -> "Neighbours":
        """The pulses without those after them: what is left where no MTI takes a difference."""
        nothing = np.zeros_like(self.now.amplitude)
        return self._replace(after=self.now._replace(amplitude=nothing))

    @property
    def still(self) -> Bool:
        """Which paths [I] are the same in all of them."""
        return ~(_differ(self.now, self.now) | _differ(self.after, self.now))


def _joined(one: Paths, other: Paths) -> Paths:
    return Paths(*(np.concatenate(parts, axis=-1) for parts in zip(one, other, strict=True)))


def knots_of(source: PathSource, waveform: Waveform, step: int, pulses: tuple[int, int]) -> Knots:
    """Paths for pulses first to last - 1, every `step` of them."""
    first, last = pulses
    nowhere = np.empty(0, dtype=np.intp)
    if step == 1:
        t = waveform.times(np.arange(first, last, dtype=float))
        paths = source(t)
        return Knots(1, pulses, t, paths, nowhere, nowhere, columns(paths, slice(0, 0)))
    segments = -(-(last - first) // step)
    at = first + (np.arange(BEFORE + segments + AFTER) - BEFORE) * step
    t = waveform.times(at.astype(float))
    shift = shifts(t, source.kinks)
    exact = (first + np.flatnonzero(shift == EXACT)[:, None] * step + np.arange(step)).ravel()
    exact = exact[exact < last]
    both = source(np.concatenate([t, waveform.times(exact.astype(float))]))
    knots, there = columns(both, slice(t.size)), columns(both, slice(t.size, None))
    return Knots(step, pulses, t, knots, shift, exact, there)


def all_knots(source: PathSource, waveform: Waveform, step: int) -> Iterator[Knots]:
    """Knots for the whole recording, in chunks that bound the memory."""
    length, count = CHUNK_KNOTS * step, waveform.n_pulses
    for first in range(0, count, length):
        yield knots_of(source, waveform, step, (first, min(first + length, count)))


def columns(paths: Paths, some: slice | Index) -> Paths:
    """The paths at some of their times."""
    return Paths(paths.delay[:, some], paths.amplitude[:, some], paths.power[some])


def _differ(paths: Paths, since: Paths) -> Bool:
    found: Bool = (paths.delay != since.delay[:, :1]).any(axis=1)
    found |= (paths.amplitude != since.amplitude[:, :1]).any(axis=1)
    return found
