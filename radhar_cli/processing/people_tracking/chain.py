"""Point clouds of a cube as the 3D people tracking firmware makes them.

The steps are those of TI's source; signs are chosen so that azimuth is positive to the right and
elevation upwards for a cube of radhar. Nothing compensates for the turns of the transmitters: a
scatterer that moves is seen beside its place, as by the board.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.fft

from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.processing.people_tracking.capon import covariance, spectrum, whitening
from radhar_cli.processing.people_tracking.detected_points import DetectedPoints
from radhar_cli.processing.people_tracking.fine_motion import (
    frames_together,
    is_fine_frame,
    join_frames,
)
from radhar_cli.processing.people_tracking.grid import row_of_map
from radhar_cli.processing.people_tracking.refinement import (
    Aperture,
    Directions,
    find_elevations,
    zoom_in,
)
from radhar_cli.processing.people_tracking.spectrum import FrameBins, decode_bpm, range_bins
from radhar_cli.processing.people_tracking.static import find_static
from radhar_cli.processing.people_tracking.two_pass_cfar import MAX_CELLS, Cells, detect_moving
from radhar_cli.processing.points import Cloud
from radhar_cli.radar.board import Board
from radhar_cli.radar.people_tracking import ElevationSearch, PeopleTracking, Zoom

MAX_POINTS = 750  # of a frame
UNEQUAL = 1e-4  # by how much a correction of a channel differs from 1 to be one


@dataclass(frozen=True)
class PeopleTracker:
    """The chain with all that follows from its settings.

    Attributes:
        settings: Detection of the .cfg.
        aperture: Elements and view.
        row: Elements of the map.
        vectors: Steering vectors of the map [angle, element].
        turned: Phases by which the channels are multiplied [virtual].
    """

    settings: PeopleTracking
    aperture: Aperture
    row: list[int]
    vectors: Complex
    turned: Complex

    @classmethod
    def of(cls, settings: PeopleTracking) -> "PeopleTracker":
        """Make the chain of a .cfg."""
        right, up = np.array(settings.right, float), np.array(settings.up, float)
        aperture = Aperture(right, up, settings.nu, settings.mu)
        nu, mu = settings.nu.values, settings.mu.values
        if isinstance(settings.refinement, ElevationSearch):
            row = row_of_map(up)
            vectors = aperture.steering(nu, 0.0)[:, row]
        else:
            row = [*range(right.size)]
            vectors = aperture.steering(nu, mu[:, None]).reshape(-1, len(row))
        turned = np.array(settings.rotation) * correction_phases(settings.coefficients, right.size)
        return cls(settings, aperture, row, vectors, turned)

    def map_of(self, moving: Complex) -> tuple[Complex, Float]:
        """Covariance of all elements and map of a frame.

        Args:
            moving: Range bins [bin, virtual, loop].

        Returns:
            Q [bin, virtual, virtual], and P [angle, bin], 0 in bins that are skipped.
        """
        first, last = self._bins(len(moving))
        matrix = covariance(moving)
        within = matrix[first:last][:, self.row][:, :, self.row]
        power = np.zeros((len(self.vectors), len(moving)))
        power[:, first:last] = spectrum(whitening(within, self.settings.gamma), self.vectors).T
        return matrix, power

    def find(self, bins: FrameBins, doppler_bins: int) -> DetectedPoints:
        """Find the points of a frame.

        Args:
            bins: Range bins.
            doppler_bins: Number of Doppler bins.
        """
        moving = bins.moving
        matrix, power = self.map_of(moving)
        cells = detect_moving(power, self.settings.dynamic).where(slice(MAX_CELLS))
        found_bins, cell_of_bin = np.unique(cells.bin, return_inverse=True)
        directions = self._refine(cells, cell_of_bin, matrix[found_bins], power[:, found_bins])
        bin_of_point = cells.bin[directions.cell]
        beams = (directions.weights.conj()[:, None] @ moving[bin_of_point])[:, 0]
        points = DetectedPoints(
            bin_of_point,
            directions.azimuth,
            directions.elevation,
            doppler_of(beams, doppler_bins),
            directions.snr,
            directions.power,
        )
        if self.settings.static is not None:
            static = find_static(bins.mean, self.aperture, self.settings.static)
            points = DetectedPoints.joined((points, static))
        return points.where(slice(MAX_POINTS))

    def _refine(self, cells: Cells, number: Index, matrix: Complex, power: Float) -> Directions:
        """Find directions of cells, of covariances and map of those bins that have one."""
        cells = cells._replace(bin=number)
        refinement = self.settings.refinement
        if isinstance(refinement, Zoom):
            whitener = whitening(matrix, self.settings.gamma)
            return zoom_in(cells, power, whitener, self.aperture, refinement)
        return find_elevations(cells, whitening(matrix, refinement.gamma), self.aperture)

    def _bins(self, count: int) -> tuple[int, int]:
        """First bin of the map, and the one behind its last."""
        near, far = self.settings.dynamic.skip_range
        return near, count - far


def doppler_of(beams: Complex, count: int) -> Index:
    """Signed Doppler bin [n] of the largest of an FFT over loops [n, loop], without a window."""
    spectrum_ = scipy.fft.fft(beams, count, axis=-1)
    largest = (spectrum_.real**2 + spectrum_.imag**2).argmax(axis=-1)
    signed: Index = np.where(largest > count // 2, largest - count, largest)
    return signed


def track_people(
    cube: Complex,
    board: Board,
    settings: PeopleTracking,
    carrier: float | None = None,
) -> Cloud:
    """Find the points of every frame of a cube.

    Args:
        cube: Samples [frame, loop, virtual, sample].
        board: The board that took them.
        settings: Detection of its .cfg.
        carrier: Frequency of the Doppler axis, Hz; None for the centre frequency.
    """
    tracker, window = PeopleTracker.of(settings), np.blackman(board.samples)
    fine = settings.fine_motion
    together = 0 if fine is None else frames_together(fine, board.loops, board.period_s)
    step = firmware_doppler_step(board, carrier)
    frames = list[Float]()
    for number in range(len(cube)):
        frame, is_fine = cube[number], fine is not None and is_fine_frame(number, fine, together)
        if is_fine:
            frame = join_frames(cube[number + 1 - together : number + 1])
        frame = decode_bpm(frame, board.sums, board.differences)
        points = tracker.find(range_bins(frame, window, tracker.turned), board.n_doppler)
        if is_fine and fine is not None:
            points = points.where(np.abs(points.doppler) <= fine.highest_bin)
            points = points._replace(doppler=np.zeros_like(points.doppler))
        frames.append(as_rows(points, board.range_step_m, step))
    return Cloud.of(frames)


def firmware_doppler_step(board: Board, carrier: float | None = None) -> float:
    """Spacing of the Doppler bins, m/s: at the frequency N/(2 fs) after the first sample.

    Args:
        carrier: Another frequency, Hz; None for that.
    """
    middle = board.carrier_hz + board.slope_hz * board.samples / (2 * board.adc_rate_hz)
    return SPEED_OF_LIGHT / (2 * (carrier or middle) * board.loop_s * board.n_doppler)


def as_rows(points: DetectedPoints, range_step: float, doppler_step: float) -> Float:
    """Write points as the rows [n, 8] of a cloud, in radhar's axes.

    Args:
        range_step: Spacing of the range bins, m.
        doppler_step: Spacing of the Doppler bins, m/s.
    """
    r = points.bin * range_step
    level = r * np.cos(points.elevation)
    return np.column_stack(
        [
            level * np.cos(points.azimuth),
            -level * np.sin(points.azimuth),
            r * np.sin(points.elevation),
            -points.doppler * doppler_step,
            points.power,
            10 * np.log10(points.snr),
            points.bin,
            -points.doppler,
        ]
    )


def correction_phases(coefficients: Sequence[complex], channels: int) -> Complex:
    """Phases [virtual] by which channels are multiplied to correct them; 1 without corrections.

    They stand in the data and not in the steering vectors, which is the same.
    """
    corrections = np.array(coefficients, complex)
    if not corrections.size or (np.abs(corrections - 1) <= UNEQUAL).all():
        return np.ones(channels, complex)
    phases: Complex = corrections / np.abs(corrections)
    return phases
