"""The gait, kick and punch of the paper's formulas, which `motion.paper` has."""

from math import radians
from typing import Annotated, Generic

from radhar_cli.motion.paper.activities import PaperGait
from radhar_cli.schema.annotations import PERSONAL, Paper
from radhar_cli.schema.number import ANGLE, FREQUENCY, NOT_NEGATIVE, SECONDS, vary
from radhar_cli.schema.section import B, ByActivity, Section, default_draw


class PaperGaitConfig(Section, Generic[B]):
    """The gait, kick and punch of the paper's formulas (motion.model: paper)."""

    gait_hz: Annotated[
        B, ByActivity(NOT_NEGATIVE, FREQUENCY), Paper("S2 S3 S4 S7 S8 S9 S10 S11 S12"), PERSONAL
    ] = default_draw(1.0)
    """Strides per second in the paper's gait."""
    thigh_deg: Annotated[B, ByActivity(ANGLE), Paper("S3 S8 S9 S10 S11 S12"), PERSONAL] = (
        default_draw(vary(30.0, 0.2))
    )
    """Peak angle of the thigh in the paper's gait and kick."""
    calf_deg: Annotated[B, ByActivity(ANGLE), Paper("S2 S3 S8 S9 S10 S11 S12"), PERSONAL] = (
        default_draw(vary(45.0, 0.2))
    )
    """Peak angle of the calf in the paper's gait, punch and kick."""
    arm_deg: Annotated[B, ByActivity(ANGLE), Paper("S2 S8 S9 S10 S11 S12"), PERSONAL] = (
        default_draw(vary(35.0, 0.2))
    )
    """Peak angle of the arm in the paper's gait and punch."""

    def make_gait(self: "PaperGaitConfig[float]", turn_deg: float, speed: float) -> PaperGait:
        """Make the gait of a scene, with its turn in S7, degrees, and its speed, m/s."""
        return PaperGait(
            frequency=self.gait_hz,
            thigh=radians(self.thigh_deg),
            calf=radians(self.calf_deg),
            arm=radians(self.arm_deg),
            turn=radians(turn_deg),
            speed=speed,
        )


class PaperTiming(Section, Generic[B]):
    """Ramps of the paper's gait."""

    blend_s: Annotated[B, ByActivity(NOT_NEGATIVE, SECONDS), Paper("S9 S10 S11 S12")] = (
        default_draw(0.3)
    )
    """Duration of the raised-cosine ramps of the gait, in and out; 0 is a hard switch."""


SECTION, TIMING = PaperGaitConfig, PaperTiming
