"""Formats of captures: what adds one is a file with a `CaptureFormat`, and its line here."""

from dataclasses import replace
from pathlib import Path

from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import regular_size
from radhar_cli.readers.captures import (
    array_files,
    dca1000,
    glasgow_files,
    text_files,
    wav_files,
    xethru_files,
)
from radhar_cli.readers.captures.packed_files import unpack_file, unpack_zip
from radhar_cli.readers.captures.source import HEAD_BYTES, CaptureFiles, CaptureFormat, Source

# The first that recognises a file opens it; raw words, which have no mark, go by the name.
FORMATS: list[CaptureFormat] = [
    dca1000.FORMAT,
    dca1000.NETWORK,
    array_files.NPY,
    array_files.NPZ,
    array_files.MAT,
    array_files.HDF5,
    wav_files.WAV,
    xethru_files.XETHRU,
    glasgow_files.GLASGOW,
    text_files.TEXT,
]


def open_capture(files: CaptureFiles) -> Source:
    """Open a capture of any format.

    Raises:
        CaptureError: the format is unknown, or the capture does not fit its header.
    """
    files = replace(files, paths=[part for path in files.paths for part in _unpack(files, path)])
    path = files.paths[0]
    head = _head_of(path)
    for form in [array_files.RAW] if files.settings.dtype is not None else FORMATS:
        if form is array_files.RAW or form.recognises(path, head):
            if len(files.paths) > 1 and not form.is_split:
                split = " and ".join(other.name for other in FORMATS if other.is_split)
                raise CaptureError(
                    f"{files.paths[1]}: only captures of {split} are split into several files"
                )
            if files.subframes > 1 and not form.has_subframes:
                raise CaptureError(
                    f"{path}: {form.name} holds one subframe; {files.header} has "
                    f"{files.subframes}: --set subframe=N says which"
                )
            return form.open(files)
    names = [
        *(form.name for form in (*FORMATS, array_files.RAW)),
        "one of these in .xz, .gz, .bz2 or .zip",
    ]
    right = (
        f"{', '.join(names[:-1])} or {names[-1]}, or what a TI demo's data port or visualizer gave"
    )
    raise CaptureError(f"{path}: unknown format; should be {right}")


def _unpack(files: CaptureFiles, path: Path) -> list[Path]:
    """Unpack a file of a capture if it is compressed as a whole; return the paths to read."""
    place, head = files.scratch / f"unpacked{files.paths.index(path)}", _head_of(path)
    if path.suffix.lower() == ".zip":
        return unpack_zip(path, place)
    return [unpack_file(path, head, place)]


def _head_of(path: Path) -> bytes:
    """First bytes of a file, by which its format is recognised.

    Raises:
        CaptureError: it cannot be read.
    """
    try:
        regular_size(path)
        with path.open("rb") as file:
            return file.read(HEAD_BYTES)
    except OSError as error:
        raise CaptureError(f"{path}: {error.strerror}") from None
