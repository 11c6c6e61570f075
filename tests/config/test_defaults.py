"""What a config leaves out: defaults that fit together, by model of motion and by wavelength."""

from collections.abc import Iterator
from math import sqrt
from pathlib import Path
from typing import Any

import pytest

from radhar_cli.config import Config, load_config
from radhar_cli.config.engine import EngineConfig
from radhar_cli.config.first_level import Request
from radhar_cli.dataset.layout import Rows
from radhar_cli.echo.accuracy import LOOSEST_DB
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.checks.flags import Flags
from radhar_cli.scene.checks.warnings import collect_warnings
from radhar_cli.schema.section import Section, defaults_of

ROOT = Path(__file__).resolve().parents[2]
README_ONCE = """
samples_per_class: 300
radar: {carrier_hz: 24e9, bandwidth_hz: 250e6, prf_hz: 2000}
subject: {height_m: {uniform: [1.5, 1.9]}}
motion: {range_m: {uniform: [1, 3]}, walking: {speed_mps: {per_activity: {default: 1.5, S12: 1.0}}}}
snr_db: {choice: [30, 20, 10]}
maps: [rtm, stft, fsst_compensated]
"""


def checked(config: Config, rows: list[int]) -> tuple[dict[Flags, int], int]:
    """Count the scenes that have each flag, and those that were drawn again."""
    drawn = [draw_valid_scene(config, *Rows.of(config)[row]) for row in rows]
    counts = {flag: sum(flag in flags for _, flags in drawn) for flag in Flags}
    return counts, sum(scene.attempt > 0 for scene, _ in drawn)


@pytest.mark.parametrize(
    ("model", "duration", "on_invalid", "bandwidth", "prf", "window"),
    [
        ("human", 6.0, "redraw", 1e9, 1e4, None),
        ("paper", 4.0, "keep", 4e9, 5e3, 0.4),
        ("file", 4.0, "redraw", 4e9, 5e3, None),
    ],
)
def test_defaults_by_model(
    model: str, duration: float, on_invalid: str, bandwidth: float, prf: float, window: Any
) -> None:
    config = Config(motion={"model": model}, classes={"wave": ["wave.bvh"]})
    assert (config.duration_s, config.on_invalid) == (duration, on_invalid)
    assert (config.radar.bandwidth_hz, config.radar.prf_hz) == (bandwidth, prf)
    assert config.processing.window_s == window


@pytest.mark.parametrize("model", ["human", "paper", "file"])
def test_what_is_said_goes_before_the_models_default(model: str) -> None:
    said: dict[str, Any] = {
        "classes": {"wave": ["wave.bvh"]},
        "motion": {"model": model, "range_m": 3.0},
        "radar": {"prf_hz": 3000.0},
        "duration_s": 5.0,
        "on_invalid": "error",
        "processing": {"window_s": 0.2},
    }
    config = Config.model_validate(said)
    assert (config.duration_s, config.on_invalid, config.radar.prf_hz) == (5.0, "error", 3000.0)
    assert (config.motion.range_m, config.processing.window_s) == (3.0, 0.2)


def test_people_of_the_defaults_stay_clear_of_the_radar_and_in_its_band() -> None:
    """One kick in 60 is faster than the unambiguous band; the fastest walker meets the radar.

    Who comes straight on at 1.75 m/s from 10.5 m walks into the radar within 6 s, and is drawn
    again.
    """
    config = Config(samples_per_class=300)
    rows = Rows.of(config).spread(12 * 12)
    counts, redrawn = checked(config, rows)
    assert counts.pop(Flags.ALIASING) <= 1
    assert not any(counts.values())
    assert redrawn <= 1


@pytest.mark.slow
def test_the_demo_builds_without_a_warning() -> None:
    config = load_config(ROOT / "configs/quickstart.yaml")
    counts, _ = checked(config, [*range(len(Rows.of(config)))])
    assert collect_warnings(config, counts) == []


def test_people_who_start_near_the_radar_pass_it(tmp_path: Path) -> None:
    """The README's config once ended in a refusal: from 1 to 3 m people walk into the radar."""
    (tmp_path / "readme.yaml").write_text(README_ONCE)
    config = load_config(tmp_path / "readme.yaml")
    counts, redrawn = checked(config, Rows.of(config).spread(120))
    assert redrawn > 0
    assert not counts[Flags.WALL] + counts[Flags.HALF_BAND]


@pytest.mark.parametrize(("carrier", "seconds"), [(77e9, 0.062), (24e9, 0.112), (2e9, 0.387)])
def test_the_window_follows_from_the_wavelength(carrier: float, seconds: float) -> None:
    """A limb's Doppler, 2 a/lambda a second for 2 m/s^2, crosses the main lobe 4/T in T."""
    processing = Config().processing
    pulses = processing.window_pulses(6.0, 1e5, carrier)
    assert pulses / 1e5 == pytest.approx(seconds, abs=5e-4)
    assert 2 * 2.0 * carrier / SPEED_OF_LIGHT * (pulses / 1e5) ** 2 == pytest.approx(4, rel=1e-3)
    assert processing.window_pulses(60.0, 1e5, carrier) == pulses


@pytest.mark.parametrize(
    ("duration", "prf", "carrier", "pulses"),
    [(0.1, 1e4, 77e9, 250), (4.0, 1e3, 1e6, 1000), (6.0, 20.0, 77e9, 8), (0.002, 1e4, 77e9, 8)],
)
def test_the_window_is_a_quarter_of_the_recording_at_most_and_8_pulses_at_least(
    duration: float, prf: float, carrier: float, pulses: int
) -> None:
    assert Config().processing.window_pulses(duration, prf, carrier) == pulses


def test_a_window_that_is_given_is_taken() -> None:
    given = Config(processing={"window_s": 0.3}).processing
    assert given.window_pulses(4.0, 1000.0, 77e9) == 300


@pytest.mark.parametrize("prf", [80.0, 5000.0])
def test_recordings_that_held_a_window_of_a_tenth_hold_the_default_one(prf: float) -> None:
    for pulses in (75, 80, 100, 1000):
        radar = {"prf_hz": prf, "chirp_s": 4e-5}
        config = Config(duration_s=pulses / prf, radar=radar)
        window = config.processing.window_pulses(pulses / prf, prf, 77e9)
        assert 8 <= window <= max(8, pulses / 4 + 1, sqrt(0.004) * prf)


def _kinds_of_section(kind: type[Section]) -> Iterator[type[Section]]:
    for inner in kind.__subclasses__():
        yield inner
        yield from _kinds_of_section(inner)


def test_defaults_that_are_not_validated_are_what_validation_gives() -> None:
    """Sections stand as defaults of fields without being validated, which makes starting slow."""
    compared = 0
    for kind in set(_kinds_of_section(Section)):
        required = any(field.is_required() for field in kind.model_fields.values())
        if required or issubclass(kind, Request):
            continue
        assert defaults_of(kind).model_dump_json() == kind().model_dump_json(), kind
        compared += 1
    assert compared > 30


def test_the_default_tolerance_is_the_loosest_that_engines_run() -> None:
    assert EngineConfig().tolerance_db == LOOSEST_DB
