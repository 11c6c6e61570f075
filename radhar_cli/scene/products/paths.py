"""Parts of a scene: waveform, antennas, wall, motions, paths, and the torso's delay."""

from collections.abc import Iterator
from functools import partial
from math import inf

from radhar_cli.config.data_set import Config
from radhar_cli.echo.bodies.motion_paths import TorsoPath
from radhar_cli.echo.knots import delay_track
from radhar_cli.echo.paths import PathSource
from radhar_cli.motion.protocol import Motion
from radhar_cli.motion.reflectors import Reflectors
from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.wall import Wall
from radhar_cli.scene.motion import moving
from radhar_cli.scene.paths import Link, make_path_sources, sum_of_paths
from radhar_cli.scene.products.knot_rate import KnotRate, knot_rate_of
from radhar_cli.scene.products.plan import Product
from radhar_cli.scene.products.segments import make_segments
from radhar_cli.scene.products.signal_power import make_snr_paths, needs_other_paths
from radhar_cli.scene.radar import antennas_of, waveform_of
from radhar_cli.scene.room import reflectors_of, wall_of
from radhar_cli.scene.scene import Scene


def scene_products(config: Config) -> Iterator[Product]:
    """Rows of the parts of a scene, for either engine."""
    needs = ("motions", "antennas", "wall", "waveform")
    through = "through the wall" if config.wall is not None else "through air"
    yield Product("waveform", ("scene",), waveform_of, "chirps and pulses")
    yield Product("antennas", ("scene",), antennas_of, "positions and gains")
    yield Product("wall", ("scene",), wall_of, "the slab, or none")
    yield Product("motions", ("scene",), make_motions, "scatterers that move")
    if config.stream is not None:
        does = "what people do from when to when"
        yield Product("segments", ("scene", "motions"), make_segments, does, is_array=True)
    room = ("room",) if config.room.reflectors else ()
    if room:
        yield Product("room", ("scene",), reflectors_of, "what stands in the room")
    does = f"delay and amplitude of all {config.body.scatterers}, {through}"
    yield Product("paths", ("scene", *needs, *room), make_paths, does)
    if needs_other_paths(config):
        does = "paths of people, for the SNR"
        yield Product("snr_paths", ("scene", *needs), make_snr_paths, does)
    rate = knot_rate_of(config) if config.engine.kind == "direct" else None
    track = partial(track_torso, rate=rate)
    yield Product("torso_track", needs, track, "delay of the torso at every pulse", is_array=True)


def make_motions(scene: Scene) -> tuple[Motion, ...]:
    """Make the motions of the people in a scene, the sample's own person first."""
    return tuple(map(moving, scene.people))


def make_paths(
    scene: Scene,
    motions: tuple[Motion, ...],
    antennas: Antennas,
    wall: Wall | None,
    waveform: Waveform,
    room: Reflectors | None = None,
) -> PathSource:
    """Make the paths of everything in a scene."""
    return sum_of_paths(make_path_sources(scene, motions, Link(antennas, wall, waveform), room))


def track_torso(
    motions: tuple[Motion, ...],
    antennas: Antennas,
    wall: Wall | None,
    waveform: Waveform,
    rate: KnotRate | None = None,
) -> Float:
    """Compute the delay of the first person's torso at every pulse [M], s.

    Args:
        wall: wall between, or None.
        rate: rate of the knots between which delays are interpolated; None for every pulse.
    """
    torso = TorsoPath(motions[0], antennas, wall)
    return delay_track(torso, waveform, inf if rate is None else rate(torso, waveform))
