"""Forms in which people have slow time and frames: each is read, or refused in one line."""

import datetime
import struct
import tarfile
import zipfile

import h5py
import numpy as np
import pytest
from helpers.foreign_targets import RATE, frame, tone
from scipy.io import savemat, wavfile

from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.capture.recording import Recording
from radhar_cli.errors import CaptureError

X = tone()
IN_PHASE, Q = (np.round(20000 * part).astype("i2") for part in (X.real, X.imag))
TURNS = np.stack([IN_PHASE, Q], axis=-1).ravel()
ROWS = [f"{v.real:.6f},{v.imag:.6f}" for v in X]
CLOCKED = [f"{n / RATE},{row}" for n, row in enumerate(ROWS)]
START = datetime.datetime(2026, 11, 27, 23, 59, 59, 900000)  # midnight comes within
CARRIER, PRF, BY_TURNS = "carrier_hz=24e9", "prf_hz=1000", "axes=[pulse,iq]"


def instants():
    return [START + datetime.timedelta(milliseconds=n) for n in range(400)]


def csv(head, rows, encoding="utf-8"):
    return "\n".join([*head, *rows]).encode(encoding)


def with_times(times, head="timestamp,I,Q"):
    return csv([head], [f"{t},{row}" for t, row in zip(times, ROWS, strict=True)])


def german_rows():
    """Dates with points, decimal commas, and semicolons between columns."""
    for t, row in zip(instants(), ROWS, strict=True):
        numbers = row.replace(",", ";").replace(".", ",")
        yield f"{t:%d.%m.%Y %H:%M:%S},{t.microsecond // 1000:03d};{numbers}"


def polar(head, degrees):
    angles = np.degrees(np.angle(X)) if degrees else np.angle(X)
    rows = [
        f"{n / RATE:.4f},{abs(v):.5f},{a:.6f}"
        for n, (v, a) in enumerate(zip(X, angles, strict=True))
    ]
    return csv([head], rows)


def wav24(path):
    data = b"".join(struct.pack("<i", int(v) << 16)[1:] for v in TURNS)
    head = struct.pack("<IHHIIHH", 16, 1, 2, 1000, 6000, 6, 24)
    size = struct.pack("<I", len(data))
    path.write_bytes(
        b"RIFF" + struct.pack("<I", 36 + len(data)) + b"WAVEfmt " + head + b"data" + size + data
    )


def matlab73(path, fill):
    """Write what MATLAB's -v7.3 makes."""
    with h5py.File(path, "w", userblock_size=512) as file:
        fill(file)
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116))


def pairs(x, number="<f8", names=("real", "imag")):
    values = np.zeros(x.shape, [(name, number) for name in names])
    values[names[0]], values[names[1]] = x.real, x.imag
    return values


def h5(path, values):
    with h5py.File(path, "w") as file:
        file["x"] = values


def zipped(path, names):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in names:
            archive.write(path.parent / name, name)
        archive.writestr("readme.txt", "a walk")


def zip_of_csv(path):
    (path.parent / "walk.csv").write_bytes(
        csv(["t;I;Q"], [f"{n / RATE};{r.replace(',', ';')}" for n, r in enumerate(ROWS)])
    )
    zipped(path, ["walk.csv"])


TEXTS = {
    "iso.csv": with_times(t.isoformat(timespec="milliseconds") for t in instants()),
    "zone.csv": with_times(t.isoformat(timespec="microseconds") + "Z" for t in instants()),
    "blank.csv": with_times((str(t) for t in instants()), "Date Time,I,Q"),
    "german.csv": csv(["time;I;Q"], german_rows()),
    "slashes.csv": with_times(f"{t:%d/%m/%Y %H:%M:%S.%f}" for t in instants()),
    "american.csv": with_times(f"{t:%m/%d/%Y %I:%M:%S.%f %p}" for t in instants()),
    "midnight.csv": with_times(f"{t:%H:%M:%S.%f}" for t in instants()),
    "minutes.csv": with_times(f"{t:%M:%S.%f}" for t in instants()),
    "narrow.csv": csv(["time,I,Q"], CLOCKED, "utf-16-le"),
    "big.csv": csv(["time,I,Q"], CLOCKED, "utf-16-be"),
    "seconds.csv": with_times(f"{1.7e9 + n / RATE:.3f}" for n in range(400)),
    "ms.csv": with_times(1700000000000 + n for n in range(400)),
    "us.csv": with_times(1700000000000000 + 1000 * n for n in range(400)),
    "ns.csv": with_times(1700000000000000000 + 1000000 * n for n in range(400)),
    "units.csv": with_times((n / RATE for n in range(400)), "Time,I,Q\ns,V,V"),
    "brackets.csv": with_times(range(400), "Time,I,Q\n(ms),(V),(V)"),
    "unit.csv": with_times(range(400), "time_ms,I,Q"),
    "radians.csv": polar("time,amplitude,phase", degrees=False),
    "degrees.csv": polar("time,Amplitude,Phase (deg)", degrees=True),
    "wide.csv": csv(["time,I,Q"], CLOCKED, "utf-16"),
    "latin.csv": csv(["# für", "time,I,Q"], CLOCKED, "latin-1"),
    "comment.csv": csv(["# time,I,Q"], CLOCKED),
    "words.csv": csv(["time,I_value [mV],Q_value [mV]"], CLOCKED),
    "parts.csv": csv(["time,Real Part,Imaginary Part"], CLOCKED),
    "x.tsv": csv(["time\tI\tQ"], [row.replace(",", "\t") for row in CLOCKED]),
}  # fmt: skip
SUMS = {
    "python.txt": lambda v: f"({v.real:.6f}{v.imag:+.6f}j)",
    "matlab.txt": lambda v: f"{v.real:.6f} {'-' if v.imag < 0 else '+'} {abs(v.imag):.6f}i",
    "labview.txt": lambda v: f"{v.real:.6f} {'-' if v.imag < 0 else '+'} j{abs(v.imag):.6f}",
    "mathematica.txt": lambda v: f"{v.real:.6f}{v.imag:+.6f}*I",
    "cpp.txt": lambda v: f"({v.real:.6e},{v.imag:.6e})",
}
FILES = {
    "turns.npy": (lambda p: np.save(p, TURNS), [PRF, BY_TURNS]),
    "turns.h5": (lambda p: h5(p, TURNS), [PRF, BY_TURNS]),
    "turns.mat": (lambda p: savemat(p, {"x": TURNS}), [PRF, BY_TURNS]),
    "turns.txt": (lambda p: p.write_text("\n".join(map(str, TURNS))), [PRF, BY_TURNS]),
    "turns.bin": (lambda p: TURNS.tofile(p), [PRF, BY_TURNS, "dtype=int16"]),
    "head.dat": (
        lambda p: p.write_bytes(b"12345678" + TURNS.astype(">f4").tobytes()),
        [PRF, BY_TURNS, "dtype='>float32'", "skipped_bytes=8"],
    ),
    "x.cf32": (lambda p: X.astype("c8").tofile(p), [PRF, "dtype=complex64"]),
    "wide.wav": (wav24, []),
    "float.wav": (lambda p: wavfile.write(p, 1000, TURNS.reshape(-1, 2).astype("f4")), []),
    "long.wav": (lambda p: wavfile.write(p, 1000, TURNS.reshape(-1, 2).astype("i4") << 14), []),
    "pairs.npy": (lambda p: np.save(p, pairs(IN_PHASE + 1j * Q, "<i2")), [PRF]),
    "reversed.npy": (lambda p: np.save(p, pairs(Q + 1j * IN_PHASE, "<i2", ("Q", "I"))), [PRF]),
    "reversed.h5": (lambda p: h5(p, pairs(Q + 1j * IN_PHASE, "<i2", ("imag", "real"))), [PRF]),
    "struct.mat": (lambda p: savemat(p, {"rec": {"radar": {"iq": X[None], "fs": 1000.0}}}), [PRF]),
    "new.mat": (lambda p: matlab73(p, lambda f: f.create_dataset("x", data=pairs(X[None]))), [PRF]),
    "clock.npz": (lambda p: np.savez(p, data=X, label=np.arange(400), t=np.arange(400) / RATE), []),
    "walk.zip": (zip_of_csv, []),
}  # fmt: skip
FILES |= {name: (lambda p, data=data: p.write_bytes(data), []) for name, data in TEXTS.items()}
FILES |= {
    name: (lambda p, form=form: p.write_text("\n".join(map(form, X))), [PRF])
    for name, form in SUMS.items()
}


def taken(tmp_path, names, *overrides):
    """(recording's info, samples of all pulses) of a capture."""
    paths = [tmp_path / name for name in names]
    info = import_capture(paths, tmp_path / "out.h5", read_settings(None, overrides))
    with Recording(tmp_path / "out.h5") as recording:
        return info, recording.beat(0, info.pulses)


@pytest.mark.every(4)
@pytest.mark.parametrize("name", FILES)
def test_slow_time_is_the_same_in_every_form(tmp_path, name):
    write, keys = FILES[name]
    write(tmp_path / name)
    info, x = taken(tmp_path, [name], CARRIER, *keys)
    assert x.shape == (1, 1, 400)
    assert info.prf_hz == pytest.approx(1000, rel=1e-3)
    likeness = np.vdot(X, x) / np.linalg.norm(X) / np.linalg.norm(x)
    assert likeness.real > 0.9999


RECEIVER_COLUMNS = (
    "time,I1,Q1,I2,Q2",
    "time,rx1_i,rx1_q,rx2_i,rx2_q",
    "time,I_ch1,Q_ch1,I_ch2,Q_ch2",
    "time,I rx1,Q rx1,I rx2,Q rx2",
)


def test_receivers_are_pairs_of_channels_and_of_columns(tmp_path):
    both = np.column_stack([IN_PHASE, Q, -Q, IN_PHASE])  # the second turned by 90 degrees
    wavfile.write(tmp_path / "four.wav", 1000, both)
    for head in RECEIVER_COLUMNS:
        rows = [f"{n / RATE},{','.join(map(str, row))}" for n, row in enumerate(both)]
        (tmp_path / "four.csv").write_bytes(csv([head], rows))
        for name in ("four.wav", "four.csv"):
            _, x = taken(tmp_path, [name], CARRIER)
            assert x.shape == (2, 1, 400)
            np.testing.assert_allclose(x[1], 1j * x[0], atol=1e-9)


BEAT = ["carrier_hz=77e9", "bandwidth_hz=1.28e9", "adc_rate_hz=3e6", "prf_hz=5555.6"]
FRAMES = [*BEAT, "frame_s=0.1", "axes=[sample,pulse]"]


def cells(kind):
    values = np.zeros((1, 3), object if kind is None else kind)
    for n in range(3):
        values[0, n] = frame(n, 3.0) if kind is None else (frame(n, 3.0), n * 0.1)
    return values


def new_cells(file):
    group = file.create_group("#refs#")
    for n in range(3):
        group["abc"[n]] = pairs(frame(n, 3.0).T)
    references = file.create_dataset("frames", (3, 1), dtype=h5py.ref_dtype)
    references[:, 0] = [group[name].ref for name in "abc"]


ONE_FILE = {
    "cells.mat": lambda p: savemat(p, {"frames": cells(None)}),
    "structs.mat": lambda p: savemat(p, {"frames": cells([("data", "O"), ("t", "O")])}),
    "new.mat": lambda p: matlab73(p, new_cells),
    "frames.zip": lambda p: zipped(p, ["f0.npy", "f1.npy", "f2.npy"]),
}
A_FILE_A_FRAME = {
    ".npy": np.save,
    ".mat": lambda p, x: savemat(p, {"x": x}),
    ".h5": h5,
    ".npz": lambda p, x: np.savez(p, x=x),
    ".csv": lambda p, x: np.savetxt(p, x, delimiter=","),
    ".txt": lambda p, x: np.savetxt(p, x, fmt=["%.6f%+.6fj"] * x.shape[1]),
}


def check_frames(info, x):
    assert (info.pulses, info.segments, info.receivers) == (96, 3, 1)
    expected = np.concatenate([frame(n, 3.0) for n in range(3)], axis=1).conj()
    np.testing.assert_allclose(x[0], expected, atol=1e-5)


@pytest.mark.parametrize("name", ONE_FILE)
def test_frames_in_cells_structs_and_archives(tmp_path, name):
    for n in range(3):
        np.save(tmp_path / f"f{n}.npy", frame(n, 3.0))
    ONE_FILE[name](tmp_path / name)
    check_frames(*taken(tmp_path, [name], *FRAMES))


@pytest.mark.parametrize("suffix", A_FILE_A_FRAME)
def test_a_file_a_frame_in_every_format(tmp_path, suffix):
    names = [f"f{n}{suffix}" for n in range(3)]
    for n, name in enumerate(names):
        A_FILE_A_FRAME[suffix](tmp_path / name, frame(n, 3.0))
    check_frames(*taken(tmp_path, names, *FRAMES))


def test_numbers_of_a_frame_without_a_header_are_cut_by_the_axes(tmp_path):
    names = [f"f{n}.bin" for n in range(3)]
    for n, name in enumerate(names):
        x = frame(n, 3.0).T
        np.stack([x.real, x.imag], axis=-1).astype("f4").tofile(tmp_path / name)
    keys = [*BEAT, "frame_s=0.1", "axes=[pulse,sample,iq]", "dtype=float32", "samples=64"]
    check_frames(*taken(tmp_path, names, *keys))


def test_a_sweep_a_line_with_i_then_q_and_a_time_is_asked_for_and_read(tmp_path):
    """As the programs around uRAD's radars write sweeps."""
    rng, n = np.random.default_rng(1), np.arange(32)
    x = np.exp(2j * np.pi * (5 * n / 32 + 0.1 * np.arange(60)[:, None]))
    x = np.round(1000 * x + 10 * rng.standard_normal(x.shape))
    rows = [
        " ".join(f"{v:.0f}" for v in (*row.real, *row.imag)) + f" {1.7e9 + 0.02 * k:.3f}"
        for k, row in enumerate(x)
    ]
    (tmp_path / "IQ.txt").write_text("\n".join(rows))
    keys = ["carrier_hz=24e9", "bandwidth_hz=2.4e8", "adc_rate_hz=2e5"]
    with pytest.raises(CaptureError, match=r"65 columns without names.*\[pulse,iq,sample"):
        taken(tmp_path, ["IQ.txt"], *keys)
    info, values = taken(tmp_path, ["IQ.txt"], *keys, "axes=[pulse,iq,sample]", "beat=negative")
    assert (info.prf_hz, values.shape) == (pytest.approx(50, rel=1e-3), (1, 32, 60))
    np.testing.assert_allclose(values[0], x.T)


@pytest.mark.parametrize(
    ("axes", "order"), [("pulse,sample,iq", (0, 1, 2)), ("pulse,iq,sample", (0, 2, 1))]
)
@pytest.mark.parametrize("suffix", [".npy", ".h5"])
def test_an_axis_of_i_and_q_is_split_as_the_axes_say(tmp_path, axes, order, suffix):
    rng = np.random.default_rng(1)
    x = rng.integers(-1000, 1000, (40, 16, 2)).astype("i2")
    flat = x.transpose(order).reshape(40, 32)
    (np.save if suffix == ".npy" else h5)(tmp_path / f"x{suffix}", flat)
    keys = [*BEAT, f"axes=[{axes}]", "beat=negative"]
    _, values = taken(tmp_path, [f"x{suffix}"], *keys)
    np.testing.assert_array_equal(values[0], (x[..., 0] + 1j * x[..., 1]).T)


REFUSED = {
    "turns.npy": (lambda p: np.save(p, TURNS), r"axes=\[pulse,iq\]\)\?; so may be carrier_hz, prf"),
    "turns.mat": (lambda p: savemat(p, {"x": TURNS}), "radhar import .* --set axes=.*-o walk.h5"),
    "turns.txt": (lambda p: p.write_text("\n".join(map(str, TURNS))), "800 real numbers along one"),
    "rows.npy": (lambda p: np.save(p, TURNS.reshape(-1, 2).T), r"such as \[iq,pulse\] if"),
    "turns.bin": (lambda p: TURNS.tofile(p), "samples and receivers are missing.*dtype=int16"),
    "three.wav": (lambda p: wavfile.write(p, 9, TURNS[:600].reshape(-1, 3)), "has 3 channels"),
    "count.csv": (lambda p: p.write_bytes(with_times(range(400), "time,I,Q")), "without a unit"),
    "twins.csv": (lambda p: p.write_bytes(with_times(range(400), "time_ms,I,I")), "named I"),
    "turn.csv": (
        lambda p: p.write_bytes(polar("time,amplitude,phase", degrees=True)),
        "phase: goes beyond 2 pi; its name should say",
    ),
    "many.npy": (lambda p: np.save(p, np.ones((40, 8, 16), "c8")), "has 3 axes.*; --set axes"),
    "x.tar.gz": (lambda p: tarfile.open(p, "w:gz").close(), "unpack it first"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_could_be_guessed_wrong_is_asked_for(tmp_path, name):
    write, says = REFUSED[name]
    write(tmp_path / name)
    with pytest.raises(CaptureError, match=says) as error:
        taken(tmp_path, [name])
    assert "\n" not in str(error.value)


def test_archives_cannot_take_the_disk_or_leave_their_folder(tmp_path):
    with zipfile.ZipFile(tmp_path / "big.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("x.npy", bytes(2**27))
    with pytest.raises(CaptureError, match="compressed 200-fold or more"):
        taken(tmp_path, ["big.zip"])
    np.save(tmp_path / "x.npy", X)
    with zipfile.ZipFile(tmp_path / "out.zip", "w") as archive:
        archive.write(tmp_path / "x.npy", "../../../escaped.npy")
    with pytest.raises(CaptureError, match="holds 0 files"):
        taken(tmp_path, ["out.zip"], CARRIER, PRF)
    assert not [*tmp_path.parent.rglob("escaped.npy")]
