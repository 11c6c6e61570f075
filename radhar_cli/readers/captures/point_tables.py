"""Tables and arrays of points, which are refused as samples: several rows belong to one frame."""

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.errors import CaptureError
from radhar_cli.readers.captures.named_parts import find_pairs
from radhar_cli.readers.captures.stored_arrays import Samples

PROBED_ROWS = 4096
PROBED_ENTRIES = 16  # of each axis of an array of more than two
FEWEST_ROWS = 8  # by which the signs of columns tell something
COLUMNS = range(5, 9)  # of an array of points
MOST_LEADING = 2  # columns before the places: number of the frame, and of its points
FARTHEST_M, FASTEST_MPS = 200.0, 50.0
HOW = (
    'radhar reads dumps of a TI demo\'s data port, and JSON: {"data": [{"frameData": {"frameNum": '
    '0, "pointCloud": [[x, y, z, Doppler, SNR], ...]}}, ...]} with x to the right, y ahead, z up, '
    "--set frame_s=0.1 (docs/guide/points.md)"
)
_BRACKETS = re.compile(r"\s*[\[(].*")
_PLACE = re.compile(r"(?:pos|position|point|coord)?[_ ]?([xyz])[_ ]?(?:pos|position|coord|m)?")
_SPEED = re.compile(r"(?:radial[_ ]?)?(?:doppler|velocity|speed|vel|v)(?:[_ ](?:mps|idx|index))?")
_ANGLE = re.compile(r"azimuth|azim|angle|theta|bearing")


def refuse_names_of_points(path: Path, names: Iterable[str]) -> None:
    """Refuse columns that are places of points, or their range, angle and Doppler.

    Raises:
        CaptureError: says what of points is read.
    """
    names = [*names]
    plain = {_BRACKETS.sub("", name).strip().lower(): name for name in names}
    places = {match[1]: plain[word] for word in plain if (match := _PLACE.fullmatch(word))}
    speeds = [name for word, name in plain.items() if _SPEED.fullmatch(word)]
    polar = [name for word, name in plain.items() if word == "range" or _ANGLE.fullmatch(word)]
    is_cartesian = {"x", "y"} <= places.keys() and ("z" in places or speeds)
    is_polar = len(polar) > 1 and speeds
    if (is_cartesian or is_polar) and not find_pairs(names):
        columns = [*places.values()] if is_cartesian else polar
        text = ", ".join([*columns, *speeds])
        raise CaptureError(f"{path}: {text} are columns of points, not samples; of points {HOW}")


def refuse_array_of_points(array: Samples) -> None:
    """Refuse an array whose last axis (of MATLAB in HDF5 the first) is x, y, z, Doppler, intensity.

    Raises:
        CaptureError: says what of points is read.
    """
    shape = array.shape
    if array.parts != 1 or len(shape) < 2:
        return
    longest = PROBED_ROWS if len(shape) == 2 else PROBED_ENTRIES
    key = tuple(slice(0, min(size, longest)) for size in shape)
    for axis in (len(shape) - 1, 0):
        if shape[axis] in COLUMNS:
            rows = np.moveaxis(array.read(key)[..., 0], axis, -1).reshape(-1, shape[axis])
            if are_points(rows):
                raise CaptureError(
                    f"{array.where}: has the shape {[*shape]} of x, y, z, Doppler and intensity of "
                    f"points, by their signs, not of samples; of points {HOW}"
                )


def are_points(rows: NDArray[Any]) -> bool:
    """Whether rows [n, columns] are points: y and intensity are never negative, another is.

    Columns are x, y, z, Doppler, intensity, and more; before them may be the number of the frame,
    which several rows share, and how many points it has. Received signals have one kind of sign.
    """
    if rows.ndim != 2 or rows.shape[1] not in COLUMNS or not np.isrealobj(rows):
        return False
    rows = rows[:PROBED_ROWS].astype(float)
    rows = rows[np.any(rows != 0, axis=1)]  # frames are filled up with zeros
    if len(rows) < FEWEST_ROWS or not np.isfinite(rows).all():
        return False
    leads = range(min(rows.shape[1] - COLUMNS[0], MOST_LEADING) + 1)
    return any(_have_signs_of_points(rows, lead) for lead in leads)


def _have_signs_of_points(rows: NDArray[np.float64], lead: int) -> bool:
    """Whether five columns after some that lead have the signs and sizes of points."""
    if lead:
        steps = np.diff(rows[:, 0])
        counts_frames = (steps >= 0).all() and (steps == np.round(steps)).all()
        if not counts_frames or not (steps == 0).any():
            return False
    x, y, z, doppler, intensity = rows[:, lead : lead + 5].T
    is_near = max(np.abs(values).max() for values in (x, y, z)) < FARTHEST_M
    is_slow = np.abs(doppler).max() < FASTEST_MPS
    has_signs = min(y.min(), intensity.min()) >= 0 and min(x.min(), z.min(), doppler.min()) < 0
    is_broken = bool((y != np.round(y)).any())  # metres, not numbers of a converter
    return bool(is_near and is_slow and has_signs and is_broken and y.any())


def refuse_file_of_points(path: Path) -> None:
    """Refuse a file of float64 that is points: a frame of MM-Fi, which has nothing before them.

    Raises:
        CaptureError: says what of points is read.
    """
    row = 8 * COLUMNS[0]
    size = path.stat().st_size
    if size % row:
        return
    with path.open("rb") as file:
        rows = np.frombuffer(file.read(row * PROBED_ROWS), "<f8").reshape(-1, COLUMNS[0])
    with np.errstate(invalid="ignore", over="ignore"):
        is_of_points = are_points(rows)
    if is_of_points:
        raise CaptureError(
            f"{path}: holds {size // row} rows of five float64: x, y, z, Doppler and intensity of "
            f"points, by their signs, not samples; of points {HOW}"
        )
