"""Arrays of every format, type and order of axes come in as the numbers that were written."""

import io
import subprocess
import sys
import zipfile
import zlib
from contextlib import suppress
from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.command_line import ROOT, radhar
from helpers.slow import examples, slow
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from radhar_cli.capture.content import SlowTime
from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.capture.recording import Recording
from radhar_cli.errors import CaptureError, FolderError, RadharError
from radhar_cli.readers.captures.array_axes import as_source
from radhar_cli.readers.captures.settings import CaptureSettings
from radhar_cli.readers.captures.stored_arrays import StoredArray

RADAR = ["carrier_hz=77e9", "bandwidth_hz=1e9", "adc_rate_hz=1e6", "prf_hz=1000"]
AXES = "axes=[receiver,sample,pulse]"
RECEIVERS, SAMPLES, PULSES = 3, 16, 40


def cube(dtype: str = "c8") -> np.ndarray:
    """[receiver, sample, pulse] with a target in radhar's half of the spectrum."""
    rng = np.random.default_rng(1)
    n, m = np.arange(SAMPLES)[:, None], np.arange(PULSES)
    x = np.exp(-2j * np.pi * (3 * n / SAMPLES + 0.21 * m))
    x = np.stack([x * np.exp(1j * k) for k in range(RECEIVERS)])
    x = x + 0.01 * (rng.standard_normal(x.shape) + 1j * rng.standard_normal(x.shape))
    return x.astype(dtype) if dtype.startswith("c") else (x.real * 1000).astype(dtype)


def imported(path: Path, *overrides: str) -> np.ndarray:
    out = path.with_name("out.h5")
    axes = [] if any(o.startswith("axes=") for o in overrides) else [AXES]
    import_capture([path], out, read_settings(None, [*RADAR, *axes, *overrides]))
    with Recording(out) as recording:
        return recording.beat(0, recording.info.pulses)


def save(path: Path, x: np.ndarray, chunks: tuple[int, ...] | None = (7, 5, 2)) -> Path:
    """Write an array in the format of the suffix; `.mat73` is what MATLAB's -v7.3 makes."""
    if path.suffix == ".npy":
        np.save(path, x)
    elif path.suffix == ".npz":
        np.savez_compressed(path, beat=x, note=np.array("text"), gain=3.0)
    elif path.suffix == ".mat":
        savemat(path, {"beat": x, "about": {"a": 1}}, do_compression=True)
    elif path.suffix == ".h5":
        with h5py.File(path, "w") as file:
            file.create_dataset("beat", data=x, compression="gzip", shuffle=True)
            file["note"] = "text"
    else:
        with h5py.File(path, "w", userblock_size=512) as file:
            pair = np.dtype([("real", "f8"), ("imag", "f8")])
            turned = x.T.astype(complex)
            values = np.empty(turned.shape, pair)
            values["real"], values["imag"] = turned.real, turned.imag
            file.create_dataset("beat", data=values, chunks=chunks, compression="gzip")
        with path.open("r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116))
    return path


@pytest.mark.parametrize("suffix", [".npy", ".npz", ".mat", ".h5", ".mat73"])
def test_every_format_is_imported(tmp_path: Path, suffix: str) -> None:
    x = cube()
    assert np.array_equal(imported(save(tmp_path / f"x{suffix}", x)), x)


@pytest.mark.parametrize("dtype", ["c8", "c16", "f4", "f8", "i2", "i4", "u2", ">c8", ">i2"])
@pytest.mark.parametrize("suffix", [".npy", ".npz", ".h5"])
def test_every_type_is_imported(tmp_path: Path, suffix: str, dtype: str) -> None:
    x = cube(dtype.lstrip(">") if "u" not in dtype else "i2")
    x = (x.astype(int) + 2**15).astype(dtype) if "u" in dtype else x.astype(dtype)
    found = imported(save(tmp_path / f"x{suffix}", x))
    assert np.array_equal(found, x.astype(int) - 2**15 if "u" in dtype else x)


@settings(
    max_examples=examples(40),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    order=st.permutations(["transmitter", "receiver", "sample", "frame", "pulse", "iq"]),
    suffix=st.sampled_from([".npy", ".h5"]),
    fortran=st.booleans(),
)
def test_every_order_of_axes_is_imported(
    tmp_path: Path, order: list[str], suffix: str, fortran: bool
) -> None:
    """Receivers of the first transmitter come first; frames follow one another."""
    sizes = {"transmitter": 2, "receiver": 3, "sample": 8, "frame": 5, "pulse": 4, "iq": 2}
    rng = np.random.default_rng(0)
    x = rng.integers(-1000, 1000, [*sizes.values()]).astype("i2")
    turned = x.transpose([[*sizes].index(name) for name in order])
    turned = np.asfortranarray(turned) if fortran else np.ascontiguousarray(turned)
    names = "[" + ", ".join(order) + "]"
    path = save(tmp_path / f"x{suffix}", turned)
    found = imported(path, f"axes={names}", "frame_s=0.1", "transmitters=2", "beat=negative")
    wanted = x.reshape(6, 8, 20, 2).astype(float)
    assert np.array_equal(found, wanted[..., 0] + 1j * wanted[..., 1])


@given(first=st.integers(0, 39), count=st.integers(1, 40), frame=st.sampled_from([1, 4, 10, 40]))
def test_any_range_of_pulses_is_read(first: int, count: int, frame: int) -> None:
    """No more than the pulses asked for, whole frames or not."""
    x = np.arange(40 * 2 * 3.0).reshape(40 // frame, frame, 2, 3)
    read: list[int] = []

    class Counting(StoredArray):
        def read(self, key: tuple[slice, ...]) -> np.ndarray:
            read.append(x[key].size)
            return super().read(key)

    axes = ("frame", "pulse", "receiver", "sample")
    source = as_source(Path("x"), Counting("x", lambda: x), CaptureSettings(axes=axes))
    stop = min(first + count, 40)
    found = source.read(first, stop)
    assert np.array_equal(found[..., 0], x.reshape(40, 2, 3).transpose(1, 2, 0)[:, :, first:stop])
    assert sum(read) == found.size


def test_chirps_of_transmitters_in_turn_are_told_apart(tmp_path: Path) -> None:
    x = cube()
    np.save(tmp_path / "x.npy", x)
    found = imported(tmp_path / "x.npy", "transmitters=2")
    assert np.array_equal(found, np.concatenate([x[:, :, ::2], x[:, :, 1::2]]))


@pytest.mark.parametrize("suffix", [".npy", ".mat", ".mat73"])
def test_slow_time_is_imported(tmp_path: Path, suffix: str) -> None:
    """MATLAB's vectors are rows or columns."""
    x = np.exp(2j * np.pi * 0.1 * np.arange(1000))
    path, out = tmp_path / f"x{suffix}", tmp_path / "out.h5"
    for shape in ((1000,),) if suffix == ".npy" else ((1, 1000), (1000, 1)):
        save(path, x.reshape(shape), (1, 1) if suffix == ".mat73" else None)
        import_capture([path], out, read_settings(None, RADAR[:1] + RADAR[3:]))
        with Recording(out) as recording:
            assert isinstance(recording.info.content, SlowTime)
            assert np.array_equal(recording.beat(0, 1000)[0, 0], x)


def test_gaps_follow_from_the_times(tmp_path: Path) -> None:
    x = cube()
    times = 5 + np.arange(PULSES) / 500
    times[30:] += 0.7
    np.savez(tmp_path / "x.npz", beat=x, t=times)
    out = tmp_path / "out.h5"
    given_settings = read_settings(None, [*RADAR[:3], "times=t", "dataset=beat", AXES])
    told = import_capture([tmp_path / "x.npz"], out, given_settings).source.findings
    assert any("not uniform: 2 stretches" in line for line in told)
    with Recording(out) as recording:
        assert recording.info.prf_hz == pytest.approx(500)
        assert recording.segments.times(np.arange(PULSES)) == pytest.approx(times - 5)


WRONG = [
    ("x.npy", cube(), ["samples=40"], "sample should have 40"),
    ("x.npy", cube(), ["axes=[sample, pulse]"], "has 3 axes, [3, 16, 40]"),
    ("x.npy", cube()[None, None], [], "has 5 axes"),
    ("x.npy", cube()[:, :1], [], "sample should have 2 or more"),
    ("x.npy", cube(), ["frame_pulses=4"], "frame_s is missing"),
    ("x.npy", cube(), ["frame_pulses=4", "frame_s=0.001"], "frame_s = 0.001: should be at least"),
    ("x.npy", cube().astype("U9"), [], "is of the type"),
    ("x.npz", cube(), ["dataset=baet"], "did you mean 'beat'"),
    ("x.npz", cube(), ["times=tt"], "tt: no such array"),
]


@pytest.mark.parametrize(("name", "x", "overrides", "expected"), WRONG)
def test_wrong_array_is_refused_in_one_line(
    tmp_path: Path, name: str, x: np.ndarray, overrides: list[str], expected: str
) -> None:
    with pytest.raises(CaptureError) as caught:
        imported(save(tmp_path / name, x), *overrides)
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)
    assert [p.name for p in tmp_path.iterdir()] == [name], "nothing is left"


@pytest.mark.parametrize("key", ["carrier_hz", "bandwidth_hz", "adc_rate_hz", "prf_hz"])
def test_missing_settings_are_asked_for(tmp_path: Path, key: str) -> None:
    np.save(tmp_path / "x.npy", cube())
    left = [one for one in (*RADAR, AXES) if not one.startswith(key)]
    done = radhar(
        *("import", tmp_path / "x.npy", "-o", tmp_path / "out.h5"),
        *(word for one in left for word in ("--set", one)),
    )
    assert done.returncode == 2
    assert f"{key} is missing" in done.stderr


class TestHostile:
    """Nothing is unpickled, nothing grows beyond bounds, no traceback."""

    def test_pickles_are_refused(self, tmp_path: Path) -> None:
        class Evil:
            def __reduce__(self) -> tuple[object, tuple[str]]:
                return (Path.touch, (tmp_path / "touched",))

        np.save(tmp_path / "x.npy", np.array([Evil(), None], dtype=object), allow_pickle=True)
        np.savez(tmp_path / "x.npz", beat=np.array([Evil()] * 4, dtype=object).reshape(2, 2))
        for name, message in (
            ("x.npy", r"an array \[2\] of Python objects.*np\.stack"),
            ("x.npz", "should name the samples"),
        ):
            with pytest.raises(CaptureError, match=message):
                imported(tmp_path / name)
        assert not (tmp_path / "touched").exists()

    def test_a_long_header_is_refused(self, tmp_path: Path) -> None:
        header = b"{'descr': '<c8', 'fortran_order': False, 'shape': (" + b"1," * 40_000 + b"), }"
        body = b"\x93NUMPY\x02\x00" + len(header).to_bytes(4, "little") + header
        (tmp_path / "x.npy").write_bytes(body)
        with pytest.raises(CaptureError, match="cannot be read"):
            imported(tmp_path / "x.npy")

    def test_a_shape_larger_than_the_file_is_refused(self, tmp_path: Path) -> None:
        data = io.BytesIO()
        np.lib.format.write_array_header_1_0(
            data, {"descr": "<c16", "fortran_order": False, "shape": (2**20, 2**20)}
        )
        (tmp_path / "x.npy").write_bytes(data.getvalue() + bytes(100))
        with pytest.raises(CaptureError, match="cannot be read"):
            imported(tmp_path / "x.npy")

    def test_decompression_bombs_are_refused(self, tmp_path: Path) -> None:
        x = np.zeros((64, 2**18), "c8")
        save(tmp_path / "x.npz", x)
        savemat(tmp_path / "x.mat", {"beat": x}, do_compression=True)
        for name in ("x.npz", "x.mat"):
            with pytest.raises(CaptureError, match=r"-fold|when unpacked"):
                imported(tmp_path / name)

    def test_lzma_is_refused(self, tmp_path: Path) -> None:
        data = io.BytesIO()
        np.save(data, cube())
        with zipfile.ZipFile(tmp_path / "x.npz", "w", zipfile.ZIP_LZMA) as archive:
            archive.writestr("beat.npy", data.getvalue())
        with pytest.raises(CaptureError, match="compressed in a way"):
            imported(tmp_path / "x.npz")

    def test_objects_of_matlab_are_refused(self, tmp_path: Path) -> None:
        cells = np.array(["more", "text"], dtype=object)
        savemat(tmp_path / "x.mat", {"beat": cells, "s": {"a": 1}, "t": "text"})
        with pytest.raises(CaptureError, match="there are none"):
            imported(tmp_path / "x.mat")

    def test_links_to_other_files_are_refused(self, tmp_path: Path) -> None:
        with h5py.File(tmp_path / "other.h5", "w") as file:
            file["beat"] = cube()
        with h5py.File(tmp_path / "x.h5", "w") as file:
            file["beat"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "/beat")
        with pytest.raises(FolderError, match="is a link"):
            imported(tmp_path / "x.h5", "dataset=beat")

    def test_a_chunk_that_inflates_beyond_its_size_is_refused(self, tmp_path: Path) -> None:
        with h5py.File(tmp_path / "x.h5", "w") as file:
            data = file.create_dataset("beat", (3, 16, 40), "c8", chunks=True, compression="gzip")
            data[:] = 0
            bomb = zlib.compress(bytes(100_000), 9)
            data.id.write_direct_chunk((0, 0, 0), bomb)
        with pytest.raises(FolderError, match="too long"):
            imported(tmp_path / "x.h5")

    @settings(
        max_examples=examples(150),
        deadline=None,
        suppress_health_check=[HealthCheck.function_scoped_fixture],
    )
    @given(
        suffix=st.sampled_from([".npy", ".npz", ".mat", ".h5", ".mat73"]),
        at=st.integers(0, 10**6),
        values=st.binary(min_size=1, max_size=8),
        cut=st.integers(0, 10**6) | st.none(),
    )
    def test_damage_is_refused_in_one_line(
        self, tmp_path: Path, suffix: str, at: int, values: bytes, cut: int | None
    ) -> None:
        path = save(tmp_path / f"x{suffix}", cube()[:, :, :8])
        data = bytearray(path.read_bytes())
        at %= len(data)
        data[at : at + len(values)] = values
        path.write_bytes(data if cut is None else data[: cut % len(data)])
        with suppress(RadharError):
            imported(path)
        assert not [*tmp_path.glob(".out*")]


GROWTH = """
import resource, sys
from pathlib import Path
from radhar_cli.capture.content import SlowTime
from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.capture.recording import Recording
import numpy, scipy.io, h5py
folder, kind = Path(sys.argv[1]), sys.argv[2]
keys = ["carrier_hz=77e9", "bandwidth_hz=1e9", "adc_rate_hz=1e6", "prf_hz=1000"]
more = ["samples=256", "receivers=4"] if kind == "bin" else ["axes=[pulse, receiver, sample]"]
settings = read_settings(None, keys + more)
import_capture([folder / f"small.{kind}"], folder / "o.h5", settings)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
import_capture([folder / f"large.{kind}"], folder / "o.h5", settings)
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024)
"""


@pytest.mark.parametrize("kind", ["bin", *slow(["npy", "h5"])])
def test_memory_does_not_grow_with_the_capture(tmp_path: Path, kind: str) -> None:
    """64 MiB of samples need no more memory than 16; a sparse file stands for a capture."""
    for name, pulses in (("small", 4096), ("large", 16_384)):
        shape = (pulses, 4, 256)
        size, pulse = 4 * pulses * 4 * 256, np.ones((4, 256))
        path = tmp_path / f"{name}.{kind}"
        if kind == "npy":
            with path.open("wb") as file:
                np.lib.format.write_array_header_1_0(
                    file, {"descr": "<c8", "fortran_order": False, "shape": shape}
                )
                start = file.tell()
                file.truncate(start + 2 * size)
                file.seek(start)
                file.write(pulse.astype("<c8").tobytes())
        elif kind == "bin":
            with path.open("wb") as file:
                file.truncate(size)
                file.seek(0)
                file.write(np.ones(2 * pulse.size, "<i2").tobytes())
        else:
            with h5py.File(path, "w") as file:
                data = file.create_dataset("beat", shape, "c8", chunks=(64, 4, 256))
                for first in range(0, pulses, 4096):
                    data[first : first + 4096] = 0
                data[0] = pulse.astype("c8")
    done = subprocess.run(
        [sys.executable, "-c", GROWTH, str(tmp_path), kind],
        capture_output=True,
        text=True,
        cwd=ROOT,
        check=True,
    )
    assert float(done.stdout) < 20, done.stdout
