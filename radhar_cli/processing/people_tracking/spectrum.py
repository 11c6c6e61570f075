"""Range bins of a frame: range FFT, BPM decoding, and moving echoes apart from static ones."""

from typing import NamedTuple

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float, Index


class FrameBins(NamedTuple):
    """Range bins of a frame, of TI's sign: a phase that grows with time is an echo that recedes.

    Attributes:
        moving: Bins [bin, virtual, loop] less their mean over the loops.
        mean: That mean [bin, virtual].
    """

    moving: Complex
    mean: Complex


def range_bins(frame: Complex, window: Float, turned: Complex) -> FrameBins:
    """Compute the range bins of a frame: as many as the next power of two of its samples.

    Args:
        frame: Samples [loop, virtual, sample], of radhar's sign, one transmitter a channel.
        window: Window over the samples of a chirp [sample].
        turned: Phases [virtual] that the bins are multiplied by.

    Loops that are equal leave exactly 0, which the rounding of an FFT would spoil.
    """
    first = frame[:1]
    change = frame - first
    mean_change = change.mean(axis=0, keepdims=True)
    change -= mean_change
    # The conjugate of samples has TI's sign, and that of their inverse FFT is its FFT.
    spectra = _range_fft(change, window).conj() * turned.astype(change.dtype)[:, None]
    mean = _range_fft(first + mean_change, window)[0].T.conj() * turned
    moving = np.ascontiguousarray(spectra.transpose(2, 1, 0), complex)
    return FrameBins(moving, mean)


def _range_fft(samples: Complex, window: Float) -> Complex:
    """FFT [.., bin] over samples [.., sample] of radhar's sign."""
    import scipy.fft  # slow to import

    weights = (window / window.sum()).astype(samples.real.dtype)
    count = 1 << (samples.shape[-1] - 1).bit_length()
    return scipy.fft.ifft(samples * weights, count, axis=-1, norm="forward")


def decode_bpm(frame: Complex, sums: Index, differences: Index) -> Complex:
    """Decode chirps in which two transmitters send together: half the sum and the difference.

    Nothing compensates for the time between the two chirps, as in the firmware.

    Args:
        frame: Samples [loop, virtual, sample] as sent.
        sums: Channels of the chirp in which both have the same sign; none where they take turns.
        differences: Channels of the chirp in which the second is turned by 180 degrees.

    Returns:
        Samples [loop, virtual, sample]: the first transmitter's in place of the sums, the second's
        in place of the differences.
    """
    if not sums.size:
        return frame
    decoded, equal, opposite = frame.copy(), frame[:, sums], frame[:, differences]
    decoded[:, sums] = (equal + opposite) / 2
    decoded[:, differences] = (equal - opposite) / 2
    return decoded
