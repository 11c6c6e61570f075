"""Images in class folders, as torchvision's ImageFolder reads them: ours or anyone's."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image, UnidentifiedImageError

from radhar_cli.arrays import Levels
from radhar_cli.dataset.layout import CONFIG
from radhar_cli.errors import ConfigError, FolderError, did_you_mean
from radhar_cli.learning.images import SPLIT_NAMES, ImageSet, class_order, luminance, repeated

SUFFIXES = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp"}


@dataclass(frozen=True)
class FilePixels:
    """One file a row.

    Attributes:
        levels_of: for "gray", the level of every 24-bit colour of our colour table.
    """

    files: tuple[Path, ...]
    kind: str
    size: tuple[int, int]
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
            rgb = np.asarray(image.convert("RGB"))
    except (OSError, SyntaxError, ValueError, UnidentifiedImageError) as error:
        raise FolderError(f"{path}: is no image, or a truncated one ({error})") from None
    if size is not None and rgb.shape[:2] != size:
        raise FolderError(
            f"{path}: is {rgb.shape[0]} x {rgb.shape[1]} px; should be {size[0]} x {size[1]}"
        )
    if kind == "rgb":
        return rgb
    levels = _levels(rgb, table) if table is not None else None
    return repeated(luminance(rgb) if levels is None else levels)


def _levels(rgb: Levels, table: Levels) -> Levels | None:
    """Levels [H, W] of an image that was drawn through a colour table; None if it was not."""
    shift = np.array([1 << 16, 1 << 8, 1])
    codes, wanted = table @ shift, rgb @ shift
    order = np.argsort(codes, kind="stable")
    found = order[np.minimum(np.searchsorted(codes[order], wanted), 255)]
    return found.astype(np.uint8) if np.array_equal(codes[found], wanted) else None


def folder_images(root: Path, map_name: str | None, kind: str) -> ImageSet:
    """Open a tree of images: class folders, or train, val and test with class folders in them.

    Raises:
        FolderError: it is no such tree; the message says what is there.
    """
    if map_name is not None and (root / map_name).is_dir():
        root = root / map_name
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
        what = f"the folders {', '.join(folders[:6])}" if folders else "no folders"
        raise FolderError(
            f"{root}: holds {what}, but no class folders with images; should be dataset.h5, a "
            "folder that `radhar generate` wrote, or a tree <class>/<image>.png or "
            "<train|val|test>/<class>/<image>.png"
        )
    if empty:
        raise FolderError(f"{root}: the class {sorted(empty)[0]!r} has no image")
    classes = class_order({name for _, name, _ in found})
    found.sort(key=lambda item: (item[0], classes.index(item[1]), item[2].name))
    files = tuple(file for _, _, file in found)
    size = _size(files[0])
    return ImageSet(
        where=root,
        map=map_name,
        classes=classes,
        label=np.array([classes.index(name) for _, name, _ in found], dtype=np.intp),
        split=np.array([split for split, _, _ in found], dtype=np.uint8) if parts else None,
        names=tuple(f"{name}/{file.stem}" for _, name, file in found),
        scenes=None,
        size=size,
        pixels=FilePixels(files, kind, size, our_table(root) if kind == "gray" else None),
    )


def our_table(inside: Path) -> Levels | None:
    """The colour table of the data set that an image lies in, None if it is not one of ours."""
    from radhar_cli.config import load_config
    from radhar_cli.figures.colour import colour_table

    for folder in inside.resolve().parents:
        if folder.name == "png" and (folder.parent / CONFIG).is_file():
            try:
                return colour_table(load_config(folder.parent / CONFIG).image.colour_map)
            except ConfigError:
                return None
    return None


def _folders(root: Path) -> list[str]:
    return sorted(p.name for p in root.iterdir() if p.is_dir() and not p.name.startswith("."))


def _files(folder: Path) -> list[Path]:
    return [p for p in folder.iterdir() if p.suffix.lower() in SUFFIXES and p.is_file()]


def _size(path: Path) -> tuple[int, int]:
    rgb = read_image(path, "rgb", None)
    return int(rgb.shape[0]), int(rgb.shape[1])


def split_named(name: str) -> str:
    """The split that a user names.

    Raises:
        FolderError: no such split.
    """
    known = {**SPLIT_NAMES, "all": -1}
    if name not in known:
        hint = did_you_mean(name, known, "the splits are train, val, test and all")
        raise FolderError(f"--split {name}: is no split; {hint}")
    return name
