"""Point clouds as others keep them: arrays of MARS, messages of TI's ROS driver, TI's viewer.

All of them have Doppler as TI does, receding positive. MARS: S. An and U. Y. Ogras, 2021, as their
script MARS_model.py loads it. ROS: messages RadarScan of ti_mmwave_rospkg for SDK 2 as `rostopic
echo` prints them, which RadHAR (A. D. Singh et al., 2019) keeps and its script voxels.py reads. TI:
the point clouds of its Industrial Visualizer.
"""

import csv
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.lib.format import open_memmap
from numpy.typing import NDArray

from radhar_cli.config.data_set import Config, MeasuredConfig
from radhar_cli.config.identity import as_yaml
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.dataset.formats.uart import (
    counting_frames,
    demo_frames,
    old_demo_frames,
    people_frames,
)
from radhar_cli.dataset.layout import CARD, CONFIG, Rows
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.table import Entry, entries
from radhar_cli.errors import FolderError
from radhar_cli.motion.segments import cross, unit
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float
from radhar_cli.processes.progress import Progress
from radhar_cli.processing.people_tracking.compressed_points import (
    SNR,
    Polar,
    pack_points,
    unpack_points,
)
from radhar_cli.radar.detection import Firmware

SIDE = 8  # MARS: 64 points of a frame as a square
MARS_SPLITS = ("train", "validate", "test")  # in its file names
# The 19 of the Kinect's 25 joints that MARS learns, in the Kinect's order.
MARS_JOINTS = (
    "SpineBase", "SpineMid", "Neck", "Head", "ShoulderLeft", "ElbowLeft", "WristLeft",
    "ShoulderRight", "ElbowRight", "WristRight", "HipLeft", "KneeLeft", "AnkleLeft", "FootLeft",
    "HipRight", "KneeRight", "AnkleRight", "FootRight", "SpineShoulder",
)  # fmt: skip
# Where the joints that ours lack are, read off the medians of MARS's subject 1: the neck between
# the shoulders' middle and the head, a hip joint beside `hip` over the width of the shoulders, a
# foot ahead of its ankle and below it over the length of the shank.
NECK, HIP_ASIDE, FOOT_AHEAD, FOOT_BELOW = 1 / 3, 0.23, 0.22, 0.2
ROS_SPLITS = ("Train", "Validation", "Test")  # folders; RadHAR has the first and the last
ROS_FRAME = "ti_mmwave"
# RadHAR's voxels.py drops the last two frames of a file and needs a window of 60 in the rest.
VOXEL_FRAMES = 62
MAGNITUDES = ("sdk1", "sdk3")  # firmware whose intensity is a magnitude
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


Encode: TypeAlias = Callable[[Iterator[Float]], Iterator[bytes]]
MESSAGES: Mapping[str | None, Encode] = {
    "people_tracking": people_frames,
    "people_counting": counting_frames,
    "sdk3": demo_frames,
    "sdk1": old_demo_frames,
}
Columns: TypeAlias = Callable[[Clouds], Sequence[Any]]


def firmware_of(data: Dataset) -> Firmware | None:
    """Firmware that found the points of a data set; None of `cloud.chain: best`."""
    config = data.config
    if not isinstance(config, Config) or not isinstance(config.radar, ArrayRadar):
        return None
    return None if config.cloud.chain == "best" else config.radar.firmware


def clouds_of(data: Dataset, row: int) -> Clouds:
    """Read the point clouds of the sample in a row, in TI's axes; measured ones have no joints."""
    products, firmware = data.products, firmware_of(data)
    points, start = products["points"][row], products["points_start"][row]
    snr_db, xyz, doppler = points[:, 5].astype(float), _ti_axes(points), -points[:, 3].astype(float)
    board = firmware in MAGNITUDES or isinstance(data.config, MeasuredConfig)
    joints: Float = np.empty((len(start) - 1, 0, 3))
    if "skeleton" in products:
        joints = _ti_axes(products["skeleton"][row][:, 0])
    if firmware == "people_tracking":
        sent = unpack_points(pack_points(Polar.of_cloud(points)))
        xyz, doppler = sent.places, sent.doppler
        snr_db = 10 * np.log10(np.maximum(sent.snr, SNR))
    return Clouds(
        frame=np.repeat(np.arange(len(start) - 1), np.diff(start)),
        xyz=xyz,
        doppler=doppler,
        bins=-np.round(np.nan_to_num(points[:, 7])).astype(np.intp),
        amplitude=points[:, 4].astype(float) if board else 10 ** (snr_db / 20),
        snr_db=snr_db,
        person=products["points_person"][row].astype(np.intp),
        joints=joints,
    )


def feature_map(clouds: Clouds, frame: int) -> Float:
    """Arrange a frame of clouds as MARS does, [8, 8, 5]: x, y, z, Doppler, amplitude.

    Points are in ascending order of x, then y, then z; the first 64 stay, zeros follow.
    """
    in_frame = clouds.frame == frame
    x, y, z = clouds.xyz[in_frame].T
    points = np.column_stack([x, y, z, clouds.doppler[in_frame], clouds.amplitude[in_frame]])
    points = points[np.lexsort((z, y, x))][: SIDE * SIDE]
    features = np.zeros((SIDE * SIDE, 5))
    features[: len(points)] = points
    return features.reshape(SIDE, SIDE, 5)


def kinect_joints(joints: Float) -> Float:
    """Positions [..., 19, 3] of MARS_JOINTS.

    Args:
        joints: positions [..., 13, 3] of JOINTS, m, in any right-handed axes.
    """
    joint = dict(zip(JOINTS, np.moveaxis(joints, -2, 0), strict=True))
    across = joint["left_shoulder"] - joint["right_shoulder"]
    middle = (joint["left_shoulder"] + joint["right_shoulder"]) / 2
    places = {
        "SpineBase": joint["hip"],
        "SpineMid": joint["torso"],
        "SpineShoulder": middle,
        "Neck": middle + NECK * (joint["head"] - middle),
        "Head": joint["head"],
    }
    for side, sign in (("left", 1), ("right", -1)):
        knee, ankle = joint[f"{side}_knee"], joint[f"{side}_ankle"]
        shank = ankle - knee
        ahead = np.moveaxis(unit(cross(*(np.moveaxis(v, -1, 0) for v in (shank, across)))), 0, -1)
        length = np.linalg.norm(shank, axis=-1, keepdims=True)
        of_side = {
            "Shoulder": joint[f"{side}_shoulder"],
            "Elbow": joint[f"{side}_elbow"],
            "Wrist": joint[f"{side}_hand"],
            "Hip": joint["hip"] + sign * HIP_ASIDE * across,
            "Knee": knee,
            "Ankle": ankle,
            "Foot": ankle + FOOT_AHEAD * length * ahead + FOOT_BELOW * shank,
        }
        places |= {f"{name}{side.capitalize()}": place for name, place in of_side.items()}
    return np.stack([places[name] for name in MARS_JOINTS], axis=-2)


def write_mars(data: Dataset, folder: Path, progress: Progress) -> None:
    """Write featuremap_<split>.npy, labels_<split>.npy and frames_<split>.npy of all three splits.

    Samples in which nobody is have no joints, and are left out.

    Raises:
        FolderError: there are no points, or skeletons are not of the thirteen joints.
    """
    _require_points(data, "mars")
    if "skeleton" not in data.products:
        raise FolderError(
            f"{data.path}: is measured; mars needs true joints, which it lacks; ti needs none"
        )
    counts, joints = data.products["points_start"].counts - 1, data.products["skeleton"].shape[2]
    if joints != len(JOINTS):
        raise FolderError(
            f"{data.path}: its skeletons have {joints} joints; mars needs those of people, "
            f"{len(JOINTS)}"
        )
    shapes = {"featuremap": (SIDE, SIDE, 5), "labels": (3 * len(MARS_JOINTS),), "frames": (3,)}
    rows, empty = Rows.of(data.config), list[str]()
    for split, part in enumerate(MARS_SPLITS):
        of_people = [one for one in _of_split(data, split) if not rows[one.row][0].is_nobody]
        total, done = int(counts[[one.row for one in of_people]].sum()), 0
        features, labels, frames = (
            _new_array(
                folder / f"{name}_{part}.npy",
                np.dtype("<i8" if name == "frames" else "<f8"),
                (total, *shape),
            )
            for name, shape in shapes.items()
        )
        for entry in of_people:
            clouds = clouds_of(data, entry.row)
            for frame, skeleton in enumerate(kinect_joints(clouds.joints)):
                features[done] = feature_map(clouds, frame)
                labels[done] = skeleton.T.ravel()
                frames[done] = entry.number, entry.place, frame
                done += 1
            progress.advance(1)
        if not total:
            empty.append(part)
    if empty:
        progress.say(
            f"warning: no frames in {', '.join(empty)}: MARS_model.py, which trains, validates and "
            "tests, stops there; give split.train, split.validation and split.test a share each"
        )
    _describe(data, folder, _MARS.format(names=", ".join(MARS_JOINTS)))


def _new_array(path: Path, kind: np.dtype[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    """A new .npy file to fill; of no rows a file that is there is all (mmap has no empty ones)."""
    if not shape[0]:
        np.save(path, np.zeros(shape, kind))
        return np.zeros(shape, kind)
    return open_memmap(path, mode="w+", dtype=kind, shape=shape)


def write_ros(data: Dataset, folder: Path, progress: Progress) -> None:
    """Write <Split>/<class>/<sample>.txt of messages RadarScan, a record a point.

    Raises:
        FolderError: there are no points.
    """
    _require_points(data, "ros")
    radar = data.config.radar
    if not isinstance(radar, ArrayRadar):
        raise FolderError(
            f"{data.path}: ros needs bins of Doppler; import the recordings with --radar FILE.cfg"
        )
    timing = radar.timing
    middle = timing.n_doppler // 2
    rows, short = Rows.of(data.config), 0
    for split in data.present_splits:
        for entry in _of_split(data, split):
            path = folder / ROS_SPLITS[split] / entry.label / f"{rows.name(entry.row)}.txt"
            path.parent.mkdir(parents=True, exist_ok=True)
            clouds = clouds_of(data, entry.row)
            if len(clouds.frame):  # voxels.py stops at a file without a record
                path.write_text(_radar_scans(clouds, timing.period_s, middle), encoding="utf-8")
            short += 0 < len(np.unique(clouds.frame)) < VOXEL_FRAMES
            progress.advance(1)
    if short:
        progress.say(
            f"warning: {short} of {len(data)} samples have fewer than {VOXEL_FRAMES} frames with "
            "points: RadHAR's voxels.py, which cuts windows of 60 frames, stops there; simulate "
            f"for longer (duration_s; {VOXEL_FRAMES} frames of this radar take "
            f"{VOXEL_FRAMES * timing.period_s:.3g} s)"
        )
    _describe(data, folder, _ROS)


def _radar_scans(c: Clouds, period_s: float, middle: int) -> str:
    """The points of a sample as `rostopic echo` prints messages RadarScan."""
    right, ahead, up = c.xyz.T
    point = np.arange(len(c.frame)) - np.searchsorted(c.frame, c.frame)
    reach, bearing = np.linalg.norm(c.xyz, axis=1), np.degrees(np.arctan2(-right, ahead))
    stamp_ns = np.round(c.frame * period_s * 1e9).astype(np.int64)
    columns = {
        "point_id": point,
        "x": ahead,
        "y": -right,
        "z": up,
        "range": reach,
        "velocity": c.doppler,
        "doppler_bin": c.bins + middle,
        "bearing": bearing,
        "intensity": 10 * np.log10(c.amplitude + 1),
    }
    names = list(columns)
    lines: list[str] = []
    values = zip(*(column.tolist() for column in columns.values()), strict=True)
    for number, (nanoseconds, line) in enumerate(zip(stamp_ns.tolist(), values, strict=True)):
        seconds, rest = divmod(nanoseconds, 10**9)
        lines += [
            "header: ",
            f"  seq: {number}",
            "  stamp: ",
            f"    secs: {seconds}",
            f"    nsecs: {rest:>9}",
            f'  frame_id: "{ROS_FRAME}"',
            *(f"{name}: {_number(value)}" for name, value in zip(names, line, strict=True)),
            "---",
        ]
    return "".join(f"{line}\n" for line in lines)


def write_ti(data: Dataset, folder: Path, progress: Progress) -> None:
    """Write <split>/<class>/<sample>.csv into a folder, with the columns TI.

    Beside it stands <sample>.bin, what the board would have sent, of firmware whose message is
    known: all but radhar's own.

    Raises:
        FolderError: there are no points.
    """
    _require_points(data, "ti")

    firmware = firmware_of(data)

    def columns(c: Clouds) -> Sequence[Any]:
        snr, noise = c.snr_db, 20 * np.log10(np.maximum(c.amplitude, 1e-9)) - c.snr_db
        if firmware == "people_tracking":
            snr, noise = 10 ** (c.snr_db / 10), np.zeros(c.snr_db.size)
        track = np.where(c.person < 0, NO_TRACK, c.person)
        return (c.frame, *c.xyz.T, c.doppler, snr, noise, track)

    _write_csv(data, folder, TI, columns, progress)
    if firmware in MESSAGES:
        _write_messages(data, folder, MESSAGES[firmware])
    _describe(data, folder, f"{_TI}\n\n{_READ_CSV}")


def _require_points(data: Dataset, name: str) -> None:
    """Require that a data set has points, for the format of that name."""
    if "points" not in data.products:
        raise FolderError(
            f"{data.path}: has no points; {name} needs a board's data set, maps: [points]"
        )


def _ti_axes(places: Float) -> Float:
    """Places [..., (right, ahead, up)] in TI's axes, of columns that begin (ahead, left, up)."""
    return np.stack([-places[..., 1], places[..., 0], places[..., 2]], axis=-1)


def _describe(data: Dataset, folder: Path, reading: str) -> None:
    """Write a description of the files, and the config that they follow from."""
    licence = data.config.output.license
    people = (
        " Others are in the scenes too: class and joints are those of the sample's main person."
        if data.config.people
        else ""
    )
    measured = isinstance(data.config, MeasuredConfig)
    kind, verb = ("measured", "cut") if measured else ("simulated", "simulated")
    text = f"# Point clouds of {len(data)} {kind} samples\n\n{reading}\n\n"
    text += f"They were {verb} by config.yaml.{people}\nLicence: {licence or 'not chosen'}.\n"
    (folder / CARD).write_text(text, encoding="utf-8")
    (folder / CONFIG).write_text(as_yaml(data.config), encoding="utf-8")


def _of_split(data: Dataset, split: int) -> Iterator[Entry]:
    """Yield the samples of a split, in the order of the table."""
    return (entry for entry in entries(data) if entry.split == split)


def _write_csv(
    data: Dataset, folder: Path, head: Sequence[str], columns: Columns, progress: Progress
) -> None:
    """Write <split>/<class>/<sample>.csv of every sample, a line a point.

    Args:
        data: the data set.
        folder: folder of the files.
        head: names of the columns.
        columns: function that gives the columns of a sample's clouds.
        progress: is told of every sample.
    """
    rows = Rows.of(data.config)
    for split, part in data.present_splits.items():
        for entry in _of_split(data, split):
            path = folder / part / entry.label / f"{rows.name(entry.row)}.csv"
            path.parent.mkdir(parents=True, exist_ok=True)
            values = [np.asarray(column).tolist() for column in columns(clouds_of(data, entry.row))]
            with path.open("w", newline="", encoding="utf-8") as file:
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(head)
                for line in zip(*values, strict=True):
                    writer.writerow(map(_number, line))
            progress.advance(1)


def _write_messages(data: Dataset, folder: Path, encode: Encode) -> None:
    """Write <split>/<class>/<sample>.bin of every sample, frame after frame."""
    rows = Rows.of(data.config)
    for split, part in data.present_splits.items():
        for entry in _of_split(data, split):
            points, start = (data.products[name][entry.row] for name in ("points", "points_start"))
            frames = (points[first:stop] for first, stop in pairwise(start))
            path = folder / part / entry.label / f"{rows.name(entry.row)}.bin"
            path.write_bytes(b"".join(encode(frames)))


def _number(value: float) -> str:
    """A number in six digits, never -0; an integer as it is."""
    return f"{value + 0.0:.6g}" if isinstance(value, float) else str(value)


_MARS = """\
```python
import numpy as np

features = np.load("featuremap_train.npy")    # float64 [frame, 8, 8, 5]
labels = np.load("labels_train.npy")          # float64 [frame, 57]
activity, sample, frame = np.load("frames_train.npy").T
```

The layout of MARS (An and Ogras, 2021): its MARS_model.py reads `featuremap_` and `labels_` of
`train`, `validate` and `test` in a folder `feature` beside it; it needs frames in all three (keys
`split.validation` and `split.test`). Every frame stands alone, up to 64 points in ascending order
of x, y, z as 8 x 8 pixels of x (right), y (ahead), z (up of the radar; m), Doppler (m/s, receding
positive) and intensity; zeros follow the last point. Intensity is the firmware's magnitude; with
`cloud.chain: best` the amplitude over the noise's.

`labels` has the x of 19 joints of a Kinect, their y, then their z: {names}. SpineMid is radhar's
torso, a wrist its hand. Computed of their neighbours, as radhar has 13 joints: SpineShoulder (the
middle of the shoulders), Neck (a third of the way from there to the head), HipLeft and HipRight
(beside the hip, 0.23 of the shoulders' distance), FootLeft and FootRight (ahead of the ankle and
below it, 0.22 and 0.2 of the shank). `frames_` is ours: class, sample and frame of every row."""

_ROS = """\
`Train/CLASS/SAMPLE.txt` has a record a point, closed by a line `---`, as `rostopic echo` prints the
message RadarScan of TI's ROS driver (ti_mmwave_rospkg, SDK 2) and as RadHAR keeps its recordings:
`header.stamp` (the frame's time after the start); `point_id`, 0 where a frame begins, so that a
frame without points leaves no record and a sample without any no file; x (ahead), y (left), z (up
of the radar) and range, m; velocity, m/s, positive receding; `doppler_bin`, zero Doppler in the
middle one; bearing, degrees, positive left; intensity, 10 lg(magnitude + 1). RadHAR's voxels.py
reads a folder of classes, such as `Train`, with these in its `sub_dirs`. It cuts windows of 60
frames with points, RadHAR's 2 s, and stops at a file that has fewer than 62; its classifiers load
what it writes by the names of RadHAR's five classes.

```python
import yaml

points = [*yaml.safe_load_all(open("Train/CLASS/SAMPLE.txt").read())][:-1]  # slow, but short
```"""

_TI = """\
`train/CLASS/SAMPLE.csv` has a line a point: its frame, and the seven columns that a point cloud of
TI's Industrial Visualizer has: x (right), y (ahead), z (up of the radar; m), Doppler (m/s, receding
positive), SNR and noise (dB), and the track: here the person whose the point is, 255 nobody's.
Of people tracking, all is rounded as its message TLV 1020 is, SNR is a ratio of powers and noise 0.
`SAMPLE.bin`, of every chain of the firmware, is what the board would have sent: frames of magic
word, header of 40 bytes (36 of SDK 1), and the points: TLV 1020 of people tracking, 6 of people
counting, 1 of SDK 1, 1 and 7 (SNR and noise, which is the level less the SNR) of SDK 3."""

_READ_CSV = """\
```python
import csv

points = list(csv.DictReader(open("train/CLASS/SAMPLE.csv")))
```"""
