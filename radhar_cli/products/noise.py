"""The white noise of a scene: its law, its strength, and the products that every radar shares."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from radhar_cli.assembly.bodies import sources_of, sum_of_paths
from radhar_cli.assembly.physics import noise_stream
from radhar_cli.config.data_set import Config
from radhar_cli.config.number import nominal
from radhar_cli.config.radar import BoardRadar
from radhar_cli.echo.paths import PathSource
from radhar_cli.errors import SceneError
from radhar_cli.motion.protocol import Motion
from radhar_cli.products.plan import Product
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import Waveform
from radhar_cli.receiver.noise import WhiteNoise
from radhar_cli.receiver.noise_law import NoiseLaw, Silent, Snr, Thermal
from radhar_cli.scene import Scene


def noise_law_of(config: Config) -> NoiseLaw:
    """Law of the noise of a config: `snr_db`, or `receiver.noise_figure_db`, or no noise.

    Numbers that are still to be drawn are taken at their middle.
    """
    if config.snr_db is not None:
        return Snr(nominal(config.snr_db))
    figure = config.receiver.noise_figure_db
    if figure is None:
        return Silent()
    return Thermal(nominal(figure), nominal(config.radar.transmit_power_dbm))


def noise_products(config: Config, channel: str | None = None) -> Iterator[Product]:
    """Rows `noise_sigma` and `noise` of the table of products.

    Args:
        config: config that gives the law.
        channel: product that names the channel whose noise it is; None where all channels share a
            stream.
    """
    law = noise_law_of(config)
    needs = ("scene", "waveform", *(("signal_power",) if law.by_signal else ()))
    yield Product("noise_sigma", needs, noise_sigma, f"of a raw sample: {_words(law)}")
    needs = ("scene", "noise_sigma", *((channel,) if channel else ()))
    yield Product("noise", needs, white_noise_of, "white noise")


def noise_sigma(scene: Scene, w: Waveform, signal_power: float = 0.0) -> float:
    """Standard deviation of the noise of a raw sample, for unit transmit power; 0 without noise.

    Args:
        scene: scene that gives the law.
        w: waveform, whose sample rate is the bandwidth of thermal noise.
        signal_power: P_s of a sample, which `snr_db` refers to.

    Raises:
        SceneError: no echo is left that an SNR could refer to.
    """
    try:
        return noise_law_of(scene.config).sigma(signal_power, w.sample_rate)
    except ValueError as error:
        keys = "wall.loss_tangent, radar.carrier_hz, motion.range_m"
        raise SceneError(f"{scene.name}: {error} ({keys}), or should be null") from None


def white_noise_of(scene: Scene, sigma: float, channel: object = "") -> WhiteNoise:
    """Make the white noise of a receive channel of a scene, of standard deviation sigma."""
    return WhiteNoise(sigma, partial(noise_stream, scene, channel=channel))


def snr_of_other_paths(c: Config) -> bool:
    """Whether the SNR refers to another echo than the simulated one.

    It refers to the sample's own person, without the room and without others; in free space also
    without what wall and beam take.
    """
    takes = c.wall is not None or isinstance(c.radar, BoardRadar) or c.radar.beam is not None
    others = c.room.reflectors or c.people or c.room.faces or c.room.back_wall_m is not None
    return (c.snr_reference == "free_space" and takes) or bool(others)


def snr_paths(
    c: Config,
    scene: Scene,
    motions: tuple[Motion, ...],
    antennas: Antennas,
    wall: Wall | None,
    w: Waveform,
    first: Antennas | None = None,
) -> PathSource:
    """Make the paths whose power is P_s: of the sample's own person, straight there and back.

    Args:
        c: config whose `snr_reference` counts.
        scene: what is simulated.
        motions: motions of its people, of which the first counts.
        antennas: antennas between which the paths run.
        wall: wall between, or None; left out in free space, as is the beam.
        w: waveform.
        first: antennas of the first channel of an array, as of `sources_of`.
    """
    if c.snr_reference == "free_space":
        antennas, wall = replace(antennas, aim=None), None
    own = sources_of(scene, motions[:1], antennas, wall, w, mirrored=False, first=first)
    return sum_of_paths(own)


def _words(law: NoiseLaw) -> str:
    if isinstance(law, Snr):
        return "by snr_db"
    return "thermal, by receiver.noise_figure_db" if isinstance(law, Thermal) else "none"
