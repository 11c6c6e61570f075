"""Where the direct engine cannot keep the tolerance: the cube instead, or a refusal."""

from math import ceil
from typing import NamedTuple, TypeAlias

from radhar_cli.config.data_set import Config
from radhar_cli.config.engine import MAX_TOLERANCE_DB
from radhar_cli.echo.accuracy import AccuracyError
from radhar_cli.echo.direct import Accuracy
from radhar_cli.errors import SceneError
from radhar_cli.scene import Scene


class Fallback(NamedTuple):
    """Why the cube made the echo instead of the direct engine."""

    reason: str


EchoAccuracy: TypeAlias = Accuracy | Fallback


def fall_back(config: Config, scene: Scene, error: AccuracyError) -> Fallback:
    """Decide, for every radar, what happens when the direct engine cannot keep the tolerance.

    Args:
        config: config whose `engine.fallback` and `engine.tolerance_db` count.
        scene: scene that a message names.
        error: error that the direct engine reaches.

    Returns:
        The fall-back to the cube, which the caller then computes.

    Raises:
        SceneError: `engine.fallback` is refuse.
    """
    if config.engine.fallback == "refuse":
        raise SceneError(_refusal(scene.name, config.engine.tolerance_db, error))
    return Fallback(str(error))


def _refusal(name: str, tolerance_db: float, error: AccuracyError) -> str:
    what = f"sample {name}: engine.tolerance_db = {tolerance_db:g}: "
    if error.limit_db > MAX_TOLERANCE_DB:
        return what + f"no tolerance can be kept here ({error}); set engine.fallback: cube"
    return what + (
        f"should be {ceil(error.limit_db)} or more, which is what the direct engine reaches here, "
        "or engine.fallback: cube"
    )
