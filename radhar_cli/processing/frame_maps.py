"""Maps of a board's frames: range-Doppler, range-angle and Doppler-angle, frame by frame.

Spectra are divided by the sum of their window, so that a steady echo of amplitude a in the middle
of a bin reads a^2 in all of them.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from operator import attrgetter
from typing import Protocol

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.power_map import Axis
from radhar_cli.radar.board import Board

BLOCK_FRAMES = 16


@dataclass(frozen=True)
class FrameMaps:
    """Maps of every frame, as power for unit transmit power."""

    power: Float  # power [frame, rows, columns], lowest first
    rows: Axis
    columns: Axis
    times: Float  # middles of the frames [frame], s
    # outer edges of the rows of their images, in their unit; None for those of the rows
    limits: tuple[float, float] | None = None

    @cached_property
    def shown(self) -> "FrameMaps":
        """Maps of the rows that images show, with the edges of images."""
        if self.limits is None:
            return self
        rows = self.rows.cells_within(self.limits)
        axis = self.rows.only(rows)
        edges = axis.within_edges(self.limits)
        return FrameMaps(self.power[:, rows], axis, self.columns, self.times, edges)

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Outer edges of an image of a frame (columns from, columns to, rows from, rows to)."""
        return (*self.columns.edges, *(self.limits or self.rows.edges))


def range_spectrum(cube: Complex, board: Board, window: Float) -> Complex:
    """Range spectrum X [frame, loop, virtual, range] of a cube, signs of the feeds taken out.

    Beats have the sign exp(-j 2 pi K tau t), so the kernel is the conjugate one. Of real samples it
    is doubled, so that a steady echo reads as of complex ones.

    Args:
        cube: Samples [frame, loop, virtual, sample].
        board: The board that took them.
        window: Window over the samples of a chirp [sample].
    """
    import scipy.fft  # slow to import

    weighted = cube * (window / window.sum()).astype(cube.real.dtype)
    if (board.signs < 0).any():
        weighted *= board.signs[:, None].astype(cube.real.dtype)
    spectrum: Complex = scipy.fft.ifft(weighted, board.n_fft, axis=-1, norm="forward")
    bins: Complex = spectrum[..., : board.n_bins]
    return 2 * bins if board.is_real else bins


def without_mean(cube: Complex) -> Complex:
    """Subtract from a cube [frame, loop, ..] the mean over the loops of each frame.

    A frame whose loops are equal becomes exactly 0, which the rounding of an earlier FFT would
    spoil. A frame of one loop, of which a mean would leave nothing, stays as it is.
    """
    if cube.shape[1] == 1:
        return cube
    moving: Complex = cube - cube[:, :1]
    moving -= moving.mean(axis=1, keepdims=True)
    return moving


def doppler_spectrum(x: Complex, board: Board, window: Float) -> Complex:
    """Doppler spectrum [frame, Doppler, virtual, range]: 0 first, approaching positive.

    Two transmitters that send together are told apart.

    Args:
        x: Range spectrum [frame, loop, virtual, range].
        window: Window over the loops [loop].
    """
    import scipy.fft  # slow to import

    weights = (window / window.sum()).astype(x.real.dtype)[:, None, None]
    return separate_transmitters(scipy.fft.fft(x * weights, board.n_doppler, axis=1), board)


def separate_transmitters(x: Complex, board: Board) -> Complex:
    """Tell two transmitters that send together apart: half the sum and half the difference.

    The block of the difference is first turned back by the Doppler of the time between the blocks.

    Args:
        x: Spectrum of the chirps as sent [.., Doppler, virtual, range]; it is overwritten.
    """
    if board.bpm is None:
        return x
    apart = board.delays[board.bpm[1]] - board.delays[board.bpm[0]]
    turns = apart / board.loop_s
    turned = np.exp(-2j * np.pi * turns * np.fft.fftfreq(board.n_doppler))[:, None, None]
    total = x[..., board.sums, :]
    difference = x[..., board.differences, :] * turned.astype(x.dtype)
    a, b = board.signs_of_two
    x[..., board.sums, :] = (total + difference) * (a / 2)
    x[..., board.differences, :] = (total - difference) * (b / 2)
    return x


def without_turns(x: Complex, board: Board) -> Complex:
    """Compensate spectra [.., Doppler, virtual, range] for the transmitters' taking turns.

    A chirp that comes a share s of a loop later has turned by 2 pi d s/N_D in Doppler bin d.
    """
    d = np.fft.fftfreq(board.n_doppler)[:, None]
    turned = np.exp(-2j * np.pi * d * board.turns)[..., None]
    compensated: Complex = x * turned.astype(x.dtype)
    return compensated


def hann(count: int) -> Float:
    """Periodic Hann window [count]; 1 for a single sample."""
    return np.hanning(count + 1)[:-1] if count > 1 else np.ones(count)


def ascending(count: int) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Numbers of FFT bins from -count/2 + 1 to count/2, as a sort of 0 .. count - 1."""
    return np.arange(count // 2 - count + 1, count // 2 + 1) % count


@dataclass(frozen=True)
class FrameAxis:
    """Axis of a frame map, whose values follow from the board.

    Attributes:
        quantity: quantity that the axis shows.
        unit: unit of its values.
        values_of: values of every row or column of a board's map, even, lowest first.
        cell_of: width of a cell of a board's map, where it may have a single one; None elsewhere.
    """

    quantity: str
    unit: str
    values_of: Callable[[Board], Float]
    cell_of: Callable[[Board], float] | None = None

    def of(self, board: Board) -> Axis:
        """Axis of the maps of a board."""
        cell = 0.0 if self.cell_of is None else self.cell_of(board)
        return Axis(self.quantity, self.unit, self.values_of(board), cell)


def ranges_of_bins(board: Board) -> Float:
    """Ranges of all bins of a board [K], m."""
    ranges: Float = np.arange(board.n_bins) * board.range_step_m
    return ranges


def speeds_of_bins(board: Board) -> Float:
    """Radial speeds of the Doppler bins of a board [N], m/s, positive approaching."""
    highest = board.n_doppler // 2
    bins = np.arange(highest - board.n_doppler + 1, highest + 1)
    speeds: Float = bins * board.doppler_step_mps()
    return speeds


def angles_of_beams(board: Board) -> Float:
    """Angles of the beams of any board, degrees."""
    return np.arange(-90.0, 91.0)


RANGE = FrameAxis("range", "m", ranges_of_bins, attrgetter("range_step_m"))
SPEED = FrameAxis("radial speed", "m/s", speeds_of_bins, Board.doppler_step_mps)
# Positive left, positive up.
ANGLES = tuple(FrameAxis(name, "degree", angles_of_beams) for name in ("azimuth", "elevation"))


def spectra(cube: Complex, board: Board, remove_mean: bool) -> Iterator[tuple[slice, Complex]]:
    """Yield slices of frames and their spectra with Hann windows.

    Args:
        cube: Samples [frame, loop, virtual, sample].
        board: The board that took them.
        remove_mean: Whether the mean over the loops of a frame is taken out.

    Yields:
        Frames, and X [frame, Doppler, virtual, range].
    """
    fast, slow = hann(board.samples), hann(board.loops)
    for first in range(0, len(cube), BLOCK_FRAMES):
        frames = slice(first, min(first + BLOCK_FRAMES, len(cube)))
        samples = without_mean(cube[frames]) if remove_mean else cube[frames]
        yield frames, doppler_spectrum(range_spectrum(samples, board, fast), board, slow)


def range_doppler(cube: Complex, board: Board, remove_mean: bool) -> FrameMaps:
    """Range-Doppler maps [frame, range, Doppler], the mean power of the virtual channels."""
    power = np.empty((len(cube), board.n_bins, board.n_doppler), np.float32)
    order = ascending(board.n_doppler)
    for frames, x in spectra(cube, board, remove_mean):
        mean = (x.real**2 + x.imag**2).mean(axis=2)
        power[frames] = mean[:, order].transpose(0, 2, 1)
    return FrameMaps(power, RANGE.of(board), SPEED.of(board), board.middles)


def range_angle(cube: Complex, board: Board, remove_mean: bool, axis: int) -> FrameMaps:
    """Range-angle maps [frame, range, angle] of a Bartlett beamformer over the longest rows.

    Doppler bins are compensated for the transmitters' turns and summed: sum_d |w^H x_d|^2 =
    w^H R w with the covariance R = sum_d x_d x_d^H. The taper of n elements is
    sin^2(pi (i + 1)/(n + 1)); of several rows as long, powers are averaged. Axis 0 is azimuth,
    positive left, 1 elevation, positive up.
    """
    beams = beams_of_rows(board, axis)
    level = level_of_sum(hann(board.loops), board.n_doppler)
    power = np.zeros((len(cube), board.n_bins, angles_of_beams(board).size), np.float32)
    for frames, x in spectra(cube, board, remove_mean):
        x = without_turns(x, board)
        for row, pairs in beams:
            power[frames] += powers_of_beams(x[:, :, row].transpose(0, 3, 2, 1), pairs)
    np.maximum(power, 0, out=power)  # of rounding
    power /= level * len(beams)
    return FrameMaps(power, RANGE.of(board), ANGLES[axis].of(board), board.middles)


def doppler_angle(cube: Complex, board: Board, remove_mean: bool, axis: int) -> FrameMaps:
    """Doppler-angle maps [frame, Doppler, angle] of a Bartlett beamformer over the longest rows.

    Of every Doppler bin, compensated for the transmitters' turns, the powers of all range bins are
    summed and divided by what a steady echo in the middle of one leaves in all of them, so that it
    reads its power. Taper, rows and angles are those of `range_angle`.
    """
    beams = beams_of_rows(board, axis)
    level = level_of_sum(hann(board.samples), board.n_fft)
    power = np.zeros((len(cube), board.n_doppler, angles_of_beams(board).size), np.float32)
    order = ascending(board.n_doppler)
    for frames, x in spectra(cube, board, remove_mean):
        x = without_turns(x, board)[:, order]
        for row, pairs in beams:
            power[frames] += powers_of_beams(x[:, :, row], pairs)
    np.maximum(power, 0, out=power)  # of rounding
    power /= level * len(beams)
    return FrameMaps(power, SPEED.of(board), ANGLES[axis].of(board), board.middles)


def beams_of_rows(board: Board, axis: int) -> list[tuple[list[int], Complex]]:
    """Numbers of the n elements of each longest row, and weights of their covariances.

    The weights [angle, n n] are w_i w_k^* of the tapered steering vectors w, which make
    w^H R w of a covariance R.
    """
    rows, places = board.rows_along(axis)
    taper = np.sin(np.pi * np.arange(1, len(rows[0]) + 1) / (len(rows[0]) + 1)) ** 2
    sines = np.sin(np.radians(angles_of_beams(board)))[:, None]
    beams = []
    for row in rows:
        steering = np.exp(-1j * np.pi * sines * places[row]) * taper / taper.sum()
        pairs = steering[:, :, None] * steering[:, None].conj()
        beams.append((row, pairs.reshape(len(sines), -1)))
    return beams


def powers_of_beams(echo: Complex, pairs: Complex) -> Float:
    """Powers [frame, cell, angle] of a row's echo [frame, cell, element, term], summed over terms.

    Args:
        echo: Spectra of the elements; terms are the bins that are summed.
        pairs: Weights [angle, element element] of `beams_of_rows`.
    """
    element = np.ascontiguousarray(echo)
    covariance = np.matmul(element, element.conj().swapaxes(2, 3))
    flat = covariance.reshape(*covariance.shape[:2], -1)
    power: Float = (flat @ pairs.T.astype(flat.dtype)).real
    return power


def level_of_sum(window: Float, bins: int) -> float:
    """Power that a steady echo of power 1 leaves in all bins of a windowed transform together."""
    return bins * float((window**2).sum() / window.sum() ** 2)


class MakeFrameMaps(Protocol):
    """Function that makes the maps of a cube."""

    def __call__(self, cube: Complex, board: Board, remove_mean: bool) -> FrameMaps:
        """Make the maps of a cube.

        Args:
            cube: Samples [frame, loop, virtual, sample].
            board: The board that took them.
            remove_mean: Whether the mean over the loops of a frame is taken out.
        """


@dataclass(frozen=True)
class FrameMapKind:
    """Kind of a map of a board's frames: all that radhar knows of it, a line of FRAME_MAP_KINDS.

    Attributes:
        name: its name in `maps:` and in files.
        title: its name in figures.
        make: makes the maps of a cube.
        rows: axis of the rows.
        columns: axis of the columns.
        shows_doppler: whether it needs frames of several loops.
        array_axis: direction in which it needs the array to extend, 0 across, 1 upwards; None
            where any array will do.
    """

    name: str
    title: str
    make: MakeFrameMaps
    rows: FrameAxis
    columns: FrameAxis
    shows_doppler: bool = False
    array_axis: int | None = None


def _angle_kind(name: str, title: str, axis: int) -> FrameMapKind:
    """Kind of a range-angle map."""
    make = partial(range_angle, axis=axis)
    return FrameMapKind(name, title, make, RANGE, ANGLES[axis], array_axis=axis)


def _doppler_angle_kind(name: str, title: str, axis: int) -> FrameMapKind:
    """Kind of a Doppler-angle map."""
    make = partial(doppler_angle, axis=axis)
    return FrameMapKind(name, title, make, SPEED, ANGLES[axis], shows_doppler=True, array_axis=axis)


# {name: kind} of every map of a board's frames, in the order of data sets.
FRAME_MAP_KINDS = {
    kind.name: kind
    for kind in (
        FrameMapKind(
            "range_doppler", "range-Doppler", range_doppler, RANGE, SPEED, shows_doppler=True
        ),
        _angle_kind("range_azimuth", "range-azimuth", 0),
        _angle_kind("range_elevation", "range-elevation", 1),
        _doppler_angle_kind("doppler_azimuth", "Doppler-azimuth", 0),
        _doppler_angle_kind("doppler_elevation", "Doppler-elevation", 1),
    )
}
