"""Captures that are arrays: .npy, .npz, .mat (v5 and v7.3) and HDF5.

They are not trusted: nothing is unpickled, MATLAB objects are refused, and what a file unpacks to
is bounded.
"""

import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.capture.named_parts import find_pair
from radhar_cli.capture.packed_files import MAX_PACKING
from radhar_cli.capture.settings import USUAL_AXES, AxisName, CaptureSettings
from radhar_cli.capture.source import CaptureFiles, CaptureFormat, Parts, Source
from radhar_cli.dataset.untrusted_hdf5 import NumberColumn, UntrustedFile
from radhar_cli.errors import CaptureError, FolderError, did_you_mean
from radhar_cli.files.untrusted import regular_size
from radhar_cli.numerics.arrays import Float

MAX_RECEIVERS = 1024
MAX_MAT5 = 2**30  # bytes: SciPy holds a variable of the old format whole
MAX_TIMES = 2**24
DEEPEST_STRUCT = 8
BLOCK = 2**20  # bytes that are unpacked at once
MATLAB_NUMBERS = {"double", "single", *(f"{u}int{n}" for u in ("", "u") for n in (8, 16, 32, 64))}
_ORDER: tuple[AxisName, ...] = ("transmitter", "receiver", "sample", "frame", "pulse", "iq")


class StoredArray:
    """Array of a capture, read in blocks like `NumberColumn`.

    Args:
        where: file and array, for messages.
        load: function that maps the array, or returns it.

    Raises:
        CaptureError: it cannot be read, or does not hold numbers.
    """

    def __init__(self, where: str, load: Callable[[], NDArray[Any]]) -> None:
        with parser_errors_as_capture_errors(where):
            values = load()
        self.where, self.load, self.shape = where, load, values.shape
        self.number = values.real.dtype.newbyteorder("=")
        self.parts, self.chunk = 1 + (values.dtype.kind == "c"), (1,) * values.ndim
        if values.dtype.kind not in "iufc" or self.number.itemsize > 8:
            raise CaptureError(f"{where}: is of the type {values.dtype}; should be numbers")
        if not values.ndim or not values.size:
            raise CaptureError(f"{where}: has the shape {values.shape}; should hold numbers")

    def read(self, key: tuple[slice, ...]) -> NDArray[Any]:
        """Read a block [..., part]; files are mapped again for each, which releases memory."""
        block = np.ascontiguousarray(self.load()[key])
        native = block.astype(block.dtype.newbyteorder("="), copy=False)
        return native.view(self.number).reshape(*block.shape, self.parts)


class PairedArray(StoredArray):
    """Two arrays of one shape, I and Q, as one of complex numbers.

    Args:
        real: I.
        imaginary: Q.

    Raises:
        CaptureError: they differ, or are complex.
    """

    def __init__(self, real: "StoredArray | NumberColumn", imaginary: "StoredArray | NumberColumn"):
        if real.shape != imaginary.shape or real.parts + imaginary.parts != 2:
            raise CaptureError(
                f"{imaginary.where}: has the shape {[*imaginary.shape]}; should be real numbers of "
                f"the shape {[*real.shape]}, as I in {real.where}"
            )
        self.where, self.shape, self.chunk = real.where, real.shape, real.chunk
        self.halves, self.parts = (real, imaginary), 2
        self.number = np.result_type(real.number, imaginary.number)

    def read(self, key: tuple[slice, ...]) -> NDArray[Any]:
        """Read a block [..., part] of both."""
        blocks = [half.read(key)[..., 0] for half in self.halves]
        return np.stack(blocks, axis=-1).astype(self.number, copy=False)


class FrameFiles(StoredArray):
    """Arrays of one shape in files of their own, as an array whose first axis numbers the files.

    Args:
        arrays: the arrays, in order.

    Raises:
        CaptureError: they differ in shape or type.
    """

    def __init__(self, arrays: Sequence["StoredArray | NumberColumn"]) -> None:
        first = arrays[0]
        for array in arrays[1:]:
            same = array.shape == first.shape and array.number == first.number
            if not same or array.parts != first.parts:
                raise CaptureError(
                    f"{array.where}: has the shape {[*array.shape]} of {array.number}; should be "
                    f"{[*first.shape]} of {first.number}, as {first.where}: a file a frame"
                )
        self.arrays, self.where, self.parts = arrays, first.where, first.parts
        self.shape, self.number = (len(arrays), *first.shape), first.number
        self.chunk = (1,) * len(self.shape)

    def read(self, key: tuple[slice, ...]) -> NDArray[Any]:
        """Read a block [file, ..., part]."""
        return np.stack([array.read(key[1:]) for array in self.arrays[key[0]]])


def _npy_files(files: CaptureFiles) -> list[StoredArray | NumberColumn]:
    """Map the array of a .npy file, or those of several, a frame each."""
    arrays = [_npy(path, str(path)) for path in files.paths]
    return [*arrays] if len(arrays) == 1 else [FrameFiles(arrays)]


def _npy(path: Path, where: str) -> StoredArray | NumberColumn:
    """Map the array of a .npy file."""
    return StoredArray(where, partial(np.load, path, mmap_mode="r", allow_pickle=False))


def _npz(path: Path, settings: CaptureSettings, scratch: Path) -> list[StoredArray | NumberColumn]:
    with parser_errors_as_capture_errors(str(path)), zipfile.ZipFile(path) as archive:
        shapes = {n: shape for n, (shape, kind) in check_npz(archive).items() if kind in "iufc"}
        files = {name.removesuffix(".npy"): name for name in archive.namelist()}
        return [
            _npy(Path(archive.extract(files[name], scratch)), f"{path}: {name}")
            for name in _chosen(path, shapes, settings)
        ]


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
            form = np.lib.format
            old = form.read_magic(file) == (1, 0)
            read = form.read_array_header_1_0 if old else form.read_array_header_2_0
            shape, _, dtype = read(file)
        if not dtype.hasobject and prod(shape) * dtype.itemsize > member.file_size:
            raise ValueError(f"{member.filename} has the shape {shape}, but too few bytes")
        arrays[member.filename.removesuffix(".npy")] = shape, dtype.kind
    return arrays


def _hdf5(path: Path, settings: CaptureSettings) -> list[StoredArray | NumberColumn]:
    file = UntrustedFile(path)
    named = settings.dataset, settings.times, settings.imaginary
    names = list(dict.fromkeys([*file.numeric_paths(), *filter(None, named)]))
    shapes = {name: tuple(file.shape(name.strip("/"))) for name in names}
    return [file.samples(name.strip("/")) for name in _chosen(path, shapes, settings)]


def _mat(path: Path, settings: CaptureSettings) -> list[StoredArray | NumberColumn]:
    """Open the arrays of a .mat file: HDF5 from version 7.3 on."""
    with path.open("rb") as file:
        is_hdf5 = file.read(10) == b"MATLAB 7.3"
    return _hdf5(path, settings) if is_hdf5 else _mat5(path, settings)


def _mat5(path: Path, settings: CaptureSettings) -> list[StoredArray | NumberColumn]:
    from scipy.io import loadmat, whosmat

    with parser_errors_as_capture_errors(str(path)):
        _check_mat5(path)
        kinds = whosmat(str(path), appendmat=False)
        shapes = {name: shape for name, shape, kind in kinds if kind in MATLAB_NUMBERS}
        structs = [name for name, _, kind in kinds if kind == "struct"]
        loaded = dict[str, NDArray[Any]]()
        if structs:
            fields = loadmat(str(path), appendmat=False, variable_names=structs)
            for name in structs:
                loaded |= _fields(fields[name], name)
            shapes |= {name: values.shape for name, values in loaded.items()}
        names = _chosen(path, shapes, settings)
        top = [name for name in names if name not in loaded]
        loaded |= loadmat(str(path), appendmat=False, variable_names=top) if top else {}
        return [StoredArray(f"{path}: {n}", partial(np.transpose, loaded[n])) for n in names]


def _fields(values: NDArray[Any], name: str, depth: int = 0) -> dict[str, NDArray[Any]]:
    """Arrays of numbers in a struct of MATLAB, by dotted names.

    Args:
        values: the struct, or what one of its fields holds.
        name: its name.
        depth: in how many structs it lies.
    """
    if values.dtype.names is not None and values.size == 1 and depth < DEEPEST_STRUCT:
        inner = dict[str, NDArray[Any]]()
        for field in values.dtype.names:
            value = values.reshape(-1)[0][field]
            if isinstance(value, np.ndarray):
                inner |= _fields(value, f"{name}.{field}", depth + 1)
        return inner
    return {name: values} if values.dtype.kind in "iufc" and values.size > 1 else {}


def _check_mat5(path: Path) -> None:
    """Unpack a .mat file of the old format block by block, to see how large it becomes.

    An element: its type and size, 4 bytes each, then its bytes; type 15 is compressed.
    """
    size = regular_size(path)
    limit = left = min(MAX_MAT5, MAX_PACKING * size)
    with path.open("rb") as file:
        order = "<" if file.read(128)[126:] == b"IM" else ">"
        while head := file.read(8):
            kind, count = struct.unpack(f"{order}II", head)
            end = file.tell() + count
            if end > size:
                raise CaptureError(f"{path}: ends in the middle of a variable; truncated?")
            if kind == 15:
                reader, count = zlib.decompressobj(), 0
                while count <= left and (
                    block := reader.unconsumed_tail or file.read(min(BLOCK, end - file.tell()))
                ):
                    count += len(reader.decompress(block, BLOCK))
            file.seek(end)
            left -= count
            if left < 0:
                raise CaptureError(
                    f"{path}: holds more than {limit} bytes when unpacked; save it with -v7.3"
                )


def _chosen(path: Path, shapes: dict[str, tuple[int, ...]], settings: CaptureSettings) -> list[str]:
    """Choose the array of the samples (named, or the only one it can be), and that of the times.

    Where I and Q are apart, that of Q comes last.
    """
    names = settings.dataset, settings.times, settings.imaginary
    named_arrays = [name for name in names if name is not None]
    for name in named_arrays:
        if name not in shapes:
            hint = did_you_mean(name, shapes, f"there are {', '.join(shapes) or 'none'}")
            raise CaptureError(f"{path}: {name}: no such array of numbers; {hint}")
    if settings.dataset is not None:
        return named_arrays
    pair = find_pair([name for name, shape in shapes.items() if prod(shape) > 1])
    if pair is not None and shapes[pair[0]] == shapes[pair[1]]:
        return [pair[0], *named_arrays, pair[1]]
    candidates = [
        name for name, shape in shapes.items() if len(shape) > 1 and prod(shape) > max(shape)
    ]
    candidates = candidates or [name for name, shape in shapes.items() if prod(shape) > 1]
    if len(candidates) != 1:
        known_arrays = (
            ", ".join(f"{name} {list(shape)}" for name, shape in shapes.items()) or "none"
        )
        raise CaptureError(
            f"{path}: --set dataset=NAME should name the samples, or dataset=NAME and "
            f"imaginary=NAME I and Q; there are {known_arrays}"
        )
    return [*candidates, *named_arrays]


def _times(array: StoredArray | NumberColumn) -> Float:
    """Read the times of the pulses [pulse], s."""
    if prod(array.shape) > MAX_TIMES or array.parts != 1:
        raise CaptureError(f"{array.where}: should be times, a real number for every pulse")
    return array.read(tuple(slice(0, n) for n in array.shape)).astype(float).ravel()


@dataclass(frozen=True)
class ArrayPulses:
    """Pulses of an array whose axes have names; those of transmitters that take turns are sorted.

    Raises:
        CaptureError: the axes do not hold whole pulses.
    """

    array: StoredArray | NumberColumn
    axes: tuple[AxisName, ...]  # of the array, outermost first
    transmitters: int

    def __post_init__(self) -> None:
        iq = self.sizes.get("iq")
        if iq is not None and (iq != 2 or self.array.parts == 2):
            raise CaptureError(
                f"{self.array.where}: the axis iq has {iq}; should have 2, real numbers"
            )
        if self.count == 0 or ("frame" in self.axes and self.per_frame % self.turns):
            raise CaptureError(
                f"{self.array.where}: the axis pulse has {self.per_frame} chirps; should have a "
                f"multiple of transmitters = {self.transmitters}"
            )

    @cached_property
    def sizes(self) -> dict[AxisName, int]:
        """Size of each axis."""
        return dict(zip(self.axes, self.array.shape, strict=True))

    @property
    def parts(self) -> int:
        """2 of complex samples, 1 of real ones."""
        return self.sizes.get("iq", self.array.parts)

    @property
    def turns(self) -> int:
        """Number of transmitters that take turns along the axis pulse."""
        return 1 if "transmitter" in self.axes else self.transmitters

    @property
    def per_frame(self) -> int:
        """Number of chirps along the axis pulse."""
        return self.sizes["pulse"]

    @property
    def chirps(self) -> int:
        """Number of chirps of all transmitters that take turns."""
        return self.per_frame * self.sizes.get("frame", 1)

    @property
    def count(self) -> int:
        """Number of pulses of each transmitter."""
        return self.chirps // self.turns

    def read(self, first: int, stop: int) -> Parts:
        """Read pulses [virtual receiver, sample, stop - first, part] from first to stop - 1."""
        pieces = _by_frame(first * self.turns, stop * self.turns, self.per_frame)
        blocks = [self._chirps(*frames_and_pulses) for frames_and_pulses in pieces]
        block = blocks[0] if len(blocks) == 1 else np.concatenate(blocks, axis=3)
        block = block.reshape(*block.shape[:3], -1, self.turns, self.parts)
        return np.moveaxis(block, 4, 0).reshape(-1, block.shape[2], stop - first, self.parts)

    def _chirps(self, frames: slice, pulses: slice) -> Parts:
        """Read chirps [transmitter, receiver, sample, chirp, part]: of frames, some pulses each."""
        chosen = {"frame": frames, "pulse": pulses}
        key = tuple(chosen.get(name, slice(0, self.sizes[name])) for name in self.axes)
        block = self.array.read(key)
        block = block[..., 0] if "iq" in self.axes else block
        present = [self.axes.index(name) for name in _ORDER if name in self.axes]
        block = block.transpose(*present, *range(len(self.axes), block.ndim))
        return block.reshape(*(self.sizes.get(name, 1) for name in _ORDER[:3]), -1, self.parts)


def as_source(
    path: Path,
    array: StoredArray | NumberColumn,
    settings: CaptureSettings,
    times: Float | None = None,
    of_matlab: bool = False,
) -> Source:
    """Make a source of an array, whose axes are put in order.

    Args:
        path: the file.
        array: samples; a last axis `iq` or complex numbers have two parts.
        settings: header of the capture, and the names of the axes.
        times: times of the pulses [pulse], s, if the capture contains them.
        of_matlab: whether the axes are reversed, as MATLAB stores them in HDF5.

    Raises:
        CaptureError: the axes do not fit the header.
    """
    axes = _axes(array, settings, of_matlab)
    sizes = dict(zip(axes, array.shape, strict=True))
    transmitters = sizes.get("transmitter", settings.transmitters)
    pulses = ArrayPulses(array, axes, transmitters)
    has_frames = "frame" in axes
    incomplete = pulses.chirps % pulses.turns
    notes = [f"the last {incomplete} chirps (an incomplete transmitter cycle) are left out"]
    notes = notes if incomplete else []
    if settings.axes is None and "iq" in axes:
        notes.append("the last axis, of two real numbers, is I and Q (axes=[...] says otherwise)")
    chunk = array.chunk[axes.index("frame" if has_frames else "pulse")]
    return Source(
        (path,),
        transmitters * sizes.get("receiver", 1),
        sizes.get("sample"),
        pulses.count,
        array.number,
        pulses.parts,
        pulses.read,
        times=times,
        step=max(chunk * (pulses.per_frame if has_frames else 1) // pulses.turns, 1),
        settings={"frame_pulses": pulses.per_frame // pulses.turns} if has_frames else {},
        notes=tuple(notes),
    )


def _open_with(
    arrays_of: Callable[[CaptureFiles], list[StoredArray | NumberColumn]], of_matlab: bool
) -> Callable[[CaptureFiles], Source]:
    """Make the function that opens a format, of one that opens its arrays: samples and times."""

    def open_arrays(capture: CaptureFiles) -> Source:
        arrays, settings = arrays_of(capture), capture.settings
        samples, others = arrays[0], arrays[1:]
        times = _times(others.pop(0)) if settings.times is not None and others else None
        if others:
            samples = PairedArray(samples, others[0])
        if len(capture.paths) > 1:
            settings = _with_frames(samples, settings)
        return replace(
            as_source(capture.paths[0], samples, settings, times, of_matlab),
            files=tuple(capture.paths),
        )

    return open_arrays


def _with_frames(array: StoredArray | NumberColumn, settings: CaptureSettings) -> CaptureSettings:
    """Settings whose axes begin with that of the frames, a file each.

    Raises:
        CaptureError: axes are not named, and not the usual ones of a frame.
    """
    usual: dict[int, tuple[AxisName, ...]] = {3: ("frame", "sample", "pulse")}
    axes = settings.axes or usual.get(len(array.shape)) or USUAL_AXES.get(len(array.shape), ())
    if settings.axes is not None and "frame" not in axes:
        axes = ("frame", *axes)
    return settings.model_copy(update={"axes": axes})


NPY = CaptureFormat(
    ".npy",
    lambda path, head: head.startswith(b"\x93NUMPY"),
    _open_with(_npy_files, of_matlab=False),
    is_split=True,
)
NPZ = CaptureFormat(
    ".npz",
    lambda path, head: head.startswith(b"PK"),
    _open_with(lambda files: _npz(files.paths[0], files.settings, files.scratch), of_matlab=False),
)
MAT = CaptureFormat(
    ".mat",
    lambda path, head: head.startswith(b"MATLAB"),
    _open_with(lambda files: _mat(files.paths[0], files.settings), of_matlab=True),
)
HDF5 = CaptureFormat(
    "HDF5",
    lambda path, head: head.startswith(b"\x89HDF"),
    _open_with(lambda files: _hdf5(files.paths[0], files.settings), of_matlab=False),
)


def _by_frame(low: int, high: int, per_frame: int) -> Iterator[tuple[slice, slice]]:
    """Yield (frames, pulses of each) that together are chirps low .. high - 1, and no others."""
    while low < high:
        frame, pulse = divmod(low, per_frame)
        whole_frames = (high - low) // per_frame if pulse == 0 else 0
        stop = per_frame if whole_frames else min(per_frame, pulse + high - low)
        yield slice(frame, frame + max(whole_frames, 1)), slice(pulse, stop)
        low += whole_frames * per_frame or stop - pulse


def _axes(
    array: StoredArray | NumberColumn, s: CaptureSettings, of_matlab: bool
) -> tuple[AxisName, ...]:
    """Names of the axes of an array, in the order of the file."""
    shape = array.shape[::-1] if of_matlab else array.shape
    axes = s.axes or _usual_axes(array.parts, shape, s)
    if of_matlab and s.axes is None and len(shape) == 2 and 1 in shape:  # a vector of MATLAB's
        axes = ("receiver", "pulse") if shape[0] == 1 else ("pulse", "receiver")
    sizes = dict(zip(axes, shape, strict=False))
    expected_sizes: dict[AxisName, int | None] = {
        "sample": s.samples,
        "receiver": s.receivers,
        "transmitter": s.transmitters if s.transmitters > 1 else None,
        "pulse": s.frame_pulses if "frame" in axes else None,
    }
    problems = [
        f"{n} should have {v}" for n, v in expected_sizes.items() if v and sizes.get(n, v) != v
    ]
    if sizes.get("sample") == 1:
        problems.append("sample should have 2 or more")
    if sizes.get("receiver", 1) > MAX_RECEIVERS:
        problems.append(f"receiver should have at most {MAX_RECEIVERS}")
    if problems or len(axes) != len(shape):
        problem = f"; {problems[0]}" if problems else ""
        raise CaptureError(
            f"{array.where}: has {len(shape)} axes, {list(shape)}, read as axes = {[*axes]}"
            f"{problem}; --set axes=[...] should name each, outermost first"
        )
    return axes[::-1] if of_matlab else axes


def _usual_axes(parts: int, shape: tuple[int, ...], s: CaptureSettings) -> tuple[AxisName, ...]:
    """Names of axes that nobody has named; a last one of two real numbers is I and Q.

    Args:
        parts: 2 of complex numbers, 1 of real ones.
        shape: sizes of the axes.
        s: header of the capture.
    """
    others = USUAL_AXES.get(len(shape) - 1)
    is_pair = parts == 1 and len(shape) > 1 and shape[-1] == 2 and shape[0] > 2
    if is_pair and others is not None and s.receivers != 2 and s.complex:
        return (*others, "iq")
    return USUAL_AXES.get(len(shape), ())


@contextmanager
def parser_errors_as_capture_errors(source: str) -> Iterator[None]:
    """Turn errors of the parsers of NumPy, SciPy and zipfile into a CaptureError.

    Args:
        source: file, or file and array, for the message.
    """
    try:
        with np.errstate(over="raise"):
            yield
    except (CaptureError, FolderError):
        raise
    except Exception as error:  # they raise whatever they meet
        reason = getattr(error, "strerror", None) or str(error).partition("\n")[0]
        raise CaptureError(f"{source}: cannot be read ({reason or type(error).__name__})") from None
