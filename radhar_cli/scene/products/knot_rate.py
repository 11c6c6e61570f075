"""Rate of the knots at which the direct engine evaluates positions."""

from math import inf

from radhar_cli.config.data_set import Config
from radhar_cli.echo.accuracy import first_aim, settings
from radhar_cli.echo.direct import DirectEcho
from radhar_cli.echo.gated import GatedEcho
from radhar_cli.echo.paths import PathSource
from radhar_cli.radar.waveform import Waveform


def knots_per_second(paths: PathSource, waveform: Waveform, config: Config) -> float:
    """Knots per second of the echo of some paths by the engine of a config; inf for every pulse.

    Every pulse is evaluated where a wide band needs knots closer than the echo's.
    """
    aim = first_aim(config.engine.tolerance_db)
    rate = settings(aim, waveform, paths.highest_frequency).spacing.per_second
    engine = GatedEcho if config.processing.range_sum == "gated" else DirectEcho
    return rate if waveform.prf >= engine.min_step * rate else inf
