"""Point clouds as others keep them: arrays of MARS, columns of TI's ROS driver and of TI's viewer.

All of them have Doppler as TI does, receding positive. MARS: S. An and U. Y. Ogras, 2021. ROS:
message RadarScan of ti_mmwave_rospkg for SDK 2. TI: the point clouds of its Industrial Visualizer.
"""

import csv
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.lib.format import open_memmap
from numpy.typing import NDArray

from radhar_cli.arrays import Float
from radhar_cli.config.identity import as_yaml
from radhar_cli.config.schema import Config
from radhar_cli.config.ti_header import board_header
from radhar_cli.dataset.layout import CARD, CONFIG, Rows
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.table import Entry, entries
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.progress import Progress

SIDE = 8  # MARS: 64 points of a frame as a square
ROS = (
    "frame", "stamp_s", "point_id", "x", "y", "z", "range", "velocity", "doppler_bin", "bearing",
    "intensity",
)  # fmt: skip
TI = ("frame", "x", "y", "z", "doppler", "snr", "noise", "track")
NO_TRACK = 255  # of a point that belongs to nobody


class Clouds(NamedTuple):
    """Point clouds of a sample and the joints behind them, in TI's axes."""

    frame: NDArray[np.intp]  # [N], of each point
    xyz: Float  # [N, 3], m: right, ahead, up
    doppler: Float  # [N], m/s, receding
    bins: NDArray[np.intp]  # [N], signed Doppler bin, receding
    # [N]: magnitude in the firmware's units; of `cloud.chain: best`, amplitude over noise
    amplitude: Float
    snr_db: Float  # [N]
    person: NDArray[np.intp]  # [N], -1: nobody's
    joints: Float  # of the first person, [frame, joint, 3], m: right, ahead, up


Columns: TypeAlias = Callable[[Clouds], Sequence[Any]]


def clouds_of(data: Dataset, row: int) -> Clouds:
    """Read the point clouds of the sample in a row, in TI's axes."""
    products = data.products
    points, start = products["points"][row], products["points_start"][row]
    snr_db = points[:, 5].astype(float)
    board = isinstance(data.config, Config) and data.config.cloud.chain == "board"
    return Clouds(
        frame=np.repeat(np.arange(len(start) - 1), np.diff(start)),
        xyz=_ti_axes(points),
        doppler=-points[:, 3].astype(float),
        bins=-np.round(points[:, 7]).astype(np.intp),
        amplitude=points[:, 4].astype(float) if board else 10 ** (snr_db / 20),
        snr_db=snr_db,
        person=products["points_person"][row].astype(np.intp),
        joints=_ti_axes(products["skeleton"][row][:, 0]),
    )


def feature_map(clouds: Clouds, frame: int) -> NDArray[np.float32]:
    """Arrange a frame of clouds as MARS does, [8, 8, 5]: x, y, z, Doppler, amplitude.

    Points are in ascending order of x, then y, then z; the first 64 stay, zeros follow.
    """
    here = clouds.frame == frame
    x, y, z = clouds.xyz[here].T
    rows = np.column_stack([x, y, z, clouds.doppler[here], clouds.amplitude[here]])
    rows = rows[np.lexsort((z, y, x))][: SIDE * SIDE]
    found = np.zeros((SIDE * SIDE, 5), np.float32)
    found[: len(rows)] = rows
    return found.reshape(SIDE, SIDE, 5)


def write_mars(data: Dataset, folder: Path, progress: Progress) -> None:
    """Write featuremap_<split>.npy, labels_<split>.npy and frames_<split>.npy into a folder."""
    counts, joints = data.products["points_start"].counts - 1, data.products["skeleton"].shape[2]
    shapes = {"featuremap": (SIDE, SIDE, 5), "labels": (3 * joints,), "frames": (3,)}
    for split, part in data.present_splits.items():
        total, done = int(counts[data.split == split].sum()), 0
        features, labels, frames = (
            open_memmap(
                folder / f"{name}_{part}.npy",
                mode="w+",
                dtype="<i8" if name == "frames" else "<f4",
                shape=(total, *shape),
            )
            for name, shape in shapes.items()
        )
        for entry in _of_split(data, split):
            clouds = clouds_of(data, entry.row)
            for frame, skeleton in enumerate(clouds.joints):
                features[done] = feature_map(clouds, frame)
                labels[done] = skeleton.T.ravel()
                frames[done] = entry.number, entry.place, frame
                done += 1
            progress.advance(1)
    names = ", ".join(JOINTS) if joints == len(JOINTS) else "as the recorded motion has them"
    _describe(data, folder, _MARS.format(joints=joints, names=names))


def write_ros(data: Dataset, folder: Path, progress: Progress) -> None:
    """Write <split>/<class>/<sample>.csv into a folder, with the columns ROS."""
    header = board_header(data.config.radar.cfg or "")
    middle = 2 ** (header.loops - 1).bit_length() // 2

    def columns(c: Clouds) -> Sequence[Any]:
        right, ahead, up = c.xyz.T
        point = np.arange(len(c.frame)) - np.searchsorted(c.frame, c.frame)
        reach, bearing = np.linalg.norm(c.xyz, axis=1), np.degrees(np.arctan2(-right, ahead))
        seen = (reach, c.doppler, c.bins + middle, bearing, 10 * np.log10(c.amplitude + 1))
        return (c.frame, c.frame * header.period_s, point, ahead, -right, up, *seen)

    _write_csv(data, folder, ROS, columns, progress)
    _describe(data, folder, f"{_ROS}\n\n{_READ_CSV}")


def write_ti(data: Dataset, folder: Path, progress: Progress) -> None:
    """Write <split>/<class>/<sample>.csv into a folder, with the columns TI."""

    def columns(c: Clouds) -> Sequence[Any]:
        noise = 20 * np.log10(np.maximum(c.amplitude, 1e-9)) - c.snr_db
        track = np.where(c.person < 0, NO_TRACK, c.person)
        return (c.frame, *c.xyz.T, c.doppler, c.snr_db, noise, track)

    _write_csv(data, folder, TI, columns, progress)
    _describe(data, folder, f"{_TI}\n\n{_READ_CSV}")


def _ti_axes(places: Float) -> Float:
    """Places [..., (right, ahead, up)] in TI's axes, of columns that begin (ahead, left, up)."""
    return np.stack([-places[..., 1], places[..., 0], places[..., 2]], axis=-1)


def _describe(data: Dataset, folder: Path, reading: str) -> None:
    """Write what the files hold, and the config that they follow from."""
    licence = data.config.output.license
    people = (
        " Others are in the scenes too: class and joints are those of the sample's main person."
        if data.config.people
        else ""
    )
    text = f"# Point clouds of {len(data)} simulated samples\n\n{reading}\n\n"
    text += f"They were simulated by config.yaml.{people}\nLicence: {licence or 'not chosen'}.\n"
    (folder / CARD).write_text(text, encoding="utf-8")
    (folder / CONFIG).write_text(as_yaml(data.config), encoding="utf-8")


def _of_split(data: Dataset, split: int) -> Iterator[Entry]:
    return (entry for entry in entries(data) if entry.split == split)


def _write_csv(
    data: Dataset, folder: Path, head: Sequence[str], columns: Columns, progress: Progress
) -> None:
    rows = Rows.of(data.config)
    for split, part in data.present_splits.items():
        for entry in _of_split(data, split):
            path = folder / part / entry.label / f"{rows.name(entry.row)}.csv"
            path.parent.mkdir(parents=True, exist_ok=True)
            values = [np.asarray(one).tolist() for one in columns(clouds_of(data, entry.row))]
            with path.open("w", newline="", encoding="utf-8") as file:
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(head)
                for line in zip(*values, strict=True):
                    writer.writerow(f"{v + 0.0:.6g}" if isinstance(v, float) else v for v in line)
            progress.advance(1)


_MARS = """\
```python
import numpy as np

features = np.load("featuremap_train.npy")    # [frame, 8, 8, 5]
labels = np.load("labels_train.npy")          # [frame, 3 x joints]
activity, sample, frame = np.load("frames_train.npy").T
```

The layout of MARS (An and Ogras, 2021): every frame alone, up to 64 points in ascending order of x,
y, z as 8 x 8 pixels of x (right), y (ahead), z (up of the radar; m), Doppler (m/s, receding
positive) and intensity; zeros follow the last point. `labels` has the x of the {joints} joints,
their y, then their z: {names}. Intensity is the firmware's magnitude; with `cloud.chain: best` the
amplitude over the noise's."""

_ROS = """\
`train/CLASS/SAMPLE.csv` has a line a point, as the message RadarScan of TI's ROS driver
(ti_mmwave_rospkg, SDK 2) has it: frame and its time `stamp_s`; `point_id` in the frame; x (ahead),
y (left), z (up of the radar) and range, m; velocity, m/s, positive receding; `doppler_bin`, zero
Doppler in the middle one; bearing, degrees, positive left; intensity, 10 lg(magnitude + 1)."""

_TI = """\
`train/CLASS/SAMPLE.csv` has a line a point: its frame, and the seven columns that a point cloud of
TI's Industrial Visualizer has: x (right), y (ahead), z (up of the radar; m), Doppler (m/s, receding
positive), SNR and noise (dB), and the track: here the person whose the point is, 255 nobody's."""

_READ_CSV = """\
```python
import csv

points = list(csv.DictReader(open("train/CLASS/SAMPLE.csv")))
```"""
