"""The window and the frames that STFT and FSST share."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.numerics.rounding import exact


@dataclass(frozen=True)
class Frames:
    """Frames of L samples every `hop`, no padding: frame l covers x[l hop : l hop + L]."""

    length: int
    hop: int

    @classmethod
    def of(cls, length: int, overlap_fraction: float) -> "Frames":
        """Frames of L samples with a hop of round((1 - overlap_fraction) L), at least 1."""
        return _frames(length, overlap_fraction)

    def within(self, pulses: int, are_apart: bool) -> "Frames":
        """Keep windows within the frames of a radar that sends such.

        Args:
            pulses: pulses of a frame, which a window has at most.
            are_apart: whether the radar pauses between frames, of which each then has one window.
        """
        length = min(self.length, pulses)
        return Frames(length, pulses if are_apart else min(self.hop, length))

    def starts(self, stretches: Sequence[slice]) -> Index:
        """Numbers of the first samples of the whole frames in stretches without a gap [frames]."""
        return np.concatenate(
            [np.arange(part.start, part.stop - self.length + 1, self.hop) for part in stretches]
        )

    @cached_property
    def window(self) -> Float:
        """Window g[n] = (1 - cos(2 pi (n + 1/2)/L))/2 [L]."""
        return 0.5 - 0.5 * np.cos(2 * np.pi * (np.arange(self.length) + 0.5) / self.length)

    @cached_property
    def window_slope(self) -> Float:
        """Slope g'[n] of the window [L], per sample."""
        n = np.arange(self.length) + 0.5
        return np.pi / self.length * np.sin(2 * np.pi * n / self.length)


@lru_cache(maxsize=4)  # with their windows, for all recordings of a data set
def _frames(length: int, overlap_fraction: float) -> Frames:
    """Frames of a length and overlap, in exact arithmetic of the fraction as it is written."""
    hop = int((1 - exact(overlap_fraction)) * length + exact(0.5))
    return Frames(length, max(hop, 1))
