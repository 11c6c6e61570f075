"""How people move: what each movement takes, and when the phases of an activity begin."""

from typing import TYPE_CHECKING, Annotated, Any, Generic, Literal

from pydantic import Field

from radhar_cli.motion.movements import catalogue
from radhar_cli.motion.movements.running import RUNNING_SPEED
from radhar_cli.motion.movements.walking import WALKING_SPEED
from radhar_cli.schema.annotations import ByModel, NeedsNullKey, Paper, People, Unless
from radhar_cli.schema.number import (
    ANGLE,
    COORDINATE,
    NOT_NEGATIVE,
    SECONDS,
    Choice,
    normal,
    uniform,
    within,
)
from radhar_cli.schema.section import B, ByActivity, Section, by_activity, default_draw, defaults_of

# Towards the radar as often as away from it, whatever people do; nominal ones face it.
_HEADING = Choice(choice=(uniform(150.0, 210.0), uniform(-30.0, 30.0)))


ZONED = Unless("places_people", "stream, whose zone says where people are")
NOT_OF_STREAMS = Unless("stream", "stream, which is cut anywhere")


class PlaceConfig(Section, Generic[B]):
    """Where people are at one instant of the recording, whatever they do.

    Who walks is there on the way: the course goes through the place at an instant at which all of
    it stays within what radar, wall and room allow, where there is one.
    """

    range_m: Annotated[B, ByActivity(COORDINATE)] = default_draw(uniform(2.0, 8.0))
    """Range at which people are."""
    cross_range_m: Annotated[B, ByActivity(COORDINATE), NeedsNullKey("motion.cross_range_m")] = (
        default_draw(uniform(-1.0, 1.0))
    )
    """Cross-range at which people are, positive to the left."""
    instant: Annotated[B, ByActivity(within(0, 1))] = default_draw(uniform(0.0, 1.0))
    """Share of the recording in which people who walk are nearer than their place: 0 has it at the
    near end of the course, 1 at the far end, as far as the whole course is possible. A law of it is
    drawn by the mean of its own rank and that of `range_m`: who is far is so at a far end."""


class MotionConfig(Section, Generic[B]):
    """Where people stand, where they head and how they move, by movement and model of motion.

    What another model alone knows is ignored; what is null takes the value of the model.
    """

    model: Literal["human", "paper", "file"] = "human"
    """Model of motion: human for measured gaits and movements, paper for the paper's formulas, file
    for motion files in every class (docs/guide/motion.md)."""
    folder: Annotated[str | None, Field(exclude=True, max_length=1000)] = None
    """Folder that paths of motion files are relative to; not part of a data set's identity."""
    place: Annotated[PlaceConfig[B], ZONED, NeedsNullKey("motion.range_m")] = defaults_of(
        PlaceConfig
    )
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
        __annotations__ |= catalogue.SECTIONS
        locals().update({name: defaults_of(kind) for name, kind in catalogue.SECTIONS.items()})


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


FALL = "motion.falling.direction"
# Speeds that follow the stature, as a config does not say how fast people are.
USUAL_SPEEDS = {
    "motion.walking.speed_mps": WALKING_SPEED,
    "motion.running.speed_mps": RUNNING_SPEED,
}
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
