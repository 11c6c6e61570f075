"""People: their bodies, how and when they move, and others in a scene."""

from typing import Annotated, Any, ClassVar, Generic, Literal

from pydantic import BeforeValidator, Field

from radhar_cli.config.classes import ClassConfig
from radhar_cli.config.motion import MotionConfig, TimingConfig
from radhar_cli.schema.annotations import (
    GIVEN,
    PERSONAL,
    Limits,
    NeedsAnyKey,
    NeedsKey,
    People,
)
from radhar_cli.schema.number import (
    METRES,
    NOT_NEGATIVE,
    POSITIVE,
    RATE,
    Share,
    normal,
    uniform,
    value_error,
    within,
)
from radhar_cli.schema.section import Filled, Flag, N, Section, default_draw, defaults_of


class SubjectConfig(Section, Generic[N]):
    """The person: body; of the human model also sway, breathing (chest) and pulse (heart)."""

    height_m: Annotated[N, POSITIVE, within(0.1, 10, "m"), Limits(1.0, 2.1), PERSONAL] = (
        default_draw(uniform(1.5, 1.9))
    )
    """Stature of the person; below 1.5 m it is a child's in proportions, weight and gait."""
    weight_kg: Annotated[Filled[N], POSITIVE, within(1e-3, 1e6, "kg"), PERSONAL] = default_draw(
        None
    )
    """Body mass of the person; null is 26 kg/m^2 times the height squared, and less of children."""
    sway_ahead_m: Annotated[N, NOT_NEGATIVE, METRES, People("", 0, 0.01), PERSONAL] = default_draw(
        uniform(0.002, 0.006)
    )
    """Standard deviation of a standing person's sway forwards and backwards."""
    sway_aside_m: Annotated[N, NOT_NEGATIVE, METRES, People("", 0, 0.01), PERSONAL] = default_draw(
        uniform(0.0015, 0.0035)
    )
    """Standard deviation of a standing person's sway to the sides."""
    breathing_hz: Annotated[N, NOT_NEGATIVE, RATE, People("", 0, 2), PERSONAL] = default_draw(
        normal(0.25, 0.04, 0.15, 0.4)
    )
    """Breathing rate, breaths per second."""
    chest_m: Annotated[N, NOT_NEGATIVE, METRES, People("", 0, 0.01), PERSONAL] = default_draw(
        uniform(0.002, 0.006)
    )
    """Amplitude of the chest's motion by breathing."""
    pulse_hz: Annotated[N, NOT_NEGATIVE, RATE, People("", 0, 4), PERSONAL] = default_draw(
        normal(1.15, 0.12, 0.8, 1.8)
    )
    """Heart rate, beats per second."""
    heart_m: Annotated[N, NOT_NEGATIVE, METRES, People("", 0, 0.002), PERSONAL] = default_draw(
        uniform(0.0001, 0.0004)
    )
    """Amplitude of the chest's motion by the heartbeat."""


_SEGMENTS = NeedsKey("body.scatterers", "segments")


class BodyConfig(Section):
    """Scatterers of a person: the joints as points, or the segments between them.

    `segments` are ellipsoids of `points_per_segment` points at most; how many a recording needs
    follows from its speeds, window and wavelength (docs/physics/bodies.md).
    """

    scatterers: Literal["points", "segments", "surfaces"] = "points"
    """Scatterers: the 13 joints, ellipsoids between them, or surfaces that face the radar."""
    points_per_segment: Annotated[
        int, Field(ge=1, le=1000, strict=True), NeedsKey("body.scatterers", "segments", "surfaces")
    ] = 20
    """Largest number of points of a segment; a surface has 14 at most."""
    cross_section_sd_db: Annotated[
        float,
        Field(ge=0, le=12, strict=True),
        NeedsKey("body.scatterers", "segments", "surfaces"),
    ] = 0.0
    """Standard deviation, from person to person, of the cross sections of trunk, head, arms,
    forearms, hands, thighs, shanks and feet: clothes and build. Both sides are alike."""
    shadowing: Annotated[Flag, NeedsAnyKey(_SEGMENTS, NeedsKey("people", GIVEN))] = True
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
    subject: SubjectConfig = defaults_of(SubjectConfig)
    motion: MotionConfig = defaults_of(MotionConfig)
    """Motion of the person; `cross_range_m` of it, or of its `place`, is -1.5 to 1.5 unless
    given."""
    timing: TimingConfig = defaults_of(TimingConfig)
    classes: dict[str, ClassConfig] | None = None
    """Drawn numbers of a class of one's own, filled in for a scene."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names, slugs or labels, of all activities that the person may do."""
        return (self.activity,) if isinstance(self.activity, str) else self.activity.choice
