"""Power maps that come in blocks of frames: joined, or reduced to what a data set needs."""

from collections.abc import Iterable

import numpy as np

from radhar_cli.arrays import Float, Levels
from radhar_cli.processing.entropy import EntropySum
from radhar_cli.processing.image import ColumnSum


def joined(blocks: Iterable[Float], frames: int) -> Float:
    """The whole map [frequency, frames] of blocks [frequency, some frames]."""
    whole: Float | None = None
    first = 0
    for block in blocks:
        if block.shape[1] == frames:
            return block
        if whole is None:
            whole = np.empty((frames, block.shape[0]))
        whole[first : first + block.shape[1]] = block.T
        first += block.shape[1]
    assert whole is not None
    return whole.T


class LongMap:
    """A power map too long to hold, gone through once: its entropy and its resized power remain.

    Args:
        blocks: [frequency, some frames], in the order of time.
        frames: of all blocks together.
        size: (height, width) of the image, pixels.
    """

    def __init__(self, blocks: Iterable[Float], frames: int, size: tuple[int, int]) -> None:
        self._entropy, self._image = EntropySum(), ColumnSum(size, frames)
        for block in blocks:
            self._entropy.add(block)
            self._image.add(block)

    @property
    def entropy_bits(self) -> float:
        """Entropy as of `entropy.entropy_bits`, to 1e-12."""
        return self._entropy.bits

    def levels(self, dynamic_range_db: float) -> Levels:
        """Image as of `image.levels`, a few pixels off by one level."""
        return self._image.levels(dynamic_range_db)
