"""Captures that are compressed as a whole: .xz, .gz and .bz2, unpacked into the scratch folder."""

import bz2
import gzip
import lzma
import zlib
from pathlib import Path
from typing import Any

from radhar_cli.errors import CaptureError

OPENERS: dict[bytes, Any] = {b"\xfd7zXZ\0": lzma.open, b"\x1f\x8b": gzip.open, b"BZh": bz2.open}
SUFFIXES = (".xz", ".gz", ".bz2")
MAX_PACKING = 200  # growth of a file when it is unpacked
LEAST = 2**20  # bytes that any file may unpack to
BLOCK = 2**20


def unpack_file(path: Path, head: bytes, scratch: Path) -> Path:
    """Unpack a file into a scratch folder, unless it is not compressed as a whole.

    Args:
        path: the file.
        head: its first bytes.
        scratch: folder for what is unpacked.

    Returns:
        Path of the unpacked content; of a file that is not compressed its own.

    Raises:
        CaptureError: it is damaged, or unpacks to far more than it has.
    """
    opener = next((OPENERS[magic] for magic in OPENERS if head.startswith(magic)), None)
    if opener is None or path.suffix.lower() not in SUFFIXES:
        return path
    limit = max(MAX_PACKING * path.stat().st_size, LEAST)
    target, size = scratch / path.stem, 0
    try:
        with opener(path, "rb") as packed, target.open("wb") as file:
            while block := packed.read(BLOCK):
                size += len(block)
                if size > limit:
                    raise CaptureError(f"{path}: is compressed {MAX_PACKING}-fold or more")
                file.write(block)
    except (EOFError, lzma.LZMAError, zlib.error, OSError) as error:
        reason = getattr(error, "strerror", None) or error
        raise CaptureError(f"{path}: cannot be unpacked ({reason})") from None
    return target
