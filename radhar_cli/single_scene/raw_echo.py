"""Raw recording of a scene: the beat matrix, or profiles, leakage and what stands still."""

from functools import partial

import numpy as np

from radhar_cli.assembly.room import echo_ways_of
from radhar_cli.config.radar import CwRadar
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.dispersion import beat_of
from radhar_cli.echo.exact import beat_blocks
from radhar_cli.echo.face_echoes import echoes_of_faces
from radhar_cli.echo.impulse import Profiles, profiles_of, steady_profile
from radhar_cli.echo.paths import PathSource
from radhar_cli.echo.static_returns import StaticReturn, leakage, near_face_distance, wall_echo
from radhar_cli.errors import SceneError
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.look import Look, ProfileSamples
from radhar_cli.products.plan import Product
from radhar_cli.products.signal import receive_echo
from radhar_cli.radar.impulse import Impulse
from radhar_cli.radar.layers import Layers
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import Waveform
from radhar_cli.receiver.impairment import Impairment
from radhar_cli.scene import Scene
from radhar_cli.scene_checks.validity import MIN_DISTANCE_M


def raw_echo(
    scene: Scene,
    paths: PathSource,
    waveform: Waveform,
    antennas: Antennas,
    wall: Wall | None,
    receiver: tuple[Impairment, ...],
) -> Complex | Float:
    """Compute the beat matrix as an ADC would record it, with leakage and what stands still.

    Args:
        scene: the scene; its wall must keep 5 cm from the antennas' midpoint.
        paths: paths of the body.
        waveform: chirps and pulses.
        antennas: antennas, which leak.
        wall: wall, which echoes by itself, or None.
        receiver: impairments, noise among them.

    Returns:
        s_noisy[n, m] [N_ADC, M]; its in-phase channel for a receiver of real samples
        (`radar.output`).

    Raises:
        SceneError: the wall's near face is within 5 cm of the antennas' midpoint.
    """
    blocks = beat_blocks(paths, waveform, receiver, scene.config.engine.motion_in_chirp)
    beat = np.concatenate(list(blocks), axis=1)
    beat += _steady_beat(leakage(antennas), waveform)
    faces = echoes_of_faces(antennas, echo_ways_of(scene), wall, waveform.fc)
    beat += beat_of(faces.paths, waveform)
    if wall is not None:
        _refuse_near_face(scene, antennas, wall)
        echo = _steady_beat(wall_echo(antennas, wall, waveform), waveform)
        if wall.layers is not None:
            echo *= _reflection(wall.layers, waveform.frequencies())[:, None]
        beat += echo
    is_real = isinstance(scene.radar, CwRadar) and scene.radar.output == "real"
    return beat.real if is_real else beat


def raw_profiles(
    scene: Scene,
    profiles: Profiles,
    waveform: Impulse,
    antennas: Antennas,
    wall: Wall | None,
    receiver: tuple[Impairment, ...],
) -> Profiles:
    """Compute range profiles as an impulse radar would record them.

    Args:
        scene: the scene; its wall must keep 5 cm from the antennas' midpoint.
        profiles: profiles of the body alone [samples, M].
        waveform: pulses.
        antennas: antennas, which leak.
        wall: wall, which echoes by itself, or None.
        receiver: impairments, noise among them.

    Returns:
        Profiles [samples, M] of body, noise, leakage, and echoes of the wall and of faces.

    Raises:
        SceneError: the wall's near face is within 5 cm of the antennas' midpoint.
    """
    look = Look.of_all("profiles", ProfileSamples(waveform))
    received = receive_echo(profiles.astype(complex), look, receiver).x[0]
    r: Profiles = received if waveform.is_iq else received.real
    r = r + steady_profile(*leakage(antennas), waveform)
    faces = echoes_of_faces(antennas, echo_ways_of(scene), wall, waveform.fc)
    r += profiles_of(faces.paths, waveform)
    if wall is not None:
        _refuse_near_face(scene, antennas, wall)
        layers = wall.layers
        reflected = None if layers is None else partial(_reflection, layers)
        r += steady_profile(*wall_echo(antennas, wall, waveform), waveform, reflected)
    return r


def _reflection(layers: Layers, f: Float) -> Complex:
    """R of a wall at frequencies f (Hz), at right angles."""
    reflected: Complex = layers.scattering_coefficients(f, np.ones(())).reflected
    return reflected


def _refuse_near_face(scene: Scene, antennas: Antennas, wall: Wall) -> None:
    """Raise SceneError of a wall whose near face is within 5 cm of the antennas' midpoint."""
    distance = near_face_distance(antennas, wall)
    if distance < MIN_DISTANCE_M:
        raise SceneError(
            f"{scene.name}: the near face of the wall (wall.center_m, wall.size_m) "
            f"is {distance * 100:.3g} cm from the middle of radar.tx_m and radar.rx_m; its "
            f"echo in a raw recording holds from {MIN_DISTANCE_M * 100:g} cm on"
        )


def _steady_beat(static_return: StaticReturn, waveform: Waveform) -> Complex:
    return beat_matrix(
        np.array([[static_return.delay]]), np.array([[static_return.amplitude]]), waveform
    )


RAW_ECHO = Product(
    "raw_echo",
    ("scene", "paths", "waveform", "antennas", "wall", "receiver"),
    raw_echo,
    "beat matrix as recorded, static returns included",
)
RAW_PROFILES = Product(
    "raw_echo",
    ("scene", "profiles", "waveform", "antennas", "wall", "receiver"),
    raw_profiles,
    "range profiles as recorded, static returns included",
)
