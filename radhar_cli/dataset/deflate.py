"""Deflate, the compression of PNG and of HDF5's gzip."""

import zlib

from isal import isal_zlib

_FAST = 2  # of ISA-L's 0 to 3: about as small as zlib's 1


def deflated(data: bytes, level: int) -> bytes:
    """A zlib stream (RFC 1950): level 0 none, 1 by ISA-L, 2 to 9 by zlib.

    Equal data give equal bytes on one machine; ISA-L may find other matches on another processor.
    """
    return isal_zlib.compress(data, _FAST) if level == 1 else zlib.compress(data, level)
