"""Bistatic delay and amplitude of a path (paper, section "Radar Echo Model"; docs/model.md)."""

from dataclasses import dataclass, replace
from math import pi
from typing import NamedTuple

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.radar.waveform import SPEED_OF_LIGHT


class Aim(NamedTuple):
    """Where an antenna looks, and how its gain falls off to the sides.

    Attributes:
        position: of the array, m.
        axes: [3, 3], rows are ahead, left and up of the radar in the scene.
        half_power_deg: half-power half-widths (azimuth, elevation), one way.
    """

    position: tuple[float, float, float]
    axes: tuple[tuple[float, float, float], ...]
    half_power_deg: tuple[float, float]

    def to_radar(self, p: Float) -> Float:
        """Places p [3, ...] of the scene as the radar has them: ahead, left, up, m."""
        seen: Float = np.tensordot(np.array(self.axes), (p.T - np.array(self.position)).T, axes=1)
        return seen

    def two_way(self, p: Float) -> Float:
        """Two-way amplitude pattern exp(-ln 2 ((az/az3)^2 + (el/el3)^2)) [...] at p [3, ...]."""
        ahead, left, up = self.to_radar(p)
        azimuth, elevation = np.arctan2(left, ahead), np.arctan2(up, np.hypot(ahead, left))
        az3, el3 = np.radians(self.half_power_deg)
        pattern: Float = np.exp(-np.log(2) * ((azimuth / az3) ** 2 + (elevation / el3) ** 2))
        return pattern


@dataclass(frozen=True)
class Antennas:
    """Transmitter and receiver.

    Attributes:
        tx, rx: positions (x, y, z), m.
        gain: linear gain of each antenna.
        isolation_db: between the two; used by the static leakage alone.
        aim: where both look, with their pattern; None radiates evenly.
    """

    tx: tuple[float, float, float]
    rx: tuple[float, float, float]
    gain: float
    isolation_db: float
    aim: Aim | None = None


def behind_mirror(antennas: Antennas, x: float, reflectance: float) -> Antennas:
    """The antennas as a wall at range x (m) mirrors them: what they see is seen by way of it.

    Echoes that go there and back by way of the wall come from a range of 2 x less the scatterer's,
    with the opposite Doppler, and are weaker by the square of the power `reflectance`. Neglected:
    echoes that meet the wall once, whose Doppler is that of movements across, and polarisation.
    """
    (tx_x, tx_y, tx_z), (rx_x, rx_y, rx_z) = antennas.tx, antennas.rx
    return replace(
        antennas,
        tx=(2 * x - tx_x, tx_y, tx_z),
        rx=(2 * x - rx_x, rx_y, rx_z),
        gain=antennas.gain * reflectance,
    )


def leg(p: Float, antenna: tuple[float, float, float]) -> Float:
    """Distance (m) [I, M] between positions p [3, I, M] and an antenna."""
    x, y, z = p[0] - antenna[0], p[1] - antenna[1], p[2] - antenna[2]
    x *= x
    y *= y
    z *= z
    x += y
    x += z
    distance: Float = np.sqrt(x, out=x)
    return distance


def bistatic_delay(r_tx: Float, r_rx: Float) -> Float:
    """tau = (R_tx + R_rx)/c in s."""
    return (r_tx + r_rx) / SPEED_OF_LIGHT


def amplitude(r_tx: Float, r_rx: Float, sigma: Float, gain: float, wavelength: float) -> Float:
    """A = sqrt(G_tx G_rx lambda^2 sigma/(4 pi)^3)/(R_tx R_rx) for unit transmit power.

    Args:
        r_tx, r_rx: legs [I, M], m.
        sigma: RCS [I, M] or [I, 1], m^2.
        gain: linear gain of each antenna.
        wavelength: m.
    """
    scale = gain * wavelength / (4 * pi) ** 1.5 * np.sqrt(sigma)
    a: Float = scale / (r_tx * r_rx)
    return a
