"""PNG files of levels: the pixels are the levels, the palette is the colour map."""

import io
from pathlib import Path

import numpy as np
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from radhar_cli.arrays import Levels
from radhar_cli.config.schema import DEFAULT_COLOUR_MAP

_DEFAULT_TABLE = Path(__file__).with_name(f"{DEFAULT_COLOUR_MAP}.rgb")  # Matplotlib starts slowly
# Marks files whose palette indices are levels.
_MARK = ("Software", "radhar")


def colour_table(name: str) -> Levels:
    """RGB [256, 3] of a Matplotlib colour map, whose name the config has checked."""
    if name == DEFAULT_COLOUR_MAP:
        return np.array([*_DEFAULT_TABLE.read_bytes()], np.uint8).reshape(256, 3)
    from matplotlib import colormaps

    rgb = colormaps[name](np.arange(256))[:, :3]
    return np.floor(rgb * 255 + 0.5).astype(np.uint8)


def encode_png(levels: Levels, table: Levels, compress_level: int) -> bytes:
    """PNG of levels [H, W] with a colour table [256, 3] as its palette."""
    picture = Image.fromarray(levels)
    picture.putpalette(table.tobytes())
    mark, buffer = PngInfo(), io.BytesIO()
    mark.add_text(*_MARK)
    picture.save(buffer, "png", compress_level=compress_level, pnginfo=mark)
    return buffer.getvalue()


def stored_levels(picture: Image.Image) -> Levels | None:
    """Levels [H, W] of a picture that `encode_png` wrote, None of any other."""
    ours = picture.mode == "P" and picture.info.get(_MARK[0]) == _MARK[1]
    return np.asarray(picture) if ours else None
