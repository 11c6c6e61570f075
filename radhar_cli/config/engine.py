"""`engine:` how the echo is computed, and how exactly."""

from typing import Annotated, Literal

from pydantic import Field

from radhar_cli.config.section import Flag, Section

MAX_TOLERANCE_DB = -6.0


class EngineConfig(Section):
    """`cube` is the exact float64 reference; `direct` the closed form, within a tolerance.

    The tolerance is the relative L2 error (dB) of the noiseless slow-time signal after MTI against
    the cube, measured in every scene. Where `direct` does not reach it, the scene is refused, or
    computed by the cube (`fallback: cube`). `motion_in_chirp` lets the paths of the cube go on
    moving during a chirp.
    """

    kind: Literal["direct", "cube"] = "direct"
    tolerance_db: Annotated[float, Field(ge=-400, le=MAX_TOLERANCE_DB, strict=True)] = -80.0
    fallback: Literal["refuse", "cube"] = "refuse"
    precision: Literal["auto", "double"] = "auto"
    motion_in_chirp: Flag = False
