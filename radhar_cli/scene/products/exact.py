"""Products of the exact engine: all signals are made from raw samples, noise included."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from operator import attrgetter
from typing import NamedTuple

from radhar_cli.config.data_set import Config
from radhar_cli.echo.exact import exact_echo
from radhar_cli.echo.paths import PathSource
from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.processing.canceller import Canceller, Fir
from radhar_cli.processing.gate import Gate
from radhar_cli.processing.look import Look, RangeBins, RangeSum
from radhar_cli.processing.signal import Signal
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.scene.products.looks import look_at_profiles, taps_before_range
from radhar_cli.scene.products.plan import Product
from radhar_cli.scene.products.receiver import name_of_impairments
from radhar_cli.scene.products.signal import signal_of_look
from radhar_cli.scene.products.signal_power import PowerSource, power_at_pulses, power_product


class BeatSignals(NamedTuple):
    """Signals made in one pass through the beat matrix.

    Attributes:
        signal: sum over range after the canceller.
        profiles: range profiles that the range-time map shows, where the canceller has taps; None
            where it needs all pulses of a recording.
    """

    signal: Signal
    profiles: Signal | None


def exact_products(config: Config) -> Iterator[Product]:
    """Rows of the exact engine."""
    of_paths = ("paths", "waveform", "canceller", name_of_impairments(config))
    width, moves = config.image.size_px[1], config.engine.motion_in_chirp
    yield power_product(
        config,
        PowerSource(("paths", "waveform"), power_at_pulses),
        PowerSource(("snr_paths", "waveform"), power_at_pulses),
    )
    compute = partial(compute_beat_signals, width=width, motion_in_chirp=moves)
    does = "the whole beat matrix, cancelled, compressed"
    yield Product("beat_cube", of_paths, compute, does)
    does = "its sum over the kept bins"
    yield Product("signal", ("beat_cube",), attrgetter("signal"), does, is_array=True)
    profiles = partial(choose_profiles, width=width, motion_in_chirp=moves)
    needs = ("beat_cube", *of_paths)
    yield Product("range_profiles", needs, profiles, "its range bins", is_array=True)
    if config.processing.range_sum == "gated":
        bins = partial(compute_gate_bins, motion_in_chirp=moves)
        does = "the beat matrix, compressed, of the gate's bins"
        yield Product("range_signals", ("gate", *of_paths), bins, does, is_array=True)


def compute_exact_signals(
    paths: PathSource,
    canceller: Canceller,
    receiver: tuple[Impairment, ...],
    looks: Sequence[Look],
    motion_in_chirp: bool = False,
) -> list[Signal]:
    """Compute signals after the canceller from raw samples, in one pass.

    Args:
        canceller: canceller; a `Fir` is applied to raw samples, another one to each signal.
        receiver: impairments.
        looks: looks at the echo, one a signal.
        motion_in_chirp: whether paths go on moving during a chirp.
    """
    has_taps = isinstance(canceller, Fir)
    static = has_taps or not canceller.removes_static
    echoes = exact_echo(paths, looks, receiver, static, motion_in_chirp)
    signals = [signal_of_look(x, look) for x, look in zip(echoes, looks, strict=True)]
    return signals if has_taps else [signal.cancelled(canceller) for signal in signals]


def compute_beat_signals(
    paths: PathSource,
    waveform: Waveform,
    canceller: Canceller,
    receiver: tuple[Impairment, ...],
    width: int,
    motion_in_chirp: bool = False,
) -> BeatSignals:
    """Compute the sum over range, and where one pass will do the range profiles, too."""
    looks = [Look.of_all("slow_time", RangeSum(waveform), taps_before_range(canceller))]
    if isinstance(canceller, Fir):
        looks.append(look_at_profiles(waveform, canceller, width))
    signal, *profiles = compute_exact_signals(paths, canceller, receiver, looks, motion_in_chirp)
    return BeatSignals(signal, profiles[0] if profiles else None)


def choose_profiles(
    beat: BeatSignals,
    paths: PathSource,
    waveform: Waveform,
    canceller: Canceller,
    receiver: tuple[Impairment, ...],
    width: int,
    motion_in_chirp: bool = False,
) -> Signal:
    """Choose the range profiles of a beat matrix; computed again where they were not kept."""
    if beat.profiles is not None:
        return beat.profiles
    look = look_at_profiles(waveform, canceller, width)
    (signal,) = compute_exact_signals(paths, canceller, receiver, [look], motion_in_chirp)
    return signal.columns(width)


def compute_gate_bins(
    gate: Gate,
    paths: PathSource,
    waveform: Waveform,
    canceller: Canceller,
    receiver: tuple[Impairment, ...],
    motion_in_chirp: bool = False,
) -> Signal:
    """Compute the range bins of a gate, referred to mid-chirp, at every pulse."""
    bins = RangeBins(replace(waveform, centred=True), gate.bins)
    look = Look.of_all("range_signals", bins, taps_before_range(canceller))
    return compute_exact_signals(paths, canceller, receiver, [look], motion_in_chirp)[0]
