"""Sequences of frames or of point clouds of a data set, cut or filled up to one length."""

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.arrays import Float, Index
from radhar_cli.config.schema import FRAME_MAPS
from radhar_cli.dataset.reading import Dataset, open_dataset
from radhar_cli.errors import FolderError
from radhar_cli.learning.settings import Kind
from radhar_cli.motion.skeleton import JOINTS

COLUMNS = ("x", "y", "z", "doppler", "snr", "present")
POINTS = 64
CLOUDS = "points"


def of_length(values: NDArray[Any], frames: int, empty: float) -> NDArray[Any]:
    """The middle `frames` of [T, ...]; a shorter sequence is followed by `empty` ones."""
    spare = max(len(values) - frames, 0)
    kept = values[spare // 2 : spare // 2 + frames]
    missing = np.full((frames - len(kept), *values.shape[1:]), empty, values.dtype)
    return np.concatenate([kept, missing])


def cloud_frames(points: Float, start: Index, count: int) -> NDArray[np.float32]:
    """Clouds of each frame as [T, count, 6]: x, y, z (m), Doppler (m/s), SNR (bels), present.

    Of more points than `count` those of the highest SNR stay, in their order; the rest of fewer is
    zeros, `present` among them.

    Args:
        points: rows [N, 8] of all frames: x, y, z, Doppler, intensity, SNR (dB), bins.
        start: first row of each frame, and N [T + 1].
    """
    found = np.zeros((len(start) - 1, count, len(COLUMNS)), np.float32)
    for frame, first, stop in zip(found, start[:-1], start[1:], strict=True):
        some = points[first:stop]
        if len(some) > count:
            some = some[np.sort(np.argsort(-some[:, 5], kind="stable")[:count])]
        frame[: len(some), :4] = some[:, :4]
        frame[: len(some), 4] = some[:, 5] / 10
        frame[: len(some), 5] = 1
    return found


@dataclass
class Opened:
    """A data set that every process opens for itself."""

    path: Path
    _open: dict[int, Dataset] = field(default_factory=dict, repr=False, kw_only=True)

    @property
    def data(self) -> Dataset:
        """The data set, opened in this process."""
        mine = self._open.get(os.getpid())
        if mine is None:
            self._open.clear()
            mine = self._open[os.getpid()] = open_dataset(self.path)
        return mine

    def __getstate__(self) -> dict[str, object]:
        return {**self.__dict__, "_open": {}}


@dataclass
class SequenceReader(Opened):
    """Frames of a map, or clouds, and the joints behind them, of `frames` frames each."""

    product: str
    frames: int
    points: int  # of a cloud

    def read(self, row: int) -> NDArray[Any]:
        """Clouds float32 [T, points, 6], or grey levels uint8 [rows, columns, T] of a map."""
        products = self.data.products
        values = products[self.product][row]
        if self.product == CLOUDS:
            clouds = cloud_frames(values, products["points_start"][row], self.points)
            return of_length(clouds, self.frames, 0)
        return of_length(values, self.frames, 0).transpose(1, 2, 0)

    def span(self, row: int) -> tuple[int, int]:
        """Number of the first frame of the sample that is read, and how many of its frames are."""
        clouds = self.product == CLOUDS
        there = len(self.data.products["points_start" if clouds else self.product][row]) - clouds
        return max(there - self.frames, 0) // 2, min(there, self.frames)

    def joints(self, row: int) -> NDArray[np.float32]:
        """Joints [T, joint, 3] of the first person, m; NaN after the end of a sample."""
        skeleton = self.data.products["skeleton"][row][:, 0]
        return of_length(skeleton, self.frames, np.nan)


def sequence_product(data: Dataset, kind: Kind, name: str | None = None) -> str:
    """The product of a data set that is read as sequences of a kind; the first if none is named."""
    wanted = [one for one in FRAME_MAPS if (one == CLOUDS) == (kind == "clouds")]
    have = [one for one in wanted if one in data.products]
    if not have or name not in (*have, None):
        known = f"it has {', '.join(have)}" if have else f"should have maps: {', '.join(wanted)}"
        raise FolderError(f"{data.path}: has no {kind}{f' of {name!r}' if name else ''}; {known}")
    return name or have[0]


def longest(data: Dataset, product: str) -> int:
    """Most frames of a sample."""
    clouds = product == CLOUDS
    of = data.products["points_start" if clouds else product]
    return int(of.counts.max()) - clouds


def joint_names(data: Dataset) -> tuple[str, ...]:
    """Names of the joints of its skeletons."""
    count = data.products["skeleton"].shape[2]
    return JOINTS if count == len(JOINTS) else tuple(f"joint {n}" for n in range(count))
