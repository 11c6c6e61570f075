"""Captures that are numbers without a mark or a header, of a type that the user names.

So write XeThru's recorder (float32, I and Q by turns or all I, then all Q), GNU Radio (complex64),
sound cards and most programs of one's own (int16).
"""

from functools import partial
from pathlib import Path

import numpy as np

from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import regular_size
from radhar_cli.readers.captures.settings import CaptureSettings
from radhar_cli.readers.captures.stored_arrays import StoredArray


def map_raw(path: Path, settings: CaptureSettings) -> StoredArray:
    """Map the numbers of a file, all along one axis.

    Args:
        path: the file.
        settings: header of the capture, with the type of the numbers and the bytes before them.

    Raises:
        CaptureError: it has no whole number of such numbers.
    """
    assert settings.dtype is not None
    name, offset = settings.dtype, settings.skipped_bytes
    dtype = np.dtype(name.lstrip("<>")).newbyteorder(">" if name[0] == ">" else "<")
    size = regular_size(path) - offset
    if size <= 0 or size % dtype.itemsize:
        after = f" after {offset}" if offset else ""
        raise CaptureError(
            f"{path}: has {max(size, 0)} bytes{after}; should have a multiple of {dtype.itemsize}, "
            f"as dtype = {settings.dtype} says (skipped_bytes=N leaves out a header)"
        )
    return StoredArray(str(path), partial(np.memmap, path, dtype, "r", offset))
