"""Existing images as samples: a tree of class folders, a table of files, an .npz, or Parquet.

A table (CSV with commas, semicolons or tabs, or a YAML list) has a row for each image file, with
its label and optionally its person. An .npz has one array of images [N, H, W] (uint8 or bool; masks
of 0 and 1 become 0 and 255), `label` [N], indices into `classes` or texts, and optionally `person`
[N]; or x_train, y_train, x_test and y_test, as Keras has them. Files of Parquet are called after
the part of the split. Columns and arrays may have any of the names in use for them.
"""

import csv
import hashlib
import io
import re
import zipfile
from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.config.yaml_reader import parse_yaml
from radhar_cli.dataset.image_file import SUFFIXES, image_size, luminance, read_gray
from radhar_cli.dataset.parquet_images import read_parquet_images
from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import refuse_outside, regular_size, text_of
from radhar_cli.motion.activities.vocabulary import plain_word
from radhar_cli.numerics.arrays import Levels
from radhar_cli.readers.captures.array_files import check_npz
from radhar_cli.readers.captures.parser_errors import parser_errors_as_capture_errors

MAX_NPZ = 2**29  # bytes of its images, which are held
MAX_TABLE = 2**22  # bytes
NPZ, PARQUET = ".npz", ".parquet"
# {folder, cell, or beginning of a file's name: part of the split}
SPLIT_WORDS = {
    **dict.fromkeys(("train", "training"), "train"),
    **dict.fromkeys(("val", "valid", "validation", "validate", "dev"), "validation"),
    **dict.fromkeys(("test", "testing"), "test"),
}
MAX_DIGITS = 18  # of a label that is a number
TABLES = {".csv", ".tsv", ".txt", ".yaml", ".yml"}
# Names in use for columns of tables and arrays of an .npz; those that come first are taken.
FILES = (
    *("file", "filename", "file_name", "filepath", "file_path", "path"),
    *("image", "image_path", "image_file", "image_name", "img", "img_path", "picture", "name"),
)
LABELS = ("label", "labels", "class", "class_name", "activity", "category", "target", "y")
SPLITS = ("split", "subset", "partition")
PERSONS = ("person", "persons", "subject", "subjects", "participant", "subject_id", "person_id")
IMAGES = ("masks", "images", "x", "data")
CLASSES = ("classes", "class_names", "target_names")


class ImageListing(NamedTuple):
    """Images of a tree, a table or packed files, with their checksum and size."""

    parts: list[dict[str, Any]]  # {file, label, person, and split where it is known} of each
    sha256: dict[str, str]  # {name of the tree or .npz: checksum of all of them}
    size: tuple[int, int]  # (H, W) of the first


def are_images(path: Path) -> bool:
    """Whether a path is a folder, packed images, or a table whose rows name image files."""
    if path.is_dir() or path.suffix.lower() in (NPZ, PARQUET):
        return True
    if path.suffix.lower() not in TABLES or not path.is_file():
        return False
    rows = _read_rows(path)
    file = _name_of(rows[0], FILES) if rows else None
    return file is not None and _image_file(path.parent, str(rows[0][file])) is not None


def is_image(file: str) -> bool:
    """Whether a part's file is an image, or one of packed ones, `masks.npz/12`."""
    place = PurePosixPath(file)
    return place.suffix.lower() in SUFFIXES or place.parent.suffix.lower() in (NPZ, PARQUET)


def list_images(path: Path, packed: bool) -> ImageListing:
    """List the images of a tree of class folders, of a table, of an .npz, or of Parquet.

    Args:
        path: the tree, the table, the .npz, or Parquet or a folder of it.
        packed: whether each byte holds eight columns as bits.

    Raises:
        CaptureError: there are no images, or they are damaged.
    """
    if path.is_dir():
        parquet = sorted(path.glob(f"*{PARQUET}")) or sorted(path.glob(f"*/*{PARQUET}"))
        return _list_archives(path, parquet, packed) if parquet else _list_tree(path)
    if path.suffix.lower() in TABLES:
        return _list_table(path)
    return _list_archives(path.parent, [path], packed)


def _list_archives(folder: Path, paths: Sequence[Path], packed: bool) -> ImageListing:
    """List the images of files that hold many each."""
    parts, checksums, sizes = list[dict[str, Any]](), dict[str, str](), set[tuple[int, int]]()
    for path in paths:
        if path.parent != folder or len(paths) > 1:
            refuse_outside(path, folder)
        with parser_errors_as_capture_errors(str(path)):
            regular_size(path)
        archive, name = _load_archive(path, packed), path.relative_to(folder).as_posix()
        with path.open("rb") as file:
            checksums[name] = hashlib.file_digest(file, "sha256").hexdigest()
        sizes.add((archive.images.shape[1], archive.images.shape[2]))
        parts += [
            {
                "file": f"{name}/{number}",
                "label": str(archive.label[number]),
                "person": None if archive.person is None else str(archive.person[number]),
                **({} if archive.split is None else {"split": str(archive.split[number])}),
            }
            for number in range(len(archive.images))
        ]
    if len(sizes) > 1:
        raise CaptureError(f"{folder}: images have several sizes; should have one")
    return ImageListing(parts, checksums, sizes.pop())


def _list_tree(path: Path) -> ImageListing:
    """List the images of a tree of class folders, or of such a tree a part of the split."""
    files = sorted(file for file in path.glob("*/*") if file.suffix.lower() in SUFFIXES)
    inner = sorted(file for file in path.glob("*/*/*") if file.suffix.lower() in SUFFIXES)
    if not files and all(file.parts[-3].lower() in SPLIT_WORDS for file in inner):
        files = inner
    if not files:
        raise CaptureError(f"{path}: should hold a folder of images for each class")
    total = hashlib.sha256()
    parts = list[dict[str, Any]]()
    for file in files:
        refuse_outside(file, path)
        with file.open("rb") as data:
            total.update(hashlib.file_digest(data, "sha256").digest())
        name, label = file.relative_to(path).as_posix(), file.parent.name
        parts.append({"file": name, "label": label, "person": None})
        if files is inner:
            parts[-1]["split"] = SPLIT_WORDS[file.parts[-3].lower()]
    return ImageListing(parts, {path.name: total.hexdigest()}, image_size(files[0]))


def _read_rows(path: Path) -> list[dict[str, Any]]:
    """Rows of a table, {name of its column: cell}; none where the file is no table.

    Names of columns are in lower case, with underscores for spaces and hyphens.
    """
    text = text_of(path, MAX_TABLE, CaptureError).removeprefix("\ufeff")
    if path.suffix.lower() in (".yaml", ".yml"):
        rows = parse_yaml(text, str(path))[0]
        if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
            return []
    else:
        heading = text.partition("\n")[0]
        separator = max(",;\t|", key=heading.count)
        try:
            rows = [*csv.DictReader(io.StringIO(text, newline=""), delimiter=separator)]
        except csv.Error as error:
            raise CaptureError(f"{path}: is not CSV ({error})") from None
    return [
        {plain_word(str(name)): cell for name, cell in row.items() if name is not None}
        for row in rows
    ]


def _name_of(names: Collection[str], known: Sequence[str]) -> str | None:
    """The first of some known names that is among names."""
    return next((name for name in known if name in names), None)


def _image_file(folder: Path, cell: str) -> str | None:
    """File of a cell from a folder on, whose ending may be left out; None where it is no image."""
    file = cell.strip().replace("\\", "/")
    if PurePosixPath(file).suffix.lower() in SUFFIXES:
        return file
    return next((file + end for end in sorted(SUFFIXES) if (folder / (file + end)).is_file()), None)


def _list_table(path: Path) -> ImageListing:
    """List the image files that a table names, with their labels and persons."""
    rows, total, parts = _read_rows(path), hashlib.sha256(), dict[str, dict[str, Any]]()
    file_name, label_name, person_name, split_name = (
        _name_of(rows[0], known) for known in (FILES, LABELS, PERSONS, SPLITS)
    )
    if label_name is None:
        raise CaptureError(
            f"{path}: has the columns {', '.join(rows[0])}; one should be label, the class of each "
            "image"
        )
    assert file_name is not None  # by which it is known to be a table of images
    for number, row in enumerate(rows, 2):
        where = f"{path}: row {number}"
        cells = [str(row.get(name) or "").strip() for name in (file_name, label_name)]
        if not all(cells):
            raise CaptureError(f"{where}: {label_name if cells[0] else file_name} is missing")
        file, label = _image_file(path.parent, cells[0]), cells[1]
        if not label[0].isalpha():
            raise CaptureError(
                f"{where}: {label_name} = {label!r}: should be the name of a class, which begins "
                "with a letter"
            )
        place = path.parent / (file or cells[0])
        refuse_outside(place, path.parent)
        if file is None or not place.is_file():
            raise CaptureError(f"{where}: {file_name} = {cells[0]!r}: is no image file there")
        if file in parts:
            raise CaptureError(f"{where}: {file_name} = {cells[0]!r}: stands there twice")
        with place.open("rb") as data:
            total.update(hashlib.file_digest(data, "sha256").digest())
        person = str(row.get(person_name) or "").strip() if person_name else ""
        parts[file] = {"file": file, "label": label, "person": person or None}
        if word := str(row.get(split_name) or "").strip().lower() if split_name else "":
            parts[file]["split"] = SPLIT_WORDS.get(word, word)
    first = path.parent / next(iter(parts))
    return ImageListing([*parts.values()], {path.name: total.hexdigest()}, image_size(first))


class ImageArchive(NamedTuple):
    """Images of a file that holds many."""

    images: Levels  # [N, H, W]
    label: NDArray[Any]  # name of the class of each [N]
    person: NDArray[Any] | None  # who each shows [N], where it is known
    split: NDArray[Any] | None  # part of the split of each [N], where it is known


def _load_archive(path: Path, packed: bool) -> ImageArchive:
    """Read the images of an .npz, unpacking packed bits, or of Parquet."""
    load = _load_parquet if path.suffix.lower() == PARQUET else _load_npz
    return load(path, packed, path.stat().st_mtime_ns)


@lru_cache(maxsize=2)
def _load_parquet(path: Path, packed: bool, changed: int) -> ImageArchive:
    """Read the images of Parquet, whose part of the split its name begins with."""
    del packed, changed
    stored = read_parquet_images(path, (*IMAGES, *FILES), LABELS, PERSONS)
    split = SPLIT_WORDS.get(re.split(r"[-_.]", path.name.lower())[0])
    return ImageArchive(
        stored.levels,
        np.array(stored.labels, object),
        None if stored.persons is None else np.array(stored.persons, object),
        None if split is None else np.repeat(split, len(stored.labels)),
    )


@lru_cache(maxsize=2)
def _load_npz(path: Path, packed: bool, changed: int) -> ImageArchive:
    """Read the images of an .npz."""
    del changed
    with parser_errors_as_capture_errors(str(path)), zipfile.ZipFile(path) as archive:
        shapes = check_npz(archive)
        names, split = _name_arrays(shapes), None
        of_images = [names.images, *names.tested[:1]]
        if sum(int(np.prod(shapes[name][0], dtype=object)) for name in of_images) > MAX_NPZ:
            raise ValueError(f"holds more than {MAX_NPZ} bytes of images")
        with np.load(path, allow_pickle=False) as arrays:
            values, label = _levels(arrays[names.images]), _as_text(arrays[names.label])
            if names.tested:
                more, of_more = _levels(arrays[names.tested[0]]), _as_text(arrays[names.tested[1]])
                if more.shape[1:] != values.shape[1:] or more.dtype != values.dtype:
                    raise ValueError(f"{' and '.join(of_images)} differ in size or type")
                split = np.repeat(["train", "test"], [len(values), len(more)])
                values, label = np.concatenate([values, more]), np.concatenate([label, of_more])
            classes, person = (
                None if name is None else _as_text(arrays[name].ravel())
                for name in (names.classes, names.person)
            )
        if values.dtype not in (np.uint8, np.bool_):
            raise ValueError(f"{names.images} is of {values.dtype}; should be uint8 or bool")
        images = np.unpackbits(values.view(np.uint8), axis=2) if packed else values.view(np.uint8)
        if images.max(initial=0) <= 1:
            images = images * np.uint8(255)
        if _is_one_hot(label):
            raise ValueError(_describe_one_hot(path, names.label, label, classes is not None))
        label = _as_numbers(label.ravel())
        if label.dtype.kind in "iu" and label.size:
            if classes is None or not ((label >= 0) & (label < classes.size)).all():
                raise ValueError(_describe_numbers(path, names.label, label))
            label = classes[label]
        if label.dtype.kind != "U" or len(label) != len(images):
            raise ValueError(f"{names.label} should name the class of each of {len(images)} images")
        for name in np.unique(label).tolist():
            if not name[:1].isalpha():
                raise ValueError(
                    f"{names.label} = {name!r}: should be the name of a class, which begins with a "
                    "letter"
                )
        if person is not None and len(person) != len(images):
            raise ValueError(f"person should name the person in each of {len(images)} images")
    return ImageArchive(images, label, person, split)


class _ArrayNames(NamedTuple):
    """Names of the arrays of an .npz."""

    images: str
    label: str
    person: str | None
    classes: str | None
    tested: tuple[str, ...] = ()  # images and labels of a test part


def _name_arrays(shapes: Mapping[str, tuple[tuple[int, ...], str]]) -> _ArrayNames:
    """Find the arrays of images, labels, persons and classes by their names.

    Args:
        shapes: {name: shape and kind of its numbers}.

    Raises:
        ValueError: images or labels are not there.
    """
    spelt = {name.lower(): name for name in shapes}
    parts = [f"{of}_{part}" for part in ("train", "test") for of in "xy"]
    if spelt.keys() >= {*parts}:
        of_images, of_label, *tested = (spelt[name] for name in parts)
        names_of_classes = spelt.get(_name_of(spelt, CLASSES) or "")
        return _ArrayNames(of_images, of_label, None, names_of_classes, (*tested,))
    names = {
        kind: _name_of(spelt, [*known, *(f"{name}_train" for name in known)])
        for kind, known in (("images", IMAGES), ("label", LABELS), ("person", PERSONS))
    }
    classes = _name_of(spelt, CLASSES)
    pictures = [
        name
        for name, (shape, kind) in shapes.items()
        if (len(shape) == 3 or (len(shape) == 4 and shape[3] in (1, 3))) and kind in "ub"
    ]
    if names["images"] is not None and spelt[names["images"]] in pictures:
        pictures = [spelt[names["images"]]]
    if len(pictures) != 1 or names["label"] is None:
        raise ValueError(
            "should hold one array of images [N, H, W], uint8 or bool (named masks or images if "
            f"there are others), and label (or {', '.join(LABELS[1:])}); it has "
            f"{', '.join(f'{name} {list(shape)}' for name, (shape, _) in shapes.items())}"
        )
    label, person = (spelt.get(names[kind] or "") for kind in ("label", "person"))
    assert label is not None
    return _ArrayNames(pictures[0], label, person, spelt.get(classes or ""))


def _levels(values: NDArray[Any]) -> NDArray[Any]:
    """Images [N, H, W] of arrays [N, H, W], [N, H, W, 1] or [N, H, W, 3], as of image files."""
    if values.ndim == 3:
        return values
    if values.shape[3] == 1:
        return values[..., 0]
    return np.stack([luminance(image) for image in values])


def _is_one_hot(label: NDArray[Any]) -> bool:
    """Whether labels are rows [N, K] of zeros, with a one in the column of the class."""
    if label.ndim != 2 or label.shape[1] < 2 or label.dtype.kind not in "biuf":
        return False
    return bool(((label == 0) | (label == 1)).all() and (label.sum(axis=1) == 1).all())


def _as_numbers(label: NDArray[Any]) -> NDArray[Any]:
    """Labels [N] as integers where they are these in another type; others as they are."""
    if label.dtype.kind == "U" and all(text.isdecimal() for text in label.tolist()):
        is_number = max(map(len, label.tolist()), default=0) <= MAX_DIGITS
    elif label.dtype.kind == "f":
        is_number = bool((np.isfinite(label) & (label == np.trunc(label))).all())
    else:
        is_number = label.dtype.kind == "b"
    return label.astype(np.int64) if is_number else label


def _describe_numbers(path: Path, name: str, label: NDArray[Any]) -> str:
    """Describe labels that should be indices into classes, with a command that adds the names."""
    return (
        f"{name} has the numbers {label.min()} to {label.max()}; should be indices into classes, "
        f"or texts; `python -c \"import numpy as np; np.savez('named.npz', **np.load('{path}'), "
        f'{_example_classes(int(label.max()) + 1)})"` adds names, which are yours'
    )


def _describe_one_hot(path: Path, name: str, label: NDArray[Any], has_classes: bool) -> str:
    """Describe one-hot labels [N, K] that should be indices, with a command that makes them so."""
    classes = "" if has_classes else f", {_example_classes(label.shape[1])}"
    return (
        f'{name} is one-hot; should be np.argmax({name}, 1); `python -c "import numpy as np; a = '
        f"dict(np.load('{path}')); a['{name}'] = np.argmax(a['{name}'], 1); "
        f"np.savez('named.npz', **a{classes})\"` makes it so"
        + ("" if has_classes else ", with names, which are yours")
    )


def _example_classes(count: int) -> str:
    """The argument `classes` of a command, with names for so many classes."""
    names = ", ".join(f"'class_{number}'" for number in range(min(count, 12)))
    return f"classes=[{names}]"


def _as_text(values: NDArray[Any]) -> NDArray[Any]:
    """Decode bytes as text; leave anything else as it is."""
    return np.char.decode(values, "ascii", "replace") if values.dtype.kind == "S" else values


def read_image(folder: Path, file: str, size: tuple[int, int], packed: bool) -> Levels:
    """Read the levels [H, W] of an image.

    Args:
        folder: folder of the manifest.
        file: image file, or one of packed images (`masks.npz/12`), below the folder.
        size: (H, W) that it should have.
        packed: whether each byte of an .npz holds eight columns as bits.

    Raises:
        CaptureError: it is missing, or has another size.
        FolderError: the same, of an image file.
    """
    place = PurePosixPath(file)
    if place.parent.suffix.lower() not in (NPZ, PARQUET):
        return read_gray(folder / file, size)
    path = folder / place.parent
    images = _load_archive(path, packed).images
    number = int(place.name) if place.name.isdecimal() else len(images)
    if number >= len(images) or images.shape[1:] != size:
        raise CaptureError(f"{path}: image {place.name}: is missing, or not {size[0]} x {size[1]}")
    levels: Levels = images[number]
    return levels
