"""Detection of points in the frames of a board (docs/guide/boards.md)."""

from typing import Annotated, Literal

from pydantic import Field

from radhar_cli.radar.detection import Chain
from radhar_cli.schema.annotations import NeedsKey
from radhar_cli.schema.section import Flag, Section


class CloudConfig(Section):
    """Detection of points in the frames of a board (docs/guide/boards.md)."""

    chain: Chain = "best"
    """Detection chain: best is what the data allow, the others what TI's firmware does with the
    .cfg, board the chain of the file's firmware: the default where it has the commands of one."""
    pfa: Annotated[float, Field(gt=0, le=0.1, strict=True), NeedsKey("cloud.chain", "best")] = 1e-5
    """Rate of false alarms of a range-Doppler cell."""
    quantise: Annotated[Flag, NeedsKey("cloud.chain", "board", "sdk1", "sdk3")] = True
    """Whether numbers are rounded as the firmware's fixed-point ones."""
    boundary_box: Flag = False
    """Whether points outside boundaryBox of the .cfg (SceneryParam of people counting), a box in
    the room, are left out; boards send them, and their trackers leave them out."""
    doppler_carrier: Literal["centre", "start"] = "centre"
    """Frequency that the points' speeds refer to; TI's software takes that at which ramps start."""
