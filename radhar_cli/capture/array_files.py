"""Captures that are arrays: .npy, .npz, .mat (v5 and v7.3) and HDF5.

They are not trusted. Nothing is unpickled; objects of MATLAB are refused; what is packed is
unpacked piece by piece and no further than its header promises.
"""

import os
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.arrays import Float
from radhar_cli.capture.settings import USUAL_AXES, AxisName, CaptureSettings
from radhar_cli.capture.source import Parts, Source
from radhar_cli.dataset.untrusted_hdf5 import Numbers, UntrustedFile
from radhar_cli.errors import CaptureError, FolderError, did_you_mean
from radhar_cli.untrusted import regular_size

MAX_RECEIVERS = 1024
BLOCK = 2**20  # bytes that are unpacked at once
MAX_HEADER = 10_000  # characters of the header of an .npy
MAX_PACKING = 200  # times that a file may grow when it is unpacked
MAX_MAT5 = 2**30  # bytes: SciPy holds a variable of the old format whole
NUMBERS_OF_MATLAB = {
    *("double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"),
}
_ORDER: tuple[AxisName, ...] = ("transmitter", "receiver", "sample", "frame", "pulse", "iq")
HDF5_SIGNATURE, MAT73 = b"\x89HDF", b"MATLAB 7.3"


@dataclass(frozen=True)
class Array:
    """An array in a file, read in blocks.

    Attributes:
        where: file and name, for messages.
        shape: without the parts of a complex number.
        number: type of the numbers.
        parts: 2 of complex numbers, 1 of real ones.
        read: block [..., part] for a slice of every axis.
        chunk: what is best read together.
    """

    where: str
    shape: tuple[int, ...]
    number: np.dtype[Any]
    parts: int
    read: Callable[[tuple[slice, ...]], NDArray[Any]]
    chunk: tuple[int, ...]


def open_arrays(path: Path, settings: CaptureSettings, scratch: Path) -> Source:
    """Open a capture that is an array.

    Args:
        path: of the file; its first bytes tell the format.
        settings: which dataset, what its axes mean.
        scratch: folder for what has to be unpacked.

    Raises:
        CaptureError, FolderError: it cannot be read, or is not what the settings say.
    """
    try:
        regular_size(path)
        with path.open("rb") as file:
            head = file.read(128)
    except OSError as error:
        raise CaptureError(f"{path}: {error.strerror}") from None
    if head.startswith(b"\x93NUMPY"):
        array, times = npy_array(path, str(path)), None
    elif head.startswith(b"PK"):
        array, times = _npz(path, settings, scratch)
    elif head.startswith((HDF5_SIGNATURE, MAT73)):
        array, times = _hdf5(path, settings, head.startswith(MAT73))
    elif head.startswith(b"MATLAB 5.0"):
        array, times = _mat5(path, settings)
    else:
        raise CaptureError(
            f"{path}: is not a capture that radhar reads; should be .npy, .npz, .mat, HDF5, SigMF, "
            "or .bin of a DCA1000 with --radar"
        )
    return as_source(path, array, settings, times)


def as_source(
    path: Path, array: Array, settings: CaptureSettings, times: Float | None = None
) -> Source:
    """An array as a source, its axes put in order.

    Raises:
        CaptureError: the axes do not fit the array.
    """
    axes = _axes(array, settings)
    sizes = dict(zip(axes, array.shape, strict=True))
    parts = sizes.get("iq", array.parts)
    if "iq" in sizes and (parts != 2 or array.parts == 2):
        raise CaptureError(f"{array.where}: the axis iq has {parts}; should have 2, real numbers")
    _check_sizes(array, axes, sizes, settings)
    turns = sizes.get("transmitter", settings.transmitters)
    per_frame = sizes["pulse"]
    chirps = per_frame * sizes.get("frame", 1)
    alternate = 1 if "transmitter" in sizes else turns
    pulses, rest = divmod(chirps, alternate)
    if pulses == 0 or ("frame" in sizes and per_frame % alternate):
        raise CaptureError(
            f"{array.where}: has {per_frame} chirps in the axis pulse, no whole number of turns of "
            f"transmitters = {turns}"
        )
    notes = [f"the last {rest} chirps are no whole turn of transmitters and are left out"]
    present = [axes.index(name) for name in _ORDER if name in axes]
    full = [sizes.get(name, 1) for name in _ORDER[:3]]

    def chirps_of(frames: slice | None, pulses: slice) -> Parts:
        """[transmitter, receiver, sample, chirp, part] of some frames, of those pulses of each."""
        key = [slice(0, size) for size in array.shape]
        key[axes.index("pulse")] = pulses
        if frames is not None:
            key[axes.index("frame")] = frames
        block = array.read(tuple(key))
        spare = [] if "iq" in sizes else [block.ndim - 1]  # the parts of complex numbers
        block = block[..., 0] if "iq" in sizes else block
        return block.transpose(*present, *spare).reshape(*full, -1, parts)

    def read(first: int, stop: int) -> Parts:
        low, high = first * alternate, stop * alternate
        if "frame" in sizes:
            chunks = [chirps_of(*where) for where in _by_frame(low, high, per_frame)]
            block = chunks[0] if len(chunks) == 1 else np.concatenate(chunks, axis=3)
        else:
            block = chirps_of(None, slice(low, high))
        if alternate > 1:
            block = block.reshape(*full, -1, alternate, parts)
            block = np.moveaxis(block, 4, 0)
        return block.reshape(-1, full[2], stop - first, parts)

    chunk = array.chunk[axes.index("frame" if "frame" in axes else "pulse")]
    settings_found: dict[str, Any] = {}
    if "frame" in sizes:
        settings_found["frame_pulses"] = per_frame // alternate
    return Source(
        (path,),
        turns * sizes.get("receiver", 1),
        sizes.get("sample"),
        pulses,
        array.number,
        parts,
        read,
        times=times,
        step=max(chunk * (per_frame if "frame" in axes else 1) // alternate, 1),
        settings=settings_found,
        notes=tuple(notes if rest else ()),
    )


def _by_frame(low: int, high: int, per_frame: int) -> Iterator[tuple[slice, slice]]:
    """(frames, pulses of each) that together are chirps low .. high - 1: no more is read."""
    while low < high:
        frame, at = divmod(low, per_frame)
        whole = (high - low) // per_frame if at == 0 else 0
        stop = per_frame if whole else min(per_frame, at + high - low)
        yield slice(frame, frame + max(whole, 1)), slice(at, stop)
        low += whole * per_frame or stop - at


def _axes(array: Array, settings: CaptureSettings) -> tuple[AxisName, ...]:
    given = settings.axes
    if given is None:
        given = USUAL_AXES.get(len(array.shape), ())
    if len(given) != len(array.shape):
        raise CaptureError(
            f"{array.where}: has {len(array.shape)} axes, {list(array.shape)}; --set axes=[...] "
            f"should name each, outermost first (axes = {[*given]})"
        )
    return given


def _check_sizes(
    array: Array, axes: tuple[AxisName, ...], sizes: dict[AxisName, int], s: CaptureSettings
) -> None:
    """Refuse axes whose lengths the header contradicts."""
    wanted: dict[AxisName, int | None] = {
        "sample": s.samples,
        "receiver": s.receivers,
        "transmitter": s.transmitters if s.transmitters > 1 else None,
        "pulse": s.frame_pulses if "frame" in axes else None,
    }
    if sizes.get("sample") == 1 or sizes.get("receiver", 1) > MAX_RECEIVERS:
        raise CaptureError(
            f"{array.where}: has the shape {list(array.shape)} with axes {[*axes]}; should have 2 "
            f"samples or more, and at most {MAX_RECEIVERS} receivers (--set axes=[...])"
        )
    for name, value in wanted.items():
        if value is None or sizes.get(name, value) == value:
            continue
        fits = [axis for axis, size in sizes.items() if size == value]
        hint = f"the axis named {fits[0]} has {value}" if fits else f"{name}s: {sizes[name]}"
        raise CaptureError(
            f"{array.where}: the axis {name} of {list(array.shape)} has {sizes[name]}, the header "
            f"says {value}; {hint} would fit"
        )


def npy_array(path: Path, where: str) -> Array:
    """An .npy file, mapped anew for every block so that what was read can be forgotten."""
    with refusing(where), path.open("rb") as file:
        shape, fortran, dtype = _header(file)
        offset = file.tell()
    number, parts = _number(dtype, where)
    size = prod(shape) * dtype.itemsize
    if not shape or size == 0 or size > regular_size(path) - offset:
        raise CaptureError(f"{where}: {list(shape)} of {dtype} does not fit the file; truncated?")

    def read(key: tuple[slice, ...]) -> NDArray[Any]:
        mapped = np.memmap(path, dtype, "r", offset, shape, "F" if fortran else "C")
        return _in_parts(np.asarray(mapped[key]), number, parts)

    return Array(where, shape, number, parts, read, (1,) * len(shape))


def _header(file: IO[bytes]) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    version = np.lib.format.read_magic(file)
    reader = {
        (1, 0): np.lib.format.read_array_header_1_0,
        (2, 0): np.lib.format.read_array_header_2_0,
    }.get(version)
    if reader is None:
        raise ValueError(f"version {version} of the format; should be 1.0 or 2.0")
    shape, fortran, dtype = reader(file, max_header_size=MAX_HEADER)
    return shape, fortran, dtype


def _number(dtype: np.dtype[Any], where: str) -> tuple[np.dtype[Any], int]:
    if dtype.kind in "iuf" and dtype.itemsize <= 8:
        return dtype.newbyteorder("="), 1
    if dtype.kind == "c" and dtype.itemsize <= 16:
        return np.dtype(f"f{dtype.itemsize // 2}"), 2
    raise CaptureError(f"{where}: is of the type {dtype}; should be real or complex numbers")


def _in_parts(values: NDArray[Any], number: np.dtype[Any], parts: int) -> NDArray[Any]:
    native = np.ascontiguousarray(values).astype(values.dtype.newbyteorder("="), copy=False)
    shape = values.shape
    return native.view(number).reshape(*shape, parts) if parts == 2 else native[..., None]


def _npz(path: Path, settings: CaptureSettings, scratch: Path) -> tuple[Array, Float | None]:
    with refusing(str(path)), zipfile.ZipFile(path) as archive:
        members = {one.filename.removesuffix(".npy"): one for one in archive.infolist()}
        shapes = {n: shape for n, (shape, kind) in check_npz(archive).items() if kind in "iufc"}
        chosen = _chosen(path, shapes, settings)
        times = None
        if settings.times is not None:
            where = f"{path}: {settings.times}"
            _chosen(path, shapes, settings.model_copy(update={"dataset": settings.times}))
            unpacked = _unpacked(archive, members[settings.times], scratch / "times.npy")
            times = _all_of(npy_array(unpacked, where))
        target = _unpacked(archive, members[chosen], scratch / "samples.npy")
    return npy_array(target, f"{path}: {chosen}"), times


def check_npz(archive: zipfile.ZipFile) -> dict[str, tuple[tuple[int, ...], str]]:
    """{name: (shape, kind of its type)} of the arrays of an .npz, read from their headers.

    Raises:
        ValueError: one is packed in another way than NumPy's, or too much, or is shorter than it
            says.
    """
    arrays: dict[str, tuple[tuple[int, ...], str]] = {}
    for one in archive.infolist():
        if one.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise ValueError(f"{one.filename} is packed in a way that NumPy does not use")
        if one.file_size > MAX_PACKING * max(one.compress_size, 1024):
            raise ValueError(f"{one.filename} is packed {MAX_PACKING}-fold or more")
        with archive.open(one) as file:
            shape, _, dtype = _header(file)
        if not dtype.hasobject and prod(shape) * dtype.itemsize > one.file_size:
            raise ValueError(f"{one.filename} says it has the shape {shape}, and holds less")
        arrays[one.filename.removesuffix(".npy")] = shape, dtype.kind
    return arrays


def _unpacked(archive: zipfile.ZipFile, member: zipfile.ZipInfo, target: Path) -> Path:
    with archive.open(member) as packed, target.open("wb") as out:
        while block := packed.read(BLOCK):
            out.write(block)
    return target


def _chosen(path: Path, shapes: dict[str, tuple[int, ...]], settings: CaptureSettings) -> str:
    """The dataset of the samples: the one asked for, or the only one that can be it."""
    if settings.dataset is not None:
        if settings.dataset in shapes:
            return settings.dataset
        known = did_you_mean(settings.dataset, shapes, f"there are {', '.join(shapes) or 'none'}")
        raise CaptureError(f"{path}: {settings.dataset}: no such array of numbers; {known}")
    large = [name for name, shape in shapes.items() if len(shape) > 1 and prod(shape) > max(shape)]
    large = large or [name for name, shape in shapes.items() if prod(shape) > 1]
    if len(large) != 1:
        told = ", ".join(f"{name} {list(shape)}" for name, shape in shapes.items()) or "none"
        raise CaptureError(f"{path}: --set dataset=NAME should name the samples; there are {told}")
    return large[0]


def _hdf5(path: Path, settings: CaptureSettings, of_matlab: bool) -> tuple[Array, Float | None]:
    """An HDF5 file; MATLAB's have their axes the other way round."""
    file = UntrustedFile(path)
    if settings.dataset is None:
        shapes = {name: tuple(file.shape(name)) for name in file.numeric_names()}
        name = _chosen(path, shapes, settings)
    else:
        name = settings.dataset.strip("/")
    times = (
        None if settings.times is None else _all_of(_stored(file.samples(settings.times), False))
    )
    return _stored(file.samples(name), of_matlab), times


def _stored(samples: Numbers, turned: bool) -> Array:
    if not turned:
        return Array(
            samples.where, samples.shape, samples.number, samples.parts, samples.read, samples.chunk
        )

    def read(key: tuple[slice, ...]) -> NDArray[Any]:
        block = samples.read(key[::-1])
        return block.transpose(*range(len(key) - 1, -1, -1), len(key))

    return Array(
        samples.where, samples.shape[::-1], samples.number, samples.parts, read, samples.chunk[::-1]
    )


def _mat5(path: Path, settings: CaptureSettings) -> tuple[Array, Float | None]:
    from scipy.io import loadmat, whosmat

    check_mat5(path)
    with refusing(str(path)):
        kinds = whosmat(str(path), appendmat=False)
        shapes = {name: shape for name, shape, kind in kinds if kind in NUMBERS_OF_MATLAB}
        chosen = _chosen(path, shapes, settings)
        names = [chosen, *([settings.times] if settings.times else [])]
        loaded = loadmat(str(path), appendmat=False, variable_names=names)
        if settings.times is not None and settings.times not in shapes:
            raise ValueError(f"{settings.times}: no such array of numbers")
    values = np.asarray(loaded[chosen])
    if 1 in values.shape and values.ndim == 2 and settings.axes is None:
        values = values.ravel()  # a vector of MATLAB's
    number, parts = _number(values.dtype, f"{path}: {chosen}")

    def read(key: tuple[slice, ...]) -> NDArray[Any]:
        return _in_parts(values[key], number, parts)

    times = None
    if settings.times is not None:
        times = np.asarray(loaded[settings.times], dtype=float).ravel()
    array = Array(f"{path}: {chosen}", values.shape, number, parts, read, (1,) * values.ndim)
    return array, times


def check_mat5(path: Path) -> None:
    """Unpack a .mat file of the old format without keeping it, to see how large it becomes.

    An element: its type and size, 4 bytes each, then its bytes; 15 is one that is packed.

    Raises:
        CaptureError: it is truncated, or grows beyond what SciPy is given to hold.
    """
    size = regular_size(path)
    most = min(MAX_MAT5, MAX_PACKING * size)
    if size > MAX_MAT5:
        raise CaptureError(f"{path}: is {size} bytes; should be at most {MAX_MAT5}, or saved -v7.3")
    with path.open("rb") as file:
        order = "little" if file.read(128)[126:] == b"IM" else "big"
        total = 0
        while head := file.read(8):
            kind = int.from_bytes(head[:4], order)  # type: ignore[arg-type]
            count = int.from_bytes(head[4:], order)  # type: ignore[arg-type]
            if len(head) < 8 or file.tell() + count > size:
                raise CaptureError(f"{path}: ends in the middle of a variable; truncated?")
            if kind == 15:
                total += _inflated_size(path, file, count, most - total)
            else:
                total += count
                file.seek(count, os.SEEK_CUR)
            if total > most:
                raise CaptureError(
                    f"{path}: holds more than {most} bytes when unpacked; save it with -v7.3"
                )


def _inflated_size(path: Path, file: IO[bytes], count: int, most: int) -> int:
    reader, total = zlib.decompressobj(), 0
    while count > 0:
        block = file.read(min(BLOCK, count))
        count -= len(block)
        while block and total <= most:
            try:
                total += len(reader.decompress(block, BLOCK))
            except zlib.error as error:
                raise CaptureError(f"{path}: is damaged ({error})") from None
            block = reader.unconsumed_tail
    return total


def _all_of(array: Array) -> Float:
    """All numbers of a small array, in one row."""
    if prod(array.shape) > 2**24 or array.parts != 1:
        raise CaptureError(f"{array.where}: should be times, a real number for every pulse")
    return array.read(tuple(slice(0, n) for n in array.shape)).astype(float).ravel()


@contextmanager
def refusing(where: str) -> Iterator[None]:
    """Errors of the parsers of NumPy, SciPy and zipfile as one of ours."""
    try:
        yield
    except (CaptureError, FolderError):
        raise
    except Exception as error:  # they raise whatever they meet
        told = getattr(error, "strerror", None) or str(error).partition("\n")[0]
        raise CaptureError(f"{where}: cannot be read ({told or type(error).__name__})") from None
