"""Images in Parquet as Hugging Face has them: rows of encoded images with their labels."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.dataset.image_file import gray_of_bytes
from radhar_cli.errors import MachineError, how_to_install
from radhar_cli.files.untrusted import parse_json, regular_size
from radhar_cli.motion.activities.vocabulary import plain_word
from radhar_cli.numerics.arrays import Levels
from radhar_cli.readers.captures.parser_errors import parser_errors_as_capture_errors

MAX_ROWS = 10**6
MAX_BYTES = 2**29  # of a file, and of its images, which are held


class ParquetImages(NamedTuple):
    """Images of a file: levels [N, H, W], names of their classes [N] and, if known, persons [N]."""

    levels: Levels
    labels: list[str]
    persons: list[str] | None


def read_parquet_images(
    path: Path, image: tuple[str, ...], label: tuple[str, ...], person: tuple[str, ...]
) -> ParquetImages:
    """Read the images of a file, and their classes, whose names may stand in its metadata.

    Args:
        path: the file.
        image: names that the column of the images may have.
        label: names that the column of the labels may have.
        person: names that a column of the persons may have.

    Raises:
        CaptureError: it is damaged, too large, or has no such columns.
        MachineError: pyarrow is not installed.
    """
    try:
        import pyarrow.parquet as pq
    except ImportError:
        raise MachineError(f"{path}: needs pyarrow; {how_to_install('pyarrow')}") from None
    with parser_errors_as_capture_errors(str(path)):
        size, file = regular_size(path), pq.ParquetFile(path)
        if file.metadata.num_rows > MAX_ROWS or size > MAX_BYTES:
            raise ValueError(f"holds more than {MAX_ROWS} rows or {MAX_BYTES} bytes")
        columns = {plain_word(name): name for name in file.schema_arrow.names}
        of_image, of_label, of_person = (
            next((columns[name] for name in known if name in columns), None)
            for known in (image, label, person)
        )
        if of_image is None or of_label is None:
            raise ValueError(f"has the columns {', '.join(columns)}; should have image and label")
        wanted = [name for name in (of_image, of_label, of_person) if name is not None]
        rows = file.read(columns=wanted).to_pydict()
        names = _class_names(file.schema_arrow.metadata or {}, of_label)
        return ParquetImages(
            _decode(rows[of_image], path),
            [_class_name(value, names, of_label) for value in rows[of_label]],
            None if of_person is None else [str(value) for value in rows[of_person]],
        )


def _decode(cells: list[Any], path: Path) -> Levels:
    """Decode images of one size into levels [N, H, W]."""
    levels = list[Levels]()
    for number, cell in enumerate(cells):
        data = cell.get("bytes") if isinstance(cell, dict) else cell
        if not isinstance(data, bytes):
            raise ValueError(f"image {number}: should be the bytes of an image file")
        levels.append(gray_of_bytes(data, path / str(number)))
        if levels[-1].shape != levels[0].shape:
            raise ValueError(f"image {number}: is of another size than the first")
        if len(levels) * levels[0].size > MAX_BYTES:
            raise ValueError(f"holds more than {MAX_BYTES} bytes of images")
    if not levels:
        raise ValueError("holds no image")
    return np.stack(levels)


def _class_name(value: Any, names: list[str] | None, column: str) -> str:
    """Name of the class of a label, which may be a number into `names`."""
    if names is not None and isinstance(value, int) and 0 <= value < len(names):
        value = names[value]
    if not str(value)[:1].isalpha():
        raise ValueError(
            f"{column} = {value!r}: should be the name of a class, or a number whose name is in "
            "the file's metadata, as Hugging Face's ClassLabel has it"
        )
    return str(value)


def _class_names(metadata: Mapping[bytes, bytes], column: str) -> list[str] | None:
    """Names of the classes that Hugging Face notes in a file's metadata; None without any."""
    try:
        features = parse_json(metadata[b"huggingface"].decode())["info"]["features"]
        return [str(name) for name in features[column]["names"]]
    except (KeyError, TypeError, ValueError):
        return None
