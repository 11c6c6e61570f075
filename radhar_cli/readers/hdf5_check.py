"""Try HDF5 files that anyone may have written, in a process of its own that may crash or be killed.

This file is the program of that process: it reads what `untrusted_hdf5` is going to read, but for
the numbers of datasets, within limits of memory and time. It imports nothing of radhar.
"""

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from math import ceil
from typing import Any

import h5py

MEMORY = 2 * 2**30  # address space of this process, bytes
SECONDS = 10  # CPU time of each file
MAX_BYTES = 2**26  # of an attribute


@contextmanager
def harmless() -> Iterator[None]:
    """Ignore errors, which the reader of the file will meet again; exit if memory runs out.

    On exit the message on standard error says why.
    """
    try:
        yield
    except Exception as error:
        if isinstance(error, MemoryError) or "alloc" in str(error):
            sys.exit(" ".join(str(error).split()) or "it takes too much memory")


def walk(file: h5py.File) -> None:
    """Read a file's attributes of text and numbers; open all its groups and datasets.

    Links to other files are not followed.
    """
    _read_attributes(file)
    walked, groups = set(), [file.id]
    while groups:
        group = groups.pop()
        for name in _names(group):
            with harmless():
                if group.links.get_info(name).type != h5py.h5l.TYPE_HARD:
                    continue
                item = h5py.h5o.open(group, name)
                address = h5py.h5o.get_info(item).addr
                if isinstance(item, h5py.h5g.GroupID) and address not in walked:
                    walked.add(address)
                    groups.append(item)
                    _read_attributes(h5py.Group(item))
                elif isinstance(item, h5py.h5d.DatasetID):
                    _read_attributes(h5py.Dataset(item))
                    if item.get_create_plist().get_layout() == h5py.h5d.CHUNKED:
                        item.get_num_chunks()


def _read_attributes(item: h5py.HLObject) -> None:
    """Read the attributes of text and numbers of a group or dataset."""
    for name in _names(item.attrs):
        with harmless():
            if is_plain(item.attrs.get_id(name)):
                item.attrs[name]


def is_plain(attribute: Any) -> bool:
    """Whether an attribute is text or numbers of at most MAX_BYTES."""
    text = h5py.check_string_dtype(attribute.dtype) is not None
    plain = text or attribute.dtype.kind in "iuf"
    return plain and attribute.get_storage_size() <= MAX_BYTES


def _names(group: Iterable[Any]) -> list[Any]:
    """Names in a group or among attributes, as far as they can be read."""
    names: list[Any] = []
    with harmless():
        names.extend(group)
    return names


def main() -> None:
    """Try the files named on standard input, each ended by a zero byte; print each one's number."""
    import resource

    _limit(resource.RLIMIT_AS, MEMORY)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for number, path in enumerate(sys.stdin.buffer.read().split(b"\0")[:-1]):
        sys.stdout.write(f"{number}\n")
        sys.stdout.flush()
        used = resource.getrusage(resource.RUSAGE_SELF)
        _limit(resource.RLIMIT_CPU, ceil(used.ru_utime + used.ru_stime + SECONDS))
        with harmless(), h5py.File(path.decode(errors="surrogateescape"), "r") as file:
            walk(file)


def _limit(kind: int, value: int) -> None:
    """Set a soft limit of this process, on a system that has it and has no stricter one."""
    import resource

    with suppress(ValueError, OSError):
        resource.setrlimit(kind, (value, resource.getrlimit(kind)[1]))


if __name__ == "__main__":
    main()
