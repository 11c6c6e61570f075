"""Point clouds as the data allow them: detection on powers, interpolated peaks, several angles.

P = mean over the channels of |X|^2 in a range-Doppler cell. With noise alone P over the mean of R
reference cells has the distribution F(2 V, 2 V R) of V channels, from which the threshold follows
(neighbouring cells of a Hann window are correlated, so the rate of false alarms is approximate).

Targets of a cell are found one after the other in what is left of the row's spectrum, and placed in
turns with the others taken out: RELAX, J. Li and P. Stoica, Efficient mixed-spectrum estimation
with applications to target feature extraction, IEEE Trans. Signal Processing 44 (1996). Peaks that
are no target are sidelobes of several, and make no point.
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
ROUNDS = 8  # in which the targets of a cell are placed in turns
LEAST_SNR = 9.0  # of a further target, beam over noise: of 1 in 1000 cells noise has as much
APART = 0.8  # least distance of the targets of a cell, widths of a beam
NEAR = 0.6  # largest distance of a target from its beam, widths of a beam


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
    # Means of what moves are a lobe about Doppler 0, in whose middle nothing else is left.
    empty = slice(0, 1 if remove_mean and board.loops > 1 else 0)
    for _, x in spectra(cube, board, remove_mean):
        for frame in x:  # [Doppler, virtual, range]
            frames.append(_frame_points(frame, board, angles, empty, pfa, step, bias))
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
    width: float  # of a beam, turns

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
        width = 1 / (float(places.max()) + 1)
        return cls(row, upper, aside, above, beams, fine, beside, width)

    @property
    def most_targets(self) -> int:
        """Most targets of a cell that the elements tell apart."""
        half = max(len(self.row) // 2, 1)
        return min(half, len(self.upper)) if self.upper else half


def _sines(count: int) -> Float:
    """Sines of `count` angles, in the order of FFTs: 0 first, to the left positive."""
    sines: Float = 2 * np.fft.fftfreq(count)
    return sines


def _frame_points(
    x: Complex,
    board: Board,
    angles: Angles,
    empty: slice,
    pfa: float,
    step: float,
    bias: float,
) -> Float:
    """Points [n, 8] of a spectrum [Doppler, virtual, range]: peaks over range, Doppler, azimuth.

    Doppler bins that are `empty` have none.
    """
    # Both are slow to import.
    from scipy.ndimage import maximum_filter
    from scipy.special import fdtri

    square = x.real.astype(float) ** 2 + x.imag.astype(float) ** 2
    power = square.mean(axis=1).T  # [range, Doppler]
    noise, cells = _noise(power)
    factor = 1 / fdtri(2 * board.channels * cells, 2 * board.channels, pfa)  # F that pfa exceeds
    hit = (power > factor * noise) & (power > 0)
    hit[:, empty] = False
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
    floor = _floor(power)
    targets = dict[tuple[int, int], CellTargets]()
    rows = []
    for k, d, b in np.argwhere((beams == largest) & strong & hit[first:stop, :, None]).tolist():
        level = np.log(np.maximum(beams[:, d, b], TINY))
        r = max((first + k + _offset(level, k, False)) * board.range_step - bias, 0.0)
        signed = (d + board.n_doppler // 2) % board.n_doppler - board.n_doppler // 2
        fine = signed + _offset(np.log(np.maximum(beams[k, :, b], TINY)), d, True)
        if (k, d) not in targets:
            turn = np.exp(-2j * np.pi * (fine - signed) / board.n_doppler * board.turns)
            least = LEAST_SNR * noise[first + k, d] / len(row)
            targets[k, d] = CellTargets.of(turned[k, d] * turn, board, angles, least)
        direction = targets[k, d].take(b / BEAMS)
        if direction is not None:
            left, up = direction
            ahead = np.sqrt(r * r * (1 - left * left - up * up))
            snr = 10 * np.log10(power[first + k, d] / (floor or noise[first + k, d]))
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


@dataclass
class CellTargets:
    """Targets of a range-Doppler cell, each of which becomes a point once.

    Attributes:
        turns: Phase steps between the elements of the row [J], turns.
        left: Direction sines to the left [J].
        up: Direction sines upwards [J].
        near: Largest distance of a target from the beam in which it is seen, turns.
    """

    turns: Float
    left: Float
    up: Float
    near: float

    @classmethod
    def of(cls, element: Complex, board: Board, angles: Angles, least: float) -> "CellTargets":
        """Find the targets of a cell.

        The azimuth follows from the phase step along the longest row, the elevation from the phase
        between two rows.

        Args:
            element: Samples [virtual] of the cell.
            board: The board.
            angles: Rows and weights.
            least: Least power of a further target.
        """
        row, upper = angles.row, angles.upper
        if len(row) == 1:
            turns: Float = np.zeros(1)
        else:
            turns = find_phase_steps(element[row], board, angles, least)
        left, up = 2 * (turns - np.round(turns)), np.zeros(turns.size)
        if upper:
            ratio = _targets(element, board, upper, left) / _targets(element, board, row, left)
            turned = np.angle(ratio) / np.pi - angles.aside * left
            up = ((turned + 1) % 2 - 1) / angles.above
        near = NEAR * angles.width if len(row) > 1 else 1.0
        return cls(turns, left, up, near)

    def take(self, beam: float) -> tuple[float, float] | None:
        """Direction sines (left, up) of the target in a beam (turns), which is gone then.

        None where there is none, or none that is in a real direction.
        """
        apart = self.turns - beam
        apart = np.abs(apart - np.round(apart))
        if not apart.size or apart.min() > self.near:
            return None
        nearest = int(apart.argmin())
        left, up = float(self.left[nearest]), float(self.up[nearest])
        self.turns = np.delete(self.turns, nearest)
        self.left, self.up = np.delete(self.left, nearest), np.delete(self.up, nearest)
        return (left, up) if left * left + up * up <= 1 else None


def find_phase_steps(signal: Complex, board: Board, angles: Angles, least: float) -> Float:
    """Phase steps [J] (turns) between the elements of the row of the targets in a signal.

    Args:
        signal: Samples [element] of the row.
        board: The board.
        angles: Rows and weights.
        least: Least power of a further target.
    """
    places = board.places[angles.row, 0] - board.places[angles.row[0], 0]
    turns: Float = np.empty(0)
    remainder, strongest = signal, 0.0
    while turns.size < angles.most_targets:
        turn, power = _largest(remainder, angles)
        if turns.size:
            apart = turns - turn
            is_close = np.abs(apart - np.round(apart)).min() < APART * angles.width
            if is_close or power < max(angles.beside * strongest, least):
                break
        turns = np.append(turns, turn)
        for j in [*range(turns.size)] * (ROUNDS if turns.size > 1 else 0):
            parts = _parts(signal, places, turns)
            turns[j], _ = _largest(signal - parts.sum(axis=1) + parts[:, j], angles)
        parts = _parts(signal, places, turns)
        remainder, strongest = signal - parts.sum(axis=1), float((np.abs(parts) ** 2).max())
    return turns


def _parts(signal: Complex, places: Float, turns: Float) -> Complex:
    """Parts [element, J] of a signal that targets of some phase steps make, by least squares."""
    steering = np.exp(2j * np.pi * np.outer(places, turns))
    parts: Complex = steering * np.linalg.lstsq(steering, signal)[0]
    return parts


def _largest(signal: Complex, angles: Angles) -> tuple[float, float]:
    """Phase step (turns) and power of the largest peak of the spectrum of a row [element]."""
    spectrum = np.abs(signal @ angles.fine) ** 2 / len(signal) ** 2
    peak = int(spectrum.argmax())
    offset = _offset(np.log(np.maximum(spectrum, TINY)), peak, True)
    return (peak + offset) / ANGLES, float(spectrum[peak])


def _floor(power: Float) -> float:
    """Mean noise power of a frame [range, Doppler]: people fill less than half of its cells.

    Beside a strong echo its own sidelobes are above the noise, which limits no SNR so.
    """
    return float(np.median(power))


def _targets(element: Complex, board: Board, row: list[int], left: Float) -> Complex:
    """Echoes [J] of targets of direction sines [J] at the first element of a row."""
    places = board.places[row, 0] - board.places[row[0], 0]
    steering = np.exp(1j * np.pi * np.outer(places, left))
    return np.linalg.lstsq(steering, element[row])[0].astype(complex)
