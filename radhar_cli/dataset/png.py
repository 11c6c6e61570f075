"""PNG files of levels: the pixels are the levels, the palette is the colour map."""

import struct
import zlib
from pathlib import Path

import numpy as np
from isal import isal_zlib
from PIL import Image

from radhar_cli.config.image import DEFAULT_COLOUR_MAP
from radhar_cli.numerics.arrays import Levels

_DEFAULT_TABLE = Path(__file__).with_name(f"{DEFAULT_COLOUR_MAP}.rgb")  # Matplotlib starts slowly
_FAST = 2  # of ISA-L's 0 to 3: about as small as zlib's 1
# Marks files whose palette indices are levels.
_MARK = ("Software", "radhar")


def deflate(data: bytes, level: int) -> bytes:
    """Compress data to a zlib stream (RFC 1950): level 0 not at all, 1 by ISA-L, 2 to 9 by zlib.

    Equal data give equal bytes on one machine; ISA-L may find other matches on another processor.
    """
    return isal_zlib.compress(data, _FAST) if level == 1 else zlib.compress(data, level)


def colour_table(name: str) -> Levels:
    """RGB [256, 3] of a Matplotlib colour map, whose name the config has checked."""
    if name == DEFAULT_COLOUR_MAP:
        return np.array([*_DEFAULT_TABLE.read_bytes()], np.uint8).reshape(256, 3)
    from matplotlib import colormaps

    rgb = colormaps[name](np.arange(256))[:, :3]
    return np.floor(rgb * 255 + 0.5).astype(np.uint8)


def encode_png(levels: Levels, table: Levels, compress_level: int) -> bytes:
    """Encode levels [H, W] as a PNG file whose palette is a colour table [256, 3]."""
    height, width = levels.shape
    lines = np.zeros((height, 1 + width), np.uint8)  # each after the number of its filter: none
    lines[:, 1:] = levels
    eight_bit_palette = (8, 3, 0, 0, 0)
    chunks = (
        (b"IHDR", struct.pack(">2I5B", width, height, *eight_bit_palette)),
        (b"tEXt", b"\0".join(word.encode("latin-1") for word in _MARK)),
        (b"PLTE", table.tobytes()),
        (b"IDAT", deflate(lines.tobytes(), compress_level)),
        (b"IEND", b""),
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        len(data).to_bytes(4) + kind + data + zlib.crc32(data, zlib.crc32(kind)).to_bytes(4)
        for kind, data in chunks
    )


def stored_levels(picture: Image.Image) -> Levels | None:
    """Levels [H, W] of a picture that `encode_png` wrote; None for any other."""
    is_from_radhar = picture.mode == "P" and picture.info.get(_MARK[0]) == _MARK[1]
    return np.asarray(picture) if is_from_radhar else None
