"""P_s, the power of the echo that an SNR refers to: of the simulated echo, or of other paths.

Paths have theirs by `power_at_pulses` or `power_at_knots`; the echo of the direct engine, and of a
board, knows its own.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.echo.exact import signal_power
from radhar_cli.echo.impulse import impulse_power
from radhar_cli.echo.knots import mean_power
from radhar_cli.echo.paths import PathSource
from radhar_cli.motion.protocol import Motion
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.impulse import Impulse
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.wall import Wall
from radhar_cli.scene.paths import Link, sum_of_paths, trace_people
from radhar_cli.scene.products.knot_rate import KnotRate
from radhar_cli.scene.products.plan import Product
from radhar_cli.scene.scene import Scene


class PowerSource(NamedTuple):
    """Source of P_s.

    Attributes:
        needs: names of the products that it is made from.
        make: function that makes it of those.
    """

    needs: tuple[str, ...]
    make: Callable[..., float]


def power_product(config: Config, of_echo: PowerSource, of_paths: PowerSource) -> Product:
    """Row `signal_power` of a radar.

    Args:
        config: config that says which echo the SNR refers to.
        of_echo: P_s of the simulated echo.
        of_paths: P_s of other paths, which the SNR may refer to.
    """
    source = of_paths if refers_to_other_paths(config) else of_echo
    if source is of_echo and has_nobody(config):
        needs = ("scene", *of_echo.needs, *of_paths.needs)
        source = PowerSource(needs, partial(power_unless_empty, of_echo, of_paths))
    return Product("signal_power", source.needs, source.make, "P_s, for snr_db")


def power_unless_empty(
    of_echo: PowerSource, of_paths: PowerSource, scene: Scene, *products: Any
) -> float:
    """P_s of the simulated echo; in an empty scene that of a person who would stand there.

    Args:
        of_echo: P_s of the simulated echo.
        of_paths: P_s of other paths.
        products: products that `of_echo` needs, then those that `of_paths` needs.
    """
    count = len(of_echo.needs)
    return of_paths.make(*products[count:]) if scene.is_empty else of_echo.make(*products[:count])


def power_at_pulses(paths: PathSource, waveform: Waveform) -> float:
    """P_s of paths: mean over all pulses of sum_i A_i^2, or of half of that for real pulses."""
    if isinstance(waveform, Impulse):
        return impulse_power(paths, waveform)
    return signal_power(paths, waveform)


def power_at_knots(paths: PathSource, waveform: Waveform, rate: KnotRate) -> float:
    """P_s of paths: mean over the pulses of sum_i A_i^2, interpolated between knots."""
    return mean_power(paths, waveform, rate(paths, waveform))


def has_nobody(config: Config) -> bool:
    """Whether a config has scenes in which nobody is."""
    return any(activity.is_nobody for activity in config.chosen_activities)


def needs_other_paths(config: Config) -> bool:
    """Whether the SNR refers to another echo than the simulated one, in some scenes or in all."""
    return refers_to_other_paths(config) or has_nobody(config)


def refers_to_other_paths(config: Config) -> bool:
    """Whether the SNR refers to another echo than the simulated one in every scene.

    It refers to the sample's own person, without the room and without others; in free space also
    without what wall and beam take.
    """
    radar = config.radar
    loses_power = config.wall is not None or isinstance(radar, ArrayRadar) or radar.beam is not None
    room = config.room
    has_others = room.reflectors or config.people or room.faces or room.back_wall_m is not None
    return (config.snr_reference == "free_space" and loses_power) or bool(has_others)


def make_snr_paths(
    scene: Scene,
    motions: tuple[Motion, ...],
    antennas: Antennas,
    wall: Wall | None,
    waveform: Waveform,
    first: Antennas | None = None,
) -> PathSource:
    """Make the paths whose power is P_s: of the sample's own person, straight there and back.

    In an empty scene they are those of a person who would stand there.

    Args:
        scene: scene with its `snr_reference`.
        motions: motions of its people, of which the first counts.
        antennas: antennas between which the paths run.
        wall: wall between, or None; left out in free space, as is the beam.
        first: antennas of the first channel of an array; None where there is one channel.
    """
    if scene.config.snr_reference == "free_space":
        antennas, wall = replace(antennas, aim=None), None
    link = Link(antennas, wall, waveform, first)
    return sum_of_paths(trace_people(scene, motions[:1], link, mirrored=False))
