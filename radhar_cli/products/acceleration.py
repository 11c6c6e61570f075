"""What compiled code does for the samples of a config, or would do if it were installed."""

from radhar_cli.config.data_set import Config
from radhar_cli.config.number import support
from radhar_cli.config.radar import BoardRadar, ImpulseRadar
from radhar_cli.echo.compiled import MIN_TERMS
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.accelerators import installed


def describe_acceleration(config: Config) -> str | None:
    """Say that numba compiles the sums over paths, or what it would save.

    Shares of a sample's time are those of docs/records/costs.md.

    Args:
        config: that of a data set.

    Returns:
        A line; None where sums are too small, or others than numba compiles.
    """
    other_sums = isinstance(config.radar, BoardRadar | ImpulseRadar) or config.wall is not None
    if other_sums or config.engine.kind != "direct" or config.engine.precision == "double":
        return None
    pulses = support(config.duration_s)[1] * support(config.radar.prf_hz)[1]
    are_points = config.body.scatterers == "points"
    if len(JOINTS) * pulses < MIN_TERMS:
        return None
    version = installed("numba")
    if version is not None:
        return f"numba {version} compiles the sums over paths"
    saved = "less than a tenth" if are_points else "half"
    return f"numba is not installed: pip install 'radhar[fast]' saves {saved} of a sample's time"
