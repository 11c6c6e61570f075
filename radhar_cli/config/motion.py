"""How people move: what each movement takes, and when the phases of an activity begin."""

from typing import TYPE_CHECKING, Annotated, Any, Generic, Literal

from pydantic import Field

from radhar_cli.activities.activity import GESTURES
from radhar_cli.motion.movements import catalogue
from radhar_cli.schema.annotations import (
    ABOVE_ZERO,
    PERSONAL,
    UNSTEADY,
    ActsIf,
    ActsIfNull,
    ByModel,
    Paper,
    People,
    Unless,
)
from radhar_cli.schema.number import (
    ANGLE,
    COORDINATE,
    FREQUENCY,
    NOT_NEGATIVE,
    RATIO,
    SECONDS,
    SPEED,
    Choice,
    normal,
    uniform,
    vary,
    within,
)
from radhar_cli.schema.section import B, ByActivity, Section, by_activity, default_draw, defaults_of

FallName = Literal["forward", "backward", "sideways"]


FALLS: tuple[FallName, ...] = FallName.__args__  # type: ignore[attr-defined]


WALKING_SPEED = normal(1.3, 0.18, 0.7, 2.0)
RUNNING_SPEED = normal(3.3, 0.7, 2.5, 6.0)


RUNS = "running jogging_in_place"


LIMPS = "limping walking_with_stick"


SEATS = (
    "sitting sitting_down standing_up falling_off_seat falling_on_rising drinking_seated "
    "writing_seated"
)
LYING = "lying turning_over lying_down getting_up_from_bed"


class Falls(Section):
    """``{choice: [forward, forward, sideways]}``: one of the directions, equally likely."""

    choice: Annotated[tuple[FallName, ...], Field(min_length=1)]

    @property
    def ordered(self) -> tuple[FallName, ...]:
        """The directions in the order of FALLS, whichever was written first."""
        return tuple(sorted(self.choice, key=FALLS.index))


# Towards the radar as often as away from it, whatever people do; nominal ones face it.
_HEADING = Choice(choice=(uniform(150.0, 210.0), uniform(-30.0, 30.0)))


ZONED = Unless("places_people", "stream, whose zone says where people are")
NOT_OF_STREAMS = Unless("stream", "stream, which is cut anywhere")


_GAIT = "S8 S9 S10 S11 S12"


class WalkingConfig(Section, Generic[B]):
    """How people walk (motion.model: human); the paper's gait takes the speed alone."""

    speed_mps: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SPEED, null=True),
        People("walking", 0.3, 2.8),
        Paper(_GAIT),
        PERSONAL,
        ByModel(human=WALKING_SPEED, paper=1.5),
    ] = default_draw(None)
    """Walking speed. The default is that of people of 1.7 m; of others at the same Froude
    number."""
    period_scale: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("walking", 0.85, 1.05), PERSONAL
    ] = default_draw(normal(0.95, 0.04, 0.85, 1.05))
    """Stride time relative to Boulic and Thalmann's."""
    arm_swing: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("walking", 0, 2), PERSONAL] = (
        default_draw(uniform(0.6, 1.3))
    )
    """Arm swing of a walker, relative to Boulic and Thalmann's."""
    trunk_pitch_deg: Annotated[B, ByActivity(ANGLE), People("walking", -5, 15), PERSONAL] = (
        default_draw(normal(3.0, 2.0, -2.0, 8.0))
    )
    """Forward pitch of a walker's trunk."""
    step_width: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("walking", 0.02, 0.1), PERSONAL
    ] = default_draw(normal(0.063, 0.011, 0.03, 0.1))
    """Distance across between a walker's feet, relative to the stature."""
    speed_variation: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("walking", 0, 0.06), UNSTEADY
    ] = default_draw(uniform(0.0, 0.06))
    """Standard deviation of a walker's speed over time, relative to the speed; that of the stride
    times is half as much, that of the step width a third, in metres."""
    lane_m: Annotated[B, ZONED, ByActivity(COORDINATE), People("walking", 0, 1000)] = default_draw(
        0.0
    )
    """Length of the lane after which walkers turn round, again and again; 0 is never."""
    lane_start: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, RATIO),
        People("walking", 0, 1),
        ActsIf("motion.walking.lane_m", ABOVE_ZERO),
    ] = default_draw(uniform(0.0, 1.0))
    """Share of the first lane that lies behind a walker at 0 s."""
    speed_up: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("walking", 0.4, 2)] = (
        default_draw(0.6)
    )
    """Strides in which a walker gains speed from rest; more above half of gravity."""


class RunningConfig(Section, Generic[B]):
    """How people run, and jog on the spot."""

    speed_mps: Annotated[
        B, ByActivity(NOT_NEGATIVE, SPEED), People("running", 1.0, 7.0), PERSONAL
    ] = default_draw(RUNNING_SPEED)
    """Speed of a run. The default is that of people of 1.7 m; of others at the same Froude
    number."""
    cadence: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(RUNS, 0.85, 1.15), PERSONAL] = (
        default_draw(normal(1.0, 0.05, 0.9, 1.1))
    )
    """Steps per second of a run, relative to the usual ones at its speed."""
    trunk_pitch_deg: Annotated[B, ByActivity(ANGLE), People(RUNS, -5, 25), PERSONAL] = default_draw(
        normal(7.0, 3.0, 1.0, 15.0)
    )
    """Forward pitch of a runner's trunk."""
    arm_swing: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(RUNS, 0, 1.6), PERSONAL] = (
        default_draw(uniform(0.7, 1.3))
    )
    """Arm swing of a runner, relative to the usual one."""
    elbow_deg: Annotated[B, ByActivity(ANGLE), People(RUNS, 40, 120), PERSONAL] = default_draw(
        normal(90.0, 12.0, 65.0, 115.0)
    )
    """Mean flexion of a runner's elbows."""
    knee_deg: Annotated[B, ByActivity(ANGLE), People("jogging_in_place", 45, 115), PERSONAL] = (
        default_draw(uniform(60.0, 105.0))
    )
    """Largest flexion of the knees in jogging on the spot."""
    variation: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(RUNS, 0, 0.05), UNSTEADY] = (
        default_draw(uniform(0.0, 0.03))
    )
    """Relative standard deviation of the time and of the speed of a runner's steps."""


class LimpingConfig(Section, Generic[B]):
    """How people limp, to spare a leg whose side is drawn; a stick goes with it."""

    pace: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("limping", 0.3, 1), PERSONAL] = (
        default_draw(normal(0.72, 0.08, 0.5, 0.95))
    )
    """Speed of a limper, relative to motion.walking.speed_mps."""
    asymmetry: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(LIMPS, 0, 0.25), PERSONAL] = (
        default_draw(uniform(0.05, 0.2))
    )
    """Share by which the painful leg stands shorter on the floor, and the other one longer; less
    of who goes fast: 0.25 at most at 1.3 m/s of a person of 1.75 m, and none from 2 m/s on."""
    lean_deg: Annotated[B, ByActivity(ANGLE), People(LIMPS, 0, 15), PERSONAL] = default_draw(
        uniform(1.0, 8.0)
    )
    """Lean of a limper's trunk over the painful leg."""


class AidsConfig(Section, Generic[B]):
    """How people walk with a stick or a walker, which itself does not scatter."""

    stick_pace: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("walking_with_stick", 0.3, 1), PERSONAL
    ] = default_draw(normal(0.62, 0.1, 0.4, 0.9))
    """Speed with a stick, relative to motion.walking.speed_mps."""
    walker_pace: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("walking_with_walker", 0.2, 1), PERSONAL
    ] = default_draw(normal(0.45, 0.08, 0.25, 0.7))
    """Speed with a rollator, relative to motion.walking.speed_mps; that with a frame is half as
    high, and at most 0.45 m/s of a person of 1.7 m."""
    walker_pitch_deg: Annotated[
        B, ByActivity(ANGLE), People("walking_with_walker", 0, 35), PERSONAL
    ] = default_draw(normal(16.0, 5.0, 5.0, 28.0))
    """Forward pitch of the trunk behind a walker."""
    rollator: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("walking_with_walker", 0, 1), PERSONAL
    ] = default_draw(Choice(choice=(0, 1)))
    """What the walker is: 1 is a rollator, 0 a frame that is lifted once a stride."""


class CarryingConfig(Section, Generic[B]):
    """How people carry something, which itself does not scatter."""

    pace: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("carrying", 0.4, 1)] = default_draw(
        normal(0.9, 0.06, 0.7, 1.0)
    )
    """Speed with a load, relative to motion.walking.speed_mps."""
    bag: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("carrying", 0, 1)] = default_draw(
        Choice(choice=(0, 1))
    )
    """What is carried: 0 is a box in both hands before the trunk, 1 a bag in one hand."""


class PaperGaitConfig(Section, Generic[B]):
    """The gait, kick and punch of the paper's formulas (motion.model: paper)."""

    gait_hz: Annotated[
        B, ByActivity(NOT_NEGATIVE, FREQUENCY), Paper(f"S2 S3 S4 S7 {_GAIT}"), PERSONAL
    ] = default_draw(1.0)
    """Strides per second in the paper's gait."""
    thigh_deg: Annotated[B, ByActivity(ANGLE), Paper(f"S3 {_GAIT}"), PERSONAL] = default_draw(
        vary(30.0, 0.2)
    )
    """Peak angle of the thigh in the paper's gait and kick."""
    calf_deg: Annotated[B, ByActivity(ANGLE), Paper(f"S2 S3 {_GAIT}"), PERSONAL] = default_draw(
        vary(45.0, 0.2)
    )
    """Peak angle of the calf in the paper's gait, punch and kick."""
    arm_deg: Annotated[B, ByActivity(ANGLE), Paper(f"S2 {_GAIT}"), PERSONAL] = default_draw(
        vary(35.0, 0.2)
    )
    """Peak angle of the arm in the paper's gait and punch."""


class RotatingConfig(Section, Generic[B]):
    """How a body rotates on the spot (S7)."""

    turn_deg: Annotated[
        B, ByActivity(ANGLE), People("body_rotating", -90, 90), Paper("S7"), PERSONAL
    ] = default_draw(vary(45.0, 0.2))
    """Angle through which a rotating body (S7) turns to each side."""
    rotation_hz: Annotated[
        B, ByActivity(NOT_NEGATIVE, FREQUENCY), People("body_rotating", 0, 1)
    ] = default_draw(vary(0.45, 0.2))
    """Turns of a rotating body (S7), to both sides, per second."""


class ExercisesConfig(Section, Generic[B]):
    """How exercises are done: squats, jumps, lunges and the like."""

    period: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("exercises", 0.6, 1.8)] = (
        default_draw(uniform(0.8, 1.3))
    )
    """Duration of a repetition of an exercise, relative to the usual one."""
    size: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("exercises", 0.5, 1.1)] = (
        default_draw(uniform(0.75, 1.05))
    )
    """Extent of the movements of an exercise, relative to the usual one."""


WRITING = "writing writing_seated"


DRINKING = "drinking drinking_seated"


ALL_GESTURES = " ".join(GESTURES)


class GesturesConfig(Section, Generic[B]):
    """How arms are moved: drinking, writing, waving, clapping."""

    left_handed: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People(ALL_GESTURES, 0, 1), PERSONAL
    ] = default_draw(Choice(choice=(0,) * 9 + (1,)))
    """Hand that is used: 1 is the left one, 0 the right one."""
    drink_s: Annotated[B, ByActivity(NOT_NEGATIVE, SECONDS), People(DRINKING, 3, 60)] = (
        default_draw(normal(5.9, 1.2, 3.5, 9.0))
    )
    """Duration of a drink at a table, from reaching for the cup to returning; the next one follows.
    Who stands has the cup in the hand, and takes 0.65 of that."""
    cup_held: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("drinking", 0, 1)] = (
        default_draw(Choice(choice=(0, 1)))
    )
    """Place of the cup between drinks of who stands: 1 holds it ahead, 0 lets the arm hang."""
    strokes_hz: Annotated[B, ByActivity(NOT_NEGATIVE, FREQUENCY), People(WRITING, 1, 6)] = (
        default_draw(normal(4.0, 0.8, 2.5, 5.5))
    )
    """Strokes up and down of handwriting per second; at a board there are 0.7 of that."""
    waving_hz: Annotated[B, ByActivity(NOT_NEGATIVE, FREQUENCY), People("waving", 0.5, 2.5)] = (
        default_draw(normal(1.5, 0.3, 0.9, 2.2))
    )
    """Swings of a waving forearm, to both sides, per second."""
    raise_deg: Annotated[B, ByActivity(ANGLE), People("waving", 30, 100)] = default_draw(
        normal(60.0, 12.0, 38.0, 85.0)
    )
    """Angle of a waving upper arm ahead of the vertical."""
    both_hands: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("waving", 0, 1)] = (
        default_draw(Choice(choice=(0, 0, 0, 1)))
    )
    """Whether both arms wave: 1 for both, 0 for one."""
    clapping_hz: Annotated[B, ByActivity(NOT_NEGATIVE, FREQUENCY), People("clapping", 1, 5)] = (
        default_draw(normal(3.0, 0.6, 1.8, 4.5))
    )
    """Claps per second."""
    size: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People(f"{WRITING} waving clapping", 0.4, 1.3)
    ] = default_draw(uniform(0.6, 1.15))
    """Extent of waves, claps and letters, relative to the usual one."""


class GrabbingConfig(Section, Generic[B]):
    """How something is picked up from the floor."""

    bend_deg: Annotated[B, ByActivity(ANGLE), People("grabbing", 30, 85)] = default_draw(
        normal(72.0, 5.0, 60.0, 85.0)
    )
    """Forward pitch of the trunk when something is picked up."""
    dwell_s: Annotated[B, ByActivity(COORDINATE), People("grabbing", -1, 60)] = default_draw(
        uniform(0.2, 0.6)
    )
    """Time that the hand stays at the floor when something is picked up; below 0 the rise begins
    before the descent ends, by at most 0.6 of it."""


class SittingConfig(Section, Generic[B]):
    """How people sit down, sit, and stand up."""

    seat_height: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(SEATS, 0.24, 0.33)] = (
        default_draw(normal(0.285, 0.015, 0.25, 0.32))
    )
    """Height of the seated hip, relative to the stature."""
    lean_deg: Annotated[
        B,
        ByActivity(ANGLE),
        People("sitting_down standing_up lying_down getting_up_from_bed", 0, 60),
        PERSONAL,
    ] = default_draw(normal(42.0, 8.0, 25.0, 58.0))
    """Forward pitch of the trunk while sitting down or rising."""
    recline_deg: Annotated[B, ByActivity(ANGLE), People(SEATS, -10, 45)] = default_draw(0.0)
    """Backward pitch of the trunk in the seat."""
    hands_on_lap: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(SEATS, 0, 1)] = default_draw(
        1.0
    )
    """Place of a seated person's hands: 0 is beside the seat, 1 on the lap."""


class TransitionsConfig(Section, Generic[B]):
    """What comes with picking up, sitting down and standing up."""

    joint_lag: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, RATIO),
        People("grabbing sitting_down standing_up", 0, 0.6),
        UNSTEADY,
    ] = default_draw(0.0)
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


class FallingConfig(Section, Generic[B]):
    """How people fall, stumble and land."""

    direction: Annotated[
        FallName | Falls, People("falling falling_off_seat falling_on_rising stumbling")
    ] = "forward"
    """Direction of a fall or stumble: forward, backward, sideways, or drawn: {choice: [forward,
    forward, sideways]}."""
    heels_deg: Annotated[B, ByActivity(ANGLE), People("falling", 0, 90), UNSTEADY] = default_draw(
        0.0
    )
    """Angle by which the shanks swing up as people land on their knees in a forward fall."""
    stumble_deg: Annotated[B, ByActivity(ANGLE), People("stumbling tripping", 0, 45)] = (
        default_draw(uniform(15.0, 40.0))
    )
    """Angle of the trunk ahead before a stumble is caught; backwards and sideways it is 0.4 of
    that."""


class LyingConfig(Section, Generic[B]):
    """How people lie, on the floor or in bed, lie down, turn over and get up from bed."""

    roll_deg: Annotated[B, ByActivity(ANGLE), People(LYING, -180, 180)] = default_draw(
        Choice(choice=(0.0, 0.0, 0.0, 90.0, 90.0, -90.0, -90.0, 180.0))
    )
    """How who lies is turned: 0 on the back, 90 on the left side, -90 on the right, 180 on the
    belly."""
    turn_deg: Annotated[B, ByActivity(ANGLE), People("turning_over", -180, 180)] = default_draw(
        Choice(choice=(90.0, -90.0, 180.0, -180.0))
    )
    """How far who turns over rolls, to the left or, below 0, to the right."""
    bed: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("lying turning_over", 0, 1)] = (
        default_draw(Choice(choice=(0.0, 1.0)))
    )
    """Whether who lies at first lies in bed: above 0.5 in bed, else on the floor."""
    bed_height: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(LYING, 0.19, 0.3)] = (
        default_draw(normal(0.25, 0.02, 0.2, 0.29))
    )
    """Height of the mattress under a person, relative to the stature."""
    head_deg: Annotated[B, ByActivity(ANGLE), People("lying turning_over", -360, 360)] = (
        default_draw(uniform(-180.0, 180.0))
    )
    """Direction of the head of who lies at first, from where people head (angle_deg)."""
    hands: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(LYING, 0, 1)] = default_draw(
        uniform(0.0, 1.0)
    )
    """Place of the hands of who lies on the back: 0 is beside the body, 1 on the belly."""


class CrawlingConfig(Section, Generic[B]):
    """How people crawl on hands and knees."""

    speed_mps: Annotated[B, ByActivity(NOT_NEGATIVE, SPEED), People("crawling", 0.2, 1.0)] = (
        default_draw(normal(0.5, 0.12, 0.28, 0.9))
    )
    """Speed of crawling."""
    stride: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("crawling", 0.8, 1.2)] = (
        default_draw(normal(1.0, 0.07, 0.85, 1.15))
    )
    """Length of a crawling stride, relative to the usual one of the speed and stature."""
    variation: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("crawling", 0, 0.05), UNSTEADY
    ] = default_draw(uniform(0.0, 0.04))
    """Standard deviation of where hands and knees are put down, relative to the stride."""


class KneelingConfig(Section, Generic[B]):
    """How people kneel."""

    sit_back: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("kneeling kneeling_down", 0, 1)
    ] = default_draw(Choice(choice=(0.0, 1.0)))
    """How far who kneels sits back: 0 is upright on the knees, 1 on the heels."""


class IdleConfig(Section, Generic[B]):
    """What people do who stand or sit."""

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
    """Steps of some centimetres per second, of who stands (S1, and S4 afterwards)."""
    phase_s: Annotated[B, ByActivity(NOT_NEGATIVE, SECONDS), People("")] = default_draw(
        uniform(0.0, 1000.0)
    )
    """Time offset of sway, breathing, pulse and speed variation."""


class PlaceConfig(Section, Generic[B]):
    """Where people are at one instant of the recording, whatever they do.

    Who walks is there on the way: the course goes through the place at an instant at which all of
    it stays within what radar, wall and room allow, where there is one.
    """

    range_m: Annotated[B, ByActivity(COORDINATE)] = default_draw(uniform(2.0, 8.0))
    """Range at which people are."""
    cross_range_m: Annotated[B, ByActivity(COORDINATE), ActsIfNull("motion.cross_range_m")] = (
        default_draw(uniform(-1.0, 1.0))
    )
    """Cross-range at which people are, positive to the left."""
    instant: Annotated[B, ByActivity(within(0, 1))] = default_draw(uniform(0.0, 1.0))
    """Share of the recording in which people who walk are nearer than their place: 0 has it at the
    near end of the course, 1 at the far end, as far as the whole course is possible. A law of it is
    drawn by the mean of its own rank and that of `range_m`: who is far is so at a far end."""


SECTIONS = dict(
    sorted(
        {
            **catalogue.SECTIONS,
            "walking": WalkingConfig,
            "running": RunningConfig,
            "limping": LimpingConfig,
            "aids": AidsConfig,
            "carrying": CarryingConfig,
            "paper": PaperGaitConfig,
            "rotating": RotatingConfig,
            "exercises": ExercisesConfig,
            "gestures": GesturesConfig,
            "grabbing": GrabbingConfig,
            "sitting": SittingConfig,
            "transitions": TransitionsConfig,
            "falling": FallingConfig,
            "lying": LyingConfig,
            "crawling": CrawlingConfig,
            "kneeling": KneelingConfig,
            "idle": IdleConfig,
        }.items(),
        key=lambda item: catalogue.ORDER.index(item[0]) if item[0] in catalogue.ORDER else 99,
    )
)


class MotionConfig(Section, Generic[B]):
    """Where people stand, where they head and how they move, by movement and model of motion.

    What another model alone knows is ignored; what is null takes the value of the model.
    """

    model: Literal["human", "paper", "file"] = "human"
    """Model of motion: human for measured gaits and movements, paper for the paper's formulas, file
    for motion files in every class (docs/guide/motion.md)."""
    folder: Annotated[str | None, Field(exclude=True, max_length=1000)] = None
    """Folder that paths of motion files are relative to; not part of a data set's identity."""
    place: Annotated[PlaceConfig[B], ZONED, ActsIfNull("motion.range_m")] = defaults_of(PlaceConfig)
    range_m: Annotated[
        B, ZONED, ByActivity(COORDINATE, null=True), ByModel(paper=uniform(1.0, 3.0))
    ] = default_draw(None)
    """Range at which people start: of the torso (paper), of the feet (human); null has people where
    motion.place says."""
    cross_range_m: Annotated[B, ZONED, ByActivity(COORDINATE, null=True), ByModel(paper=0.0)] = (
        default_draw(None)
    )
    """Cross-range at which people start, positive to the left; null is 0 where motion.range_m is
    given, else motion.place."""
    angle_deg: Annotated[
        B,
        ZONED,
        ByActivity(ANGLE, null=True),
        ByModel(human=_HEADING, paper=uniform(-30.0, 30.0), file=_HEADING),
    ] = default_draw(None)
    """Heading of people; 0 faces away from the radar, 180 faces it."""
    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Sections of the movements, which their files have."""
    else:
        __annotations__ |= SECTIONS
        locals().update({name: defaults_of(kind) for name, kind in SECTIONS.items()})


class TimingConfig(Section, Generic[B]):
    """When the phases of an activity begin and how long they last.

    What is null takes the value of the model.
    """

    onset: Annotated[B, NOT_OF_STREAMS, ByActivity(within(0, 1)), People("", 0, 1)] = default_draw(
        uniform(0.0, 1.0)
    )
    """When people begin, before or during the recording: 0 is the earliest instant that leaves
    enough of the movement to be seen, 1 the latest."""
    visible: Annotated[B, NOT_OF_STREAMS, ByActivity(within(0, 1)), People("", 0, 1)] = (
        default_draw(0.75)
    )
    """Share of a movement that is seen at least; of the recording, for what lasts or is longer."""
    seat_start_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S5 S6"),
        Paper("S5 S6"),
        ByModel(paper=0.5),
    ] = default_draw(None)
    """When sitting down or standing up begins; null of people is by timing.onset."""
    seat_duration_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S5 S6", 1, 60),
        Paper("S5 S6"),
        ByModel(
            human=by_activity(normal(2.0, 0.4, 1.3, 3.0), standing_up=normal(1.8, 0.4, 1.2, 3.0)),
            paper=2.0,
        ),
    ] = default_draw(None)
    """Duration of sitting down or standing up."""
    grab_start_s: Annotated[B, ByActivity(NOT_NEGATIVE, SECONDS, null=True), People("S4")] = (
        default_draw(None)
    )
    """When picking up begins; null is by timing.onset."""
    grab_duration_s: Annotated[B, ByActivity(NOT_NEGATIVE, SECONDS), People("S4", 1, 60)] = (
        default_draw(normal(2.5, 0.5, 1.6, 3.6))
    )
    """Duration of picking up, down and up together."""
    rise_start_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S9 S11"),
        Paper("S9 S11"),
        ByModel(paper=0.5),
    ] = default_draw(None)
    """When standing up or getting up before a walk begins; null of people is by timing.onset."""
    rise_duration_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S9 S11", 1, 60),
        Paper("S9 S11"),
        ByModel(
            human=by_activity(
                normal(1.8, 0.25, 1.2, 3.0), falling_to_walking=normal(3.0, 0.5, 2.2, 4.5)
            ),
            paper=1.5,
        ),
    ] = default_draw(None)
    """Duration of standing up or getting up before a walk."""
    walk_begin_s: Annotated[
        B | None, ByActivity(NOT_NEGATIVE, SECONDS, null=True), People("S8", 0, 600)
    ] = default_draw(None)
    """When the walk of S8 begins, after standing; null is by timing.onset, before or after 0 s."""
    walk_start_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S9 S11", 0, 600),
        Paper("S9 S11"),
        ByModel(paper=2.0),
    ] = default_draw(None)
    """When the walk after rising begins; null of people is when they have risen, less overlap_s."""
    walk_stop_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S10 S12", 0.5, 600),
        Paper("S10 S12"),
        ByModel(paper=2.0),
    ] = default_draw(None)
    """When the walk before sitting down or falling begins to end; null of people is by
    timing.onset, which says when sitting down or falling begins."""
    sit_duration_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S10", 1, 60),
        Paper("S10"),
        ByModel(human=normal(2.0, 0.25, 1.3, 3.0), paper=1.5),
    ] = default_draw(None)
    """Duration of sitting down after a walk."""
    fall_duration_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S12", 0.7, 10),
        Paper("S12"),
        ByModel(human=normal(1.1, 0.4, 0.9, 2.0), paper=0.8),
    ] = default_draw(None)
    """Duration of the fall after a walk."""
    blend_s: Annotated[B, ByActivity(NOT_NEGATIVE, SECONDS), Paper("S9 S10 S11 S12")] = (
        default_draw(0.3)
    )
    """Duration of the raised-cosine ramps of the gait, in and out; 0 is a hard switch."""
    overlap_s: Annotated[B, ByActivity(NOT_NEGATIVE, SECONDS), People("S9 S10 S11 S12", 0, 0.8)] = (
        default_draw(0.0)
    )
    """Time by which the second movement starts before the first ends, unless walk_start_s says
    when. A scene gets at most 0.3 of the duration of rising, sitting down or falling, and nothing
    of a fall to the side: its number is what it got."""


# Where keys of earlier versions are; the random streams of numbers keep those names.
EARLIER_KEYS = {
    "motion.walking.speed_mps": "motion.speed_mps",
    "motion.walking.period_scale": "motion.period_scale",
    "motion.walking.arm_swing": "motion.arm_swing",
    "motion.walking.trunk_pitch_deg": "motion.trunk_pitch_deg",
    "motion.walking.step_width": "motion.step_width",
    "motion.walking.speed_variation": "motion.speed_variation",
    "motion.walking.lane_m": "motion.lane_m",
    "motion.walking.lane_start": "motion.lane_start",
    "motion.walking.speed_up": "motion.speed_up",
    "motion.paper.gait_hz": "motion.gait_hz",
    "motion.paper.thigh_deg": "motion.thigh_deg",
    "motion.paper.calf_deg": "motion.calf_deg",
    "motion.paper.arm_deg": "motion.arm_deg",
    "motion.rotating.turn_deg": "motion.turn_deg",
    "motion.rotating.rotation_hz": "motion.rotation_hz",
    "motion.striking.punch_hz": "motion.punch_hz",
    "motion.striking.kick_hz": "motion.kick_hz",
    "motion.striking.strike_scale": "motion.strike_scale",
    "motion.exercises.period": "motion.exercise_period",
    "motion.exercises.size": "motion.exercise_size",
    "motion.repeating.cycle_phase": "motion.cycle_phase",
    "motion.repeating.tempo_jitter": "motion.tempo_jitter",
    "motion.repeating.size_jitter": "motion.size_jitter",
    "motion.grabbing.bend_deg": "motion.bend_deg",
    "motion.grabbing.dwell_s": "motion.dwell_s",
    "motion.sitting.seat_height": "motion.seat_height",
    "motion.sitting.lean_deg": "motion.lean_deg",
    "motion.sitting.recline_deg": "motion.recline_deg",
    "motion.sitting.hands_on_lap": "motion.hands_on_lap",
    "motion.transitions.joint_lag": "motion.joint_lag",
    "motion.transitions.step_m": "motion.step_m",
    "motion.transitions.settle_size": "motion.settle_size",
    "motion.falling.direction": "motion.fall",
    "motion.falling.heels_deg": "motion.heels_deg",
    "motion.falling.stumble_deg": "motion.stumble_deg",
    "motion.idle.fidget_hz": "motion.fidget_hz",
    "motion.idle.fidget_size": "motion.fidget_size",
    "motion.idle.shuffle_hz": "motion.shuffle_hz",
    "motion.idle.phase_s": "motion.idle_phase_s",
}
