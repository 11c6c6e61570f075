"""Captures that hold wrapped words, lost pulses or nonsense: put right, flagged or refused."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from capture.test_array_files import AXES, cube, imported, save
from capture.test_array_files import RADAR as NUMBERS
from helpers.command_line import radhar

from radhar_cli.capture.findings import LOST
from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.capture.recording import Recording
from radhar_cli.errors import CaptureError, FolderError

RADAR = [*NUMBERS, AXES]
SET = [word for one in RADAR for word in ("--set", one)]
CONFIG = "maps: [stft]\nimage: {size_px: 32}\nprocessing: {clutter: mean}\n"


def counts() -> np.ndarray:
    """Samples of a 16-bit converter, signed, as whole complex numbers."""
    return np.round(1000 * cube("c16"))


def longer(dtype: str = "c16") -> np.ndarray:
    """400 pulses, enough for a Doppler map."""
    return np.tile(cube(dtype), (1, 1, 10))


def wrapped(x: np.ndarray) -> np.ndarray:
    """What a reader gets who takes two's complement for unsigned numbers."""
    return x.real % 2**16 + 1j * (x.imag % 2**16)


@pytest.mark.parametrize("suffix", [".npy", ".npz", ".mat", ".h5", ".mat73"])
@pytest.mark.parametrize("asked", [[], ["coding=signed"]])
def test_wrapped_words_are_unwrapped_in_every_format(
    tmp_path: Path, suffix: str, asked: list[str]
) -> None:
    x = counts()
    assert np.array_equal(imported(save(tmp_path / f"x{suffix}", wrapped(x)), *asked), x)


@pytest.mark.parametrize("dtype", ["c8", "f4", "f8", "u2", ">u2", "i4", "u4", "i8"])
@pytest.mark.parametrize("coding", ["signed", "offset"])
@pytest.mark.parametrize("asked", [False, True])
def test_every_type_of_words_is_decoded(
    tmp_path: Path, dtype: str, coding: str, asked: bool
) -> None:
    x = counts()
    parts = wrapped(x) if coding == "signed" else x + 2**15 * (1 + 1j)
    if "c" not in dtype:
        x, parts = x.real, parts.real
    path = save(tmp_path / "x.npy", parts.astype(dtype))
    assert np.array_equal(imported(path, *[f"coding={coding}"] * asked), x)


def test_what_was_decided_is_said(tmp_path: Path) -> None:
    path = save(tmp_path / "x.npy", wrapped(counts()))
    told = import_capture([path], tmp_path / "o.h5", read_settings(None, RADAR)).source.findings
    assert "65536 is subtracted from samples above 32767" in told[0]
    assert told[1].startswith("beat negative")


@pytest.mark.parametrize("x", [cube(), 1e6 * counts()], ids=["fractions", "too large"])
@pytest.mark.parametrize("coding", ["signed", "offset"])
def test_a_coding_of_what_is_no_word_is_refused(tmp_path: Path, x: np.ndarray, coding: str) -> None:
    path = save(tmp_path / "x.npy", x)
    with pytest.raises(CaptureError, match=rf"x.npy: coding = {coding}: .*should be whole numbers"):
        imported(path, f"coding={coding}")


def test_numbers_that_are_no_words_stay(tmp_path: Path) -> None:
    for number, x in enumerate((cube("f8"), 100 * cube("i4"), abs(counts()) ** 2)):
        assert np.array_equal(imported(save(tmp_path / f"{number}.npy", x)), x)


@pytest.mark.parametrize("suffix", [".npy", ".npz", ".mat", ".h5"])
def test_pulses_that_are_not_a_number_are_lost(tmp_path: Path, suffix: str) -> None:
    x = longer()
    x[0, 3, 7], x[2, :, 20:23] = np.nan, np.nan * 1j
    told = import_capture(
        [save(tmp_path / f"x{suffix}", x)], tmp_path / "o.h5", read_settings(None, RADAR)
    ).source.findings
    assert any(line.startswith("4 of 400 pulses (1 %) lack samples") for line in told)
    with Recording(tmp_path / "o.h5") as recording:
        assert np.flatnonzero(recording.flags & LOST).tolist() == [7, 20, 21, 22]
        assert np.isfinite(recording.beat(0, 400)).all()
    (tmp_path / "c.yaml").write_text(CONFIG)
    done = radhar(
        *("process", tmp_path / "o.h5", "--config", tmp_path / "c.yaml"),
        *("-o", tmp_path / "p", "--no-figures"),
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("value", [np.inf, -np.inf, 1e200, 1e16j])
@pytest.mark.parametrize("pulse", [0, 33])
def test_numbers_that_no_receiver_gives_are_refused(
    tmp_path: Path, value: complex, pulse: int
) -> None:
    x = np.tile(cube("c16"), (1, 1, 60))  # more than is probed
    x[1, 5, 60 * pulse] = value
    path = save(tmp_path / "x.npy", x)
    done = radhar("import", path, "-o", tmp_path / "out.h5", *SET, "-q")
    assert done.returncode == 2
    shown = f"{(value.imag or value.real):g}"
    where = f"receiver 1, sample 5, pulse {60 * pulse} is {shown}; should be from -1e+15"
    assert done.stderr.startswith(f"radhar: {path}: {where}")
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out.h5").exists()


def test_numbers_that_do_not_fit_what_was_probed_are_refused(tmp_path: Path) -> None:
    x = np.tile(wrapped(counts()), (1, 1, 60))
    x[0, 0, 70] = 0.5
    with pytest.raises(CaptureError, match=r"pulse 70 is 0\.5; should be .* a whole number"):
        imported(save(tmp_path / "x.npy", x))


@pytest.mark.parametrize(
    ("value", "told"),
    [(np.nan, "pulse 9 holds NaN"), (np.inf, "pulse 9 is inf"), (1e200, "pulse 9 is 1e+200")],
)
def test_a_recording_made_elsewhere_is_refused_in_one_line(
    tmp_path: Path, value: float, told: str
) -> None:
    import_capture(
        [save(tmp_path / "x.npy", longer())], tmp_path / "o.h5", read_settings(None, RADAR)
    )
    with h5py.File(tmp_path / "o.h5", "r+") as file:
        file["beat"][1, 2, 9] = value
    (tmp_path / "c.yaml").write_text(CONFIG + "recordings: {window_s: 0.2}\n")
    (tmp_path / "m.csv").write_text("file,label\no.h5,walking\n")
    config, out = tmp_path / "c.yaml", tmp_path / "out"
    for words in (
        ("process", tmp_path / "o.h5", "--config", config, "-o", out),
        ("generate", config, "--recordings", tmp_path / "m.csv", "-o", out),
    ):
        done = radhar(*words, "-q")
        assert done.returncode == 2, words
        assert "Traceback" not in done.stderr
        assert told in done.stderr


def test_nothing_but_zeros_is_refused(tmp_path: Path) -> None:
    zeros = save(tmp_path / "zeros.npy", 0 * longer())
    done = radhar("import", zeros, "-o", tmp_path / "zeros.h5", *SET, "--set", "beat=negative")
    assert done.returncode == 2
    assert done.stderr.startswith("radhar: zeros.h5: each of the 400 pulses lacks samples")
    assert not (tmp_path / "zeros.h5").exists()


def test_tiny_numbers_are_processed(tmp_path: Path) -> None:
    tiny = save(tmp_path / "tiny.npy", 1e-200 * longer())
    import_capture([tiny], tmp_path / "tiny.h5", read_settings(None, [*RADAR, "beat=negative"]))
    (tmp_path / "c.yaml").write_text(CONFIG)
    done = radhar(
        *("process", tmp_path / "tiny.h5", "--config", tmp_path / "c.yaml"),
        *("-o", tmp_path / "tiny", "-q", "--no-figures"),
    )
    assert done.returncode == 0
    assert "None" not in done.stderr


def test_one_of_several_imports_to_a_file_succeeds(tmp_path: Path) -> None:
    """What another process wrote meanwhile stays."""
    path, out = save(tmp_path / "x.npy", longer()), tmp_path / "o.h5"
    settings = read_settings(None, RADAR)
    import_capture([path], out, settings, overwrite=False)
    before = out.read_bytes()
    with pytest.raises(FolderError, match="was written by another process meanwhile"):
        import_capture([path], out, settings, overwrite=False)
    assert out.read_bytes() == before
    assert sorted(one.name for one in tmp_path.iterdir()) == ["o.h5", "x.npy"]


def test_words_of_12_bits_as_other_numbers_lie_around_zero(tmp_path: Path) -> None:
    beat = np.clip(np.round(200 * longer().real), -2048, 2047)
    path = save(tmp_path / "x.npy", beat + 2048.0)
    info = import_capture([path], tmp_path / "o.h5", read_settings(None, RADAR))
    assert any("offset binary: 2048 is subtracted" in line for line in info.source.findings)


@pytest.mark.parametrize("size", [1, 2, 3, 63])
def test_a_few_bytes_are_no_capture(tmp_path: Path, size: int) -> None:
    (tmp_path / "x.bin").write_bytes(bytes(size))
    more = ["--set", "samples=16", "--set", "receivers=1"]
    done = radhar("import", tmp_path / "x.bin", "-o", tmp_path / "o.h5", *SET, *more, "-q")
    assert done.returncode == 2
    assert done.stderr == (
        f"radhar: {tmp_path}/x.bin: holds {size} bytes; a pulse by --set takes 64\n"
    )


def test_times_that_are_no_seconds_are_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "x.npz", beat=cube(), t=1e-20 * np.arange(40))
    settings = read_settings(None, [*RADAR[:3], AXES, "times=t", "dataset=beat"])
    with pytest.raises(CaptureError, match=r"1e\+20 pulses/s; times should be in s"):
        import_capture([tmp_path / "x.npz"], tmp_path / "o.h5", settings)
