"""What a receiver of one channel does to an echo: noise, other impairments, and the canceller."""

from collections.abc import Iterator

from radhar_cli.config.data_set import Config
from radhar_cli.config.processing import ProcessingConfig
from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.echo.receiver.noise import WhiteNoise
from radhar_cli.processing.canceller import Canceller
from radhar_cli.radar.waveform import Waveform
from radhar_cli.scene.assembly.processing import canceller_of
from radhar_cli.scene.assembly.receiver import channel_of, impairments_of
from radhar_cli.scene.products.noise import noise_products
from radhar_cli.scene.products.plan import Product
from radhar_cli.scene.products.static_returns import add_static_returns
from radhar_cli.scene.scene import Scene


def receiver_products(config: Config) -> Iterator[Product]:
    """Rows of the canceller, the noise and the other impairments of one receive channel."""
    does = _describe_canceller(config.processing)
    yield Product("canceller", ("scene", "waveform"), make_canceller, does)
    if config.processing.leaves_static:
        needs: tuple[str, ...] = ("receiver", "scene", "waveform", "antennas", "wall")
        does = "of the receiver, and what stands still"
        yield Product("impairments", needs, add_static_returns, does)
    if not config.has_noise:
        yield Product("receiver", (), make_ideal_receiver, "nothing: no noise")
        return
    yield Product("channel", ("scene", "antennas"), channel_of, "whose noise it is")
    yield from noise_products(config, "channel")
    needs = ("scene", "noise", "waveform")
    yield Product("receiver", needs, make_receiver, "noise, interference")


def name_of_impairments(config: Config) -> str:
    """Name of the product with all that is added to the echo of one channel."""
    return "impairments" if config.processing.leaves_static else "receiver"


def make_canceller(scene: Scene, waveform: Waveform) -> Canceller:
    """Make the canceller of static echoes that a scene asks for."""
    return canceller_of(scene.config, waveform.prf)


def make_ideal_receiver() -> tuple[Impairment, ...]:
    """Make a receiver that adds nothing to the echo."""
    return ()


def make_receiver(scene: Scene, noise: WhiteNoise, waveform: Waveform) -> tuple[Impairment, ...]:
    """Make the impairments of a receiver in the order in which they act: white noise first."""
    return (noise, *impairments_of(scene, noise, waveform))


def _describe_canceller(processing: ProcessingConfig) -> str:
    """Describe the canceller that `processing.clutter` names, in one line."""
    match processing.clutter:
        case "difference":
            return "first difference of the pulses"
        case "mean":
            return "the mean of the recording is taken out"
        case "none":
            return "nothing is taken out"
    both_ways = ", both ways" if processing.highpass.zero_phase else ""
    return f"high-pass of order {processing.highpass.order}{both_ways}"
