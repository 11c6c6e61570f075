"""What the receiver of a scene adds to the echo, and its random streams."""

from functools import partial

import numpy as np

from radhar_cli.echo.receiver.flicker import FlickerNoise
from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.echo.receiver.interference import InterferenceLine
from radhar_cli.echo.receiver.noise import WhiteNoise
from radhar_cli.numerics.randomness import NOISE, stream
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.waveform import Waveform
from radhar_cli.scene.assembly.radar import antennas_of
from radhar_cli.scene.scene import Scene


def impairments_of(scene: Scene, noise: WhiteNoise, w: Waveform) -> tuple[Impairment, ...]:
    """Make the impairments that a receiver adds to white noise.

    Coloured noise is the channel's own, as white noise is. Interference comes from outside: tones
    are the same in all channels, phases included.
    """
    receiver, impairments = scene.receiver, list[Impairment]()
    corner, slope = receiver.noise_corner_hz, receiver.noise_slope_db
    if corner > 0:
        impairments.append(FlickerNoise(noise.sigma, noise.stream, corner, slope))
    of_scene = partial(noise_stream, scene)
    for number, tone in enumerate(receiver.tones):
        line = noise.sigma * 10 ** (tone.level_db / 20), tone.doppler_hz, w
        times = tone.on_s, tone.off_s
        impairments.append(
            InterferenceLine(*line, of_scene, f"line {number}", *times, tone.both_sides)
        )
    return tuple(impairments)


def channel_of(scene: Scene, antennas: Antennas) -> str:
    """Name of a receive channel: "" for the antennas of the config, else the antennas' numbers."""
    if antennas == antennas_of(scene):
        return ""
    numbers = (*antennas.tx, *antennas.rx, antennas.gain, antennas.isolation_db)
    return " ".join(str(float(number)) for number in numbers)


def noise_stream(scene: Scene, name: str, channel: object = "") -> np.random.Generator:
    """Random stream of the noise of a scene's radar.

    Args:
        scene: the scene, whose seed, class and index name the stream, and its radar of several.
        name: what the noise is.
        channel: name of the receive channel (`channel_of`).
    """
    key = (scene.activity.index, scene.index)
    name = f"{name} channel {channel}" if channel else name
    if scene.config.radar_name is not None:
        name = f"{name} radar {scene.config.radar_name}"
    return stream(scene.config.seed, NOISE, *key, name=name)


def surroundings_stream(scene: Scene, name: str) -> np.random.Generator:
    """Random stream of what moves in a scene besides people, the same for all of its radars.

    Args:
        scene: the scene, whose seed, class and index name the stream.
        name: what moves.
    """
    key = (scene.activity.index, scene.index)
    return stream(scene.config.seed, NOISE, *key, name=name)
