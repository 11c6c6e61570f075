"""Antenna leakage and the wall's echo: MTI removes both; raw echoes have them."""

from math import dist, pi
from typing import NamedTuple

from radhar_cli.radar.fmcw import SPEED_OF_LIGHT, Waveform
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.wall import Wall


class StaticReturn(NamedTuple):
    """A path that does not move: delay (s) and amplitude for unit transmit power."""

    delay: float
    amplitude: float


def leakage(antennas: Antennas) -> StaticReturn:
    """Leakage between the antennas: amplitude 10^(-isolation/20), delay |p_tx - p_rx|/c."""
    return StaticReturn(
        dist(antennas.tx, antennas.rx) / SPEED_OF_LIGHT, 10 ** (-antennas.isolation_db / 20)
    )


def near_face_distance(antennas: Antennas, wall: Wall) -> float:
    """Distance (m) along x from the antennas' midpoint to the wall's near face."""
    middle = (antennas.tx[0] + antennas.rx[0]) / 2
    return min(abs(face - middle) for face in wall.bounds[0])


def wall_echo(antennas: Antennas, wall: Wall, waveform: Waveform) -> StaticReturn:
    """Specular echo of the near face: |Gamma| G lambda/(4 pi 2 d), delay 2 d/c.

    d is the `near_face_distance`, above 0. For layers, whose R depends on frequency, it lacks
    |Gamma|.
    """
    d = near_face_distance(antennas, wall)
    reflected = abs(wall.reflection) if wall.layers is None else 1.0
    amplitude = reflected * antennas.gain * waveform.wavelength / (8 * pi * d)
    return StaticReturn(2 * d / SPEED_OF_LIGHT, amplitude)
