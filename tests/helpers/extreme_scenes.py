"""One scene at a time, and its slow-time signal once more in extended precision."""

from typing import Any

import numpy as np
from helpers import reference as ref

from radhar_cli.config import Config
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.products.run import Results
from radhar_cli.scene.products.run import record as record_scene
from radhar_cli.scene.scene import nominal_scene, scene_numbers

# 20 samples a chirp and 200 pulses: little to compute even in extended precision. The half-band
# ends at 7.5 m.
RADAR = {"carrier_hz": 24e9, "bandwidth_hz": 2e8, "prf_hz": 1000, "adc_rate_hz": 5e5}
SCENE: dict[str, Any] = {
    "duration_s": 0.2,
    "snr_db": None,
    "image": {"size_px": 32},
    "subject": {"height_m": 1.8},
    "motion": {"range_m": 2.0, "angle_deg": 20.0},
}


# The budget that docs/reference/limits.md speaks of, whatever the default.
ENGINES = {"cube": {"kind": "cube"}, "direct": {"kind": "direct", "tolerance_db": -60}}


def config_of(engine: str = "cube", radar: dict[str, Any] | None = None, **more: Any) -> Config:
    """The scene above with other sections; `radar` changes single keys."""
    document = SCENE | {"radar": RADAR | (radar or {}), "engine": ENGINES[engine]} | more
    length = document["duration_s"]
    if not isinstance(length, dict):
        document["processing"] = {"window_s": length / 4} | document.get("processing", {})
    document["motion"] = {"model": "paper"} | document["motion"]
    return Config.model_validate(document)


def record(config: Config, *products: str, activity: str = "walking") -> Results:
    """Make some products of the nominal scene."""
    return record_scene(nominal_scene(config, activity_named(activity)), products)


def signal(config: Config, activity: str = "walking") -> np.ndarray:
    """The slow-time signal x[m]."""
    return np.asarray(record(config, "signal", activity=activity)["signal"].x[0, 0])


def radar_of(config: Config) -> ref.Radar:
    r, p = config.radar, config.processing
    return ref.Radar(
        fc=float(r.carrier_hz),
        bandwidth=float(r.bandwidth_hz),
        chirp=float(r.chirp_s),
        adc_rate=float(r.adc_rate_hz),
        prf=float(r.prf_hz),
        duration=float(config.duration_s),
        fft_length=p.range_fft_length,
        centred=p.range_reference == "centre",
        residual_video_phase=r.residual_video_phase,
    )


def free_space_paths(config: Config, activity: str = "walking") -> tuple[np.ndarray, np.ndarray]:
    """Delays and amplitudes [13, M] without a wall, geometry and phases in extended precision."""
    scene = nominal_scene(config, activity_named(activity))
    motion, v, t = motion_of(scene.people[0]), scene_numbers(scene), radar_of(config).times
    p = motion.positions(t).astype(np.longdouble)
    legs = []
    for antenna in ("tx", "rx"):
        at = np.array([v[f"radar.{antenna}_m.{axis}"] for axis in range(3)])
        legs.append(np.sqrt(((p - at[:, None, None]) ** 2).sum(axis=0)))
    gain = 10 ** (v["radar.antenna_gain_dbi"] / 10)
    wavelength = ref.C / v["radar.carrier_hz"]
    strength = gain * wavelength * np.sqrt(motion.cross_sections(t) / (4 * np.pi) ** 3)
    return (legs[0] + legs[1]) / np.longdouble(ref.C), strength / (legs[0] * legs[1])


def exact_signal(config: Config, activity: str = "walking") -> np.ndarray:
    """x[m] in free space by the naive formulas of `reference`, in extended precision."""
    delay, amplitude = free_space_paths(config, activity)
    y = ref.slow_time(delay, amplitude, radar_of(config))
    return np.diff(y) if config.processing.clutter == "difference" else y


def relative(found: np.ndarray, right: np.ndarray) -> float:
    """L2 error of `found` relative to `right`."""
    return float(np.linalg.norm(found - right) / np.linalg.norm(right))
