"""Settings of the people tracking and people counting chains of TI's firmware, as a .cfg has them.

Sources: TI's 3D people counting demo (radar toolbox 4.7: `pcount3D_cli.c`, `radarProcess.c`) with
its implementation and detection-layer tuning guides (2021); its people counting lab for xWR16xx.
Azimuths are positive to the right, elevations upwards, as TI has them.
"""

from dataclasses import dataclass
from functools import cached_property
from math import floor, radians, sin

import numpy as np

from radhar_cli.numerics.arrays import Float

_ROUNDING = 1e-9  # of a number of steps


@dataclass(frozen=True)
class Cosines:
    """Direction cosines -s + i s step/A, s = sin A: the last may fall short of s.

    Attributes:
        half_view_deg: Half width A of the view, degree.
        step_deg: Step in the middle, degree.
    """

    half_view_deg: float
    step_deg: float

    @property
    def first(self) -> float:
        """The first, -s."""
        return -sin(radians(self.half_view_deg))

    @property
    def step(self) -> float:
        """Difference of a cosine and the next."""
        return -self.first * self.step_deg / self.half_view_deg

    @cached_property
    def values(self) -> Float:
        """All cosines of the grid, ascending."""
        count = floor(2 * self.half_view_deg / self.step_deg + _ROUNDING) + 1
        values: Float = self.first + np.arange(count) * self.step
        return values

    def at(self, index: Float) -> Float:
        """Cosines at indices, which may lie between."""
        return self.first + index * self.step


@dataclass(frozen=True)
class TwoPassCfar:
    """CFAR of a range-angle map: along range, and along angle for what that finds.

    Attributes:
        skip_range: Bins at the near and the far end that are left out.
        skip_angle: Angles at the first and the last end that are left out.
        window: Cells on each side that are averaged, along range and along angle.
        guard: Cells on each side that are left out, along range and along angle.
        threshold: Power of a detected cell over the average, along range and along angle.
        sidelobe: Power over the largest of the bin from which a maximum over angle is kept
            although the pass along angle fails; None without that rule.
        second_pass: Whether there is a pass along angle.
    """

    skip_range: tuple[int, int]
    skip_angle: tuple[int, int]
    window: tuple[int, int]
    guard: tuple[int, int]
    threshold: tuple[float, float]
    sidelobe: float | None
    second_pass: bool

    def fits_bins(self, bins: int) -> bool:
        """Whether both sides along range lie between the ends of so many bins."""
        return bins - sum(self.skip_range) > 2 * (self.window[0] + self.guard[0])

    def mirrors_within(self, bins: int) -> bool:
        """Whether the mirror of the far side, at the last of so many bins, lies in the map.

        The firmware takes bins that are `skip_range[1]` nearer.
        """
        reach = self.window[0] + self.guard[0]
        return bins - self.skip_range[1] - reach >= self.skip_range[1]

    def fits_angles(self, angles: int) -> bool:
        """Whether both sides along angle lie within so many angles, where there is that pass."""
        return not self.second_pass or angles > 2 * (self.window[1] + self.guard[1])


@dataclass(frozen=True)
class ElevationSearch:
    """Elevation of a cell of the azimuth map: the largest of a search over all elements.

    Attributes:
        step_deg: Step of the search where it looks ahead, degree.
        gamma: Share of the mean power that is added to the diagonal of the covariance.
    """

    step_deg: float
    gamma: float


@dataclass(frozen=True)
class Zoom:
    """Finer search about a cell of the azimuth-elevation map.

    Attributes:
        factor: Number of finer steps in a step of the map.
        reach: Finer cells on each side of the largest that become points too; 0 for none.
        relative: Power over the largest from which they do, less the contrast of the cells.
        least_snr: Power of the largest over the noise from which they do.
        neighbours: 1 keeps cells that are not below those above and below, 2 cells that are not
            below any of eight, 0 all.
    """

    factor: int
    reach: int
    relative: float
    least_snr: float
    neighbours: int


@dataclass(frozen=True)
class StaticSearch:
    """Points of static echoes: a beamformer over the means of a frame.

    Attributes:
        cfar: Its CFAR, without a pass along angle; ranges that are left out are the moving points'.
        decimation: One in so many azimuths and elevations is looked at.
    """

    cfar: TwoPassCfar
    decimation: tuple[int, int]


@dataclass(frozen=True)
class FineMotion:
    """Frames whose points are those of slow movements, seen over several frames.

    Attributes:
        seconds: Duration over which they are seen, s.
        cycle: One in so many frames is such a frame.
        highest_bin: Largest Doppler bin of their points.
    """

    seconds: float
    cycle: int
    highest_bin: int


@dataclass(frozen=True)
class PeopleTracking:
    """Detection of the 3D people tracking firmware.

    Attributes:
        right: Places of the virtual elements to the right, half wavelengths.
        up: Places of the virtual elements upwards, half wavelengths.
        rotation: Signs of the virtual elements, +1 or -1.
        coefficients: Phase and gain corrections of the virtual elements.
        half_view_deg: Half widths of the search in azimuth and elevation, degree.
        step_deg: Step of the map where it looks ahead, degree.
        gamma: Share of the mean power that is added to the diagonal of the map's covariance.
        refinement: How a cell of the map becomes a direction: an azimuth map and a search over
            elevation, or an azimuth-elevation map and a zoom.
        dynamic: CFAR of the map.
        static: Search for static echoes; None where it is off.
        fine_motion: Frames of slow movements; None where they are off.
    """

    right: tuple[float, ...]
    up: tuple[float, ...]
    rotation: tuple[float, ...]
    coefficients: tuple[complex, ...]
    half_view_deg: tuple[float, float]
    step_deg: float
    gamma: float
    refinement: ElevationSearch | Zoom
    dynamic: TwoPassCfar
    static: StaticSearch | None = None
    fine_motion: FineMotion | None = None

    @property
    def nu(self) -> Cosines:
        """Direction cosines to the right that are looked at; a zoom needs a step on each side."""
        margin = self.step_deg if isinstance(self.refinement, Zoom) else 0.0
        return Cosines(self.half_view_deg[0] - margin, self.step_deg)

    @property
    def mu(self) -> Cosines:
        """Direction cosines upwards that are looked at."""
        if isinstance(self.refinement, Zoom):
            return Cosines(self.half_view_deg[1] - self.step_deg, self.step_deg)
        return Cosines(self.half_view_deg[1], self.refinement.step_deg)


@dataclass(frozen=True)
class PeopleCounting:
    """Detection of the older people counting firmware, of one row of elements.

    Attributes:
        half_view_deg: Half width of the map, degree.
        step_deg: Step of the map, degree.
        gamma: Share of the mean power that is added to the diagonal of the covariance.
        coefficients: Phase and gain corrections of the virtual elements.
        cfar: CFAR of the map.
    """

    half_view_deg: float
    step_deg: float
    gamma: float
    coefficients: tuple[complex, ...]
    cfar: TwoPassCfar

    @property
    def angles_deg(self) -> Float:
        """Azimuths that are looked at, equally spaced, from the left to the right."""
        count = round(2 * self.half_view_deg / self.step_deg)
        azimuths: Float = np.arange(count) * self.step_deg - self.half_view_deg
        return azimuths
