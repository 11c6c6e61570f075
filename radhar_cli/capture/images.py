"""Existing images as samples: a tree of class folders, or an .npz of images or masks.

An .npz has one array of images [N, H, W] (uint8 or bool; masks of 0 and 1 become 0 and 255),
`label` [N], indices into `classes` or texts, and optionally `person` [N].
"""

import hashlib
import zipfile
from functools import lru_cache
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.capture.array_files import check_npz
from radhar_cli.capture.parser_errors import parser_errors_as_capture_errors
from radhar_cli.dataset.image_file import SUFFIXES, image_size, read_gray
from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import refuse_outside, regular_size
from radhar_cli.numerics.arrays import Levels

MAX_NPZ = 2**29  # bytes of its images, which are held


class ImageListing(NamedTuple):
    """Images of a tree or an .npz, with their checksum and size."""

    parts: list[dict[str, Any]]  # {file, label, person} of each
    sha256: dict[str, str]  # {name of the tree or .npz: checksum of all of them}
    size: tuple[int, int]  # (H, W) of the first


def are_images(path: Path) -> bool:
    """Whether a path is a tree of images, or an .npz."""
    return path.is_dir() or path.suffix.lower() == ".npz"


def is_image(file: str) -> bool:
    """Whether a part's file is an image, or one of an .npz, `masks.npz/12`."""
    place = PurePosixPath(file)
    return place.suffix.lower() in SUFFIXES or place.parent.suffix.lower() == ".npz"


def list_images(path: Path, packed: bool) -> ImageListing:
    """List the images of a tree of class folders, or of an .npz.

    Args:
        path: the tree, or the .npz.
        packed: whether each byte holds eight columns as bits.

    Raises:
        CaptureError: there are no images, or they are damaged.
    """
    if path.is_dir():
        return _list_tree(path)
    with parser_errors_as_capture_errors(str(path)):
        regular_size(path)
    images, label, person = _load_npz(path, packed, path.stat().st_mtime_ns)
    with path.open("rb") as file:
        total = hashlib.file_digest(file, "sha256").hexdigest()
    parts = [
        {
            "file": f"{path.name}/{number}",
            "label": str(label[number]),
            "person": None if person is None else str(person[number]),
        }
        for number in range(len(images))
    ]
    return ImageListing(parts, {path.name: total}, (images.shape[1], images.shape[2]))


def _list_tree(path: Path) -> ImageListing:
    """List the images of a tree of class folders."""
    files = sorted(file for file in path.glob("*/*") if file.suffix.lower() in SUFFIXES)
    if not files:
        raise CaptureError(f"{path}: should hold a folder of images for each class")
    total = hashlib.sha256()
    parts = []
    for file in files:
        refuse_outside(file, path)
        with file.open("rb") as data:
            total.update(hashlib.file_digest(data, "sha256").digest())
        label = file.parent.name
        parts.append({"file": f"{label}/{file.name}", "label": label, "person": None})
    return ImageListing(parts, {path.name: total.hexdigest()}, image_size(files[0]))


@lru_cache(maxsize=2)
def _load_npz(
    path: Path, packed: bool, changed: int
) -> tuple[Levels, NDArray[Any], NDArray[Any] | None]:
    """Read (images [N, H, W], label [N], person [N] or None) of an .npz, unpacking packed bits."""
    del changed
    with parser_errors_as_capture_errors(str(path)), zipfile.ZipFile(path) as archive:
        shapes = check_npz(archive)
        wide = [name for name, (shape, kind) in shapes.items() if len(shape) == 3 and kind in "ub"]
        wide = [name for name in wide if name in ("masks", "images")] or wide
        if len(wide) != 1 or "label" not in shapes:
            raise ValueError(
                "should hold one array of images [N, H, W], uint8 or bool (named masks or images "
                "if there are others), and label"
            )
        if int(np.prod(shapes[wide[0]][0], dtype=object)) > MAX_NPZ:
            raise ValueError(f"holds more than {MAX_NPZ} bytes of images")
        with np.load(path, allow_pickle=False) as arrays:
            values, label = arrays[wide[0]], _as_text(arrays["label"].ravel())
            classes = _as_text(arrays["classes"].ravel()) if "classes" in shapes else None
            person = _as_text(arrays["person"].ravel()) if "person" in shapes else None
        if values.dtype not in (np.uint8, np.bool_):
            raise ValueError(f"{wide[0]} is of {values.dtype}; should be uint8 or bool")
        images = np.unpackbits(values.view(np.uint8), axis=2) if packed else values.view(np.uint8)
        if images.max(initial=0) <= 1:
            images = images * np.uint8(255)
        if label.dtype.kind in "iu":
            if classes is None or not ((label >= 0) & (label < classes.size)).all():
                raise ValueError("label should be indices into classes, or texts")
            label = classes[label]
        if label.dtype.kind != "U" or len(label) != len(images):
            raise ValueError(f"label should name the class of each of {len(images)} images")
        if person is not None and len(person) != len(images):
            raise ValueError(f"person should name the person in each of {len(images)} images")
    return images, label, person


def _as_text(values: NDArray[Any]) -> NDArray[Any]:
    """Decode bytes as text; leave anything else as it is."""
    return np.char.decode(values, "ascii", "replace") if values.dtype.kind == "S" else values


def read_image(folder: Path, file: str, size: tuple[int, int], packed: bool) -> Levels:
    """Read the levels [H, W] of an image.

    Args:
        folder: folder of the manifest.
        file: image file, or image of an .npz (`masks.npz/12`), below the folder.
        size: (H, W) that it should have.
        packed: whether each byte of an .npz holds eight columns as bits.

    Raises:
        CaptureError: it is missing, or has another size.
        FolderError: the same, of an image file.
    """
    place = PurePosixPath(file)
    if place.parent.suffix.lower() != ".npz":
        return read_gray(folder / file, size)
    path = folder / place.parent
    images = _load_npz(path, packed, path.stat().st_mtime_ns)[0]
    number = int(place.name) if place.name.isdecimal() else len(images)
    if number >= len(images) or images.shape[1:] != size:
        raise CaptureError(f"{path}: image {place.name}: is missing, or not {size[0]} x {size[1]}")
    levels: Levels = images[number]
    return levels
