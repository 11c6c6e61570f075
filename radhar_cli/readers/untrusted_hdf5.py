"""HDF5 files that anyone may have written: the one place that opens them.

A file is tried in a process of its own first (`hdf5_check`), where HDF5 may crash, loop or take
memory. Then only what is asked for by name is read; the rest of the file does not matter. Each link
on the way is a hard one and each dataset lies in the file itself, so nothing leads to another file.
Types and shapes are checked before anything is read, and compressed pieces are inflated here, up to
the size that they should have: HDF5 would inflate them to any.
"""

import hashlib
import io
import os
import signal
import subprocess
import sys
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import islice
from math import prod
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import DTypeLike, NDArray

from radhar_cli.errors import FolderError
from radhar_cli.files.untrusted import Closing, parse_json, regular_size
from radhar_cli.readers import hdf5_check

# What h5py raises on a file whose structure is damaged.
_DAMAGED = (
    AttributeError,
    KeyError,
    OSError,
    OverflowError,
    RuntimeError,
    TypeError,
    ValueError,
    zlib.error,
)
DEEPEST_GROUP = 8
MAX_TEXT = 2**20
MAX_CELLS = 2**16
MAX_CHUNK = 2**27  # bytes of a chunk
_DEFLATE, _SHUFFLE = h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE
MOST_TRIED = 1000  # files: a variable holds 128 KiB
_TRIED = "RADHAR_TRIED_HDF5"  # files that this process, or one that started it, has tried


@contextmanager
def _damage_as_folder_error(where: str) -> Iterator[None]:
    """Turn errors of h5py on a damaged file into a FolderError that names `where`."""
    try:
        yield
    except _DAMAGED as error:
        raise FolderError(f"{where}: cannot be read, the file is damaged ({error})") from None


def try_files(paths: Sequence[Path]) -> None:
    """Read the structure of files in another process, which may crash or be killed.

    Raises:
        FolderError: a file is damaged, or takes too much memory or time.
    """
    if not paths:
        return
    names = b"".join(os.fsencode(path) + b"\0" for path in paths)
    process = subprocess.run(
        [sys.executable, "-P", hdf5_check.__file__],
        input=names,
        capture_output=True,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
    )
    if process.returncode == 0:
        return
    path = paths[len(process.stdout.split()) - 1]
    why = process.stderr.decode(errors="replace").strip().rpartition("\n")[2]
    if process.returncode == -signal.SIGXCPU:
        why = f"takes HDF5 more than {hdf5_check.SECONDS} s to open"
    elif process.returncode < 0:
        why = f"HDF5 crashes on it, {signal.Signals(-process.returncode).name}"
    raise FolderError(f"{path}: cannot be read, the file is damaged ({why})")


def remember(path: Path) -> None:
    """Remember that a file is sound: it is not tried again, here or in processes started later."""
    version = _version_of(path)
    others = [tried for tried in os.environ.get(_TRIED, "").split() if tried != version]
    os.environ[_TRIED] = " ".join([*others[1 - MOST_TRIED :], version])


def _version_of(path: Path) -> str:
    """Text that changes when a file is written or replaced."""
    status = path.stat()
    return f"{status.st_dev}:{status.st_ino}:{status.st_size}:{status.st_ctime_ns}"


DIGESTS = "attributes_sha256"


def attribute_digests(file: h5py.File) -> dict[str, str]:
    """Digest the attributes of each object in a file: {name: digest}, links left out.

    Shapes are not asked for: HDF5 would open the files that a virtual dataset names.
    """
    digests = {"/": _attribute_digest(file)}
    file.visititems(lambda name, item: digests.__setitem__(name, _attribute_digest(item)))
    return digests


def _attribute_digest(item: Any) -> str:
    """Digest of the attributes of a group or dataset."""
    attributes = dict[str, Any]()
    for name in sorted(item.attrs):
        if name != DIGESTS:
            plain = hdf5_check.is_plain(item.attrs.get_id(name))
            attributes[name] = np.asarray(item.attrs[name]).tolist() if plain else "another type"
    return hashlib.sha256(repr(attributes).encode()).hexdigest()[:16]


class UntrustedFile(Closing):
    """An HDF5 file, opened for reading.

    Args:
        path: path of the file, for messages too.
        data: bytes of a file that was made here or tried already; None reads the path.

    Raises:
        FolderError: it is no HDF5 file, or is damaged.
    """

    def __init__(self, path: Path, data: bytes | None = None) -> None:
        self.path = path
        self._claimed = 0
        try:
            self.bytes = regular_size(path) if data is None else len(data)
            if data is None and _version_of(path) not in os.environ.get(_TRIED, "").split():
                try_files([path])
                remember(path)
        except OSError as error:
            raise FolderError(f"{path}: {error.strerror}") from None
        try:
            self._file = h5py.File(path if data is None else io.BytesIO(data), "r")
        except _DAMAGED as error:
            raise FolderError(f"{path}: is not an HDF5 file, or is truncated ({error})") from None

    def has_attribute(self, name: str) -> bool:
        """Whether the root of the file has an attribute of that name."""
        with _damage_as_folder_error(f"{self.path}: attribute {name}"):
            return name in self._file.attrs

    def text(self, name: str) -> str:
        """Read a text attribute of the file.

        Raises:
            FolderError: it is missing, or not text of at most MAX_TEXT characters.
        """
        where = f"{self.path}: attribute {name}"
        with _damage_as_folder_error(where):
            # HDF5 may crash on converting what is not text.
            if h5py.check_string_dtype(self._scalar(name, where)) is None:
                raise FolderError(f"{where}: should be text")
            value = self._file.attrs[name]
            if isinstance(value, bytes):
                value = value.decode()
            if not isinstance(value, str) or len(value) > MAX_TEXT:
                raise FolderError(f"{where}: should be text of at most {MAX_TEXT} characters")
            value.encode()  # h5py lets through what is not UTF-8
            return value

    def json(self, name: str) -> Any:
        """Read an attribute of the file that is JSON text.

        Raises:
            FolderError: it is missing, or not JSON.
        """
        try:
            return parse_json(self.text(name))
        except ValueError as error:
            raise FolderError(f"{self.path}: attribute {name}: is not JSON ({error})") from None

    def attribute_digests(self) -> dict[str, str]:
        """Digest the attributes of each object in the file: {name: digest}."""
        with _damage_as_folder_error(f"{self.path}: attributes"):
            return attribute_digests(self._file)

    def whole_number(self, name: str) -> int:
        """Read an attribute of the file that is a whole number.

        Raises:
            FolderError: it is missing, or another value.
        """
        where = f"{self.path}: attribute {name}"
        with _damage_as_folder_error(where):
            if self._scalar(name, where).kind not in "iu":
                raise FolderError(f"{where}: should be a whole number")
            return int(self._file.attrs[name])

    def _scalar(self, name: str, where: str) -> np.dtype[Any]:
        if name not in self._file.attrs:
            raise FolderError(f"{where}: is missing")
        attribute = self._file.attrs.get_id(name)
        if attribute.shape != () or attribute.get_storage_size() > MAX_TEXT:
            raise FolderError(f"{where}: should be a single value")
        kind: np.dtype[Any] = attribute.dtype
        return kind

    def column(self, name: str, dtype: DTypeLike, shape: tuple[int, ...]) -> "Column":
        """Open a dataset of numbers stored in one piece, without gaps or filters.

        Raises:
            FolderError: it is missing, damaged, or of another type or shape.
        """
        where, expected_type = f"{self.path}: /{name}", np.dtype(dtype)
        with _damage_as_folder_error(where):
            dataset = self._dataset(name, where, expected_type, shape)
            size = expected_type.itemsize * prod(shape)
            if dataset.chunks is not None or dataset.id.get_storage_size() != size:
                raise FolderError(f"{where}: should be stored in one piece of {size} bytes")
        self._claimed += size
        if self._claimed > self.bytes:
            raise FolderError(f"{where}: is larger than the file; it is damaged or truncated")
        return Column(where, dataset)

    def chunks(self, name: str, dtype: DTypeLike, shape: tuple[int, ...]) -> "Column":
        """Open a dataset of samples [N, ...], each in a chunk of its own, plain or gzip.

        Raises:
            FolderError: it is missing, damaged, or of another type or shape.
        """
        where, chunk_shape, expected_type = (
            f"{self.path}: /{name}",
            (1, *shape[1:]),
            np.dtype(dtype),
        )
        with _damage_as_folder_error(where):
            dataset = self._dataset(name, where, expected_type, shape)
            if dataset.dtype != expected_type:
                raise FolderError(
                    f"{where}: is of the type {dataset.dtype.str}; not {expected_type.str}"
                )
            if dataset.chunks != chunk_shape:
                raise FolderError(
                    f"{where}: has chunks of {dataset.chunks}; should be {chunk_shape}"
                )
            filters = _filters(dataset, where, [], [_DEFLATE])
            if dataset.id.get_num_chunks() != shape[0]:
                raise FolderError(
                    f"{where}: holds {dataset.id.get_num_chunks()} samples; should hold {shape[0]}"
                )
        return Column(where, dataset, filters)

    def samples(self, name: str, may_be_empty: bool = False) -> "NumberColumn":
        """Real or complex numbers of any shape, plain or gzip, read in pieces.

        Args:
            name: Dataset in the file.
            may_be_empty: Whether it may have no rows.

        Raises:
            FolderError: The dataset is missing, damaged, of another type, or holds nothing.
        """
        where = f"{self.path}: /{name}"
        with _damage_as_folder_error(where):
            dataset = self._dataset(name, where, None, None)
            filters = _filters(dataset, where, [], [_DEFLATE], [_SHUFFLE, _DEFLATE])
            column = NumberColumn(where, dataset, filters)
            size, chunk = dataset.dtype.itemsize * prod(dataset.shape), dataset.chunks
            lengths = dataset.shape[1:] if may_be_empty else dataset.shape
            if not dataset.shape or prod(lengths) == 0:
                raise FolderError(f"{where}: has the shape {dataset.shape}; should hold numbers")
            if chunk is None and dataset.id.get_storage_size() != size:
                raise FolderError(f"{where}: should be stored in {size} bytes; it is truncated")
            if chunk is not None:
                chunk_bytes = dataset.dtype.itemsize * prod(chunk)
                grid = prod(-(-n // c) for n, c in zip(dataset.shape, chunk, strict=True))
                if chunk_bytes > MAX_CHUNK:
                    raise FolderError(
                        f"{where}: has chunks of {chunk_bytes} bytes; at most {MAX_CHUNK}"
                    )
                if dataset.id.get_num_chunks() != grid:
                    raise FolderError(f"{where}: lacks pieces; it is unfinished or damaged")
            if not filters and size > self.bytes:
                raise FolderError(f"{where}: is larger than the file; it is damaged or truncated")
        return column

    def numeric_paths(self) -> list[str]:
        """List the paths of the datasets of numbers, of at most 1000 links and 8 groups deep."""
        paths, groups, links = list[str](), [("", self._file)], 0
        with _damage_as_folder_error(str(self.path)):
            for prefix, group in groups:
                for name in islice(group, 1000 - links):
                    links += 1
                    if group.id.links.get_info(name.encode()).type != h5py.h5l.TYPE_HARD:
                        continue
                    item, path = group[name], f"{prefix}{name}"
                    if isinstance(item, h5py.Group) and path.count("/") < DEEPEST_GROUP:
                        groups.append((f"{path}/", item))
                    elif isinstance(item, h5py.Dataset) and item.shape:
                        with suppress(FolderError):
                            _numbers(item.dtype, path)
                            paths.append(path)
        return [path for path in paths if not path.startswith("#")]  # MATLAB's own

    def cells(self) -> dict[str, list[str]]:
        """Paths of the datasets of numbers that each cell array of MATLAB 7.3 refers to."""
        cells = dict[str, list[str]]()
        with _damage_as_folder_error(str(self.path)):
            for name in islice(self._file, 1000):
                if self._file.id.links.get_info(name.encode()).type != h5py.h5l.TYPE_HARD:
                    continue
                item = self._file[name]
                is_reference = isinstance(item, h5py.Dataset) and item.dtype == h5py.ref_dtype
                if is_reference and 1 < item.size <= MAX_CELLS:
                    references = item[()].reshape(-1)
                    cells[name] = [str(self._file[r].name).strip("/") for r in references if r]
        return cells

    def scalar_text(self, name: str) -> str:
        """Read a dataset that is a single text.

        Raises:
            FolderError: it is missing, or not text of at most MAX_TEXT characters.
        """
        where = f"{self.path}: /{name}"
        with _damage_as_folder_error(where):
            item = self._dataset(name, where, None, ())
            if h5py.check_string_dtype(item.dtype) is None:
                raise FolderError(f"{where}: should be text")
            value = item.asstr()[()]
        if not isinstance(value, str) or len(value) > MAX_TEXT:
            raise FolderError(f"{where}: should be text of at most {MAX_TEXT} characters")
        return value

    def shape(self, name: str) -> list[int]:
        """Shape of a dataset of any type; no values are read."""
        with _damage_as_folder_error(f"{self.path}: /{name}"):
            return list(self._dataset(name, f"{self.path}: /{name}", None, None).shape)

    def _dataset(
        self, name: str, where: str, dtype: np.dtype[Any] | None, shape: tuple[int, ...] | None
    ) -> h5py.Dataset:
        item: Any = self._file
        for part in name.split("/"):
            # `part in found` and `found.get` would open the file that an external link names.
            if not isinstance(item, h5py.Group) or not item.id.links.exists(part.encode()):
                raise FolderError(f"{where}: is missing")
            if item.id.links.get_info(part.encode()).type != h5py.h5l.TYPE_HARD:
                raise FolderError(f"{where}: is a link; should be stored in this file")
            item = item[part]
        if not isinstance(item, h5py.Dataset):
            raise FolderError(f"{where}: should be a dataset")
        # First of all: to know the shape of a virtual dataset HDF5 may open its sources.
        creation = item.id.get_create_plist()
        virtual = creation.get_layout() == h5py.h5d.VIRTUAL
        if virtual or creation.get_external_count():
            raise FolderError(f"{where}: lies in another file; should be stored in this file")
        if shape is not None and item.shape != shape:
            raise FolderError(f"{where}: has the shape {item.shape}; should have {shape}")
        if dtype is not None and item.dtype.newbyteorder("=") != dtype:
            raise FolderError(f"{where}: is of the type {item.dtype}; should be {dtype}")
        return item

    def close(self) -> None:
        """Close the file."""
        self._file.close()


class Column:
    """Values that were checked and are read when they are indexed.

    Attributes:
        where: file and dataset, for messages.
        shape: shape of the dataset.
        chunk: shape of the blocks that are stored together.
        dtype: type of the values, in the byte order of this machine.
    """

    def __init__(self, where: str, dataset: h5py.Dataset, filters: Sequence[int] = ()) -> None:
        self.where, self._dataset, self._filters = where, dataset, filters
        self.shape: tuple[int, ...] = dataset.shape
        self.chunk: tuple[int, ...] = dataset.chunks or (1,) * len(self.shape)
        self.dtype: np.dtype[Any] = dataset.dtype.newbyteorder("=")

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, key: Any) -> NDArray[Any]:
        if isinstance(key, slice) and key.step in (None, 1):
            return self.rows(*key.indices(len(self))[:2])
        rows = np.arange(len(self))[key]
        if rows.ndim:
            return np.stack([self[row] for row in rows.tolist()])
        row: NDArray[Any] = self.rows(int(rows), int(rows) + 1)[0]
        return row

    def rows(self, start: int, stop: int) -> NDArray[Any]:
        """Read rows start .. stop - 1, and no others."""
        stop = min(stop, len(self))
        if stop <= start:
            return np.empty((0, *self.shape[1:]), self.dtype)
        return self.block((slice(start, stop), *(slice(0, n) for n in self.shape[1:])))

    def block(self, key: tuple[slice, ...]) -> NDArray[Any]:
        """Read a block of the values; slices have a start and a stop within the shape."""
        with _damage_as_folder_error(self.where):
            if not self._filters:
                values: NDArray[Any] = self._dataset[key]
                return values.astype(self.dtype, copy=False)
            out = np.empty([span.stop - span.start for span in key], self.dtype)
            for piece in self._dataset.iter_chunks(key):
                corner = tuple(s.start // c * c for s, c in zip(piece, self.chunk, strict=True))
                in_block = _relative(piece, [span.start for span in key])
                out[in_block] = self._piece(corner)[_relative(piece, corner)]
            return out

    def stored(self, row: int) -> tuple[int, bytes]:
        """Read the filter mask and the bytes of a row's chunk as they lie in the file."""
        with _damage_as_folder_error(f"{self.where}[{row}]"):
            return self._stored((row, *(0,) * (len(self.shape) - 1)))

    def _stored(self, corner: tuple[int, ...]) -> tuple[int, bytes]:
        """Read the filter mask and the bytes of the chunk at a corner.

        Deflate makes nothing longer by more than a thousandth: h5py refuses what is longer.
        """
        raw = self.dtype.itemsize * prod(self.chunk)
        room = bytearray(raw + (raw // 1000 + 64 if self._filters else 0))
        mask, data = self._dataset.id.read_direct_chunk(corner, out=room)
        return mask, bytes(data)

    def _piece(self, corner: tuple[int, ...]) -> NDArray[Any]:
        """Read the chunk at a corner, inflated up to its size."""
        raw = self.dtype.itemsize * prod(self.chunk)
        with _damage_as_folder_error(f"{self.where}[{corner[0]}]"):
            mask, data = self._stored(corner)
            for place, kind in reversed([*enumerate(self._filters)]):
                if mask >> place & 1:
                    continue
                if kind == _SHUFFLE:
                    data = np.frombuffer(data, "u1").reshape(self.dtype.itemsize, -1).T.tobytes()
                    continue
                reader = zlib.decompressobj()
                data = reader.decompress(data, raw + 1)
                if not reader.eof:
                    raise zlib.error("too long or truncated")
            if len(data) != raw:
                raise ValueError(f"is {len(data)} bytes; should be {raw}")
            return np.frombuffer(data, self._dataset.dtype).reshape(self.chunk)


class NumberColumn(Column):
    """Column of real or complex numbers.

    Attributes:
        number: type of a real number, or of each part of a complex one.
        parts: 2 for complex numbers, 1 for real ones.
    """

    def __init__(self, where: str, dataset: h5py.Dataset, filters: Sequence[int] = ()) -> None:
        super().__init__(where, dataset, filters)
        self.number, self.parts = _numbers(dataset.dtype, where)

    def read(self, key: tuple[slice, ...]) -> NDArray[Any]:
        """Read a block of numbers by parts [..., part], two for complex and compound numbers."""
        values = np.ascontiguousarray(self.block(key))
        return values.view(self.number).reshape(*values.shape, self.parts)


def _relative(piece: Sequence[slice], origin: Sequence[int]) -> tuple[slice, ...]:
    """Slices of a piece, counted from an origin."""
    return tuple(
        slice(span.start - first, span.stop - first)
        for span, first in zip(piece, origin, strict=True)
    )


def _filters(dataset: h5py.Dataset, where: str, *allowed: list[int]) -> list[int]:
    """Numbers of the filters that a dataset is stored through, one of the lists allowed."""
    creation = dataset.id.get_create_plist()
    filters = [creation.get_filter(i)[0] for i in range(creation.get_nfilters())]
    if filters not in allowed:
        raise FolderError(f"{where}: is stored through filters {filters}; should be gzip")
    return filters


def _numbers(dtype: np.dtype[Any], where: str) -> tuple[np.dtype[Any], int]:
    """Type of the real numbers and their parts, of a dataset's type: real, complex or a pair."""
    if dtype.kind in "iuf" and dtype.itemsize <= 8:
        return dtype.newbyteorder("="), 1
    if dtype.kind == "c" and dtype.itemsize <= 16:
        return np.dtype(f"f{dtype.itemsize // 2}"), 2
    if dtype.names is not None and len(dtype.names) == 2:
        first, second = dtype[0], dtype[1]
        if first == second and first.kind in "iuf" and dtype.itemsize == 2 * first.itemsize <= 16:
            return first.newbyteorder("="), 2
    raise FolderError(f"{where}: is of the type {dtype}; should be real or complex numbers")
