"""Images in class folders, as torchvision's ImageFolder reads them, from radhar or elsewhere."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from radhar_cli.arrays import Levels
from radhar_cli.dataset.image_file import SUFFIXES, image_size, read_gray, read_rgb
from radhar_cli.dataset.layout import CONFIG, PNG
from radhar_cli.errors import FolderError
from radhar_cli.learning.images.image_set import SPLIT_NAMES, ImageSet, class_order, repeated
from radhar_cli.untrusted import refuse_outside

_WANTED = (
    "should be dataset.h5, a folder that `radhar generate` wrote, or a tree <class>/<image>.png or "
    "<train|val|test>/<class>/<image>.png"
)
MAX_CLASSES = 128  # a confusion matrix of them can still be drawn


@dataclass(frozen=True)
class FilePixels:
    """One image file per row."""

    files: tuple[Path, ...]  # [N]
    kind: str  # "rgb" or "gray"
    size: tuple[int, int] | None  # (H, W) that all of them should have, None for any

    def read(self, row: int) -> Levels:
        """RGB [H, W, 3] of a row, or one channel three times."""
        if self.kind == "rgb":
            return read_rgb(self.files[row], self.size)
        return repeated(read_gray(self.files[row], self.size))


def folder_images(root: Path, map_name: str | None, kind: str, any_size: bool = False) -> ImageSet:
    """Open a tree of images: class folders, or train, val and test with class folders in them.

    Args:
        any_size: images may differ in size; `size` is that of the first.
    """
    own, inside = our_map(root), root
    if map_name is not None and map_name != own:
        if map_name not in _folders(root, inside):
            raise FolderError(f"{root}: has no map {map_name!r}; it is a tree of images")
        root = root / map_name
        own = map_name
    folders = _folders(root, inside)
    parts = {name: SPLIT_NAMES[name.lower()] for name in folders if name.lower() in SPLIT_NAMES}
    if parts:
        images = [
            (split, name, file)
            for part, split in sorted(parts.items(), key=lambda item: item[1])
            for name in _folders(root / part, inside)
            for file in image_files(root / part / name, inside)
        ]
        empty = {name for part in parts for name in _folders(root / part, inside)}
    else:
        images = [(-1, name, file) for name in folders for file in image_files(root / name, inside)]
        empty = set(folders)
    empty -= {name for _, name, _ in images}
    if not images:
        maps = [name for name in folders if _folders(root / name, inside)]
        hint = f"--map {maps[0]} takes one of its maps" if maps and not parts else _WANTED
        raise FolderError(f"{root}: holds no class folders with images; {hint}")
    if empty:
        raise FolderError(f"{root}: the class {sorted(empty)[0]!r} has no image")
    classes = class_order({name for _, name, _ in images})
    if len(classes) > MAX_CLASSES:
        raise FolderError(f"{root}: has {len(classes)} classes; should have at most {MAX_CLASSES}")
    images.sort(key=lambda item: (item[0], classes.index(item[1]), item[2].name))
    files = tuple(file for _, _, file in images)
    size = image_size(files[0])
    return ImageSet(
        where=root,
        map=own,
        classes=classes,
        label=np.array([classes.index(name) for _, name, _ in images], dtype=np.intp),
        split=np.array([split for split, _, _ in images], dtype=np.uint8) if parts else None,
        names=_names(images),
        scenes=None,
        size=size,
        pixels=FilePixels(files, kind, None if any_size else size),
    )


def _names(images: Sequence[tuple[int, str, Path]]) -> tuple[str, ...]:
    """<class>/<image> of (split, class, file), with the ending where only that tells two apart."""
    alike = Counter((split, name, file.stem) for split, name, file in images)
    names = []
    for split, name, file in images:
        below = file.name if file.parent.name == name else f"{file.parent.name}/{file.name}"
        names.append(f"{name}/{file.stem if alike[split, name, file.stem] == 1 else below}")
    return tuple(names)


def our_map(inside: Path) -> str | None:
    """The map whose images lie in a folder that `radhar generate` wrote, None elsewhere."""
    whole = inside.resolve()
    for folder, below in zip(whole.parents, (whole, *whole.parents), strict=False):
        if folder.name == PNG and (folder.parent / CONFIG).is_file():
            return below.name
    return None


def _folders(root: Path, inside: Path) -> list[str]:
    """Names of the folders in `root`, of which each may become a class."""
    names = sorted(p.name for p in _visible(root, inside) if p.is_dir())
    for name in names:
        if not name.isprintable():
            raise FolderError(f"{root}: the folder {name!r} should have a name of plain text")
    return names


def image_files(folder: Path, inside: Path) -> list[Path]:
    """Image files of a class folder and of numbered folders in it, in the order of their names."""
    numbered = (p for p in _visible(folder, inside) if p.name.isdecimal() and p.is_dir())
    places = (folder, *sorted(numbered))
    return sorted(p for place in places for p in _visible(place, inside) if is_image(p))


def _visible(folder: Path, inside: Path) -> Iterator[Path]:
    """Entries of a folder that are not hidden; a link that leads out of `inside` is refused."""
    for path in folder.iterdir():
        if path.name.startswith("."):
            continue
        if path.is_symlink() and (path.is_dir() or is_image(path)):
            refuse_outside(path, inside)
        yield path


def is_image(path: Path) -> bool:
    """Whether a path is an image file by its name, and none that a file manager hides."""
    return path.suffix.lower() in SUFFIXES and not path.name.startswith(".") and path.is_file()
