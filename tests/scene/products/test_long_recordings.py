"""Long recordings and dense FSST maps: the memory is bounded, the result the same."""

import gc
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from weakref import WeakValueDictionary

import numpy as np
import pytest
from helpers.peak_memory import PEAK

from radhar_cli.config.data_set import Config
from radhar_cli.config.maps import MAP_NAMES
from radhar_cli.echo import exact as exact_module
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.processing import stft as stft_module
from radhar_cli.processing.signal import Signal
from radhar_cli.scene.checks import check_grid
from radhar_cli.scene.checks.validity import check_scene
from radhar_cli.scene.products.plan import plan
from radhar_cli.scene.products.run import Results, record, run
from radhar_cli.scene.products.table import plan_images, products
from radhar_cli.scene.scene import Scene, draw_scene

ROOT = Path(__file__).resolve().parents[3]
WINDOW = {"window_s": 0.1}
SMALL = {
    "radar": {"carrier_hz": 10e9, "bandwidth_hz": 1e9, "prf_hz": 500},
    "duration_s": 1.0,
    "processing": WINDOW,
    "maps": MAP_NAMES,
    "image": {"size_px": 32},
}
IMAGES = [f"image:{name}" for name in MAP_NAMES]
FLIPS = 1e-3  # one pixel of 32 x 32


def recorded(document: dict, *names: str) -> Results:
    return record(scene_of(Config.model_validate(document)), names)


def scene_of(config: Config) -> Scene:
    return draw_scene(config, activity_named("walking"), 0)


@pytest.mark.parametrize("engine", ["direct", "cube"])
@pytest.mark.parametrize("processing", [{}, {"clutter": "none", "fsst_hop_pulses": 1}])
def test_blocks_and_chunks_change_nothing(monkeypatch, engine, processing):
    document = SMALL | {"engine": {"kind": engine}, "processing": WINDOW | processing}
    whole = recorded(document, *MAP_NAMES, *IMAGES)
    monkeypatch.setattr(stft_module, "BLOCK_COEFFICIENTS", 7 * 50)
    monkeypatch.setattr(exact_module, "BLOCK_SAMPLES", 37 * adc_samples(document))
    parts = recorded(document, *MAP_NAMES, *IMAGES)
    for name in MAP_NAMES:
        right, found = whole[name].power, parts[name].power
        assert found.shape == right.shape
        assert np.abs(found - right).max() < 1e-12 * right.max()
        right, found = whole[f"image:{name}"], parts[f"image:{name}"]
        assert found.entropy == pytest.approx(right.entropy, rel=1e-6)
        steps = np.abs(found.levels.astype(int) - right.levels)
        assert steps.max() <= 1
        assert np.mean(steps > 0) <= FLIPS


def adc_samples(document: dict) -> int:
    """ADC samples of a chirp."""
    return recorded(document, "waveform")["waveform"].n_adc


def test_only_requested_products_are_kept():
    asked = ("signal", "stft_denoised", "slow_time", "image:fsst")
    assert set(recorded(SMALL, *asked).products) == set(asked)


@pytest.mark.parametrize("engine", ["direct", "cube"])
def test_signals_are_released_after_their_last_use(engine):
    """At most two at once when an image is made, and none is left."""
    alive, held = WeakValueDictionary[int, Signal](), []

    def noted(product):
        def make(*needs):
            found = product.make(*needs)
            alive.update((id(part), part) for part in (found, *needs) if isinstance(part, Signal))
            held.append(len(alive))
            return found

        return replace(product, make=make)

    config = Config.model_validate(SMALL | {"engine": {"kind": engine}})
    table = {name: noted(product) for name, product in products(config).items()}
    asked = plan_images(config).requested
    recording = run(plan(table, asked, ["scene"]), {"scene": scene_of(config)})
    gc.collect()
    assert max(held) <= 2
    assert not alive
    assert set(recording.products) == set(asked)


class TestHop:
    """`processing.fsst_hop_pulses`: of the FSST alone."""

    @pytest.mark.parametrize("hop", [1, 3, 449, 450, 2**24])
    @pytest.mark.parametrize("processing", [{}, {"stft_fft_length": 64}])
    def test_axes_follow(self, hop, processing):
        document = SMALL | {"processing": WINDOW | processing | {"fsst_hop_pulses": hop}}
        recording = recorded(document, "stft", "fsst", "fsst_compensated")
        usual = recorded(SMALL | {"processing": WINDOW | processing}, "stft")
        assert np.array_equal(recording["stft"].power, usual["stft"].power)
        columns = (499 - 50) // hop + 1
        for name in ("fsst", "fsst_compensated"):
            found = recording[name]
            assert found.power.shape == (50, columns)
            assert found.columns.values == pytest.approx(
                (np.arange(columns) * float(hop) + 25) / 500
            )
            assert found.rows.values.size == 50

    def test_a_dense_map_holds_the_columns_of_the_usual_one(self):
        processing = WINDOW | {"fsst_threshold": 0.0}
        usual = recorded(SMALL | {"processing": processing}, "fsst")["fsst"]
        processing |= {"fsst_hop_pulses": 1}
        dense = recorded(SMALL | {"processing": processing}, "fsst")["fsst"]
        assert np.array_equal(dense.power[:, ::5], usual.power)


def test_checking_a_scene_in_chunks_finds_the_same(monkeypatch):
    """Near, behind a wall, leaving the half-band: whatever there is to find, and when."""
    for more in ({}, {"wall": {}}, {"motion": {"range_m": 0.6, "angle_deg": 180}}):
        scene = scene_of(Config.model_validate(SMALL | more | {"duration_s": 4.0}))
        whole = check_scene(scene)
        with monkeypatch.context() as patch:
            patch.setattr(check_grid, "GRID_CHUNK", 11)
            assert check_scene(scene) == whole


_PROGRAM = (
    PEAK
    + """
import sys
from radhar_cli.dataset.sample import synthesise
from radhar_cli.config.data_set import Config
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.echo import compiled
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.scene import draw_scene
import numpy as np, json, scipy.fft, scipy.signal, PIL.Image
def make(document):
    config = Config.model_validate(document)
    synthesise(draw_scene(config, activity_named("punching"), 0), plan_images(config), config)
compiled.MIN_TERMS = 0
document = json.loads(sys.argv[1])
make(document | {"duration_s": 4.0})  # so that numba is loaded, if it is there
before = peak()
make(document)
print((peak() - before) / 2**20)
"""
)


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.slow
def test_memory_follows_the_signal_and_not_the_map():
    """Two million pulses, 32 MB a signal; a whole map is 146 MB, its spectra 291.

    Three signals (paths, noise, sum) and the blocks, knots among them: 200 MiB with room to spare.
    """
    document = {
        "duration_s": 400.0,
        "maps": ["stft", "fsst"],
        "processing": {"overlap_fraction": 0.8},
        "image": {"size_px": 64},
    }
    command = [sys.executable, "-c", _PROGRAM, json.dumps(document)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    assert float(done.stdout) < 3 * 31 + 200
