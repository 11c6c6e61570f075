"""Settings of the direct engine for an error that is allowed, and the error that they made.

As FINUFFT turns eps into a kernel width, `settings` turns decibels into the spacing of knots, the
size of a table and a precision; `measured_db` then compares the signal with the exact sum at some
pulses.
"""

from collections.abc import Callable
from functools import lru_cache
from math import ceil, inf, isnan, log10, nan
from typing import NamedTuple, TypeVar

import numpy as np

from radhar_cli.echo.beat import BLOCK_SAMPLES
from radhar_cli.echo.exact import beat_at
from radhar_cli.echo.half_band_sum import MAX_CELLS, reference_table
from radhar_cli.echo.knots import EVEN, Roughness, Spacing
from radhar_cli.echo.paths import Paths
from radhar_cli.echo.phase_recurrence import run_length
from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.numerics.phasor import unit_phasor
from radhar_cli.processing.canceller import NO_CANCELLER, Canceller, Fir
from radhar_cli.processing.look import weights
from radhar_cli.radar.fmcw import Waveform

# Six-point interpolation errs by the sixth power of the spacing; this one made -114 dB or less of
# every activity at 77 GHz.
SPACING_DB = -140.0
PER_SECOND, PER_CYCLE, AMPLITUDE_CHANGE, PHASE_CHANGE = 400.0, 200.0, 0.1, 0.05
# Cubic Hermite cells err by the fourth power of their width: -48 dB at 4 a fast-time sample.
TABLE_DB = -48.0
SINGLE_DB = -115.0  # error of the recurrence in float32
STORED_SINGLE_DB = -144.5  # largest rounding of values that are stored in float32: 2^-24 of each
CUBIC_DB = -146.0  # of cubic phases over 20 pulses or fewer: for tolerances down to -120 dB
# Settings aim below the tolerance, and are taken if the stated error is below it by SPARE.
MARGIN_DB, SPARE_DB, REFINE_DB, MIN_AIM_DB = 25.0, 6.0, 30.0, -220.0
LOOSEST_DB = -80.0  # the default; what is looser runs as it (docs/physics/engines.md)
PROBES = 96
# Shares of the probes that lie where interpolation is likely to err most, and at ends of runs.
ROUGH, SEAMS = 0.4, 0.15
# The stated error lies as many standard errors above the estimate, and so many dB above that.
DEVIATIONS, BOUND_DB = 2.0, 4.0
GOLDEN = 0.6180339887498949
MAX_REFERENCE_SAMPLES, BLOCK = 2**14, 2**14  # of a chirp whose G is tabulated; values at work
Values = TypeVar("Values", float, Float)


class Settings(NamedTuple):
    """Settings of the direct engine."""

    spacing: Spacing  # spacing of the knots
    table_oversampling: int  # points of the table of G per fast-time sample
    single: bool  # whether phasors between knots are single precision
    cubic: bool  # whether phases between knots are cubics over 20 pulses or fewer


def settings(aim_db: float, waveform: Waveform, highest_frequency: float) -> Settings:
    """Choose settings that usually err by `aim_db` or less.

    Args:
        aim_db: Relative L2 error after the canceller, dB.
        highest_frequency: Fundamental of the fastest motion, Hz.
    """
    coarse = 10 ** ((aim_db - SPACING_DB) / 120)
    finest_table = max(1, MAX_CELLS // waveform.n_adc)
    return Settings(
        Spacing(
            max(PER_SECOND, PER_CYCLE * highest_frequency) / coarse,
            AMPLITUDE_CHANGE * coarse,
            min(PHASE_CHANGE * coarse, 0.25),
        ),
        min(4 * 2 ** max(0, ceil((TABLE_DB - aim_db) / 24)), finest_table),
        aim_db >= SINGLE_DB,
        aim_db >= CUBIC_DB,
    )


def target_error_db(tolerance_db: float) -> float:
    """Error (dB) that sums are made for: the tolerance (dB), or the default where it is looser."""
    return min(tolerance_db, LOOSEST_DB)


def first_aim(tolerance_db: float) -> float:
    """Error (dB) for which settings are first chosen, below a tolerance (dB)."""
    return max(target_error_db(tolerance_db) - MARGIN_DB, MIN_AIM_DB)


def error_as_stored(error_db: float) -> float:
    """Bound of the error (dB) of values that are stored in float32, by theirs before that (dB)."""
    return 20 * log10(10 ** (error_db / 20) + 10 ** (STORED_SINGLE_DB / 20))


class AccuracyError(ValueError):
    """The direct engine cannot be as accurate as asked.

    Attributes:
        limit_db: Error that it reaches, dB.
    """

    def __init__(self, limit_db: float) -> None:
        super().__init__(f"the direct engine reaches no more than {limit_db:.0f} dB")
        self.limit_db = limit_db


def measured_db(
    y: Complex,
    source: Callable[[Float], Paths],
    waveform: Waveform,
    canceller: Canceller,
    unit: float,
    roughness: Roughness = EVEN,
) -> float:
    """Bound of the relative L2 error (dB) of a signal after a canceller, from some pulses.

    e is the error after a `Fir`, and before another canceller, behind which it is no larger;
    sum |x|^2 is known.

    Args:
        y: Signal [M] before the canceller, in units of `unit`.
        source: Paths that y is the sum of.
        unit: Amplitude in which y is given.
        roughness: Likely errors of interpolation.
    """
    taps = canceller.taps if isinstance(canceller, Fir) else NO_CANCELLER.taps
    probes = choose_probes(
        _powers(y, canceller, roughness.step), y.size - canceller.lost, roughness, len(taps) - 1
    )
    if probes.total == 0:
        return -inf
    error = exact_sum(source, waveform, probes.pulses, taps) / unit
    for lag, tap in enumerate(taps):
        error -= tap * y[probes.pulses + lag]
    return probes.bound_db(error.real**2 + error.imag**2)


class Probes(NamedTuple):
    """Pulses at which a signal is compared with the exact one."""

    pulses: Index  # numbers of the pulses [P]; a pulse may be there several times
    density: Float  # expected count of each pulse [P]
    total: float  # sum of |x|^2 over all pulses

    def bound_db(self, squares: Float) -> float:
        """Bound of the relative error (dB) from the squared errors |e|^2 [P] at the pulses.

        Each |e|^2 over its density estimates P/sum |e|^2; the bound lies DEVIATIONS standard
        errors of the mean and BOUND_DB above it.
        """
        estimates = squares / self.density
        spread = estimates.std() * np.sqrt(estimates.size)
        relative = float(estimates.sum() + DEVIATIONS * spread) / self.total
        if isnan(self.total):  # no number of a signal can be right; its power is refused later
            return nan
        if isnan(relative):
            return inf
        return BOUND_DB + 10 * log10(relative) if relative > 0 else -inf


def choose_probes(powers: Float, pulses: int, roughness: Roughness = EVEN, lost: int = 0) -> Probes:
    """Choose PROBES pulses at which a signal is compared with the exact one.

    A share `ROUGH` of them lies where interpolation is likely to err most, so that few milliseconds
    which hold most of the error are among them; of the others half are spread evenly, half by the
    power, so that a jump which holds most of that, as of a limb that crosses a wall's face, is.
    Of those in a segment a share `SEAMS` or more lies where a run of pulses ends.

    Args:
        powers: Sum of |x|^2 over each segment of pulses [segments].
        pulses: Number M of pulses of x.
        roughness: Likely |e|^2 in each segment, up to a factor, and their pulses.
        lost: Number of pulses by which the canceller shortens a signal.
    """
    starts = np.arange(0, pulses, roughness.step)
    total = float(powers.sum())
    if total == 0:
        return Probes(np.empty(0, np.intp), np.empty(0), 0.0)
    if isnan(total):  # the error is no number at any pulse
        return Probes(np.zeros(1, np.intp), np.ones(1), total)
    lengths = np.diff(starts, append=pulses)
    share = powers * (0.5 / total) + lengths * (0.5 / pulses)
    rough = roughness.squares[: starts.size]
    if (expected := float(rough.sum())) > 0:
        share *= 1 - ROUGH
        share += rough * (ROUGH / expected)
    place = (np.arange(PROBES) + np.arange(PROBES) * GOLDEN % 1) / PROBES
    ends = np.cumsum(share)
    segment = np.searchsorted(ends, place).clip(max=starts.size - 1)
    within = ((place - ends[segment]) / share[segment] + 1).clip(0, 1 - 1e-9)
    offset, density = _choose_pulses(within, lengths[segment], roughness.step, lost)
    return Probes(starts[segment] + offset, share[segment] * density * PROBES, total)


def _choose_pulses(within: Float, lengths: Index, step: int, lost: int) -> tuple[Index, Float]:
    """Choose a pulse in each of some segments, a share SEAMS or more of them at ends of runs.

    Args:
        within: Uniform numbers u [P], 0 <= u < 1, which choose the pulses.
        lengths: Number of pulses of each segment [P]: `step`, or fewer of the last.
        step: Number of pulses of a segment.
        lost: Number of pulses by which the canceller shortens a signal.

    Returns:
        Number of each pulse within its segment [P], and its probability there [P].
    """
    offset, density = (within * lengths).astype(np.intp), 1 / lengths
    order, seams = _order_seams_first(step, lost)
    if seams >= SEAMS * step:  # as many lie there anyway
        return offset, density
    at_seam, is_full = within < SEAMS, lengths == step
    rank = np.where(
        at_seam,
        within * (seams / SEAMS),
        seams + (within - SEAMS) * ((step - seams) / (1 - SEAMS)),
    ).astype(np.intp)
    shares = np.where(at_seam, SEAMS / seams, (1 - SEAMS) / (step - seams))
    return np.where(is_full, order[rank], offset), np.where(is_full, shares, density)


@lru_cache(maxsize=128)
def _order_seams_first(step: int, lost: int) -> tuple[Index, int]:
    """Order the pulses of a segment [step], seams first: those at ends of runs; and count these.

    Rounding grows along a run, and a canceller sees the jump to the next.
    """
    pulses, length = np.arange(step), run_length(step)
    after = pulses + max(1, lost)
    at_end = (after // length != pulses // length) | (after >= step)
    return np.argsort(~at_end, kind="stable"), int(at_end.sum())


def segment_powers(x: Complex, step: int) -> Float:
    """Sum of |x|^2 over every `step` pulses [segments] of a signal x [M]; the last may be fewer."""
    pairs = np.ascontiguousarray(x).view(float)
    paired = x.size // step * 2 * step
    powers: Float = np.einsum("sk,sk->s", *2 * (pairs[:paired].reshape(-1, 2 * step),))
    last = pairs[paired:]
    return np.append(powers, last @ last) if last.size else powers


def _powers(y: Complex, canceller: Canceller, step: int) -> Float:
    """Sum of |x|^2 over every `step` pulses [segments] of y after the canceller."""
    if not isinstance(canceller, Fir):
        return segment_powers(canceller(y), step)
    parts, length = [], max(1, BLOCK_SAMPLES // step) * step
    for start in range(0, y.size - canceller.lost, length):
        x = canceller(y[start : start + length + canceller.lost])
        parts.append(segment_powers(x, step))
    return np.concatenate([np.empty(0), *parts])


def exact_sum(
    source: Callable[[Float], Paths], waveform: Waveform, pulses: Index, taps: tuple[float, ...]
) -> Complex:
    """Exact signal x [P] at some pulses after a `Fir` of some taps: the coherent sum over range.

    G is that of `reference_table`, phases f0 tau are not rounded; chirps that are too long for a
    table are summed sample by sample.
    """
    if waveform.n_adc > MAX_REFERENCE_SAMPLES:
        length = max(1, BLOCK_SAMPLES // waveform.n_adc)
        parts = [pulses[start : start + length] for start in range(0, pulses.size, length)]
        beats = (beat_at(source, waveform, part, taps) for part in parts)
        return np.concatenate([weights(waveform) @ beat for beat in beats])
    needed = np.unique(pulses + np.arange(len(taps))[:, None])
    paths, table = source(waveform.times(needed.astype(float))), reference_table(waveform)
    y, length = np.empty(needed.size, complex), max(1, BLOCK // max(1, len(paths.delay)))
    for start in range(0, needed.size, length):  # so that it stays in the cache
        block = slice(start, start + length)
        delay, amplitude = paths.delay[:, block], paths.amplitude[:, block]
        g = table(waveform.slope / waveform.adc_rate * delay)
        g *= amplitude
        turning = unit_phasor(_exact_phase(delay, waveform))
        y[block] = np.einsum("im,im->m", turning, g)
    x: Complex = np.zeros(pulses.size, complex)
    for lag, tap in enumerate(taps):
        x += tap * y[np.searchsorted(needed, pulses + lag)]
    return x


def _exact_phase(delay: Float, waveform: Waveform) -> Float:
    """Phases [...] (cycles) of delays [...] (s) at f0, less whole turns, without rounding f0 tau.

    The product in two parts is that of T. J. Dekker, "A floating-point technique for extending the
    available precision", Numerische Mathematik 18, 1971.
    """
    f0, f0_high = waveform.f0, _high(waveform.f0)
    product, high = f0 * delay, _high(delay)
    low = delay - high
    rounding = f0_high * high - product
    rounding += f0_high * low
    rounding += (f0 - f0_high) * high
    rounding += (f0 - f0_high) * low
    product -= np.rint(product)
    product += rounding
    if waveform.residual_video_phase:
        product -= 0.5 * waveform.slope * delay * delay
    return product


def _high(x: Values) -> Values:
    """Upper 26 bits of the 53 of a number."""
    scaled = 134217729.0 * x  # 2^27 + 1
    return scaled - (scaled - x)
