"""`subject:`, `motion:` and `timing:` who moves, how, and when."""

from typing import Annotated, Any, Generic, TypeAlias, TypeVar

from pydantic import Discriminator, Tag, field_validator
from pydantic_core import PydanticCustomError

from radhar_cli.activity import Activity, activity_named
from radhar_cli.config.number import (
    Angle,
    Coordinate,
    NotNegative,
    Number,
    Positive,
    Uniform,
    Vary,
    within,
)
from radhar_cli.config.section import Section

T = TypeVar("T")


class PerActivity(Section, Generic[T]):
    """``{per_activity: {default: 2.0, walking: 1.0, S9: 1.0}}``: a number by activity."""

    per_activity: dict[str, T]

    @field_validator("per_activity")
    @classmethod
    def _by_slug(cls, value: dict[str, T]) -> dict[str, T]:
        numbers: dict[str, T] = {}
        for name, number in value.items():
            try:
                slug = name if name == "default" else activity_named(name).slug
            except ValueError as error:
                raise PydanticCustomError("activity", "{what}", {"what": str(error)}) from None
            if slug in numbers:
                raise PydanticCustomError("activity", "should name {slug} once", {"slug": slug})
            numbers[slug] = number
        if "default" not in numbers:
            raise PydanticCustomError(
                "activity", "should have a 'default' beside the activities it names"
            )
        return numbers


def _kind(value: Any) -> str:
    per_activity = isinstance(value, PerActivity) or (
        isinstance(value, dict) and "per_activity" in value
    )
    return "per_activity" if per_activity else "same"


# One alias a constraint: pydantic cannot substitute a type variable inside an Annotated union.
_Either = Discriminator(_kind)
Speed = Annotated[NotNegative, within(0, 1e4, "m/s")]
Frequency = Annotated[NotNegative, within(0, 1e3, "Hz")]
Seconds = Annotated[NotNegative, within(0, 1e7, "s")]
SpeedBy: TypeAlias = Annotated[
    Annotated[Speed, Tag("same")] | Annotated[PerActivity[Speed], Tag("per_activity")], _Either
]
FrequencyBy: TypeAlias = Annotated[
    Annotated[Frequency, Tag("same")] | Annotated[PerActivity[Frequency], Tag("per_activity")],
    _Either,
]
SecondsBy: TypeAlias = Annotated[
    Annotated[Seconds, Tag("same")] | Annotated[PerActivity[Seconds], Tag("per_activity")], _Either
]
AngleBy: TypeAlias = Annotated[
    Annotated[Angle, Tag("same")] | Annotated[PerActivity[Angle], Tag("per_activity")], _Either
]
CoordinateBy: TypeAlias = Annotated[
    Annotated[Coordinate, Tag("same")] | Annotated[PerActivity[Coordinate], Tag("per_activity")],
    _Either,
]


def for_activity(value: Number | PerActivity[Number], activity: Activity) -> Number:
    """Return the number that holds for one activity."""
    if isinstance(value, PerActivity):
        return value.per_activity.get(activity.slug, value.per_activity["default"])
    return value


class SubjectConfig(Section):
    """The person; without a weight it is 26 kg/m^2 times the height squared."""

    height_m: Annotated[Positive, within(0.1, 10, "m")] = Uniform(uniform=(1.5, 1.9))
    weight_kg: Annotated[Positive, within(1e-3, 1e6, "kg")] | None = None


class MotionConfig(Section):
    """Where the torso stands, where it heads and how the limbs swing."""

    range_m: CoordinateBy = Uniform(uniform=(1.0, 3.0))
    cross_range_m: CoordinateBy = 0.0
    angle_deg: AngleBy = Uniform(uniform=(-30.0, 30.0))
    speed_mps: SpeedBy = 1.5
    gait_hz: FrequencyBy = 1.0
    thigh_deg: AngleBy = Vary(vary=(30.0, 0.2))
    calf_deg: AngleBy = Vary(vary=(45.0, 0.2))
    arm_deg: AngleBy = Vary(vary=(35.0, 0.2))
    turn_deg: AngleBy = Vary(vary=(45.0, 0.2))


class TimingConfig(Section):
    """When the phases of an activity begin and how long they last.

    seat_*: S5 and S6. rise_*, walk_start_s: S9 and S11. walk_stop_s: S10 and S12, then
    sit_duration_s (S10) or fall_duration_s (S12). blend_s: length of the raised-cosine ramps that
    switch the gait on and off; 0 is the paper's hard switch.
    """

    seat_start_s: SecondsBy = 0.5
    seat_duration_s: SecondsBy = 2.0
    rise_start_s: SecondsBy = 0.5
    rise_duration_s: SecondsBy = 1.5
    walk_start_s: SecondsBy = 2.0
    walk_stop_s: SecondsBy = 2.0
    sit_duration_s: SecondsBy = 1.5
    fall_duration_s: SecondsBy = 0.8
    blend_s: SecondsBy = 0.3
