"""What `simulate --raw` writes of any radar gives the maps of the scene, by `process`."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.command_line import radhar
from scipy.io import savemat

from radhar_cli.capture.recording import Recording

OF_SIGNALS = "stft, stft_cadence"
OF_FRAMES = "range_doppler, range_azimuth, doppler_azimuth, azimuth_time"
CHIRPS = "frame: {chirps: 64, interval_s: 250e-6, period_s: 0.05}, carrier_hz: 60e9, chirp_s: 64e-6"
BAND = "bandwidth_hz: 1e9, adc_rate_hz: 2e6"
L_SHAPE = "array: {tx: [[0, 0]], rx: [[0, 0], [1, 0], [1, 1]]}, position_m: [0, 0, 1]"
RADARS = {
    "fmcw": ("{carrier_hz: 24e9, bandwidth_hz: 1e9, prf_hz: 1000}", f"rtm, {OF_SIGNALS}, fsst"),
    "sfcw": (
        "{waveform: sfcw, carrier_hz: 2e9, bandwidth_hz: 1e9, steps: 64, dwell_s: 4e-6, "
        "prf_hz: 500}",
        f"rtm, {OF_SIGNALS}, fsst_cadence",
    ),
    "cw": (
        "{waveform: cw, carrier_hz: 24e9, prf_hz: 1000}",
        f"{OF_SIGNALS}, stft_denoised_cadence",
    ),
    "cw, real": (
        "{waveform: cw, carrier_hz: 24e9, prf_hz: 1000, output: real}",
        "stft, stft_denoised, fsst",
    ),
    "impulse, iq": (
        "{waveform: impulse, output: iq, carrier_hz: 6.54e9, bandwidth_hz: 1.5e9, prf_hz: 400, "
        "profile_m: [0.3, 9.662], profile_samples: 182}",
        f"rtm, {OF_SIGNALS}",
    ),
    "impulse, rf": (
        "{waveform: impulse, carrier_hz: 6.54e9, bandwidth_hz: 1.5e9, prf_hz: 400, "
        "profile_m: [0.3, 9.662], profile_samples: 2048}",
        "rtm",
    ),
    "fmcw with frames": (
        f"{{{CHIRPS}, {BAND}, tx_m: [0, 0, 1], rx_m: [0, 0, 1]}}",
        "range_doppler",
    ),
    "frames without a pause": (
        f"{{{CHIRPS.replace('period_s: 0.05', 'period_s: 0.016')}, {BAND}, {L_SHAPE}}}",
        f"rtm, {OF_SIGNALS}, fsst, {OF_FRAMES}",
    ),
    "frames, array": (
        f"{{{CHIRPS}, {BAND}, {L_SHAPE}}}",
        f"rtm, {OF_SIGNALS}, {OF_FRAMES}, points",
    ),
    "frames, array, real": (
        f"{{{CHIRPS}, {BAND}, {L_SHAPE}, output: real}}",
        f"{OF_FRAMES}, range_elevation, doppler_elevation, elevation_time, points",
    ),
    "steps, array": (
        "{waveform: sfcw, frame: {chirps: 32, period_s: 0.2}, carrier_hz: 2e9, bandwidth_hz: 1e9, "
        "steps: 128, dwell_s: 20e-6, array: {tx: [[0, 0], [4, 0]], rx: [[0, 0], [1, 0], [2, 0], "
        "[3, 0]]}}",
        f"rtm, {OF_SIGNALS}, {OF_FRAMES}, points",
    ),
    "cw, array": (
        "{waveform: cw, frame: {chirps: 64}, carrier_hz: 24.125e9, prf_hz: 2560, "
        "array: {rx: [[-0.5, 0], [0.5, 0]]}, position_m: [0, 0, 1]}",
        f"{OF_SIGNALS}, doppler_azimuth, azimuth_time",
    ),
    "cw, in turns": (
        "{waveform: cw, frame: {chirps: 64, period_s: 0.1}, carrier_hz: 10e9, prf_hz: 1000, "
        "array: {tx: [[0, 0], [0, 1]], rx: [[-0.5, 0], [0.5, 0]]}}",
        "doppler_azimuth, doppler_elevation, elevation_time",
    ),
    "board": (
        "{device: IWR1443BOOST, cfg: iwr1443boost, position_m: [0, 0, 1]}",
        f"rtm, {OF_SIGNALS}, {OF_FRAMES}, elevation_time, points",
    ),
}
SCENE = """
radar: {radar}
maps: [{maps}]
activities: [walking]
duration_s: 2
motion: {{range_m: 3, cross_range_m: 0.5, angle_deg: 150}}
processing: {{range_sum: coherent}}
cloud: {{chain: best}}
engine: {{kind: {engine}}}
"""


@pytest.mark.every(4)
@pytest.mark.parametrize("radar", RADARS)
def test_a_raw_recording_gives_the_maps_of_its_scene(tmp_path: Path, radar: str) -> None:
    section, maps = RADARS[radar]
    config = tmp_path / "scene.yaml"
    engine = "direct" if "impulse" in radar else "cube"  # of raw samples, with their noise
    config.write_text(SCENE.format(radar=section, maps=maps, engine=engine))
    done = radhar("simulate", config, "-o", tmp_path / "scene", "--raw", "--no-figures")
    assert done.returncode == 0, done.stderr
    recording, out = tmp_path / "scene/recording.h5", tmp_path / "maps"
    done = radhar("process", recording, "--config", config, "-o", out, "--no-figures")
    assert done.returncode == 0, done.stderr
    scene, processed = h5py.File(tmp_path / "scene/scene.h5"), h5py.File(out / "maps.h5")
    with scene, processed:
        for name in maps.split(", "):
            key = name if name in scene else f"maps/{name}"
            expected, result = scene[key][:], processed[key][:]
            assert expected.size, name
            assert expected.shape == result.shape, name
            difference = np.abs(result - expected).max()
            assert difference <= 2e-4 * np.abs(expected).max(), name
            for axis in scene.get(f"axes/{name}", ()):
                values = scene[f"axes/{name}/{axis}"][:]
                assert np.allclose(processed[f"axes/{name}/{axis}"][:], values), (name, axis)


FORMS = {"fmcw": "mat", "sfcw": "npy", "cw": "npz", "cw, real": "npy", "impulse, iq": "mat"}


def write_as(form: str, path: Path, samples: np.ndarray) -> Path:
    """Write the samples [sample, pulse] of a recording as an array of another program."""
    file = path.with_suffix(f".{form}")
    match form:
        case "npy":
            np.save(file, samples)
        case "npz":
            np.savez(file, x=samples)
        case "mat":
            savemat(file, {"x": samples})
    return file


@pytest.mark.every(3)
@pytest.mark.parametrize("radar", FORMS)
def test_samples_in_another_form_give_the_same_maps(tmp_path: Path, radar: str) -> None:
    section, names = RADARS[radar]
    config, engine = tmp_path / "scene.yaml", "direct" if "impulse" in radar else "cube"
    config.write_text(SCENE.format(radar=section, maps=names, engine=engine))
    done = radhar("simulate", config, "-o", tmp_path / "scene", "--raw", "--no-figures")
    assert done.returncode == 0, done.stderr
    with Recording(tmp_path / "scene/recording.h5") as recording:
        samples = recording.beat(0, recording.info.pulses)[0]
        samples = samples if recording.samples.parts == 2 else samples.real
        kind = recording.info.content.dataset
    file = write_as(FORMS[radar], tmp_path / "x", samples if len(samples) > 1 else samples[0])
    axes = ("--set", "axes=[sample,pulse]")
    options = {
        "beat": ("--set", "holds=beat", "--set", "beat=negative", *axes),
        "profiles": axes,
        "slow_time": ("--set", "axes=[pulse]"),  # not I and Q by turns
    }.get(kind, ())
    again = tmp_path / "again.h5"
    done = radhar("import", file, "--radar", config, "-o", again, *options)
    assert done.returncode == 0, done.stderr
    for name, recorded in (("first", tmp_path / "scene/recording.h5"), ("second", again)):
        out = tmp_path / name
        done = radhar("process", recorded, "--config", config, "-o", out, "--no-figures")
        assert done.returncode == 0, done.stderr
    first, second = h5py.File(tmp_path / "first/maps.h5"), h5py.File(tmp_path / "second/maps.h5")
    with first, second:
        for name in names.split(", "):
            expected, result = first[f"maps/{name}"][:], second[f"maps/{name}"][:]
            assert expected.max() > 0
            assert np.abs(result - expected).max() <= 1e-5 * expected.max(), name
