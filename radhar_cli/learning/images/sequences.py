"""Sequences of frames or of point clouds of a data set, cut or filled up to one length."""

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.config.maps import FRAME_MAPS
from radhar_cli.dataset.reading import Dataset, open_dataset
from radhar_cli.errors import FolderError
from radhar_cli.learning.registry import Kind
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float, Index

COLUMNS = ("x", "y", "z", "doppler", "snr", "present")
POINTS = 64
CLOUDS = "points"


def fit_length(values: NDArray[Any], frames: int, empty: float) -> NDArray[Any]:
    """Middle `frames` of a sequence [T, ...], or a shorter one filled up at its end.

    Args:
        values: [T, ...].
        frames: number of frames of the result.
        empty: value of the frames that are added.

    Returns:
        Sequence [frames, ...].
    """
    spare = max(len(values) - frames, 0)
    middle = values[spare // 2 : spare // 2 + frames]
    missing = np.full((frames - len(middle), *values.shape[1:]), empty, values.dtype)
    return np.concatenate([middle, missing])


def cloud_frames(points: Float, start: Index, count: int) -> NDArray[np.float32]:
    """Clouds of each frame as [T, count, 6]: x, y, z (m), Doppler (m/s), SNR (bels), present.

    Of more points than `count` those of the highest SNR stay, in their order; where there are
    fewer, the rows after them are zeros, `present` among them.

    Args:
        points: rows [N, 8] of all frames: x, y, z, Doppler, intensity, SNR (dB), bins.
        start: [T + 1] first row of each frame, and N.
        count: number of points of a frame in the result.
    """
    clouds = np.zeros((len(start) - 1, count, len(COLUMNS)), np.float32)
    for frame, first, stop in zip(clouds, start[:-1], start[1:], strict=True):
        rows = points[first:stop]
        if len(rows) > count:
            rows = rows[np.sort(np.argsort(-rows[:, 5], kind="stable")[:count])]
        frame[: len(rows), :4] = rows[:, :4]
        frame[: len(rows), 4] = np.nan_to_num(rows[:, 5]) / 10  # measured ones may have no SNR
        frame[: len(rows), 5] = 1
    return clouds


@dataclass
class Opened:
    """A data set that every process opens for itself."""

    path: Path
    _open: dict[int, Dataset] = field(default_factory=dict, repr=False, kw_only=True)

    @property
    def data(self) -> Dataset:
        """Data set, opened in this process."""
        dataset = self._open.get(os.getpid())
        if dataset is None:
            self._open.clear()
            dataset = self._open[os.getpid()] = open_dataset(self.path)
        return dataset

    def keep_open(self, data: Dataset) -> None:
        """Read from a data set of this path that is open in this process already."""
        self._open[os.getpid()] = data

    def __getstate__(self) -> dict[str, object]:
        return {**self.__dict__, "_open": {}}


@dataclass
class SequenceReader(Opened):
    """Sequences of one length: frames of a map or clouds, and the joints behind them."""

    product: str
    frames: int
    points: int  # number of points of a cloud

    def read(self, row: int) -> NDArray[Any]:
        """Clouds float32 [T, points, 6], or grey levels uint8 [rows, columns, T] of a map."""
        products = self.data.products
        values = products[self.product][row]
        if self.product == CLOUDS:
            clouds = cloud_frames(values, products["points_start"][row], self.points)
            return fit_length(clouds, self.frames, 0)
        return fit_length(values, self.frames, 0).transpose(1, 2, 0)

    def span(self, row: int) -> tuple[int, int]:
        """Number of the first frame of a sample that is read, and the number of frames read."""
        clouds = self.product == CLOUDS
        sample_frames = (
            len(self.data.products["points_start" if clouds else self.product][row]) - clouds
        )
        return max(sample_frames - self.frames, 0) // 2, min(sample_frames, self.frames)

    def joints(self, row: int) -> NDArray[np.float32]:
        """Joints [T, joint, 3] of the first person, m; NaN after the end of a sample."""
        skeleton = self.data.products["skeleton"][row][:, 0]
        return fit_length(skeleton, self.frames, np.nan)


def sequence_product(data: Dataset, kind: Kind, name: str | None = None) -> str:
    """Name of the product of a data set that is read as sequences.

    Args:
        data: open data set.
        kind: frames or clouds.
        name: name of the product; None takes the first of that kind.

    Raises:
        FolderError: the data set has no such product.
    """
    products = [product for product in FRAME_MAPS if (product == CLOUDS) == (kind == "clouds")]
    available = [product for product in products if product in data.products]
    if not available or name not in (*available, None):
        known = (
            f"it has {', '.join(available)}"
            if available
            else f"should have maps: {', '.join(products)}"
        )
        raise FolderError(f"{data.path}: has no {kind}{f' of {name!r}' if name else ''}; {known}")
    return name or available[0]


def longest_sequence(data: Dataset, product: str) -> int:
    """Largest number of frames of a sample, of a product of frames or clouds."""
    clouds = product == CLOUDS
    frames = data.products["points_start" if clouds else product]
    return int(frames.counts.max()) - clouds


def joint_names(data: Dataset) -> tuple[str, ...]:
    """Names of the joints of a data set's skeletons; "joint 0" and so on of another skeleton.

    Measured data sets have none.
    """
    if "skeleton" not in data.products:
        return ()
    count = data.products["skeleton"].shape[2]
    return JOINTS if count == len(JOINTS) else tuple(f"joint {n}" for n in range(count))
