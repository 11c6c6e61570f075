"""`engine:` how the echo is computed, and how exactly."""

from typing import Annotated, Literal

from pydantic import Field

from radhar_cli.config.section import Flag, Section

MAX_TOLERANCE_DB = -6.0


class EngineConfig(Section):
    """`cube` is the exact float64 reference; `direct` the closed form, within an error budget.

    The budget is the relative L2 error (dB) of the noiseless slow-time signal after MTI against
    the cube; the default is the tightest that costs nothing to speak of (docs/tradeoff.md). A
    budget that `direct` cannot promise for a scene is refused, or the scene is computed by the cube
    (`fallback: cube`). `motion_in_chirp` lets the paths of the cube go on moving during a chirp.
    """

    kind: Literal["direct", "cube"] = "direct"
    tolerance_db: Annotated[float, Field(ge=-400, le=MAX_TOLERANCE_DB, strict=True)] = -80.0
    fallback: Literal["refuse", "cube"] = "refuse"
    precision: Literal["auto", "double"] = "auto"
    motion_in_chirp: Flag = False
