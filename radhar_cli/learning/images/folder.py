"""Images in class folders, as torchvision's ImageFolder reads them: ours or anyone's."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image, UnidentifiedImageError

from radhar_cli.arrays import Levels
from radhar_cli.dataset.layout import CONFIG, PNG
from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.learning.images.image_set import (
    SPLIT_NAMES,
    ImageSet,
    Resized,
    class_order,
    colour_codes,
    luminance,
    repeated,
)

_WANTED = (
    "should be dataset.h5, a folder that `radhar generate` wrote, or a tree <class>/<image>.png or "
    "<train|val|test>/<class>/<image>.png"
)
SUFFIXES = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp"}


@dataclass(frozen=True)
class FilePixels:
    """One file a row.

    Attributes:
        files: [N].
        kind: "rgb" or "gray".
        size: (H, W) that all of them should have, None for any.
        table: for "gray", the colour table [256, 3] that ours were drawn with.
    """

    files: tuple[Path, ...]
    kind: str
    size: tuple[int, int] | None
    table: Levels | None

    def read(self, row: int) -> Levels:
        """RGB [H, W, 3] of a row.

        Raises:
            FolderError: it is damaged, or of another size.
        """
        return read_image(self.files[row], self.kind, self.size, self.table)


def read_image(
    path: Path, kind: str, size: tuple[int, int] | None, table: Levels | None = None
) -> Levels:
    """Read an image file as RGB [H, W, 3].

    Args:
        path: of the file.
        kind: "rgb" or "gray", one channel three times.
        size: (H, W) that it should have, or None.
        table: the colour table [256, 3] it was drawn with, to find the levels again for "gray".

    Raises:
        FolderError: it is damaged, or of another size.
    """
    try:
        with Image.open(path) as image:
            rgb = _rgb(image)
    except (OSError, SyntaxError, ValueError, UnidentifiedImageError) as error:
        raise FolderError(f"{path}: is no image, or a truncated one ({error})") from None
    if size is not None and rgb.shape[:2] != size:
        raise FolderError(
            f"{path}: is {rgb.shape[0]} x {rgb.shape[1]} px; should be {size[0]} x {size[1]} "
            "(eval and predict bring it there with --resize)"
        )
    if kind == "rgb":
        return rgb
    levels = _levels(rgb, table) if table is not None else None
    return repeated(luminance(rgb) if levels is None else levels)


def _rgb(image: Image.Image) -> Levels:
    """Eight bits a channel; 16-bit greys are scaled, transparency is dropped."""
    if image.mode.startswith("I;16"):
        wide = np.asarray(image).astype(np.uint32)
        return repeated(((wide + 128) // 257).astype(np.uint8))
    if image.mode in ("I", "F"):
        raise ValueError(f"its mode is {image.mode}; should be 8 or 16 bits a channel")
    return np.asarray(image.convert("RGB"))


def _levels(rgb: Levels, table: Levels) -> Levels | None:
    """Levels [H, W] of an image that was drawn through a colour table; None if it was not."""
    codes, wanted = colour_codes(table), colour_codes(rgb)
    order = np.argsort(codes, kind="stable")  # of levels that share a colour the lowest is found
    found = order[np.minimum(np.searchsorted(codes[order], wanted), 255)]
    return found.astype(np.uint8) if np.array_equal(codes[found], wanted) else None


def folder_images(root: Path, map_name: str | None, kind: str, any_size: bool = False) -> ImageSet:
    """Open a tree of images: class folders, or train, val and test with class folders in them.

    Args:
        any_size: images may differ in size; `size` is that of the first.

    Raises:
        FolderError: it is no such tree; the message says what is there.
    """
    own = our_map(root)
    if map_name is not None and map_name != own:
        if not (root / map_name).is_dir():
            raise FolderError(f"{root}: has no map {map_name!r}; it is a tree of images")
        root = root / map_name
        own = map_name
    folders = _folders(root)
    parts = {name: SPLIT_NAMES[name.lower()] for name in folders if name.lower() in SPLIT_NAMES}
    if parts:
        found = [
            (split, name, file)
            for part, split in sorted(parts.items(), key=lambda item: item[1])
            for name in _folders(root / part)
            for file in _files(root / part / name)
        ]
        empty = {name for part in parts for name in _folders(root / part)}
    else:
        found = [(-1, name, file) for name in folders for file in _files(root / name)]
        empty = set(folders)
    empty -= {name for _, name, _ in found}
    if not found:
        maps = [name for name in folders if _folders(root / name)]
        hint = f"--map {maps[0]} takes one of its maps" if maps and not parts else _WANTED
        raise FolderError(f"{root}: holds no class folders with images; {hint}")
    if empty:
        raise FolderError(f"{root}: the class {sorted(empty)[0]!r} has no image")
    classes = class_order({name for _, name, _ in found})
    found.sort(key=lambda item: (item[0], classes.index(item[1]), item[2].name))
    files = tuple(file for _, _, file in found)
    size = _size(files[0])
    return ImageSet(
        where=root,
        map=own,
        classes=classes,
        label=np.array([classes.index(name) for _, name, _ in found], dtype=np.intp),
        split=np.array([split for split, _, _ in found], dtype=np.uint8) if parts else None,
        names=_names(found),
        scenes=None,
        size=size,
        pixels=FilePixels(
            files, kind, None if any_size else size, our_table(root) if kind == "gray" else None
        ),
    )


def _names(found: Sequence[tuple[int, str, Path]]) -> tuple[str, ...]:
    """<class>/<image> of (split, class, file), with the ending where only that tells two apart."""
    alike = Counter((split, name, file.stem) for split, name, file in found)
    return tuple(
        f"{name}/{file.stem if alike[split, name, file.stem] == 1 else file.name}"
        for split, name, file in found
    )


def loose_images(
    files: Sequence[Path], size: tuple[int, int], kind: str, resize: bool = False
) -> ImageSet:
    """Single files without classes, of a size (H, W) or brought to it."""
    where = files[0].parent
    table = our_table(where) if kind == "gray" else None
    pixels = FilePixels(tuple(files), kind, None if resize else size, table)
    return ImageSet(
        where=where,
        map=None,
        classes=(),
        label=np.zeros(len(files), dtype=np.intp),
        split=None,
        names=tuple(map(str, files)),
        scenes=None,
        size=size,
        pixels=Resized(pixels, size) if resize else pixels,
    )


def our_table(inside: Path) -> Levels | None:
    """The colour table of the data set that an image lies in, None if it is not one of ours."""
    from radhar_cli.config import load_config
    from radhar_cli.figures.colour import colour_table

    found = _our_png_folder(inside)
    if found is None:
        return None
    try:
        return colour_table(load_config(found[0].parent / CONFIG).image.colour_map)
    except ConfigError:
        return None


def our_map(inside: Path) -> str | None:
    """The map whose images lie in a folder that `radhar generate` wrote, None elsewhere."""
    found = _our_png_folder(inside)
    return found[1] if found else None


def _our_png_folder(inside: Path) -> tuple[Path, str] | None:
    """(png folder, map) of a path inside a data set's images."""
    whole = inside.resolve()
    for folder, below in zip(whole.parents, (whole, *whole.parents), strict=False):
        if folder.name == PNG and (folder.parent / CONFIG).is_file():
            return folder, below.name
    return None


def _folders(root: Path) -> list[str]:
    return sorted(p.name for p in root.iterdir() if p.is_dir() and not p.name.startswith("."))


def _files(folder: Path) -> list[Path]:
    return [p for p in folder.iterdir() if is_image(p)]


def is_image(path: Path) -> bool:
    """Whether a path is an image file by its name, and none that a file manager hides."""
    return path.suffix.lower() in SUFFIXES and not path.name.startswith(".") and path.is_file()


def image_size(path: Path) -> tuple[int, int]:
    """(H, W) of an image file by its header alone.

    Raises:
        FolderError: it is no image.
    """
    try:
        with Image.open(path) as image:
            return image.height, image.width
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise FolderError(f"{path}: is no image ({error})") from None


def _size(path: Path) -> tuple[int, int]:
    rgb = read_image(path, "rgb", None)
    return int(rgb.shape[0]), int(rgb.shape[1])
