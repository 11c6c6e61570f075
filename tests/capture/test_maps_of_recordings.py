"""Maps of a simulation are those of its own recording, whatever stands still and what takes it out.

What a canceller leaves of leakage, walls and faces is in the maps of data sets as it is in those of
recordings: networks that have never seen it would meet it first in measured data.
"""

from pathlib import Path

import numpy as np
import pytest

from radhar_cli.capture.chain import maps_of
from radhar_cli.capture.recording import Recording
from radhar_cli.commands.scene_folder import SceneOutputs, write_scene_folder
from radhar_cli.config import load_config
from radhar_cli.config.data_set import Config
from radhar_cli.scene.single.simulate import Simulation, simulate

SCENE = """
activities: [walking]
duration_s: 1
motion: {range_m: 2, angle_deg: 0}
image: {size_px: 32}
maps: [MAPS]
"""
IMPULSE = "waveform: impulse, bandwidth_hz: 1e9, prf_hz: 200, profile_m: [0.1, 6]"
FRAME = (
    "frame: {chirps: 64, interval_s: 250e-6, period_s: 0.05}, array: {tx: [[0, 0]], rx: [[0, 0]]}"
)
RADARS = {
    "fmcw": "{carrier_hz: 24e9, prf_hz: 1000, adc_rate_hz: 2.5e6, chirp_s: 40e-6}",
    "sfcw": "{waveform: sfcw, carrier_hz: 1e9, bandwidth_hz: 1e9, steps: 80, dwell_s: 20e-6, "
    "prf_hz: 200}",
    "cw": "{waveform: cw, carrier_hz: 24e9, prf_hz: 1000}",
    "cw-real": "{waveform: cw, output: real, carrier_hz: 24e9, prf_hz: 1000}",
    "impulse": f"{{{IMPULSE}, carrier_hz: 2e9, profile_samples: 600}}",
    "impulse-iq": f"{{{IMPULSE}, output: iq, carrier_hz: 2e9, profile_samples: 60}}",
    "board": f"{{{FRAME}, carrier_hz: 60e9, adc_rate_hz: 2e6, chirp_s: 64e-6}}",
}
CANCELLERS = {
    "none": "none",
    "difference": "difference",
    "mean": "mean",
    "highpass": "highpass",
    "highpass from rest": "highpass, highpass: {remove_mean: false}",
}
OUTPUTS = SceneOutputs(recording=True, panels=False, overlay=False, page=False)
NO_NOISE = ["snr_db=null", "receiver.noise_figure_db=null"]
AROUND = {
    "open": "",
    "wall": "wall: {}",
    "layers": "wall: {size_m: [null, 5, 2.5], echoes: exact, layers: "
    "[{eps_r: 4, thickness_m: 0.1}]}",
    "room": "room: {faces: {floor: concrete}}",
}


def config_of(folder: Path, radar: str, canceller: str, around: str = "open") -> Config:
    """Config of a scene before a radar."""
    maps = "stft" if radar.startswith("cw") else "rtm, stft"
    fixed = "range_sum: gated, gate_m: [0.5, 5]"  # a gate about the torso goes by its track
    gate = fixed if radar in ("impulse", "board") else ""
    text = SCENE.replace("MAPS", maps) + f"radar: {RADARS[radar]}\n{AROUND[around]}\n"
    processing = CANCELLERS[canceller]
    text += f"processing: {{clutter: {processing}, {gate}}}\n"
    text += "engine: {kind: cube}\n" if around == "layers" and "impulse" not in radar else ""
    (folder / "scene.yaml").write_text(text)
    return load_config(folder / "scene.yaml")


def apart(folder: Path, config: Config, scene: Simulation) -> float:
    """Largest difference of the maps of a scene and of its recording, relative to their norm."""
    write_scene_folder(scene, folder, OUTPUTS)
    with Recording(folder / "recording.h5") as recording:
        found = maps_of(recording, config, config.maps).maps
    norms = []
    for name, right in scene.maps.items():
        off = np.linalg.norm(found[name].power - right.power) / np.linalg.norm(right.power)
        norms.append(float(off))
    return max(norms)


@pytest.mark.every(4)
@pytest.mark.parametrize("canceller", CANCELLERS)
@pytest.mark.parametrize("radar", RADARS)
def test_maps_are_those_of_the_recording(tmp_path: Path, radar: str, canceller: str) -> None:
    if radar == "board" and canceller not in ("none", "mean"):
        pytest.skip("refused, as frames have pauses")
    config = config_of(tmp_path, radar, canceller)
    assert apart(tmp_path, config, simulate(config, seed=3, raw=True)) < 1e-5


@pytest.mark.every(4)
@pytest.mark.parametrize("around", ["wall", "layers", "room"])
@pytest.mark.parametrize("radar", ["fmcw", "sfcw", "cw", "impulse", "impulse-iq", "board"])
def test_walls_and_faces_are_in_maps_where_nothing_takes_them_out(
    tmp_path: Path, radar: str, around: str
) -> None:
    if radar == "board" and around == "layers":
        pytest.skip("walls with echoes need a radar of one channel")
    config = config_of(tmp_path, radar, "none", around)
    assert apart(tmp_path, config, simulate(config, seed=3, raw=True)) < 1e-5


@pytest.mark.parametrize("radar", ["fmcw", "sfcw", "cw", "cw-real"])
def test_the_direct_engine_has_them_too(tmp_path: Path, radar: str) -> None:
    """Without a recording the engine is the fast one, of other noise: none is added here."""
    config_of(tmp_path, radar, "none")
    config = load_config(tmp_path / "scene.yaml", NO_NOISE)
    scene = simulate(config, seed=3)
    assert scene.accuracy is not None
    exact = simulate(config, seed=3, raw=True)
    for name, map_ in scene.maps.items():
        off = np.linalg.norm(map_.power - exact.maps[name].power)
        assert off < 1e-5 * np.linalg.norm(exact.maps[name].power)
    without = load_config(tmp_path / "scene.yaml", ["radar.antenna_isolation_db=200", *NO_NOISE])
    weaker = simulate(without, seed=3).maps["stft"].power.max()
    assert weaker < 1e-2 * scene.maps["stft"].power.max()  # the leakage of -10 dB
