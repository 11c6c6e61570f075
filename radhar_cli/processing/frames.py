"""The window and the frames that STFT and FSST share."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from radhar_cli.arrays import Complex, Float
from radhar_cli.rounding import exact

# Coefficients of a block of frames: 8 MiB in complex64. The paper's 90 frames of 2000 are a sixth.
BLOCK_COEFFICIENTS = 2**20


@dataclass(frozen=True)
class Frames:
    """Frames of L samples every `hop`, no padding: frame l covers x[l hop : l hop + L]."""

    length: int
    hop: int

    @classmethod
    def of(cls, length: int, overlap_fraction: float) -> "Frames":
        """Frames of L samples, hop = round((1 - overlap_fraction) L), at least 1."""
        return _frames(length, overlap_fraction)

    def count(self, samples: int) -> int:
        """Number of whole frames in a signal."""
        return (samples - self.length) // self.hop + 1

    def starts(self, samples: int) -> Float:
        """First sample of every frame."""
        return np.arange(self.count(samples)) * float(self.hop)

    def blocks(self, samples: int, bins: int) -> list[slice]:
        """Consecutive slices of frames that bound the memory: BLOCK_COEFFICIENTS, or one frame.

        Args:
            samples: of the signal.
            bins: coefficients of a frame.
        """
        count, most = self.count(samples), max(1, BLOCK_COEFFICIENTS // bins)
        return [slice(first, min(first + most, count)) for first in range(0, count, most)]

    def span(self, block: slice) -> slice:
        """Samples that a slice of frames covers."""
        return slice(block.start * self.hop, (block.stop - 1) * self.hop + self.length)

    @cached_property
    def window(self) -> Float:
        """g[n] = (1 - cos(2 pi (n + 1/2)/L))/2."""
        return 0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(self.length) + 0.5) / self.length)

    @cached_property
    def window_slope(self) -> Float:
        """g'[n] per sample."""
        n = np.arange(self.length) + 0.5
        return np.pi / self.length * np.sin(2 * np.pi * n / self.length)

    def cut(self, x: Complex) -> Complex:
        """Frames [count, L] of a signal [M], a view."""
        return np.lib.stride_tricks.sliding_window_view(x, self.length)[:: self.hop]


@lru_cache(maxsize=4)  # with their windows, for all recordings of a data set
def _frames(length: int, overlap_fraction: float) -> Frames:
    hop = int((1 - exact(overlap_fraction)) * length + exact(0.5))
    return Frames(length, max(hop, 1))
