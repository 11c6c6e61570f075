"""`engine:` how the echo is computed."""

from typing import Annotated, Literal

from pydantic import Field

from radhar_cli.config.section import Flag, Section


class EngineConfig(Section):
    """`cube` is the exact float64 reference; `direct` the closed form, with its three settings.

    The settings of `direct` are floors: where a scene needs more (a fast gait, a scatterer that
    brushes an antenna, an MTI that cancels almost everything) the engine takes more.
    `motion_in_chirp` lets the paths of the cube go on moving during a chirp.
    """

    kind: Literal["direct", "cube"] = "direct"
    kinematics_hz: Annotated[float, Field(gt=0, le=1e9, strict=True)] = 250.0
    table_oversampling: Annotated[int, Field(ge=2, le=1024, strict=True)] = 16
    precision: Literal["single", "double"] = "single"
    motion_in_chirp: Flag = False
