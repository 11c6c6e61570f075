"""Point clouds as TI's older people counting firmware makes them, of one row of elements.

The map has azimuths in equal steps of degrees, and there is no elevation. Of both passes of the
CFAR each must fire. The firmware of xWR68xx looks for several speeds of a cell, which is not
modelled: a point has the largest peak's, as on xWR16xx.
"""

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.processing.people_tracking.capon import covariance, spectrum, weights, whitening
from radhar_cli.processing.people_tracking.chain import (
    as_rows,
    correction_phases,
    doppler_of,
    firmware_doppler_step,
)
from radhar_cli.processing.people_tracking.detected_points import DetectedPoints
from radhar_cli.processing.people_tracking.spectrum import range_bins
from radhar_cli.processing.people_tracking.two_pass_cfar import detect_moving
from radhar_cli.processing.points import Cloud, elevation_pair
from radhar_cli.radar.board import Board
from radhar_cli.radar.people_tracking import PeopleCounting

MAX_POINTS = 300  # of a frame


def count_people(
    cube: Complex,
    board: Board,
    settings: PeopleCounting,
    remove_mean: bool,
    carrier: float | None = None,
) -> Cloud:
    """Find the points of every frame of a cube.

    Args:
        cube: Samples [frame, loop, virtual, sample].
        board: The board that took them.
        settings: Detection of its .cfg.
        remove_mean: Whether the mean over the loops of a frame is taken out.
        carrier: Frequency of the Doppler axis, Hz; None for the centre frequency.
    """
    row, *_ = elevation_pair(board)
    right = -(board.places[row, 0] - board.places[row[0], 0])
    turned = correction_phases(settings.coefficients, board.channels)
    sines = np.sin(np.radians(settings.angles_deg))
    vectors = np.exp(-1j * np.pi * np.multiply.outer(sines, right))
    step, window = firmware_doppler_step(board, carrier), np.blackman(board.samples)
    frames = list[Float]()
    for frame in cube:
        bins = range_bins(frame, window, turned)
        signals = bins.moving if remove_mean else bins.moving + bins.mean[..., None]
        points = find_in_row(signals[:, row], vectors, settings, board.n_doppler)
        frames.append(as_rows(points, board.range_step_m, step))
    return Cloud.of(frames)


def find_in_row(
    signals: Complex, vectors: Complex, settings: PeopleCounting, doppler_bins: int
) -> DetectedPoints:
    """Find the points of a frame.

    Args:
        signals: Range bins [bin, element, loop] of the row.
        vectors: Steering vectors [angle, element].
        settings: Detection of the .cfg.
        doppler_bins: Number of Doppler bins.
    """
    near, far = settings.cfar.skip_range
    whitener = whitening(covariance(signals), settings.gamma)
    power = spectrum(whitener, vectors).T
    power[:, :near] = power[:, len(signals) - far :] = 0
    cells = detect_moving(power, settings.cfar)
    order = np.argsort(order_of_angles(len(vectors))[cells.angle], kind="stable")[:MAX_POINTS]
    cells = cells.where(order)
    looking = weights(whitener[cells.bin], vectors[cells.angle])
    beams = (looking.conj()[:, None] @ signals[cells.bin])[:, 0]
    return DetectedPoints(
        cells.bin,
        np.radians(settings.angles_deg)[cells.angle],
        np.zeros(cells.bin.size),
        doppler_of(beams, doppler_bins),
        cells.power / cells.noise,
        cells.power,
    )


def order_of_angles(angles: int) -> Index:
    """Number the angles in the order of the search: first, last, second, last but one, ..."""
    number = np.arange(angles)
    turn: Index = np.minimum(2 * number, 2 * (angles - 1 - number) + 1)
    return turn
