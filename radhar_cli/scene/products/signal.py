"""Signals of what a radar receives: an echo through receiver and canceller, and its treatments."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.errors import SceneError
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.canceller import Canceller, Fir
from radhar_cli.processing.denoising import savgol
from radhar_cli.processing.doppler_compensation import compensate
from radhar_cli.processing.look import Look, RangeBins
from radhar_cli.processing.map_kind import TREATMENTS, UNTREATED, Treatment
from radhar_cli.processing.signal import Signal
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.scene.products.plan import Product


def signal_name(treatment: Treatment = UNTREATED) -> str:
    """Name of the product that Doppler-time maps of a treatment show."""
    return f"signal{treatment.suffix}"


def bins_name(treatment: Treatment = UNTREATED) -> str:
    """Name of the product of a gate's range bins after a treatment."""
    return f"range_signals{treatment.suffix}"


# In the order in which few are held at once: each follows the one it is made from.
SIGNALS = tuple(map(signal_name, TREATMENTS))


def treatment_products(config: AnyConfig) -> Iterator[Product]:
    """Rows of the treated signals, and of the range bins of a gate."""
    filter_ = config.processing.savgol
    smooth = partial(smooth_signal, order=filter_.order, frame=filter_.frame)
    raw_and_smooth, compensated = "Savitzky-Golay filter", "bulk Doppler compensation"
    is_gated = config.processing.range_sum == "gated"
    for name in (signal_name, bins_name) if is_gated else (signal_name,):
        denoised_only, compensated_only = Treatment(denoised=True), Treatment(compensated=True)
        both = Treatment(compensated=True, denoised=True)
        yield Product(name(denoised_only), (name(),), smooth, raw_and_smooth, is_array=True)
        yield Product(
            name(compensated_only),
            (name(), "torso_track"),
            compensate_torso,
            compensated,
            is_array=True,
        )
        yield Product(name(both), (name(compensated_only),), smooth, raw_and_smooth, is_array=True)


def signal_of_look(x: Complex, look: Look) -> Signal:
    """Make the signal of one channel that a look shows.

    Args:
        x: samples [K, M]: K range bins, or one sum over range, at M pulses.
        look: pulses, taps and range axis of the samples; times are in the middle of the taps.
    """
    w = look.fast.waveform
    later = (len(look.taps) - 1) / 2
    if isinstance(look.pulses, range):
        times = PulseTimes.even(look.count, w.prf, later / w.prf)
    else:
        each = (look.pulses + later) / w.prf
        times = PulseTimes(each, np.arange(look.count), look.count, w.prf)
    if not isinstance(look.fast, RangeBins):
        return Signal(x[None], times, w.f0)
    bins = look.fast.bins or slice(0, w.n_bins)
    return Signal(x[None], times, w.f0, w.range_axis()[bins], bins.start, w.range_step)


def receive_echo(
    x: Complex, look: Look, receiver: tuple[Impairment, ...], canceller: Canceller | None = None
) -> Signal:
    """Pass an echo through the receiver and the canceller, as one look shows it.

    Args:
        x: noiseless samples [K, M].
        look: pulses, taps and range axis of the samples.
        receiver: impairments that are added, in this order.
        canceller: canceller after them; None where the look has its taps.

    Raises:
        SceneError: an impairment is not additive, so that raw samples would be needed.
    """
    for impairment in receiver:
        if not impairment.additive:
            raise SceneError(
                f"{type(impairment).__name__}: is not additive, which engine.kind: direct needs; "
                "should be engine.kind: cube"
            )
        x = impairment.apply(x, look)
    signal = signal_of_look(x, look)
    spans = look.spans if isinstance(canceller, Fir) else None  # others see all pulses
    return signal if canceller is None else signal.cancelled(canceller, spans)


def keep_in_phase(signal: Signal) -> Signal:
    """Keep the real part of a signal, as a receiver without a quadrature channel does."""
    return signal.with_samples(signal.x.real.astype(complex))


def compensate_torso(signal: Signal, torso_track: Float) -> Signal:
    """Take the bulk Doppler of the torso out of a signal.

    Args:
        signal: signal [channel, row, pulse].
        torso_track: delay of the torso at every pulse [M], s.
    """
    return signal.with_samples(compensate(signal.x, torso_track, signal.f0))


def smooth_signal(signal: Signal, order: int, frame: int) -> Signal:
    """Smooth every row of a signal by a Savitzky-Golay filter, stretch by stretch.

    Args:
        signal: signal [channel, row, pulse].
        order: order of the polynomials.
        frame: number of pulses that each is fitted to.
    """
    smooth = partial(savgol, order=order, frame=frame)
    parts = [np.apply_along_axis(smooth, -1, signal.x[..., part]) for part in signal.times.slices]
    return signal.with_samples(parts[0] if len(parts) == 1 else np.concatenate(parts, axis=-1))
