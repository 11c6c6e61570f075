"""Scenes in which the direct engine misses the tolerance: the cube instead, or a refusal."""

from math import ceil
from typing import NamedTuple, TypeAlias

from radhar_cli.config.engine import MAX_TOLERANCE_DB, EngineConfig
from radhar_cli.echo.accuracy import AccuracyError
from radhar_cli.echo.direct import Accuracy
from radhar_cli.errors import SceneError


class Fallback(NamedTuple):
    """Reason why the cube made the echo instead of the direct engine."""

    reason: str


EchoAccuracy: TypeAlias = Accuracy | Fallback


def fall_back(engine: EngineConfig, sample: str, error: AccuracyError) -> Fallback:
    """Return why the cube makes an echo, which the caller then computes.

    Args:
        engine: engine whose tolerance cannot be kept.
        sample: name of the sample, for the message.
        error: error that the direct engine reaches.

    Raises:
        SceneError: such scenes are refused.
    """
    if engine.fallback == "cube":
        return Fallback(str(error))
    begin = f"sample {sample}: engine.tolerance_db = {engine.tolerance_db:g}: "
    if error.limit_db > MAX_TOLERANCE_DB:
        raise SceneError(
            begin + f"no tolerance can be kept here ({error}); set engine.fallback: cube"
        )
    raise SceneError(
        begin + f"should be {ceil(error.limit_db)} or more, which is what the direct engine "
        "reaches here, or engine.fallback: cube"
    )
