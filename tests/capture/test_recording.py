"""Recordings: what is written, and what should not be read."""

import json
from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.command_line import radhar
from helpers.small import small_config

from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.capture.recording import Recording, is_recording
from radhar_cli.errors import CaptureError, FolderError, RadharError

RADAR = ["carrier_hz=77e9", "bandwidth_hz=1e9", "adc_rate_hz=1e6", "prf_hz=1000"]
SMALL_RAW = """
activities: [walking]
duration_s: 0.5
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 200}
motion: {model: paper}
"""


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """Three receivers, frames with gaps, whole numbers."""
    rng = np.random.default_rng(0)
    x = rng.integers(-999, 999, (3, 8, 40, 2)).astype("i2")
    np.save(tmp_path / "x.npy", x)
    overrides = [*RADAR, "axes=[receiver, sample, pulse, iq]", "beat=negative", "label=walking"]
    overrides += ["frame_pulses=10", "frame_s=0.1", "person=ann"]
    import_capture([tmp_path / "x.npy"], tmp_path / "x.h5", read_settings(None, overrides))
    return tmp_path / "x.h5"


def test_simulate_writes_what_it_received(tmp_path: Path) -> None:
    """The recording has the samples of the scene."""
    config = small_config(tmp_path, SMALL_RAW)
    command = ("simulate", config, "--no-figures", "--maps", "stft", "--raw", "-o", tmp_path / "s")
    assert radhar(*command).returncode == 0
    path = tmp_path / "s/recording.h5"
    assert is_recording(path)
    with Recording(path) as one:
        beat = one.beat(0, one.info.pulses)
        assert beat.shape == (1, 400, 100)
        assert one.info.labels[0].label == "walking"


class TestHostileRecording:
    """A recording from anyone: one line, no traceback."""

    @pytest.mark.parametrize(
        ("key", "value", "expected"),
        [
            ("receivers", 4, "should"),
            ("pulses", 10**12, "pulses"),
            ("segments", 3, "segment_start"),
            ("samples", None, "together"),
            ("prf_hz", -1, "prf_hz"),
            ("labels", "x", "labels"),
            ("extra", 1, "extra"),
            ("samples", 2**24, "should take at most"),
        ],
    )
    def test_wrong_attribute(self, recording: Path, key: str, value: object, expected: str) -> None:
        with h5py.File(recording, "r+") as file:
            document = json.loads(file.attrs["recording"])
            file.attrs["recording"] = json.dumps({**document, key: value})
        with pytest.raises(FolderError) as caught:
            Recording(recording)
        assert expected in str(caught.value)
        assert "\n" not in str(caught.value)

    def test_segments_out_of_order(self, recording: Path) -> None:
        with h5py.File(recording, "r+") as file:
            file["segment_first"][:] = [0, 20, 10, 30]
        with pytest.raises(FolderError, match="should be in order"):
            Recording(recording)

    def test_damage_anywhere_is_refused_in_one_line(self, recording: Path, tmp_path: Path) -> None:
        data, rng = recording.read_bytes(), np.random.default_rng(0)
        refused = []
        for _ in range(150):
            spoilt = bytearray(data)
            at = int(rng.integers(len(data) - 8))
            spoilt[at : at + 4] = rng.bytes(4)
            (tmp_path / "spoilt.h5").write_bytes(spoilt[: int(rng.integers(1, 2 * len(data)))])
            try:
                with Recording(tmp_path / "spoilt.h5") as one:
                    one.beat(0, one.info.pulses)
            except RadharError as error:
                refused.append(str(error))
        assert refused
        assert not [message for message in refused if "\n" in message]


def test_a_file_that_is_no_recording_is_refused(tmp_path: Path) -> None:
    (tmp_path / "x.h5").write_bytes(b"nothing")
    assert not is_recording(tmp_path / "x.h5")
    with pytest.raises(CaptureError, match="unknown format"):
        import_capture([tmp_path / "x.h5"], tmp_path / "y.h5", read_settings(None, RADAR))


def test_inspect_shows_what_a_recording_holds(recording: Path) -> None:
    done = radhar("inspect", recording)
    assert done.returncode == 0, done.stderr
    for text in (
        "duration_s: 0.31",
        "segments: 4",
        "highest_speed_mps",
        "label: walking, person: ann",
    ):
        assert text in " ".join(done.stdout.split())
    summary = json.loads(radhar("inspect", recording, "--json").stdout)
    assert summary["receivers"] == 3
    assert summary["lost_pulses"] == 0


def test_one_receiver_is_singular(tmp_path: Path) -> None:
    np.save(tmp_path / "capture.npy", np.ones((16, 32), "c8"))
    out = tmp_path / "walk.h5"
    chirps = ("carrier_hz=1e10", "prf_hz=500", "bandwidth_hz=1e9", "adc_rate_hz=1e6")
    sets = [
        part for one in (*chirps, "beat=negative", "axes=[sample,pulse]") for part in ("--set", one)
    ]
    done = radhar("import", tmp_path / "capture.npy", *sets, "-o", out)
    assert "32 pulses at 500 Hz: 1 receiver, 16 samples a chirp" in done.stdout, done.stderr
