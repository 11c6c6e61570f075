"""Captures as people have them: point targets in other people's formats, and what import says."""

import bz2
import gzip
import json
import lzma
import shlex

import h5py
import numpy as np
import pytest
from helpers.command_line import ok, radhar
from helpers.foreign_targets import LUA, RATE, frame, profiles, tone
from scipy.io import savemat, wavfile

from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.capture.recording import Recording
from radhar_cli.config import load_config
from radhar_cli.errors import CaptureError, ConfigError
from radhar_cli.readers.captures.named_parts import find_pair
from radhar_cli.readers.captures.packed_files import unpack_file
from radhar_cli.readers.ti.ti_lua import read_lua

CARRIER = ["carrier_hz=24e9"]


def taken(tmp_path, names, *overrides, header=None):
    """(recording's info, samples of all pulses) of a capture."""
    paths = [tmp_path / name for name in names]
    info = import_capture(paths, tmp_path / "out.h5", read_settings(header, overrides))
    with Recording(tmp_path / "out.h5") as recording:
        return info, recording.beat(0, info.pulses)


def wav(path):
    x = tone()
    wavfile.write(path, int(RATE), np.round(20000 * np.column_stack([x.real, x.imag])).astype("i2"))


def csv_named(path):
    x = tone()
    rows = [f"{n / RATE:.6f},{v.real:.6f},{v.imag:.6f}" for n, v in enumerate(x)]
    path.write_text("\n".join(["time,I,Q", *rows]))


def text_complex(path):
    path.write_text("% from MATLAB\n" + "\n".join(f"{v.real:.6f}{v.imag:+.6f}i" for v in tone()))


def text_columns(path):
    path.write_text("\n".join(f"{v.real:.6f}\t{v.imag:.6f}" for v in tone()))


def mat_pair(path):
    savemat(path, {"I": tone().real, "Q": tone().imag, "fs": RATE})


def mat_struct(path):
    savemat(path, {"rec": {"meta": {"fs": RATE}, "data": tone()[None]}, "note": "a text"})


def npz_pair(path):
    np.savez(path, ch_I=tone().real, ch_Q=tone().imag, temperature=np.float64(20))


def h5_integers(path):
    x = np.zeros(400, [("r", "<i2"), ("i", "<i2")])
    x["r"], x["i"] = np.round(20000 * tone().real), np.round(20000 * tone().imag)
    with h5py.File(path, "w") as file:
        file["x"] = x


def h5_pair(path):
    with h5py.File(path, "w") as file:
        file["real"], file["imag"] = tone().real, tone().imag


def npy_xz(path):
    np.save(path.with_name("x.npy"), tone())
    path.write_bytes(lzma.compress(path.with_name("x.npy").read_bytes()))


def csv_decimal_commas(path):
    rows = [f"{n / RATE:.4f};{v.real:.5f};{v.imag:.5f}" for n, v in enumerate(tone())]
    path.write_text("\n".join(["Time [s];I [V];Q [V]", *rows]).replace(".", ","))


def csv_units(path):
    rows = [f"{1e3 * n / RATE:.4f},{v.real:.5f},{v.imag:.5f}" for n, v in enumerate(tone())]
    path.write_text("\n".join(["Time (ms),I (V),Q (V)", *rows]))


def csv_preamble(path):
    rows = [f"{v.real:.5f},{v.imag:.5f}" for v in tone()]
    path.write_text("\n".join(["Device: a radar", "Fs = 1000 Hz", "", "I,Q", *rows]))


def csv_gaps(path):
    rows = [f"{n / RATE:.4f},{v.real:.5f},{v.imag:.5f}" for n, v in enumerate(tone())]
    rows[40], rows[41] = "0.0400,nan,nan", "0.0410,,"
    path.write_text("\n".join(["time,I,Q", *rows]))


def npy_last_axis(path):
    np.save(path, np.stack([tone().real, tone().imag], -1))


def h5_group(path):
    with h5py.File(path, "w") as file:
        file["session/entry_0/frame"] = tone()[:, None]
        file["session/entry_0/temperature"] = np.full(400, 25)


SLOW_TIME = {
    "commas.csv": (csv_decimal_commas, []),
    "units.csv": (csv_units, []),
    "preamble.csv": (csv_preamble, ["prf_hz=1000"]),
    "gaps.csv": (csv_gaps, []),
    "last.npy": (npy_last_axis, ["prf_hz=1000", "axes=[pulse, iq]"]),
    "group.h5": (
        h5_group,
        ["prf_hz=1000", "axes=[pulse, receiver]", "dataset=session/entry_0/frame"],
    ),
    "iq.wav": (wav, []),
    "named.csv": (csv_named, []),
    "complex.txt": (text_complex, ["prf_hz=1000"]),
    "columns.dat": (text_columns, ["prf_hz=1000"]),
    "pair.mat": (mat_pair, ["prf_hz=1000"]),
    "struct.mat": (mat_struct, ["prf_hz=1000"]),
    "pair.npz": (npz_pair, ["prf_hz=1000"]),
    "integers.h5": (h5_integers, ["prf_hz=1000"]),
    "pair.h5": (h5_pair, ["prf_hz=1000"]),
    "slow.npy.xz": (npy_xz, ["prf_hz=1000"]),
}


@pytest.mark.parametrize("name", SLOW_TIME)
def test_slow_time_of_any_format_keeps_its_doppler(tmp_path, name):
    write, keys = SLOW_TIME[name]
    write(tmp_path / name)
    info, x = taken(tmp_path, [name], *CARRIER, *keys)
    assert x.shape == (1, 1, 400)
    assert info.prf_hz == pytest.approx(RATE, rel=1e-3)
    spectrum = np.abs(np.fft.fft(x[0, 0]))
    assert np.fft.fftfreq(400, 1 / RATE)[spectrum.argmax()] == pytest.approx(160, abs=2.6)
    assert spectrum.max() > 20 * np.median(spectrum)


def test_i_and_q_are_found_by_names_that_pair():
    assert find_pair(["fs", "I", "Q"]) == ("I", "Q")
    assert find_pair(["rx1_real", "rx1_imag", "t"]) == ("rx1_real", "rx1_imag")
    assert find_pair(["data.re", "data.im"]) == ("data.re", "data.im")
    assert find_pair(["mini", "minq"]) is None
    assert find_pair(["a_i", "a_q", "b_i", "b_q"]) is None


def test_several_pairs_and_structs_say_what_is_there(tmp_path):
    np.savez(tmp_path / "two.npz", a_i=np.ones(9), a_q=np.ones(9), b_i=np.ones(9), b_q=np.ones(9))
    with pytest.raises(CaptureError, match=r"imaginary=NAME I and Q; there are a_i \[9\]"):
        taken(tmp_path, ["two.npz"], *CARRIER, "prf_hz=1000")
    _, x = taken(tmp_path, ["two.npz"], *CARRIER, "prf_hz=1000", "dataset=b_i", "imaginary=b_q")
    np.testing.assert_allclose(x, 1 + 1j)
    savemat(tmp_path / "s.mat", {"rec": {"a": np.ones((4, 9)), "b": np.ones((4, 9))}})
    with pytest.raises(CaptureError, match=r"there are rec\.a \[4, 9\], rec\.b \[4, 9\]"):
        taken(tmp_path, ["s.mat"], *CARRIER, "prf_hz=1000")


PROFILE_KEYS = ["carrier_hz=7.29e9", "prf_hz=256", "axes=[pulse, sample]"]


def test_range_bins_are_tracked_where_they_are_and_not_taken_for_a_beat(tmp_path):
    np.save(tmp_path / "x4.npy", profiles())
    beat = ["bandwidth_hz=1.5e9", "adc_rate_hz=1e9"]
    for kind in (complex, float):
        np.save(tmp_path / "real.npy", profiles(kind))
        with pytest.raises(CaptureError, match=r"as of range bins.*first_range_m.*holds=beat"):
            taken(tmp_path, ["real.npy"], *PROFILE_KEYS, *beat)
    places = ["first_range_m=0.3", "range_step_m=0.05144", "bandwidth_hz=1.5e9"]
    info, x = taken(tmp_path, ["x4.npy"], *PROFILE_KEYS, *places)
    assert info.content.is_iq
    np.testing.assert_allclose(x[0], profiles().T, rtol=1e-6)  # as they are, not conjugated
    (tmp_path / "c.yaml").write_text(
        "maps: [rtm]\nprocessing: {clutter: mean, range_sum: gated}\nimage: {size_px: 32}\n"
    )
    ok("process", tmp_path / "out.h5", "--config", tmp_path / "c.yaml", "-o", tmp_path / "maps",
       "--no-figures")  # fmt: skip
    with h5py.File(tmp_path / "maps" / "maps.h5") as file:
        time, track = file["track/time"][()], file["track/range"][()]
    np.testing.assert_allclose(track, 4 - time, atol=0.1)


def test_beat_signals_are_not_taken_for_range_bins(tmp_path):
    """Echoes near and far, in noise, real and complex, are beat signals."""
    rng, n = np.random.default_rng(2), np.arange(64)
    for bins in ((3,), (3, 20), ()):
        noise = rng.standard_normal((64, 40)) + 1j * rng.standard_normal((64, 40))
        x = 0.1 * noise + sum(np.exp(-2j * np.pi * k * n / 64)[:, None] for k in bins)
        for values in (x, x.real):
            np.save(tmp_path / "beat.npy", values)
            info, _ = taken(
                tmp_path, ["beat.npy"], "carrier_hz=24e9", "bandwidth_hz=2.5e8",
                "adc_rate_hz=1e6", "prf_hz=1000", "axes=[sample,pulse]", "beat=negative",
            )  # fmt: skip
            assert info.content.dataset == "beat"


def test_magnitudes_have_a_range_time_map_and_no_doppler(tmp_path):
    values = np.round(3000 * np.abs(profiles())).astype("i2")
    values[:, 120:] = 0
    np.save(tmp_path / "a.npy", values)
    places = ["first_range_m=0.3", "range_step_m=0.05144", "bandwidth_hz=1.5e9"]
    taken(tmp_path, ["a.npy"], *PROFILE_KEYS, *places)
    with Recording(tmp_path / "out.h5") as recording:
        assert not recording.flags.any()  # zeros where nothing echoes are no losses
    (tmp_path / "c.yaml").write_text(
        "maps: [rtm]\nprocessing: {clutter: mean, range_sum: gated}\nimage: {size_px: 32}\n"
    )
    command = ("process", tmp_path / "out.h5", "--config", tmp_path / "c.yaml", "--no-figures")
    ok(*command, "-o", tmp_path / "maps")
    done = radhar(*command, "--maps", "stft", "-o", tmp_path / "doppler")
    assert done.returncode == 2
    assert "are magnitudes" in done.stderr


def test_a_folder_is_its_files_in_the_order_of_their_numbers(tmp_path):
    (tmp_path / "frames").mkdir()
    for index in range(12):
        np.save(tmp_path / "frames" / f"f{index}.npy", frame(index, 3.0))
    keys = (*FRAME_KEYS, "frame_s=0.1", "axes=[sample,pulse]")
    sets = [part for key in keys for part in ("--set", key)]
    ok("import", tmp_path / "frames", *sets, "-o", tmp_path / "out.h5")
    with Recording(tmp_path / "out.h5") as recording:
        assert recording.info.source.files == [f"f{index}.npy" for index in range(12)]


def test_arrays_in_groups_are_listed_by_their_paths(tmp_path):
    with h5py.File(tmp_path / "x.h5", "w") as file:
        file["a/data"], file["b/data"] = np.ones((4, 9)), np.ones((4, 9))
    with pytest.raises(CaptureError, match=r"there are a/data \[4, 9\], b/data \[4, 9\]"):
        taken(tmp_path, ["x.h5"], *CARRIER, "prf_hz=1000")


FRAME_KEYS = ["carrier_hz=77e9", "bandwidth_hz=1.28e9", "adc_rate_hz=3e6", "prf_hz=5555.6"]


@pytest.mark.parametrize("range_m", [3.4, 4.0])
def test_one_file_a_frame_and_echoes_in_both_halves_of_the_band(tmp_path, range_m):
    names = [f"{index:06d}.npy" for index in range(6)]
    for index, name in enumerate(names):
        np.save(tmp_path / name, frame(index, range_m)[..., None, None])
    info, x = taken(
        tmp_path, names, *FRAME_KEYS, "axes=[sample, pulse, receiver, transmitter]", "frame_s=0.1"
    )
    assert (info.pulses, info.segments, info.receivers) == (6 * 32, 6, 1)
    np.testing.assert_allclose(x[0][:, 32:64], frame(1, range_m).conj(), rtol=1e-6)
    assert info.content.is_whole == (range_m > 3.75)
    assert len(info.source.files) == 6
    np.save(tmp_path / names[3], frame(3, range_m)[:32, :, None, None])
    with pytest.raises(CaptureError, match=r"000003\.npy: has the shape .* a file a frame"):
        taken(tmp_path, names, *FRAME_KEYS, "axes=[sample, pulse, receiver, transmitter]")


@pytest.mark.parametrize(
    "words",
    ["[adc, chirp, rx, tx]", "[Range Bins, slow-time, antenna, TX]", "[samples, pulses, Rx, tx]"],
)
def test_axes_have_the_words_of_other_software(tmp_path, words):
    np.save(tmp_path / "frame.npy", frame(0, 3.4)[..., None, None])
    keys = FRAME_KEYS
    axes = "axes=[sample, pulse, receiver, transmitter]"
    expected, x = taken(tmp_path, ["frame.npy"], *keys, axes)
    info, y = taken(tmp_path, ["frame.npy"], *keys, f"axes={words}")
    assert (info.pulses, info.receivers) == (expected.pulses, expected.receivers)
    np.testing.assert_array_equal(x, y)
    with pytest.raises(ConfigError, match=r"axes.*azimuth.*should be 'receiver'"):
        taken(tmp_path, ["frame.npy"], *keys, "axes=[azimuth, pulse]")


def test_scripts_of_mmwave_studio_are_read_as_its_json_is(tmp_path):
    path = tmp_path / "capture.lua"
    path.write_text(LUA)
    header, stream = read_lua(path)
    assert (header.samples, header.loops, header.period_s) == (256, 128, pytest.approx(0.04))
    assert header.receivers == (0, 1)
    assert header.carrier_hz == pytest.approx(77e9 + 6 * 29.982e6)
    assert header.slope_hz * 256 / 1e7 == pytest.approx(767.5e6, rel=1e-3)
    assert stream.lanes == 2
    for text, says in (
        (LUA.replace("ar1.FrameConfig", "x.FrameConfig"), "should call ar1.FrameConfig"),
        (LUA.replace("SAMPLES, 10000", "os.getenv, 10000"), "argument 14 depends on os.getenv"),
        (LUA.replace("0, 0, 0, 1, 0, 0)\nar1.F", "0, 0, 0, 0, 0, 0)\nar1.F"), "transmitter on"),
        ("print('hello')", "should call ar1.ChanNAdcConfig, ar1.ProfileConfig"),
    ):
        path.write_text(text)
        with pytest.raises(CaptureError) as error:
            read_lua(path)
        assert says in str(error.value)


def test_missing_keys_are_all_named_at_once_with_a_command(tmp_path):
    np.save(tmp_path / "x.npy", np.ones((40, 64)))
    axes = ("--set", "axes=[sample,pulse]")
    done = radhar("import", tmp_path / "x.npy", *axes, "-o", tmp_path / "y.h5")
    assert done.returncode == 2
    keys = ("carrier_hz", "prf_hz", "bandwidth_hz", "adc_rate_hz")
    assert ", ".join(keys) + " are missing" in done.stderr
    assert all(f"--set {key}=" in done.stderr for key in keys)
    assert f"radhar import {tmp_path / 'x.npy'} --set axes=[sample,pulse] --set" in done.stderr


def test_a_missing_out_is_named_with_the_missing_keys_in_a_command_to_copy(tmp_path):
    np.save(tmp_path / "my x.npy", np.ones((40, 64)))
    axes = ("--set", "axes=[sample,pulse]")
    done = radhar("import", tmp_path / "my x.npy", "--set", "carrier_hz=24e9", *axes)
    assert done.returncode == 2
    assert "-o, the recording to write, is missing; " in done.stderr
    assert "prf_hz, bandwidth_hz, adc_rate_hz are missing" in done.stderr
    words = shlex.split(done.stderr.partition("radhar import ")[2].partition(", or --radar")[0])
    assert words[-2:] == ["-o", "walk.h5"]
    ok("import", *words[:-1], tmp_path / "y.h5")
    with Recording(tmp_path / "y.h5") as recording:
        assert recording.info.carrier_hz == 24e9
    missing = radhar("import", *words[:-2], "--label", "sitting down")
    assert missing.returncode == 2
    assert "-o, the recording to write, is missing: radhar import" in missing.stderr
    assert "--label 'sitting down' -o 'my x.h5'" in missing.stderr
    assert missing.stderr.count("\n") == 1


def test_process_names_all_that_is_missing(tmp_path):
    (tmp_path / "walk.h5").touch()
    done = radhar("process", tmp_path / "walk.h5")
    assert done.returncode == 2
    assert "--config and -o are missing: radhar process" in done.stderr
    assert "-o out/walk; `radhar fit" in done.stderr
    assert "no such file" in radhar("process", tmp_path / "none.h5").stderr
    done = radhar("process", tmp_path / "walk.h5", "--config", "c.yaml")
    assert "-o is missing: radhar process" in done.stderr
    assert "--config c.yaml" in done.stderr


def test_fit_chooses_frames_of_plain_real_chirps_and_says_so(tmp_path):
    """A plain radar of a config has complex samples; that of real ones has frames."""
    section = {
        "frame": {"chirps": 64, "interval_s": 1e-3}, "carrier_hz": 24e9, "chirp_s": 512e-6,
        "bandwidth_hz": 250e6, "adc_rate_hz": 0.5e6, "tx_m": [0, 0, 1], "rx_m": [0, 0, 1],
        "output": "real",
    }  # fmt: skip
    document = {"radar": section, "activities": ["walking"], "duration_s": 4, "maps": ["stft"],
                "snr_db": 20, "motion": {"range_m": 3}}  # fmt: skip
    (tmp_path / "radar.yaml").write_text(json.dumps(document))
    ok("simulate", tmp_path / "radar.yaml", "--raw", "--no-figures", "-o", tmp_path / "raw")
    with Recording(tmp_path / "raw/recording.h5") as recording:
        np.save(tmp_path / "x.npy", recording.beat(0, recording.info.pulses)[0].real)
    header = (
        "carrier_hz=24e9",
        "bandwidth_hz=250e6",
        "adc_rate_hz=0.5e6",
        "prf_hz=1000",
        "axes=[sample,pulse]",
    )
    words = [word for text in header for word in ("--set", text)]
    ok("import", tmp_path / "x.npy", "-o", tmp_path / "r.h5", *words)
    done = ok("fit", tmp_path / "r.h5", "-o", tmp_path / "fitted.yaml")
    assert "has real samples, and no frames: frames of 128 chirps without a pause" in done.stderr
    fitted = load_config(tmp_path / "fitted.yaml").filled()
    assert fitted.radar.output == "real"
    assert fitted.radar.timing.loops == 128
    assert fitted.snr_db == pytest.approx(20, abs=1.5)
    sets = ("--set", "activities=[walking]", "--set", "maps=[stft,range_doppler]")
    ok("simulate", tmp_path / "fitted.yaml", "--no-figures", "-o", tmp_path / "again", *sets)
    words = ("--set", "radar.frame.chirps=32", "--overwrite")
    done = ok("fit", tmp_path / "r.h5", "-o", tmp_path / "fitted.yaml", *words)
    assert "chosen" not in done.stderr
    assert load_config(tmp_path / "fitted.yaml").filled().radar.timing.loops == 32


def test_fit_asks_where_receivers_stand(tmp_path):
    rng = np.random.default_rng(3)
    np.save(tmp_path / "x.npy", rng.standard_normal((25, 3, 64, 32)))
    ok("import", tmp_path / "x.npy", "-o", tmp_path / "r.h5", "--set", "carrier_hz=58.5e9",
       "--set", "bandwidth_hz=1e9", "--set", "adc_rate_hz=2e6", "--set", "prf_hz=2000",
       "--set", "frame_s=0.1", "--set", "axes=[frame, receiver, pulse, sample]")  # fmt: skip
    done = radhar("fit", tmp_path / "r.h5", "-o", tmp_path / "fitted.yaml")
    assert done.returncode == 2
    assert "has 3 receivers" in done.stderr
    assert "--set 'radar.array.rx=[[0,0],[1,0],[2,0]]'" in done.stderr
    assert not (tmp_path / "fitted.yaml").exists()


@pytest.mark.parametrize(("suffix", "pack"), [(".xz", lzma), (".gz", gzip), (".bz2", bz2)])
def test_packed_files_cannot_take_the_disk(tmp_path, suffix, pack):
    path = tmp_path / f"zeros.npy{suffix}"
    path.write_bytes(pack.compress(bytes(2**27)))
    with pytest.raises(CaptureError, match="compressed 200-fold or more"):
        unpack_file(path, path.read_bytes()[:16], tmp_path)
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(CaptureError):
        unpack_file(path, path.read_bytes()[:16], tmp_path)


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.csv", b"time,I,Q\n0,1\n", "a.csv:2: has 2 columns; lines above have 3"),
        ("a.csv", b"a,b,c\n1,2,3\n2,3,4\n", "there are a [2], b [2], c [2]"),
        ("a.csv", b"I,Q\n1,2\n3\n", "a.csv:3: has 1 columns; lines above have 2"),
        ("a.txt", b"1\nx\n", "a.txt:2: 'x' should be a number"),
        ("a.wav", b"RIFF\x00\x00\x00\x00WAVEfmt ", "cannot be read"),
        ("a.npy.xz", b"\xfd7zXZ\x00junk", "cannot be unpacked"),
        ("a.qqq", b"123", "unknown format"),
    ],
)
def test_damaged_and_unknown_files_are_refused_in_a_line(tmp_path, name, content, says):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(CaptureError) as error:
        taken(tmp_path, [name], *CARRIER, "prf_hz=1000")
    assert says in str(error.value)
    assert "\n" not in str(error.value)
