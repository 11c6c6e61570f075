"""What was simulated is read off its recordings."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from command_line import radhar
from slow import slow

from radhar_cli.activity import ACTIVITIES
from radhar_cli.capture.fitting import Fit, fit, line_keys
from radhar_cli.capture.importing import write_simulated
from radhar_cli.capture.noise_spectrum import FoundLine, OnOff
from radhar_cli.capture.recording import Label, RecordingInfo, SourceNote, write_recording
from radhar_cli.capture.room_returns import Returns, peaks
from radhar_cli.config import load_config
from radhar_cli.errors import CaptureError
from radhar_cli.processing.pulse_times import PulseTimes
from radhar_cli.radar.waveform import Waveform
from radhar_cli.receiver.interference import Line
from radhar_cli.simulation.simulate import Simulation, simulate

CONFIG = """
duration_s: 4
radar: {carrier_hz: 10e9, bandwidth_hz: 2e9, prf_hz: 600, adc_rate_hz: 5e6}
motion: {range_m: {uniform: [2, 3]}, angle_deg: 0}
engine: {kind: cube}
"""
# Far enough from somebody at 2.5 m to be told from him.
STRONG = {"position_m": [4.9, 0, 1.5], "rcs_dbsm": 5, "residual_m": 5e-4, "highest_hz": 6}
STILL = {"position_m": [6.0, 0, 1.5], "rcs_dbsm": -3, "residual_m": 0.0}
ROOM = f"room.reflectors={[STRONG, STILL]}"
HERE = "motion.range_m=2.5"


def simulated(folder: Path, activity: str, seed: int, *sets: str) -> Simulation:
    (folder / "c.yaml").write_text(CONFIG)
    config = load_config(folder / "c.yaml", sets)
    return simulate(config, activity, seed, maps=("stft",), raw=True)


def recorded(folder: Path, *sets: str, activity: str = "punching", seed: int = 1) -> Path:
    scene = simulated(folder, activity, seed, *sets)
    assert scene.beat is not None
    path = folder / f"{len([*folder.glob('*.h5')])}.h5"
    write_simulated(path, scene.beat, scene.waveform, Label(label=activity))
    return path


def reflectors(found: Fit) -> list[dict[str, Any]]:
    listed: list[dict[str, Any]] = found.document["room"]["reflectors"]
    return listed


@pytest.mark.parametrize("snr_db", [20.0, 5.0, -5.0])
def test_snr_and_range_come_back_and_nothing_is_invented(tmp_path: Path, snr_db: float) -> None:
    found = fit([recorded(tmp_path, f"snr_db={snr_db}", activity="walking")])
    assert found.document["snr_db"] == pytest.approx(snr_db, abs=1.0)
    assert abs(found.slope_db) < 1, "white noise has no colour"
    low, high = found.document["motion"]["range_m"]["uniform"]
    assert 2 < low < 4
    assert low + 2 < high < 9
    assert found.document.keys() == {"duration_s", "radar", "snr_db", "motion"}
    assert found.numbers()["zero_line_db"] == pytest.approx(0, abs=1), "nobody is there"


def test_what_stands_in_the_room_comes_back(tmp_path: Path) -> None:
    found = fit([recorded(tmp_path, "snr_db=20", ROOM, seed=n) for n in (1, 2)])
    strong, still = reflectors(found)
    for one, true in ((strong, STRONG), (still, STILL)):
        assert one["position_m"][0] == pytest.approx(true["position_m"][0], abs=0.03)
        # The person's cross section is taken for the model's, his range for that of what moves.
        assert one["rcs_dbsm"] == pytest.approx(true["rcs_dbsm"], abs=3)
    assert strong["rcs_dbsm"] - still["rcs_dbsm"] == pytest.approx(8, abs=1)
    assert strong["residual_m"] == pytest.approx(5e-4, rel=0.2)
    assert strong["highest_hz"] == pytest.approx(6, rel=0.25)
    assert still["residual_m"] == 0
    assert "highest_hz" not in still
    assert "receiver" not in found.document, "reflectors that move are no coloured noise"


def test_leakage_comes_back(tmp_path: Path) -> None:
    isolation = [
        fit([recorded(tmp_path, f"radar.antenna_isolation_db={db}")]).document["radar"]
        for db in (10, 40)
    ]
    first, second = (one["antenna_isolation_db"] for one in isolation)
    assert first == pytest.approx(10, abs=3)
    assert second - first == pytest.approx(30, abs=0.5)


@pytest.mark.parametrize(("corner", "slope"), [(20, 10), (8, 16)])
def test_colour_and_lines_come_back_beside_reflectors(
    tmp_path: Path, corner: float, slope: float
) -> None:
    lines = [{"doppler_hz": 120.3, "level_db": -10}, {"doppler_hz": -233, "level_db": -20}]
    colour = f"receiver={{noise_corner_hz: {corner}, noise_slope_db: {slope}, lines: {lines}}}"
    found = fit([recorded(tmp_path, "snr_db=10", ROOM, colour, seed=n) for n in (1, 2)])
    receiver = found.document["receiver"]
    assert receiver["noise_corner_hz"] == pytest.approx(corner, rel=0.25)
    assert receiver["noise_slope_db"] == pytest.approx(slope, abs=2)
    assert len(receiver["lines"]) == 2
    for one, true in zip(receiver["lines"], lines, strict=True):
        assert one.keys() == {"doppler_hz", "level_db"}, "always there"
        assert one["doppler_hz"] == pytest.approx(true["doppler_hz"], abs=0.1)
        assert one["level_db"] == pytest.approx(true["level_db"], abs=1.5)
    assert found.document["snr_db"] == pytest.approx(10, abs=1.5)


def test_a_line_that_comes_and_goes_is_told_from_one_that_is_always_there() -> None:
    rng, prf, bins, pulses = np.random.default_rng(1), 100.0, 40, 60_000
    waveform = Waveform(1e9, 1e9, 1e-6, 8e7, prf, pulses / prf)
    for on, off, level in ((1.0, 2.0, 0.5), (1.0, 0.0, 0.5), (1.0, 0.0, 0.01)):
        line = Line(np.sqrt(level), 17.0, waveform, lambda name: rng, "line", on, off)
        noise = rng.standard_normal((bins, pulses, 2)).view(complex)[..., 0] / np.sqrt(2)
        x = noise + line.code[:bins, None] * line.tone(np.arange(pulses))
        given = FoundLine(17.0, level * on / (on + off))
        times = OnOff(given, prf)
        for first in range(0, pulses, 400):
            some = slice(first, first + 400)
            times.add(x[:, some], np.ones((bins, 400), bool), 1.0)
        found = times.line_with_times()
        if off == 0:
            assert found == given
        else:
            assert found.level == pytest.approx(level, rel=0.2)
            assert found.on == pytest.approx(on, rel=0.3)  # blocks of 0.1 s
            assert found.off == pytest.approx(off, rel=0.3)


def test_a_flat_top_is_a_return() -> None:
    power = np.full(60, 1e-9)
    power[20:23] = 1.0
    radar = Waveform(77e9, 4e9, 40e-6, 10e6, 5000.0, 4.0)
    found = peaks(Returns(power, np.zeros(60), np.full(60, np.nan)), 1e-9, radar)
    assert all(20 <= one.range / radar.range_step <= 22 for one in found)
    assert found


def test_lines_on_both_sides_are_one_key() -> None:
    keys = line_keys([FoundLine(100.1, 0.1), FoundLine(-99.99, 0.12), FoundLine(-233.0, 0.1)])
    assert [(one["doppler_hz"], one.get("both_sides")) for one in keys] == [
        (100.1, True),
        (-233.0, None),
    ]
    different = line_keys([FoundLine(100.0, 0.1), FoundLine(-100.0, 0.01)])
    assert not any("both_sides" in one for one in different)


def test_an_empty_room_adds_what_stands_in_it(tmp_path: Path) -> None:
    person = recorded(tmp_path, "snr_db=20")
    scene = simulated(tmp_path, "punching", 3, "snr_db=20", ROOM)
    alone = simulated(tmp_path, "punching", 3, "snr_db=null")
    assert scene.beat is not None
    assert alone.beat is not None
    still = alone.beat.mean(axis=1, keepdims=True)  # the same person, taken out; the leakage stays
    empty = tmp_path / "empty.h5"
    write_simulated(empty, scene.beat - alone.beat + still, scene.waveform, Label(label="empty"))
    with pytest.raises(CaptureError, match="nobody is seen to move"):
        fit([empty])
    assert "room" not in fit([person]).document
    ranges = [one["position_m"][0] for one in reflectors(fit([person, empty]))]
    assert any(abs(x - 4.9) < 0.03 for x in ranges)


def test_frames_with_gaps_between(tmp_path: Path) -> None:
    scene = simulated(tmp_path, "punching", 1, "snr_db=20", "duration_s=8", ROOM)
    assert scene.beat is not None
    kept = np.arange(4800).reshape(-1, 80)[:, :64]  # frames of 64 of 80 pulses
    values = np.ascontiguousarray(scene.beat[:, kept.ravel()]).view(float)
    values = values.reshape(1, len(scene.beat), kept.size, 2)
    info = RecordingInfo(
        carrier_hz=10e9,
        prf_hz=600,
        bandwidth_hz=2e9,
        adc_rate_hz=5e6,
        samples=len(scene.beat),
        receivers=1,
        pulses=kept.size,
        receiver_delay_s=[0.0],
        source=SourceNote(format="test"),
    )
    segments = PulseTimes(kept[:, 0] / 600, np.arange(len(kept)) * 64, kept.size, 600.0)
    path = tmp_path / "frames.h5"
    write_recording(path, info, values.dtype, 2, [(0, values)], segments)
    found = fit([path])
    snr = found.document["snr_db"]
    assert (snr if isinstance(snr, float) else snr["normal"][0]) == pytest.approx(20, abs=1.5)
    assert [one["position_m"][0] for one in reflectors(found)] == pytest.approx([4.9, 6], abs=0.03)
    assert "receiver" not in found.document, "frames are too short to tell"


def test_the_config_simulates_with_the_same_zero_line(tmp_path: Path) -> None:
    colour = "receiver.noise_corner_hz=10"
    paths = [
        recorded(tmp_path, f"snr_db={snr}", HERE, ROOM, colour, seed=n)
        for n, snr in enumerate((5.0, 10.0, 15.0))
    ]
    done = radhar("fit", *paths, "-o", tmp_path / "fit.yaml")
    assert done.returncode == 0, done.stderr
    document = yaml.safe_load((tmp_path / "fit.yaml").read_text())
    middle, spread = document["snr_db"]["normal"]
    assert middle == pytest.approx(10, abs=1)
    assert spread == pytest.approx(np.std([5, 10, 15]), abs=1)
    config = load_config(tmp_path / "fit.yaml", ["engine.kind=cube", "motion.angle_deg=0"])
    assert config.radar.carrier_hz == 10e9
    assert config.radar.chirp_s == pytest.approx(40e-6)
    assert (tmp_path / "fit.png").stat().st_size > 10_000
    again = []
    for n, snr in enumerate((5.0, 10.0, 15.0)):
        scene = simulate(
            config.model_copy(update={"snr_db": snr}), "punching", n, maps=("stft",), raw=True
        )
        assert scene.beat is not None
        path = tmp_path / f"again{n}.h5"
        write_simulated(path, scene.beat, scene.waveform, Label(label="punching"))
        again.append(path)
    one, other = (fit(some).numbers()["zero_line_db"] for some in (paths, again))
    assert one > 5, "reflectors and coloured noise"
    assert other == pytest.approx(one, abs=2)


def test_a_recording_counts_once(tmp_path: Path) -> None:
    path, other = recorded(tmp_path), recorded(tmp_path, seed=2)
    (tmp_path / "link.h5").hardlink_to(path)
    (tmp_path / "copy.h5").write_bytes(path.read_bytes())
    for again in (path.name, "link.h5", "copy.h5"):
        with pytest.raises(CaptureError, match=f"{again}: has the samples of {path};"):
            fit([path, other, tmp_path / again])


def test_a_recording_too_short_for_anybody_to_move_is_refused_as_such(tmp_path: Path) -> None:
    with pytest.raises(CaptureError, match=r"lasts 0\.2 s; it should last at least 0\.5 s"):
        fit([recorded(tmp_path, "duration_s=0.2")])


def test_without_noise_no_lines_or_colour_are_read_into_its_rounding(tmp_path: Path) -> None:
    found = fit([recorded(tmp_path, "snr_db=null", "radar.carrier_hz=24e9", activity="walking")])
    assert "receiver" not in found.document


def test_recordings_of_two_radars_are_refused(tmp_path: Path) -> None:
    paths = [recorded(tmp_path), recorded(tmp_path, "radar.prf_hz=500")]
    with pytest.raises(CaptureError, match="another radar"):
        fit(paths)


@pytest.mark.parametrize(
    ("activity", "snr_db"),
    slow((a.slug, snr) for a in ACTIVITIES if a.slug != "stationary" for snr in (25.0, 10.0, 0.0)),
)
def test_of_every_activity_nothing_is_invented(
    tmp_path: Path, activity: str, snr_db: float
) -> None:
    document = fit([recorded(tmp_path, f"snr_db={snr_db}", activity=activity, seed=50)]).document
    assert document.keys() == {"duration_s", "radar", "snr_db", "motion"}
    assert document["snr_db"] == pytest.approx(snr_db, abs=4)  # legs are farther from the torso
    assert document["radar"]["antenna_isolation_db"] == pytest.approx(10, abs=5)
