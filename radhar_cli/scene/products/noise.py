"""The white noise of a scene: its law, its strength, and the products that every radar shares."""

from collections.abc import Iterator
from functools import partial

from radhar_cli.config.data_set import Config
from radhar_cli.echo.receiver.noise import WhiteNoise
from radhar_cli.echo.receiver.noise_law import NoiseLaw, Silent, Snr, Thermal
from radhar_cli.errors import SceneError
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.scene.products.plan import Product
from radhar_cli.scene.scene import Scene
from radhar_cli.schema.number import nominal


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
    does = f"of a raw sample: {_describe_law(law)}"
    yield Product("noise_sigma", needs, compute_noise_sigma, does)
    needs = ("scene", "noise_sigma", *((channel,) if channel else ()))
    yield Product("noise", needs, make_white_noise, "white noise")


def compute_noise_sigma(scene: Scene, waveform: Waveform, signal_power: float = 0.0) -> float:
    """Standard deviation of the noise of a raw sample, for unit transmit power; 0 without noise.

    Args:
        scene: scene that gives the law.
        waveform: waveform, whose sample rate is the bandwidth of thermal noise.
        signal_power: P_s of a sample, which `snr_db` refers to.

    Raises:
        SceneError: no echo is left that an SNR could refer to.
    """
    try:
        return noise_law_of(scene.config).sigma(signal_power, waveform.sample_rate)
    except ValueError as error:
        keys = "wall.loss_tangent, radar.carrier_hz, motion.range_m"
        raise SceneError(f"{scene.name}: {error} ({keys}), or should be null") from None


def make_white_noise(scene: Scene, sigma: float, channel: object = "") -> WhiteNoise:
    """Make the white noise of a receive channel of a scene, of standard deviation sigma."""
    return WhiteNoise(sigma, partial(scene.noise_stream, channel=channel))


def _describe_law(law: NoiseLaw) -> str:
    """Describe a law of noise in a few words."""
    if isinstance(law, Snr):
        return "by snr_db"
    return "thermal, by receiver.noise_figure_db" if isinstance(law, Thermal) else "none"
