"""Raw recording of a scene: the beat matrix, or profiles, leakage and static returns."""

import numpy as np

from radhar_cli.config.radar import CwRadar
from radhar_cli.echo.exact import beat_blocks
from radhar_cli.echo.impulse import Profiles
from radhar_cli.echo.paths import PathSource
from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.look import Look, ProfileSamples
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.impulse import Impulse
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.wall import Wall
from radhar_cli.scene.products.plan import Product
from radhar_cli.scene.products.signal import receive_echo
from radhar_cli.scene.products.static_returns import make_static_returns
from radhar_cli.scene.scene import Scene


def raw_echo(
    scene: Scene,
    paths: PathSource,
    waveform: Waveform,
    antennas: Antennas,
    wall: Wall | None,
    receiver: tuple[Impairment, ...],
) -> Complex | Float:
    """Compute the beat matrix as an ADC would record it, with leakage and static returns.

    Args:
        scene: the scene; its wall must keep 5 cm from the antennas' midpoint.
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
    beat += make_static_returns(scene, waveform, antennas, wall).samples
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
    return r + make_static_returns(scene, waveform, antennas, wall).samples


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
