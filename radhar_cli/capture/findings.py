"""Read off the samples themselves: offset binary, sign of the beat, clipping, lost packets."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.capture.source import Parts, Source

PROBES, PROBED = 16, 64  # places that are looked at, and pulses of each
SURE = 0.65  # share of the energy in one half of the spectrum
LOST_RUN = 32  # zero samples one after the other
MIN_ZEROS = 4  # zero samples of a pulse beside a lost one
RARE = 3  # samples at full scale that prove nothing
LOST, CLIPPED = 1, 2  # flags of a pulse


def probe(source: Source) -> list[Parts]:
    """Consecutive pulses from places all over a capture, each [receiver, sample, pulse, part]."""
    length = min(PROBED, source.pulses)
    starts = np.unique(np.linspace(0, source.pulses - length, PROBES).astype(int))
    return [source.read(int(first), int(first) + length) for first in starts]


def offset_of(pieces: list[Parts]) -> int:
    """What to subtract from whole numbers that are in offset binary; 0 of two's complement.

    Offset binary of 16 bits that is read as two's complement jumps between the ends of the scale;
    unsigned numbers lie around half their scale.
    """
    dtype = pieces[0].dtype
    if dtype.kind not in "iu":
        return 0
    values = np.concatenate([piece.ravel() for piece in pieces])
    if dtype.kind == "u":
        middle = float(np.median(values[values != 0])) if values.any() else 1.0
        bits = [b for b in (8, 10, 12, 14, 16, 24, 32) if b <= 8 * dtype.itemsize]
        return int(min((2 ** (b - 1) for b in bits), key=lambda half: abs(np.log2(middle / half))))
    if dtype.itemsize != 2:
        return 0
    shifted = (values.view(np.uint16) ^ 0x8000).view(np.int16)  # as offset binary
    seen = values != 0  # lost packets are zeros whatever the coding
    signed, offset = (
        (float(np.abs(v[seen].astype(float)).mean()) for v in (values, shifted))
        if (seen.any())
        else (0.0, 1.0)
    )
    return 2**15 if offset < 0.5 * signed else 0


def without_offset(values: Parts, offset: int, bits: int) -> Parts:
    """Signed numbers, the offset taken off, bits above the ADC's ones taken as the sign's."""
    dtype = values.dtype
    if dtype.kind not in "iu":
        return values
    if offset == 2**15 and dtype == np.int16:
        return (values.view(np.uint16) ^ 0x8000).view(np.int16)
    if offset:
        wide = values.astype(np.int64) - offset
        return wide.astype(np.int16) if offset <= 2**15 else wide.astype(float)
    if bits < 16 and dtype == np.int16:
        half = 1 << (bits - 1)
        return (((values.astype(np.int32) + half) & (2 * half - 1)) - half).astype(np.int16)
    if dtype.itemsize > 2 or dtype.kind == "u":
        return values.astype(float)
    return values.astype(np.int16, copy=False)


class PositiveShare(NamedTuple):
    """Which share of the energy lies at positive beat frequencies, 0 to 1.

    Attributes:
        moving: of what differs from pulse to pulse.
        still: of everything.
    """

    moving: float
    still: float

    @property
    def sign(self) -> str | None:
        """`positive`, `negative`, or None where neither share is clear."""
        for share in self:
            if abs(share - 0.5) >= SURE - 0.5:
                return "positive" if share > 0.5 else "negative"
        return None


def positive_share(pieces: list[Parts]) -> PositiveShare:
    """In which half of the spectrum of complex chirps the targets lie.

    The white noise of a bin, its median over the bins, is taken off. Hann's window keeps the direct
    echo in the lowest bins, which are left out.
    """
    moving = still = np.zeros(pieces[0].shape[1])
    for piece in pieces:
        x = piece[..., 0].astype(float) + 1j * piece[..., 1].astype(float)
        window = np.hanning(x.shape[1] + 2)[1:-1, None]
        spectrum = np.fft.fft(x * window, axis=1)
        still = still + (np.abs(spectrum) ** 2).sum(axis=(0, 2))
        if x.shape[2] > 1:
            moving = moving + (np.abs(np.diff(spectrum, axis=2)) ** 2).sum(axis=(0, 2))
    return PositiveShare(_share(moving), _share(still))


def _share(power: NDArray[np.float64]) -> float:
    """Share of the energy at positive frequencies, the lowest bins and the floor left out."""
    count = power.size
    above = np.maximum(power - np.median(power), 0)
    lowest = max(2, count // 64)
    positive = above[lowest + 1 : (count + 1) // 2].sum()
    negative = above[count // 2 + 1 : count - lowest].sum()
    total = positive + negative
    return float(positive / total) if total > 0 else 0.5


@dataclass
class Damage:
    """Clipping and losses, counted piece by piece.

    Attributes:
        full_scale: numbers that only a clipped sample reaches, lowest and highest; None of floats.
        clipped, samples: how many of how many.
    """

    full_scale: tuple[int, int] | None
    clipped: int = 0
    samples: int = 0
    flags: list[NDArray[np.uint8]] = field(default_factory=list)

    def add(self, raw: Parts, values: Parts) -> None:
        """Take in numbers [receiver, sample, pulse, part] as stored and as signed, in time."""
        flags = np.zeros(values.shape[2], np.uint8)
        if self.full_scale is not None:
            low, high = self.full_scale
            clipped = (values <= low) | (values >= high)
            self.clipped += int(np.count_nonzero(clipped))
            flags[clipped.any(axis=(0, 1, 3))] |= CLIPPED
        self.samples += values.size
        flags[lost(raw)] |= LOST
        self.flags.append(flags)


def lost(values: Parts) -> NDArray[np.bool_]:
    """Pulses [pulse] of which LOST_RUN samples in a row, or all of a shorter chirp, are zero.

    One zero of slow time proves nothing.
    """
    if values.shape[1] == 1:
        return np.zeros(values.shape[2], bool)
    zero = (values == 0).all(axis=3)
    run = min(LOST_RUN, zero.shape[1])
    if not zero.any():
        return np.zeros(zero.shape[2], bool)
    summed = np.cumsum(zero, axis=1, dtype=np.int32)
    inside = summed[:, run - 1 :].copy()
    inside[:, 1:] -= summed[:, :-run]
    missing: NDArray[np.bool_] = (inside == run).any(axis=(0, 1))
    # The rest of a gap that reaches into the pulse before or after.
    beside = np.convolve(missing, [1, 1, 1])[1:-1] > 0
    missing |= beside & (summed[:, -1].max(axis=0) >= MIN_ZEROS)
    return missing


def full_scale(dtype: np.dtype[Any], offset: int, bits: int) -> tuple[int, int] | None:
    """Lowest and highest number of a converter, the offset taken off."""
    if dtype.kind not in "iu":
        return None
    half = offset or 1 << (min(bits, 8 * dtype.itemsize) - 1)
    return -half, half - 1
