"""Images in class folders, as torchvision's ImageFolder reads them, from radhar or elsewhere."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import itemgetter
from pathlib import Path
from typing import NamedTuple

import numpy as np

from radhar_cli.config.image import DEFAULT_COLOUR_MAP
from radhar_cli.dataset.files import read_bytes
from radhar_cli.dataset.image_file import SUFFIXES, image_size, luminance, read_gray, read_rgb
from radhar_cli.dataset.layout import CLASSES, CONFIG, PNG
from radhar_cli.errors import FolderError
from radhar_cli.files.untrusted import refuse_outside
from radhar_cli.learning.images.colour_maps import PICTURES_LOOKED_AT, colour_map_of, levels_behind
from radhar_cli.learning.images.image_set import SPLIT_NAMES, ImageSet
from radhar_cli.learning.images.sample_table import SampleTable, objects
from radhar_cli.learning.registry import Kind
from radhar_cli.numerics.arrays import Levels

_WANTED = (
    "should be dataset.h5, a folder that `radhar generate` wrote, or a tree <class>/<image>.png or "
    "<train|val|test>/<class>/<image>.png"
)
NO_SPLIT = -1  # of an image in a tree without splits
MAX_CLASSES = 128  # a confusion matrix of them can still be drawn


@dataclass(frozen=True)
class FilePixels:
    """One image file per row."""

    files: tuple[Path, ...]  # [N]
    kind: Kind  # "rgb" or "gray"
    size: tuple[int, int] | None  # (H, W) that all of them should have, None for any
    colours: str | None = None  # colour map whose levels are one channel; None takes the luminance

    def read(self, row: int) -> Levels:
        """RGB [H, W, 3] or levels [H, W, 1] of a row."""
        if self.kind == "rgb":
            return read_rgb(self.files[row], self.size)
        levels_of = None if self.colours is None else partial(levels_behind, name=self.colours)
        return read_gray(self.files[row], self.size, levels_of or luminance)[..., None]

    def with_recognised_colours(self) -> "FilePixels":
        """Pixels of these files that know the colour map in which some of them are drawn."""
        spread = np.linspace(
            0, len(self.files) - 1, min(PICTURES_LOOKED_AT, len(self.files))
        ).astype(int)
        samples = (read_rgb(self.files[row], self.size) for row in spread.tolist())
        return replace(self, colours=colour_map_of(samples))

    def notes(self, where: Path) -> tuple[str, ...]:
        """Note that levels are taken from the colours of the pictures, where they are."""
        if self.kind == "rgb" or self.colours in (None, DEFAULT_COLOUR_MAP, "gray"):
            return ()
        return (f"{where}: drawn in {self.colours}; its levels are learned from, not brightness",)


def open_tree(
    root: Path,
    map_name: str | None,
    kind: Kind,
    any_size: bool = False,
    looks_at_colours: bool = True,
) -> ImageSet:
    """Open a tree of images: class folders, or train, val and test with class folders in them.

    Args:
        root: folder of the tree, or one that holds a tree for each map.
        map_name: map to open where there are several; None takes `root` itself.
        kind: "rgb" or "gray".
        any_size: images may differ in size; `size` is that of the first.
        looks_at_colours: read some pictures to recognise their colour map.

    Raises:
        FolderError: no such map, no class folders with images, a class without any, images of
            several sizes, or a link that leads out of `root`.
    """
    folder_map, tree = map_of_folder(root), root
    if map_name is not None and map_name != folder_map:
        if map_name not in _folders(root, tree):
            raise FolderError(f"{root}: has no map {map_name!r}; it is a tree of images")
        root = root / map_name
        folder_map = map_name
    listed = _list_tree(root, tree)
    classes = _classes(root, {image.class_name for image in listed})
    if len(classes) > MAX_CLASSES:
        raise FolderError(f"{root}: has {len(classes)} classes; should have at most {MAX_CLASSES}")
    listed.sort(key=lambda image: (image.split, classes.index(image.class_name), image.file.name))
    files = tuple(image.file for image in listed)
    size = image_size(files[0])
    images = open_pictures(root, files, kind, None if any_size else size, looks_at_colours)
    samples = replace(
        images.samples,
        label=np.array([classes.index(image.class_name) for image in listed], np.intp),
        name=objects(_names(listed)),
        split=np.array([image.split for image in listed], np.uint8)
        if listed[0].split != NO_SPLIT
        else None,
    )
    return replace(images, map=folder_map, classes=classes, samples=samples, size=size)


class _ListedImage(NamedTuple):
    """An image file of a tree, with class and split by its folders."""

    split: int  # number of the split; NO_SPLIT in a tree without splits
    class_name: str
    file: Path


def _list_tree(root: Path, tree: Path) -> list[_ListedImage]:
    """Images of the class folders in `root`, or of those in its train, val and test.

    Args:
        root: folder of class folders or splits.
        tree: folder out of which no link may lead.

    Raises:
        FolderError: there is none, or a class folder without images.
    """
    folders = _folders(root, tree)
    split_folders = {
        name: SPLIT_NAMES[name.lower()] for name in folders if name.lower() in SPLIT_NAMES
    }
    # of each split, in order: its number, and the folder of its class folders
    parts = [
        (split, root / name) for name, split in sorted(split_folders.items(), key=itemgetter(1))
    ]
    class_folders = [
        (split, name, part / name)
        for split, part in parts or [(NO_SPLIT, root)]
        for name in (_folders(part, tree) if parts else folders)
    ]
    listed = [
        _ListedImage(split, name, file)
        for split, name, folder in class_folders
        for file in image_files(folder, tree)
    ]
    if not listed:
        maps = [name for name in folders if _folders(root / name, tree)]
        hint = f"--map {maps[0]} takes one of its maps" if maps and not parts else _WANTED
        raise FolderError(f"{root}: holds no class folders with images; {hint}")
    empty = {name for _, name, _ in class_folders} - {image.class_name for image in listed}
    if empty:
        raise FolderError(
            f"{root}: the class {sorted(empty)[0]!r} has no image; {_empty_hint(empty, listed)}"
        )
    return listed


def _empty_hint(empty: set[str], images: Sequence[_ListedImage]) -> str:
    """Advice on folders without images beside others that have some."""
    classes = sorted({image.class_name for image in images})
    if len(classes) < 2:
        return f"{classes[0]!r} alone has images, so this may be no data set; {_WANTED}"
    return "every folder beside those of the classes should hold images of its class"


def open_pictures(
    where: Path,
    files: Sequence[Path],
    kind: Kind,
    size: tuple[int, int] | None,
    looks_at_colours: bool = True,
) -> ImageSet:
    """Image set of files of which nothing is known but the colour map that they are drawn in.

    Args:
        where: file or folder that messages name.
        files: image files, one a row.
        kind: "rgb" or "gray".
        size: (H, W) that all of them should have, None for any.
        looks_at_colours: read some pictures to recognise their colour map.
    """
    pixels = FilePixels(tuple(files), kind, size)
    if looks_at_colours:
        pixels = pixels.with_recognised_colours()
    return ImageSet(
        where=where,
        map=None,
        classes=("unknown",),
        samples=SampleTable(
            label=np.zeros(len(files), np.intp),
            name=objects(map(str, files)),
            source=np.zeros(len(files), np.intp),
        ),
        size=size or image_size(files[0]),
        pixels=pixels,
        kind=kind,
        channels=1 if kind == "gray" else 3,
        colours=pixels.colours if kind == "rgb" else None,
        notes=pixels.notes(where),
    )


def _classes(root: Path, present: set[str]) -> tuple[str, ...]:
    """Name of every label of a tree: names of its classes.txt, else of the folders by the alphabet.

    `generate` writes that file beside the splits of a map; ImageFolder numbers by the alphabet.
    """
    for folder in (root, root.parent):
        path = folder / CLASSES
        if path.is_file() and not path.is_symlink():
            names = tuple(read_bytes(path).decode(errors="replace").splitlines())
            if present <= set(names) and len(set(names)) == len(names):
                return names
    return tuple(sorted(present))


def _names(images: Sequence[_ListedImage]) -> Iterator[str]:
    """Yield <class>/<image> of each, with the ending where only that tells two apart."""
    stems = Counter((split, name, file.stem) for split, name, file in images)
    for split, name, file in images:
        file_name = file.name if file.parent.name == name else f"{file.parent.name}/{file.name}"
        yield f"{name}/{file.stem if stems[split, name, file.stem] == 1 else file_name}"


def map_of_folder(folder: Path) -> str | None:
    """Map whose images lie in a folder that `radhar generate` wrote, None elsewhere."""
    resolved = folder.resolve()
    for parent, child in zip(resolved.parents, (resolved, *resolved.parents), strict=False):
        if parent.name == PNG and (parent.parent / CONFIG).is_file():
            return child.name
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
    numbered_folders = (p for p in _visible(folder, inside) if p.name.isdecimal() and p.is_dir())
    folders = (folder, *sorted(numbered_folders))
    return sorted(p for place in folders for p in _visible(place, inside) if is_image(p))


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
