"""Rate of the knots at which the direct engine evaluates positions."""

from collections.abc import Callable
from functools import partial
from math import inf
from typing import TypeAlias

from radhar_cli.config.data_set import Config
from radhar_cli.echo.accuracy import first_aim, settings
from radhar_cli.echo.direct import DirectEcho
from radhar_cli.echo.gated import GatedEcho
from radhar_cli.echo.paths import PathSource
from radhar_cli.radar.fmcw import Waveform

# Knots per second of the echo of some paths; inf for every pulse.
KnotRate: TypeAlias = Callable[[PathSource, Waveform], float]


def knot_rate_of(config: Config) -> KnotRate:
    """Rate of the knots of the direct engine, of the sum over range or of the bins of a gate."""
    engine = GatedEcho if config.processing.range_sum == "gated" else DirectEcho
    tolerance_db, min_step = config.engine.tolerance_db, engine.min_step
    return partial(knots_per_second, tolerance_db=tolerance_db, min_step=min_step)


def knots_per_second(
    paths: PathSource, waveform: Waveform, tolerance_db: float, min_step: int
) -> float:
    """Knots per second of the echo of some paths within a tolerance; inf for every pulse.

    Every pulse is evaluated where knots are closer than `min_step` pulses, as of a wide band.
    """
    chosen = settings(first_aim(tolerance_db), waveform, paths.highest_frequency)
    rate = chosen.spacing.per_second
    return rate if waveform.prf >= min_step * rate else inf
