"""Replay files of TI's Industrial Visualizer: frames of points and tracks as JSON."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import read_text
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.points.point_frames import (
    PointFrame,
    RadarSteps,
    TiPoints,
    amplitude_of,
    are_measurements,
    decibels_of,
    make_targets,
    no_targets,
)

MAX_REPLAY = 2**25  # bytes of a file; a hundred frames of 300 points take four million
MAX_NUMBER = 2**53
LISTS = ("data", "fileData")
POINT_VALUES = (4, 8)  # fewest and most numbers of a point


@dataclass(frozen=True)
class Replay:
    """Frames of replay files, as they stand in them.

    Attributes:
        items: Where each frame stands, and the frame.
        cfg: Lines of the .cfg; "" where there are none.
        demo: Name of the demo; "" where it is unknown.
    """

    items: Sequence[tuple[str, dict[str, Any]]]
    cfg: str
    demo: str

    @property
    def times(self) -> Float:
        """Times of the frames, s; NaN where there is none."""
        return np.array([_time(item) for _, item in self.items])

    @property
    def numbers(self) -> list[int]:
        """Numbers of the frames."""
        return [_number_of(where, item, n) for n, (where, item) in enumerate(self.items)]

    def frames(self, steps: RadarSteps, snr_is_ratio: bool) -> Iterator[PointFrame]:
        """Yield the frames.

        Args:
            steps: steps of the board, as far as they are known.
            snr_is_ratio: whether SNRs are ratios of powers, not decibels.

        Raises:
            CaptureError: a point or track is not as the visualizer writes it.
        """
        for number, (where, item) in zip(self.numbers, self.items, strict=True):
            inner = _inner(item)
            points = _points(inner.get("pointCloud"), where, snr_is_ratio)
            targets = _targets(inner.get("trackData"), where)
            rows, time = points.rows(steps), _time(item)
            if not are_measurements(rows) or not are_measurements(targets[:, 1:]):
                raise CaptureError(f"{where}: holds infinite or huge numbers")
            known = None if np.isnan(time) else time
            yield PointFrame(number, rows, points.tracks(), targets, known)


def is_replay(path: Path, head: bytes) -> bool:
    """Whether a file is JSON by its name and first byte, and so may be a replay file."""
    return path.suffix.lower() == ".json" and head.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] in b"{["


def read_replay(paths: Sequence[Path]) -> Replay:
    """Read replay files, which follow each other.

    Raises:
        CaptureError: a file is no JSON, or no replay file.
    """
    items, cfg, demo = list[tuple[str, dict[str, Any]]](), "", ""
    for path in paths:
        document = _read_json(path)
        listed = document
        if isinstance(document, dict):
            name = next((name for name in LISTS if name in document), LISTS[0])
            listed = document.get(name)
            cfg = cfg or _lines(document.get("cfg"))
            demo = demo or _text(document.get("demo"))
        if not isinstance(listed, list) or not all(isinstance(item, dict) for item in listed):
            raise CaptureError(
                f"{path}: is no replay file of TI's visualizer: should have data: "
                '[{"frameData": {"frameNum": ..., "pointCloud": [...]}, "timestamp": ...}, ...]'
            )
        items += [(f"{path}: frame {number}", item) for number, item in enumerate(listed)]
    if not any("pointCloud" in _inner(item) or "frameNum" in _inner(item) for _, item in items):
        raise CaptureError(f"{paths[0]}: holds no frame with a pointCloud or a frameNum")
    return Replay(items, cfg, demo)


def _read_json(path: Path) -> Any:
    """Read a JSON file of at most MAX_REPLAY bytes.

    Raises:
        CaptureError: it cannot be read, or is no JSON.
    """
    try:
        return json.loads(read_text(path, MAX_REPLAY).removeprefix("\ufeff"))
    except RecursionError:
        raise CaptureError(f"{path}: is nested too deeply for a replay file") from None
    except OSError as error:
        raise CaptureError(f"{path}: {error.strerror or error}") from None
    except ValueError as error:
        raise CaptureError(f"{path}: is damaged, or is not JSON ({error})") from None


def _inner(item: dict[str, Any]) -> dict[str, Any]:
    """Content of a frame: `frameData`, or the frame itself."""
    inner = item.get("frameData", item)
    return inner if isinstance(inner, dict) else {}


def _lines(value: Any) -> str:
    """Lines of the .cfg in a replay file, as one text."""
    if isinstance(value, list) and all(isinstance(line, str) for line in value):
        return "".join(line.rstrip("\r\n") + "\n" for line in value)
    return _text(value)


def _text(value: Any) -> str:
    """A text, "" of anything else."""
    return value if isinstance(value, str) else ""


def _time(item: dict[str, Any]) -> float:
    """Time of a frame, s, of its time stamp in ms; NaN without one."""
    value = item.get("timestamp", item.get("timeStamp"))
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        return np.nan
    return float(value) / 1e3 if abs(value) < MAX_NUMBER else np.nan


def _number_of(where: str, item: dict[str, Any], place: int) -> int:
    """Number of a frame; its place in the file where it has none.

    Raises:
        CaptureError: it is no whole number.
    """
    value = _inner(item).get("frameNum", place)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**32:
        raise CaptureError(f"{where}: frameNum = {str(value)[:40]}: should be a whole number")
    return value


def _table(value: Any, name: str, where: str, fewest: int, width: int) -> Float:
    """Rows of numbers [n, columns] of a list of lists; columns that a row lacks are NaN.

    Raises:
        CaptureError: it is no such list.
    """
    rows = [] if value is None else value
    right = f"should be a list of lists of {fewest} to {width} numbers"
    if not isinstance(rows, list):
        raise CaptureError(f"{where}: {name} {right}")
    table = np.full((len(rows), width), np.nan)
    for number, row in enumerate(rows):
        is_list = isinstance(row, list) and fewest <= len(row)
        if not is_list or not all(type(x) in (int, float) for x in row[:width]):
            raise CaptureError(f"{where}: {name}[{number}] {right}")
        if not all(-MAX_NUMBER < x < MAX_NUMBER for x in row[:width]):
            raise CaptureError(f"{where}: {name}[{number}] holds infinite or huge numbers")
        table[number, : min(len(row), width)] = row[:width]
    return table


def _points(value: Any, where: str, snr_is_ratio: bool) -> TiPoints:
    """Points of a frame: x, y, z, Doppler, and SNR, noise and track where there are such."""
    table = _table(value, "pointCloud", where, *POINT_VALUES)
    places, doppler, snr, noise, track = table[:, :3], *table[:, 3:7].T
    if snr_is_ratio:
        return TiPoints(places, doppler, snr, decibels_of(snr), track=track)
    amplitude = amplitude_of(np.clip(snr + np.nan_to_num(noise), -1e3, 1e2))
    return TiPoints(places, doppler, amplitude, snr, track=track)


def _targets(value: Any, where: str) -> Float:
    """Targets of a frame: track, place, velocity, acceleration, then gain and confidence."""
    if value is None or value == []:
        return no_targets()
    table = _table(value, "trackData", where, 4, 16)
    place, velocity, acceleration = (np.nan_to_num(table[:, n : n + 3]) for n in (1, 4, 7))
    return make_targets(table[:, 0], place, velocity, acceleration, table[:, 11])
