"""Products of the direct engine: the closed form of the echo at knots, for one channel."""

from collections.abc import Iterator
from functools import partial
from operator import attrgetter, methodcaller
from typing import NamedTuple

import numpy as np

from radhar_cli.config.data_set import Config
from radhar_cli.config.engine import EngineConfig
from radhar_cli.echo.accuracy import AccuracyError
from radhar_cli.echo.direct import DirectEcho
from radhar_cli.echo.exact import beat_at, exact_echo
from radhar_cli.echo.paths import PathSource
from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.numerics.arrays import Complex
from radhar_cli.processing.canceller import Canceller, Fir
from radhar_cli.processing.signal import Signal
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.scene.products.fallback import EchoAccuracy, fall_back
from radhar_cli.scene.products.knot_rate import knot_rate_of
from radhar_cli.scene.products.looks import look_at_profiles
from radhar_cli.scene.products.plan import Product
from radhar_cli.scene.products.receiver import name_of_impairments
from radhar_cli.scene.products.signal import receive_echo, signal_of_look
from radhar_cli.scene.products.signal_power import (
    PowerSource,
    power_at_knots,
    power_product,
)
from radhar_cli.scene.scene import Scene


class MeasuredEcho(NamedTuple):
    """A noiseless echo of one channel, and its error.

    Attributes:
        samples: samples x [K, M] of the look of the engine.
        accuracy: measured error of the direct engine, or why the exact one made the samples.
    """

    samples: Complex
    accuracy: EchoAccuracy


def direct_products(config: Config) -> Iterator[Product]:
    """Rows of the direct engine but for the bins of a gate (`gated.py`)."""
    is_gated = config.processing.range_sum == "gated"
    make = partial(make_direct_echo, engine=config.engine)
    needs: tuple[str, ...] = ("paths", "waveform", "canceller")
    yield Product("direct", needs, make, "closed form of the echo at knots")
    does = "samples and their measured error, of the sum over range"
    yield Product("echo", ("direct", "scene"), compute_echo, does)
    does = "slow-time signal without noise"
    yield Product("slow_time", ("echo", "direct"), make_noiseless_signal, does, is_array=True)
    needs = ("echo", "direct", "canceller", name_of_impairments(config))
    does = "receiver, then canceller"
    yield Product("signal", needs, receive_measured_echo, does, is_array=True)
    needs = ("paths", "waveform", "canceller", name_of_impairments(config))
    profiles = partial(compute_profiles, width=config.image.size_px[1])
    does = "range profiles at the pulses that the range-time map shows"
    yield Product("range_profiles", needs, profiles, does, is_array=True)
    yield power_product(  # from the knots that are there anyway
        config,
        PowerSource(("gated" if is_gated else "direct",), methodcaller("signal_power")),
        PowerSource(("snr_paths", "waveform"), partial(power_at_knots, rate=knot_rate_of(config))),
    )
    needs = ("gated_echo" if is_gated else "echo",)
    yield Product("accuracy", needs, attrgetter("accuracy"), "its measured error")


def make_direct_echo(
    paths: PathSource, waveform: Waveform, canceller: Canceller, engine: EngineConfig
) -> DirectEcho:
    """Make the closed form of the sum over range, within a tolerance after the canceller."""
    return DirectEcho(paths, waveform, engine.tolerance_db, engine.is_double, canceller)


def compute_echo(direct: DirectEcho, scene: Scene) -> MeasuredEcho:
    """Compute samples by the direct engine, or exactly where it cannot keep the tolerance.

    Args:
        direct: closed form of the echo.
        scene: scene whose engine says what happens where the tolerance cannot be kept.

    Raises:
        SceneError: it cannot be kept, and such scenes are refused.
    """
    try:
        return MeasuredEcho(*direct.rows())
    except AccuracyError as error:
        fallback = fall_back(scene.config.engine, scene.name, error)
        static = not direct.canceller.removes_static
        return MeasuredEcho(exact_echo(direct.source, [direct.look], static=static)[0], fallback)


def make_noiseless_signal(echo: MeasuredEcho, direct: DirectEcho) -> Signal:
    """Make the signal of an echo before receiver and canceller."""
    return signal_of_look(echo.samples, direct.look)


def receive_measured_echo(
    echo: MeasuredEcho,
    direct: DirectEcho,
    canceller: Canceller,
    receiver: tuple[Impairment, ...],
) -> Signal:
    """Pass an echo of the direct engine through receiver and canceller."""
    return receive_echo(echo.samples, direct.look, receiver, canceller)


def compute_profiles(
    paths: PathSource,
    waveform: Waveform,
    canceller: Canceller,
    receiver: tuple[Impairment, ...],
    width: int,
) -> Signal:
    """Compute the range profiles that a range-time map shows, from exact beats."""
    look = look_at_profiles(waveform, canceller, width)
    if not isinstance(canceller, Fir):
        (x,) = exact_echo(paths, [look], static=not canceller.removes_static)
        return receive_echo(x, look, receiver, canceller).columns(width)
    x = look.fast(beat_at(paths, waveform, np.asarray(look.pulses), look.taps))
    return receive_echo(x, look, receiver)
