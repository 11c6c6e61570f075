"""Directions of detected cells: the elevation of a cell of an azimuth map, or a zoom about it."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from radhar_cli.numerics.arrays import Bool, Complex, Float, Index
from radhar_cli.processing.people_tracking.capon import spectrum, weights
from radhar_cli.processing.people_tracking.grid import steering
from radhar_cli.processing.people_tracking.two_pass_cfar import Cells
from radhar_cli.radar.people_tracking import Cosines, Zoom

AROUND = np.array([-1, 0, 1])
NEIGHBOURS = {1: ((-1, 0), (1, 0)), 2: tuple((i, j) for i in AROUND for j in AROUND if i or j)}


class Directions(NamedTuple):
    """Directions of points, and weights that look there.

    Attributes:
        cell: Number of the detected cell of each point [n].
        azimuth: Azimuth, positive to the right [n], rad.
        elevation: Elevation [n], rad.
        snr: Power of the point over the noise of its cell [n].
        power: Power of the point [n].
        weights: Weights w of y = w^H Y over all elements [n, virtual].
    """

    cell: Index
    azimuth: Float
    elevation: Float
    snr: Float
    power: Float
    weights: Complex


@dataclass(frozen=True)
class Aperture:
    """All elements of the board as the firmware believes them to be, and its view.

    Attributes:
        right: Places of the virtual elements to the right [virtual], half wavelengths.
        up: Places upwards [virtual].
        nu: Cosines to the right that are looked at.
        mu: Cosines upwards.
    """

    right: Float
    up: Float
    nu: Cosines
    mu: Cosines

    def steering(self, nu: Float, mu: Float | float) -> Complex:
        """Steering vectors [..., virtual] of directions."""
        return steering(self.right, self.up, nu, mu)


def find_elevations(cells: Cells, whitener: Complex, aperture: Aperture) -> Directions:
    """Find the elevation of cells of an azimuth map: the first largest power over elevation.

    The elevation is the centre of mass of that power and its neighbours; nu is not interpolated.

    Args:
        cells: Detected cells; `angle` is the number of nu.
        whitener: L^-1 [bin, virtual, virtual] of all elements.
        aperture: Elements and view.
    """
    nu, mu = aperture.nu.values[cells.angle], aperture.mu.values
    vectors = aperture.steering(nu[:, None], mu)
    power = spectrum(whitener[cells.bin], vectors)
    cell = np.arange(nu.size)
    largest = power.argmax(axis=1)
    near = np.clip(largest[:, None] + AROUND, 0, mu.size - 1)
    elevation_sine = aperture.mu.at(_centre(near, power[cell[:, None], near]))
    elevation, azimuth, is_real = directions_of(nu, elevation_sine)
    chosen = cell[is_real]
    looking = weights(whitener[cells.bin[chosen]], vectors[chosen, largest[chosen]])
    return Directions(
        chosen,
        azimuth[is_real],
        elevation[is_real],
        (cells.power / cells.noise)[is_real],
        cells.power[is_real],
        looking,
    )


def zoom_in(
    cells: Cells, power: Float, whitener: Complex, aperture: Aperture, zoom: Zoom
) -> Directions:
    """Look about cells of an azimuth-elevation map with finer steps.

    Args:
        cells: Detected cells; `angle` is elevation times the number of azimuths plus azimuth.
        power: The map [angle, bin].
        whitener: L^-1 [bin, virtual, virtual].
        aperture: Elements and view.
        zoom: Settings.
    """
    count = aperture.nu.values.size
    row, column = np.divmod(cells.angle, count)
    tops = _is_top(power.reshape(-1, count, power.shape[1]), row, column, cells, zoom.neighbours)
    chosen = np.flatnonzero(tops)
    offsets = np.arange(-zoom.factor, zoom.factor + 1) / zoom.factor
    nu = aperture.nu.at(column[chosen, None] + offsets)[:, :, None]
    mu = aperture.mu.at(row[chosen, None] + offsets)[:, None, :]
    vectors = aperture.steering(nu, mu).reshape(chosen.size, offsets.size**2, -1)
    nu, mu = (grid.reshape(vectors.shape[:2]) for grid in np.broadcast_arrays(nu, mu))
    bins = cells.bin[chosen]
    fine = spectrum(whitener[bins], vectors)
    noise = cells.noise[chosen]
    is_point = _expand(fine, noise, offsets.size, zoom)
    point, place = np.nonzero(is_point)
    elevation, azimuth, is_real = directions_of(nu[point, place], mu[point, place])
    farthest = aperture.nu.step - aperture.nu.first
    is_real &= np.abs(np.sin(azimuth)) < farthest
    point, place = point[is_real], place[is_real]
    is_several = is_point.sum(axis=1) > 1
    level = np.where(is_several[point], fine[point, place], cells.power[chosen[point]])
    return Directions(
        chosen[point],
        azimuth[is_real],
        elevation[is_real],
        level / noise[point],
        level,
        weights(whitener[bins[point]], vectors[point, place]),
    )


def _centre(index: Index, power: Float) -> Float:
    """Centre of mass [n] of indices [n, 3] by power [n, 3]."""
    mass: Float = (index * power).sum(axis=1) / power.sum(axis=1)
    return mass


def directions_of(nu: Float, mu: Float) -> tuple[Float, Float, Bool]:
    """Elevation and azimuth (rad) of direction cosines, and whether there is such a direction."""
    level = np.sqrt(np.maximum(1 - mu * mu, 0))
    is_real: Bool = np.abs(nu) < level
    sine = np.where(is_real, nu, 0) / np.where(is_real, level, 1)
    return np.arcsin(np.clip(mu, -1, 1)), np.arcsin(sine), is_real


def _is_top(power: Float, row: Index, column: Index, cells: Cells, neighbours: int) -> Bool:
    """Whether cells of a map [elevation, azimuth, bin] are not below some of their neighbours.

    With neighbours above and below alone, cells at an end of the elevations fail.
    """
    wide = np.pad(power, ((1, 1), (1, 1), (0, 0)), constant_values=-np.inf)
    is_top = np.ones(row.size, bool)
    for above, aside in NEIGHBOURS.get(neighbours, ()):
        is_top &= cells.power >= wide[row + 1 + above, column + 1 + aside, cells.bin]
    if neighbours == 1:
        is_top &= (row > 0) & (row < len(power) - 1)
    return is_top


def _expand(fine: Float, noise: Float, side: int, zoom: Zoom) -> Bool:
    """Which fine cells [n, side * side] become points: the first largest, or those beside it too.

    Args:
        fine: Power [n, side * side], azimuth outermost.
        noise: Noise [n].
        side: Number of fine cells along an axis.
        zoom: Settings.
    """
    largest = fine.argmax(axis=1)
    number = np.arange(fine.shape[1])
    is_point: Bool = number == largest[:, None]
    if zoom.reach <= 0:
        return is_point
    peak, least = fine.max(axis=1), fine.min(axis=1)
    across, upwards = (
        np.abs(place[None] - place[largest][:, None]) for place in np.divmod(number, side)
    )
    is_near = np.maximum(across, upwards) <= zoom.reach
    level = peak * (zoom.relative - (peak - least) / (peak + least))
    is_strong = (peak > zoom.least_snr * noise)[:, None]
    return np.where(is_strong, is_near & (fine > level[:, None]), is_point)
