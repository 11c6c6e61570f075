"""Sequences of a data set for PyTorch."""

from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.utils.data import Dataset

from radhar_cli.dataset.reading import open_dataset
from radhar_cli.errors import ConfigError
from radhar_cli.learning.images.image_set import SPLIT_NAMES, check_split_name
from radhar_cli.learning.images.sequences import (
    CLOUDS,
    POINTS,
    SequenceReader,
    longest_sequence,
    sequence_product,
)
from radhar_cli.numerics.arrays import Index


class Sequences(Dataset[dict[str, Any]]):
    """Sequences of a data set as tensors, for a DataLoader.

    An item has `label` (place in `classes`), `skeleton` float32 [frames, joint, 3] of the first
    person (m, in the radar's axes; NaN after the end of the sample), and `clouds` float32 [frames,
    points, 6], or `frames` uint8 [frames, rows, columns]. The columns of a cloud are x, y, z (m),
    Doppler (m/s, approaching), SNR (bels) and 1 where there is a point.

    Attributes:
        label: [N] place in `classes`, as in the dataset.h5.
        classes: name of every label, in the order of the config's `activities`.
        frames: number of frames of an item.
    """

    def __init__(
        self,
        path: str | Path,
        of: str = CLOUDS,
        *,
        split: str = "all",
        frames: int | None = None,
        points: int = POINTS,
    ) -> None:
        """Open the sequences of a data set.

        Args:
            path: folder that `radhar generate` wrote, or dataset.h5.
            of: points, range_doppler, range_azimuth or range_elevation.
            split: train, val, test or all.
            frames: number of frames of an item, the middle ones of a longer sample; None takes that
                of the longest sample.
            points: number of points of a frame, those of the highest SNR.

        Raises:
            ConfigError: frames or points below 1.
            FolderError: it is no data set, or has no such product or split.
        """
        for key, value in (("frames", frames), ("points", points)):
            if value is not None and value < 1:
                raise ConfigError(f"{key} = {value}: should be at least 1")
        with open_dataset(path) as data:
            product = sequence_product(data, "clouds" if of == CLOUDS else "frames", of)
            self.frames = frames or longest_sequence(data, product)
            split_name = check_split_name(split)
            in_split = split_name == "all" or data.split == SPLIT_NAMES.get(split_name)
            self._rows = np.flatnonzero(np.broadcast_to(in_split, data.split.shape))
            self.label: Index = data.label[self._rows].astype(np.intp)
            self.classes = data.classes
            self._reader = SequenceReader(data.path, product, self.frames, points)

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        classes = ", ".join(self.classes[n] for n in np.unique(self.label))
        contents = f"{self.frames} frames of {self._reader.product}"
        return f"<Sequences {self._reader.path}: {len(self)} x {contents}; classes {classes}>"

    def __getitem__(self, row: int) -> dict[str, Any]:
        stored_row, reader = int(self._rows[row]), self._reader
        values: Tensor = torch.from_numpy(np.ascontiguousarray(reader.read(stored_row)))
        inputs = (
            {"clouds": values} if reader.product == CLOUDS else {"frames": values.permute(2, 0, 1)}
        )
        skeleton = torch.from_numpy(reader.joints(stored_row))
        return {**inputs, "skeleton": skeleton, "label": int(self.label[row])}
