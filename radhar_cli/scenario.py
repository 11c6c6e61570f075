"""(config, class, index) -> one scene: every number drawn, nothing computed yet."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from radhar_cli.activity import Activity
from radhar_cli.body.skeleton import default_weight
from radhar_cli.config.experiment import Config
from radhar_cli.config.motion import for_activity
from radhar_cli.config.number import Number, is_fixed, nominal, quantile
from radhar_cli.randomness import PERSON, SCENE, stream

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


@dataclass(frozen=True)
class Scene:
    """One recording to be simulated.

    Attributes:
        activity: what is performed.
        index: number of the sample within its class.
        subject: number of the person, or None where every sample is a person of its own.
        seed: of the data set; names the noise streams with (class, index).
        values: {dotted config key: number} in the units of the keys, for every number that the
            scene depends on; vectors as `radar.tx_m.0` and so on.
        attempt: how often the scene was redrawn (`on_invalid: redraw`).
    """

    activity: Activity
    index: int
    subject: int | None
    seed: int
    values: Mapping[str, float]
    attempt: int = 0

    @property
    def name(self) -> str:
        """How messages call this sample."""
        return f"{self.activity.slug}/{self.index}"


def scene_numbers(config: Config, activity: Activity) -> Iterator[tuple[str, Number]]:
    """Yield (dotted key, number) for everything a scene of this activity depends on."""
    yield "duration_s", config.duration_s
    for key in ("carrier_hz", "bandwidth_hz", "prf_hz", "adc_rate_hz", "chirp_s"):
        yield f"radar.{key}", getattr(config.radar, key)
    for key in ("tx_m", "rx_m"):
        yield from _vector(f"radar.{key}", getattr(config.radar, key))
    yield "radar.antenna_gain_dbi", config.radar.antenna_gain_dbi
    yield "radar.antenna_isolation_db", config.radar.antenna_isolation_db
    yield "subject.height_m", config.subject.height_m
    if config.subject.weight_kg is not None:
        yield "subject.weight_kg", config.subject.weight_kg
    for section in ("motion", "timing"):
        model = getattr(config, section)
        for key in type(model).model_fields:
            dotted = f"{section}.{key}"
            if dotted in activity.uses or key in ("range_m", "cross_range_m", "angle_deg"):
                yield dotted, for_activity(getattr(model, key), activity)
    if config.wall is not None:
        yield from _vector("wall.center_m", config.wall.center_m)
        yield from _vector("wall.size_m", config.wall.size_m)
        yield "wall.eps_r", config.wall.eps_r
        yield "wall.loss_tangent", config.wall.loss_tangent
    if config.snr_db is not None:
        yield "snr_db", config.snr_db


def _vector(key: str, numbers: tuple[Number, ...]) -> Iterator[tuple[str, Number]]:
    for axis, number in enumerate(numbers):
        yield f"{key}.{axis}", number


def subject_of(config: Config, index: int) -> int | None:
    """Number of the person in sample `index` of any class, or None without named persons."""
    return None if config.split.subjects is None else index % config.split.subjects


def draw_scene(config: Config, activity: Activity, index: int, attempt: int = 0) -> Scene:
    """Draw every number of one sample, each from its own stream.

    Persons come from (seed, subject, field), the rest from (seed, class, index, field): no draw
    depends on another, on the maps, on the engine, or on the order of work.
    """
    subject = subject_of(config, index)

    def draw(key: str, number: Number) -> float:
        if is_fixed(number):
            return nominal(number)
        again = attempt if key.startswith(REDRAWN) else 0
        if subject is not None and key in PERSONAL:
            rng = stream(config.seed, PERSON, subject, name=key)
        else:
            rng = stream(config.seed, SCENE, activity.index, index, again, name=key)
        return quantile(number, rng.random())

    values = {key: draw(key, number) for key, number in scene_numbers(config, activity)}
    return Scene(activity, index, subject, config.seed, _with_weight(values), attempt)


def nominal_scene(config: Config, activity: Activity) -> Scene:
    """The scene with every number at its middle."""
    values = {key: nominal(number) for key, number in scene_numbers(config, activity)}
    return Scene(activity, 0, None, config.seed, _with_weight(values))


def _with_weight(values: dict[str, float]) -> dict[str, float]:
    values.setdefault("subject.weight_kg", default_weight(values["subject.height_m"]))
    return values
