"""Only what a request needs is computed: for every request, the products that run."""

from math import floor

import numpy as np
import pytest

from radhar_cli.config.data_set import Config
from radhar_cli.config.maps import MAP_NAMES
from radhar_cli.echo.bodies import motion_paths
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.motion.paper.body import PaperBody
from radhar_cli.scene.products import paths as scene_paths
from radhar_cli.scene.products import table as products
from radhar_cli.scene.products.plan import Plan, plan
from radhar_cli.scene.products.run import record, run
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.scene import Scene, draw_scene

PULSES, WIDTH = 128, 20

QUIET, WALL, CUBE = {"snr_db": None}, {"wall": {}}, {"engine": {"kind": "cube"}}
LONG_FFT = {"processing": {"stft_fft_length": 64}}
OWN_HOP = {"processing": {"fsst_hop_pulses": 1}}

# What runs besides the images themselves. Written by hand: change it only where the physics needs
# another product.
SCENE = "image_scale waveform antennas wall motions paths canceller receiver"
SIGNAL = f"{SCENE} direct echo accuracy signal"
NOISE = "channel signal_power noise_sigma noise"
NOISY = f"{SIGNAL} {NOISE}"
PROFILES = f"{SCENE} range_profiles rtm"
NOISY_PROFILES = f"{PROFILES} direct {NOISE}"
CUBED = f"{SCENE} beat_cube"
COMPENSATED = "torso_track signal_compensated"
COMPENSATED_DENOISED = f"{COMPENSATED} signal_compensated_denoised"
# The SNR behind a wall refers to the echo without it, by default.
WALLED = f"{NOISY} snr_paths"

REQUESTS: list[tuple[str, dict, str]] = [
    # maps, config, products
    ("rtm", {}, NOISY_PROFILES),
    ("rtm", QUIET, PROFILES),
    ("stft", {}, f"{NOISY} frames"),
    ("stft", QUIET, f"{SIGNAL} frames"),
    ("stft_denoised", QUIET, f"{SIGNAL} signal_denoised frames"),
    ("stft_compensated", QUIET, f"{SIGNAL} {COMPENSATED} frames"),
    ("stft_compensated_denoised", QUIET, f"{SIGNAL} {COMPENSATED_DENOISED} frames"),
    ("fsst", {}, f"{NOISY} fsst_frames"),
    ("fsst", QUIET, f"{SIGNAL} fsst_frames"),
    ("fsst_denoised", QUIET, f"{SIGNAL} signal_denoised fsst_frames"),
    ("fsst_compensated", {}, f"{NOISY} {COMPENSATED} fsst_frames"),
    ("fsst_compensated_denoised", QUIET, f"{SIGNAL} {COMPENSATED_DENOISED} fsst_frames"),
    ("stft fsst", {}, f"{NOISY} frames fsst_frames"),
    ("stft_denoised fsst_denoised", {}, f"{NOISY} signal_denoised frames fsst_frames"),
    ("rtm stft", QUIET, f"{SIGNAL} range_profiles rtm frames"),
    ("rtm stft", {}, f"{NOISY} range_profiles rtm frames"),
    (
        "stft_compensated fsst_compensated_denoised",
        QUIET,
        f"{SIGNAL} {COMPENSATED_DENOISED} frames fsst_frames",
    ),
    ("stft", WALL, f"{WALLED} frames"),
    ("stft", WALL | {"snr_reference": "received"}, f"{NOISY} frames"),
    ("rtm", WALL, f"{PROFILES} {NOISE} snr_paths"),
    ("rtm", WALL | QUIET, PROFILES),
    ("fsst_compensated", WALL, f"{WALLED} {COMPENSATED} fsst_frames"),
    ("stft", LONG_FFT, f"{NOISY} frames"),
    ("fsst", LONG_FFT, f"{NOISY} fsst_frames"),
    ("stft fsst", LONG_FFT | QUIET, f"{SIGNAL} frames fsst_frames"),
    ("stft fsst", OWN_HOP, f"{NOISY} frames fsst_frames"),
    ("stft", OWN_HOP | QUIET, f"{SIGNAL} frames"),
    ("stft", {"processing": {"clutter": "none"}}, f"{NOISY} frames impairments"),
    ("rtm", {"processing": {"clutter": "none"}} | QUIET, f"{PROFILES} impairments"),
    ("stft", CUBE, f"{CUBED} {NOISE} signal frames"),
    ("stft", CUBE | QUIET, f"{CUBED} signal frames"),
    ("rtm", CUBE, f"{CUBED} {NOISE} range_profiles rtm"),
    ("rtm", CUBE | QUIET | WALL, f"{CUBED} range_profiles rtm"),
    ("rtm stft", CUBE, f"{CUBED} {NOISE} signal range_profiles rtm frames"),
    (
        " ".join(MAP_NAMES),
        WALL,
        f"{WALLED} range_profiles rtm signal_denoised {COMPENSATED_DENOISED} frames fsst_frames",
    ),
    (
        " ".join(MAP_NAMES),
        CUBE | QUIET,
        f"{CUBED} signal range_profiles rtm signal_denoised {COMPENSATED_DENOISED} "
        "frames fsst_frames",
    ),
]
IDS = [
    f"{'all' if len(maps) > 60 else maps}, {' '.join(more) or 'default'}"
    for maps, more, _ in REQUESTS
]


def config_of(maps: str, more: dict) -> Config:
    """One second of a slow radar: every path is evaluated at pulses alone, in one block."""
    document = {
        "duration_s": 1.0,
        "radar": {"carrier_hz": 2e9, "bandwidth_hz": 1e9, "prf_hz": PULSES},
        "image": {"size_px": [16, WIDTH]},
        "maps": maps.split(),
        "motion": {"model": "paper"},
    }
    return Config.model_validate(document | more)


def scene_of(config: Config) -> Scene:
    return draw_scene(config, activity_named("walking"), 0)


@pytest.mark.parametrize(("maps", "more", "names"), REQUESTS, ids=IDS)
def test_what_runs(maps, more, names):
    """Exactly those products, each once, each after what it needs."""
    config = config_of(maps, more)
    asked = plan_images(config)
    executed = list(run(asked, {"scene": scene_of(config)}).seconds)
    images = [f"image:{name}" for name in maps.split()]
    images += [f"power:{name}" for name in maps.split() if name != "rtm"]  # when read
    assert sorted(executed) == sorted(names.split() + images)
    assert executed == [product.name for product in asked.products]
    for product in asked.products:
        for need in set(product.needs) - {"scene"}:
            assert executed.index(need) < executed.index(product.name)


def test_only_a_wall_is_crossed(monkeypatch):
    crossed: list[str] = []
    for module, name in (
        (motion_paths, "pass_wall"),
        (motion_paths, "wall_delay"),
        (scene_paths, "wall_of"),
    ):
        original = getattr(module, name)

        def noted(*arguments, name=name, original=original):
            found = original(*arguments)
            crossed.extend([] if name == "wall_of" and found is None else [name])
            return found

        monkeypatch.setattr(module, name, noted)
    for wall, expected in (
        ({}, set()),
        (WALL, {"pass_wall", "wall_delay", "wall_of"}),
    ):
        crossed.clear()
        config = config_of("stft_compensated rtm", wall)
        run(plan_images(config), {"scene": scene_of(config)})
        assert set(crossed) == expected


@pytest.mark.parametrize("with_mti", [True, False])
def test_range_profiles_compute_only_the_pulses_shown(monkeypatch, with_mti):
    asked: list[np.ndarray] = []
    original = PaperBody.positions

    def noted(body, t):
        asked.append(t)
        return original(body, t)

    monkeypatch.setattr(PaperBody, "positions", noted)
    config = config_of(
        "rtm", QUIET | {"processing": {"clutter": "difference" if with_mti else "none"}}
    )
    run(plan_images(config), {"scene": scene_of(config)})
    kept = PULSES - with_mti
    shown = {floor((j + 0.5) * kept / WIDTH) for j in range(WIDTH)}
    needed = shown | {m + 1 for m in shown} if with_mti else shown
    assert [t.tolist() for t in asked] == [[m / PULSES for m in sorted(needed)]]


def test_a_fast_radar_evaluates_the_body_at_its_knots(monkeypatch):
    """Not at each of its 5000 pulses a second: that is most of the price of a sample."""
    evaluated: list[int] = []
    original = PaperBody.positions

    def noted(body, t):
        evaluated.append(t.size)
        return original(body, t)

    monkeypatch.setattr(PaperBody, "positions", noted)
    config = Config.model_validate({"duration_s": 2.0, "maps": MAP_NAMES, "image": {"size_px": 16}})
    run(plan_images(config), {"scene": scene_of(config)})
    assert sum(evaluated) < 0.2 * 2.0 * 5000


def test_a_plan_knows_its_products():
    config = config_of("stft", QUIET)
    asked = plan(products.products(config), ["stft", "fsst"], ["scene"])
    assert isinstance(asked, Plan)
    assert "signal" in asked
    assert "torso_track" not in asked
    assert "signal" in asked.released_after["fsst"]
    assert not {"signal", "stft"} & set(asked.released_after["stft"])


@pytest.mark.parametrize("engine", ["direct", "cube"])
def test_every_product_can_be_made_alone(engine):
    """Whatever row of the table is asked for alone, it is made, and none but what it needs."""
    config = config_of(" ".join(MAP_NAMES), WALL | {"engine": {"kind": engine}})
    for name in products.products(config):
        recording = record(scene_of(config), [name])
        assert recording[name] is not None
        assert set(recording.products) == {name}
        assert not any(other.startswith("image:") for other in recording.seconds if other != name)
