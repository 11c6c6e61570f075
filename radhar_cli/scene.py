"""(config, class, index) -> one scene: a config with nothing left to draw."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeAlias

from radhar_cli.activity import Activity
from radhar_cli.config.number import Number, is_fixed, nominal, quantile
from radhar_cli.config.schema import Config, PerActivity, Section, for_activity
from radhar_cli.motion.skeleton import default_weight
from radhar_cli.randomness import PERSON, SCENE, stream

# The keys of a config whose numbers may be drawn, scene by scene.
SCENE_KEYS = ("duration_s", "radar", "subject", "motion", "timing", "wall", "snr_db")
# What stays with a person whatever they do: body and gait.
PERSONAL = (
    "subject.height_m",
    "subject.weight_kg",
    "motion.speed_mps",
    "motion.gait_hz",
    "motion.thigh_deg",
    "motion.calf_deg",
    "motion.arm_deg",
    "motion.turn_deg",
)
# Redrawing a scene outside the model changes what the person does, not the radar or the person.
REDRAWN = ("motion.", "timing.")
# Numbers of `motion:` that every activity depends on.
PLACE = ("motion.range_m", "motion.cross_range_m", "motion.angle_deg")

Draw: TypeAlias = Callable[[str, Number], float]


@dataclass(frozen=True)
class Scene:
    """One recording to be simulated.

    Attributes:
        config: with every number of SCENE_KEYS fixed; written to YAML and simulated again with the
            same activity and index, it gives the same recording.
        activity: what is performed.
        index: number of the sample within its class; names its noise, with the seed and the class.
        subject: number of the person, or None where every sample is a person of its own.
        attempt: how often the scene was redrawn (`on_invalid: redraw`).
    """

    config: Config
    activity: Activity
    index: int
    subject: int | None = None
    attempt: int = 0

    @property
    def name(self) -> str:
        """How messages call this sample."""
        return f"{self.activity.slug}/{self.index}"


def draw_scene(config: Config, activity: Activity, index: int, attempt: int = 0) -> Scene:
    """Draw every number of one sample, each from its own stream.

    Persons come from (seed, subject, field), the rest from (seed, class, index, field): no draw
    depends on another, on the maps, on the engine, or on the order of work.
    """
    subject = subject_of(config, index)

    def draw(key: str, number: Number) -> float:
        again = attempt if key.startswith(REDRAWN) else 0
        if subject is not None and key in PERSONAL:
            rng = stream(config.seed, PERSON, subject, name=key)
        else:
            rng = stream(config.seed, SCENE, activity.index, index, again, name=key)
        return quantile(number, rng.random())

    return Scene(_fixed(config, activity, draw), activity, index, subject, attempt)


def nominal_scene(config: Config, activity: Activity) -> Scene:
    """The scene with every number at its middle."""
    return Scene(_fixed(config, activity, lambda key, number: nominal(number)), activity, 0)


def subject_of(config: Config, index: int) -> int | None:
    """Number of the person in sample `index` of any class, or None without named persons."""
    return None if config.split.subjects is None else index % config.split.subjects


def numbers(config: Config) -> list[tuple[str, Any]]:
    """[(dotted key, number or PerActivity)] of all that may be drawn, in the order of the schema.

    Vectors come as `radar.tx_m.0` and so on; keys that are null are left out.
    """
    found: list[tuple[str, Any]] = []

    def note(key: str, number: Any) -> Any:
        found.append((key, number))
        return number

    for key in SCENE_KEYS:
        _each_number(getattr(config, key), key, note)
    return found


def scene_numbers(scene: Scene) -> dict[str, float]:
    """{dotted key: number} of all that a scene depends on, in the units of the keys."""
    return {key: one for key, one in numbers(scene.config) if depends_on(scene.activity, key)}


def number_at(config: Config, key: str) -> Any:
    """The number of a dotted key, such as `radar.tx_m.0`; None where its section is null."""
    place: Any = config
    for name in _path(key):
        if place is None:
            return None
        place = place[int(name)] if isinstance(place, tuple) else getattr(place, name)
    return place


@lru_cache(maxsize=1024)
def _path(key: str) -> tuple[str, ...]:
    return tuple(key.split("."))


def depends_on(activity: Activity, key: str) -> bool:
    """Whether scenes of an activity depend on the number of this dotted key."""
    return not key.startswith(REDRAWN) or key in PLACE or key in activity.uses


class _SameConfig:
    """A config as a key: equal to itself alone, whatever it holds."""

    def __init__(self, config: Config) -> None:
        self.config = config

    def __hash__(self) -> int:
        return id(self.config)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _SameConfig) and self.config is other.config


@lru_cache(maxsize=64)
def _fixed_and_drawn(same: _SameConfig, activity: Activity) -> tuple[Config, dict[str, Any]]:
    """The config of an activity with all at its middle, and {dotted key: number} to be drawn."""
    drawn: dict[str, Any] = {}

    def fix(key: str, number: Any) -> float:
        one = for_activity(number, activity)
        if depends_on(activity, key) and not is_fixed(one):
            drawn[key] = one
        return nominal(one)

    config = same.config
    sections = {key: _each_number(getattr(config, key), key, fix) for key in SCENE_KEYS}
    return config.model_copy(update=sections | {"activities": (activity.slug,)}), drawn


def _fixed(config: Config, activity: Activity, draw: Draw) -> Config:
    """The config of one scene; numbers that its activity does not depend on are at their middle."""
    fixed, drawn = _fixed_and_drawn(_SameConfig(config), activity)
    changes: dict[str, dict[str, Any]] = {}
    for key, number in drawn.items():
        section, _, rest = key.partition(".")
        name, _, axis = rest.partition(".")
        value: Any = draw(key, number)
        if axis:
            vector = list(
                changes.get(section, {}).get(name) or getattr(getattr(fixed, section), name)
            )
            vector[int(axis)] = value
            value = tuple(vector)
        changes.setdefault(section, {})[name] = value
    sections: dict[str, Any] = {
        key: found[""] if "" in found else getattr(fixed, key).model_copy(update=found)
        for key, found in changes.items()
    }
    subject = sections.get("subject", fixed.subject)
    if subject.weight_kg is None:
        weight = {"weight_kg": default_weight(subject.height_m)}
        sections["subject"] = subject.model_copy(update=weight)
    return fixed.model_copy(update=sections)


def _each_number(value: Any, key: str, change: Callable[[str, Any], Any]) -> Any:
    """A value of a config with change(dotted key, number) in place of every number."""
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, tuple):
        return tuple(change(f"{key}.{axis}", number) for axis, number in enumerate(value))
    if isinstance(value, Section) and not isinstance(value, PerActivity):
        fields = type(value).model_fields
        return value.model_copy(
            update={
                name: _each_number(getattr(value, name), f"{key}.{name}", change) for name in fields
            }
        )
    return change(key, value)
