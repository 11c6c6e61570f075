"""Products of a range gate: which bins each frame shows, and those bins by the direct engine."""

from collections.abc import Iterator
from functools import partial
from operator import methodcaller
from typing import NamedTuple

import numpy as np

from radhar_cli.config.data_set import AnyConfig, Config
from radhar_cli.config.engine import EngineConfig
from radhar_cli.echo.gated import GatedEcho
from radhar_cli.echo.paths import PathSource
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.processing.canceller import Canceller, Fir
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.gate import Gate, around, interval
from radhar_cli.processing.signal import Signal
from radhar_cli.processing.stft import Stft
from radhar_cli.processing.track import Track
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT, Waveform
from radhar_cli.scene.products.direct import compute_echo, receive_measured_echo
from radhar_cli.scene.products.plan import Product
from radhar_cli.scene.products.receiver import name_of_impairments


class NeededBins(NamedTuple):
    """Range bins that are needed at each pulse.

    Attributes:
        first: first bin [M].
        stop: last bin + 1 [M].
    """

    first: Index
    stop: Index


def gate_products(config: AnyConfig) -> Iterator[Product]:
    """Rows of the gate of one channel; none where all bins are summed."""
    if config.processing.range_sum != "gated":
        return
    ranges = methodcaller("range_axis")  # an impulse radar's begins elsewhere
    yield Product("range_axis", ("waveform",), ranges, "ranges of the bins", is_array=True)
    limits = config.processing.gate_m
    if isinstance(limits, tuple):
        nearest, farthest = limits
        make = partial(make_fixed_gate, limits_m=limits)
        does = f"range bins from {nearest:g} to {farthest:g} m"
        yield Product("gate", ("range_axis",), make, does)
    else:
        make = partial(make_gate_around_torso, half_width_m=limits)
        does = f"range bins within {limits:g} m of the torso, frame by frame"
        needs = ("range_axis", "frames", "canceller", "torso_track")
        yield Product("gate", needs, make, does)


def gated_direct_products(config: Config) -> Iterator[Product]:
    """Rows of a gate's bins by the direct engine."""
    find = partial(find_needed_bins, margin=config.processing.savgol.frame)
    needs: tuple[str, ...] = ("gate", "frames", "waveform", "canceller")
    yield Product("gate_needed", needs, find, "its bins that frames show, pulse by pulse")
    make = partial(make_gated_echo, engine=config.engine)
    needs = ("paths", "waveform", "canceller", "gate", "gate_needed")
    yield Product("gated", needs, make, "closed form of them at knots")
    does = "samples and their measured error, of the gate's bins"
    yield Product("gated_echo", ("gated", "scene"), compute_echo, does)
    needs = ("gated_echo", "gated", "canceller", name_of_impairments(config))
    does = "receiver, then canceller, of the gate's bins"
    yield Product("range_signals", needs, receive_measured_echo, does, is_array=True)


def make_fixed_gate(ranges: Float, limits_m: tuple[float, float]) -> Gate:
    """Make a gate of the bins between two ranges, the same for every frame.

    Args:
        ranges: ranges of the bins [K], m.
        limits_m: nearest and farthest range, m.
    """
    return interval(*limits_m, ranges)


def make_gate_around_torso(
    ranges: Float,
    frames: Frames,
    canceller: Canceller,
    torso_track: Float,
    half_width_m: float,
) -> Gate:
    """Make a gate about the range of the torso in the middle of every frame.

    Args:
        ranges: ranges of the bins [K], m.
        frames: windows of the Doppler-time map.
        canceller: canceller, after which frames are counted.
        torso_track: delay of the torso at every pulse [M], s.
        half_width_m: half width of the gate, m.
    """
    starts = frames.starts([slice(0, torso_track.size - canceller.lost)])
    middles = np.rint(starts + (frames.length - 1) / 2 + canceller.delay).astype(np.intp)
    return around(torso_track[middles] * (SPEED_OF_LIGHT / 2), half_width_m, ranges)


def gate_in_windows(
    bins: Signal, frames: Frames, track: Track, gate_m: float | tuple[float, float]
) -> Gate:
    """Make the gate of every window of a signal, which may have gaps.

    Args:
        bins: range bins after the canceller.
        frames: windows of the signal.
        gate_m: half width about the torso, or nearest and farthest range, m.
    """
    assert bins.ranges is not None
    if isinstance(gate_m, tuple):
        return interval(*gate_m, bins.ranges)
    middles = Stft(bins, frames).time.values
    return around(track.range_at(middles), gate_m, bins.ranges)


def find_needed_bins(
    gate: Gate, frames: Frames, waveform: Waveform, canceller: Canceller, margin: int
) -> NeededBins | None:
    """Find the range bins that frames show at each pulse.

    Args:
        gate: range bins that each frame shows.
        frames: windows of the Doppler-time map.
        canceller: canceller before the frames.
        margin: pulses of the filter after it that a frame depends on.

    Returns:
        The bins; None where an output of the canceller depends on all pulses.
    """
    if not isinstance(canceller, Fir):
        return None
    return NeededBins(*gate.needed(frames, waveform.n_pulses, canceller.lost + margin))


def make_gated_echo(
    paths: PathSource,
    waveform: Waveform,
    canceller: Canceller,
    gate: Gate,
    needed: NeededBins | None,
    engine: EngineConfig,
) -> GatedEcho:
    """Make the closed form of the range bins of a gate.

    Args:
        canceller: canceller after which the bins will be seen.
        gate: range bins that frames show.
        needed: bins that are needed at each pulse; None for all at all.
        engine: largest error after the canceller, and the precision of sums.
    """
    return GatedEcho(
        paths,
        waveform,
        engine.tolerance_db,
        engine.is_double,
        canceller,
        gate.bins,
        needed,
        None if needed is None else gate.spans(needed),
    )
