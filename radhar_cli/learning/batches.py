"""Batches: which images make a step of training, and how they are read."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import torch
from numpy.typing import ArrayLike
from torch import Tensor
from torch.utils.data import DataLoader, Dataset

from radhar_cli.errors import FolderError
from radhar_cli.learning.augmentation import Augmentation
from radhar_cli.learning.images.image_set import Pixels
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.numerics.randomness import TRAINING, stream

SMALLEST = 2  # images of a batch, for batch norm
AS_STORED = -1


@dataclass(frozen=True)
class Normalisation:
    """Levels to network input: (level/255 - mean)/sd, channel by channel, or all channels alike.

    What is no levels, but numbers with a unit, stays as it is. Images of one channel are repeated
    here, on the device, for a network that takes several.
    """

    mean: tuple[float, ...]
    sd: tuple[float, ...]
    channels: int | None = None  # that a network of images takes; None takes them as they are

    def __call__(self, levels: Tensor) -> Tensor:
        """uint8 [B, C, H, W] to float32 [B, C, H, W], or of `channels` equal ones where C is 1."""
        if levels.is_floating_point():
            return levels
        shape = (1, -1, 1, 1)
        mean = torch.tensor(self.mean, device=levels.device).view(shape)
        sd = torch.tensor(self.sd, device=levels.device).view(shape)
        inputs = (levels.float() / 255 - mean) / sd
        if self.channels is not None and inputs.shape[1] == 1:
            return inputs.expand(-1, self.channels, -1, -1)
        return inputs


def epoch_order(weights: Float, seed: int, epoch: int) -> Index:
    """Shuffled numbers of the images of one epoch: number i as often as weights[i] on average.

    Args:
        weights: [images]; 1 is once, 2.3 twice and, with probability 0.3, a third time.
        seed: seed of the training run.
        epoch: number of the epoch; each has an order of its own.

    Returns:
        [sum of the times] places in `weights`.
    """
    rng = stream(seed, TRAINING, epoch, name="order")
    if (weights == 1).all():
        return rng.permutation(weights.size)
    times = np.floor(weights + rng.random(weights.size)).astype(np.intp)
    return rng.permutation(np.repeat(np.arange(weights.size), times))


def epoch_batches(order: Index, size: int) -> list[Index]:
    """Batches of one epoch, `size` images each, in the order of the epoch.

    The images left at the end are a smaller batch; a single one joins the batch before, since batch
    norm needs two.
    """
    count = order.size
    starts = list(range(0, count, size))
    if len(starts) > 1 and count - starts[-1] < SMALLEST:
        starts.pop()
    return [order[start:stop] for start, stop in zip(starts, [*starts[1:], count], strict=True)]


class Targets(Protocol):
    """Targets to be learned, a number or an array for every row of a set."""

    def __getitem__(self, row: int, /) -> ArrayLike: ...


class _Rows(Dataset[tuple[Tensor, Tensor]]):
    """Rows read on demand, with their targets; these are 0 for all without."""

    def __init__(
        self, pixels: Pixels, targets: Targets | None, augmentation: Augmentation | None
    ) -> None:
        self.pixels, self.targets, self.augmentation = pixels, targets, augmentation

    def __getitem__(self, item: tuple[int, int]) -> tuple[Tensor, Tensor]:
        row, epoch = item
        values = self.pixels.read(row)
        if self.augmentation is not None and epoch >= 0:
            values = self.augmentation(values[..., 0], row, epoch)[..., None]
        target = torch.as_tensor(0 if self.targets is None else self.targets[row])
        return torch.from_numpy(np.ascontiguousarray(values.transpose(2, 0, 1))), target


class Reader:
    """Reads batches of an image set, in worker processes if there are any.

    Each worker opens the file itself and lives as long as the reader.
    """

    def __init__(
        self,
        pixels: Pixels,
        targets: Targets | None,
        augmentation: Augmentation | None = None,
        workers: int = 0,
        pin: bool = False,
    ) -> None:
        """Prepare to read; workers start with the first batch.

        Args:
            pixels: images or sequences by row.
            targets: targets of every row; None gives 0 for all.
            augmentation: changes of training images; None leaves all as they are stored.
            workers: number of processes that read; 0 reads in this one.
            pin: keep batches in memory from which CUDA copies without waiting.
        """
        self._batches: list[list[tuple[int, int]]] = []
        self._loader = DataLoader(
            _Rows(pixels, targets, augmentation),
            batch_sampler=self._batches,
            num_workers=workers,
            persistent_workers=workers > 0,
            pin_memory=pin,
            # Its own: starting workers must not draw from the stream of the layers.
            generator=torch.Generator().manual_seed(0),
        )

    def __call__(
        self, batches: Sequence[Index], epoch: int = AS_STORED
    ) -> Iterator[tuple[Tensor, Tensor]]:
        """Yield (inputs [B, C, H, W], targets [B, ...]) for every batch of row numbers.

        Args:
            batches: row numbers of each batch.
            epoch: number of the epoch as which images are augmented; AS_STORED leaves them.

        Raises:
            FolderError: an image cannot be read.
        """
        self._batches[:] = [[(int(row), epoch) for row in batch] for batch in batches]
        try:
            yield from self._loader
        except FolderError as error:  # a worker's comes wrapped in its traceback
            raise FolderError(str(error).strip().rpartition("FolderError: ")[2]) from None


def batches_in_order(rows: Index, size: int) -> list[Index]:
    """Batches of `size` rows in their order; the last may be smaller."""
    return [rows[start : start + size] for start in range(0, rows.size, size)]
