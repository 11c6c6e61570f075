"""HDF5 files that anyone may have written: the one place that opens them.

Only what is asked for by name is read; the rest of the file does not matter. Each link on the
way is a hard one and each dataset lies in the file itself, so nothing leads to another file. Types,
shapes and stored bytes are checked before anything is read. Compressed images are inflated here, up
to the size that they should have: HDF5 would inflate them to any.
"""

import os
import struct
import weakref
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import partial
from itertools import islice
from math import prod
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import DTypeLike, NDArray

from radhar_cli.errors import FolderError
from radhar_cli.untrusted import Closing, parse_json, regular_size

# What h5py raises on a file whose structure is damaged.
_DAMAGED = (
    AttributeError,
    KeyError,
    NotImplementedError,
    OSError,
    OverflowError,
    RuntimeError,
    TypeError,
    ValueError,
)
_HEAP = b"GCOL\x01"
MAX_TEXT = 2**20
MIN_HEAP, MAX_HEAP = 4096, 2**24  # bytes; the minimum is HDF5's
MAX_CHUNK = 2**27  # bytes of a chunk
_DEFLATE, _SHUFFLE = h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE


@contextmanager
def _refusing_damage(where: str) -> Iterator[None]:
    try:
        yield
    except _DAMAGED as error:
        raise FolderError(f"{where}: cannot be read, the file is damaged ({error})") from None


class _HeapChecked:
    """What HDF5 reads from: a file whose global heaps, where texts lie, are checked as they pass.

    On a heap with a free object of size 0 HDF5 would loop forever.
    """

    def __init__(self, source: Path | bytes) -> None:
        self.close: Callable[[], object]
        if isinstance(source, bytes):
            self.size, self.close = len(source), lambda: None
            self._at: Callable[[int, int], bytes] = lambda count, at: source[at : at + count]
        else:
            self.size = regular_size(source)
            number = os.open(source, os.O_RDONLY)
            self._at = partial(os.pread, number)
            self.close = weakref.finalize(self, os.close, number)
        self._place = 0

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Choose where to read, from the start or from the end."""
        self._place = offset + (self.size if whence == os.SEEK_END else 0)
        return self._place

    def tell(self) -> int:
        """Where the next byte is read."""
        return self._place

    def read(self, count: int) -> bytes:
        """Read so many bytes, or what there is."""
        before = min(self._place, len(_HEAP) - 1)
        start = self._place - before
        data = self._at(before + count, start)
        at = data.find(_HEAP)
        while at >= 0:
            self._check_heap(start + at)
            at = data.find(_HEAP, at + 1)
        self._place = start + len(data)
        return data[before:]

    def readinto(self, buffer: memoryview) -> int:
        """Fill a buffer."""
        data = self.read(len(buffer))
        buffer[: len(data)] = data
        return len(data)

    def _check_heap(self, place: int) -> None:
        """Walk a global heap: a header of 16 bytes, objects of 16 bytes and theirs, free space."""
        size = int.from_bytes(self._at(8, place + 8), "little")
        if not MIN_HEAP <= size <= self.size - place:
            return  # HDF5 refuses it, if it is one
        if size > MAX_HEAP:
            raise OSError(f"a heap of {size} bytes")
        heap, at = self._at(size - 16, place + 16), 0
        while at + 16 <= len(heap):
            index, _, length = struct.unpack_from("<HHxxxxQ", heap, at)
            need = 16 + -(-length // 8) * 8 if index else length
            if need < 8 or at + need > len(heap):
                raise OSError("a heap with an object of an impossible size")
            at += need


class UntrustedFile(Closing):
    """An HDF5 file, opened for reading.

    Args:
        path: of the file.
        data: its bytes, where they have been read already.

    Raises:
        FolderError: it is not a regular file, or not HDF5. So do all methods, for whatever is not
            as it should be; the message names file and field.
    """

    def __init__(self, path: Path, data: bytes | None = None) -> None:
        self.path = path
        self._claimed = 0
        try:
            self._source = _HeapChecked(path if data is None else data)
        except OSError as error:
            raise FolderError(f"{path}: {error.strerror}") from None
        try:
            self.bytes = self._source.size
            self._file = h5py.File(self._source, "r")
            if self._file.id.get_create_plist().get_sizes() != (8, 8):
                raise ValueError("its addresses and lengths should have 8 bytes")
        except _DAMAGED as error:
            raise FolderError(f"{path}: is not an HDF5 file, or is truncated ({error})") from None

    def has_attribute(self, name: str) -> bool:
        """Whether the file itself has an attribute of that name."""
        with _refusing_damage(f"{self.path}: attribute {name}"):
            return name in self._file.attrs

    def text(self, name: str) -> str:
        """A text attribute of the file."""
        where = f"{self.path}: attribute {name}"
        with _refusing_damage(where):
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
        """What a text attribute of the file says in JSON."""
        try:
            return parse_json(self.text(name))
        except ValueError as error:
            raise FolderError(f"{self.path}: attribute {name}: is not JSON ({error})") from None

    def whole_number(self, name: str) -> int:
        """A whole number among the attributes of the file."""
        where = f"{self.path}: attribute {name}"
        with _refusing_damage(where):
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
        """Numbers in one piece, all there: no gaps to be filled in, no filters."""
        where, wanted = f"{self.path}: /{name}", np.dtype(dtype)
        with _refusing_damage(where):
            dataset = self._dataset(name, where, wanted, shape)
            size = wanted.itemsize * int(np.prod(shape, dtype=object))
            if dataset.chunks is not None or dataset.id.get_storage_size() != size:
                raise FolderError(f"{where}: should be stored in one piece of {size} bytes")
        self._claimed += size
        if self._claimed > self.bytes:
            raise FolderError(f"{where}: is larger than the file; it is damaged or truncated")
        return Column(where, dataset, wanted, shape)

    def chunks(self, name: str, dtype: DTypeLike, shape: tuple[int, ...]) -> "Chunks":
        """Samples [N, ...], each in a chunk of its own, plain or gzip."""
        where, one, wanted = f"{self.path}: /{name}", (1, *shape[1:]), np.dtype(dtype)
        with _refusing_damage(where):
            dataset = self._dataset(name, where, wanted, shape)
            if dataset.dtype != wanted:
                raise FolderError(f"{where}: is of the type {dataset.dtype.str}; not {wanted.str}")
            creation = dataset.id.get_create_plist()
            filters = [creation.get_filter(i)[0] for i in range(creation.get_nfilters())]
            if dataset.chunks != one:
                raise FolderError(f"{where}: has chunks of {dataset.chunks}; should be {one}")
            if filters not in ([], [_DEFLATE]):
                raise FolderError(f"{where}: is stored through filters {filters}; should be gzip")
            if dataset.id.get_num_chunks() != shape[0]:
                raise FolderError(
                    f"{where}: holds {dataset.id.get_num_chunks()} samples; should hold {shape[0]}"
                )
        return Chunks(where, dataset, wanted, shape, bool(filters))

    def samples(self, name: str) -> "Samples":
        """Real or complex numbers of any shape, plain or gzip, read in pieces."""
        where = f"{self.path}: /{name}"
        with _refusing_damage(where):
            dataset = self._dataset(name, where, None, None)
            number, parts = _numbers(dataset.dtype, where)
            creation = dataset.id.get_create_plist()
            filters = [creation.get_filter(i)[0] for i in range(creation.get_nfilters())]
            size = dataset.dtype.itemsize * int(np.prod(dataset.shape, dtype=object))
            if not dataset.shape or size == 0:
                raise FolderError(f"{where}: has the shape {dataset.shape}; should hold numbers")
            if filters not in ([], [_DEFLATE], [_SHUFFLE, _DEFLATE]):
                raise FolderError(f"{where}: is stored through filters {filters}; should be gzip")
            chunk = dataset.chunks
            if chunk is None and dataset.id.get_storage_size() != size:
                raise FolderError(f"{where}: should be stored in {size} bytes; it is truncated")
            if chunk is not None:
                one = dataset.dtype.itemsize * int(np.prod(chunk, dtype=object))
                if one > MAX_CHUNK:
                    raise FolderError(f"{where}: has chunks of {one} bytes; at most {MAX_CHUNK}")
                if dataset.id.get_num_chunks() != _grid(dataset.shape, chunk):
                    raise FolderError(f"{where}: lacks pieces; it is unfinished or damaged")
            if not filters and size > self.bytes:
                raise FolderError(f"{where}: is larger than the file; it is damaged or truncated")
        return Samples(
            where, dataset, dataset.shape, number, parts, _SHUFFLE in filters, bool(filters)
        )

    def numeric_names(self) -> list[str]:
        """Names of the datasets of numbers at the top of the file, at most 1000."""
        names = []
        with _refusing_damage(str(self.path)):
            for name in islice(self._file, 1000):
                if self._file.id.links.get_info(name.encode()).type != h5py.h5l.TYPE_HARD:
                    continue
                item = self._file[name]
                if isinstance(item, h5py.Dataset) and item.shape:
                    with suppress(FolderError):
                        _numbers(item.dtype, name)
                        names.append(name)
        return names

    def shape(self, name: str) -> list[int]:
        """Shape of a dataset of any type, none of which is read."""
        with _refusing_damage(f"{self.path}: /{name}"):
            return list(self._dataset(name, f"{self.path}: /{name}", None, None).shape)

    def _dataset(
        self,
        name: str,
        where: str,
        dtype: np.dtype[Any] | None,
        shape: tuple[int, ...] | None,
    ) -> h5py.Dataset:
        place: Any = self._file
        for part in name.split("/"):
            # `part in found` and `found.get` would open the file that an external link names.
            if not isinstance(place, h5py.Group) or not place.id.links.exists(part.encode()):
                raise FolderError(f"{where}: is missing")
            if place.id.links.get_info(part.encode()).type != h5py.h5l.TYPE_HARD:
                raise FolderError(f"{where}: is a link; should be stored in this file")
            place = place[part]
        if not isinstance(place, h5py.Dataset):
            raise FolderError(f"{where}: should be a dataset")
        # First of all: to know the shape of a virtual dataset HDF5 may open its sources.
        creation = place.id.get_create_plist()
        virtual = creation.get_layout() == h5py.h5d.VIRTUAL
        if virtual or creation.get_external_count():
            raise FolderError(f"{where}: lies in another file; should be stored in this file")
        if shape is not None and place.shape != shape:
            raise FolderError(f"{where}: has the shape {place.shape}; should have {shape}")
        if dtype is not None and place.dtype.newbyteorder("=") != dtype:
            raise FolderError(f"{where}: is of the type {place.dtype}; should be {dtype}")
        return place

    def close(self) -> None:
        """Close the file."""
        self._file.close()
        self._source.close()


@dataclass(frozen=True)
class Column:
    """Numbers that were checked and are read when they are indexed."""

    where: str
    _dataset: h5py.Dataset
    dtype: np.dtype[Any]
    shape: tuple[int, ...]

    def __len__(self) -> int:
        return self.shape[0]

    def rows(self, start: int, stop: int) -> NDArray[Any]:
        """Rows start .. stop - 1; no others are read."""
        with _refusing_damage(self.where):
            values: NDArray[Any] = self._dataset[start:stop]
        return values.astype(self.dtype, copy=False)

    def __getitem__(self, key: Any) -> Any:
        with _refusing_damage(self.where):
            values: NDArray[Any] = self._dataset[()]
        return values.astype(self.dtype, copy=False)[key]


@dataclass
class Chunks:
    """Samples [N, ...] that were checked and are read when they are indexed."""

    where: str
    _dataset: h5py.Dataset
    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    _deflated: bool
    _sizes: NDArray[np.uint32] | None = field(default=None, repr=False)

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, key: Any) -> NDArray[Any]:
        rows = np.arange(len(self))[key]
        return self._sample(int(rows)) if rows.ndim == 0 else np.stack([*map(self._sample, rows)])

    @property
    def _bytes(self) -> int:
        """Of a sample, inflated."""
        return self.dtype.itemsize * prod(self.shape[1:])

    def stored(self, row: int) -> tuple[int, bytes]:
        """Filter mask and bytes of a row's chunk as they lie in the file."""
        if self._sizes is None:
            self._sizes = self._stored_sizes()
        with _refusing_damage(f"{self.where}[{row}]"):
            mask, chunk = self._dataset.id.read_direct_chunk((row, *(0,) * (len(self.shape) - 1)))
        return mask, chunk

    def _stored_sizes(self) -> NDArray[np.uint32]:
        """Stored bytes of every row; deflate makes nothing longer by more than a thousandth."""
        raw = self._bytes
        most = raw + raw // 1000 + 64 if self._deflated else raw
        sizes = np.zeros(len(self), np.uint32)

        def note(chunk: Any) -> None:
            if chunk.chunk_offset[0] < len(sizes):
                sizes[chunk.chunk_offset[0]] = min(chunk.size, 2**32 - 1)

        with _refusing_damage(self.where):
            self._dataset.id.chunk_iter(note)
        if (sizes > most).any():
            row = int(np.argmax(sizes > most))
            raise FolderError(f"{self.where}[{row}]: is stored in {sizes[row]} bytes, too many")
        if not sizes.all():
            raise FolderError(f"{self.where}: lacks samples; it is damaged")
        return sizes

    def _sample(self, row: int) -> NDArray[Any]:
        raw = self._bytes
        mask, chunk = self.stored(row)
        if self._deflated and not mask & 1:
            with _inflating(f"{self.where}[{row}]"):
                reader = zlib.decompressobj()
                chunk = reader.decompress(chunk, raw + 1)
                if not reader.eof:
                    raise zlib.error("too long or truncated")
        if len(chunk) != raw:
            raise FolderError(f"{self.where}[{row}]: is {len(chunk)} bytes; should be {raw}")
        return np.frombuffer(chunk, self.dtype).reshape(self.shape[1:]).copy()


@dataclass(frozen=True)
class Samples:
    """Numbers that were checked and are read in pieces.

    Attributes:
        where: file and dataset, for messages.
        shape: of the dataset.
        number: type of the numbers.
        parts: 2 of complex numbers, 1 of real ones.
    """

    where: str
    _dataset: h5py.Dataset
    shape: tuple[int, ...]
    number: np.dtype[Any]
    parts: int
    _shuffled: bool
    _deflated: bool

    @property
    def chunk(self) -> tuple[int, ...]:
        """Shape of what is stored together."""
        return self._dataset.chunks or (1,) * len(self.shape)

    def whole(self) -> NDArray[Any]:
        """All of the numbers, complex ones as such."""
        return self.rows(0, self.shape[0])

    def rows(self, start: int, stop: int) -> NDArray[Any]:
        """Rows start .. stop - 1 of the first axis, complex numbers as such."""
        if stop == start:
            return np.empty((0, *self.shape[1:]), self._dataset.dtype)
        key = (slice(start, stop), *(slice(0, n) for n in self.shape[1:]))
        found: NDArray[Any] = self.read(key).view(self._dataset.dtype.newbyteorder("="))[..., 0]
        return found

    def read(self, key: tuple[slice, ...]) -> NDArray[Any]:
        """A block [..., part] of the numbers; slices have a start and a stop within the shape."""
        with _refusing_damage(self.where):
            if not self._deflated:
                return self._in_parts(self._dataset[key])
            out = np.empty([one.stop - one.start for one in key], self._dataset.dtype)
            first = [s.start // c for s, c in zip(key, self.chunk, strict=True)]
            counts = [-(-s.stop // c) - f for s, c, f in zip(key, self.chunk, first, strict=True)]
            for place in np.ndindex(*counts):
                corner = [(f + p) * c for f, p, c in zip(first, place, self.chunk, strict=True)]
                inside, outside = [], []
                for start, side, wanted in zip(corner, self.chunk, key, strict=True):
                    low, high = max(start, wanted.start), min(start + side, wanted.stop)
                    inside.append(slice(low - start, high - start))
                    outside.append(slice(low - wanted.start, high - wanted.start))
                out[tuple(outside)] = self._inflated(tuple(corner))[tuple(inside)]
            return self._in_parts(out)

    def _inflated(self, corner: tuple[int, ...]) -> NDArray[Any]:
        dtype = self._dataset.dtype
        raw = dtype.itemsize * int(np.prod(self.chunk))
        if self._dataset.id.get_chunk_info_by_coord(corner).size > raw + raw // 1000 + 64:
            raise FolderError(f"{self.where}: a piece is stored in too many bytes")
        mask, data = self._dataset.id.read_direct_chunk(corner)
        if not mask & (2 if self._shuffled else 1):
            with _inflating(f"{self.where}[{corner}]"):
                data = zlib.decompressobj().decompress(data, raw + 1)
        if len(data) != raw:
            raise FolderError(f"{self.where}: a piece is {len(data)} bytes; should be {raw}")
        flat = np.frombuffer(data, np.uint8)
        if self._shuffled and not mask & 1:
            flat = flat.reshape(dtype.itemsize, -1).T.ravel()
        whole: NDArray[Any] = flat.view(dtype).reshape(self.chunk)
        return whole

    def _in_parts(self, values: NDArray[Any]) -> NDArray[Any]:
        """[...] as [..., part], two of complex and compound numbers."""
        values = np.ascontiguousarray(values)
        flat = values.view(self.number.newbyteorder(_order(values.dtype)))
        return flat.astype(self.number, copy=False).reshape(*values.shape, self.parts)


def _order(dtype: np.dtype[Any]) -> Any:
    first = dtype if dtype.names is None else dtype[0]
    return first.byteorder if first.byteorder in "<>" else "="


def _numbers(dtype: np.dtype[Any], where: str) -> tuple[np.dtype[Any], int]:
    """(type of the numbers, parts) of a dataset's type, which may be complex or a pair."""
    if dtype.kind in "iuf" and dtype.itemsize <= 8:
        return dtype.newbyteorder("="), 1
    if dtype.kind == "c" and dtype.itemsize <= 16:
        return np.dtype(f"f{dtype.itemsize // 2}"), 2
    if dtype.names is not None and len(dtype.names) == 2:
        first, second = dtype[0], dtype[1]
        if first == second and first.kind in "iuf" and dtype.itemsize == 2 * first.itemsize <= 16:
            return first.newbyteorder("="), 2
    raise FolderError(f"{where}: is of the type {dtype}; should be real or complex numbers")


def _grid(shape: tuple[int, ...], chunk: tuple[int, ...]) -> int:
    return int(np.prod([-(-n // c) for n, c in zip(shape, chunk, strict=True)], dtype=object))


@contextmanager
def _inflating(where: str) -> Iterator[None]:
    try:
        yield
    except zlib.error as error:
        raise FolderError(f"{where}: cannot be read, its gzip data are damaged ({error})") from None
