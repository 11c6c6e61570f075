"""Receiver of one channel: noise, other impairments, and the canceller."""

from collections.abc import Iterator

from radhar_cli.config.data_set import Config
from radhar_cli.config.processing import ProcessingConfig
from radhar_cli.echo.receiver.flicker import FlickerNoise
from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.echo.receiver.interference import InterferenceLine
from radhar_cli.echo.receiver.noise import WhiteNoise
from radhar_cli.processing.canceller import Canceller
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.propagation import Antennas
from radhar_cli.scene.products.noise import noise_products
from radhar_cli.scene.products.plan import Product
from radhar_cli.scene.products.static_returns import add_static_returns
from radhar_cli.scene.radar import antennas_of
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
        yield Product("receiver", (), tuple, "nothing: no noise")
        return
    yield Product("channel", ("scene", "antennas"), name_channel, "whose noise it is")
    yield from noise_products(config, "channel")
    needs = ("scene", "noise", "waveform")
    yield Product("receiver", needs, make_impairments, "noise, interference")


def name_of_impairments(config: Config) -> str:
    """Name of the product with all that is added to the echo of one channel."""
    return "impairments" if config.processing.leaves_static else "receiver"


def make_canceller(scene: Scene, waveform: Waveform) -> Canceller:
    """Make the canceller of static echoes that a scene asks for."""
    return scene.config.processing.make_canceller(waveform.prf)


def name_channel(scene: Scene, antennas: Antennas) -> str:
    """Name a receive channel: "" for the antennas of the config, else the antennas' numbers."""
    if antennas == antennas_of(scene):
        return ""
    numbers = (*antennas.tx, *antennas.rx, antennas.gain, antennas.isolation_db)
    return " ".join(str(float(number)) for number in numbers)


def make_impairments(scene: Scene, noise: WhiteNoise, waveform: Waveform) -> tuple[Impairment, ...]:
    """Make the impairments of a receiver in the order in which they act: white noise first.

    Coloured noise is the channel's own, as white noise is. Interference comes from outside: tones
    are the same in all channels, phases included.
    """
    receiver, impairments = scene.receiver, list[Impairment]([noise])
    if receiver.noise_corner_hz > 0:
        corner, slope = receiver.noise_corner_hz, receiver.noise_slope_db
        impairments.append(FlickerNoise(noise.sigma, noise.stream, corner, slope))
    for number, tone in enumerate(receiver.tones):
        line = noise.sigma * 10 ** (tone.level_db / 20), tone.doppler_hz, waveform
        times, name = (tone.on_s, tone.off_s), f"line {number}"
        impairments.append(
            InterferenceLine(*line, scene.noise_stream, name, *times, tone.both_sides)
        )
    return tuple(impairments)


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
