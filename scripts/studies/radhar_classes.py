"""Five activities in the point clouds of RadHAR, learned from simulated clouds alone.

    python scripts/studies/radhar_classes.py FOLDER -o OUT [--per-class 30] [--seeds 5] [--half 2]

FOLDER: recordings `<class>*.npz` of boxing, jack, jump, squats and walk (github.com/nesl/RadHAR,
Singh et al. 2019): `points` [N, 9] = frame, x (ahead), y, z (up) m, velocity (receding) m/s,
intensity dB, range m, ...; 30 frames a second. Simulated ones come from
configs/measured/radhar_1443.yaml. Range bins in which something stands still in most frames of all
recordings are the room's and the device's, and left out; points at 0.7 to 2.9 m, within 0.9 m of
the height of the radar, are then the person's. Windows last 4 s, one begins every second. Of each,
ten series over time (how many points, where, how far apart, how many move) give means, spreads and
power in six bands; a logistic regression tells the classes. It has learned before the recordings
are opened. The last line is for programs; windows of a recording overlap, so n is not the number of
independent ones.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from shared import as_options, run_radhar
from sklearn.linear_model import LogisticRegression
from sklearn.pipeline import Pipeline, make_pipeline
from sklearn.preprocessing import StandardScaler

from radhar_cli.dataset.reading import open_dataset

Float = NDArray[np.float64]
Whole = NDArray[np.intp]
ROOT = Path(__file__).resolve().parents[2]
CONFIG = ROOT / "configs" / "measured" / "radhar_1443.yaml"
CLASSES = ("boxing", "jack", "jump", "squats", "walk")
RATE, FRAMES, EVERY = 30, 120, 30  # Hz; frames of a window, and from one to the next
RANGE_STEP, SPEED_STEP = 0.0436, 0.615  # of the radar, m and m/s
ROOM = 0.8  # of all frames have a still point in a range bin of the room
NEAR_M, FAR_M, HIGH_M = 0.7, 2.9, 0.9
BANDS_HZ = (0.1, 0.4, 0.8, 1.4, 2.4, 4.0, 15.0)
COPIES, LOST, DRIFT_M = 5, 0.3, 0.2  # of each simulated window, changed; most points lost, drift
PENALTY = 0.005  # C of the regression


class Cloud(NamedTuple):
    """Frame of each point [N]; x, y, z (m), approaching speed (m/s), dB, range (m) [N, 6]."""

    frame: Whole
    points: Float


def series(cloud: Cloud, first: int) -> Float:
    """Ten series [10, FRAMES] from frame `first` on, scaled to about the same size."""
    frame, points = cloud.frame - first, cloud.points
    here = (frame >= 0) & (frame < FRAMES) & (np.abs(points[:, 2]) < HIGH_M)
    here &= (points[:, 5] > NEAR_M) & (points[:, 5] < FAR_M)
    frame, (_, y, z, speed, level, reach) = frame[here], points[here].T
    if not frame.size:
        return np.zeros((10, FRAMES))
    count = np.bincount(frame, minlength=FRAMES)
    seen = np.flatnonzero(count)

    def number(which: Float) -> Float:
        return np.bincount(frame, which, minlength=FRAMES)

    def filled(values: Float) -> Float:
        return np.interp(np.arange(FRAMES), seen, values[seen])

    def mean(values: Float) -> Float:
        return filled(number(values - np.median(values)) / np.maximum(count, 1))

    def most(values: Float) -> Float:
        found = np.full(FRAMES, -np.inf)
        np.maximum.at(found, frame, values)
        return filled(found)

    away, moving, strongest = reach - np.median(reach), np.abs(speed) > SPEED_STEP / 2, most(level)
    rows = [
        count / 5,
        3 * mean(reach),
        3 * most(away),
        -3 * most(-away),
        number(moving.astype(float)) / 3,
        number(np.sign(speed) * moving) / 3,
        number((np.abs(speed) > 1.5 * SPEED_STEP).astype(float)) / 2,
        3 * mean(y),
        3 * mean(z),
        (strongest - np.median(strongest)) / 4,
    ]
    return np.stack(rows)


def features(rows: Float) -> Float:
    """Mean, standard deviation, 5 to 95 % and log power in six bands of each series [90]."""
    power = np.abs(np.fft.rfft((rows - rows.mean(1, keepdims=True)) * np.hanning(FRAMES))) ** 2
    band = np.searchsorted(BANDS_HZ, np.fft.rfftfreq(FRAMES, 1 / RATE), side="right")
    bands = [power[:, band == number].sum(1) for number in range(1, len(BANDS_HZ))]
    low, high = np.percentile(rows, [5, 95], axis=1)
    shape = [rows.mean(1), rows.std(1), high - low, *np.log(np.array(bands) + 1e-2)]
    return np.concatenate(shape)


def changed(cloud: Cloud, rng: np.random.Generator) -> Cloud:
    """Fewer points, of a person who drifts to and fro, or of one in a mirror."""
    kept = rng.random(len(cloud.frame)) > rng.uniform(0, LOST)
    frame, points = cloud.frame[kept], cloud.points[kept]
    omega, size = 2 * np.pi * rng.uniform(0.15, 0.5), rng.uniform(0, DRIFT_M)
    phase = omega * frame / RATE + rng.uniform(0, 2 * np.pi)
    drift = size * np.sin(phase)
    points[:, :3] *= 1 + (drift / np.maximum(points[:, 5], 1e-6))[:, None]
    points[:, 5] += drift
    speed = points[:, 3] - size * omega * np.cos(phase)
    points[:, 3] = SPEED_STEP * np.round(speed / SPEED_STEP)
    points[:, 1] *= rng.choice([-1, 1])
    return Cloud(frame, points)


def simulated(
    out: Path, per_class: int, jobs: int, more: Sequence[str] = ()
) -> tuple[list[Cloud], list[int]]:
    """Clouds and classes of a data set that is built in `out`, with more settings of the config."""
    settings = (f"samples_per_class={per_class}", f"duration_s={FRAMES / RATE + 0.05}", *more)
    run_radhar("generate", CONFIG, "-o", out.resolve(), "--jobs", jobs, *as_options(settings))
    clouds = []
    with open_dataset(out) as data:
        labels = [CLASSES.index(data.classes[label]) for label in data.label[:]]
        for row in range(len(labels)):
            start = data.products["points_start"][row]
            frame = np.repeat(np.arange(len(start) - 1), np.diff(start))
            points = np.asarray(data.products["points"][row], float)[: len(frame), :5]
            points[:, 4] = 10 * np.log10(np.maximum(points[:, 4], 1))
            reach = np.linalg.norm(points[:, :3], axis=1)
            clouds.append(Cloud(frame, np.column_stack([points, reach])))
    return clouds, labels


def measured(folder: Path) -> tuple[list[Cloud], list[int]]:
    """Recordings of a folder without the room, and their classes."""
    clouds, labels = [], []
    for path in sorted(folder.glob("*.npz")):
        name = next((one for one in CLASSES if path.name.startswith(one)), None)
        if name is None:
            continue
        with np.load(path, allow_pickle=False) as file:
            rows = file["points"].astype(float)
        clouds.append(Cloud(rows[:, 0].astype(np.intp), rows[:, 1:7] * [1, 1, 1, -1, 1, 1]))
        labels.append(CLASSES.index(name))
    if not clouds:
        sys.exit(f"radhar_classes: {folder}: has no recording <class>*.npz of {', '.join(CLASSES)}")
    bins = [np.round(one.points[:, 5] / RANGE_STEP).astype(int) for one in clouds]
    frames, still = 0, np.zeros(1 + max(int(one.max()) for one in bins))
    for one, at in zip(clouds, bins, strict=True):
        frames += int(one.frame.max()) + 1
        stands = one.points[:, 3] == 0
        pairs = np.unique(np.stack([one.frame[stands], at[stands]]), axis=1)
        still += np.bincount(pairs[1], minlength=len(still))
    room = still > ROOM * frames
    kept = [~room[at] | (one.points[:, 3] != 0) for one, at in zip(clouds, bins, strict=True)]
    without = [Cloud(one.frame[k], one.points[k]) for one, k in zip(clouds, kept, strict=True)]
    return without, labels


def windows(
    clouds: list[Cloud], labels: list[int], half: int | None
) -> tuple[Float, NDArray[np.int_]]:
    """Features and classes of all windows, or of those within a half of each recording, 1 or 2."""
    rows, truth = [], []
    for cloud, label in zip(clouds, labels, strict=True):
        frames = int(cloud.frame.max()) + 1
        first = frames // 2 if half == 2 else 0
        last = frames // 2 if half == 1 else frames
        for begin in range(first, last - FRAMES + 1, EVERY):
            rows.append(features(series(cloud, begin)))
            truth.append(label)
    return np.stack(rows), np.array(truth)


def trained(clouds: list[Cloud], labels: list[int], seed: int) -> Pipeline:
    """A regression that has learned changed copies of all clouds."""
    rng = np.random.default_rng(seed)
    rows = [features(series(changed(one, rng), 0)) for one in clouds for _ in range(COPIES)]
    model = make_pipeline(StandardScaler(), LogisticRegression(C=PENALTY, max_iter=3000))
    return model.fit(np.stack(rows), np.repeat(labels, COPIES))


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path, help="recordings, <class>*.npz")
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--per-class", type=int, default=30, help="simulated samples of each class")
    parser.add_argument("--seeds", type=int, default=5, help="of the changes")
    parser.add_argument("--half", type=int, choices=(1, 2), help="of each recording alone")
    parser.add_argument("--jobs", type=int, default=2, help="processes that generate")
    given = parser.parse_args()
    if not given.folder.is_dir():
        sys.exit(f"radhar_classes: {given.folder}: no such folder")
    clouds, labels = simulated(given.out / "simulated", given.per_class, given.jobs)
    models = [trained(clouds, labels, seed) for seed in range(1, given.seeds + 1)]
    seen, truth = windows(*measured(given.folder), given.half)
    confusion, shares = np.zeros((5, 5), int), []
    for model in models:
        found = model.predict(seen)
        np.add.at(confusion, (truth, found), 1)
        shares.append(float((found == truth).mean()))
    print("rows are true classes, all seeds\n" + " " * 8 + "".join(f"{n:>8}" for n in CLASSES))
    for name, row in zip(CLASSES, confusion, strict=True):
        print(f"{name:8}" + "".join(f"{count:8d}" for count in row))
    print(
        f"accuracy on measured: mean {np.mean(shares):.3f}, lowest {min(shares):.3f}, "
        f"highest {max(shares):.3f}, n = {len(truth)} windows, {len(shares)} seeds"
    )


if __name__ == "__main__":
    main()
