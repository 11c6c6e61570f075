"""Point clouds as the firmware of TI's xWR14xx demo makes them, by its source.

Spectra here have TI's sign, the conjugate of radhar's; clouds have radhar's axes: x ahead, y left,
z up of the radar, Doppler positive approaching.
"""

from typing import NamedTuple

import numpy as np

from radhar_cli.numerics.arrays import Bool, Complex, Float, Index
from radhar_cli.processing.frame_maps import (
    doppler_spectrum,
    range_spectrum,
    without_mean,
)
from radhar_cli.radar.board import Board, longest_rows
from radhar_cli.radar.detection import Cfar, Detection

COLUMNS = ("x", "y", "z", "doppler", "intensity", "snr_db", "range_index", "doppler_index")
COLUMN_UNITS = ("m", "m", "m", "m/s", "1", "dB", "bin", "bin")
BINS = 64  # bins of the angle FFT
NOISE_LSB = 1.5  # rms of a Doppler cell's noise in units of the fixed-point numbers
XYZ_STEP = 2.0**-10  # m
NOISE_FRAMES = 8  # frames from which the noise is estimated


class Cloud(NamedTuple):
    """Points of all frames, one frame after the other."""

    points: Float  # float32 [N, 8], columns as COLUMNS
    start: Index  # int64 [frames + 1]; points start[f] .. start[f + 1] - 1 are frame f's.

    @classmethod
    def of(cls, frames: list[Float]) -> "Cloud":
        """Cloud of the points of each frame [n, 8]."""
        start = np.cumsum([0, *map(len, frames)])
        points = np.concatenate([np.empty((0, len(COLUMNS))), *frames])
        return cls(points.astype(np.float32), start.astype(np.int64))


def board_points(
    cube: Complex, board: Board, detection: Detection, quantise: bool, carrier: float | None = None
) -> Cloud:
    """Points of every frame of a cube.

    Args:
        cube: Samples [frame, loop, virtual, sample].
        board: The board that took them.
        detection: Detection settings of its .cfg.
        quantise: Whether to round as fixed-point numbers do, whose unit follows from the noise.
        carrier: Frequency of the Doppler axis, Hz; None for the centre frequency.
    """
    fast, slow = np.blackman(board.samples), np.hanning(board.loops)
    fast, slow = fast / fast.sum(), slow / slow.sum()
    lsb = noise_rms(cube, board, fast, slow) / NOISE_LSB if quantise else 0.0
    step = board.doppler_step_mps(carrier)
    frames = list[Float]()
    # Bins in TI's order: the conjugate of a signal has the opposite frequency.
    negated = -np.arange(board.n_doppler) % board.n_doppler
    for frame in range(len(cube)):
        samples = cube[frame : frame + 1]
        samples = without_mean(samples) if detection.remove_mean else samples
        x = range_spectrum(samples, board, fast)
        spectrum = doppler_spectrum(x, board, slow)[0].conj()
        frames.append(_frame_points(spectrum[negated], board, detection, lsb, step))
    return Cloud.of(frames)


def noise_rms(cube: Complex, board: Board, fast: Float, slow: Float) -> float:
    """Rms of the noise of a range-Doppler cell: people fill less than half of the cells.

    Args:
        cube: Samples [frame, loop, virtual, sample].
        board: The board that took them.
        fast: Window over the samples of a chirp, of sum 1.
        slow: Window over the loops, of sum 1.
    """
    frames = np.unique(np.linspace(0, len(cube) - 1, min(len(cube), NOISE_FRAMES)).astype(int))
    x = doppler_spectrum(range_spectrum(cube[frames], board, fast), board, slow)
    moving = x[:, 2:-1] if board.n_doppler > 4 else x  # what stands still fills three bins
    return float(np.sqrt(np.median(moving.real**2 + moving.imag**2) / np.log(2)))


def _frame_points(x: Complex, board: Board, detection: Detection, lsb: float, step: float) -> Float:
    """Points [n, 8] of a spectrum [Doppler, virtual, range] of TI's sign."""
    with np.errstate(divide="ignore"):
        d = np.mean(20 * np.log10(np.abs(x)), axis=1)  # [Doppler, range]
    snr = _above(d, detection.along_range, axis=1)
    hit = snr > detection.along_range.threshold_db
    if detection.along_doppler is not None:
        over = _above(d, detection.along_doppler, axis=0)
        hit &= over > detection.along_doppler.threshold_db
    hit &= _peaks(d, detection.grouping, detection.demo.groups_diagonally)
    hit[:, : detection.first_bin] = False
    if detection.last_bin is not None:
        hit[:, detection.last_bin + 1 :] = False
    doppler, ranges = (bins[: detection.demo.max_points] for bins in np.nonzero(hit))
    symbols = x[doppler, :, ranges]  # [n, virtual]
    if lsb > 0:
        symbols = np.round(symbols.real / lsb) + 1j * np.round(symbols.imag / lsb)
    if detection.coefficients:
        measured = np.array(detection.coefficients)
        if abs(measured @ board.signs) > abs(measured.sum()):
            measured *= board.signs  # which `range_spectrum` has taken out
        symbols = symbols * measured
    signed = np.where(doppler < board.n_doppler / 2, doppler, doppler - board.n_doppler)
    turn = signed[:, None] / board.n_doppler * board.turns
    symbols = symbols * np.exp(-2j * np.pi * turn)
    if lsb > 0:
        symbols = np.trunc(symbols.real) + 1j * np.trunc(symbols.imag)
    n, intensity, right, up = _angles(symbols, board, detection, lsb > 0)
    r = np.maximum(ranges[n] * board.range_step_m - detection.bias, 0)
    aside, z = r * right, r * up
    places = np.stack([np.sqrt(np.maximum(r * r - aside * aside - z * z, 0)), -aside, z])
    if lsb > 0:
        places = np.round(places / XYZ_STEP) * XYZ_STEP
    snr_db = snr[doppler[n], ranges[n]] * detection.demo.snr_scale
    if lsb > 0 and detection.demo.snr_step_db > 0:
        snr_db = np.round(snr_db / detection.demo.snr_step_db) * detection.demo.snr_step_db
    about = -signed[n] * step, intensity, snr_db, ranges[n], -signed[n]
    points = np.stack([*places, *about], axis=1)
    return points[_in_view(points, detection)]


def _above(d: Float, cfar: Cfar, axis: int) -> Float:
    """Excess (dB) of cells d [Doppler, range] (dB) over the noise of neighbours along an axis.

    It is -inf without neighbours; a side that lacks cells is left out.
    """
    d = np.moveaxis(d, axis, -1)
    reach, count = cfar.guard + cfar.window, d.shape[-1]
    wrapped = np.concatenate([d[..., count - reach :], d, d[..., :reach]], axis=-1)
    windows = np.lib.stride_tricks.sliding_window_view(wrapped, cfar.window, axis=-1)
    means = windows.mean(axis=-1)
    left, right = means[..., :count].copy(), means[..., -count:].copy()
    if not cfar.cyclic:
        left[..., :reach] = np.nan
        right[..., max(count - reach, 0) :] = np.nan
    sides = np.stack([left, right])
    sides = np.where(np.isnan(sides), sides[::-1], sides)
    noise = (sides.mean(axis=0), sides.max(axis=0), sides.min(axis=0))[cfar.mode]
    with np.errstate(invalid="ignore"):
        above = np.where(np.isfinite(d), d - noise, -np.inf)
    above[np.isnan(above)] = -np.inf
    return np.moveaxis(above, -1, axis)


def _peaks(d: Float, grouping: tuple[bool, bool], diagonally: bool) -> Bool:
    """Whether cells [Doppler, range] are not below their neighbours; Doppler closes on itself.

    Args:
        d: Decibels [Doppler, range].
        grouping: Whether neighbours along range, and along Doppler, are compared.
        diagonally: Whether, with both, those across both axes are compared too.
    """
    is_peak = np.ones(d.shape, bool)
    wide = np.pad(d, ((0, 0), (1, 1)), constant_values=-np.inf)
    wide = np.concatenate([wide[-1:], wide, wide[:1]])
    rows = (-1, 0, 1) if grouping[1] else (0,)
    columns = (-1, 0, 1) if grouping[0] else (0,)
    for i in rows:
        for j in columns if diagonally or i == 0 else (0,):
            is_peak &= d >= wide[1 + i : 1 + i + len(d), 1 + j : 1 + j + d.shape[1]]
    return is_peak


def _angles(
    symbols: Complex, board: Board, detection: Detection, integer: bool
) -> tuple[Index, Float, Float, Float]:
    """Directions of the first peak over angle of each symbol, and of second peaks.

    Args:
        symbols: Samples [n, virtual] of the detected cells.
        detection: Detection settings: least height of a second peak, most points.
        integer: Whether heights are whole numbers.

    Returns:
        Number of the symbol, intensity, and direction sines to the right and up [points].
    """
    import scipy.fft  # slow to import

    row, upper, aside, above = elevation_pair(board)
    spectra = scipy.fft.fft(symbols[:, row], BINS)
    heights = np.abs(spectra) / len(row)
    heights = np.floor(heights) if integer else heights
    n = np.arange(len(symbols))
    bins = heights.argmax(axis=1)
    second = detection.second_peak
    if second is not None:
        other_heights = np.where(_flanks(heights, bins), -1, heights)
        least, second_bins = second * heights[n, bins], other_heights.argmax(axis=1)
        with_second = np.flatnonzero(
            other_heights[n, second_bins] > (np.floor(least) if integer else least)
        )
        with_second = with_second[: detection.demo.max_points - n.size]
        n, bins = np.concatenate([n, with_second]), np.concatenate([bins, second_bins[with_second]])
    right = 2 * np.where(bins < BINS // 2, bins, bins - BINS) / BINS
    up = np.zeros(n.size)
    if upper:
        turn = np.angle(spectra[n, bins] * scipy.fft.fft(symbols[:, upper], BINS)[n, bins].conj())
        up = ((turn / np.pi + aside * right + 1) % 2 - 1) / above
    return n, heights[n, bins], right, up


def elevation_pair(board: Board) -> tuple[list[int], list[int], float, float]:
    """Rows of elements from which elevation follows.

    Returns:
        Elements of the longest row; those of the row nearest to it, none without another row; and
        how far to the left and up the latter begins, half wavelengths.
    """
    row = longest_rows(board.places, 0)[0]
    places = board.places
    left, up = places[row[0]]
    others = sorted({round(float(other), 6) for other in places[:, 1]} - {round(float(up), 6)})
    if not others:
        return row, [], 0.0, 1.0
    near = min(others, key=lambda other: (abs(other - up), -other))
    upper = [v for v in range(len(places)) if abs(places[v, 1] - near) < 1e-6]
    upper.sort(key=lambda v: float(places[v, 0]))
    return row, upper, float(places[upper[0], 0] - left), float(near - up)


def _flanks(m: Float, peak: Index) -> Bool:
    """Whether bins [n, angle] belong to the peak [n] or to its flanks; angles close."""
    is_flank: Bool = np.arange(m.shape[1]) == peak[:, None]
    for direction in (-1, 1):
        bins = (peak[:, None] + direction * np.arange(m.shape[1])) % m.shape[1]
        heights = np.take_along_axis(m, bins, axis=1)
        falls = np.logical_and.accumulate(heights[:, 1:] <= heights[:, :-1], axis=1)
        n, after = np.nonzero(falls)
        is_flank[n, bins[n, after + 1]] = True
    return is_flank


def _in_view(points: Float, detection: Detection) -> Bool:
    """Whether points [n, 8] lie in the fields of view [n]."""
    x, y, z, doppler = points[:, :4].T
    angles = np.degrees(np.arctan2(-y, x)), np.degrees(np.arctan2(z, np.hypot(x, y)))
    inside = np.ones(len(points), bool)
    for value, limits in (
        (angles[0], detection.azimuth_deg),
        (angles[1], detection.elevation_deg),
        (np.sqrt(x * x + y * y + z * z), detection.range_m),
        (-doppler, detection.doppler_mps),
    ):
        if limits is not None:
            inside &= (value >= limits[0]) & (value <= limits[1])
    return inside
