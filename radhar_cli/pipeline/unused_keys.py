"""Keys of a config that have no effect, because of what another key says."""

from collections.abc import Iterator
from operator import eq
from typing import Any

from pydantic import BaseModel

from radhar_cli.activity import ACTIVITIES
from radhar_cli.config.number import support
from radhar_cli.config.schema import (
    Config,
    MotionConfig,
    PerActivity,
    class_activities,
)
from radhar_cli.scene import FALL, depends_on, numbers

# A key, the one that decides about it, and the value with which it has an effect.
USED_ONLY_WITH = (
    ("processing.gate_m", "processing.range_sum", "gated"),
    ("processing.gate_sum", "processing.range_sum", "gated"),
    ("processing.highpass", "processing.clutter", "highpass"),
    ("image.cfar", "image.kind", "cfar"),
    ("body.points_per_segment", "body.scatterers", "segments"),
    ("body.shadowing", "body.scatterers", "segments"),
    ("engine.tolerance_db", "engine.kind", "direct"),
    ("engine.fallback", "engine.kind", "direct"),
    ("engine.precision", "engine.kind", "direct"),
)
# What only maps have whose name holds this.
USED_ONLY_BY_MAPS = {
    "denoised": ("processing.savgol",),
    "fsst": ("processing.fsst_hop_pulses", "processing.fsst_threshold"),
    "stft": ("processing.stft_fft_length",),
    "st": (
        "processing.range_sum",
        "processing.window_s",
        "processing.overlap_fraction",
        "image.doppler_limits_mps",
    ),
}


def unused_keys(config: Config) -> list[str]:
    """Say which keys have no effect although their values are not the defaults."""
    return list(dict.fromkeys(_unused(config)))


def _unused(config: Config) -> Iterator[str]:
    default = _defaults(config)
    fixed = all(isinstance(number, int | float) for _, number in numbers(config))

    def changed(key: str) -> bool:
        same = _drawn_from if fixed else eq
        return not same(_at(config, key), _at(default, key))

    for key, other, wanted in USED_ONLY_WITH:
        if _at(config, other) != wanted and changed(key):
            needed = f"{other}: {_yaml(wanted)}"
            yield f"{key} has no effect with {_entry(config, other)}; it needs {needed}"
    for part, keys in USED_ONLY_BY_MAPS.items():
        if not any(part in name for name in config.maps):
            for key in filter(changed, keys):
                yield f"{key} has no effect with {_entry(config, 'maps')}"
    if config.snr_reference == "received" and (config.snr_db is None or config.wall is None):
        other = "snr_db" if config.snr_db is None else "wall"
        yield f"snr_reference has no effect with {_entry(config, other)}"
    for key, reason in _unused_numbers(config):
        if changed(key):
            yield f"{key} has no effect with {reason}"


def _unused_numbers(config: Config) -> Iterator[tuple[str, str]]:
    """(key, reason) of numbers that a scene of no activity depends on."""
    own = class_activities(config.classes) | {a.slug: a for a in config.chosen_activities}
    activities = ({a.slug: a for a in ACTIVITIES} | own).values()
    reasons = {
        "receiver": "receiver.noise_corner_hz: 0",
        "subject": _entry(config, "motion.model"),
        "motion": _entry(config, "motion.model"),
        "timing": _entry(config, "motion.model"),
    }
    if config.image.kind == "cfar":
        reasons["image"] = "image.cfar.domain: power"
    for key in (*(key for key, _ in numbers(config)), FALL):
        reason = reasons.get(key.partition(".")[0])
        if reason and not any(depends_on(config, activity, key) for activity in activities):
            yield key, reason


def _defaults(config: Config) -> Config:
    """The default config with the defaults of this one's model of motion."""
    return Config.model_construct(motion=MotionConfig(model=config.motion.model)).filled()


def _drawn_from(value: Any, default: Any) -> bool:
    """Whether a value of a scene is the default, or was drawn from it."""
    if value == default or not isinstance(default, BaseModel):
        return bool(value == default)
    if not isinstance(value, int | float):
        return all(
            _drawn_from(getattr(value, name), getattr(default, name))
            for name in type(default).model_fields
        )
    given: Any = default
    forms = given.per_activity.values() if isinstance(given, PerActivity) else (given,)
    return any(support(form)[0] <= value <= support(form)[1] for form in forms)


def _at(config: Config, key: str) -> Any:
    place: Any = config
    for name in key.split("."):
        place = getattr(place, name)
    return place


def _entry(config: Config, key: str) -> str:
    return f"{key}: {_yaml(_at(config, key))}"


def _yaml(value: object) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(str, value))}]"
    return "null" if value is None else str(value)
