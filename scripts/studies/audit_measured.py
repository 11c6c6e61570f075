"""Audit public measured data sets: convert them to what `radhar audit` reads, audit, tabulate.

    python scripts/studies/audit_measured.py MEASURED -o OUT

MEASURED holds glasgow_masks.npz (masks, label, classes), mars/subject*.npz and radhar_points/*.npz
(points by frame) and mmrgait_maps.npz (view_*); what is missing is left out. Each becomes a tree of
images, OUT/<set>/<set>, and a table of what is known beside them, OUT/<set>/table.csv; clouds
become Doppler-time histograms, and numbers of their windows in the table. The audits are
OUT/<set>/audit; OUT/audits.md tabulates what tells the classes.
"""

import argparse
import csv
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from shared import commit

from radhar_cli.audit.audit import QUICK, Audit, audit
from radhar_cli.audit.held_out import Effort
from radhar_cli.audit.report import ordered, write_audit
from radhar_cli.processes.progress import NO_PROGRESS

MARS_FRAMES, RADHAR_FRAMES, VIEW_COLUMNS = 20, 60, 30  # of a window: 2 s, 2 s, 0.3 s
DOPPLER_MPS, ROWS = 3.0, 32  # largest Doppler of a histogram, and its rows
FAR_M = 1.5  # from the middle of a cloud: points there are none of the body's
MOVEMENTS = (
    *("left_upper_limb", "right_upper_limb", "both_upper_limbs", "left_front_lunge"),
    *("right_front_lunge", "squat", "left_side_lunge", "right_side_lunge", "left_limbs"),
    "right_limbs",
)

Float = NDArray[np.floating[Any]]


class Sample(NamedTuple):
    """An image [H, W] of a class, and what is known beside it."""

    label: str
    levels: Float
    known: dict[str, object]


def glasgow(folder: Path) -> Iterator[Sample]:
    """Masks of six activities; walking was recorded for 10 s, the others for 5 s."""
    path = folder / "glasgow_masks.npz"
    if not path.exists():
        return
    with np.load(path) as stored:
        masks = np.unpackbits(stored["masks"], axis=2)
        for mask, label in zip(masks, stored["label"], strict=True):
            name = str(stored["classes"][label])
            yield Sample(name, 255.0 * mask, {"length_s": 10 if name == "walking" else 5})


def mars(folder: Path) -> Iterator[Sample]:
    """Windows of MARS's clouds (x right, y forward, z up, Doppler, intensity) of two persons."""
    for path in sorted((folder / "mars").glob("subject*.npz")):
        person, part = path.stem.split("_")
        with np.load(path) as stored:
            points, movement, number = (
                stored[name] for name in ("points", "movement", "frame_number")
            )
        starts = np.searchsorted(points[:, 0], np.arange(len(movement) + 1))
        for first in range(0, len(movement) - MARS_FRAMES + 1, MARS_FRAMES):
            frames = slice(first, first + MARS_FRAMES)
            if np.unique(movement[frames]).size > 1:
                continue
            window = points[starts[first] : starts[first + MARS_FRAMES]]
            window = window[:, [0, 1, 2, 3, 4, 5]] - [first, 0, 0, 0, 0, 0]
            known = {"person": person, "recording": f"{person} {part}"}
            known |= {"frame_in_recording": number[first], **cloud_numbers(window, MARS_FRAMES)}
            yield Sample(MOVEMENTS[movement[first]], histogram(window, MARS_FRAMES), known)


def radhar_points(folder: Path) -> Iterator[Sample]:
    """Windows of RadHAR's clouds (x forward, y, z up, velocity), one recording of each class."""
    for path in sorted((folder / "radhar_points").glob("*.npz")):
        with np.load(path) as stored:
            points, count = stored["points"], len(stored["t"])
        starts = np.searchsorted(points[:, 0], np.arange(count + 1))
        for first in range(0, count - RADHAR_FRAMES + 1, RADHAR_FRAMES):
            window = points[starts[first] : starts[first + RADHAR_FRAMES]]
            window = window[:, [0, 2, 1, 3, 4, 5]] - [first, 0, 0, 0, 0, 0]
            known = {"recording": path.stem, "frame_in_recording": first}
            known |= cloud_numbers(window, RADHAR_FRAMES)
            yield Sample(path.stem.partition("_")[0], histogram(window, RADHAR_FRAMES), known)


def mmrgait(folder: Path) -> Iterator[Sample]:
    """Windows of a walker's maps, whose classes are the directions that they are seen from."""
    path = folder / "mmrgait_maps.npz"
    if not path.exists():
        return
    with np.load(path) as stored:
        for name in stored.files:
            decibels = stored[name]
            levels = 255 * (decibels - decibels.max() + 60) / 60
            for first in range(0, decibels.shape[1] - VIEW_COLUMNS + 1, VIEW_COLUMNS):
                known = {"recording": name, "column": first}
                yield Sample(name, levels[:, first : first + VIEW_COLUMNS], known)


def cloud_numbers(window: Float, frames: int) -> dict[str, object]:
    """Numbers of a window of clouds that are not the movement, or hardly.

    Args:
        window: points [N, 6]: frame, x right, y forward, z up (m), Doppler (m/s), intensity.
        frames: number of frames.
    """
    middle = np.median(window[:, 1:3], axis=0)
    distance = np.hypot(*(window[:, 1:3] - middle).T)
    return {
        "range_m": round(float(middle[1]), 3),
        "cross_range_m": round(float(middle[0]), 3),
        "points_a_frame": round(len(window) / frames, 3),
        "intensity": round(float(np.median(window[:, 5])), 3),
        "far_points": round(float(np.mean(distance > FAR_M)), 4),
    }


def histogram(window: Float, frames: int) -> Float:
    """Levels [ROWS, frames] of the number of points by Doppler and frame, approach on top."""
    doppler = np.clip(-window[:, 4], -DOPPLER_MPS, DOPPLER_MPS)
    edges = (np.linspace(-DOPPLER_MPS, DOPPLER_MPS, ROWS + 1), np.arange(frames + 1))
    counts = np.histogram2d(doppler, window[:, 0], edges)[0][::-1]
    levels: Float = 255 * np.minimum(counts / 8, 1)
    return levels


SETS = {
    "glasgow": glasgow,
    "mars": mars,
    "radhar_points": radhar_points,
    "mmrgait": mmrgait,
}


def convert(samples: list[Sample], folder: Path) -> None:
    """Write samples as a tree of images, numbered class by class, and a table."""
    rows, numbers = list[dict[str, object]](), dict[str, int]()
    for sample in samples:
        number = numbers[sample.label] = numbers.get(sample.label, -1) + 1
        path = Path(sample.label, f"{number:04d}.png")
        (folder / folder.name / sample.label).mkdir(parents=True, exist_ok=True)
        levels = np.clip(np.rint(sample.levels), 0, 255).astype(np.uint8)
        Image.fromarray(levels).save(folder / folder.name / path)
        rows.append({"file": path.as_posix(), **sample.known})
    with (folder / "table.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def tabulate(name: str, result: Audit) -> str:
    """Table of an audit, as Markdown."""
    classes = len(result.data.classes)
    lines = [
        f"## {name}: {result.rows.size} samples of {classes} classes, {result.held_out}s held out",
        "",
        "| from | right, % (95 %) | chance, % | verdict |",
        "| --- | --- | --- | --- |",
    ]
    for line in ordered(result.lines):
        cells = [line.evidence.name, "", "", line.verdict]
        if line.result is not None:
            share, low, high, chance = (f"{100 * value:.1f}" for value in line.result[:4])
            cells[1:3] = [f"{share} ({low} to {high})", chance]
        lines.append(f"| {' | '.join(cells)} |")
    lines += ["", *(f"- {text}" for text in (*result.sentences, *result.warnings))]
    return "\n".join(lines).rstrip() + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path, help="measured data sets")
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--only", choices=SETS, help="one of them")
    parser.add_argument("--quick", action="store_true", help="smaller forests")
    given = parser.parse_args()
    if not given.folder.is_dir():
        sys.exit(f"audit_measured: {given.folder}: no such folder")
    texts = [f"commit {commit()}\n"]
    for name in [given.only] if given.only else SETS:
        samples, folder = list(SETS[name](given.folder)), given.out / name
        if not samples:
            continue
        convert(samples, folder)
        table, effort = folder / "table.csv", QUICK if given.quick else Effort()
        result = audit(folder / name, NO_PROGRESS, table=table, effort=effort)
        write_audit(result, folder / "audit")
        texts.append(tabulate(name, result))
        print(texts[-1])
    (given.out / "audits.md").write_text("\n".join(texts))


if __name__ == "__main__":
    main()
