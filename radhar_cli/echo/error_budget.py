"""From an error that is allowed to the cheapest settings of the direct engine that keep it."""

from dataclasses import dataclass, field
from itertools import pairwise
from math import inf, log10
from typing import NamedTuple

import numpy as np

from radhar_cli.arrays import Bool, Complex, Float, Index
from radhar_cli.echo import error_bounds
from radhar_cli.echo.coarse_knots import LEAST_STEP, CoarseKnots, every_pulse
from radhar_cli.echo.error_bounds import MOST_TURN, OVERSAMPLINGS, Bounds, Interpolation, Sums
from radhar_cli.echo.half_band_sum import MOST_CELLS, HalfBandTable, half_band_table
from radhar_cli.echo.interpolation import TAPS
from radhar_cli.echo.knots import Knots, Neighbours, all_knots, columns
from radhar_cli.echo.paths import Paths
from radhar_cli.radar.waveform import Waveform

# Shares of the budget. Where there are no knots, the table of G has that of the interpolation too.
INTERPOLATION_SHARE, ROUNDING_SHARE = 0.5, 0.25

# Aims that usually spare a second look.
USUAL_TURN, SPARE = 0.2, 0.9
# Pulses that x is measured at, in every piece between kinks.
LOOK_PULSES = 160
LOOK_OVERSAMPLING = 16
GOLDEN = 0.6180339887498949


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
    probe = _through_knots(coarse, mti) if coarse.step > 1 else _through_pulses(coarse, mti)
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
        scale: power of two near the largest amplitude.
    """

    bounds: Bounds
    delays: float
    moving: Bool
    scale: float


def _through_knots(coarse: CoarseKnots, mti: bool) -> _Probe:
    waveform, kinks = coarse.waveform, coarse.source.kinks
    table = _look_table(waveform)
    looks: list[Sums] = []
    delays: list[Interpolation] = []
    first, scale, longest = None, 1.0, 0.0
    moving: Bool = np.zeros(1, dtype=bool)
    for knots in coarse.chunks():
        if first is None:
            first, scale = knots.at_pulses, _scale(knots.paths)
        seen = knots.neighbours(kinks, LOOK_PULSES)
        looks.append(error_bounds.sums(seen if mti else seen.alone(), table, scale))
        b = error_bounds.envelope(knots.paths, table, scale)
        delays.append(error_bounds.delay_errors(knots, b, kinks, waveform, mti))
        moving = moving | (knots.changes(first) if mti else np.full(len(b), True))
        longest = max(longest, float(knots.paths.delay.max()))
    changing = moving.astype(float)
    bounds = error_bounds.bounds(looks, waveform.f0 * longest, changing)
    return _Probe(bounds, _norm(delays, changing), moving, scale)


def _through_pulses(coarse: CoarseKnots, mti: bool) -> _Probe:
    """Pairs of neighbouring pulses, spread over every piece between kinks."""
    source, waveform = coarse.source, coarse.waveform
    pulses, weight = _spread(waveform, source.kinks)
    if coarse.kept is not None:
        every = coarse.kept.paths
        pair = Neighbours(columns(every, pulses), columns(every, pulses + 1), weight)
        moving = coarse.kept.changes(every)
    else:
        now, after = (source(waveform.times((pulses + later).astype(float))) for later in (0, 1))
        pair = Neighbours(now, after, weight)
        moving = ~pair.still
    scale = _scale(pair.now)
    if not mti:
        pair, moving = pair.alone(), np.full(len(moving), True)
    look = error_bounds.sums(pair, _look_table(waveform), scale)
    cycles = waveform.f0 * float(pair.now.delay.max())
    bounds = error_bounds.bounds([look], cycles, moving.astype(float))
    return _Probe(bounds, 0.0, moving, scale)


def _spread(waveform: Waveform, kinks: tuple[float, ...]) -> tuple[Index, Float]:
    """Pulses with a next one, by the golden ratio in every piece: numbers, and weights of each."""
    last = waveform.n_pulses - 1
    bounds = np.clip(np.ceil(np.array([-1.0, *kinks, np.inf]) * waveform.prf), 0, last)
    found, weight = [], []
    for first, end in pairwise(np.unique(bounds).astype(np.intp).tolist()):
        place = np.mod((np.arange(LOOK_PULSES) + 0.5) * GOLDEN, 1) * (end - first)
        found.append(np.unique(first + place.astype(np.intp)))
        weight.append(np.full(found[-1].size, (end - first) / found[-1].size))
    return np.concatenate(found), np.concatenate(weight)


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
            b = error_bounds.envelope(knots.paths, table, probe.scale)
            errors.append(error_bounds.interpolation_errors(knots, b, source.kinks, waveform, mti))
            kept = Envelope(knots, b) if len(errors) == 1 else None
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


def _scale(paths: Paths) -> float:
    largest = float(paths.amplitude.max(initial=0.0))
    return float(2.0 ** np.frexp(largest)[1]) if largest > 0 else 1.0
