"""Movements of people: their keys, and when the phases of an activity begin."""

from typing import TYPE_CHECKING, Annotated, Any, Generic, Literal

from pydantic import Field

from radhar_cli.motion.movements import catalogue
from radhar_cli.motion.movements.running import RUNNING_SPEED
from radhar_cli.motion.movements.walking import WALKING_SPEED
from radhar_cli.schema.annotations import ByModel, NeedsNullKey, People, Unless
from radhar_cli.schema.number import ANGLE, COORDINATE, Choice, uniform, within
from radhar_cli.schema.section import B, ByActivity, Section, default_draw, defaults_of

# Towards the radar as often as away from it, whatever people do; nominal ones face it.
_HEADING = Choice(choice=(uniform(150.0, 210.0), uniform(-30.0, 30.0)))


ZONED = Unless("places_people", "stream, whose zone says where people are")
NOT_OF_STREAMS = Unless("stream", "stream, which is cut anywhere")


class PlaceConfig(Section, Generic[B]):
    """Place of people at one instant of the recording, whatever they do.

    Walkers are there on the way: their course goes through the place at an instant at which all of
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
    drawn by the mean of its own rank and that of `range_m`: far people are so at a far end."""


class MotionConfig(Section, Generic[B]):
    """Places, headings and movements of people, by movement and model of motion.

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
    """Beginnings and durations of the phases of an activity.

    What is null takes the value of the model.
    """

    onset: Annotated[B, NOT_OF_STREAMS, ByActivity(within(0, 1)), People("", 0, 1)] = default_draw(
        uniform(0.0, 1.0)
    )
    """Beginning of the movement, before or during the recording: 0 is the earliest instant that
    leaves enough of the movement to be seen, 1 the latest."""
    visible: Annotated[B, NOT_OF_STREAMS, ByActivity(within(0, 1)), People("", 0, 1)] = (
        default_draw(0.75)
    )
    """Share of a movement that is seen at least; of the recording, for what lasts or is longer."""
    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Keys of the movements, which their files have."""
    else:
        __annotations__ |= catalogue.TIMING_KEYS
        locals().update(catalogue.TIMING_DEFAULTS)

    @classmethod
    def descriptions(cls) -> dict[str, str]:
        """Texts under the fields in the source, of this class and of the movements."""
        texts = super().descriptions()
        return texts | {
            k: text for one in catalogue.TIMINGS for k, text in one.descriptions().items()
        }


FALL = "motion.falling.direction"
# Speeds that follow the stature, as a config does not say how fast people are.
USUAL_SPEEDS = {
    "motion.walking.speed_mps": WALKING_SPEED,
    "motion.running.speed_mps": RUNNING_SPEED,
}
# Keys that had no section in earlier versions, and other names that some of them had; the random
# streams of numbers keep those names.
_ONCE_WITHOUT_SECTION = {
    "walking": "speed_mps period_scale arm_swing trunk_pitch_deg step_width speed_variation "
    "lane_m lane_start speed_up",
    "paper": "gait_hz thigh_deg calf_deg arm_deg",
    "rotating": "turn_deg rotation_hz",
    "striking": "punch_hz kick_hz strike_scale",
    "exercises": "period size",
    "repeating": "cycle_phase tempo_jitter size_jitter",
    "grabbing": "bend_deg dwell_s",
    "sitting": "seat_height lean_deg recline_deg hands_on_lap",
    "transitions": "joint_lag step_m settle_size",
    "falling": "direction heels_deg stumble_deg",
    "idle": "fidget_hz fidget_size shuffle_hz phase_s",
}
_OTHER_NAMES = {
    "motion.exercises.period": "motion.exercise_period",
    "motion.exercises.size": "motion.exercise_size",
    "motion.falling.direction": "motion.fall",
    "motion.idle.phase_s": "motion.idle_phase_s",
}
EARLIER_KEYS = {
    key: _OTHER_NAMES.get(key, f"motion.{name}")
    for section, names in _ONCE_WITHOUT_SECTION.items()
    for name in names.split()
    for key in [f"motion.{section}.{name}"]
}
