"""The two data sets that are compared: images, axes, groups and scales."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from radhar_cli.capture.images import is_image
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.errors import FolderError, did_you_mean
from radhar_cli.learning.images.folder import map_of_folder
from radhar_cli.learning.images.image_set import ImageSet, Resized
from radhar_cli.learning.images.opening import is_h5, open_images
from radhar_cli.learning.images.sequences import CLOUDS, Opened
from radhar_cli.numerics.arrays import Float, Index, Levels

MAPS = "maps.h5"  # that `radhar process` writes
MAX_SIDE = 512  # px; larger images are brought there
ASSUMED_DB = 40.0  # that levels span where a file does not say
TWO_VALUED = 8  # images looked at to tell masks from grey


@dataclass(frozen=True)
class Side:
    """One of two data sets that are compared, its N images."""

    images: ImageSet
    classes: dict[str, Index]  # {class, by the common name: rows}
    left_out: dict[str, int]  # {class of its own: images} that are not compared
    size: tuple[int, int]  # (H, W), px, to which images are brought
    # [N, 4] left, right, bottom, top (s; Hz or m) of every image; None where they are not known
    extent: Float | None
    # [N] who is in it, where that is known, or which recording; else a number of its own
    group: Index
    dynamic_range_db: float | None  # that levels span; None where it is not known, or of masks
    masks: bool
    clouds: Opened | None = None  # data set whose clouds are compared; None of maps

    def levels(self, row: int) -> Levels:
        """Levels [H, W] of an image."""
        return self.images.pixels.read(row)[..., 0]

    def power(self, levels: Levels) -> Float:
        """Power [...] of levels [...], over the power of the brightest level."""
        return 10 ** ((self.dynamic_range_db or ASSUMED_DB) / 10 * (levels / 255.0 - 1))


@dataclass(frozen=True)
class Pair:
    """Two data sets that are compared: simulated, measured."""

    sides: tuple[Side, Side]

    @property
    def clouds(self) -> bool:
        """Whether point clouds are compared, not the maps that are drawn of them."""
        return all(side.clouds is not None for side in self.sides)

    @property
    def ranges(self) -> bool:
        """Whether they hold range-time maps."""
        return any(side.images.map == "rtm" for side in self.sides)

    @property
    def axes(self) -> bool:
        """Whether edges of the images are used; else all is counted in px."""
        return not self.clouds and all(side.extent is not None for side in self.sides)

    @property
    def power(self) -> bool:
        """Whether there are statistics of power."""
        return not (self.ranges or self.clouds) and all(
            side.dynamic_range_db is not None for side in self.sides
        )

    @property
    def units(self) -> dict[str, str]:
        """Units of the axes of the maps: {"rows": unit, "columns": unit}."""
        if not self.axes:
            return {"rows": "px", "columns": "px"}
        return {"rows": "m" if self.ranges else "Hz", "columns": "s"}

    def edges(self, side: Side, row: int) -> tuple[float, float, float, float]:
        """Edges of an image, left, right, bottom and top, in `units`."""
        if self.axes:
            assert side.extent is not None
            left, right, bottom, top = map(float, side.extent[row])
            return left, right, bottom, top
        height, width = side.size
        bottom = 0.0 if self.ranges else -height / 2
        return 0.0, float(width), bottom, bottom + height


def open_sides(
    simulated: Path, measured: Path, map_name: str | None, names: Mapping[str, str | None]
) -> Pair:
    """Open two data sets, classes matched by name, images at the size of the measured ones.

    Args:
        simulated: data set, or tree of images.
        measured: data set, or tree of images.
        map_name: map that is compared, or points; None is the first that both have.
        names: {class in one of them: common name, or None to leave it out}.

    Raises:
        FolderError: data that cannot be used, of other maps, or without a common class.
    """
    paths = (simulated, measured)
    for path in paths:
        _refuse_one_recording(path)
    map_name = map_name or _common_map(paths)
    image_sets = [_open(path, map_name) for path in paths]
    maps = [images.map for images in image_sets]
    if None not in maps and maps[0] != maps[1]:
        raise FolderError(
            f"{simulated}: shows {maps[0]}, {measured} {maps[1]}; --map names one for both"
        )
    known = sorted({name for images in image_sets for name in images.classes})
    for name in names:
        if name not in known:
            hint = did_you_mean(name, known, f"they have {', '.join(known)}")
            raise FolderError(f"{simulated}, {measured}: no class {name!r} (--classes); {hint}")
    rows = [_class_rows(images, names) for images in image_sets]
    common = [name for name in rows[0] if name in rows[1]]
    if not common:
        raise FolderError(
            f"{simulated}: its classes ({', '.join(rows[0])}) are none of those of {measured} "
            f"({', '.join(rows[1])}); --classes FILE maps names"
        )
    height, width = (min(side, MAX_SIDE) for side in image_sets[1].size)
    first, second = (
        _side(path, images, {name: rows_of[name] for name in common}, (height, width))
        for path, images, rows_of in zip(paths, image_sets, rows, strict=True)
    )
    return Pair((first, second))


def _refuse_one_recording(path: Path) -> None:
    """Refuse the maps of one recording, which are no data set."""
    results = path / MAPS if path.is_dir() else path
    if results.name == MAPS and results.is_file():
        raise FolderError(
            f"{results}: holds the maps of one recording, and is no data set: `radhar generate "
            "CONFIG --recordings MANIFEST -o FOLDER` makes a data set of recordings "
            "(docs/guide/measured.md)"
        )


def _common_map(paths: Sequence[Path]) -> str | None:
    """First map of the first of two dataset.h5 that the other has; None where they have none."""
    maps = list[tuple[str, ...]]()
    for path in paths:
        if not path.exists() or not is_h5(path):
            return None
        with open_dataset(path) as data:
            maps.append(tuple(data.maps))
    return next((name for name in maps[0] if name in maps[1]), None)


def _open(path: Path, map_name: str | None) -> ImageSet:
    """Open a data set; a foreign tree, which names no map, has the one that it has."""
    foreign = path.is_dir() and not is_h5(path) and map_of_folder(path) is None
    if foreign and map_name is not None and not (path / map_name).is_dir():
        map_name = None
    return open_images(path, map_name, "gray")


def _class_rows(images: ImageSet, names: Mapping[str, str | None]) -> dict[str, Index]:
    """Rows of each class {common name: rows}, in the order of the images' own classes."""
    numbers: dict[str, list[int]] = {}
    for number, name in enumerate(images.classes):
        common = names.get(name, name)
        if common is not None:
            numbers.setdefault(common, []).append(number)
    return {
        name: np.flatnonzero(np.isin(images.samples.label, own_numbers))
        for name, own_numbers in numbers.items()
    }


def _side(path: Path, images: ImageSet, classes: dict[str, Index], size: tuple[int, int]) -> Side:
    compared_rows = np.concatenate(list(classes.values()))
    counts = np.bincount(
        np.delete(images.samples.label, compared_rows), minlength=len(images.classes)
    ).tolist()
    left_out = {name: n for name, n in zip(images.classes, counts, strict=True) if n}
    looked_at = compared_rows[:: max(1, compared_rows.size // TWO_VALUED)]
    masks = all(_two_valued(images.pixels.read(int(row))) for row in looked_at)
    group, extent, decibels = np.arange(len(images)), None, None
    clouds = None
    if images.samples.person is not None:
        group = np.unique(images.samples.person, return_inverse=True)[1]
    if images.map is not None and is_h5(path):
        with open_dataset(path) as data:
            extent, recorded = data.extents(images.map), data.config.recordings
            if images.map == CLOUDS and CLOUDS in data.products:
                clouds = Opened(data.path)
            if not masks and (recorded is None or not is_image(recorded.parts[0].file)):
                decibels = data.config.image.dynamic_range_db
    at_size = replace(images, pixels=Resized(images.pixels, size))
    return Side(at_size, classes, left_out, size, extent, group, decibels, masks, clouds)


def _two_valued(levels: Levels) -> bool:
    """Whether an image has two levels at most, a dark and a bright one."""
    dark, bright = levels.min(), levels.max()
    return bool(((levels == dark) | (levels == bright)).all() and (bright >= 128 or bright == dark))
