"""Config of the engine that computes the echo."""

from typing import Annotated, Literal

from pydantic import Field

from radhar_cli.config.acting import NO_IMPULSE
from radhar_cli.schema.annotations import NeedsKey
from radhar_cli.schema.section import Flag, Section

MAX_TOLERANCE_DB = -6.0


_DIRECT = NeedsKey("engine.kind", "direct")


class EngineConfig(Section):
    """`cube` is the exact float64 reference; `direct` the closed form, within a tolerance.

    The tolerance is the relative L2 error (dB) of the noiseless slow-time signal after the
    canceller against the cube, measured in every scene. Where `direct` does not reach it, the scene
    is refused, or computed by the cube (`fallback: cube`). `motion_in_chirp` lets the paths of the
    cube go on moving during a chirp.
    """

    kind: Literal["direct", "cube"] = "direct"
    """Echo engine: the closed form within the tolerance, or the exact reference."""
    tolerance_db: Annotated[
        float, Field(ge=-400, le=MAX_TOLERANCE_DB, strict=True), _DIRECT, NO_IMPULSE
    ] = -80.0
    """Largest relative L2 error of the noiseless signal after the canceller, measured in every
    scene. What is looser than the default runs as it."""
    fallback: Annotated[Literal["refuse", "cube"], _DIRECT, NO_IMPULSE] = "refuse"
    """Treatment of a scene in which `direct` misses the tolerance: refuse it, or compute it by the
    cube."""
    precision: Annotated[Literal["auto", "double"], _DIRECT] = "auto"
    """Arithmetic of the direct engine: single where the tolerance allows it, or float64 always."""
    motion_in_chirp: Flag = False
    """Whether paths go on moving during a chirp, with `kind: cube`."""

    @property
    def is_double(self) -> bool:
        """Whether sums are made in double precision whatever the tolerance."""
        return self.precision == "double"
