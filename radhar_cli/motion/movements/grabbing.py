"""S4: people who bend to pick something up from the floor."""

from dataclasses import dataclass, field
from math import radians
from typing import Annotated, Generic

from radhar_cli.motion.human.minimum_jerk import Course, Lags, Step
from radhar_cli.motion.human.part import Phase
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import Planted, resting_channels
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.transitions import draw_lags
from radhar_cli.motion.movements.words import ON_FLOOR
from radhar_cli.schema.annotations import People
from radhar_cli.schema.number import ANGLE, COORDINATE, NOT_NEGATIVE, SECONDS, normal, uniform
from radhar_cli.schema.section import B, ByActivity, Section, default_draw


class GrabbingConfig(Section, Generic[B]):
    """Picking something up from the floor."""

    bend_deg: Annotated[B, ByActivity(ANGLE), People("grabbing", 30, 85)] = default_draw(
        normal(72.0, 5.0, 60.0, 85.0)
    )
    """Forward pitch of the trunk when something is picked up."""
    dwell_s: Annotated[B, ByActivity(COORDINATE), People("grabbing", -1, 60)] = default_draw(
        uniform(0.2, 0.6)
    )
    """Time that the hand stays at the floor when something is picked up; below 0 the rise begins
    before the descent ends, by at most 0.6 of it."""


class GrabbingTiming(Section, Generic[B]):
    """Beginning and duration of picking something up."""

    grab_start_s: Annotated[B, ByActivity(NOT_NEGATIVE, SECONDS, null=True), People("S4")] = (
        default_draw(None)
    )
    """Beginning of picking up; null is by timing.onset."""
    grab_duration_s: Annotated[B, ByActivity(NOT_NEGATIVE, SECONDS), People("S4", 1, 60)] = (
        default_draw(normal(2.5, 0.5, 1.6, 3.6))
    )
    """Duration of picking up, down and up together."""


SECTION, TIMING = GrabbingConfig, GrabbingTiming


@dataclass(frozen=True)
class Grab:
    """Bends down within `down` s, dwells, and rises within `up` s; angles at the floor in rad.

    A negative dwell lets the rise begin before the descent ends, by at most 0.6 of it.
    """

    down: float = 1.2
    dwell: float = 0.4
    up: float = 1.3
    shank: float = radians(20)
    thigh: float = radians(-62)
    trunk: float = radians(72)
    reach: float = radians(12)  # angle of the right arm ahead of the vertical
    other_arm: float = 0.55  # flexion of the left shoulder over that of the right one
    # lowering, rising: which joints lead and which lag
    lowering: Lags = field(default_factory=Lags)
    rising: Lags = field(default_factory=Lags)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        rest = resting_channels(person)
        arm = self.trunk + self.reach  # flexion is relative to the trunk
        bent = {
            "shank": self.shank,
            "thigh": self.thigh,
            "trunk": self.trunk,
            "right_shoulder": arm,
            "left_shoulder": self.other_arm * arm,
        }
        rises = begin + self.down + max(self.dwell, -0.6 * self.down)
        steps = self.lowering(
            Step(channel, angle - rest[channel], begin, self.down)
            for channel, angle in bent.items()
        )
        steps += self.rising(
            Step(channel, rest[channel] - angle, rises, self.up) for channel, angle in bent.items()
        )
        end = rises + self.up
        phases = (Phase(begin, "picking up"), Phase(end, "standing"))
        return Planted(person, Course.of(rest, steps), begin, end, phases)


def make_grab(mover: Mover) -> Grab:
    """Make a person pick something up."""
    grabbing, (lowering, rising) = mover.numbers(GrabbingConfig[float]), draw_lags(mover)
    return Grab(
        down=mover.duration * 1.2 / 2.5,
        dwell=grabbing.dwell_s,
        up=mover.duration * 1.3 / 2.5,
        thigh=radians(-62) * grabbing.bend_deg / 72,
        trunk=radians(grabbing.bend_deg),
        lowering=lowering,
        rising=rising,
    )


MOVEMENTS = (
    MovementKind(
        "grabbing",
        "bends down, picks something up and stands again",
        make_grab,
        seconds=2.5,
        in_place=True,
        uses=("transitions.joint_lag",),
        steps=(0.8, 0.4),
        gestures=(  # what was picked up is looked at
            ("right_elbow", 0.4, True, -1.1, 0.8),
            ("right_elbow", 0.0, True, 0.4, 0.8),
        ),
        words="picking_up pick_up picking picking_object picking_up_objects picking_up_object "
        "pick_up_object pick_up_an_object picking_up_things pick_up_things grasping grab pickup "
        "pickup_object pick_up_things_from_floor",
        manners=ON_FLOOR,
        nearby="bending bending_down bend reaching lifting bowing bow stooping bending_over "
        "lift_box tie_shoes stoop body_extension",
    ),
)
