"""Maps of one row or column, and numbers beyond float32: built, or refused, never lost."""

import h5py
import numpy as np
import pytest
from helpers.command_line import ok, radhar
from helpers.slow import slow_but

from radhar_cli.config.reading import load_config
from radhar_cli.dataset.sample import storable_array
from radhar_cli.errors import SceneError
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.scene.products.plan import plan
from radhar_cli.scene.products.run import run
from radhar_cli.scene.products.table import products
from radhar_cli.scene.scene import draw_scene

SMALL = """
samples_per_class: 1
activities: [punching, kicking]
image: {size_px: 32}
motion: {range_m: 3}
duration_s: 0.5
on_invalid: keep
split: {train: 1, validation: 0}
radar: {carrier_hz: 24e9, bandwidth_hz: 1e9, prf_hz: 500}
"""


def built(folder, text, *sets):
    """The data set of a config, verified; None and what was said where it is refused."""
    (folder / "c.yaml").write_text(text)
    words = [word for one in sets for word in ("--set", one)]
    ok("generate", folder / "c.yaml", "-o", folder / "set", "--jobs", 1, *words)
    ok("verify", folder / "set")
    return h5py.File(folder / "set/dataset.h5")


def test_a_map_of_one_column_spans_its_window(tmp_path):
    maps = "maps=[rtm, stft, fsst, stft_denoised]"
    with built(tmp_path, SMALL, "processing.window_s=0.498", maps, "output.power=float16") as file:
        for name in ("stft", "fsst", "stft_denoised"):
            left, right, bottom, top = file[f"extent/{name}"][0]
            assert right - left == pytest.approx(0.498)
            assert left == pytest.approx(0, abs=1e-9)
            assert bottom < top
            levels = file[f"maps/{name}"][0]
            assert (levels == levels[:, :1]).all()
            assert levels.max() >= 102  # that of the noise floor


@pytest.mark.parametrize("power", [0.0, 2.0])
def test_a_range_time_map_of_one_bin_spans_it(tmp_path, power):
    """Two samples a chirp have a bin, whose gain is 1."""
    radar = (
        "radar={carrier_hz: 24e9, bandwidth_hz: 1e9, prf_hz: 500, adc_rate_hz: 2e4, chirp_s: 1e-4}"
    )
    gain = f"processing.range_gain_power={power}"
    with built(tmp_path, SMALL, radar, "maps=[rtm]", gain) as file:
        *_, bottom, top = file["extent/rtm"][0]
        assert bottom == 0  # of the cell from -0.07 to 0.07 m
        assert top == pytest.approx(299792458 * 2e4 / (8 * 1e9 / 1e-4), rel=1e-9)
        assert len(np.unique(file["maps/rtm"][0], axis=0)) == 1


def test_one_frame_of_a_board_has_a_map_of_one_column(tmp_path):
    text = """
radar: {device: IWR1443BOOST, cfg: iwr1443boost}
activities: [punching]
samples_per_class: 1
duration_s: 0.05
motion: {range_m: 2}
maps: [stft, range_doppler, points]
image: {size_px: 32}
split: {train: 1, validation: 0}
"""
    with built(tmp_path, text) as file:
        left, right, *_ = file["extent/stft"][0]
        assert right - left == pytest.approx(0.0072, abs=0.001)  # 16 loops


ONE_SAMPLE = """
samples_per_class: 1
activities: [punching]
image: {size_px: 32}
duration_s: 0.5
on_invalid: keep
split: {train: 1, validation: 0}
"""
BAND = "carrier_hz: 24e9, bandwidth_hz: 1e9, prf_hz: 500"
RADARS = {
    "fmcw": f"radar: {{{BAND}}}",
    "noisy": f"radar: {{{BAND}}}\nsnr_db: 10",
    "cube": f"radar: {{{BAND}}}\nengine: {{kind: cube}}",
    "gated": f"radar: {{{BAND}}}\nprocessing: {{range_sum: gated, gate_m: 1}}",
    "sfcw": f"radar: {{{BAND}, waveform: sfcw, steps: 20, dwell_s: 2e-6}}",
    "cw": "radar: {carrier_hz: 24e9, prf_hz: 500, waveform: cw}",
    "real cw": "radar: {carrier_hz: 24e9, prf_hz: 500, waveform: cw, output: real}",
    "impulse": f"radar: {{{BAND}, waveform: impulse, profile_m: [0.2, 6], profile_samples: 2000}}\n"
    "processing: {range_sum: gated}",
    "board": "radar: {device: IWR1443BOOST, cfg: iwr1443boost}",
}


@pytest.mark.parametrize("radar", slow_but(RADARS, ("fmcw", "impulse", "board")))
def test_arrays_are_stored_and_other_products_refused_before_scenes(tmp_path, radar):
    """The list in the refusal is what can be stored; what is not in it is refused."""
    path = tmp_path / "c.yaml"
    path.write_text(ONE_SAMPLE + RADARS[radar])
    names = set(products(load_config(path)))
    command = ("generate", path, "-o", tmp_path / "set", "--jobs", 1)
    refused = radhar(*command, "--set", "output.products=[nonesuch]")
    arrays = refused.stderr.strip().rpartition("engine make: ")[2].split(", ")
    assert {"signal", "range_profiles", "torso_track"} <= set(arrays) <= names
    assert {"accuracy", "paths", "noise", "motions", "image:rtm"}.isdisjoint(arrays)

    others = {name for name in names if ":" not in name} - set(arrays)  # no key has a colon
    for name in sorted(others):
        for more in (["--dry-run"], []):
            done = radhar(*command, *more, "--set", f'output.products=["{name}"]')
            assert done.returncode == 2
            (line,) = done.stderr.strip().splitlines()
            assert f'output.products = ["{name}"]: should be arrays' in line
            assert ", ".join(arrays) in line
    assert not (tmp_path / "set").exists()

    ok(*command, "--set", f"output.products=[{', '.join(arrays)}]")
    with h5py.File(tmp_path / "set/dataset.h5") as file:
        assert set(file["products"]) >= set(arrays)


@pytest.mark.parametrize("radar", RADARS)
def test_products_that_say_they_are_no_arrays_are_none(tmp_path, radar):
    path = tmp_path / "c.yaml"
    path.write_text(ONE_SAMPLE + RADARS[radar])
    config = load_config(path)
    table = products(config)
    scene = draw_scene(config, activity_named("punching"), 0)
    others = [name for name, product in table.items() if not product.is_array]
    recording = run(plan(table, others, ["scene"]), {"scene": scene})
    for name in others:
        with pytest.raises(SceneError, match="should be an array"):
            storable_array(recording[name], name, 40.0)


OPAQUE = "wall={loss_tangent: 10}", "snr_reference=received", "snr_db=null", "radar.carrier_hz=5e9"


def test_maps_behind_an_opaque_wall_keep_their_values(tmp_path):
    """2e-60 is no float32: such a map is stored in float64."""
    (tmp_path / "c.yaml").write_text(SMALL)
    words = [word for one in OPAQUE for word in ("--set", one)]
    command = ("simulate", tmp_path / "c.yaml", "-a", "punching", "--no-figures")
    command = (*command, "--maps", "all", "-o", tmp_path / "o")
    ok(*command, *words)
    with h5py.File(tmp_path / "o/scene.h5") as file:
        for name in ("rtm", "stft", "fsst"):
            power = file[f"maps/{name}"]
            assert power.dtype == np.float64
            assert 0 < power[:].max() < 1e-40
    ok(*command, "--overwrite")
    with h5py.File(tmp_path / "o/scene.h5") as file:
        assert file["maps/stft"].dtype == np.float32


def test_slow_time_that_complex64_cannot_hold_is_refused(tmp_path):
    (tmp_path / "c.yaml").write_text(SMALL)
    words = [w for one in (*OPAQUE, "output.slow_time=true") for w in ("--set", one)]
    words += ["--set", "wall.loss_tangent=20"]
    done = radhar("generate", tmp_path / "c.yaml", "-o", tmp_path / "set", "--jobs", 1, *words)
    assert done.returncode == 2
    assert "output.slow_time: its largest value" in done.stderr
