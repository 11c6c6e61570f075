"""Point clouds as the data allow them: detection on powers, interpolated peaks, several angles.

P = mean over the channels of |X|^2 in a range-Doppler cell. With noise alone P over the mean of R
reference cells has the distribution F(2 V, 2 V R) of V channels, from which the threshold follows
(neighbouring cells of a Hann window are correlated, so the rate of false alarms is approximate).
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.frame_maps import spectra, without_turns
from radhar_cli.processing.points import COLUMNS, Cloud, elevation_pair
from radhar_cli.radar.board import Board, sidelobe

GUARD, TRAINING = (3, 2), (8, 4)  # cells on each side: range, Doppler
BEAMS, ANGLES = 32, 256  # lengths of the azimuth FFTs that find targets and that place them
BESIDE = 0.1  # least power of a further target of a cell over its strongest
BEYOND = 1.5  # least power of a further target over the sidelobes of the row
TINY = np.finfo(float).tiny
INTERVALS = np.array([-1, 0, 1])


def best_points(
    cube: Complex,
    board: Board,
    remove_mean: bool,
    pfa: float,
    carrier: float | None = None,
    bias: float = 0.0,
) -> Cloud:
    """Points of every frame of a cube; intensity is a cell's power for unit transmit power.

    Args:
        cube: Samples [frame, loop, virtual, sample].
        board: The board that took them.
        remove_mean: Whether the mean over the loops of a frame is taken out.
        pfa: Rate of false alarms of a cell.
        carrier: Frequency of the Doppler axis, Hz; None for the centre frequency.
        bias: Bias of ranges, which is subtracted, m.
    """
    step = board.doppler_step(carrier)
    angles = Angles.of(board)
    frames = list[Float]()
    for _, x in spectra(cube, board, remove_mean):
        for frame in x:  # [Doppler, virtual, range]
            frames.append(_frame_points(frame, board, angles, pfa, step, bias))
    return Cloud.of(frames)


@dataclass(frozen=True)
class Angles:
    """Rows and weights by which a board measures directions.

    With a longest row of one element azimuth is 0, without another row elevation.
    """

    row: list[int]  # elements of the longest row
    upper: list[int]  # elements of the nearest other row, none without one
    aside: float  # offset of the other row to the left, half wavelengths
    above: float  # offset of the other row upwards, half wavelengths
    beams: Complex  # weights [element, beam] that targets are found with
    fine: Complex  # weights [element, angle] that they are placed with
    beside: float  # power of a further target of a cell over its strongest, beyond sidelobes

    @classmethod
    def of(cls, board: Board) -> "Angles":
        """Rows and weights that follow from the elements of a board."""
        row, upper, aside, above = elevation_pair(board)
        places = board.places[row, 0] - board.places[row[0], 0]
        single = len(row) == 1
        # A single element has one beam, which sees everything ahead.
        beams, fine = (
            np.exp(-1j * np.pi * np.outer(places, _sines(1 if single else count)))
            for count in (BEAMS, ANGLES)
        )
        beside = max(BESIDE, BEYOND * sidelobe(places))
        return cls(row, upper, aside, above, beams, fine, beside)


def _sines(count: int) -> Float:
    """Sines of `count` angles, in the order of FFTs: 0 first, to the left positive."""
    sines: Float = 2 * np.fft.fftfreq(count)
    return sines


def _frame_points(
    x: Complex, board: Board, angles: Angles, pfa: float, step: float, bias: float
) -> Float:
    """Points [n, 8] of a spectrum [Doppler, virtual, range]: peaks over range, Doppler, azimuth."""
    # Both are slow to import.
    from scipy.ndimage import maximum_filter
    from scipy.special import fdtri

    square = x.real.astype(float) ** 2 + x.imag.astype(float) ** 2
    power = square.mean(axis=1).T  # [range, Doppler]
    noise, cells = _noise(power)
    factor = 1 / fdtri(2 * board.channels * cells, 2 * board.channels, pfa)  # F that pfa exceeds
    hit = (power > factor * noise) & (power > 0)
    ranges = np.flatnonzero(hit.any(axis=1))
    if not ranges.size:
        return np.empty((0, len(COLUMNS)))
    first, stop = max(ranges[0] - 1, 0), min(ranges[-1] + 2, len(power))
    turned = without_turns(x, board).transpose(2, 0, 1)[first:stop]  # [range, Doppler, virtual]
    row = angles.row
    beams = np.abs(turned[..., row] @ angles.beams.astype(turned.dtype) / len(row)) ** 2
    reach = board.places[row[-1], 0] - board.places[row[0], 0] + 1  # of the row
    around = (3, 3, 2 * int(BEAMS / reach) // 2 + 1)
    largest = maximum_filter(beams, around, mode=("nearest", "wrap", "wrap"))
    strong = beams > angles.beside * beams.max(axis=2, keepdims=True)
    rows = []
    for k, d, b in np.argwhere((beams == largest) & strong & hit[first:stop, :, None]):
        level = np.log(np.maximum(beams[:, d, b], TINY))
        r = max((first + k + _offset(level, k, False)) * board.range_step - bias, 0.0)
        signed = (d + board.n_doppler // 2) % board.n_doppler - board.n_doppler // 2
        fine = signed + _offset(np.log(np.maximum(beams[k, :, b], TINY)), d, True)
        element = turned[k, d] * np.exp(
            -2j * np.pi * (fine - signed) / board.n_doppler * board.turns
        )
        left, up = _direction(element, board, angles, 2 * np.pi * b / BEAMS)
        if left * left + up * up <= 1:
            ahead = np.sqrt(r * r * (1 - left * left - up * up))
            snr = 10 * np.log10(power[first + k, d] / noise[first + k, d])
            about = fine * step, beams[k, d, b], snr, first + k, signed
            rows.append((ahead, r * left, r * up, *about))
    return np.array(rows, float).reshape(-1, len(COLUMNS))


def _noise(power: Float) -> tuple[Float, int]:
    """Mean [range, Doppler] of the reference cells around each cell, and their number."""
    from scipy.ndimage import uniform_filter  # slow to import

    inner = [min(2 * g + 1, n) for g, n in zip(GUARD, power.shape, strict=True)]
    outer = [min(2 * (g + t) + 1, n) for g, t, n in zip(GUARD, TRAINING, power.shape, strict=True)]
    area = outer[0] * outer[1], inner[0] * inner[1]
    around = partial(uniform_filter, power, mode=("reflect", "wrap"))
    total = around(outer) * area[0]
    noise = (total - around(inner) * area[1]) / max(area[0] - area[1], 1)
    return np.maximum(noise, TINY), max(area[0] - area[1], 1)


def _offset(level: Float, bin_: int, cyclic: bool) -> float:
    """Offset (bins, -1/2 to 1/2) of a peak by a parabola through three logarithms of power."""
    if level.size < 3 or (not cyclic and not 0 < bin_ < level.size - 1):
        return 0.0
    before, peak, after = level[(bin_ + INTERVALS) % level.size]
    curve = before - 2 * peak + after
    return float(np.clip((before - after) / (2 * curve), -0.5, 0.5)) if curve < 0 else 0.0


def _direction(element: Complex, board: Board, angles: Angles, near: float) -> tuple[float, float]:
    """Direction sines (left, up) of the target near a phase step (rad) between elements.

    The first is the peak of the row's spectrum there; with the other peaks of the spectrum taken
    out by least squares, the second follows from the phase between two rows.
    """
    row, upper = angles.row, angles.upper
    if len(row) == 1:
        left, chosen = np.zeros(1), 0
    else:
        spectrum = np.abs(element[row] @ angles.fine) ** 2
        peaks = (spectrum >= np.roll(spectrum, 1)) & (spectrum > np.roll(spectrum, -1))
        peaks &= spectrum > angles.beside * spectrum.max()
        level = np.log(np.maximum(spectrum, TINY))
        bins = sorted(np.flatnonzero(peaks), key=lambda n: -spectrum[n])[: max(len(upper), 1)]
        turns = np.array([(b + _offset(level, int(b), True)) / ANGLES for b in bins])
        apart = turns - near / (2 * np.pi)
        chosen = int(np.abs(apart - np.round(apart)).argmin())
        left = 2 * (turns - np.round(turns))
    up = 0.0
    if upper:
        ratio = _targets(element, board, upper, left) / _targets(element, board, row, left)
        turned = np.angle(ratio[chosen]) / np.pi - angles.aside * left[chosen]
        up = ((turned + 1) % 2 - 1) / angles.above
    return float(left[chosen]), float(up)


def _targets(element: Complex, board: Board, row: list[int], left: Float) -> Complex:
    """Echoes [J] of targets of direction sines [J] at the first element of a row."""
    places = board.places[row, 0] - board.places[row[0], 0]
    steering = np.exp(1j * np.pi * np.outer(places, left))
    return np.linalg.lstsq(steering, element[row])[0].astype(complex)
