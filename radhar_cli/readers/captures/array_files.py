"""Captures that are arrays: .npy, .npz, .mat (v5 and v7.3), HDF5, and numbers without a mark.

They are not trusted: nothing is unpickled, MATLAB objects are refused, and what a file unpacks to
is bounded. Of several files each is a frame.
"""

import zipfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from math import prod
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.errors import CaptureError
from radhar_cli.readers.captures.acconeer_files import FRAME, SparseIq, read_sparse_iq
from radhar_cli.readers.captures.array_axes import as_source, cut_axes, settings_with_frames
from radhar_cli.readers.captures.matlab_files import open_mat5
from radhar_cli.readers.captures.named_arrays import ArrayNames, choose_arrays
from radhar_cli.readers.captures.named_parts import is_quadrature_first
from radhar_cli.readers.captures.packed_files import MAX_PACKING
from radhar_cli.readers.captures.parser_errors import parser_errors_as_capture_errors
from radhar_cli.readers.captures.point_tables import (
    HOW,
    refuse_array_of_points,
    refuse_file_of_points,
)
from radhar_cli.readers.captures.pulse_clock import seconds_of
from radhar_cli.readers.captures.raw_files import map_raw
from radhar_cli.readers.captures.settings import NO_TIMES
from radhar_cli.readers.captures.source import CaptureFiles, CaptureFormat, Source
from radhar_cli.readers.captures.stored_arrays import (
    FrameFiles,
    PairedArray,
    PointsOfArray,
    Samples,
    StoredArray,
    SwappedPairs,
)
from radhar_cli.readers.untrusted_hdf5 import UntrustedFile

MAX_TIMES = 2**24
UNNAMED = ArrayNames("", None, None, False)


class Arrays(NamedTuple):
    """Arrays of a file that are read.

    Attributes:
        names: Which of them are the samples, Q and the times.
        arrays: The arrays by their names.
        header: What the file itself says of them; None of most.
    """

    names: ArrayNames
    arrays: Mapping[str, Samples]
    header: SparseIq | None = None


def _open_npy(path: Path, files: CaptureFiles) -> Arrays:
    """Map the array of a .npy file.

    Raises:
        CaptureError: it holds Python objects, such as frames of unequal shapes.
    """
    del files
    with parser_errors_as_capture_errors(str(path)), path.open("rb") as file:
        shape, dtype = _read_header(file)
        if dtype.hasobject:
            raise CaptureError(
                f"{path}: is an array {[*shape]} of Python objects, which are not read, as they "
                "can run code; should be numbers: np.save(OUT, np.stack(FRAMES)) of samples; of "
                f"points {HOW}"
            )
    return Arrays(UNNAMED, {"": _map_npy(path, str(path))})


def _map_npy(path: Path, where: str) -> StoredArray:
    """Map an array that NumPy has written."""
    return StoredArray(where, partial(np.load, path, mmap_mode="r", allow_pickle=False))


def _open_raw(path: Path, files: CaptureFiles) -> Arrays:
    """Map a file of numbers."""
    refuse_file_of_points(path)
    return Arrays(UNNAMED, {"": map_raw(path, files.settings)})


def _open_npz(path: Path, files: CaptureFiles) -> Arrays:
    """Unpack the arrays of an .npz that are read."""
    place = files.scratch / f"{files.paths.index(path)}"
    with parser_errors_as_capture_errors(str(path)), zipfile.ZipFile(path) as archive:
        kinds = {n: found for n, found in check_npz(archive).items() if found[1] in "iufcV"}
        shapes = {name: shape for name, (shape, _) in kinds.items()}
        names = choose_arrays(path, shapes, files.settings, lambda name: kinds[name][1] in "cV")
        members = {name.removesuffix(".npy"): name for name in archive.namelist()}
        arrays = {
            name: _map_npy(Path(archive.extract(members[name], place)), f"{path}: {name}")
            for name in names[:3]
            if name is not None
        }
        return Arrays(names, arrays)


def _read_header(file: IO[bytes]) -> tuple[tuple[int, ...], np.dtype[Any]]:
    """Read shape and type of an array that NumPy has written."""
    form = np.lib.format
    old = form.read_magic(file) == (1, 0)
    read = form.read_array_header_1_0 if old else form.read_array_header_2_0
    shape, _, dtype = read(file)
    return shape, dtype


def check_npz(archive: zipfile.ZipFile) -> dict[str, tuple[tuple[int, ...], str]]:
    """Check the arrays of an .npz by their headers: {name: (shape, kind of its type)}.

    Raises:
        ValueError: an array is compressed too much or otherwise than by NumPy, or is too short.
    """
    arrays: dict[str, tuple[tuple[int, ...], str]] = {}
    for member in archive.infolist():
        if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise ValueError(f"{member.filename} is compressed in a way that NumPy does not use")
        if member.file_size > MAX_PACKING * max(member.compress_size, 1024):
            raise ValueError(f"{member.filename} is compressed {MAX_PACKING}-fold or more")
        with archive.open(member) as file:
            shape, dtype = _read_header(file)
        if not dtype.hasobject and prod(shape) * dtype.itemsize > member.file_size:
            raise ValueError(f"{member.filename} has the shape {shape}, but too few bytes")
        arrays[member.filename.removesuffix(".npy")] = shape, dtype.kind
    return arrays


def npz_columns(path: Path) -> list[str]:
    """Names of the arrays [n] of numbers or texts of an .npz.

    Raises:
        CaptureError: the file is damaged.
    """
    with parser_errors_as_capture_errors(str(path)), zipfile.ZipFile(path) as archive:
        arrays = check_npz(archive).items()
    return [name for name, (shape, kind) in arrays if len(shape) == 1 and kind in "iufU"]


def read_npz_array(path: Path, name: str, max_bytes: int, kinds: str = "iuf") -> NDArray[Any]:
    """Read an array of plain numbers, or of other `kinds`, out of an .npz.

    Raises:
        CaptureError: the file is damaged, or has no such array of at most `max_bytes`.
    """
    with parser_errors_as_capture_errors(str(path)), zipfile.ZipFile(path) as archive:
        shape, kind = check_npz(archive).get(name, ((), "O"))
        if kind not in kinds:
            raise ValueError(f"holds no {name} of plain numbers; pickles are not opened")
        if 8 * prod(shape) > max_bytes:
            raise ValueError(f"{name} has the shape {[*shape]}, too large")
        if archive.getinfo(f"{name}.npy").file_size > max_bytes:
            raise ValueError(f"{name} has more than {max_bytes} bytes")
        with archive.open(f"{name}.npy") as file:
            array: NDArray[Any] = np.lib.format.read_array(file, allow_pickle=False)
            return array


def _open_hdf5(path: Path, files: CaptureFiles) -> Arrays:
    """Open the arrays of an HDF5 file that are read."""
    file, settings = UntrustedFile(path), files.settings
    named = settings.dataset, settings.times, settings.imaginary
    paths = {name.strip("/"): name for name in filter(None, named) if name != "none"}
    names = list(dict.fromkeys([*file.numeric_paths(), *paths.values()]))
    shapes = {name: tuple(file.shape(name.strip("/"))) for name in names}
    cells = {name: parts for name, parts in file.cells().items() if parts}
    shapes |= {name: (*file.shape(parts[0]), len(parts)) for name, parts in cells.items()}
    frames = [name for name in shapes if f"/{name}".endswith(FRAME)]
    if settings.dataset is None and len(frames) > 1:
        raise CaptureError(
            f"{path}: is an acconeer recording of {len(frames)} sensors; --set dataset=NAME should "
            f"say which is read: {', '.join(frames)}"
        )
    name = settings.dataset or "".join(frames)
    if name in frames:
        settings = settings.model_copy(
            update={"dataset": name, "times": settings.times or NO_TIMES}
        )
    chosen = choose_arrays(
        path, shapes, settings, lambda name: name not in cells and _is_pair(file, name)
    )
    arrays = {
        name: (
            FrameFiles([_column(file, part) for part in cells[name]])
            if name in cells
            else _column(file, name)
        )
        for name in chosen[:3]
        if name is not None
    }
    if chosen.samples not in frames:
        return Arrays(chosen, arrays)
    header = read_sparse_iq(file, chosen.samples, settings.subsweep)
    if header is not None:
        arrays[chosen.samples] = PointsOfArray(arrays[chosen.samples], header.points)
    return Arrays(chosen, arrays, header)


def _is_pair(file: UntrustedFile, name: str) -> bool:
    """Whether a dataset holds complex numbers."""
    return file.samples(name.strip("/")).parts == 2


def _column(file: UntrustedFile, name: str) -> Samples:
    """Open a dataset of numbers, of whose pairs I comes first."""
    column = file.samples(name.strip("/"))
    fields = column.dtype.names
    return SwappedPairs(column) if fields and is_quadrature_first(fields) else column


def _open_mat(path: Path, files: CaptureFiles) -> Arrays:
    """Open the arrays of a .mat file: HDF5 from version 7.3 on."""
    with path.open("rb") as file:
        is_hdf5 = file.read(10) == b"MATLAB 7.3"
    if is_hdf5:
        return _open_hdf5(path, files)
    return Arrays(*open_mat5(path, files.settings, len(files.paths)))


def _seconds(array: Samples, name: str, path: Path) -> tuple[np.ndarray, str | None]:
    """Read the times of the pulses [pulse], s, and what was assumed of them."""
    if prod(array.shape) > MAX_TIMES or array.parts != 1:
        raise CaptureError(f"{array.where}: should be times, a real number for every pulse")
    values = array.read(tuple(slice(0, n) for n in array.shape)).astype(float).ravel()
    return seconds_of(values, name, str(path))


def _open_with(
    open_file: Callable[[Path, CaptureFiles], Arrays], of_matlab: bool = False
) -> Callable[[CaptureFiles], Source]:
    """Make the function that opens a format, of one that opens the arrays of a file."""

    def samples_of(names: ArrayNames, arrays: Mapping[str, Samples]) -> Samples:
        samples = arrays[names.samples]
        return samples if names.imaginary is None else PairedArray(samples, arrays[names.imaginary])

    def open_arrays(capture: CaptureFiles) -> Source:
        opened = [open_file(path, capture) for path in capture.paths]
        frames = [samples_of(names, arrays) for names, arrays, _ in opened]
        settings, path = capture.settings, capture.paths[0]
        for frame in frames:
            refuse_array_of_points(frame)
        header = opened[0].header
        if header is not None and settings.axes is None and len(frames) == 1:
            settings = settings.model_copy(update={"axes": header.axes})
        if len(frames) > 1:
            axes = tuple(name for name in settings.axes or () if name != "frame") or None
            cut = settings.model_copy(update={"axes": axes})
            frames = [cut_axes(frame, cut) if axes else frame for frame in frames]
        samples = frames[0] if len(frames) == 1 else FrameFiles(frames)
        if isinstance(samples, FrameFiles):
            settings = settings_with_frames(settings, of_matlab)
        source = as_source(path, samples, settings, None, of_matlab)
        source = replace(source, files=tuple(capture.paths))
        names, arrays, _ = opened[0]
        if header is not None:
            known = {**header.settings, **source.settings}
            source = replace(source, settings=known, notes=(*source.notes, *header.notes))
        if names.times is None or len(opened) > 1:
            return source
        is_clock = names.are_times_named or (
            settings.prf_hz is None and prod(arrays[names.times].shape) == source.pulses
        )
        if not is_clock:
            return source
        times, note = _seconds(arrays[names.times], names.times, path)
        notes = [note] if note else []
        if not names.are_times_named:
            notes.append(f"times of the pulses: {names.times} (times=none leaves them out)")
        return replace(source, times=times, notes=(*source.notes, *notes))

    return open_arrays


NPY = CaptureFormat(
    ".npy",
    lambda path, head: head.startswith(b"\x93NUMPY"),
    _open_with(_open_npy),
    is_split=True,
)
NPZ = CaptureFormat(
    ".npz", lambda path, head: head.startswith(b"PK"), _open_with(_open_npz), is_split=True
)
MAT = CaptureFormat(
    ".mat",
    lambda path, head: head.startswith(b"MATLAB"),
    _open_with(_open_mat, of_matlab=True),
    is_split=True,
)
HDF5 = CaptureFormat(
    "HDF5", lambda path, head: head.startswith(b"\x89HDF"), _open_with(_open_hdf5), is_split=True
)
RAW = CaptureFormat(
    "numbers of a type (with --set dtype=int16)",
    lambda path, head: False,  # nothing marks them
    _open_with(_open_raw),
    is_split=True,
)
