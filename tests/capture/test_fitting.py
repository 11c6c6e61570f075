"""Estimates from simulated recordings match what was simulated."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from helpers.command_line import radhar
from helpers.documented import KEYS
from helpers.slow import slow

from radhar_cli.capture.content import Beat
from radhar_cli.capture.fitting import fit
from radhar_cli.capture.importing import write_simulated
from radhar_cli.capture.recording import (
    Label,
    RecordingInfo,
    SampleStream,
    SourceNote,
    write_recording,
)
from radhar_cli.config import load_config
from radhar_cli.errors import CaptureError
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.scene.single.simulate import Simulation, simulate

CONFIG = """
duration_s: 4
radar: {carrier_hz: 10e9, bandwidth_hz: 2e9, prf_hz: 600, adc_rate_hz: 5e6}
motion: {range_m: {uniform: [2, 3]}, angle_deg: 0}
engine: {kind: cube}
"""
# A curtain and a wall.
ROOM = """room.reflectors=[
    {position_m: [4.9, 0, 1.5], rcs_dbsm: 5, residual_m: 5e-4, highest_hz: 6},
    {position_m: [6.0, 0, 1.5], rcs_dbsm: -3, residual_m: 0.0}]"""


def simulated(folder: Path, activity: str, seed: int, *sets: str) -> Simulation:
    (folder / "c.yaml").write_text(CONFIG)
    config = load_config(folder / "c.yaml", sets)
    return simulate(config, activity, seed, maps=("stft",), raw=True)


def recorded(folder: Path, *sets: str, activity: str = "punching", seed: int = 1) -> Path:
    scene = simulated(folder, activity, seed, *sets)
    assert scene.beat is not None
    path = folder / f"{len([*folder.glob('*.h5')])}.h5"
    write_simulated(path, scene.beat[None], scene.waveform, Label(label=activity))
    return path


@pytest.mark.parametrize("snr_db", [20.0, 5.0, -5.0])
def test_snr_range_and_floor_come_back(tmp_path: Path, snr_db: float) -> None:
    found = fit([recorded(tmp_path, f"snr_db={snr_db}", activity="walking")])
    assert found.document["snr_db"] == pytest.approx(snr_db, abs=2.0)
    assert abs(found.numbers()["noise_over_range_db"]) < 1, "white noise is the same everywhere"
    low, high = found.document["motion"]["place"]["range_m"]["uniform"]
    assert 2 < low < 4
    seen = 2 if snr_db > 0 else 1  # the walker fades as they go away
    assert low + seen < high < 9
    assert found.document.keys() == {"duration_s", "radar", "snr_db", "motion"}


def test_what_stands_in_the_room_changes_nothing(tmp_path: Path) -> None:
    found = fit([recorded(tmp_path, "snr_db=20", ROOM, seed=n) for n in (1, 2)])
    assert found.document.keys() == {"duration_s", "radar", "snr_db", "motion"}
    assert found.snr_db == pytest.approx([20, 20], abs=1.5)


def test_the_noise_floor_is_the_variance_of_a_raw_sample(tmp_path: Path) -> None:
    noisy, clean = (simulated(tmp_path, "punching", 1, f"snr_db={snr}") for snr in ("5", "null"))
    assert noisy.beat is not None
    assert clean.beat is not None
    variance = np.mean(np.abs(noisy.beat - clean.beat) ** 2)
    floor = fit([recorded(tmp_path, "snr_db=5")]).numbers()["noise_floor_db"]
    assert floor == pytest.approx(10 * np.log10(variance), abs=0.5)


def test_an_empty_room_is_refused_as_nobody_moves(tmp_path: Path) -> None:
    scene = simulated(tmp_path, "punching", 3, "snr_db=20", ROOM)
    alone = simulated(tmp_path, "punching", 3, "snr_db=null")
    assert scene.beat is not None
    assert alone.beat is not None
    still = alone.beat.mean(axis=1, keepdims=True)  # the same person, taken out; the leakage stays
    empty = tmp_path / "empty.h5"
    write_simulated(
        empty, (scene.beat - alone.beat + still)[None], scene.waveform, Label(label="empty")
    )
    with pytest.raises(CaptureError, match="nobody moves"):
        fit([empty])
    person = recorded(tmp_path, "snr_db=20")
    assert fit([person, empty]).document["snr_db"] == fit([person]).document["snr_db"]


def test_frames_with_gaps_between(tmp_path: Path) -> None:
    scene = simulated(tmp_path, "punching", 1, "snr_db=20", "duration_s=8", ROOM)
    assert scene.beat is not None
    kept = np.arange(4800).reshape(-1, 80)[:, :64]  # frames of 64 of 80 pulses
    values = np.ascontiguousarray(scene.beat[:, kept.ravel()]).view(float)
    values = values.reshape(1, len(scene.beat), kept.size, 2)
    info = RecordingInfo(
        content=Beat(10e9, 2e9, 5e6, len(scene.beat), 600),
        receivers=1,
        pulses=kept.size,
        receiver_delay_s=[0.0],
        source=SourceNote(format="test"),
    )
    segments = PulseTimes(kept[:, 0] / 600, np.arange(len(kept)) * 64, kept.size, 600.0)
    path = tmp_path / "frames.h5"
    write_recording(path, info, SampleStream(values.dtype, 2, [(0, values)]), segments)
    assert fit([path]).document["snr_db"] == pytest.approx(20, abs=1.5)


def test_the_config_that_is_written_loads_and_builds_a_data_set(tmp_path: Path) -> None:
    paths = [recorded(tmp_path, f"snr_db={snr}", seed=n) for n, snr in enumerate((5.0, 10.0, 15.0))]
    done = radhar("fit", *paths, "-o", tmp_path / "fit.yaml", "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told.keys() == KEYS["fit"]
    assert told["parts"] == told["numbers"]["parts"] == 3
    document = yaml.safe_load((tmp_path / "fit.yaml").read_text())
    middle, spread = document["snr_db"]["normal"]
    assert middle == pytest.approx(10, abs=1)
    assert spread == pytest.approx(np.std([5, 10, 15]), abs=1)
    config = load_config(tmp_path / "fit.yaml")
    assert config.radar.carrier_hz == 10e9
    assert config.radar.chirp_s == pytest.approx(40e-6)
    assert (tmp_path / "fit.png").stat().st_size > 10_000
    small = ("maps=[stft]", "activities=[punching]", "samples_per_class=2", "image.size_px=32")
    sets = [part for one in small for part in ("--set", one)]
    built = radhar("generate", tmp_path / "fit.yaml", "-o", tmp_path / "set", "--jobs", 1, *sets)
    assert built.returncode == 0, built.stderr


def test_a_recording_too_short_for_anybody_to_move_is_refused_as_such(tmp_path: Path) -> None:
    with pytest.raises(CaptureError, match=r"lasts 0\.2 s; should last at least 0\.5 s"):
        fit([recorded(tmp_path, "duration_s=0.2")])


def test_recordings_of_two_radars_are_refused(tmp_path: Path) -> None:
    paths = [recorded(tmp_path), recorded(tmp_path, "radar.prf_hz=500")]
    with pytest.raises(CaptureError, match="differs in radar"):
        fit(paths)


@pytest.mark.parametrize(
    ("activity", "snr_db"),
    slow((a.slug, snr) for a in ACTIVITIES if a.slug != "stationary" for snr in (25.0, 10.0, 0.0)),
)
def test_of_every_activity_the_snr_comes_back(tmp_path: Path, activity: str, snr_db: float) -> None:
    document = fit([recorded(tmp_path, f"snr_db={snr_db}", activity=activity, seed=50)]).document
    assert document["snr_db"] == pytest.approx(snr_db, abs=4)  # legs are farther from the torso
