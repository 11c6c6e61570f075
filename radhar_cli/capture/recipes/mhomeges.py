"""mHomeGes: ten gestures in front of an IWR1443, at distances from 1.2 m, as tables of points.

Hands rest for a second between repetitions, in which there are no points. Each repetition begins a
slot of SLOT_S in the recording, and the rest before it is left out. Axes are TI's (right, ahead,
up); the sign of the velocity is not stated, and taken for TI's, receding.
"""

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import groupby
from pathlib import Path

import numpy as np

from radhar_cli.capture.recipes.clouds import CloudClip, points_of_ti, read_table, write_clips
from radhar_cli.capture.recipes.recipe import (
    BY_PERSON,
    CLOUDS,
    MatchedFile,
    NoSettings,
    SetRecipe,
    Take,
    as_name,
    find_files,
)

FRAME_S, SLOT_S = 0.1, 3.0
REST = 5  # frames without points, from which on the next repetition begins


def list_takes(folder: Path, settings: NoSettings) -> Iterator[Take]:
    """List a take for each person and distance, of all gestures."""
    files = find_files(folder, r"point_([^_/]+)_([\d.]+m)_([^/]+)\.csv")
    ordered = sorted(files, key=lambda file: (_person(file), file.inner))
    for (person, distance), gestures in groupby(ordered, key=_person):
        sources = {file.path: file.match[3].lower() for file in gestures}
        write = partial(write_take, sources, person)
        yield Take(as_name(f"{distance}_{person}"), tuple(sources), write)


def _person(file: MatchedFile) -> tuple[str, str]:
    """Person and distance of a file."""
    return file.match[1], file.match[2].lower()


def write_take(sources: dict[Path, str], person: str, out: Path) -> None:
    """Write the repetitions of all gestures of a person.

    Raises:
        CaptureError: a file is damaged, or all are empty.
    """
    clips, findings = list[CloudClip](), list[str]()
    for path, gesture in sources.items():
        rows, lost_lines = read_table(path, 7)
        findings += [f"{path.name}: the last line is cut and left out"] * lost_lines
        rows = rows[rows[:, 1] > 0]  # a row of zeros is a frame without points
        if not len(rows):
            findings.append(f"{path.name}: holds no points")
            continue
        frame = rows[:, 0].astype(np.int64)
        steps = np.diff(frame)
        cuts = np.flatnonzero((steps > REST) | (steps < 0)) + 1
        clips += [
            _repetition(gesture, person, rows[part], frame[part])
            for part in np.split(np.arange(len(rows)), cuts)
        ]
    write_clips(out, _join_repetitions(clips), FRAME_S, [*sources], findings)


def _repetition(gesture: str, person: str, rows: np.ndarray, frame: np.ndarray) -> CloudClip:
    """CloudClip of a repetition, as long as whole slots."""
    slot = round(SLOT_S / FRAME_S)
    length = -(-int(frame[-1] - frame[0] + 1) // slot) * slot
    return CloudClip(gesture, person, points_of_ti(rows[:, 2:7]), frame - frame[0], length)


def _join_repetitions(clips: Sequence[CloudClip]) -> list[CloudClip]:
    """Join repetitions of a gesture into one clip."""
    joined = []
    for _, group in groupby(clips, key=lambda clip: clip.label):
        parts = [*group]
        starts = np.cumsum([0, *(clip.length for clip in parts)])
        frame = np.concatenate([c.frame + start for c, start in zip(parts, starts, strict=False)])
        points = np.concatenate([clip.points for clip in parts])
        joined.append(CloudClip(parts[0].label, parts[0].person, points, frame, int(starts[-1])))
    return joined


RECIPE = SetRecipe(
    source="mHomeGes, github.com/GestureMan/mHomeGes-dataset",
    licence="mit",
    holds="10 gestures at 13 distances, persons by number",
    tested="a gesture of 4 persons, and files written by this layout",
    layout="longGes_1.2m/804/point_804_1.2m_circle.csv",
    list_takes=list_takes,
    config=CLOUDS | {"recordings": {"window_s": SLOT_S, "hop_s": SLOT_S}, "split": BY_PERSON},
)
