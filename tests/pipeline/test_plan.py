"""Model only what a scene requires: for every request, what runs and what does not."""

from math import floor

import numpy as np
import pytest
from radhar_cli.body.pose import Body

from radhar_cli.activity import activity_named
from radhar_cli.config.schema import MAP_NAMES, Config
from radhar_cli.pipeline.plan import Plan, plan, plan_images
from radhar_cli.pipeline.run import run
from radhar_cli.scene import Scene, draw_scene

PULSES, WIDTH = 128, 20

QUIET, WALL, CUBE = {"snr_db": None}, {"wall": {}}, {"engine": {"kind": "cube"}}
LONG_FFT = {"processing": {"stft_fft_length": 64}}
OWN_HOP = {"processing": {"fsst_hop_pulses": 1}}

# What runs besides the map itself, its entropy and its levels. Written by hand: change it only
# where the physics needs another stage.
SIGNAL = "paths echo slow_time signal:plain"
NOISY = f"{SIGNAL} signal_power slow_time_noise"
PROFILES = "paths range_profiles"
NOISY_PROFILES = "paths echo signal_power range_noise range_profiles"
CUBED = "paths beat_cube"
COMPENSATED = "torso_track signal:compensated"
COMPENSATED_DENOISED = f"{COMPENSATED} signal:compensated_denoised"

REQUESTS: list[tuple[str, dict, str]] = [
    # maps, config, stages
    ("rtm", {}, NOISY_PROFILES),
    ("rtm", QUIET, PROFILES),
    ("stft", {}, f"{NOISY} spectrum:plain"),
    ("stft", QUIET, f"{SIGNAL} spectrum:plain"),
    ("stft_denoised", QUIET, f"{SIGNAL} signal:denoised spectrum:denoised"),
    ("stft_compensated", QUIET, f"{SIGNAL} {COMPENSATED} spectrum:compensated"),
    (
        "stft_compensated_denoised",
        QUIET,
        f"{SIGNAL} {COMPENSATED_DENOISED} spectrum:compensated_denoised",
    ),
    ("fsst", {}, f"{NOISY} spectrum:plain"),
    ("fsst", QUIET, f"{SIGNAL} spectrum:plain"),
    ("fsst_denoised", QUIET, f"{SIGNAL} signal:denoised spectrum:denoised"),
    ("fsst_compensated", {}, f"{NOISY} {COMPENSATED} spectrum:compensated"),
    (
        "fsst_compensated_denoised",
        QUIET,
        f"{SIGNAL} {COMPENSATED_DENOISED} spectrum:compensated_denoised",
    ),
    ("stft fsst", {}, f"{NOISY} spectrum:plain"),
    ("stft_denoised fsst_denoised", {}, f"{NOISY} signal:denoised spectrum:denoised"),
    ("rtm stft", QUIET, f"{SIGNAL} range_profiles spectrum:plain"),
    ("rtm stft", {}, f"{NOISY} range_noise range_profiles spectrum:plain"),
    (
        "stft_compensated fsst_compensated_denoised",
        QUIET,
        f"{SIGNAL} {COMPENSATED_DENOISED} spectrum:compensated spectrum:compensated_denoised",
    ),
    ("stft", WALL, f"wall {NOISY} spectrum:plain"),
    ("rtm", WALL | QUIET, f"wall {PROFILES}"),
    ("fsst_compensated", WALL, f"wall {NOISY} {COMPENSATED} spectrum:compensated"),
    ("stft", LONG_FFT, f"{NOISY} padded_spectrum:plain"),
    ("fsst", LONG_FFT, f"{NOISY} spectrum:plain"),
    ("stft fsst", LONG_FFT | QUIET, f"{SIGNAL} padded_spectrum:plain spectrum:plain"),
    ("stft fsst", OWN_HOP, f"{NOISY} spectrum:plain fsst_spectrum:plain"),
    ("fsst_denoised", OWN_HOP, f"{NOISY} signal:denoised fsst_spectrum:denoised"),
    ("stft", OWN_HOP | QUIET, f"{SIGNAL} spectrum:plain"),
    ("stft", {"processing": {"mti": False}}, f"{NOISY} spectrum:plain"),
    ("rtm", {"processing": {"mti": False}} | QUIET, PROFILES),
    ("stft", CUBE, f"{CUBED} signal_power signal:plain spectrum:plain"),
    ("stft", CUBE | QUIET, f"{CUBED} signal:plain spectrum:plain"),
    ("rtm", CUBE, f"{CUBED} signal_power"),
    ("rtm", CUBE | QUIET | WALL, f"wall {CUBED}"),
    ("rtm stft", CUBE, f"{CUBED} signal_power signal:plain spectrum:plain"),
    (
        " ".join(MAP_NAMES),
        WALL,
        f"wall {NOISY} range_noise range_profiles signal:denoised {COMPENSATED_DENOISED} "
        "spectrum:plain spectrum:denoised spectrum:compensated spectrum:compensated_denoised",
    ),
    (
        " ".join(MAP_NAMES),
        CUBE | QUIET,
        f"{CUBED} signal:plain signal:denoised {COMPENSATED_DENOISED} "
        "spectrum:plain spectrum:denoised spectrum:compensated spectrum:compensated_denoised",
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
    }
    return Config.model_validate(document | more)


def scene_of(config: Config) -> Scene:
    return draw_scene(config, activity_named("walking"), 0)


def expected_stages(maps: str, stages: str) -> list[str]:
    names = stages.split()
    for name in maps.split():
        names += [f"{kind}:{name}" for kind in ("reduced", "entropy", "levels")]
        names += ["rtm"] if name == "rtm" else []
    return sorted(names)


@pytest.mark.parametrize(("maps", "more", "stages"), REQUESTS, ids=IDS)
def test_what_runs(maps, more, stages):
    """Exactly those stages, each once, each after what it needs."""
    config = config_of(maps, more)
    asked = plan_images(config)
    executed = list(run(asked, scene_of(config), config).seconds)
    assert sorted(executed) == expected_stages(maps, stages)
    assert executed == [stage.name for stage in asked.stages]
    for stage in asked.stages:
        for need in stage.needs:
            assert executed.index(need) < executed.index(stage.name)


class TestSpecificPromises:
    """What the table says, for those who look for one promise."""

    def stages(self, maps: str, **more: object) -> list[str]:
        return [stage.name for stage in plan_images(config_of(maps, more)).stages]

    def test_a_doppler_map_needs_no_range_profiles(self):
        assert not {"beat_cube", "range_profiles"} & set(self.stages("stft"))

    def test_a_range_map_needs_no_slow_time_signal(self):
        assert not {"slow_time", "signal:plain", "spectrum:plain"} & set(self.stages("rtm"))

    def test_both_kinds_of_spectrogram_share_a_spectrum(self):
        assert self.stages("stft fsst").count("spectrum:plain") == 1

    def test_only_compensation_takes_a_torso_track(self):
        assert "torso_track" not in self.stages("stft_denoised fsst rtm")
        both = self.stages("stft_compensated fsst_compensated_denoised")
        assert both.count("torso_track") == 1

    def test_only_a_wall_is_crossed(self):
        assert "wall" not in self.stages("stft rtm")
        assert "wall" in self.stages("stft rtm", wall={})

    def test_only_noise_takes_random_numbers_and_power(self):
        noise = {"signal_power", "slow_time_noise", "range_noise"}
        assert not noise & set(self.stages(" ".join(MAP_NAMES), snr_db=None))
        assert noise <= set(self.stages(" ".join(MAP_NAMES)))

    def test_the_cube_is_gone_through_once_for_all_maps(self):
        assert self.stages(" ".join(MAP_NAMES), **CUBE).count("beat_cube") == 1

    @pytest.mark.parametrize("with_mti", [True, False])
    def test_range_profiles_look_at_the_pulses_shown_alone(self, monkeypatch, with_mti):
        asked: list[np.ndarray] = []
        original = Body.positions

        def noted(body, t):
            asked.append(t)
            return original(body, t)

        monkeypatch.setattr(Body, "positions", noted)
        config = config_of("rtm", QUIET | {"processing": {"mti": with_mti}})
        run(plan_images(config), scene_of(config), config)
        kept = PULSES - with_mti
        shown = {floor((j + 0.5) * kept / WIDTH) for j in range(WIDTH)}
        needed = shown | {m + 1 for m in shown} if with_mti else shown
        assert [t.tolist() for t in asked] == [[m / PULSES for m in sorted(needed)]]


def test_a_fast_radar_evaluates_the_body_at_its_knots(monkeypatch):
    """Not at each of its 5000 pulses a second: that is most of the price of a sample."""
    evaluated: list[int] = []
    original = Body.positions

    def noted(body, t):
        evaluated.append(t.size)
        return original(body, t)

    monkeypatch.setattr(Body, "positions", noted)
    config = Config.model_validate({"duration_s": 2.0, "maps": MAP_NAMES, "image": {"size_px": 16}})
    run(plan_images(config), scene_of(config), config)
    assert sum(evaluated) < 0.2 * 2.0 * 5000


def test_a_plan_knows_its_stages_and_who_reads_them():
    asked = plan(config_of("stft", QUIET), ["stft", "fsst"])
    assert isinstance(asked, Plan)
    assert "spectrum:plain" in asked
    assert "torso_track" not in asked
    assert asked.wanted_by("spectrum:plain") == ("stft", "fsst")
    assert asked.wanted_by("stft") == ()
    assert [s.name for s in asked.stages if s.variant == "plain"] == [
        "signal:plain",
        "spectrum:plain",
    ]


@pytest.mark.parametrize("engine", ["direct", "cube"])
def test_every_stage_there_could_be_can_run(engine):
    """No entry of the graph is without its function, and none is computed unless asked for."""
    config = config_of(" ".join(MAP_NAMES), WALL | {"engine": {"kind": engine}})
    for name in (*MAP_NAMES, "torso_track", "signal_power", "wall", "signal:compensated_denoised"):
        recording = run(plan(config, [name]), scene_of(config), config)
        assert recording.products[name] is not None
        assert not any(other.startswith(("levels", "entropy")) for other in recording.products)
