"""Rate of the knots at which the direct engine evaluates positions."""

from dataclasses import dataclass
from math import inf

from radhar_cli.config.data_set import Config
from radhar_cli.echo.accuracy import first_aim, settings
from radhar_cli.echo.direct import DirectEcho
from radhar_cli.echo.gated import GatedEcho
from radhar_cli.echo.paths import PathSource
from radhar_cli.radar.waveform import Waveform


@dataclass(frozen=True)
class KnotRate:
    """Rate of the knots of an echo.

    Attributes:
        tolerance_db: tolerance of the engine (`engine.tolerance_db`).
        is_gated: whether the engine makes the bins of a gate, rather than their sum.
    """

    tolerance_db: float
    is_gated: bool

    @classmethod
    def of(cls, config: Config) -> "KnotRate":
        """Read tolerance and gate of a config."""
        return cls(config.engine.tolerance_db, config.processing.range_sum == "gated")

    def per_second(self, paths: PathSource, waveform: Waveform) -> float:
        """Knots per second of the echo of some paths; inf for every pulse.

        Every pulse is evaluated where a wide band needs knots closer than the echo's.
        """
        chosen = settings(first_aim(self.tolerance_db), waveform, paths.highest_frequency)
        rate = chosen.spacing.per_second
        fewest_pulses = (GatedEcho if self.is_gated else DirectEcho).min_step
        return rate if waveform.prf >= fewest_pulses * rate else inf
