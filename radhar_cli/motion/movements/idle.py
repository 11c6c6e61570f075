"""Small movements at rest: sway, breath, fidgets and shuffles (`motion.human.idle`)."""

from collections.abc import Iterable
from math import pi
from typing import Annotated, Generic

import numpy as np

from radhar_cli.motion.human.idle import Waves, spread_phases
from radhar_cli.schema.annotations import UNSTEADY, People
from radhar_cli.schema.number import FREQUENCY, NOT_NEGATIVE, RATIO, SECONDS, uniform
from radhar_cli.schema.section import B, ByActivity, Section, default_draw


class IdleConfig(Section, Generic[B]):
    """Small movements of people who stand or sit."""

    fidget_hz: Annotated[B, ByActivity(NOT_NEGATIVE, FREQUENCY), People("", 0, 2), UNSTEADY] = (
        default_draw(uniform(0.0, 0.4))
    )
    """Fidgets of a standing or seated person per second, in the mean."""
    fidget_size: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("", 0, 2)] = default_draw(
        uniform(0.5, 1.5)
    )
    """Size of a person's fidgets, relative to the usual one."""
    shuffle_hz: Annotated[
        B, ByActivity(NOT_NEGATIVE, FREQUENCY), People("S1 S4", 0, 0.5), UNSTEADY
    ] = default_draw(uniform(0.0, 0.2))
    """Steps of some centimetres a second of a standing person (S1, and S4 afterwards)."""
    phase_s: Annotated[B, ByActivity(NOT_NEGATIVE, SECONDS), People("")] = default_draw(
        uniform(0.0, 1000.0)
    )
    """Time offset of sway, breathing, pulse and speed variation."""


SECTION = IdleConfig


def low_pass_waves(
    idle: IdleConfig[float], deviation: float, rates: Iterable[float], first: float
) -> Waves:
    """Low-pass waves of a standard deviation that have been going on for `idle.phase_s`."""
    f = tuple(rates)
    phases = np.array(spread_phases(len(f), first)) + 2 * pi * np.array(f) * idle.phase_s
    return Waves.low_pass(deviation, tuple(phases % (2 * pi)), f) if deviation else Waves()
