"""People: their bodies, how and when they move, and others in a scene."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field

from radhar_cli.activities.activity import ACTIVITIES
from radhar_cli.config.annotations import (
    ABOVE_ZERO,
    GIVEN,
    PERSONAL,
    UNSTEADY,
    ActsIf,
    ActsIfAny,
    ByModel,
    Limits,
    Paper,
    People,
)
from radhar_cli.config.classes import ClassConfig
from radhar_cli.config.number import (
    Angle,
    Coordinate,
    Frequency,
    Metres,
    Positive,
    Rate,
    Ratio,
    Seconds,
    Share,
    Signed,
    Speed,
    normal,
    uniform,
    value_error,
    vary,
    within,
)
from radhar_cli.config.section import By, Flag, Section, by_activity


class SubjectConfig(Section):
    """The person: body; of the human model also sway, breathing (chest) and pulse (heart)."""

    height_m: Annotated[Positive, within(0.1, 10, "m"), Limits(1.5, 2.1), PERSONAL] = uniform(
        1.5, 1.9
    )
    """Stature of the person."""
    weight_kg: Annotated[Positive | None, within(1e-3, 1e6, "kg"), PERSONAL] = None
    """Body mass of the person; null is 26 kg/m^2 times the height squared."""
    sway_ahead_m: Annotated[Metres, People("", 0, 0.01), PERSONAL] = uniform(0.002, 0.006)
    """Standard deviation of a standing person's sway forwards and backwards."""
    sway_aside_m: Annotated[Metres, People("", 0, 0.01), PERSONAL] = uniform(0.0015, 0.0035)
    """Standard deviation of a standing person's sway to the sides."""
    breathing_hz: Annotated[Rate, People("", 0, 2), PERSONAL] = normal(0.25, 0.04, 0.15, 0.4)
    """Breathing rate, breaths per second."""
    chest_m: Annotated[Metres, People("", 0, 0.01), PERSONAL] = uniform(0.002, 0.006)
    """Amplitude of the chest's motion by breathing."""
    pulse_hz: Annotated[Rate, People("", 0, 4), PERSONAL] = normal(1.15, 0.12, 0.8, 1.8)
    """Heart rate, beats per second."""
    heart_m: Annotated[Metres, People("", 0, 0.002), PERSONAL] = uniform(0.0001, 0.0004)
    """Amplitude of the chest's motion by the heartbeat."""


FallName = Literal["forward", "backward", "sideways"]


FALLS: tuple[FallName, ...] = FallName.__args__  # type: ignore[attr-defined]


SEATS = "sitting_down standing_up falling_off_seat falling_on_rising"


class Falls(Section):
    """``{choice: [forward, forward, sideways]}``: one of the directions, equally likely."""

    choice: Annotated[tuple[FallName, ...], Field(min_length=1)]

    def drawn(self, u: float) -> FallName:
        """The direction at a fraction u, 0 to 1, of the draws."""
        ordered = sorted(self.choice, key=FALLS.index)
        return ordered[min(int(u * len(ordered)), len(ordered) - 1)]


# People face the radar, and in 6 s walk 8 m towards it: they start far enough away, all within its
# half-band of 30 m. Classes of one's own may walk all the time.
_NEARER = {a.slug: uniform(5, 8) if a.walks else uniform(2, 5) for a in ACTIVITIES}


del _NEARER["walking"]


_HUMAN_RANGE = by_activity(uniform(9.0, 12.0), **_NEARER)


_FACING = uniform(150.0, 210.0)


_GAIT = "S8 S9 S10 S11 S12"


class MotionConfig(Section):
    """Where people stand, where they head and how they move, under each model of motion.

    What another model alone knows is ignored; what is null takes the value of the model.
    """

    model: Literal["human", "paper", "file"] = "human"
    """Model of motion: human for measured gaits and movements, paper for the paper's formulas, file
    for motion files in every class (docs/guide/motion.md)."""
    folder: Annotated[str | None, Field(exclude=True, max_length=1000)] = None
    """Folder that paths of motion files are relative to; not part of a data set's identity."""
    range_m: Annotated[
        By[Coordinate] | None,
        ByModel(human=_HUMAN_RANGE, paper=uniform(1.0, 3.0), file=uniform(2.0, 4.0)),
    ] = None
    """Range at which people start: of the torso (paper), of the feet (human)."""
    cross_range_m: By[Coordinate] = 0.0
    """Cross-range at which people start, positive to the left."""
    angle_deg: Annotated[
        By[Angle] | None, ByModel(human=_FACING, paper=uniform(-30.0, 30.0), file=_FACING)
    ] = None
    """Heading of people; 0 faces away from the radar, 180 faces it."""
    speed_mps: Annotated[
        By[Speed] | None,
        People("walking", 0.3, 2.8),
        Paper(_GAIT),
        PERSONAL,
        ByModel(human=normal(1.3, 0.18, 0.7, 2.0), paper=1.5),
    ] = None
    """Walking speed."""
    gait_hz: Annotated[By[Frequency], Paper(f"S2 S3 S4 S7 {_GAIT}"), PERSONAL] = 1.0
    """Strides per second in the paper's gait."""
    thigh_deg: Annotated[By[Angle], Paper(f"S3 {_GAIT}"), PERSONAL] = vary(30.0, 0.2)
    """Peak angle of the thigh in the paper's gait and kick."""
    calf_deg: Annotated[By[Angle], Paper(f"S2 S3 {_GAIT}"), PERSONAL] = vary(45.0, 0.2)
    """Peak angle of the calf in the paper's gait, punch and kick."""
    arm_deg: Annotated[By[Angle], Paper(f"S2 {_GAIT}"), PERSONAL] = vary(35.0, 0.2)
    """Peak angle of the arm in the paper's gait and punch."""
    turn_deg: Annotated[By[Angle], People("body_rotating", -90, 90), Paper("S7"), PERSONAL] = vary(
        45.0, 0.2
    )
    """Angle through which a rotating body (S7) turns to each side."""
    rotation_hz: Annotated[By[Frequency], People("body_rotating", 0, 1)] = vary(0.45, 0.2)
    """Turns of a rotating body (S7), to both sides, per second."""
    period_scale: Annotated[By[Ratio], People("walking", 0.85, 1.05), PERSONAL] = normal(
        0.95, 0.04, 0.85, 1.05
    )
    """Stride time relative to Boulic and Thalmann's."""
    cycle_phase: Annotated[By[Signed], People("punching kicking body_rotating walking", -1, 1)] = (
        uniform(-0.5, 0.5)
    )
    """Initial phase of steady walks, punches, kicks and turns, in cycles."""
    arm_swing: Annotated[By[Ratio], People("walking", 0, 2), PERSONAL] = uniform(0.6, 1.3)
    """Arm swing of a walker, relative to Boulic and Thalmann's."""
    trunk_pitch_deg: Annotated[By[Angle], People("walking", -5, 15), PERSONAL] = normal(
        3.0, 2.0, -2.0, 8.0
    )
    """Forward pitch of a walker's trunk."""
    step_width: Annotated[By[Ratio], People("walking", 0.02, 0.1), PERSONAL] = normal(
        0.063, 0.011, 0.03, 0.1
    )
    """Distance across between a walker's feet, relative to the stature."""
    speed_variation: Annotated[By[Ratio], People("walking", 0, 0.06), UNSTEADY] = uniform(0.0, 0.06)
    """Standard deviation of a walker's speed over time, relative to the speed; that of the stride
    times is half as much, that of the step width a third, in metres."""
    lane_m: Annotated[By[Coordinate], People("walking", 0, 1000)] = 0.0
    """Length of the lane after which walkers turn round, again and again; 0 is never."""
    lane_start: Annotated[
        By[Ratio], People("walking", 0, 1), ActsIf("motion.lane_m", ABOVE_ZERO)
    ] = uniform(0.0, 1.0)
    """Share of the first lane that lies behind a walker at 0 s."""
    speed_up: Annotated[By[Ratio], People("walking", 0.4, 2)] = 0.6
    """Strides in which a walker gains speed from rest."""
    punch_hz: Annotated[By[Frequency], People("punching", 0.05, 1.1)] = vary(0.7, 0.15)
    """Pairs of punches, right and left, per second."""
    kick_hz: Annotated[By[Frequency], People("kicking", 0.05, 0.6)] = vary(0.45, 0.1)
    """Kicks per second."""
    strike_scale: Annotated[By[Ratio], People("punching kicking", 0.8, 1.25), PERSONAL] = normal(
        1.0, 0.12, 0.8, 1.25
    )
    """Duration of a punch or kick, relative to the usual one."""
    exercise_period: Annotated[By[Ratio], People("exercises", 0.6, 1.8)] = uniform(0.8, 1.3)
    """Duration of a repetition of an exercise, relative to the usual one."""
    exercise_size: Annotated[By[Ratio], People("exercises", 0.5, 1.1)] = uniform(0.75, 1.05)
    """Extent of the movements of an exercise, relative to the usual one."""
    tempo_jitter: Annotated[
        By[Ratio], People("punching kicking body_rotating exercises", 0, 0.2), UNSTEADY
    ] = uniform(0.0, 0.1)
    """Relative standard deviation of the time from one punch, kick or turn to the next."""
    size_jitter: Annotated[
        By[Ratio], People("punching kicking body_rotating exercises", 0, 0.15), UNSTEADY
    ] = uniform(0.0, 0.1)
    """Relative standard deviation of the size from one punch, kick or turn to the next."""
    bend_deg: Annotated[By[Angle], People("grabbing", 30, 85)] = normal(72.0, 5.0, 60.0, 85.0)
    """Forward pitch of the trunk when something is picked up."""
    dwell_s: Annotated[By[Coordinate], People("grabbing", -1, 60)] = uniform(0.2, 0.6)
    """Time that the hand stays at the floor when something is picked up; below 0 the rise begins
    before the descent ends, by at most 0.6 of it."""
    seat_height: Annotated[By[Ratio], People(SEATS, 0.24, 0.33)] = normal(0.285, 0.015, 0.25, 0.32)
    """Height of the seated hip, relative to the stature."""
    lean_deg: Annotated[By[Angle], People("sitting_down standing_up", 0, 60), PERSONAL] = normal(
        42.0, 8.0, 25.0, 58.0
    )
    """Forward pitch of the trunk while sitting down or rising."""
    recline_deg: Annotated[By[Angle], People(SEATS, -10, 45)] = 0.0
    """Backward pitch of the trunk in the seat."""
    hands_on_lap: Annotated[By[Ratio], People(SEATS, 0, 1)] = 1.0
    """Place of a seated person's hands: 0 is beside the seat, 1 on the lap."""
    joint_lag: Annotated[
        By[Ratio], People("grabbing sitting_down standing_up", 0, 0.6), UNSTEADY
    ] = 0.0
    """Share of a movement by which some joints lead and others lag; which ones differs between
    recordings."""
    step_m: Annotated[By[Ratio], People("S4 S5 S6", 0, 0.5), UNSTEADY] = uniform(0.0, 0.5)
    """Length of the steps back before sitting down (S5), ahead after standing up (S6) and around
    picking up (S4)."""
    settle_size: Annotated[By[Ratio], People("S4 S5 S6", 0, 3), UNSTEADY] = uniform(0.0, 3.0)
    """Size of the fidgets around the end of a movement, relative to the usual one."""
    heels_deg: Annotated[By[Angle], People("falling", 0, 90), UNSTEADY] = 0.0
    """Angle by which the shanks swing up as people land on their knees in a forward fall."""
    fall: Annotated[
        FallName | Falls, People("falling falling_off_seat falling_on_rising stumbling")
    ] = "forward"
    """Direction of a fall or stumble: forward, backward, sideways, or drawn: {choice: [forward,
    forward, sideways]}."""
    stumble_deg: Annotated[By[Angle], People("stumbling tripping", 0, 45)] = uniform(15.0, 40.0)
    """Angle of the trunk ahead before a stumble is caught; backwards and sideways it is 0.4 of
    that."""
    fidget_hz: Annotated[By[Frequency], People("", 0, 2), UNSTEADY] = uniform(0.0, 0.4)
    """Fidgets of a standing or seated person per second, in the mean."""
    fidget_size: Annotated[By[Ratio], People("", 0, 2)] = uniform(0.5, 1.5)
    """Size of a person's fidgets, relative to the usual one."""
    shuffle_hz: Annotated[By[Frequency], People("S1 S4", 0, 0.5), UNSTEADY] = uniform(0.0, 0.2)
    """Steps of some centimetres per second, of who stands (S1, and S4 afterwards)."""
    idle_phase_s: Annotated[By[Seconds], People("")] = uniform(0.0, 1000.0)
    """Time offset of sway, breathing, pulse and speed variation."""


class TimingConfig(Section):
    """When the phases of an activity begin and how long they last.

    What is null takes the value of the model.
    """

    seat_start_s: Annotated[By[Seconds], People("S5 S6"), Paper("S5 S6")] = 0.5
    """When sitting down or standing up begins."""
    seat_duration_s: Annotated[
        By[Seconds] | None,
        People("S5 S6", 1, 60),
        Paper("S5 S6"),
        ByModel(
            human=by_activity(normal(2.0, 0.4, 1.3, 3.0), standing_up=normal(1.8, 0.4, 1.2, 3.0)),
            paper=2.0,
        ),
    ] = None
    """Duration of sitting down or standing up."""
    grab_start_s: Annotated[By[Seconds], People("S4")] = 0.5
    """When picking up begins."""
    grab_duration_s: Annotated[By[Seconds], People("S4", 1, 60)] = normal(2.5, 0.5, 1.6, 3.6)
    """Duration of picking up, down and up together."""
    rise_start_s: Annotated[By[Seconds], People("S9 S11"), Paper("S9 S11")] = 0.5
    """When standing up or getting up before a walk begins."""
    rise_duration_s: Annotated[
        By[Seconds] | None,
        People("S9 S11", 1, 60),
        Paper("S9 S11"),
        ByModel(
            human=by_activity(
                normal(1.8, 0.25, 1.2, 3.0), falling_to_walking=normal(3.0, 0.5, 2.2, 4.5)
            ),
            paper=1.5,
        ),
    ] = None
    """Duration of standing up or getting up before a walk."""
    walk_begin_s: Annotated[By[Seconds] | None, People("S8", 0, 600)] = None
    """When the walk of S8 begins, after standing; null is a walk that is under way at 0 s."""
    walk_start_s: Annotated[
        By[Seconds] | None, People("S9 S11", 0, 600), Paper("S9 S11"), ByModel(paper=2.0)
    ] = None
    """When the walk after rising begins; null of people is when they have risen, less overlap_s."""
    walk_stop_s: Annotated[By[Seconds], People("S10 S12", 0.5, 600), Paper("S10 S12")] = 2.0
    """When the walk before sitting down or falling ends."""
    sit_duration_s: Annotated[
        By[Seconds] | None,
        People("S10", 1, 60),
        Paper("S10"),
        ByModel(human=normal(2.0, 0.25, 1.3, 3.0), paper=1.5),
    ] = None
    """Duration of sitting down after a walk."""
    fall_duration_s: Annotated[
        By[Seconds] | None,
        People("S12", 0.7, 10),
        Paper("S12"),
        ByModel(human=normal(1.1, 0.4, 0.9, 2.0), paper=0.8),
    ] = None
    """Duration of the fall after a walk."""
    blend_s: Annotated[By[Seconds], Paper("S9 S10 S11 S12")] = 0.3
    """Duration of the raised-cosine ramps of the gait, in and out; 0 is a hard switch."""
    overlap_s: Annotated[By[Seconds], People("S9 S10 S11 S12", 0, 0.8)] = 0.0
    """Time by which the second movement starts before the first ends, unless walk_start_s says
    when. A scene gets at most 0.3 of the duration of rising, sitting down or falling, and nothing
    of a fall to the side: its number is what it got."""


_SEGMENTS = ActsIf("body.scatterers", "segments")


class BodyConfig(Section):
    """What of a person scatters: the joints as points, or the segments between them.

    `segments` are ellipsoids of `points_per_segment` points at most; how many a recording needs
    follows from its speeds, window and wavelength (docs/physics/bodies.md).
    """

    scatterers: Literal["points", "segments", "surfaces"] = "points"
    """What scatters: the 13 joints, ellipsoids between them, or surfaces that face the radar."""
    points_per_segment: Annotated[
        int, Field(ge=1, le=1000, strict=True), ActsIf("body.scatterers", "segments", "surfaces")
    ] = 20
    """Largest number of points of a segment; a surface has 14 at most."""
    shadowing: Annotated[Flag, ActsIfAny(_SEGMENTS, ActsIf("people", GIVEN))] = True
    """Whether trunk and thighs hide the segments behind them and, with `people`, each person hides
    others."""


class OneOf(Section):
    """``{choice: [walking, punching]}``: one of them, equally likely."""

    choice: Annotated[tuple[str, ...], Field(min_length=1, max_length=200)]


def _name_or_choice(value: object) -> object:
    names: Any = value.get("choice") if isinstance(value, dict) and len(value) == 1 else None
    listed = isinstance(names, (list, tuple)) and all(isinstance(one, str) for one in names)
    if isinstance(value, (str, OneOf)) or (listed and names):
        return value
    raise value_error("should be a slug or label, or {choice: [walking, punching]}")


class PersonConfig(Section):
    """Somebody besides the sample's main person."""

    REPEATS: ClassVar = True  # sections of the top level

    activity: Annotated[str | OneOf, BeforeValidator(_name_or_choice)] = "walking"
    """Activity of the person: a slug or label, or {choice: [...]}."""
    share: Share = 1.0
    """Share of the scenes in which the person is there."""
    subject: SubjectConfig = SubjectConfig()
    motion: MotionConfig = MotionConfig()
    """Motion of the person; its `cross_range_m` is -1.5 to 1.5 unless given."""
    timing: TimingConfig = TimingConfig()
    classes: dict[str, ClassConfig] | None = None
    """Drawn numbers of a class of one's own, filled in for a scene."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names, slugs or labels, of all activities that the person may do."""
        return (self.activity,) if isinstance(self.activity, str) else self.activity.choice
