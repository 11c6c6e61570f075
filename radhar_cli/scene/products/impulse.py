"""Products of an impulse radar: all signals are made from samples of its range profiles."""

from collections.abc import Iterator
from functools import partial
from math import inf
from operator import methodcaller

from radhar_cli.config.data_set import Config
from radhar_cli.echo.direct import Accuracy
from radhar_cli.echo.impulse import Profiles, impulse_echo
from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.processing.canceller import Canceller
from radhar_cli.processing.look import Look, ProfileSamples
from radhar_cli.processing.signal import Signal
from radhar_cli.radar.impulse import Impulse
from radhar_cli.scene.products.plan import Product
from radhar_cli.scene.products.receiver import name_of_impairments
from radhar_cli.scene.products.signal import receive_echo
from radhar_cli.scene.products.signal_power import PowerSource, power_at_pulses, power_product


def impulse_products(config: Config) -> Iterator[Product]:
    """Rows of an impulse radar."""
    does = "samples over range, a pulse at its delay for every path"
    yield Product("profiles", ("paths", "waveform"), impulse_echo, does, is_array=True)
    yield power_product(
        config,
        PowerSource(("paths", "waveform"), power_at_pulses),
        PowerSource(("snr_paths", "waveform"), power_at_pulses),
    )
    needs = ("profiles", "waveform", "canceller", name_of_impairments(config))
    does = "receiver, then canceller"
    yield Product("range_signals", needs, receive_profiles, does, is_array=True)
    choose = methodcaller("columns", config.image.size_px[1])
    does = "those that the map shows"
    yield Product("range_profiles", ("range_signals",), choose, does, is_array=True)
    does = "their sum over range"
    yield Product("signal", ("range_signals",), Signal.summed, does, is_array=True)
    accuracy = partial(Accuracy, step=1, table_oversampling=0, single=False, error_db=-inf)
    yield Product("accuracy", (), accuracy, "paths at every pulse")


def receive_profiles(
    profiles: Profiles, waveform: Impulse, canceller: Canceller, receiver: tuple[Impairment, ...]
) -> Signal:
    """Pass noiseless range profiles through receiver and canceller.

    Args:
        profiles: samples over range [samples, M].
        waveform: pulses of the radar.
        canceller: canceller of static echoes.
        receiver: impairments.
    """
    look = Look.of_all("profiles", ProfileSamples(waveform))
    return receive_echo(profiles.astype(complex), look, receiver, canceller)
