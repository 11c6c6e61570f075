"""Every reader refuses what is no file of its format in one line: bounded in size and time."""

import io
import os
import signal
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from radhar_cli.capture.importing import import_capture, read_settings
from radhar_cli.errors import RadharError
from radhar_cli.readers.motion.reading import SUFFIXES, read_motion

SECONDS = 120  # in which each is refused, also on a busy machine
LARGE = 2**31 + 2  # bytes of a file with holes, more than any text or motion may have
LONG = 2**21  # bytes of an endless line


def read_capture(path: Path) -> None:
    keys = ["carrier_hz=24e9", "prf_hz=1000", "axes=[pulse,sample]"]
    import_capture([path], path.with_name("out.h5"), read_settings(None, keys))


def read_header(path: Path) -> None:
    read_settings(path, [])


def read_joints(path: Path) -> None:
    path.with_suffix(".asf").write_text(":version 1.10\n")
    read_motion(path).recording()


CAPTURES = (".csv", ".txt", ".dat", ".npy", ".npz", ".mat", ".h5", ".wav", ".pcap")
CAPTURES += (".zip", ".npy.xz", ".npy.gz", ".npy.bz2")
HEADERS = (".cfg", ".lua", ".mmwave.json")
FORMATS: list[tuple[str, Callable[[Path], None]]] = [
    *((suffix, read_capture) for suffix in CAPTURES),
    *((suffix, read_header) for suffix in HEADERS),
    *((suffix, read_joints) for suffix in SUFFIXES),
]


def write_large(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(LARGE)


def write_zip_bomb(path: Path) -> None:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("positions.npy", bytes(2**26))
    path.write_bytes(data.getvalue())


HAZARDS: dict[str, Callable[[Path], object]] = {
    "too large": write_large,
    "endless line": lambda path: path.write_bytes(b"1," * (LONG // 2)),
    "endless word": lambda path: path.write_bytes(b"1" * LONG),
    "deep nesting": lambda path: path.write_bytes(b"[" * LONG),
    "deep braces": lambda path: path.write_bytes(b'{"a":' * (LONG // 5)),
    "zip bomb": write_zip_bomb,
    "NUL bytes": lambda path: path.write_bytes(bytes(10_000)),
    "empty": lambda path: path.write_bytes(b""),
    "FIFO": os.mkfifo,
    "folder": Path.mkdir,
}


class BlocksError(BaseException):
    """A reader takes too long; no OSError, which readers turn into their own."""


@pytest.fixture
def alarm() -> Iterator[None]:
    """Fail, rather than wait for ever, where a reader blocks."""

    def fail(*_: object) -> None:
        raise BlocksError(f"takes more than {SECONDS} s")

    previous = signal.signal(signal.SIGALRM, fail)
    signal.alarm(SECONDS)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, previous)


@pytest.mark.usefixtures("alarm")
@pytest.mark.parametrize("hazard", HAZARDS)
@pytest.mark.parametrize(("suffix", "read"), FORMATS, ids=[f"{r.__name__}{s}" for s, r in FORMATS])
def test_every_reader_refuses_every_hazard_in_one_line(
    tmp_path: Path, suffix: str, read: Callable[[Path], None], hazard: str
) -> None:
    path = tmp_path / f"file{suffix}"
    HAZARDS[hazard](path)
    with pytest.raises(RadharError) as refused:
        read(path)
    assert "\n" not in str(refused.value)
    assert len(str(refused.value)) < 3000
    assert not [*tmp_path.glob("*.h5.*")], "nothing is left"
