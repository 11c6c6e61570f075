"""Where the direct engine cannot keep the tolerance: the cube instead, or a refusal."""

from dataclasses import dataclass
from math import ceil
from typing import NamedTuple, TypeAlias

from radhar_cli.config.data_set import Config
from radhar_cli.config.engine import MAX_TOLERANCE_DB
from radhar_cli.echo.accuracy import AccuracyError
from radhar_cli.echo.direct import Accuracy
from radhar_cli.errors import SceneError


class Fallback(NamedTuple):
    """Why the cube made the echo instead of the direct engine."""

    reason: str


EchoAccuracy: TypeAlias = Accuracy | Fallback


@dataclass(frozen=True)
class Tolerance:
    """How exact the direct engine must be, for every radar, and what happens where it cannot be.

    Attributes:
        tolerance_db: largest relative error of the signal, dB (`engine.tolerance_db`).
        is_double: whether sums are made in double precision whatever the tolerance.
        refuses: whether a scene is refused where the tolerance cannot be kept, rather than
            computed by the cube.
    """

    tolerance_db: float
    is_double: bool
    refuses: bool

    @classmethod
    def of(cls, config: Config) -> "Tolerance":
        """Read `engine` of a config."""
        engine = config.engine
        return cls(engine.tolerance_db, engine.precision == "double", engine.fallback == "refuse")

    def fall_back(self, sample: str, error: AccuracyError) -> Fallback:
        """Return the fall-back to the cube, which the caller then computes.

        Args:
            sample: name of the sample, for the message.
            error: error that the direct engine reaches.

        Raises:
            SceneError: such scenes are refused.
        """
        if self.refuses:
            raise SceneError(_refusal(sample, self.tolerance_db, error))
        return Fallback(str(error))


def _refusal(sample: str, tolerance_db: float, error: AccuracyError) -> str:
    begin = f"sample {sample}: engine.tolerance_db = {tolerance_db:g}: "
    if error.limit_db > MAX_TOLERANCE_DB:
        return begin + f"no tolerance can be kept here ({error}); set engine.fallback: cube"
    return begin + (
        f"should be {ceil(error.limit_db)} or more, which is what the direct engine reaches here, "
        "or engine.fallback: cube"
    )
