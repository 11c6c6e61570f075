"""Captures of TI's card: every layout is read back as the echo that was written."""

import json
import re
from contextlib import suppress
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from capture.dca1000_file import Radar, body, echo, words, write_studio
from helpers.command_line import radhar
from helpers.slow import examples
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.capture.recording import Recording
from radhar_cli.config import load_config
from radhar_cli.errors import CaptureError, RadharError

RADAR, FRAMES = Radar(), 6
CONFIG = """
activities: [walking]
duration_s: 1
radar: {carrier_hz: 60e9, bandwidth_hz: 1.5e9, prf_hz: 2000, adc_rate_hz: 2.5e6, chirp_s: 25.6e-6}
motion: {model: paper, range_m: 2.5, angle_deg: 180}
"""


@pytest.fixture(scope="module")
def beat(tmp_path_factory: pytest.TempPathFactory) -> np.ndarray:
    path = tmp_path_factory.mktemp("config") / "c.yaml"
    path.write_text(CONFIG)
    return echo(RADAR, body(load_config(path)), FRAMES)


def imported(folder: Path, *overrides: str, header: str = "radar.mmwave.json") -> Recording:
    read = read_settings(folder / header, overrides)
    import_capture([folder / "adc_data_Raw_0.bin"], folder / "out.h5", read, header)
    return Recording(folder / "out.h5")


@pytest.mark.parametrize("real", [False, True], ids=["complex", "real"])
@pytest.mark.parametrize(("lanes", "order"), [(2, 1), (2, 0), (4, 0), (4, 1)])
def test_every_layout_is_read_back(
    tmp_path: Path, beat: np.ndarray, lanes: int, order: int, real: bool
) -> None:
    """Half a step of the converter is the only difference."""
    words(beat, 2, lanes, not order, real).tofile(tmp_path / "adc_data_Raw_0.bin")
    write_studio(
        tmp_path / "radar.mmwave.json",
        RADAR,
        laneEn="0x3" if lanes == 2 else "0xF",
        chInterleave=order,
        b2AdcOutFmt=0 if real else 1,
    )
    with imported(tmp_path) as recording:
        assert recording.info.receivers == 4
        assert recording.info.prf_hz == pytest.approx(1 / (2 * 250e-6))
        assert recording.samples.parts == 2 - real
        found = recording.beat(0, recording.info.pulses) / 8000
    wanted = beat.real if real else beat
    assert np.abs(found - wanted).max() < 1 / 8000


def test_sdk_demo_header_describes_the_same_capture(tmp_path: Path, beat: np.ndarray) -> None:
    (tmp_path / "demo.cfg").write_text(RADAR.demo())
    write_studio(tmp_path / "radar.mmwave.json", RADAR)
    studio = read_settings(tmp_path / "radar.mmwave.json", [])
    demo = read_settings(tmp_path / "demo.cfg", [])
    assert demo.model_copy(update={"radar": studio.radar}) == studio
    w = RADAR.waveform
    assert (studio.carrier_hz, studio.bandwidth_hz) == pytest.approx((w.fc, w.bandwidth))


@pytest.mark.parametrize("swapped", [False, True])
def test_sign_of_the_beat_is_detected_and_can_be_overridden(
    tmp_path: Path, beat: np.ndarray, swapped: bool
) -> None:
    """Q before I is a conjugate turned by 90 degrees; the sign is found either way."""
    stream = words(beat, 2).reshape(-1, 2, 2)
    stream = stream[:, ::-1] if swapped else stream
    np.ascontiguousarray(stream).tofile(tmp_path / "adc_data_Raw_0.bin")
    write_studio(tmp_path / "radar.mmwave.json", RADAR)
    with imported(tmp_path) as recording:
        found = recording.beat(0, 10) / 8000
        told = " ".join(recording.info.source.findings)
    phase = -1j if swapped else 1
    assert np.abs(found * phase - beat[..., :10]).max() < 2 / 8000
    assert ("beat negative" if swapped else "beat positive") in told
    share = int(re.search(r"(\d+) % of what moves", told)[1])
    assert share < 10 if swapped else share > 90
    with imported(tmp_path, "beat=negative") as recording:
        kept = recording.beat(0, 10) / 8000
    assert np.abs(kept - (kept if swapped else np.conj(beat[..., :10]))).max() < 2 / 8000


def test_offset_binary_is_detected_and_can_be_overridden(tmp_path: Path, beat: np.ndarray) -> None:
    stream = (words(beat, 2).astype(int) + 2**15).astype("<u2")
    stream.tofile(tmp_path / "adc_data_Raw_0.bin")
    write_studio(tmp_path / "radar.mmwave.json", RADAR)
    with imported(tmp_path) as recording:
        assert "offset binary" in recording.info.source.findings[0]
        found = recording.beat(0, 20) / 8000
    assert np.abs(found - beat[..., :20]).max() < 1 / 8000
    with imported(tmp_path, "coding=signed", "beat=positive") as recording:
        assert np.abs(recording.beat(0, 20)).max() > 30000


def test_capture_split_at_any_byte(tmp_path: Path, beat: np.ndarray) -> None:
    data = words(beat, 2).tobytes()
    cuts = [0, 10_007, 200_000, len(data) - 100]
    for n, (low, high) in enumerate(pairwise(cuts)):
        (tmp_path / f"adc_data_Raw_{n}.bin").write_bytes(data[low:high])
    write_studio(tmp_path / "radar.mmwave.json", RADAR)
    with imported(tmp_path) as recording:
        assert recording.info.pulses == FRAMES * RADAR.loops - 1
        found = recording.beat(0, recording.info.pulses) / 8000
        told = recording.info.source.findings
    assert np.abs(found - beat[..., :-1]).max() < 1 / 8000
    assert told[0] == "3 files: adc_data_Raw_0.bin to adc_data_Raw_2.bin"
    assert "incomplete pulse" in told[1]
    (tmp_path / "adc_data_Raw_1.bin").unlink()
    with pytest.raises(CaptureError, match=r"adc_data_Raw_1\.bin: is missing"):
        imported(tmp_path)


def test_frames_with_gaps_are_segments(tmp_path: Path, beat: np.ndarray) -> None:
    words(beat, 2).tofile(tmp_path / "adc_data_Raw_0.bin")
    write_studio(tmp_path / "radar.mmwave.json", RADAR)
    with imported(tmp_path) as recording:
        assert len(recording.segments) == FRAMES
        pulses = np.arange(recording.info.pulses)
        assert recording.segments.times(pulses) == pytest.approx(RADAR.times(FRAMES))
        assert recording.info.receiver_delay_s == pytest.approx([0, 0, 250e-6, 250e-6])
        assert any("not uniform" in line for line in recording.info.source.findings)
    write_studio(tmp_path / "radar.mmwave.json", RADAR, framePeriodicity_msec=32.0)
    with imported(tmp_path) as recording:
        assert len(recording.segments) == 1
        assert any("uniform" in line for line in recording.info.source.findings)


def test_losses_and_saturation_are_flagged(tmp_path: Path, beat: np.ndarray) -> None:
    stream = words(beat, 2, scale=60_000 / 2)
    unit = 2 * 2 * 64 * 2
    stream[100 * unit + 30 : 102 * unit + 40] = 0
    stream[7 * unit : 7 * unit + 8] = 32767
    stream.tofile(tmp_path / "adc_data_Raw_0.bin")
    write_studio(tmp_path / "radar.mmwave.json", RADAR)
    with imported(tmp_path) as recording:
        assert np.flatnonzero(recording.flags & 1).tolist() == [100, 101, 102]
        assert np.flatnonzero(recording.flags & 2).tolist() == [7]
        told = " ".join(recording.info.source.findings)
    assert "3 of 384 pulses" in told
    assert "8 samples in 1 of 384 pulses are at full scale" in told


WRONG = [
    ({"numAdcSamples": 60}, ["samples = 60", "samples: 64 would fit"]),
    ({"numAdcSamples": 128}, ["numAdcSamples = 128: should be at most 70: at 2.5e+06 Hz"]),
    ({"framePeriodicity_msec": 20}, ["framePeriodicity = 20", "at least 32 ms"]),
    ({"chirpEndIdx": 3}, ["chirpEndIdx = 0 3: should be chirps that are all defined"]),
    ({"freqSlopeConst_MHz_usec": -5}, ["freqSlopeConst_MHz_usec = -5", "equal to 0.001"]),
    ({"chirpEndIdx": 2**70}, ["chirpEndIdx = 1180591620717411303424", "less than"]),
    ({"digOutSampleRate": "fast"}, ['digOutSampleRate = "fast"', "valid number"]),
    ({"b2AdcOutFmt": 3}, ["b2AdcOutFmt = 3", "less than or equal to 2"]),
    ({"laneEn": "0x7"}, ["laneEn = 0x7", "2 or 4 lanes"]),
]


@pytest.mark.parametrize(("changed", "expected"), WRONG, ids=[next(iter(c)) for c, _ in WRONG])
def test_wrong_header_is_refused_with_what_would_fit(
    tmp_path: Path, beat: np.ndarray, changed: dict[str, object], expected: list[str]
) -> None:
    words(beat, 2).tofile(tmp_path / "adc_data_Raw_0.bin")
    header = write_studio(tmp_path / "radar.mmwave.json", RADAR, **changed)
    capture = tmp_path / "adc_data_Raw_0.bin"
    done = radhar("import", capture, "--radar", header, "-o", tmp_path / "out.h5")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1, done.stderr
    assert str(header) in done.stderr
    for text in expected:
        assert text in done.stderr
    assert not (tmp_path / "out.h5").exists()


def test_import_reports_what_it_found(tmp_path: Path, beat: np.ndarray) -> None:
    words(beat, 2).tofile(tmp_path / "adc_data_Raw_0.bin")
    header = write_studio(tmp_path / "radar.mmwave.json", RADAR)
    command = ("import", tmp_path / "adc_data_Raw_0.bin", "--radar", header, "--label", "walking")
    done = radhar(*command, "--person", 3, "-o", tmp_path / "walk.h5")
    assert done.returncode == 0, done.stderr
    for text in ("two's complement", "beat positive", "not uniform", "384 pulses at 2000 Hz"):
        assert text in done.stdout
    with Recording(tmp_path / "walk.h5") as recording:
        assert recording.info.labels[0].model_dump(exclude_none=True) == {
            "label": "walking",
            "person": "3",
        }
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        "adc_data_Raw_0.bin",
        "radar.mmwave.json",
        "walk.h5",
    ]


@settings(
    max_examples=examples(150),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_damaged_headers_are_refused_in_one_line_or_imported(
    tmp_path: Path, data: st.DataObject
) -> None:
    """One value of a header after the other is replaced by nonsense; the capture is short."""
    (tmp_path / "adc_data_Raw_0.bin").write_bytes(bytes(range(256)) * 64)
    nonsense = st.sampled_from([None, -1, 0, 1, 3, 1e308, 2**70, "0x", "0xFFFFFFFFFF", [], {}, "x"])
    if data.draw(st.booleans()):
        path = tmp_path / "radar.cfg"
        words = RADAR.demo().split(" ")
        words[data.draw(st.integers(0, len(words) - 1))] = str(data.draw(nonsense))
        path.write_text(" ".join(words))
    else:
        path = tmp_path / "radar.json"
        document = json.loads(json.dumps(RADAR.studio()))
        place = document
        while True:
            keys = [*place] if isinstance(place, dict) else [*range(len(place))]
            if not keys:
                break
            key = data.draw(st.sampled_from(keys))
            if not isinstance(place[key], dict | list) or data.draw(st.integers(0, 9)) == 0:
                place[key] = data.draw(nonsense)
                break
            place = place[key]
        path.write_text(json.dumps(document))
    with suppress(RadharError):
        read = read_settings(path, [])
        import_capture([tmp_path / "adc_data_Raw_0.bin"], tmp_path / "o.h5", read, str(path))


@pytest.mark.parametrize("factor", [2, 4])
def test_chirps_that_are_joined_are_told(tmp_path: Path, factor: int) -> None:
    """By a header of so many times the samples; of the right one nothing is said."""
    n, pulses = np.arange(64)[:, None], np.arange(256)
    still = np.exp(-2j * np.pi * (1.3 * n / 64 + 0 * pulses))
    moving = 0.1 * np.exp(-2j * np.pi * (6.4 * n / 64 - 0.05 * pulses))
    x = np.stack([(still + moving) * gain for gain in (0.5, 0.5j, -0.4, 0.3)])
    words(x, 2).tofile(tmp_path / "adc_data_Raw_0.bin")
    for samples in (64, 64 * factor):
        changed = {"numAdcSamples": samples, "freqSlopeConst_MHz_usec": 60 * 64 / samples}
        times = {"rampEndTime_usec": 180.0, "framePeriodicity_msec": 80.0}
        write_studio(tmp_path / "radar.mmwave.json", RADAR, **changed, **times)
        with imported(tmp_path) as recording:
            told = " ".join(recording.info.source.findings)
        assert ("samples = 64 may be right" in told) is (samples != 64)
