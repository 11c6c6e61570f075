"""The one reader of image files: five formats, one frame, a bounded number of pixels."""

import io
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from PIL import Image

from radhar_cli.dataset.png import stored_levels
from radhar_cli.errors import FolderError
from radhar_cli.files.untrusted import regular_size
from radhar_cli.numerics.arrays import Levels

# No format that runs a program: EPS, whatever its file is called, would start Ghostscript.
FORMATS = ("PNG", "JPEG", "BMP", "TIFF", "WEBP")
MAX_SIDE = 8192  # px; largest image size of a config
MAX_FILE = 4 * MAX_SIDE**2  # bytes

SUFFIXES = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp"}


def image_size(path: Path) -> tuple[int, int]:
    """Read the size (H, W) of an image file from its header."""
    with _open_image(path, None) as image:
        return image.height, image.width


def read_rgb(path: Path, size: tuple[int, int] | None = None) -> Levels:
    """Read an image file as RGB [H, W, 3]; 16-bit greys are scaled, transparency is dropped.

    Args:
        path: the file.
        size: (H, W) that it should have; None for any.

    Raises:
        FolderError: the file is no image of FORMATS, damaged, or of another size.
    """
    with _open_image(path, size) as image:
        return _rgb(image)


def luminance(rgb: Levels) -> Levels:
    """Brightness [H, W] of RGB [H, W, 3] after ITU-R BT.601.

    One channel after the other: an image may have 67 million pixels.
    """
    total = np.full(rgb.shape[:-1], 500, dtype=np.uint32)
    for channel, weight in enumerate((299, 587, 114)):
        total += rgb[..., channel] * np.uint32(weight)
    total //= 1000
    return total.astype(np.uint8)


def _rgb(image: Image.Image) -> Levels:
    """RGB [H, W, 3] of an open image."""
    if image.mode.startswith("I;16"):
        grey = np.asarray(image).astype(np.uint32)
        return np.repeat(((grey + 128) // 257).astype(np.uint8)[..., None], 3, axis=-1)
    return np.asarray(image.convert("RGB"))


def read_gray(
    path: Path,
    size: tuple[int, int] | None = None,
    brightness: Callable[[Levels], Levels] = luminance,
) -> Levels:
    """Read the levels [H, W] of an image file: the indices of a PNG of radhar, else its brightness.

    Args:
        path: the file.
        size: (H, W) that it should have; None for any.
        brightness: function that makes levels [H, W] of RGB [H, W, 3].

    Raises:
        FolderError: the file is no image of FORMATS, damaged, or of another size.
    """
    with _open_image(path, size) as image:
        levels = stored_levels(image)
        return brightness(_rgb(image)) if levels is None else levels


def gray_of_bytes(data: bytes, where: Path) -> Levels:
    """Levels [H, W] of the bytes of an image file, as `read_gray` reads them of the file.

    Args:
        where: name of the image in messages.
    """
    with _open_image(where, None, data) as image:
        levels = stored_levels(image)
        return luminance(_rgb(image)) if levels is None else levels


@contextmanager
def _open_image(
    path: Path, size: tuple[int, int] | None, data: bytes | None = None
) -> Iterator[Image.Image]:
    """Open an image and check its header; errors of Pillow's parsers become a FolderError."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if (regular_size(path) if data is None else len(data)) > MAX_FILE:
                raise FolderError(f"{path}: should be an image of at most {MAX_FILE} bytes")
            source = path if data is None else io.BytesIO(data)
            with Image.open(source, formats=FORMATS) as image:
                problem = _header_problem(image, size)
                if problem is not None:
                    raise FolderError(f"{path}: {problem}")
                yield image
    except FolderError:
        raise
    except Exception as error:  # Pillow raises whatever its parsers meet
        reason = str(error).partition("\n")[0]
        damaged = f"is not an image, or is truncated ({reason})"
        raise FolderError(f"{path}: {getattr(error, 'strerror', None) or damaged}") from None


def _header_problem(image: Image.Image, size: tuple[int, int] | None) -> str | None:
    """Describe the problem with the size or the mode of an image; None without one."""
    height, width = image.height, image.width
    if size is not None and (height, width) != size:
        return (
            f"is {height} x {width} px; should be {size[0]} x {size[1]} "
            "(--resize brings it there, of train with --init)"
        )
    if not 1 <= min(height, width) <= max(height, width) <= MAX_SIDE:
        return f"is {height} x {width} px; should be from 1 x 1 to {MAX_SIDE} x {MAX_SIDE}"
    if getattr(image, "is_animated", False):
        return "holds several pictures; should hold one"
    if image.mode in ("I", "F"):
        return f"its mode is {image.mode}; should be 8 or 16 bits a channel"
    return None
