"""What each shortcut of the direct engine costs in accuracy, read off the paths themselves.

Norms are root mean squares over the pulses. Errors of different paths are added as norms
(Minkowski), so that nothing counts on their interference. x is the signal after MTI, y before; the
MTI divides an error of y by what it leaves of y. docs/engines.md derives the bounds.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import sqrt
from typing import NamedTuple

import numpy as np
import scipy.fft

from radhar_cli.arrays import Complex, Float
from radhar_cli.echo.beat import start_phase
from radhar_cli.echo.half_band_sum import HalfBandTable, weights
from radhar_cli.echo.interpolation import TAPS
from radhar_cli.echo.knots import Knots, Neighbours
from radhar_cli.echo.paths import Paths
from radhar_cli.phasor import unit_phasor
from radhar_cli.radar.waveform import Waveform

# Root mean square over a segment of the six-point Lagrange remainder and of its slope, in sixth
# differences. The first difference of a smooth piece stands for two more segments, whose shifted
# stencils err by 2 and 28 times as much, squared; so does the last.
VALUE, SLOPE, EDGE = 0.0035, 0.011, 30.0
# Largest error of a cubic Hermite cell and of its slope: in fourth derivatives times the cell to
# the powers 4 and 3.
HERMITE_VALUE, HERMITE_SLOPE = 1 / 384, sqrt(3) / 216
# A float32 angle of up to pi, its sine, an envelope and a sum; the same in double precision, where
# the phase is that of the whole delay.
SINGLE, DOUBLE = 1.5e-7, 4e-16
# Cycles a knot up to which sixth differences see a component of G.
MOST_TURN = 0.25
OVERSAMPLINGS = np.array([1, *(n * 2**k for k in range(10) for n in (2, 3))])
_GRID = 8
_MIDDLE = slice(TAPS // 2, -(TAPS // 2))


@dataclass
class Sums:
    """Sums over pulses of what the bounds are made of; those of two looks add.

    Attributes:
        pulses: how many they stand for.
        signal: of |x|^2.
        envelope: of |B_i|^2 [I], B = A G.
        table: of what the errors of tables are made of, squared [I, 3]: G's fourth derivative times
            what the MTI leaves of a path with a constant G; times A; times A and how far u moves
            in a pulse.
        largest: amplitude.
    """

    pulses: float
    signal: float
    envelope: Float
    table: Float
    largest: float

    def __add__(self, other: "Sums") -> "Sums":
        return Sums(
            self.pulses + other.pulses,
            self.signal + other.signal,
            self.envelope + other.envelope,
            self.table + other.table,
            max(self.largest, other.largest),
        )


def sums(seen: Neighbours, table: HalfBandTable, scale: float) -> Sums:
    """Sums over some pulses.

    Args:
        seen: the paths there and at the pulse after each.
        table: of G, to look with.
        scale: that amplitudes are divided by.
    """
    w, now, after = table.waveform, seen.now, seen.after
    b, b_after = envelope(now, table, scale), envelope(after, table, scale)
    here, there = (unit_phasor(start_phase(paths.delay, w, w.f0)) for paths in (now, after))
    x = (b_after * there - b * here)[~seen.still].sum(axis=0)
    left = np.abs(after.amplitude * there - now.amplitude * here) / scale
    return Sums(
        pulses=float(seen.weight.sum()),
        signal=float(seen.weight @ (x.real**2 + x.imag**2)),
        envelope=(b.real**2 + b.imag**2) @ seen.weight,
        table=_table_parts(seen, left, scale, w),
        largest=float(np.maximum(now.amplitude, after.amplitude).max(initial=0.0)),
    )


@dataclass(frozen=True)
class Bounds:
    """Bounds of the root-mean-square error of x, and x itself.

    Attributes:
        signal: root mean square of x.
        table: G read from a table, for each of OVERSAMPLINGS.
        single: sines and cosines in float32.
        double: in float64, in which the cube errs as much.
    """

    signal: float
    table: Float
    single: float
    double: float


def bounds(total: Sums, waveform: Waveform, cycles: float, moving: Float) -> Bounds:
    """Turn sums into bounds.

    Args:
        total: over the whole recording.
        waveform: the radar.
        cycles: longest path in cycles of f0.
        moving: 1 for paths that change [I], 0 for those that cancel in the MTI.
    """
    b = np.sqrt(total.envelope / total.pulses)
    return Bounds(
        signal=sqrt(total.signal / total.pulses),
        table=_table_errors(moving @ np.sqrt(total.table / total.pulses), waveform),
        # Rounding is independent from pulse to pulse and from path to path.
        single=SINGLE * sqrt(2) * float(np.linalg.norm(moving * b)),
        double=DOUBLE * sqrt(2) * (2 * np.pi * cycles + 8) * float(b.sum()),
    )


class Interpolation(NamedTuple):
    """Weighted sums over knots [I] of squared interpolation errors, and the sum of the weights."""

    squares: Float
    weight: float

    @property
    def error(self) -> Float:
        """Root mean square [I]."""
        mean: Float = self.squares / max(self.weight, 1.0)
        return np.sqrt(mean)


def delay_errors(
    knots: Knots, b: Complex, kinks: tuple[float, ...], waveform: Waveform, mti: bool
) -> Interpolation:
    """Errors of delay and amplitude alone: what the knots would do to a path with a constant G."""
    a = knots.paths.amplitude
    relative = np.divide(np.abs(b), a, out=np.zeros_like(a), where=a > 0)[:, _MIDDLE]
    error = relative * np.abs(np.diff(a, TAPS, axis=1))
    return _interpolation(knots, b, error, kinks, waveform, mti)


def interpolation_errors(
    knots: Knots, b: Complex, kinks: tuple[float, ...], waveform: Waveform, mti: bool
) -> Interpolation:
    """Errors of delay and envelope.

    Args:
        knots, b: the paths and their envelopes A G [I, K] there.
        kinks: instants that no difference may reach across, s.
        waveform: the radar.
        mti: whether the error counts after MTI.
    """
    return _interpolation(knots, b, np.abs(np.diff(b, TAPS, axis=1)), kinks, waveform, mti)


def _interpolation(
    knots: Knots,
    b: Complex,
    error: Float,
    kinks: tuple[float, ...],
    waveform: Waveform,
    mti: bool,
) -> Interpolation:
    """Add the error of the delay as a phase of B; each times what the MTI does to it.

    An error stays with a carrier that turns from pulse to pulse, and changes itself.
    """
    delay = knots.paths.delay
    rate = 2 * np.pi * waveform.f0
    if waveform.residual_video_phase:
        rate += 2 * np.pi * waveform.slope * float(delay.max())
    total = error + rate * np.abs(b[:, _MIDDLE]) * np.abs(np.diff(delay, TAPS, axis=1))
    if mti:
        turned = rate / (2 * knots.step) * np.abs(delay[:, 4:-2] - delay[:, 2:-4])
        total *= VALUE * np.minimum(turned, 2.0) + SLOPE / knots.step
    else:
        total *= VALUE
    weight = _weights(knots.times, kinks)
    return Interpolation(np.asarray(total**2 @ weight), float(weight.sum()))


def envelope(paths: Paths, table: HalfBandTable, scale: float) -> Complex:
    """B = A G [I, M] over the scale."""
    w = table.waveform
    b: Complex = table(w.slope / w.adc_rate * paths.delay)
    b *= paths.amplitude / scale
    return b


def _table_parts(seen: Neighbours, left: Float, scale: float, w: Waveform) -> Float:
    """What `_table_errors` is made of, squared and summed over the pulses [I, 3]."""
    now, after, weight = seen
    per_delay = w.slope / w.adc_rate
    fourth = _near(_fourth_derivatives(w), per_delay * now.delay)
    at_rest = fourth * (np.maximum(now.amplitude, after.amplitude) / scale)
    moved = at_rest * (per_delay * np.abs(after.delay - now.delay))
    return np.stack([part**2 @ weight for part in (fourth * left, at_rest, moved)], axis=1)


def _table_errors(parts: Float, w: Waveform) -> Float:
    """Bounds [OVERSAMPLINGS] of the error of x that tables make, from `_table_parts` as norms [3].

    The error of a cell times what the MTI leaves of the carrier, and its own change from pulse to
    pulse: its slope times the way, and at most twice the error.
    """
    left, at_rest, moved = parts
    cell = 1 / (OVERSAMPLINGS * w.n_adc)
    value, slope = HERMITE_VALUE * cell**4, HERMITE_SLOPE * cell**3
    error: Float = value * left + np.minimum(slope * moved, 2 * value * at_rest)
    return error


def _near(values: Float, u: Float) -> Float:
    """The value of a function of period 1 on a grid, at the point nearest to u."""
    place = np.rint((u - np.floor(u)) * values.size).astype(np.intp) % values.size
    found: Float = values[place]
    return found


@lru_cache(maxsize=4)
def _fourth_derivatives(w: Waveform) -> Float:
    """|d^4 G/du^4| over a period, each value the largest within a fast-time sample of it."""
    from scipy.ndimage import maximum_filter1d

    n = np.arange(w.n_adc) - w.n0
    values = np.abs(scipy.fft.fft(weights(w) * (2 * np.pi * n) ** 4, _GRID * w.n_adc))
    largest: Float = maximum_filter1d(values, 2 * _GRID + 1, mode="wrap")
    return largest


def _weights(times: Float, kinks: tuple[float, ...]) -> Float:
    """Weight of each sixth difference: 0 across a kink, more at the ends of smooth pieces."""
    piece = np.searchsorted(kinks, times, side="right")
    first, last = piece[:-TAPS], piece[TAPS:]
    within = first == last
    weight: Float = within.astype(float)
    weight[within & (np.diff(first, prepend=first[0]) > 0)] += EDGE
    weight[within & (np.diff(last, append=last[-1]) > 0)] += EDGE
    return weight
