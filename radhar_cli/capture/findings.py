"""Estimates from the samples: coding, sign of the beat, clipping, lost packets."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.errors import CaptureError
from radhar_cli.numerics.arrays import Bool, Float
from radhar_cli.readers.captures.source import Parts, Source

PROBES, PROBED = 16, 64  # places that are examined, and pulses of each
SURE = 0.65  # share of the energy in one half of the spectrum that decides
FEWEST_SAMPLES, FEW_SAMPLES = 16, 0.3  # of a pulse; share in which range bins have their power
EDGE = 3  # bins at zero that lie in both halves
LOST_RUN = 32  # consecutive zero samples
MIN_ZEROS = 4  # zero samples of a pulse beside a lost one
RARE = 3  # samples at full scale that are ignored
LOST, CLIPPED = 1, 2  # flags of a pulse
LARGEST = 1e15  # sample whose squares and sums remain finite


def probe(source: Source) -> list[Parts]:
    """Read pulses from places all over a capture, each [receiver, sample, pulse, part]."""
    length = min(PROBED, source.pulses)
    starts = np.unique(np.linspace(0, source.pulses - length, PROBES).astype(int))
    return [checked(source.read(at, at + length), at, source.name)[0] for at in map(int, starts)]


class Coding(NamedTuple):
    """Encoding of signed samples as whole numbers."""

    words: bool  # whether they are words of 16 bits, read as signed or unsigned
    offset: int = 0  # of offset binary; 0 of two's complement


PLAIN = Coding(False)


HALVES, SHARE_OF_HALF = (2**9, 2**11, 2**13), 0.25  # of ADCs of 10 to 14 bits


def coding_of(pieces: list[Parts], coding: str | None = None, bits: int = 16) -> Coding:
    """Find the coding in which the samples are smallest, or check the one that is named.

    Words in another coding jump between the ends of the scale. Other unsigned numbers lie around
    half their scale.

    Args:
        pieces: numbers as stored, each [receiver, sample, pulse, part].
        coding: `signed` or `offset`; None finds the coding.
        bits: resolution of the converter.

    Raises:
        ValueError: the numbers cannot have the coding that is named.
    """
    dtype = pieces[0].dtype
    values = np.concatenate([piece.ravel() for piece in pieces]).astype(float)
    low, high, unsigned = float(values.min()), float(values.max()), dtype.kind == "u"
    fits = low >= -(2**15) and high < (2**15 if low < 0 else 2**16)
    words = fits and (dtype.kind in "iu" or bool((values == np.floor(values)).all()))
    if coding and not words and dtype.kind != {"signed": "i", "offset": "u"}[coding]:
        raise ValueError(f"numbers from {low:g} to {high:g}; should be whole numbers of 16 bits")
    native = dtype in (np.int16, np.uint16)
    nonzero = values[values != 0]  # lost packets are zeros whatever the coding
    if unsigned and coding != "signed" and nonzero.size and not (words and high >= 2**15):
        middle = float(np.median(nonzero))
        halves = (2 ** (b - 1) for b in (8, 10, 12, 14, 16, 24, 32) if b <= 8 * dtype.itemsize)
        return Coding(False, min(halves, key=lambda half: abs(np.log2(middle / half))))
    if coding == "offset":
        return Coding(bits == 16, 1 << (bits - 1))
    if not coding and words and nonzero.size:
        signed, offset = (
            float(np.abs(decoded(nonzero, Coding(True, n))).mean()) for n in (0, 2**15)
        )
        if (not signed < 0.5 * offset) if unsigned else offset < 0.5 * signed:
            return Coding(True, 2**15)
        half = next((h for h in HALVES if low >= 0 and high < 2 * h), None)
        if half and abs(float(np.median(nonzero)) - half) < SHARE_OF_HALF * half:
            return Coding(False, half)  # words of an ADC that were stored as other numbers
    return Coding(words and (native or high >= 2**15))


def decoded(values: Parts, coding: Coding, bits: int = 16) -> Parts:
    """Decode stored numbers to signed ones, in the same shape.

    Bits above the resolution of the converter are replaced by its sign.
    """
    dtype, (words, offset) = values.dtype, coding
    if words and dtype in (np.int16, np.uint16):
        signed = (values.view(np.uint16) ^ np.uint16(offset)).view(np.int16)
    elif dtype.kind == "f":
        return np.mod(values + (2**15 - offset), 2**16) - 2**15 if words else values - offset
    elif dtype == np.uint8 and not offset:
        return values.view(np.int8).astype(np.int16)
    else:
        wide = values.astype(np.int64)
        wide = (wide + 2**15 - offset) % 2**16 - 2**15 if words else wide - offset
        if not words and (offset > 2**15 or (not offset and dtype.itemsize > 1)):
            return wide.astype(float)
        signed = wide.astype(np.int16)
    if bits < 16 and not offset:
        half = 1 << (bits - 1)
        signed = (((signed.astype(np.int32) + half) & (2 * half - 1)) - half).astype(np.int16)
    return signed


def positive_share(pieces: list[Parts]) -> tuple[float, float]:
    """Share of the energy of complex chirps at positive beat frequencies, 0 to 1.

    The first number is that of the differences from pulse to pulse, the second of everything. The
    noise floor, the median over the bins, is subtracted. Hann's window keeps the direct echo in the
    lowest bins, which are left out.
    """
    moving = still = np.zeros(pieces[0].shape[1])
    for piece in pieces:
        x = piece[..., 0].astype(float) + 1j * piece[..., 1].astype(float)
        window = np.hanning(x.shape[1] + 2)[1:-1, None]
        spectrum = np.fft.fft(x * window, axis=1)
        still = still + (np.abs(spectrum) ** 2).sum(axis=(0, 2))
        moving = moving + (np.abs(np.diff(spectrum, axis=2)) ** 2).sum(axis=(0, 2))
    return _share(moving), _share(still)


def _share(power: NDArray[np.float64]) -> float:
    """Share of a spectrum [bin] above its floor that lies at positive frequencies."""
    count = power.size
    above = np.maximum(power - np.median(power), 0)
    lowest = max(2, count // 64)
    positive = above[lowest + 1 : (count + 1) // 2].sum()
    negative = above[count // 2 + 1 : count - lowest].sum()
    total = positive + negative
    return float(positive / total) if total > 0 else 0.5


@dataclass
class Damage:
    """Clipping and losses, counted piece by piece."""

    # lowest and highest number of the converter, reached by clipped samples only; None of floats
    full_scale: tuple[int, int] | None
    lost_run: int = LOST_RUN  # zero samples in a row of which a pulse is lost
    clipped: int = 0  # number of clipped samples
    # of the pulses, uint8 [pulse] of each piece
    flags: list[NDArray[np.uint8]] = field(default_factory=list)

    def add(self, raw: Parts, values: Parts, gone: Bool) -> None:
        """Count the damage of a piece.

        Args:
            raw: numbers as stored [receiver, sample, pulse, part].
            values: the same as signed numbers.
            gone: whether a pulse is known to be lost [pulse].
        """
        flags = np.zeros(values.shape[2], np.uint8)
        if self.full_scale is not None:
            low, high = self.full_scale
            clipped = (values <= low) | (values >= high)
            self.clipped += int(np.count_nonzero(clipped))
            flags[clipped.any(axis=(0, 1, 3))] |= CLIPPED
        flags[lost(raw, self.lost_run) | gone] |= LOST
        self.flags.append(flags)

    def findings(self) -> list[str]:
        """Describe the counts in words, a line each."""
        flags, words = np.concatenate(self.flags), []
        if lost := int(np.count_nonzero(flags & LOST)):
            words.append(
                f"{lost} of {flags.size} pulses ({100 * lost / flags.size:.3g} %) lack samples "
                "(zeros, or NaN); they are flagged"
            )
        if self.clipped > RARE:
            pulses = int(np.count_nonzero(flags & CLIPPED))
            words.append(
                f"{self.clipped} samples in {pulses} of {flags.size} pulses are at full scale: the "
                "receiver was saturated; they are flagged"
            )
        return words


def lost(values: Parts, longest: int = LOST_RUN) -> Bool:
    """Whether a pulse has so many consecutive zero samples, or only zeros [pulse].

    Single zeros of slow time are not taken for losses.
    """
    if values.shape[1] == 1:
        return np.zeros(values.shape[2], bool)
    zero = (values == 0).all(axis=3)
    run = min(longest, zero.shape[1])
    if not zero.any():
        return np.zeros(zero.shape[2], bool)
    summed = np.cumsum(zero, axis=1, dtype=np.int32)
    inside = summed[:, run - 1 :].copy()
    inside[:, 1:] -= summed[:, :-run]
    missing: Bool = (inside == run).any(axis=(0, 1))
    # The rest of a loss that extends into the pulse before or after.
    beside = np.convolve(missing, [1, 1, 1])[1:-1] > 0
    missing |= beside & (summed[:, -1].max(axis=0) >= MIN_ZEROS)
    return missing


def full_scale(dtype: np.dtype[Any], coding: Coding, bits: int) -> tuple[int, int] | None:
    """Lowest and highest number of the converter without its offset; None if unknown."""
    if not any(coding) and (dtype.kind == "f" or dtype.itemsize > 2):
        return None
    half = coding.offset or 1 << (min(bits, 8 * dtype.itemsize) - 1)
    return -half, half - 1


def checked(raw: Parts, first: int, where: str, coding: Coding = PLAIN) -> tuple[Parts, Bool]:
    """Check numbers, and replace NaN by 0.

    Args:
        raw: numbers as stored [receiver, sample, pulse, part].
        first: number of the first pulse, for messages.
        where: file, for messages.
        coding: coding in which they will be decoded.

    Returns:
        The numbers, and whether a pulse held NaN [pulse].

    Raises:
        CaptureError: a number is too large, or does not fit the coding.
    """
    raw = raw.astype(np.float32) if raw.dtype == np.float16 else raw
    low, high = (-(2**15), 2**16 - 1) if coding.words else (-LARGEST, LARGEST)
    if raw.dtype.itemsize <= 2 or (not coding.words and raw.min() >= low and raw.max() <= high):
        return raw, np.zeros(raw.shape[2], bool)
    nan = np.isnan(raw)
    fits = (raw >= low) & (raw <= high)
    if coding.words:
        fits &= raw == np.floor(raw)
    wrong = ~(fits | nan)
    if wrong.any():
        receiver, sample, pulse, part = np.argwhere(wrong)[0]
        raise CaptureError(
            f"{where}: receiver {receiver}, sample {sample}, pulse {first + pulse} is "
            f"{raw[receiver, sample, pulse, part]:g}; should be from {low:g} to {high:g}"
            + (", a whole number, as the coding says" if coding.words else "")
        )
    gone: Bool = np.asarray(nan.any(axis=(0, 1, 3)))
    return np.where(nan, raw.dtype.type(0), raw), gone


def lies_beyond_half_band(pieces: list[Parts], conjugated: bool) -> bool:
    """Whether something moves in the half of the band in which radhar's beat has no targets.

    Its strongest bin there is no image of one in the other half (6 dB) and no noise (13 dB).

    Args:
        pieces: numbers, each [receiver, sample, pulse, part] with two parts.
        conjugated: whether samples are conjugated on import.
    """
    power: Any = 0.0
    for piece in pieces:
        x = piece[..., 0].astype(float) + (-1j if conjugated else 1j) * piece[..., 1]
        x = np.nan_to_num(x - x.mean(axis=2, keepdims=True))
        window = np.hanning(x.shape[1] + 2)[1:-1, None]
        power = power + np.mean(np.abs(np.fft.fft(x * window, axis=1)) ** 2, axis=(0, 2))
    if np.size(power) < FEWEST_SAMPLES:
        return False
    beyond = float(power[EDGE : power.size // 2 - 1].max())
    return beyond > power.max() / 4 and beyond > 20 * float(np.median(power))


def look_like_range_bins(pieces: list[Parts]) -> bool:
    """Whether the power of samples lies in few of them, and less so that of their spectrum.

    A beat signal has much the same power in all samples of a chirp, and its spectrum has the
    targets; of range profiles it is the other way round. The measure is how many of N samples
    share a power p, (sum p)^2/(N sum p^2), of the mean over pulses.

    Args:
        pieces: numbers, each [receiver, sample, pulse, part].
    """
    signals = []
    for piece in pieces:
        values = np.nan_to_num(piece.astype(float))
        signals.append(values[..., 0] + (1j * values[..., 1] if values.shape[-1] == 2 else 0))
    x = np.concatenate(
        [signal.swapaxes(0, 1).reshape(signal.shape[1], -1) for signal in signals], 1
    )
    if x.shape[0] < FEWEST_SAMPLES:
        return False
    share = _share_of_samples(np.mean(np.abs(x) ** 2, axis=1))
    spectrum = _share_of_samples(np.mean(np.abs(np.fft.fft(x, axis=0)) ** 2, axis=1))
    return share < FEW_SAMPLES and share < spectrum


def _share_of_samples(power: Float) -> float:
    """Share of the samples [N] in which a power lies: 1 of a constant one, 1/N of a single one."""
    total = float(np.sum(power**2))
    return 1.0 if total <= 0 else float(np.sum(power)) ** 2 / (power.size * total)
