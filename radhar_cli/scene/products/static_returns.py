"""Static returns of a radar of one channel: leakage, the wall, the faces of the room.

A canceller takes it out, so that only raw recordings have it, and maps where nothing is taken out.
Boards have the faces in their samples (`board.py`), and no leakage.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.dispersion import beat_of
from radhar_cli.echo.face_echoes import echoes_of_faces
from radhar_cli.echo.impulse import profiles_of, steady_profile
from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.echo.static_returns import StaticReturn, leakage, near_face_distance, wall_echo
from radhar_cli.errors import SceneError
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.look import Look
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.impulse import Impulse
from radhar_cli.radar.layers import Layers
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.wall import Wall
from radhar_cli.scene.room import echo_ways_of
from radhar_cli.scene.scene import Scene

NEAREST_WALL_M = 0.05


@dataclass(frozen=True, eq=False)
class StaticReturns(Impairment):
    """Static returns, which add the same to the samples of every pulse.

    Attributes:
        samples: raw samples, or samples over range, of one pulse [N, 1].
    """

    samples: Complex | Float

    def apply(self, x: Complex, look: Look) -> Complex:
        """Add it to an echo [K, M] as a look shows it."""
        added: Complex = x + sum(look.taps) * look.fast(self.samples.astype(complex))
        return added


def add_static_returns(
    receiver: tuple[Impairment, ...],
    scene: Scene,
    waveform: Waveform,
    antennas: Antennas,
    wall: Wall | None,
) -> tuple[Impairment, ...]:
    """Add static returns to the impairments of a receiver."""
    return (*receiver, make_static_returns(scene, waveform, antennas, wall))


def make_static_returns(
    scene: Scene, waveform: Waveform, antennas: Antennas, wall: Wall | None
) -> StaticReturns:
    """Compute the samples of leakage, and of the echoes of the wall and of faces.

    Args:
        scene: the scene; its wall must keep 5 cm from the antennas' midpoint.
        waveform: chirps or pulses.
        antennas: antennas, which leak.
        wall: wall, which echoes by itself, or None.

    Raises:
        SceneError: the wall's near face is within 5 cm of the antennas' midpoint.
    """
    if wall is not None:
        _refuse_near_face(scene, antennas, wall)
    leaked = leakage(antennas)
    reflected = None if wall is None else wall_echo(antennas, wall, waveform)
    faces = echoes_of_faces(antennas, echo_ways_of(scene), wall, waveform.fc).paths
    layers = None if wall is None else wall.layers
    if isinstance(waveform, Impulse):
        profile = steady_profile(*leaked, waveform) + profiles_of(faces, waveform)
        if reflected is not None:
            coefficient = None if layers is None else partial(_reflection, layers)
            profile = profile + steady_profile(*reflected, waveform, coefficient)
        return StaticReturns(profile)
    beat = _steady_beat(leaked, waveform) + beat_of(faces, waveform)
    if reflected is not None:
        echo = _steady_beat(reflected, waveform)
        if layers is not None:
            echo *= _reflection(layers, waveform.frequencies())[:, None]
        beat += echo
    return StaticReturns(beat)


def _steady_beat(static_return: StaticReturn, waveform: Waveform) -> Complex:
    """Beat [N_ADC, 1] of a path that does not move."""
    delay, amplitude = np.array([[static_return.delay]]), np.array([[static_return.amplitude]])
    return beat_matrix(delay, amplitude, waveform)


def _reflection(layers: Layers, f: Float) -> Complex:
    """R of a wall at frequencies f (Hz), at right angles."""
    reflected: Complex = layers.scattering_coefficients(f, np.ones(())).reflected
    return reflected


def _refuse_near_face(scene: Scene, antennas: Antennas, wall: Wall) -> None:
    """Raise SceneError of a wall whose near face is within 5 cm of the antennas' midpoint."""
    distance = near_face_distance(antennas, wall)
    if distance < NEAREST_WALL_M:
        raise SceneError(
            f"{scene.name}: the near face of the wall (wall.center_m, wall.size_m) "
            f"is {distance * 100:.3g} cm from the middle of radar.tx_m and radar.rx_m; its "
            f"own echo holds from {NEAREST_WALL_M * 100:g} cm on"
        )
