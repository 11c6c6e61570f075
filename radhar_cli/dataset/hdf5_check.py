"""Try HDF5 files that anyone may have written, in a process of its own that may crash or be killed.

This file is the program of that process: it reads what `untrusted_hdf5` is going to read, but for
the numbers of datasets, within limits of memory and time. It imports nothing of radhar.
"""

import sys
from contextlib import suppress

import h5py

MEMORY, SECONDS = 2 * 2**30, 10  # address space, CPU time of a run


def walk(path: str) -> None:
    """Read the texts and numbers among a file's attributes; open all its groups and datasets.

    Links to other files are not followed.
    """
    with h5py.File(path, "r") as file:
        for name in file.attrs:
            attribute = file.attrs.get_id(name)
            with suppress(TypeError, ValueError):  # of what is not read then either
                text = h5py.check_string_dtype(attribute.dtype) is not None
                if attribute.shape == () and (text or attribute.dtype.kind in "iuf"):
                    file.attrs[name]
        seen, left = set(), [file.id]
        while left:
            found = left.pop()
            if isinstance(found, h5py.h5d.DatasetID):
                creation = found.get_create_plist()
                if creation.get_layout() == h5py.h5d.CHUNKED:
                    found.get_num_chunks()
                continue
            for name in found:
                if found.links.get_info(name).type != h5py.h5l.TYPE_HARD:
                    continue
                child = h5py.h5o.open(found, name)
                place = h5py.h5o.get_info(child).addr
                if isinstance(child, h5py.h5g.GroupID | h5py.h5d.DatasetID) and place not in seen:
                    seen.add(place)
                    left.append(child)


def main() -> None:
    """Try the files whose names come in, each ended by a zero byte; say the number of each."""
    import resource

    for kind, most in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CPU, SECONDS)):
        with suppress(ValueError, OSError):  # a system without it, or with a stricter one
            resource.setrlimit(kind, (most, resource.getrlimit(kind)[1]))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for number, path in enumerate(sys.stdin.buffer.read().split(b"\0")[:-1]):
        sys.stdout.write(f"{number}\n")
        sys.stdout.flush()
        try:
            walk(path.decode(errors="surrogateescape"))
        except Exception as error:
            sys.exit(" ".join(str(error).split()) or type(error).__name__)


if __name__ == "__main__":
    main()
