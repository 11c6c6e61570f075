"""PNG files: levels through a colour table."""

import io

from PIL import Image

from radhar_cli.arrays import Levels


def encode_png(levels: Levels, table: Levels, compress_level: int) -> bytes:
    """RGB PNG of levels [H, W] through a colour table [256, 3]."""
    buffer = io.BytesIO()
    Image.fromarray(table[levels]).save(buffer, "png", compress_level=compress_level)
    return buffer.getvalue()
