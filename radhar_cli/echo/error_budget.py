"""From an error that is allowed to the cheapest settings of the direct engine that keep it."""

from dataclasses import dataclass, field
from math import inf, log10
from typing import NamedTuple

import numpy as np

from radhar_cli.arrays import Bool, Complex, Float
from radhar_cli.echo import error_bounds
from radhar_cli.echo.coarse_knots import LEAST_STEP, CoarseKnots, every_pulse
from radhar_cli.echo.error_bounds import MOST_TURN, OVERSAMPLINGS, Bounds, Interpolation, Sums
from radhar_cli.echo.half_band_sum import MOST_CELLS, HalfBandTable, half_band_table
from radhar_cli.echo.interpolation import TAPS
from radhar_cli.echo.knots import Knots, all_knots
from radhar_cli.radar.waveform import Waveform

# Shares of the budget. Where there are no knots, the table of G has that of the interpolation too.
INTERPOLATION_SHARE, ROUNDING_SHARE = 0.5, 0.25

# Aims that usually spare a second look.
USUAL_TURN, SPARE = 0.24, 0.9
LOOK_OVERSAMPLING = 16


@dataclass(frozen=True)
class DirectSettings:
    """What the direct engine does for a scene.

    Attributes:
        step: pulses from knot to knot of the kinematics; 1 is every pulse.
        table_oversampling: points of the table of G per fast-time sample.
        single: whether sines and cosines are single precision.
        moving: numbers of the paths that change; the others cancel in the MTI.
        scale: power of two that the amplitudes are divided by.
        cheapest: nothing less exact would have been cheaper.
        bounds_db: {term: bound of its error relative to x, dB}.
    """

    step: int
    table_oversampling: int
    single: bool
    moving: tuple[int, ...]
    scale: float
    cheapest: bool = True
    bounds_db: dict[str, float] = field(default_factory=dict)


class BudgetError(ValueError):
    """The direct engine cannot promise the accuracy asked for.

    Attributes:
        limit_db: the tightest that it can.
    """

    def __init__(self, limit_db: float) -> None:
        super().__init__(f"the direct engine can promise no more than {limit_db:.0f} dB")
        self.limit_db = limit_db


class Envelope(NamedTuple):
    """Knots, and B = A G over the scale [I, K] there."""

    knots: Knots
    b: Complex


class Choice(NamedTuple):
    """Settings; and the paths themselves, where the recording is short enough to keep them."""

    settings: DirectSettings
    kept: Envelope | None


def choose(
    coarse: CoarseKnots, tolerance_db: float, double: bool = False, mti: bool = True
) -> Choice:
    """Return the cheapest settings whose error bound is within the budget.

    Args:
        coarse: the recording seen through its coarsest knots.
        tolerance_db: relative L2 error of the noiseless slow-time signal.
        double: keep to double precision whatever the budget.
        mti: whether that is the signal after MTI.

    Raises:
        BudgetError: the budget is below what float64 leaves of this signal.
    """
    budget = 10 ** (tolerance_db / 20)
    probe = _look(coarse, mti)
    if not probe.moving.any():
        return Choice(DirectSettings(coarse.step, 1, not double, (), probe.scale), None)
    single, rounding = _rounding(probe.bounds, budget, double)
    left = budget * probe.bounds.signal - rounding
    share = INTERPOLATION_SHARE * budget * probe.bounds.signal if coarse.step > 1 else 0.0
    oversampling, table_error = _table(probe.bounds, coarse.waveform, left - share)
    table = half_band_table(coarse.waveform, oversampling)
    step, interpolation, kept = 1, 0.0, None
    if coarse.step > 1:
        step, interpolation, kept = _close_enough(coarse, probe, table, budget, mti)
    if step == 1:
        every = (coarse if coarse.step == 1 else every_pulse(coarse.source, coarse.waveform)).kept
        if every is not None:
            kept = Envelope(every, error_bounds.envelope(every.paths, table, probe.scale))
    terms = {"interpolation": interpolation, "table": table_error, "rounding": rounding}
    settings = DirectSettings(
        step,
        oversampling,
        single,
        tuple(np.flatnonzero(probe.moving).tolist()),
        probe.scale,
        step == coarse.step and oversampling == 1 and (single or double),
        {name: _decibel(error, probe.bounds.signal) for name, error in terms.items()},
    )
    return Choice(settings, kept)


@dataclass(frozen=True)
class _Probe:
    """What the coarse knots show.

    Attributes:
        bounds: all that do not depend on the knots.
        delays: error of delays and amplitudes at these knots.
        moving: which paths change [I]; without MTI, all of them count.
        unit: that the bounds are in.
        scale: power of two near the largest amplitude.
    """

    bounds: Bounds
    delays: float
    moving: Bool
    unit: float
    scale: float


def _look(coarse: CoarseKnots, mti: bool) -> _Probe:
    """See the whole recording: every coarse knot, or every pulse where there are no knots."""
    waveform, kinks = coarse.waveform, coarse.source.kinks
    table = _look_table(waveform)
    # Squares of tiny amplitudes must not vanish; a power of two changes no digit.
    unit = 1.0 if coarse.kept is None else _scale(float(coarse.kept.paths.amplitude.max()))
    total: Sums | None = None
    delays: list[Interpolation] = []
    first, longest = None, 0.0
    moving: Bool = np.zeros(1, dtype=bool)
    for knots in coarse.chunks():
        first = first or knots.at_pulses
        seen = knots.neighbours()
        here = error_bounds.sums(seen if mti else seen.alone(), table, unit)
        total = here if total is None else total + here
        if knots.step > 1:
            b = error_bounds.envelope(knots.paths, table, unit)
            delays.append(error_bounds.delay_errors(knots, b, kinks, waveform, mti))
        moving = moving | (knots.changes(first) if mti else np.full(len(here.envelope), True))
        longest = max(longest, float(knots.paths.delay.max()))
    assert total is not None
    changing = moving.astype(float)
    bounds = error_bounds.bounds(total, waveform, waveform.f0 * longest, changing)
    scale = unit if coarse.kept is not None else _scale(total.largest)
    return _Probe(bounds, _norm(delays, changing), moving, unit, scale)


def _rounding(b: Bounds, budget: float, double: bool) -> tuple[bool, float]:
    """Whether single precision will do, and the error of what is chosen."""
    limit = ROUNDING_SHARE * budget * b.signal
    if b.double > limit:
        raise BudgetError(_decibel(b.double, ROUNDING_SHARE * b.signal))
    single = not double and b.single <= limit
    return single, b.single if single else b.double


def _first_step(coarse: CoarseKnots, probe: _Probe, budget: float) -> int:
    """A step that should do, from what the probe saw."""
    step = coarse.step * _closer(probe.delays, INTERPOLATION_SHARE * budget * probe.bounds.signal)
    if coarse.motion.turn > MOST_TURN:
        usual: float = USUAL_TURN * (budget / 1e-3) ** (1 / TAPS)
        step = min(step, coarse.step * min(usual, MOST_TURN) / coarse.motion.turn)
    return int(step)


def _close_enough(
    coarse: CoarseKnots, probe: _Probe, table: HalfBandTable, budget: float, mti: bool
) -> tuple[int, float, Envelope | None]:
    """Bring the knots together until their bound is within its share: (step, bound, knots)."""
    source, waveform = coarse.source, coarse.waveform
    share = INTERPOLATION_SHARE * budget * probe.bounds.signal
    moving = probe.moving.astype(float)
    step = _first_step(coarse, probe, budget)
    while step >= LEAST_STEP:
        errors: list[Interpolation] = []
        kept = None
        chunks = coarse.chunks() if step == coarse.step else all_knots(source, waveform, step)
        for knots in chunks:
            b = error_bounds.envelope(knots.paths, table, probe.unit)
            errors.append(error_bounds.interpolation_errors(knots, b, source.kinks, waveform, mti))
            kept = Envelope(knots, b * (probe.unit / probe.scale)) if len(errors) == 1 else None
        error = _norm(errors, moving)
        if error <= share:
            return step, error, kept
        step = min(step - 1, int(step * _closer(error, share)))
    return 1, 0.0, None


def _closer(error: float, share: float) -> float:
    """Factor on the step of the knots after which an error should be within its share.

    It falls with the sixth power of the step, its change from pulse to pulse with the fifth.
    """
    return SPARE * (share / error) ** (1 / (TAPS - 1)) if error > share else 1.0


def _norm(chunks: list[Interpolation], moving: Float) -> float:
    if not chunks:
        return 0.0
    squares = np.sum([chunk.squares for chunk in chunks], axis=0)
    whole = Interpolation(squares, sum(chunk.weight for chunk in chunks))
    return float(moving @ whole.error)


def _table(b: Bounds, waveform: Waveform, share: float) -> tuple[int, float]:
    """The coarsest table whose error is within its share: oversampling and error."""
    fine = np.flatnonzero(OVERSAMPLINGS * waveform.n_adc <= max(MOST_CELLS, waveform.n_adc))
    enough = fine[b.table[fine] <= share]
    if not enough.size:
        raise BudgetError(_decibel(float(b.table[fine[-1]]), INTERPOLATION_SHARE * b.signal))
    return int(OVERSAMPLINGS[enough[0]]), float(b.table[enough[0]])


def _look_table(waveform: Waveform) -> HalfBandTable:
    return half_band_table(waveform, min(LOOK_OVERSAMPLING, max(1, MOST_CELLS // waveform.n_adc)))


def _decibel(error: float, signal: float) -> float:
    return 20 * log10(error / signal) if error > 0 and signal > 0 else (inf if error > 0 else -inf)


def _scale(largest: float) -> float:
    return float(2.0 ** np.frexp(largest)[1]) if largest > 0 else 1.0
