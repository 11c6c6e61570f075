"""Point clouds as the data allow them: every scatterer that noise and sidelobes do not explain.

P = mean over the channels of |X|^2 in a range-Doppler cell. Of noise alone, V P over its mean has
the Gamma distribution of shape V, the number of channels, from which the threshold follows
(neighbouring cells of a Hann window are correlated, so the rate of false alarms is approximate).
The noise is a median over cells, most of which no person fills: neighbours of a cell would not do,
as a walker fills them, too. No cell counts that sidelobes of another one may have made.

Cells are taken in the order of their power. The echo of each, as the windows spread it over its
neighbours, is taken out before the next is looked for, so what is left shows further scatterers
beside it: CLEAN, J. A. Högbom, Aperture synthesis with a non-regular distribution of interferometer
baselines, Astronomy and Astrophysics Supplement 15 (1974).

Targets of a cell are found one after the other in what is left of the row's spectrum, and placed in
turns with the others taken out: RELAX, J. Li and P. Stoica, Efficient mixed-spectrum estimation
with applications to target feature extraction, IEEE Trans. Signal Processing 44 (1996). Peaks that
are no target are sidelobes of several, and make no point.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.processing.frame_maps import hann, spectra
from radhar_cli.processing.points import COLUMNS, Cloud, elevation_pair
from radhar_cli.radar.board import Board, sidelobe

NEIGHBOURS = 32  # ranges on each side whose noise is that of a range
ROUNDING = (
    1e-10  # least noise over the largest cell: engines err by -80 dB, over all cells together
)
# Power of sidelobes of several scatterers over that of the strongest's: near by of two that are
# alike, and farther away, where those of all are in phase, of four.
INTERFERENCE = 4.0, 16.0
FINE = 16  # steps of a bin in which sidelobes are tabulated
LOBE = 4  # resolution cells on each side in which an echo is taken out
MEAN = 2e-5  # least power about Doppler 0 over the largest: means of what changes range are as much
FAINT = 0.02  # least power beside a peak over the peak's that is of the same echo: -14 dB and more
LEFT = 0.01  # least power of a cell after others are taken out, over that before
ANGLES = 256  # length of the azimuth FFT that places targets
BESIDE = 0.1  # least power of a further target of a cell over its strongest
BEYOND = 1.5  # least power of a further target over the sidelobes of the row
TINY = np.finfo(float).tiny
SHARED = 0.5  # least power of the strongest target of a cell over that in its neighbours
OFFSETS = np.linspace(-0.9, 0.6, 16)  # of echoes beside bin 0 from their bin, away from 0, bins
INTERVALS = np.array([-1, 0, 1])
ROUNDS = 8  # in which the targets of a cell are placed in turns
LEAST_SNR = 9.0  # of a further target, beam over noise: of 1 in 1000 cells noise has as much
APART = 0.8  # least distance of the targets of a cell, widths of a beam


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
    from scipy.special import gammainccinv  # slow to import

    finder = Finder(
        board=board,
        angles=Angles.of(board),
        fast=EchoSpread(hann(board.samples), board.n_fft, 1),
        slow=EchoSpread(
            hann(board.loops), board.n_doppler, -1, has_mean=not remove_mean or board.loops == 1
        ),
        threshold=float(gammainccinv(board.channels, pfa)) / board.channels,
        step=board.doppler_step_mps(carrier),
        bias=bias,
    )
    frames = list[Float]()
    # In double precision, as rounding of an FFT would decide which weak cells count.
    precise = np.result_type(cube.dtype, np.float64)
    for samples in cube:
        for _, x in spectra(samples[None].astype(precise), board, remove_mean):
            frames.append(finder.find_points(x[0]))
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
    fine: Complex  # weights [element, angle] that targets are placed with
    beside: float  # power of a further target of a cell over its strongest, beyond sidelobes
    width: float  # of a beam, turns

    @classmethod
    def of(cls, board: Board) -> "Angles":
        """Rows and weights that follow from the elements of a board."""
        row, upper, aside, above = elevation_pair(board)
        places = board.places[row, 0] - board.places[row[0], 0]
        # Sines of the angles in the order of FFTs: 0 first, to the left positive.
        fine = np.exp(-2j * np.pi * np.outer(places, np.fft.fftfreq(ANGLES)))
        beside = max(BESIDE, BEYOND * sidelobe(places))
        width = 1 / (float(places.max()) + 1)
        return cls(row, upper, aside, above, fine, beside, width)

    @property
    def most_targets(self) -> int:
        """Most targets of a cell that the elements tell apart."""
        half = max(len(self.row) // 2, 1)
        return min(half, len(self.upper)) if self.upper else half


@dataclass(frozen=True)
class EchoSpread:
    """Spread of a steady echo over the bins of a windowed Fourier transform.

    Attributes:
        window: The window over the samples.
        bins: Number of bins of the transform, of which bin 0 follows the last.
        sign: Sign of the transform's exponent.
        has_mean: Whether the mean over the samples is not taken out before.
    """

    window: Float
    bins: int
    sign: int
    has_mean: bool = True

    @property
    def width(self) -> int:
        """Bins of a resolution cell, half as many as from the main lobe's middle to its end."""
        return -(-self.bins // len(self.window))

    @property
    def reach(self) -> int:
        """Bins on each side over which an echo is taken out."""
        return min(LOBE * self.width, (self.bins - 1) // 2)

    def bins_of_echo(self, middle: int) -> Index:
        """Bins [K] over which an echo is taken out: those about its own, and about 0 its mean's."""
        apart = np.arange(-self.reach, self.reach + 1)
        bins = middle + apart if self.has_mean else np.append(middle + apart, apart)
        return np.unique(bins % self.bins)

    def lobe(self, place: float | Float, bins: Index) -> Complex:
        """Amplitudes [K, ...] in some bins [K] of echoes at places [...] on the axis of bins."""
        samples = np.arange(len(self.window))
        turn = 2j * np.pi * self.sign / self.bins
        echo = np.exp(-turn * np.multiply.outer(samples, place))
        if not self.has_mean:
            echo -= echo.mean(axis=0)
        amplitudes: Complex = (np.exp(turn * np.outer(bins, samples)) * self.window) @ echo
        return amplitudes

    def offset(self, x: Complex, middle: int) -> float:
        """Offset (bins) of an echo from its bin.

        Near bin 0 whose mean is taken out it is that of least squares, elsewhere a parabola's.

        Args:
            x: Spectrum [bin, channel] of as many bins on each side of that of the echo.
            middle: Number of the echo's bin, negative below bin 0.
        """
        apart = np.arange(len(x)) - len(x) // 2
        if self.has_mean or abs(middle) > len(x) // 2:
            return _offset(_mean_powers(x), len(x) // 2)
        lobes = self.lobe(middle + np.sign(middle) * OFFSETS, middle + apart)  # [bin, place]
        like = (np.abs(lobes.conj().T @ x) ** 2).sum(axis=1) / (np.abs(lobes) ** 2).sum(axis=0)
        n = int(like.argmax())
        step = float(OFFSETS[1] - OFFSETS[0])
        offset = OFFSETS[n] + step * _offset(like, n)
        return float(np.sign(middle) * offset)

    @cached_property
    def sidelobes(self) -> Float:
        """Largest power [lag] of sidelobes in a bin over that of the bin with the echo.

        Within the main lobe it is 0, but for the bin itself, of which it is 1.
        """
        power = np.abs(np.fft.fft(self.window, FINE * self.bins)[: FINE * self.bins // 2 + 1]) ** 2
        power = np.maximum.accumulate(power[::-1])[::-1]
        lags = np.arange(self.bins // 2 + 1)
        largest = power[np.maximum(FINE * lags - FINE // 2, 0)] / power[FINE // 2]
        largest *= np.where(lags <= LOBE * self.width, *INTERFERENCE)
        largest[: 2 * self.width + 1] = 0.0
        largest[0] = 1.0
        sidelobes: Float = largest[: int(np.flatnonzero(largest > ROUNDING)[-1]) + 1]
        return sidelobes

    def spread(self, power: Float, axis: int) -> Float:
        """Spread the power of cells over their sidelobes along an axis; the largest counts."""
        before = np.moveaxis(power, axis, 0)
        after = before.copy()
        for lag in np.flatnonzero(self.sidelobes)[1:].tolist():
            scaled = before * self.sidelobes[lag]
            for to, source in ((slice(lag, None), slice(-lag)), (slice(lag), slice(-lag, None))):
                np.maximum(after[to], scaled[source], out=after[to])
                np.maximum(after[source], scaled[to], out=after[source])
        spread: Float = np.moveaxis(after, 0, axis)
        return spread


@dataclass(frozen=True, kw_only=True)
class Finder:
    """Detector of the points of a board's frames.

    Attributes:
        board: The board.
        angles: Rows and weights of its array.
        fast: Spread of echoes over ranges.
        slow: Spread of echoes over Doppler bins.
        threshold: Least power of a cell over the mean of its noise.
        step: Width of a Doppler bin, m/s.
        bias: Bias of ranges, m.
    """

    board: Board
    angles: Angles
    fast: EchoSpread
    slow: EchoSpread
    threshold: float
    step: float
    bias: float

    def find_points(self, x: Complex) -> Float:
        """Points [n, 8] of a frame's spectrum [Doppler, virtual, range], strongest cell first."""
        from scipy.ndimage import maximum_filter  # slow to import

        square = x.real.astype(float) ** 2 + x.imag.astype(float) ** 2
        power = square.mean(axis=1).T  # [range, Doppler]
        noise = self._estimate_noise(power)
        least = np.repeat(self.threshold * noise[:, None], power.shape[1], axis=1)
        if not self.slow.has_mean:
            about_zero = np.arange(-self.slow.width, self.slow.width + 1)
            least[:, about_zero] = np.maximum(least[:, about_zero], MEAN * power.max())
        hit = (power > least) & (power >= self._spread_sidelobes(power))
        if self.board.is_real:
            hit[0] = False  # its own image, of either sign of speed
        if not self.slow.has_mean:
            # Means of what moves are a lobe about Doppler 0, in whose middle nothing else is left.
            hit[:, 0] = False
        rows = list[tuple[float, ...]]()
        if hit.any():
            # Where an echo ends, little of it is left however well it was taken out.
            size = 2 * self.fast.width + 1, 2 * self.slow.width + 1
            beside = maximum_filter(power, size, mode=("nearest", "wrap"))
            least = np.maximum(least, LEFT * beside)
            rest, left = x.transpose(2, 0, 1).copy(), np.where(hit, power, 0.0)
            while left.any():
                cell = divmod(int(left.argmax()), self.board.n_doppler)
                snr_db = 10 * np.log10(power[cell] / noise[cell[0]])
                rows += self._take_out(cell, rest, left, least, noise[cell[0]], float(snr_db))
        return np.array(rows, float).reshape(-1, len(COLUMNS))

    def _estimate_noise(self, power: Float) -> Float:
        """Mean noise power of each range [range] from the powers of a frame [range, Doppler].

        It is a median over all Doppler bins of the ranges about it, less than half of which people
        fill.
        """
        from scipy.ndimage import median_filter  # slow to import
        from scipy.special import gammaincinv

        median = median_filter(np.median(power, axis=1), 2 * NEIGHBOURS + 1, mode="nearest")
        mean = median * (self.board.channels / gammaincinv(self.board.channels, 0.5))
        noise: Float = np.maximum(mean, max(ROUNDING * float(power.max()), TINY))
        return noise

    def _spread_sidelobes(self, power: Float) -> Float:
        """Largest power that sidelobes of others may have in each cell, no less than its own.

        Of real samples every echo has an image at the opposite range and Doppler.
        """
        cells = power
        if self.board.is_real:
            image = np.roll(power[:0:-1, ::-1], 1, axis=1)
            gap = np.zeros((self.board.n_fft - len(power) - len(image), power.shape[1]))
            cells = np.concatenate([power, gap, image])
        return self.slow.spread(self.fast.spread(cells, 0), 1)[: len(power)]

    def _take_out(
        self,
        cell: tuple[int, int],
        rest: Complex,
        left: Float,
        least: Float,
        noise: float,
        snr_db: float,
    ) -> list[tuple[float, ...]]:
        """Take the echo of a cell out of a spectrum, and make points of it.

        Args:
            cell: Its range bin and Doppler bin.
            rest: Rest of the spectrum [range, Doppler, virtual], from which it is taken.
            left: Powers of the cells that are still to be looked at, 0 of others [range, Doppler].
            least: Least power of a cell with a point [range, Doppler].
            noise: Mean noise power of the cell.
            snr_db: SNR of the cell, dB.
        """
        (k, d), count = cell, self.board.n_doppler
        fast, slow = self.fast.reach, self.slow.reach
        ranges = np.arange(max(k - fast, 0), min(k + fast + 1, len(rest)))
        patch = rest[ranges[0] : ranges[-1] + 1, (d + np.arange(-slow, slow + 1)) % count]
        middle_row, doppler = k - int(ranges[0]), (d + count // 2) % count - count // 2
        off_range = _offset(_mean_powers(patch[:, slow]), middle_row)
        off_doppler = self.slow.offset(patch[middle_row], doppler)
        rows = self._points_of_cell(
            patch, (middle_row, slow), (k, doppler), off_doppler, noise, snr_db
        )
        bins = self.slow.bins_of_echo(d)
        over_ranges = self.fast.lobe(k + off_range, ranges)
        over_doppler = self.slow.lobe(doppler + off_doppler, bins)
        lobe = np.outer(over_ranges, over_doppler) / (
            over_ranges[middle_row] * over_doppler[bins == d]
        )
        around = np.ix_(ranges, bins)
        after = rest[around] - (lobe[..., None] * rest[cell]).astype(rest.dtype)
        rest[around] = after
        power = (after.real**2 + after.imag**2).mean(axis=2)
        left[around] = np.where((left[around] > 0) & (power > least[around]), power, 0.0)
        left[cell] = 0.0
        return rows

    def _points_of_cell(
        self,
        patch: Complex,
        middle: tuple[int, int],
        cell: tuple[int, int],
        off_doppler: float,
        noise: float,
        snr_db: float,
    ) -> list[tuple[float, ...]]:
        """Points of the targets of a cell whose echo is largest there, and not in a neighbour.

        Args:
            patch: Spectrum about the cell [range, Doppler, virtual].
            middle: Numbers of the cell in it.
            cell: Range bin, and Doppler bin with its sign.
            off_doppler: Offset of the echo's Doppler from that of the bin, bins.
            noise: Mean noise power of the cell.
            snr_db: SNR of the cell, dB.
        """
        (middle_row, column), (k, doppler), row = middle, cell, self.angles.row
        turn = np.exp(
            -2j * np.pi * (doppler + off_doppler) / self.board.n_doppler * self.board.turns
        )
        targets = CellTargets.of(
            patch[middle_row, column] * turn, self.board, self.angles, LEAST_SNR * noise / len(row)
        )
        first, before = max(middle_row - 1, 0), max(column - 1, 0)
        near, middle_row, column = (
            patch[first : middle_row + 2, before : column + 2, row],
            middle_row - first,
            column - before,
        )
        places = self.board.places[row, 0] - self.board.places[row[0], 0]
        turned = (doppler + np.arange(near.shape[1]) - column) / self.board.n_doppler
        turned = turned[:, None] * self.board.turns[row]
        weights = np.exp(-2j * np.pi * (places * targets.turns[:, None, None] + turned)) / len(row)
        beams = np.abs((near * weights[:, None]).sum(axis=-1)) ** 2  # [target, range, Doppler]
        strongest = beams[:, middle_row, column].argmax()
        rows = list[tuple[float, ...]]()
        for j, (power, aside, up) in enumerate(zip(beams, targets.left, targets.up, strict=True)):
            is_beside = power[middle_row, column] < (SHARED if j == strongest else 1) * power.max()
            if is_beside or aside * aside + up * up > 1:
                continue
            r = max(
                (k + _offset(power[:, column], middle_row)) * self.board.range_step_m - self.bias,
                0.0,
            )
            speed = (doppler + _offset(power[middle_row], column)) * self.step
            ahead = r * np.sqrt(1 - aside * aside - up * up)
            place = ahead, r * aside, r * up
            rows.append((*place, speed, power[middle_row, column], snr_db, k, doppler))
        return rows


def _mean_powers(x: Complex) -> Float:
    """Mean power [bin] of the channels of x [bin, virtual]."""
    powers: Float = (x.real**2 + x.imag**2).mean(axis=1)
    return powers


def _offset(power: Float, bin_: int, cyclic: bool = False) -> float:
    """Offset (bins, -1/2 to 1/2) of a peak by a parabola through three logarithms of power.

    Neighbours count as no less than FAINT of the peak: what is less is rounding, where their own
    echo was taken out.
    """
    if power.size < 3 or (not cyclic and not 0 < bin_ < power.size - 1):
        return 0.0
    three = power[(bin_ + INTERVALS) % power.size]
    before, peak, after = np.log(np.maximum(three, max(FAINT * float(three[1]), TINY)))
    curve = before - 2 * peak + after
    return float(np.clip((before - after) / (2 * curve), -0.5, 0.5)) if curve < 0 else 0.0


@dataclass(frozen=True)
class CellTargets:
    """Targets of a range-Doppler cell.

    Attributes:
        turns: Phase steps between the elements of the row [J], turns.
        left: Direction sines to the left [J].
        up: Direction sines upwards [J].
    """

    turns: Float
    left: Float
    up: Float

    @classmethod
    def of(cls, element: Complex, board: Board, angles: Angles, least: float) -> "CellTargets":
        """Find the targets of a cell.

        The azimuth follows from the phase step along the longest row, the elevation from the phase
        between two rows.

        Args:
            element: Samples [virtual] of the cell.
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
        return cls(turns, left, up)


def find_phase_steps(signal: Complex, board: Board, angles: Angles, least: float) -> Float:
    """Phase steps [J] (turns) between the elements of the row of the targets in a signal.

    Args:
        signal: Samples [element] of the row.
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
    offset = _offset(spectrum, peak, True)
    return (peak + offset) / ANGLES, float(spectrum[peak])


def _targets(element: Complex, board: Board, row: list[int], left: Float) -> Complex:
    """Echoes [J] of targets of direction sines [J] at the first element of a row."""
    places = board.places[row, 0] - board.places[row[0], 0]
    steering = np.exp(1j * np.pi * np.outer(places, left))
    return np.linalg.lstsq(steering, element[row])[0].astype(complex)
