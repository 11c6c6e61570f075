"""Captures that are .mat files of version 5 to 7: arrays, structs and cells, without objects."""

import struct
import zlib
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import regular_size
from radhar_cli.readers.captures.named_arrays import ArrayNames, choose_arrays
from radhar_cli.readers.captures.packed_files import MAX_PACKING
from radhar_cli.readers.captures.parser_errors import parser_errors_as_capture_errors
from radhar_cli.readers.captures.settings import CaptureSettings
from radhar_cli.readers.captures.stored_arrays import FrameFiles, Samples, StoredArray

MAX_MAT5 = 2**30  # bytes: SciPy holds a variable of the old format whole
DEEPEST_STRUCT = 8
BLOCK = 2**20  # bytes that are unpacked at once
MATLAB_NUMBERS = {"double", "single", *(f"{u}int{n}" for u in ("", "u") for n in (8, 16, 32, 64))}


def open_mat5(
    path: Path, settings: CaptureSettings, share: int = 1
) -> tuple[ArrayNames, dict[str, Samples]]:
    """Open the arrays of a .mat file of version 5 to 7.

    Args:
        path: the file.
        settings: header of the capture.
        share: number of files of the capture, which share the memory.

    Returns:
        Names of the arrays that are read, and these arrays, their axes reversed.

    Raises:
        CaptureError: it is damaged, or nothing tells which array holds the samples.
    """
    from scipy.io import loadmat, whosmat

    with parser_errors_as_capture_errors(str(path)):
        _check_mat5(path, share)
        kinds = whosmat(str(path), appendmat=False)
        shapes = {name: shape for name, shape, kind in kinds if kind in MATLAB_NUMBERS}
        holders = [name for name, _, kind in kinds if kind in ("struct", "cell")]
        parts = dict[str, list[NDArray[Any]]]()
        if holders:
            values = loadmat(str(path), appendmat=False, variable_names=holders)
            for name in holders:
                _list_fields(values[name], name, parts)
            shapes |= {name: _shape_of(arrays) for name, arrays in parts.items()}
        others = [name for name, _, kind in kinds if kind in ("opaque", "object", "function")]
        advice = f"; {', '.join(others)}: save tables and objects as arrays" if others else ""
        loaded = {name: arrays[0] for name, arrays in parts.items() if len(arrays) == 1}

        def is_complex(name: str) -> bool:
            if name not in parts and name not in loaded:
                loaded[name] = loadmat(str(path), appendmat=False, variable_names=[name])[name]
            return np.iscomplexobj(parts[name][0] if name in parts else loaded[name])

        names = choose_arrays(path, shapes, settings, is_complex, advice)
        top = [n for n in names[:3] if n is not None and n not in parts and n not in loaded]
        loaded |= loadmat(str(path), appendmat=False, variable_names=top) if top else {}
        return names, {n: _array_of(path, n, parts, loaded) for n in names[:3] if n is not None}


def _array_of(
    path: Path,
    name: str,
    parts: Mapping[str, Sequence[NDArray[Any]]],
    loaded: Mapping[str, NDArray[Any]],
) -> Samples:
    """Array of a name; of cells or structs, whose arrays are frames, an array of all of them."""
    arrays = parts[name] if name in parts else [loaded[name]]
    stored = [StoredArray(f"{path}: {name}", partial(np.transpose, values)) for values in arrays]
    return stored[0] if len(stored) == 1 else FrameFiles(stored)


def _shape_of(arrays: Sequence[NDArray[Any]]) -> tuple[int, ...]:
    """Shape of an array, or of several, which are frames."""
    return arrays[0].shape if len(arrays) == 1 else (*arrays[0].shape, len(arrays))


def _list_fields(
    values: NDArray[Any], name: str, parts: dict[str, list[NDArray[Any]]], depth: int = 0
) -> None:
    """List the arrays of numbers in a struct or cells of MATLAB, by dotted names.

    Args:
        values: the struct, the cells, or what one of its fields holds.
        name: its name.
        parts: {name: arrays}, to which they are added; those of several structs or cells of one
            name follow one another.
        depth: in how many structs it lies.
    """
    if values.dtype.names is None and values.dtype.kind in "iufc":
        if values.size > 1:
            parts.setdefault(name, []).append(values)
        return
    if depth >= DEEPEST_STRUCT:
        return
    for item in values.reshape(-1, order="F"):
        for field in values.dtype.names or ("",):
            value = item[field] if field else item
            if isinstance(value, np.ndarray):
                _list_fields(value, f"{name}.{field}" if field else name, parts, depth + 1)


def _check_mat5(path: Path, share: int) -> None:
    """Unpack a .mat file of the old format block by block, to see how large it becomes.

    One of several files may take its share of MAX_MAT5.

    An element: its type and size, 4 bytes each, then its bytes; type 15 is compressed.
    """
    size = regular_size(path)
    limit = left = min(MAX_MAT5 // share, MAX_PACKING * size)
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
