"""Anybody's own points: tables with a row a point, and files that `radhar import` reads.

A table names its columns: frame, x, y, z, Doppler, and what else there is of intensity, SNR, label
and person. Names that are not plain are given by `columns`, and which way axes point by `axes`.
"""

import csv
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from radhar_cli.capture.images import LABELS, PERSONS, SPLIT_WORDS
from radhar_cli.capture.importing_points import (
    PointHeader,
    PointSettings,
    import_points,
    is_point_capture,
)
from radhar_cli.capture.recipes.axes import AxesSettings, to_radhar_axes
from radhar_cli.capture.recipes.clouds import MAX_TABLE, CloudClip, points_of, write_clips
from radhar_cli.capture.recipes.recipe import CLOUDS, SetRecipe, Take, as_name, find_files
from radhar_cli.errors import CaptureError
from radhar_cli.files.plain_text import decode_text
from radhar_cli.files.untrusted import bytes_of
from radhar_cli.motion.activities.vocabulary import plain_word
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.captures.array_files import npz_columns, read_npz_array
from radhar_cli.readers.captures.settings import Above, Text

LONGEST_LOSS = 1000  # frames; a larger step is a recording that begins anew
_UNIT = re.compile(r"\s*[\[(#].*")
NAMES: dict[str, tuple[str, ...]] = {
    "frame": ("frame", "frame_number", "frame_num", "frame_no", "frame_id", "frame_index"),
    "x": ("x", "pos_x", "x_pos", "point_x", "x_m"),
    "y": ("y", "pos_y", "y_pos", "point_y", "y_m"),
    "z": ("z", "pos_z", "z_pos", "point_z", "z_m"),
    "doppler": ("doppler", "velocity", "speed", "v", "vel", "radial_velocity", "doppler_mps"),
    "intensity": ("intensity", "peak", "peak_value", "amplitude", "power"),
    "snr": ("snr", "snr_db"),
    "label": LABELS,
    "person": PERSONS,
}
FILES = r"[^/]+\.(csv|tsv|txt|npz|json|dat|bin)"
NEEDED = ("frame", "x", "y", "z", "doppler")


class PointTableSettings(AxesSettings):
    """Facts that tables of points do not state themselves."""

    frame_s: Annotated[Above, Field(ge=1e-5, le=1e6)] | None = None
    """Time from frame to frame, s."""
    columns: dict[str, Text] = Field(default_factory=dict)
    """Names of columns that are not plain: {frame: t, doppler: v_r}."""
    label: Text | None = None
    """Label of all files, where neither a column nor the folder of a file says it."""
    person: Text | None = None
    """Person of all files, where no column says it."""


def list_takes(folder: Path, settings: PointTableSettings) -> Iterator[Take]:
    """List a take for each file; its folder is its label where it has no column of labels.

    Raises:
        CaptureError: a setting is missing, or files are pickles.
    """
    if pickles := [file.inner for file in find_files(folder, r"[^/]+\.(pkl|pickle)")]:
        raise CaptureError(f"{folder / pickles[0]}: is a pickle, which runs code when it is opened")
    for name in settings.columns:
        if name not in NAMES:
            raise CaptureError(f"columns.{name}: there are {', '.join(NAMES)}")
    listed = [(file.path, file.inner) for file in find_files(folder, FILES)]
    for path, inner in [(folder, folder.name)] if folder.is_file() else listed:
        name = as_name(inner)
        *folders, _ = inner.split("/")
        split = next((SPLIT_WORDS[f.lower()] for f in folders if f.lower() in SPLIT_WORDS), None)
        classes = [name for name in folders if name.lower() not in SPLIT_WORDS]
        label = settings.label or (classes[-1] if classes else None)
        if is_point_capture(path):
            write = partial(_import, path, label, settings)
        else:
            settings.require(str(folder))
            if settings.frame_s is None:
                raise CaptureError(f"{folder}: frame_s is missing (--set frame_s=0.1)")
            write = partial(write_take, path, label, settings)
        yield Take(name, (path,), write, split)


def _import(path: Path, label: str | None, settings: PointTableSettings, out: Path) -> None:
    """Import a dump of a board's data port, or a replay file."""
    point_settings = PointSettings(
        frame_s=settings.frame_s, label=_require_label(path, label), person=settings.person
    )
    import_points([path], out, PointHeader(point_settings))


def _require_label(path: Path, label: str | None) -> str:
    """Label of a file.

    Raises:
        CaptureError: nothing says it.
    """
    if label is None:
        raise CaptureError(
            f"{path}: label is missing: a column, the folder that the file lies in, or --set label="
        )
    return label


def write_take(path: Path, label: str | None, settings: PointTableSettings, out: Path) -> None:
    """Write the points of a table; where label or person change, another clip begins.

    Raises:
        CaptureError: columns are missing, or cells are no numbers.
    """
    clips = read_clips(path, settings, label)
    for clip in clips:
        _require_label(path, clip.label or None)
    assert settings.frame_s is not None  # as `list_takes` found
    write_clips(out, clips, settings.frame_s, [path])


def read_clips(
    path: Path, settings: PointTableSettings, label: str | None = None
) -> list[CloudClip]:
    """Read a table of points: a clip where frames go on, of one label and one person.

    Args:
        path: CSV, or .npz with an array for each column.
        settings: Which way axes point, and names of columns.
        label: Label where no column says it; None leaves it empty.

    Raises:
        CaptureError: columns or axes are missing, or cells are no numbers.
    """
    settings.require(str(path))
    cells = _read_columns(path, settings.columns)
    frame = _numbers(path, "frame", cells["frame"])
    rounded = np.round(frame)
    if not len(frame) or not (np.abs(frame) < 2**53).all() or (rounded != frame).any():
        raise CaptureError(f"{path}: frame should be whole numbers")
    numbers = rounded.astype(np.int64)
    places = np.column_stack([_numbers(path, name, cells[name]) for name in "xyz"])
    receding = settings.receding(_numbers(path, "doppler", cells["doppler"]))
    more = {
        name: _numbers(path, name, cells[name]) for name in ("intensity", "snr") if name in cells
    }
    assert settings.axes is not None
    points = points_of(
        to_radhar_axes(places, settings.axes), receding, more.get("intensity"), more.get("snr")
    )
    labels = cells.get("label") or [label or ""] * len(numbers)
    persons = cells.get("person") or [settings.person or ""] * len(numbers)
    steps = np.diff(numbers)
    is_cut = (steps < 0) | (steps > LONGEST_LOSS)
    is_cut |= [
        (a, c) != (b, d)
        for a, b, c, d in zip(labels, labels[1:], persons, persons[1:], strict=False)
    ]
    clips = []
    for rows in np.split(np.arange(len(numbers)), np.flatnonzero(is_cut) + 1):
        first, order = int(rows[0]), (numbers[rows] - numbers[rows[0]]).astype(np.intp)
        person = persons[first] or None
        clip = CloudClip(labels[first], person, points[rows], order, int(order[-1]) + 1)
        clips.append(replace(clip, first_number=int(numbers[first])))
    return clips


def _read_columns(path: Path, renamed: Mapping[str, str]) -> dict[str, list[str]]:
    """Cells of a table by our names.

    Raises:
        CaptureError: a column that is needed has no plain name.
    """
    if path.suffix.lower() == ".npz":
        return _read_arrays(path, renamed)
    try:
        text = decode_text(bytes_of(path, MAX_TABLE, CaptureError))
    except ValueError as error:
        raise CaptureError(f"{path}: {error}") from None
    heading = text.partition("\n")[0]
    separator = max(",;\t", key=heading.count)
    rows = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
    try:
        names = [name.strip() for name in next(rows, [])]
        columns = _match_names(path, names, renamed)
        body = [row for row in rows if row]
    except csv.Error as error:
        raise CaptureError(f"{path}: is not CSV ({error})") from None
    if body and len(body[-1]) < len(names) and not text.endswith("\n"):
        body.pop()  # a last line that is cut
    for number, row in enumerate(body, 2):
        if len(row) < len(names):
            raise CaptureError(
                f"{path}: row {number}: has {len(row)} cells; should have {len(names)}"
            )
    return {name: [row[place].strip() for row in body] for name, place in columns.items()}


def _read_arrays(path: Path, renamed: Mapping[str, str]) -> dict[str, list[str]]:
    """Cells of the arrays of an .npz, one a column, as texts, by our names.

    Raises:
        CaptureError: it is damaged, an array is missing, or they differ in length.
    """
    names = npz_columns(path)
    cells = {
        name: read_npz_array(path, names[place], MAX_TABLE, "iufU").astype(str).tolist()
        for name, place in _match_names(path, names, renamed).items()
    }
    if len({*map(len, cells.values())}) > 1:
        lengths = ", ".join(f"{name} {len(column)}" for name, column in cells.items())
        raise CaptureError(f"{path}: arrays should have a number for each point; {lengths}")
    return cells


def _match_names(path: Path, names: Sequence[str], renamed: Mapping[str, str]) -> dict[str, int]:
    """Place of each column by our names."""
    plain = {
        plain_word(_UNIT.sub("", heading)): place
        for place, heading in reversed([*enumerate(names)])
    }
    columns = dict[str, int]()
    for name, known in NAMES.items():
        if name in renamed and renamed[name] not in names:
            raise CaptureError(
                f"{path}: has no column {renamed[name]!r}; it has {', '.join(names)}"
            )
        place = (
            names.index(renamed[name])
            if name in renamed
            else next(
                (plain[w] for w in known if w in plain and plain[w] not in columns.values()), None
            )
        )
        if place is not None:
            columns[name] = place
    if missing := [name for name in NEEDED if name not in columns]:
        raise CaptureError(
            f"{path}: has the columns {', '.join(names)}, none of which is plainly "
            f"{', '.join(missing)}: --set columns.{missing[0]}=NAME"
        )
    return columns


def _numbers(path: Path, name: str, cells: Sequence[str]) -> Float:
    """Numbers [n] of the cells of a column; NaN of empty ones.

    Raises:
        CaptureError: a cell is no number; names the row, that of names being row 1.
    """
    numbers = np.full(len(cells), np.nan)
    for place, cell in enumerate(cells):
        try:
            numbers[place] = float(cell or "nan")
        except ValueError:
            raise CaptureError(
                f"{path}: row {place + 2}: {name} = {cell[:80]!r}: should be a number"
            ) from None
    return numbers


RECIPE = SetRecipe(
    source="tables of points, or what radhar import reads of points",
    licence="",
    holds="a row a point: frame, x, y, z, Doppler, and intensity, SNR, label, person",
    tested="files written by this layout",
    layout="walking/anna.csv, or tables with a column of labels",
    list_takes=list_takes,
    config=CLOUDS,
    settings=PointTableSettings,
)
