"""Model only what a scene requires: for every request, what runs, and what it costs."""

import sys
from collections import Counter
from math import floor

import numpy as np
import pytest
import scipy.fft
from radhar_cli.pipeline.body_paths import BodyPaths

from radhar_cli.activity import activity_named
from radhar_cli.config.schema import MAP_NAMES, Config
from radhar_cli.echo import beat, cube, half_band_sum
from radhar_cli.motion.paper.body import Body
from radhar_cli.pipeline import run as run_module
from radhar_cli.pipeline.plan import Plan, plan, plan_images
from radhar_cli.processing import (
    denoising,
    doppler_compensation,
    fsst,
    image,
    mti,
    range_compression,
)
from radhar_cli.radar import noise, propagation, wall
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
requests = pytest.mark.parametrize(("maps", "more", "stages"), REQUESTS, ids=IDS)

# What one stage of a kind computes, and what it must not: calls of the functions below.
WORK: dict[str, dict[str, int]] = {
    # A table to look with, the one that is chosen, and that one again at the pulses near kinks.
    "slow_time": {"half_band_table": 3, "mti": 1},
    "slow_time_noise": {"circular_gaussian": 1, "mti": 1},
    "range_noise": {"circular_gaussian": 1},
    "range_profiles": {"beat_matrix": 1},
    "rtm": {"range_power": 1, "transform": 1},
    "torso_track": {"torso_delay": 1},
    "signal:denoised": {"savgol": 1},
    "signal:compensated": {"compensate": 1},
    "signal:compensated_denoised": {"savgol": 1},
    "spectrum": {"transform": 1},
    "padded_spectrum": {"transform": 1},
    "fsst_spectrum": {"transform": 1},
    "fsst": {"synchrosqueeze": 1, "transform": 1},
    "reduced": {"reduced": 1},
    "levels": {"levels": 1},
}
CUBE_WORK: dict[str, dict[str, int]] = WORK | {
    "signal_power": {"signal_power": 1},
    "signal:plain": {"half_band_signal": 1, "range_compression": 1, "transform": 1},
    "rtm": {"range_power": 1, "transform": 1},
    "beat_cube": {"beat_matrix": 1, "beat_blocks": 1, "mti": 1},
}


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


@pytest.fixture
def executed(monkeypatch):
    """Names of the stages that run, in order: every entry of STAGES reports itself."""
    names: list[str] = []

    def reporting(function):
        def report(recording, stage):
            names.append(stage.name)
            return function(recording, stage)

        return report

    stages = {kind: reporting(function) for kind, function in run_module.STAGES.items()}
    monkeypatch.setattr(run_module, "STAGES", stages)
    return names


@pytest.fixture
def work(monkeypatch):
    """Calls of the functions that cost something, wherever in the package they are called from.

    Geometry is counted in pulses, transforms where they are of whole matrices.
    """
    counts: Counter[str] = Counter()

    def counted(function, label, size):
        def count(*args, **kwargs):
            counts[label] += size(*args)
            return function(*args, **kwargs)

        return count

    def one(*args):
        return 1

    ours = [module for name, module in sys.modules.items() if name.startswith("radhar_cli")]
    for home, name, size in (
        (propagation, "leg", lambda p, antenna: p.shape[-1]),
        (wall, "crossing", lambda p, antenna, slab: p.shape[-1]),
        (wall, "extra_delay", lambda chord, slab: chord.shape[-1]),
        (wall, "field_factor", lambda crossed, slab, fc: crossed.chord.shape[-1]),
        (noise, "circular_gaussian", one),
        (half_band_sum, "half_band_table", one),
        (beat, "beat_matrix", one),
        (cube, "beat_blocks", one),
        (cube, "signal_power", one),
        (mti, "mti", one),
        (range_compression, "range_compression", one),
        (range_compression, "range_power", one),
        (range_compression, "half_band_signal", one),
        (doppler_compensation, "compensate", one),
        (denoising, "savgol", one),
        (fsst, "synchrosqueeze", one),
        (image, "reduced", one),
        (image, "levels", one),
    ):
        original = getattr(home, name)
        for module in ours:
            if vars(module).get(name) is original:
                monkeypatch.setattr(module, name, counted(original, name, size))
    for owner, name, size in (
        (Body, "positions", lambda body, t: t.size),
        (Body, "torso", lambda body, t: t.size),
        (BodyPaths, "torso_delay", one),
    ):
        monkeypatch.setattr(owner, name, counted(getattr(owner, name), name, size))
    for library in (scipy.fft, np.fft):
        for name in ("fft", "ifft", "rfft", "irfft", "fft2", "ifft2"):
            whole = counted(getattr(library, name), "transform", lambda x, *more: np.ndim(x) == 2)
            monkeypatch.setattr(library, name, whole)
    return counts


@requests
def test_what_runs(executed, maps, more, stages):
    """Exactly those stages, each once, each after what it needs."""
    config = config_of(maps, more)
    asked = plan_images(config)
    recording = run_module.run(asked, scene_of(config), config)
    assert sorted(executed) == expected_stages(maps, stages)
    assert executed == [stage.name for stage in asked.stages]
    assert list(recording.seconds) == executed
    for stage in asked.stages:
        for need in stage.needs:
            assert executed.index(need) < executed.index(stage.name)


def expected_work(config: Config, stages: list[str]) -> Counter:
    """The sum over the stages, and how many pulses the paths are evaluated at, and why."""
    of_cube, noisy = config.engine.kind == "cube", config.snr_db is not None
    total: Counter[str] = Counter()
    for name in stages:
        kind = name.partition(":")[0]
        table = CUBE_WORK if of_cube else WORK
        total.update(table.get(name) or table.get(kind) or {})
        if name.startswith("reduced:fsst"):
            total.update(table["fsst"])
    if of_cube and noisy:
        total["circular_gaussian"] += 1
    if not config.processing.mti:
        total["mti"] = 0
    if of_cube:
        pulses = PULSES * (1 + noisy)  # once for the noise's power, once for the matrix
    else:
        pulses = PULSES if "echo" in stages else 0
        if "range_profiles" in stages:
            pulses += WIDTH * (2 if config.processing.mti else 1)
    torso = PULSES if "torso_track" in stages else 0
    total["positions"], total["torso"] = pulses, torso
    total["leg"] = 2 * (pulses + torso)
    if config.wall is not None:
        total["crossing"] = total["extra_delay"] = 2 * (pulses + torso)
        total["field_factor"] = 2 * pulses
    return +total


@requests
def test_what_it_costs(work, maps, more, stages):
    """No stage does hidden work: every call of the physics is accounted for."""
    config = config_of(maps, more)
    run_module.run(plan_images(config), scene_of(config), config)
    assert +work == expected_work(config, expected_stages(maps, stages))


class TestSpecificPromises:
    """What the table says, for those who look for one promise."""

    def spent(self, work, maps: str, **more: object) -> Counter:
        config = config_of(maps, more)
        work.clear()
        run_module.run(plan_images(config), scene_of(config), config)
        return work

    def test_a_doppler_map_needs_no_beat_matrix(self, work):
        assert self.spent(work, "stft")["beat_matrix"] == 0

    def test_a_range_map_needs_no_slow_time_signal(self, work):
        spent = self.spent(work, "rtm")
        assert spent["half_band_table"] == 0
        assert spent["transform"] == 1  # of the range profiles

    def test_only_synchrosqueezing_takes_a_second_transform(self, work):
        assert self.spent(work, "stft")["transform"] == 1
        assert self.spent(work, "fsst")["transform"] == 2
        assert self.spent(work, "stft fsst")["transform"] == 2

    def test_only_compensation_takes_a_torso_track(self, work):
        assert self.spent(work, "stft_denoised fsst rtm")["torso"] == 0
        assert self.spent(work, "stft_compensated fsst_compensated_denoised")["torso"] == PULSES

    def test_only_a_wall_takes_chords(self, work):
        assert self.spent(work, "stft rtm")["crossing"] == 0
        assert self.spent(work, "stft rtm", wall={})["crossing"] > 0

    def test_only_noise_takes_random_numbers_and_power(self, work):
        quiet = self.spent(work, " ".join(MAP_NAMES), snr_db=None)
        assert quiet["circular_gaussian"] == quiet["signal_power"] == 0
        assert self.spent(work, " ".join(MAP_NAMES))["circular_gaussian"] == 2

    @pytest.mark.parametrize("with_mti", [True, False])
    def test_range_profiles_look_at_the_pulses_shown_alone(self, monkeypatch, with_mti):
        asked: list[np.ndarray] = []
        original = Body.positions

        def noted(body, t):
            asked.append(t)
            return original(body, t)

        monkeypatch.setattr(Body, "positions", noted)
        config = config_of("rtm", QUIET | {"processing": {"mti": with_mti}})
        run_module.run(plan_images(config), scene_of(config), config)
        kept = PULSES - with_mti
        shown = {floor((j + 0.5) * kept / WIDTH) for j in range(WIDTH)}
        needed = shown | {m + 1 for m in shown} if with_mti else shown
        assert [t.tolist() for t in asked] == [[m / PULSES for m in sorted(needed)]]

    def test_the_cube_is_gone_through_once_for_all_maps(self, work):
        spent = self.spent(work, " ".join(MAP_NAMES), **CUBE)
        assert spent["beat_blocks"] == spent["beat_matrix"] == 1


def test_a_fast_radar_evaluates_the_body_at_its_knots(monkeypatch):
    """Not at each of its 5000 pulses a second: that is most of the price of a sample."""
    evaluated: list[int] = []
    original = Body.positions

    def noted(body, t):
        evaluated.append(t.size)
        return original(body, t)

    monkeypatch.setattr(Body, "positions", noted)
    config = Config.model_validate({"duration_s": 2.0, "maps": MAP_NAMES, "image": {"size_px": 16}})
    run_module.run(plan_images(config), scene_of(config), config)
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
        recording = run_module.run(plan(config, [name]), scene_of(config), config)
        assert recording.products[name] is not None
        assert not any(other.startswith(("levels", "entropy")) for other in recording.products)
