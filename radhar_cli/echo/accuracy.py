"""Settings of the direct engine for an error that is allowed, and the error that they made.

As FINUFFT turns eps into a kernel width, `settings` turns decibels into the spacing of knots, the
size of a table and a precision; `measured_db` then compares the signal with the exact beat at some
pulses.
"""

from collections.abc import Callable
from math import ceil, inf, log10
from typing import NamedTuple

import numpy as np

from radhar_cli.echo.beat import BLOCK_SAMPLES
from radhar_cli.echo.exact import beat_at
from radhar_cli.echo.half_band_sum import MAX_CELLS
from radhar_cli.echo.knots import Spacing
from radhar_cli.echo.paths import Paths
from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.processing.canceller import NO_CANCELLER, Canceller, Fir
from radhar_cli.processing.look import weights
from radhar_cli.radar.waveform import Waveform

# Six-point interpolation errs by the sixth power of the spacing; this one made -114 dB or less of
# every activity at 77 GHz.
SPACING_DB = -140.0
PER_SECOND, PER_CYCLE, AMPLITUDE_CHANGE, PHASE_CHANGE = 400.0, 200.0, 0.1, 0.05
# Cubic Hermite cells err by the fourth power of their width: -48 dB at 4 a fast-time sample.
TABLE_DB = -48.0
SINGLE_DB = -115.0  # error of the recurrence in float32
CUBIC_DB = -140.0  # of a cubic phase over 20 pulses, which may err by -120 dB in a few places
# Settings aim below the tolerance, and are taken if the measured error is below it by SPARE.
MARGIN_DB, SPARE_DB, REFINE_DB, MIN_AIM_DB = 25.0, 10.0, 30.0, -220.0
COARSEST_DB = -60.0  # tolerance above which farther knots save no time (docs/results/tradeoff.md)
PROBES = 48
ROUGH = 0.25  # share of the probes that lie where interpolation is likely to err most


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
        waveform: The radar.
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


def first_aim(tolerance_db: float) -> float:
    """Error (dB) for which settings are first chosen, below a tolerance (dB)."""
    return max(min(tolerance_db, COARSEST_DB) - MARGIN_DB, MIN_AIM_DB)


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
    likely: Float | None = None,
) -> float:
    """Relative L2 error (dB) of a signal after a canceller, measured at some pulses.

    Pulses are chosen by `probed_pulses`. The estimate of
    sum |e|^2 divides each |e|^2 by the density of the pulses; sum |x|^2 is known. e is the error
    after a `Fir`, and before another canceller, behind which it is no larger.

    Args:
        y: Signal [M] before the canceller, in units of `unit`.
        source: Paths that y is the sum of.
        waveform: The radar.
        canceller: The canceller.
        unit: Amplitude in which y is given.
        likely: How large |e|^2 may be [M or more], up to a factor.
    """
    shown = canceller if isinstance(canceller, Fir) else NO_CANCELLER
    probes, density, total = probed_pulses(_power(y, canceller), likely)
    if total == 0:
        return -inf
    error = _exact(source, waveform, probes, shown.taps) / unit - sum(
        c * y[probes + lag] for lag, c in enumerate(shown.taps)
    )
    return relative_db(error.real**2 + error.imag**2, density, total)


def probed_pulses(power: Float, likely: Float | None = None) -> tuple[Index, Float, float]:
    """Choose pulses at which a signal is compared with the exact one.

    A share `ROUGH` of them lies where the error is likely to be large, so that few milliseconds
    which hold most of it are among them; of the others half are spread evenly, half by the power,
    so that a jump which holds most of that, as of a limb that crosses a wall's face, is.

    Args:
        power: |x|^2 [M].
        likely: How large |e|^2 may be [M or more], up to a factor; None or zeros where nothing is
            known of it.

    Returns:
        Numbers of the pulses, expected count of each among them, and the sum of the power.
    """
    total = float(power.sum())
    if total == 0:
        return np.empty(0, np.intp), np.empty(0), 0.0
    share = power * (0.5 / total) + 0.5 / power.size
    expected = 0.0 if likely is None else float(likely[: power.size].sum())
    if likely is not None and expected > 0:
        share *= 1 - ROUGH
        share += likely[: power.size] * (ROUGH / expected)
    place = (np.arange(PROBES) + np.arange(PROBES) * 0.6180339887498949 % 1) / PROBES
    pulses = np.searchsorted(np.cumsum(share), place).clip(max=power.size - 1)
    probes, times = np.unique(pulses, return_counts=True)
    return probes, share[probes] * PROBES / times, total


def relative_db(squares: Float, density: Float, total: float) -> float:
    """Relative error (dB) of a signal from squared errors at some pulses.

    Args:
        squares: |e|^2 at the pulses [P].
        density: Expected count of each pulse [P].
        total: Sum of |x|^2 over all pulses.
    """
    relative = float((squares / density).sum()) / total
    return 10 * log10(relative) if relative > 0 else -inf


def _power(y: Complex, canceller: Canceller) -> Float:
    """Power |x|^2 [M] of y after the canceller."""
    if not isinstance(canceller, Fir):
        x = canceller(y)
        power: Float = x.real**2 + x.imag**2
        return power
    power = np.empty(max(y.size - canceller.lost, 0))
    for start in range(0, power.size, BLOCK_SAMPLES):
        part = power[start : start + BLOCK_SAMPLES]
        x = canceller(y[start : start + part.size + canceller.lost])
        part[:] = x.real**2 + x.imag**2
    return power


def _exact(
    source: Callable[[Float], Paths],
    waveform: Waveform,
    pulses: Index,
    canceller: tuple[float, ...],
) -> Complex:
    """Exact x [pulses] at some pulses by way of the beat, a few of them at a time."""
    d, length = weights(waveform), max(1, BLOCK_SAMPLES // waveform.n_adc)
    return np.concatenate(
        [
            d @ beat_at(source, waveform, pulses[start : start + length], canceller)
            for start in range(0, pulses.size, length)
        ]
    )
