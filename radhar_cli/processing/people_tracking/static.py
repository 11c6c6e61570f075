"""Points of static echoes: a beamformer over the mean of a frame's loops.

S = |a^H M|^2 of the mean M over all elements, at every so many directions. With noise alone these
are single looks, and the CFAR fires all over: the path needs an echo of a room, as on the board.
"""

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.processing.people_tracking.detected_points import DetectedPoints
from radhar_cli.processing.people_tracking.refinement import AROUND, Aperture, directions_of
from radhar_cli.processing.people_tracking.two_pass_cfar import MAX_CELLS, detect_static
from radhar_cli.radar.people_tracking import StaticSearch


def find_static(mean: Complex, aperture: Aperture, search: StaticSearch) -> DetectedPoints:
    """Find points of static echoes.

    Args:
        mean: Mean M [bin, virtual] over the loops.
        aperture: Elements and view.
        search: Settings.
    """
    nu, mu = (
        axis.values[::every]
        for axis, every in zip((aperture.nu, aperture.mu), search.decimation, strict=True)
    )
    vectors = aperture.steering(nu[:, None], mu)
    beam = vectors.conj() @ mean.T
    power = beam.real**2 + beam.imag**2  # [azimuth, elevation, bin]
    cells = detect_static(power.reshape(-1, len(mean)), search.cfar).where(slice(MAX_CELLS))
    column, row = np.divmod(cells.angle, mu.size)
    aside, upwards = _centres(power, column, row, cells.bin)
    elevation, azimuth, is_real = directions_of(
        aperture.nu.at(aside * search.decimation[0]), aperture.mu.at(upwards * search.decimation[1])
    )
    resting = np.zeros(cells.bin.size, np.intp)
    snr = cells.power / cells.noise
    points = DetectedPoints(cells.bin, azimuth, elevation, resting, snr, cells.power)
    return points.where(is_real)


def _centres(power: Float, column: Index, row: Index, bins: Index) -> tuple[Float, Float]:
    """Centre of mass of each cell and its eight neighbours: azimuth index and elevation index.

    Args:
        power: Power [azimuth, elevation, bin], beyond whose ends nothing counts.
        column: Azimuths of the cells [n].
        row: Elevations of the cells [n].
        bins: Range bins of the cells [n].
    """
    wide = np.pad(power, ((1, 1), (1, 1), (0, 0)))
    across = column[:, None, None] + AROUND[:, None]
    upwards = row[:, None, None] + AROUND
    mass = wide[across + 1, upwards + 1, bins[:, None, None]]
    total = mass.sum(axis=(1, 2))
    return (mass * across).sum(axis=(1, 2)) / total, (mass * upwards).sum(axis=(1, 2)) / total
