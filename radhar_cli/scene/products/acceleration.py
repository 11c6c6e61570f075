"""Compiled code for the samples of a config, and the time that it saves or would save."""

from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import ArrayRadar, ImpulseRadar
from radhar_cli.echo.compiled import MIN_TERMS
from radhar_cli.errors import how_to_install
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.accelerators import installed
from radhar_cli.processing.map_kind import kind_of
from radhar_cli.schema.number import support


def describe_acceleration(config: Config) -> str | None:
    """Name the version of numba that compiles a part of a sample, or the time it would save.

    Shares of a sample's time are those of docs/records/costs.md.

    Args:
        config: that of a data set.

    Returns:
        A line; None where numba compiles nothing.
    """
    if config.engine.precision == "double" or isinstance(config.radar, ArrayRadar):
        return None
    kinds = [kind for name in config.maps if (kind := kind_of(name)) is not None]
    has_fsst = any(kind.transform == "fsst" for kind in kinds)
    has_sums = _has_compiled_sums(config)
    if not has_fsst and not has_sums:
        return None
    version = installed("numba")
    if version is not None:
        return f"numba {version} compiles what of a sample it speeds up"
    saved = "a sixth" if has_fsst else "a tenth"
    if has_sums and config.body.scatterers != "points":
        saved = "half"
    return f"numba is not installed: {how_to_install('numba')} saves {saved} of a sample's time"


def _has_compiled_sums(config: Config) -> bool:
    """Whether sums over the paths of an echo are as large as those that numba compiles."""
    if config.engine.kind != "direct" or config.wall is not None:  # whose paths have no knots
        return False
    if isinstance(config.radar, ImpulseRadar):
        return False
    pulses = support(config.duration_s)[1] * support(config.radar.prf_hz)[1]
    return len(JOINTS) * pulses >= MIN_TERMS
