"""Maps of a board's frames: range-Doppler, range-azimuth and range-elevation, frame by frame.

Spectra are divided by the sum of their window, so that a steady echo of amplitude a in the middle
of a bin reads a^2 in all of them.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from radhar_cli.arrays import Complex, Float
from radhar_cli.processing.power_map import Axis
from radhar_cli.radar.board import Board, longest_rows

BLOCK_FRAMES = 16


@dataclass(frozen=True)
class FrameMaps:
    """Power of every frame for unit transmit power."""

    power: Float  # [frame, rows, columns], lowest first
    # rows, columns: the axes
    rows: Axis
    columns: Axis
    times: Float  # middles of the frames, s


def range_spectrum(cube: Complex, board: Board, window: Float) -> Complex:
    """X [frame, loop, virtual, range] of a cube, signs of the feeds taken out.

    Beats have the sign exp(-j 2 pi K tau t), so the kernel is the conjugate one.
    """
    import scipy.fft  # slow to import

    weighted = cube * (window / window.sum()).astype(cube.real.dtype)
    if (board.signs < 0).any():
        weighted *= board.signs[:, None].astype(cube.real.dtype)
    return scipy.fft.ifft(weighted, board.n_fft, axis=-1, norm="forward")


def without_mean(cube: Complex) -> Complex:
    """A cube [frame, loop, ..] less the mean over the loops of each frame.

    Of a frame whose loops are equal exactly nothing is left, which rounding in an FFT before would
    spoil.
    """
    left: Complex = cube - cube[:, :1]
    left -= left.mean(axis=1, keepdims=True)
    return left


def doppler_spectrum(x: Complex, board: Board, window: Float) -> Complex:
    """X [frame, Doppler, virtual, range] of x [frame, loop, virtual, range], windowed over loops.

    Doppler is as FFTs have it: 0 first, approaching positive.
    """
    import scipy.fft  # slow to import

    weights = (window / window.sum()).astype(x.real.dtype)[:, None, None]
    return scipy.fft.fft(x * weights, board.n_doppler, axis=1)


def without_turns(x: Complex, board: Board) -> Complex:
    """X [.., Doppler, virtual, range] as if all transmitters had sent at once.

    A chirp that comes k/n_TX of a loop later has turned by 2 pi d k/(N_D n_TX) in Doppler bin d.
    """
    d = np.fft.fftfreq(board.n_doppler)[:, None]
    turned = np.exp(-2j * np.pi * d * board.turns)[..., None]
    compensated: Complex = x * turned.astype(x.dtype)
    return compensated


def hann(count: int) -> Float:
    """Periodic Hann window [count]; 1 of a single sample."""
    return np.hanning(count + 1)[:-1] if count > 1 else np.ones(count)


def ascending(count: int) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Numbers of FFT bins from -count/2 + 1 to count/2, as a sort of 0 .. count - 1."""
    return np.arange(count // 2 - count + 1, count // 2 + 1) % count


def doppler_axis(board: Board) -> Axis:
    """Radial speeds, positive approaching."""
    highest = board.n_doppler // 2
    bins = np.arange(highest - board.n_doppler + 1, highest + 1)
    return Axis("radial speed", "m/s", bins * board.doppler_step())


def range_axis(board: Board) -> Axis:
    """Ranges of all bins."""
    return Axis("range", "m", np.arange(board.n_fft) * board.range_step)


def spectra(cube: Complex, board: Board, remove_mean: bool) -> Iterator[tuple[slice, Complex]]:
    """(frames, X [frame, Doppler, virtual, range]) of some frames at a time, with Hann windows."""
    fast, slow = hann(board.samples), hann(board.loops)
    for first in range(0, len(cube), BLOCK_FRAMES):
        some = slice(first, min(first + BLOCK_FRAMES, len(cube)))
        samples = without_mean(cube[some]) if remove_mean else cube[some]
        yield some, doppler_spectrum(range_spectrum(samples, board, fast), board, slow)


def range_doppler(cube: Complex, board: Board, remove_mean: bool) -> FrameMaps:
    """Power [frame, range, Doppler], the mean over the virtual channels."""
    power = np.empty((len(cube), board.n_fft, board.n_doppler), np.float32)
    order = ascending(board.n_doppler)
    for some, x in spectra(cube, board, remove_mean):
        mean = (x.real**2 + x.imag**2).mean(axis=2)
        power[some] = mean[:, order].transpose(0, 2, 1)
    return FrameMaps(power, range_axis(board), doppler_axis(board), board.middles)


def range_angle(cube: Complex, board: Board, remove_mean: bool, axis: int) -> FrameMaps:
    """Power [frame, range, angle] of a Bartlett beamformer over the longest rows or columns.

    Doppler bins are compensated for the transmitters' turns and summed: sum_d |w^H x_d|^2 =
    w^H R w with the covariance R = sum_d x_d x_d^H. The taper of n elements is
    sin^2(pi (i + 1)/(n + 1)); of several rows as long, powers are averaged. Axis 0 is azimuth,
    positive left, 1 elevation, positive up.
    """
    angles = np.arange(-90.0, 91.0)
    rows = longest_rows(board.places, axis)
    taper = np.sin(np.pi * np.arange(1, len(rows[0]) + 1) / (len(rows[0]) + 1)) ** 2
    sines = np.sin(np.radians(angles))[:, None]
    window = hann(board.loops)
    level = board.n_doppler * float((window**2).sum() / window.sum() ** 2)
    power = np.zeros((len(cube), board.n_fft, angles.size), np.float32)
    for some, x in spectra(cube, board, remove_mean):
        x = without_turns(x, board)
        for row in rows:
            element = np.ascontiguousarray(x[:, :, row].transpose(0, 3, 2, 1))  # Doppler last
            covariance = np.matmul(element, element.conj().swapaxes(2, 3))
            steering = np.exp(-1j * np.pi * sines * board.places[row, axis]) * taper / taper.sum()
            pairs = (steering[:, :, None] * steering[:, None].conj()).reshape(len(angles), -1)
            flat = covariance.reshape(*covariance.shape[:2], -1)
            power[some] += (flat @ pairs.T.astype(flat.dtype)).real
    np.maximum(power, 0, out=power)  # of rounding
    power /= level * len(rows)
    name = "azimuth" if axis == 0 else "elevation"
    return FrameMaps(power, range_axis(board), Axis(name, "degree", angles), board.middles)
