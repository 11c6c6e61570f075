"""A format of captures is added by one table row; contents of recordings are types."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from radhar_cli.capture.content import (
    Beat,
    Content,
    RangeProfiles,
    SlowTime,
    describe_difference,
    radar_section,
)
from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.capture.recording import Recording
from radhar_cli.config import load_config, resolved
from radhar_cli.errors import CaptureError
from radhar_cli.readers.captures import formats
from radhar_cli.readers.captures.source import CaptureFiles, CaptureFormat, Parts, Source


def open_text(capture: CaptureFiles) -> Source:
    """Open slow time in a text file: a line a pulse, real and imaginary part."""
    values = np.loadtxt(capture.paths[0], delimiter=",")

    def read(first: int, stop: int) -> Parts:
        return values[None, None, first:stop]

    return Source((capture.paths[0],), 1, None, len(values), values.dtype, 2, read)


TEXT = CaptureFormat(".own", lambda path, head: path.suffix == ".own", open_text)


def test_a_format_is_added_by_one_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    samples = np.exp(2j * np.pi * 0.1 * np.arange(50))
    np.savetxt(tmp_path / "x.own", samples.view(float).reshape(-1, 2), delimiter=",")
    settings = read_settings(None, ["carrier_hz=24e9", "prf_hz=1000"])
    with pytest.raises(CaptureError, match=r"x\.own: unknown format; should be \.bin.*HDF5"):
        import_capture([tmp_path / "x.own"], tmp_path / "x.h5", settings)
    monkeypatch.setattr(formats, "FORMATS", [*formats.FORMATS, TEXT])
    import_capture([tmp_path / "x.own"], tmp_path / "x.h5", settings)
    with Recording(tmp_path / "x.h5") as recording:
        assert recording.info.content == SlowTime(24e9, 1000.0)
        assert np.allclose(recording.beat(0, 50)[0, 0], samples)
    with pytest.raises(CaptureError, match=r"x\.own: only captures of \.bin .* are split"):
        import_capture([tmp_path / "x.own"] * 2, tmp_path / "y.h5", settings)


BEAT = Beat(24e9, 1e9, 2.5e6, 100, 1000.0)
PROFILES = RangeProfiles(2.5e9, 1e9, 600, 200.0, 0.1, 0.01)
SLOW = SlowTime(24e9, 1000.0)


RADARS = {
    "fmcw": "{}",
    "cw": "{waveform: cw, carrier_hz: 5e9}",
    "impulse": "{waveform: impulse, carrier_hz: 1e9, profile_m: [0.1, 6]}",
    "sfcw": "{waveform: sfcw, steps: 50, dwell_s: 1e-6, prf_hz: 500}",
}


@pytest.mark.parametrize("content", [BEAT, PROFILES, SLOW], ids=lambda c: c.dataset)
@pytest.mark.parametrize("waveform", RADARS)
def test_a_config_takes_the_radar_of_any_recording(
    tmp_path: Path, waveform: str, content: Content
) -> None:
    path, maps = tmp_path / "c.yaml", "stft" if waveform == "cw" else "rtm"
    path.write_text(f"radar: {RADARS[waveform]}\nmaps: [{maps}]\n")
    section = radar_section(resolved(load_config(path))["radar"], content)
    assert section["prf_hz"] == content.prf_hz
    assert (
        section["waveform"]
        in {
            SlowTime: {"cw"},
            RangeProfiles: {"impulse"},
            Beat: {"sfcw" if waveform == "sfcw" else "fmcw"},
        }[type(content)]
    )
    assert ("bandwidth_hz" in section) == (not isinstance(content, SlowTime))
    assert ("profile_m" in section) == isinstance(content, RangeProfiles)


def test_differences_of_recordings_are_said() -> None:
    other = Beat(24e9, 1e9, 2.5e6, 100, 500.0)
    assert describe_difference(BEAT, BEAT) is None
    assert describe_difference(other, BEAT) == "prf_hz = 500: should be 1000"
    whole = replace(BEAT, is_whole=True)
    assert describe_difference(whole, BEAT) == "whole_band = 1: should be 0"
    assert describe_difference(BEAT, whole) == "whole_band = 0: should be 1"
    text = "holds slow time: should hold samples of chirps"
    assert describe_difference(SLOW, BEAT) == text
