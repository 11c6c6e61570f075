"""Details of picking up, sitting down and standing up: joints that lead, steps, fidgets."""

from typing import Annotated, Generic

from radhar_cli.motion.human.minimum_jerk import Lags
from radhar_cli.motion.human.planted import ELBOWS, LEGS_AND_TRUNK, SHOULDERS
from radhar_cli.motion.movements.kind import Mover
from radhar_cli.schema.annotations import UNSTEADY, People
from radhar_cli.schema.number import NOT_NEGATIVE, RATIO, uniform
from radhar_cli.schema.section import B, ByActivity, Section, default_draw


class TransitionsConfig(Section, Generic[B]):
    """Details of picking up, sitting down and standing up."""

    joint_lag: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(None, 0, 0.6), UNSTEADY] = (
        default_draw(0.0)
    )
    """Share of a movement by which some joints lead and others lag; which ones differs between
    recordings."""
    step_m: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("S4 S5 S6", 0, 0.5), UNSTEADY] = (
        default_draw(uniform(0.0, 0.5))
    )
    """Length of the steps back before sitting down (S5), ahead after standing up (S6) and around
    picking up (S4)."""
    settle_size: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("S4 S5 S6", 0, 3), UNSTEADY
    ] = default_draw(uniform(0.0, 3.0))
    """Size of the fidgets around the end of a movement, relative to the usual one."""


SECTION = TransitionsConfig


def draw_lags(mover: Mover) -> tuple[Lags, Lags]:
    """Draw the lags of the joints in going down, and in coming up."""
    rng = mover.stream(f"motion.joint_lag/{mover.place}")
    share = mover.numbers(TransitionsConfig[float]).joint_lag
    channels = (*LEGS_AND_TRUNK, *SHOULDERS, *ELBOWS)
    down, up = (
        Lags(share, dict(zip(channels, rng.random(len(channels)).tolist(), strict=True)))
        for _ in range(2)
    )
    return down, up
