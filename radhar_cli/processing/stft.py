"""Short-time Fourier transform (paper, last but one equation of "DTMs Generation")."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from radhar_cli.errors import RadharError
from radhar_cli.numerics.arrays import Bool, Complex, Float, Index
from radhar_cli.processing.fourier import fill_in_spectra
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.gate import Gate
from radhar_cli.processing.power_map import Axis
from radhar_cli.processing.signal import Signal

# Coefficients of a block of frames: 8 MiB in complex64. The paper's 90 frames of 2000 are a sixth.
BLOCK_COEFFICIENTS = 2**20


@dataclass(frozen=True, eq=False)
class Stft:
    """Transform X[l, k] = sum_n x[l hop + n] g[n] exp(-j 2 pi k (n - L//2)/N), and its axes.

    Frames come in blocks that bound the memory. Coefficients are those of 2^-exponent x, whose
    largest part is 1/2 to 1, so that no power of them overflows or vanishes, in float32 either.
    """

    signal: Signal  # without its gaps, in which no frame lies
    frames: Frames  # window length L and hop
    bins: int | None = None  # N, at least L; None is L
    single: bool = False  # whether coefficients are complex64; complex128 otherwise
    gate: Gate | None = None  # which rows of the signal a frame shows; None is all
    magnitudes: bool = False  # whether magnitudes are summed over the rows instead of powers

    @property
    def size(self) -> int:
        """Number N of frequencies."""
        return self.bins or self.frames.length

    @cached_property
    def starts(self) -> Index:
        """Number of the first sample of every frame [frames]."""
        return self.frames.starts(self.signal.times.slices)

    @cached_property
    def frequency(self) -> Axis:
        """Axis of Doppler frequencies of the rows of a map, Hz, rising."""
        return Axis(
            "frequency", "Hz", np.fft.fftshift(np.fft.fftfreq(self.size, 1 / self.signal.prf))
        )

    @cached_property
    def time(self) -> Axis:
        """Axis of the middles of the frames, s."""
        length, prf = self.frames.length, self.signal.prf
        middles = self.signal.times.times(self.starts) + (length - 1) / 2 / prf
        return Axis("time", "s", middles, length / prf)

    @cached_property
    def exponent(self) -> int:
        """Binary exponent of the largest real or imaginary part of the signal, which is finite."""
        parts = np.ascontiguousarray(self.signal.x).view(self.signal.x.real.dtype)
        largest = float(max(abs(parts.min()), abs(parts.max())))
        if not np.isfinite(largest):
            raise RadharError(f"the signal should be finite; its largest part is {largest}")
        # 2^-exponent must be a double itself; denormal signals keep their digits at 2^1022.
        return max(int(np.frexp(largest)[1]), -1022)

    @cached_property
    def blocks(self) -> list[slice]:
        """Frames of every block: of BLOCK_COEFFICIENTS coefficients, or one frame."""
        count, length = self.starts.size, max(1, BLOCK_COEFFICIENTS // self.size)
        return [slice(first, min(first + length, count)) for first in range(0, count, length)]

    def transform(
        self, row: Complex, frames: slice, window: Float, magnitudes: bool = False
    ) -> Any:
        """Transform X [frames, N], or |X|, of a row of the signal.

        Args:
            row: Samples [M].
            frames: Consecutive frames.
            window: Window g, or its slope [L].
            magnitudes: Whether |X| is made.
        """
        segments = self.segments(row, frames)
        dtype: Any = segments.real.dtype if magnitudes else segments.dtype
        spectra = np.empty((len(segments), self.size), dtype)
        fill_in_spectra(spectra, segments, window)
        return spectra

    def segments(self, row: Complex, frames: slice) -> Complex:
        """Segments 2^-exponent x[l hop : l hop + L] of some frames [frames, L], not to be changed.

        Args:
            row: Samples [M].
            frames: Consecutive frames.
        """
        starts, length = self.starts[frames], self.frames.length
        dtype: Any = np.complex64 if self.single else np.complex128
        x = (row[starts[0] : starts[-1] + length] * 2.0**-self.exponent).astype(dtype)
        segments = np.lib.stride_tricks.sliding_window_view(x, length)
        gapless = starts[-1] - starts[0] == (starts.size - 1) * self.frames.hop
        return segments[:: self.frames.hop] if gapless else segments[starts - starts[0]]

    def power_blocks(self) -> Iterator[Float]:
        """Yield sum |X|^2 over channels and rows, or (sum |X|)^2, of blocks [frames, N].

        Frequencies rise. Each frame adds up the rows that the gate shows.
        """
        for block in self.blocks:
            is_shown = self._shown(block)
            total: Float | None = None
            for channel in self.signal.x:
                for x, is_in_gate in zip(channel, is_shown, strict=True):
                    shown_frames = np.flatnonzero(is_in_gate)
                    if not shown_frames.size:
                        continue
                    first, last = int(shown_frames[0]), int(shown_frames[-1]) + 1
                    frames = slice(block.start + first, block.start + last)
                    magnitude = self.transform(x, frames, self.frames.window, magnitudes=True)
                    if not self.magnitudes:
                        magnitude *= magnitude
                    if total is None and shown_frames.size == is_in_gate.size:
                        total = magnitude
                        continue
                    if total is None:
                        total = np.zeros((is_in_gate.size, self.size), magnitude.dtype)
                    if shown_frames.size == len(magnitude):  # the usual case: frames without a gap
                        total[first:last] += magnitude
                    else:
                        total[shown_frames] += magnitude[shown_frames - first]
            assert total is not None, "a gate shows at least one row of every frame"
            if self.magnitudes:
                total *= total
            yield np.fft.fftshift(total, axes=1)

    def _shown(self, block: slice) -> Bool:
        """Whether a row is shown by a frame [rows, frames]."""
        rows = np.arange(self.signal.x.shape[1])[:, None]
        if self.gate is None:
            return np.ones((rows.size, block.stop - block.start), bool)
        first = np.broadcast_to(self.gate.first - self.signal.first, self.starts.size)[block]
        is_shown: Bool = (first <= rows) & (rows < first + self.gate.count)
        return is_shown
