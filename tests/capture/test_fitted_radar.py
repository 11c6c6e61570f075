"""A radar comes back from recordings that were simulated with it, and its maps have their axes."""

from dataclasses import asdict

import h5py
import numpy as np
import pytest
import yaml
from helpers.command_line import ok, radhar
from helpers.slow import slow

from radhar_cli.capture.fitted_radar import differing_key, frames_in
from radhar_cli.capture.recording import Recording
from radhar_cli.config import load_config
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.motion.skeleton import TORSO
from radhar_cli.radar.pulse_times import PulseTimes

CHIRPS = {
    "carrier_hz": 24e9, "bandwidth_hz": 250e6, "adc_rate_hz": 1e6, "chirp_s": 128e-6,
}  # fmt: skip
L_SHAPE = [[0, 0], [1, 0], [1, 1]]
PAUSED = {"chirps": 64, "interval_s": 250e-6, "period_s": 0.05}
X4 = {"waveform": "impulse", "carrier_hz": 6.54e9, "bandwidth_hz": 1.5e9, "prf_hz": 256,
      "profile_m": [0.3, 6.3], "profile_samples": 128, "output": "iq"}  # fmt: skip
RADARS = {
    "fmcw": CHIRPS | {"prf_hz": 2000},
    "frames": CHIRPS | {"prf_hz": 2000, "frame": {"chirps": 64}},
    "array_iq": CHIRPS | {"frame": PAUSED, "array": {"rx": L_SHAPE}, "tilt_deg": 5},
    "array_real": CHIRPS | {"frame": PAUSED, "array": {"rx": L_SHAPE}, "output": "real"},
    "turns": CHIRPS | {"frame": PAUSED | {"chirps": 32},
                       "array": {"tx": [[0, 0], [2, 0]], "rx": [[0, 0], [1, 0]]}},
    "sfcw": {"waveform": "sfcw", "steps": 64, "dwell_s": 1e-5, "carrier_hz": 2e9,
             "bandwidth_hz": 1e9, "prf_hz": 500},
    "sfcw_array": {"waveform": "sfcw", "steps": 64, "dwell_s": 1e-5, "carrier_hz": 2e9,
                   "bandwidth_hz": 1e9,
                   "frame": {"chirps": 32, "interval_s": 4e-3, "period_s": 0.2},
                   "array": {"rx": [[0, 0], [1, 0]]}},
    "sfcw_fine": {"waveform": "sfcw", "steps": 160, "dwell_s": 1e-5, "carrier_hz": 2e9,
                  "bandwidth_hz": 1e9, "prf_hz": 500},
    "cw_array": {"waveform": "cw", "carrier_hz": 24e9, "prf_hz": 4000, "frame": {"chirps": 64},
                 "array": {"rx": [[0, 0], [1, 0]]}},
    "cw_iq": {"waveform": "cw", "carrier_hz": 24e9, "prf_hz": 4000},
    "cw_real": {"waveform": "cw", "carrier_hz": 24e9, "prf_hz": 4000, "output": "real"},
    "impulse_rf": {"waveform": "impulse", "carrier_hz": 0.7e9, "bandwidth_hz": 1.6e9,
                   "prf_hz": 128, "profile_m": [0, 6]},
    "impulse_iq": X4,
    "board": {"cfg": "iwr1443boost", "device": "IWR1443BOOST"},
    "beam": CHIRPS | {"prf_hz": 2000, "beam": {"azimuth_deg": 40, "elevation_deg": 20}},
    "narrow": CHIRPS | {"frame": PAUSED, "array": {"rx": L_SHAPE}, "half_power_deg": [20, 8]},
    "saw": {"carrier_hz": 24e9, "bandwidth_hz": 240e6, "adc_rate_hz": 200e3, "chirp_s": 1e-3,
            "prf_hz": 20},
    "board_iq2": {"cfg": "iwr6843isk", "device": "IWR6843ISK"},
}  # fmt: skip
SNR_DB = {"impulse_rf": 30, "impulse_iq": 30}


def written(folder, name, snr_db, **more):
    document = {
        "radar": RADARS[name], "activities": ["walking"], "duration_s": 2, "snr_db": snr_db,
        "motion": {"range_m": 3}, "maps": ["rtm"], **more,
    }  # fmt: skip
    if name.startswith(("cw", "board")):
        document["maps"] = ["stft"]
    (folder / "radar.yaml").write_text(yaml.safe_dump(document))
    return folder / "radar.yaml"


def recorded(folder, name):
    path = written(folder, name, SNR_DB.get(name, 15))
    ok("simulate", path, "--raw", "--no-figures", "-o", folder / "raw", "--seed", 1)
    return path, folder / "raw" / "recording.h5"


def same(radar, other):
    """What differs in two radars, whichever keys say their times; None for nothing."""
    documents = []
    for one in (radar, other):
        document = one.model_dump(mode="json")
        if isinstance(one, ArrayRadar):
            document |= {"frame": None, "prf_hz": None, "array": str(one.elements)}
            document["timing"] = asdict(one.timing)
        documents.append(document)
    return differing_key(*documents)


@pytest.mark.every(5)
@pytest.mark.parametrize("name", RADARS)
def test_the_radar_comes_back(tmp_path, name):
    path, recording = recorded(tmp_path, name)
    ok("fit", recording, "-o", tmp_path / "fitted.yaml")
    fitted = load_config(tmp_path / "fitted.yaml").filled()
    radar = load_config(path).filled().radar
    assert same(fitted.radar, radar) is None
    if radar.waveform == "cw":
        assert fitted.radar.carrier_hz == radar.carrier_hz


def fitted_snr(config, folder, seed):
    """SNR that `fit` finds in a recording that is simulated by a config, and the fitted config."""
    ok("simulate", config, "--raw", "--no-figures", "-o", folder, "--seed", seed)
    ok("fit", folder / "recording.h5", "-o", folder / "fitted.yaml")
    return load_config(folder / "fitted.yaml").snr_db, folder / "fitted.yaml"


WITH_SNR = ("fmcw", "frames", "array_iq", "array_real", "turns", "beam", "narrow", "board",
            "board_iq2", "saw")  # fmt: skip


@pytest.mark.every(4)
@pytest.mark.parametrize("name", WITH_SNR)
@pytest.mark.parametrize(("snr_db", "seed"), [(20, 6), *slow([(0, 4)])])
def test_the_snr_comes_back_as_received(tmp_path, name, snr_db, seed):
    """Within 2.2 dB: interference of the limbs, over 2 to 4 s; five seeds of one radar differ so.

    `saw` has so few pulses per second that a person is no faster than a curtain.
    """
    is_board = name.startswith("board")
    more = {"snr_reference": "received", "duration_s": 2 if is_board else 4}
    config = written(tmp_path, name, snr_db, **more)
    found, fitted = fitted_snr(config, tmp_path / "raw", seed)
    assert found == pytest.approx(snr_db, abs=2.2)
    has_beam = name not in ("fmcw", "saw")
    assert ("snr_reference" in yaml.safe_load(fitted.read_text())) == has_beam


# {radar: SNR of a walk, and where it begins, m}
WALKS = {
    "fmcw": (12, 8),
    "array_real": (10, 7),
    "sfcw_fine": (8, 8),
    "impulse_iq": (30, 5),
    "cw_iq": (10, 8),
    "board": (-5, 5.5),
}


@pytest.mark.every(3)
@pytest.mark.parametrize("name", WALKS)
def test_a_walk_counts_as_a_whole(tmp_path, name):
    """Most of its power is in its last second, when the walker is near (A^2 goes with R^-4)."""
    snr_db, begin_m = WALKS[name]
    motion = {"range_m": begin_m, "angle_deg": 180, "speed_mps": 1}
    more = {"snr_reference": "received", "duration_s": 5, "motion": motion, "maps": ["stft"]}
    found, fitted = fitted_snr(written(tmp_path, name, snr_db, **more), tmp_path / "raw", 1)
    assert found == pytest.approx(snr_db, abs=2)
    if name not in ("cw_iq", "board"):  # without ranges, and with a track that is unsure
        with h5py.File(tmp_path / "raw/scene.h5") as scene:
            torso = scene["truth/positions"][:, TORSO]
        expected = np.percentile(np.linalg.norm(torso[:, :2], axis=1), [5, 95])
        ranges = yaml.safe_load(fitted.read_text())["motion"]["place"]["range_m"]["uniform"]
        assert ranges == pytest.approx(expected, abs=0.3)


def test_the_snr_of_parts_is_their_power_mean(tmp_path):
    """Of a recording of two parts, and of recordings the mean of their decibels."""
    near = {"duration_s": 9, "motion": {"range_m": 11, "angle_deg": 180, "speed_mps": 1}}
    config = written(tmp_path, "cw_iq", 12, snr_reference="received", **near)
    found, _ = fitted_snr(config, tmp_path / "raw", 1)
    assert found == pytest.approx(12, abs=2)


def test_complex_and_real_recordings_are_refused_as_such(tmp_path):
    paths = []
    for name in ("cw_iq", "cw_real"):
        ok("simulate", written(tmp_path, name, 20), "--raw", "--no-figures", "-o", tmp_path / name)
        paths.append(tmp_path / name / "recording.h5")
    done = radhar("fit", *paths, "-o", tmp_path / "fitted.yaml")
    assert done.returncode == 2
    assert f"has real samples; should have complex ones, as {paths[0]}" in done.stderr


def test_a_walker_in_the_far_half_of_the_band_counts(tmp_path):
    """Of a board's complex samples, whose range bins go through the whole band (3.3 to 6.6 m)."""
    config = written(tmp_path, "board", 15, snr_reference="received", motion={"range_m": 4})
    assert fitted_snr(config, tmp_path / "raw", 1)[0] == pytest.approx(15, abs=1.5)
    with Recording(tmp_path / "raw/recording.h5") as recording:
        assert recording.info.waveform().half_band_range == pytest.approx(6.62, abs=0.01)


def test_a_fitted_config_makes_recordings_of_its_snr(tmp_path):
    """Of a free-space SNR the antennas' beam takes its part, which is not taken again."""
    place = {"duration_s": 4, "motion": {"range_m": 3, "angle_deg": 0}}
    found, fitted = fitted_snr(written(tmp_path, "narrow", 15, **place), tmp_path / "first", 1)
    assert found < 13.5, "the beam takes some of the power of head and legs"
    sets = ("activities=[walking]", "motion.place.range_m=3", "motion.angle_deg=0")
    options = [part for text in sets for part in ("--set", text)]
    ok("fit", tmp_path / "first/recording.h5", "-o", fitted, "--overwrite", *options)
    again, _ = fitted_snr(fitted, tmp_path / "second", 2)
    assert again == pytest.approx(found, abs=2)


@pytest.mark.every(4)
@pytest.mark.parametrize(
    "name", ["fmcw", "array_real", "sfcw", "sfcw_array", "cw_iq", "cw_array", "impulse_iq"]
)
def test_a_config_is_the_header_of_an_import(tmp_path, name):
    path, recording = recorded(tmp_path, name)
    dataset = {"c": "slow_time", "i": "profiles"}.get(name[0], "beat")
    kind = "[receiver,pulse]" if dataset == "slow_time" else "[receiver,sample,pulse]"
    sets = [f"dataset={dataset}", f"axes={kind}"] + ["holds=beat"] * (dataset == "beat")
    options = [part for text in sets for part in ("--set", text)]
    ok("import", recording, "--radar", path, *options, "-o", tmp_path / "again.h5")
    ok("fit", tmp_path / "again.h5", "-o", tmp_path / "fitted.yaml")
    fitted = load_config(tmp_path / "fitted.yaml").filled()
    assert same(fitted.radar, load_config(path).filled().radar) is None


def axes_in(file):
    """Values of every axis of a file of maps, by path."""
    values = {}

    def visit(path, item):
        if isinstance(item, h5py.Dataset) and path.startswith("axes/"):
            values[path] = item[()]

    file.visititems(visit)
    return values


@pytest.mark.every(3)
@pytest.mark.parametrize("name", ["array_iq", "array_real", "frames"])
def test_maps_of_the_fitted_config_have_the_axes_of_the_recording(tmp_path, name):
    _, recording = recorded(tmp_path, name)
    fitted = tmp_path / "fitted.yaml"
    sets = ("--set", "activities=[walking]", "--set", "maps=[stft,range_doppler]")
    ok("fit", recording, "-o", fitted, *sets)
    ok("process", recording, "--config", fitted, "-o", tmp_path / "maps", "--no-figures")
    ok("simulate", fitted, "-o", tmp_path / "scene", "--no-figures")
    with h5py.File(tmp_path / "maps/maps.h5") as one, h5py.File(tmp_path / "scene/scene.h5") as two:
        assert one["maps/stft"].shape == two["maps/stft"].shape
        measured, simulated = axes_in(one), axes_in(two)
        shared = [axis for axis in measured if axis in simulated]
        assert shared
        for axis in shared:
            assert measured[axis].size == simulated[axis].size
            steps = np.diff(measured[axis]), np.diff(simulated[axis])
            np.testing.assert_allclose(*steps, rtol=1e-4, atol=1e-9)


@pytest.mark.parametrize("form", ["receiver first", "pulse first", "real numbers"])
def test_receivers_of_a_cw_header_are_an_axis_of_an_array(tmp_path, form):
    """One frequency has no samples of a chirp; each receiver has a row, or a column."""
    path, recording = recorded(tmp_path, "cw_array")
    with h5py.File(recording) as file:
        samples = file["slow_time"][:]
    array = samples if form == "receiver first" else samples.T
    axes = "receiver,pulse" if form == "receiver first" else "pulse,receiver"
    if form == "real numbers":
        array, axes = np.stack([array.real, array.imag], axis=-1), f"{axes},iq"
    np.save(tmp_path / "module.npy", array)
    named = ("--set", f"axes=[{axes}]")
    ok("import", tmp_path / "module.npy", "--radar", path, *named, "-o", tmp_path / "again.h5")
    with h5py.File(tmp_path / "again.h5") as file:
        np.testing.assert_array_equal(file["slow_time"][:], samples)


def test_frames_may_be_missing_and_the_last_cut_off():
    starts, first = np.array([0, 0.1, 0.3, 0.4]), np.arange(4) * 8
    assert frames_in(PulseTimes(starts, first, 30, 1000.0)) == (8, pytest.approx(0.1))
    assert frames_in(PulseTimes(np.array([0, 0.1, 0.37]), first[:3], 24, 1000.0)) is None
    assert frames_in(PulseTimes.even(30, 1000.0)) is None


def test_an_unknown_radar_lists_those_that_there_are(tmp_path):
    np.save(tmp_path / "x.npy", np.ones((64, 40)))
    done = radhar("import", tmp_path / "x.npy", "--radar", "bgt60tr13", "-o", tmp_path / "y.h5")
    assert done.returncode == 2
    assert "did you mean 'bgt60tr13c'?" in done.stderr
    assert "there are iwr" in done.stderr
    (tmp_path / "maps.yaml").write_text("maps: [stft]\nimage: {size_px: 64}\n")
    done = radhar(
        "import", tmp_path / "x.npy", "--radar", tmp_path / "maps.yaml", "-o", tmp_path / "y.h5"
    )
    assert done.returncode == 2
    assert "is a config without `radar`" in done.stderr
    assert len(done.stderr.splitlines()) == 1
