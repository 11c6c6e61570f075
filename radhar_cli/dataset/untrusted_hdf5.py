"""HDF5 files that anyone may have written: the one place that opens them.

Only what is asked for by name is looked at; the rest of the file does not matter. Each link on the
way is a hard one and each dataset lies in the file itself, so nothing leads to another file. Types,
shapes and stored bytes are checked before anything is read. Compressed images are inflated here, up
to the size that they should have: HDF5 would inflate them to any.
"""

import os
import struct
import weakref
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any

import h5py
import numpy as np
from numpy.typing import DTypeLike, NDArray

from radhar_cli.arrays import Levels
from radhar_cli.errors import FolderError
from radhar_cli.untrusted import parse_json, regular_size

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
MIN_HEAP, MAX_HEAP = 4096, 2**24  # bytes; the first is HDF5's
_DEFLATE = h5py.h5z.FILTER_DEFLATE


@contextmanager
def _said(where: str) -> Iterator[None]:
    try:
        yield
    except _DAMAGED as error:
        raise FolderError(f"{where}: cannot be read, the file is damaged ({error})") from None


class _Watched:
    """What HDF5 reads from: a file whose global heaps, where texts lie, are checked as they pass.

    In a heap with a free object of no size HDF5 runs in a circle without end.
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
        found = data.find(_HEAP)
        while found >= 0:
            self._check_heap(start + found)
            found = data.find(_HEAP, found + 1)
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


class UntrustedFile:
    """An HDF5 file, opened for reading.

    Args:
        path: of the file.
        data: its bytes, where they have been read already.

    Raises:
        FolderError: it is no regular file, or no HDF5 file. So do all methods, for whatever is not
            as it should be; the message names file and field.
    """

    def __init__(self, path: Path, data: bytes | None = None) -> None:
        self.path = path
        self._claimed = 0
        try:
            self._source = _Watched(path if data is None else data)
            self.bytes = self._source.size
            self._file = h5py.File(self._source, "r")
            if self._file.id.get_create_plist().get_sizes() != (8, 8):
                raise ValueError("its addresses and lengths should have 8 bytes")
        except _DAMAGED as error:
            raise FolderError(f"{path}: is no HDF5 file, or a truncated one ({error})") from None

    def has_attribute(self, name: str) -> bool:
        """Whether the file itself has an attribute of that name."""
        with _said(f"{self.path}: attribute {name}"):
            return name in self._file.attrs

    def text(self, name: str) -> str:
        """A text attribute of the file."""
        where = f"{self.path}: attribute {name}"
        with _said(where):
            # Of what is no text, HDF5 may crash on converting it.
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
            raise FolderError(f"{self.path}: attribute {name}: is no JSON ({error})") from None

    def whole_number(self, name: str) -> int:
        """A whole number among the attributes of the file."""
        where = f"{self.path}: attribute {name}"
        with _said(where):
            if self._scalar(name, where).kind not in "iu":
                raise FolderError(f"{where}: should be a whole number")
            return int(self._file.attrs[name])

    def _scalar(self, name: str, where: str) -> np.dtype[Any]:
        if name not in self._file.attrs:
            raise FolderError(f"{where}: is missing")
        found = self._file.attrs.get_id(name)
        if found.shape != () or found.get_storage_size() > MAX_TEXT:
            raise FolderError(f"{where}: should be a single value")
        kind: np.dtype[Any] = found.dtype
        return kind

    def column(self, name: str, dtype: DTypeLike, shape: tuple[int, ...]) -> "Column":
        """Numbers in one piece, all there: no gaps to be filled in, no filters."""
        where, wanted = f"{self.path}: /{name}", np.dtype(dtype)
        with _said(where):
            found = self._dataset(name, where, wanted, shape)
            size = wanted.itemsize * int(np.prod(shape, dtype=object))
            if found.chunks is not None or found.id.get_storage_size() != size:
                raise FolderError(f"{where}: should be stored in one piece of {size} bytes")
        self._claimed += size
        if self._claimed > self.bytes:
            raise FolderError(f"{where}: is larger than the file; it is damaged or truncated")
        return Column(where, found, wanted, shape)

    def images(self, name: str, shape: tuple[int, int, int]) -> "Images":
        """Images uint8 [N, H, W], each in a chunk of its own, plain or gzip."""
        where, one = f"{self.path}: /{name}", (1, *shape[1:])
        with _said(where):
            found = self._dataset(name, where, np.dtype(np.uint8), shape)
            creation = found.id.get_create_plist()
            filters = [creation.get_filter(i)[0] for i in range(creation.get_nfilters())]
            if found.chunks != one:
                raise FolderError(f"{where}: has chunks of {found.chunks}; should be {one}")
            if filters not in ([], [_DEFLATE]):
                raise FolderError(f"{where}: is stored through filters {filters}; should be gzip")
            if found.id.get_num_chunks() != shape[0]:
                raise FolderError(
                    f"{where}: holds {found.id.get_num_chunks()} images; should hold {shape[0]}"
                )
        return Images(where, found, shape, bool(filters))

    def shape(self, name: str) -> list[int]:
        """Shape of a dataset of any type, none of which is read."""
        with _said(f"{self.path}: /{name}"):
            return list(self._dataset(name, f"{self.path}: /{name}", None, None).shape)

    def _dataset(
        self,
        name: str,
        where: str,
        dtype: np.dtype[Any] | None,
        shape: tuple[int, ...] | None,
    ) -> h5py.Dataset:
        found: Any = self._file
        for part in name.split("/"):
            # `part in found` and `found.get` would open the file that an external link names.
            if not isinstance(found, h5py.Group) or not found.id.links.exists(part.encode()):
                raise FolderError(f"{where}: is missing")
            if found.id.links.get_info(part.encode()).type != h5py.h5l.TYPE_HARD:
                raise FolderError(f"{where}: is a link; should be stored in this file")
            found = found[part]
        if not isinstance(found, h5py.Dataset):
            raise FolderError(f"{where}: should be a dataset")
        if shape is not None and found.shape != shape:
            raise FolderError(f"{where}: has the shape {found.shape}; should have {shape}")
        if dtype is not None and found.dtype.newbyteorder("=") != dtype:
            raise FolderError(f"{where}: is of the type {found.dtype}; should be {dtype}")
        creation = found.id.get_create_plist()
        if creation.get_layout() == h5py.h5d.VIRTUAL or creation.get_external_count():
            raise FolderError(f"{where}: lies in another file; should be stored in this file")
        return found

    def close(self) -> None:
        """Close the file."""
        self._file.close()
        self._source.close()

    def __enter__(self) -> "UntrustedFile":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()


@dataclass(frozen=True)
class Column:
    """Numbers that were checked and are read when they are indexed."""

    where: str
    _dataset: h5py.Dataset
    dtype: np.dtype[Any]
    shape: tuple[int, ...]

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, key: Any) -> Any:
        with _said(self.where):
            values: NDArray[Any] = self._dataset[()]
        return values.astype(self.dtype, copy=False)[key]


@dataclass
class Images:
    """Images uint8 [N, H, W] that were checked and are read when they are indexed."""

    where: str
    _dataset: h5py.Dataset
    shape: tuple[int, int, int]
    _deflated: bool
    _sizes: dict[int, int] = field(default_factory=dict, repr=False)

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, key: Any) -> Levels:
        rows = np.arange(len(self))[key]
        return self._image(int(rows)) if rows.ndim == 0 else np.stack([*map(self._image, rows)])

    def stored(self, row: int) -> tuple[int, bytes]:
        """Filter mask and bytes of a row's chunk as they lie in the file."""
        if not self._sizes:
            self._sizes = self._stored_sizes()
        with _said(f"{self.where}[{row}]"):
            mask, chunk = self._dataset.id.read_direct_chunk((row, 0, 0))
        return mask, chunk

    def _stored_sizes(self) -> dict[int, int]:
        """Stored bytes of every row; deflate makes nothing longer by more than a thousandth."""
        raw = self.shape[1] * self.shape[2]
        most = raw + raw // 1000 + 64 if self._deflated else raw
        sizes: dict[int, int] = {}
        with _said(self.where):
            self._dataset.id.chunk_iter(lambda c: sizes.__setitem__(c.chunk_offset[0], c.size))
        for row, size in sizes.items():
            if size > most:
                raise FolderError(f"{self.where}[{row}]: is stored in {size} bytes, too many")
        if sizes.keys() != set(range(len(self))):
            raise FolderError(f"{self.where}: lacks images; it is damaged")
        return sizes

    def _image(self, row: int) -> Levels:
        raw = self.shape[1] * self.shape[2]
        mask, chunk = self.stored(row)
        if self._deflated and not mask & 1:
            with _inflating(f"{self.where}[{row}]"):
                reader = zlib.decompressobj()
                chunk = reader.decompress(chunk, raw + 1)
                if not reader.eof:
                    raise zlib.error("too long or truncated")
        if len(chunk) != raw:
            raise FolderError(f"{self.where}[{row}]: is {len(chunk)} bytes; should be {raw}")
        return np.frombuffer(chunk, np.uint8).reshape(self.shape[1:]).copy()


@contextmanager
def _inflating(where: str) -> Iterator[None]:
    try:
        yield
    except zlib.error as error:
        raise FolderError(f"{where}: cannot be read, its gzip data are damaged ({error})") from None
