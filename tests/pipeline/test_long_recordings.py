"""Long recordings and dense FSST maps: the memory is bounded, the result the same."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from peak_memory import PEAK
from radhar_cli.pipeline.axes import axes_of

from radhar_cli.activity import activity_named
from radhar_cli.config.schema import MAP_NAMES, Config
from radhar_cli.pipeline import run as run_module
from radhar_cli.pipeline import survey as survey_module
from radhar_cli.pipeline.plan import KEPT, plan, plan_images
from radhar_cli.pipeline.run import Recording, run
from radhar_cli.processing import frames as frames_module
from radhar_cli.scene import Scene, draw_scene

ROOT = Path(__file__).resolve().parents[2]
SMALL = {
    "radar": {"carrier_hz": 10e9, "bandwidth_hz": 1e9, "prf_hz": 500},
    "duration_s": 1.0,
    "maps": MAP_NAMES,
    "image": {"size_px": 32},
}
FLIPS = 1e-3  # one pixel of 32 x 32


def recorded(document: dict, *products: str) -> Recording:
    config = Config.model_validate(document)
    asked = plan(config, products) if products else plan_images(config)
    return run(asked, scene_of(config), config)


def scene_of(config: Config) -> Scene:
    return draw_scene(config, activity_named("walking"), 0)


@pytest.mark.parametrize("engine", ["direct", "cube"])
@pytest.mark.parametrize("processing", [{}, {"mti": False, "fsst_hop_pulses": 1}])
def test_blocks_and_chunks_change_nothing(monkeypatch, engine, processing):
    document = SMALL | {"engine": {"kind": engine}, "processing": processing}
    images, whole = recorded(document).products, recorded(document, *MAP_NAMES).products
    monkeypatch.setattr(frames_module, "BLOCK_COEFFICIENTS", 7 * 50)
    monkeypatch.setattr(run_module, "CHUNK", 37)
    blocked, parts = recorded(document).products, recorded(document, *MAP_NAMES).products
    for name in MAP_NAMES:
        assert parts[name].shape == whole[name].shape
        assert np.abs(parts[name] - whole[name]).max() < 1e-12 * whole[name].max()
        entropy = images[f"entropy:{name}"]
        assert blocked[f"entropy:{name}"] == pytest.approx(entropy, rel=1e-6)
        right, found = (p[f"levels:{name}"].astype(int) for p in (images, blocked))
        assert np.abs(found - right).max() <= 1
        assert np.mean(found != right) <= FLIPS


def test_what_was_asked_for_is_kept_and_no_more():
    kept = set(recorded(SMALL).products)
    images = {f"{kind}:{name}" for kind in ("levels", "entropy") for name in MAP_NAMES}
    assert kept == images | (set(KEPT) - {"wall"})
    asked = ("signal:plain", "stft_denoised", "slow_time", "spectrum:denoised")
    assert set(recorded(SMALL, *asked).products) - set(KEPT) == set(asked)


def test_products_are_released_as_soon_as_nobody_reads_them(monkeypatch):
    """At most two signals and the torso track at once, and one spectrum."""
    held = []

    def noted(function):
        def note(recording, stage):
            kinds = [name.partition(":")[0] for name in recording.products]
            held.append((kinds.count("signal"), sum("spectrum" in kind for kind in kinds)))
            return function(recording, stage)

        return note

    stages = {kind: noted(function) for kind, function in run_module.STAGES.items()}
    monkeypatch.setattr(run_module, "STAGES", stages)
    recorded(SMALL)
    assert max(signals for signals, _ in held) == 2
    assert max(spectra for _, spectra in held) == 1


class TestHop:
    """`processing.fsst_hop_pulses`: of the FSST alone."""

    @pytest.mark.parametrize("hop", [1, 3, 449, 450, 2**24])
    @pytest.mark.parametrize("processing", [{}, {"stft_fft_length": 64}])
    def test_axes_follow(self, hop, processing):
        document = SMALL | {"processing": processing | {"fsst_hop_pulses": hop}}
        recording = recorded(document, "stft", "fsst", "fsst_compensated")
        usual = recorded(SMALL | {"processing": processing}, "stft", "fsst")
        assert np.array_equal(recording.products["stft"], usual.products["stft"])
        columns = (499 - 50) // hop + 1
        for name in ("fsst", "fsst_compensated"):
            axes = axes_of(name, recording)
            assert recording.products[name].shape == (50, columns)
            assert axes.time == pytest.approx((np.arange(columns) * float(hop) + 25) / 500)
            assert axes.vertical.size == 50

    def test_a_dense_map_holds_the_columns_of_the_usual_one(self):
        usual = recorded(SMALL | {"processing": {"fsst_threshold": 0.0}}, "fsst").products["fsst"]
        processing = {"fsst_hop_pulses": 1, "fsst_threshold": 0.0}
        dense = recorded(SMALL | {"processing": processing}, "fsst").products["fsst"]
        assert np.array_equal(dense[:, ::5], usual)

    @pytest.mark.parametrize("more", [{}, {"stft_fft_length": 64}])
    def test_it_takes_its_own_spectrum_and_the_stft_keeps_its_own(self, more):
        document = SMALL | {"maps": ["stft", "fsst"], "processing": more | {"fsst_hop_pulses": 2}}
        stages = [s.name for s in plan_images(Config.model_validate(document)).stages]
        right = ["padded_spectrum:plain" if more else "spectrum:plain", "fsst_spectrum:plain"]
        assert [name for name in stages if "spectrum" in name] == right


def test_survey_in_parts_finds_the_same(monkeypatch):
    """Near, behind a wall, leaving the half-band: whatever there is to find, and when."""
    for more in ({}, {"wall": {}}, {"motion": {"range_m": 0.6, "angle_deg": 180}}):
        config = Config.model_validate(SMALL | more | {"duration_s": 4.0})
        scene = scene_of(config)
        whole = survey_module.survey(scene, config)
        with monkeypatch.context() as patch:
            patch.setattr(survey_module, "GRID_CHUNK", 11)
            assert survey_module.survey(scene, config) == whole


_PROGRAM = (
    PEAK
    + """
import sys
from radhar_cli.dataset.sample import synthesise
from radhar_cli.config.schema import Config
from radhar_cli.activity import activity_named
from radhar_cli.pipeline.plan import plan_images
from radhar_cli.scene import draw_scene
import numpy as np, json, scipy.fft, scipy.signal, PIL.Image
config = Config.model_validate(json.loads(sys.argv[1]))
before = peak()
synthesise(draw_scene(config, activity_named("punching"), 0), config, plan_images(config))
print((peak() - before) / 2**20)
"""
)


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_memory_follows_the_signal_and_not_the_map():
    """Two million pulses, 32 MB a signal; a whole map is 146 MB, its spectra 291.

    Three signals (paths, noise, sum) and the blocks, knots among them: 200 MiB with room to spare.
    """
    import json

    document = {
        "duration_s": 400.0,
        "maps": ["stft", "fsst"],
        "processing": {"overlap_fraction": 0.8},
        "image": {"size_px": 64},
    }
    command = [sys.executable, "-c", _PROGRAM, json.dumps(document)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    assert float(done.stdout) < 3 * 31 + 200
