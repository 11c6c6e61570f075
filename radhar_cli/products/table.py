"""The table of products: name, needs and function of all that can be made of a scene.

Order (paper, figure "Signal processing overflow"): canceller -> range compression -> [range-time
map] -> sum over the kept bins -> [compensation] -> [denoising] -> STFT or FSST. With
`processing.range_sum: gated` the sum comes last, over the powers of some bins.

    scene      what is simulated                     paths     delay and amplitude over time
    slow_time  noiseless, before the canceller       signal    what the Doppler maps show
    range_signals  of the gate's bins                range_profiles  what the range-time map shows
    <map>      PowerMap                              image:<map>  MapImage
"""

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from math import inf
from typing import NamedTuple, TypeAlias

import numpy as np

from radhar_cli.assembly.bodies import sources_of, sum_of_paths
from radhar_cli.assembly.physics import (
    antennas_of,
    canceller_of,
    cfar_of,
    channel_of,
    frames_of,
    fsst_frames_of,
    gate_of,
    impairments_of,
    moving,
    reflectors_of,
    wall_of,
    waveform_of,
)
from radhar_cli.bodies.motion_paths import TorsoPath
from radhar_cli.config.data_set import AnyConfig, Config
from radhar_cli.config.maps import MAP_NAMES
from radhar_cli.config.radar import BoardRadar, CwRadar, ImpulseRadar
from radhar_cli.echo.accuracy import AccuracyError, first_aim, settings
from radhar_cli.echo.direct import Accuracy, DirectEcho
from radhar_cli.echo.exact import beat_at, exact_echo, signal_power
from radhar_cli.echo.gated import GatedEcho
from radhar_cli.echo.impulse import impulse_echo, impulse_power
from radhar_cli.echo.knots import delay_track, mean_power
from radhar_cli.echo.paths import PathSource
from radhar_cli.errors import ConfigError, SceneError
from radhar_cli.extensions import own_products
from radhar_cli.motion.protocol import Motion
from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.processing import fsst
from radhar_cli.processing.canceller import Canceller, Fir
from radhar_cli.processing.cfar import CellAveraging, decibels_of
from radhar_cli.processing.denoising import savgol
from radhar_cli.processing.doppler_compensation import compensate
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.gate import Gate
from radhar_cli.processing.image import (
    Reduced,
    binary_exponent,
    levels,
    reduced,
    reduced_map,
    signed_levels,
    unclipped,
)
from radhar_cli.processing.look import Look, ProfileSamples, RangeBins, RangeSum
from radhar_cli.processing.power_map import Axis, MapImage, PowerMap
from radhar_cli.processing.signal import Signal, shown_pulses
from radhar_cli.processing.stft import Stft
from radhar_cli.products.fallback import EchoAccuracy, fall_back
from radhar_cli.products.noise import noise_products, snr_of_other_paths, snr_paths
from radhar_cli.products.plan import Plan, Product, plan
from radhar_cli.radar.impulse import Impulse
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import SPEED_OF_LIGHT, Waveform
from radhar_cli.receiver.impairment import Impairment
from radhar_cli.scene import Scene

SINGLE_RANGE_DB = 70.0  # of images in float32, in which a pixel in 1e5 differs by a level
# In the order in which few are held at once: each follows the one it is made from.
SIGNALS = ("signal", "signal_denoised", "signal_compensated", "signal_compensated_denoised")


def signal_of(map_name: str) -> str:
    """Name of the signal, of SIGNALS, that a Doppler-time map shows."""
    suffix = map_name.partition("_")[2]
    return f"signal_{suffix}" if suffix else "signal"


def plan_images(config: Config) -> Plan:
    """Plan the products of a data set: the image of every map, by signal, and what it stores.

    Raises:
        ConfigError: `output.products` names one that the radar or the engine does not make, or
            that is no array.
    """
    own = {product.name for product in own_products()}
    of_signals = [name for name in config.maps if name in MAP_NAMES and name not in own]
    maps = sorted(of_signals, key=lambda name: SIGNALS.index(signal_of(name)))
    asked = [f"image:{name}" for name in (*maps, *(n for n in config.maps if n not in of_signals))]
    if config.has_error:
        asked.append("accuracy")
    asked += config.stored
    if config.output.slow_time:
        asked.append("signal")
    if config.output.column_labels:
        asked.append("motions")
    table = products(config)
    storable = own | {name for name, product in table.items() if product.is_array}
    wrong = [name for name in config.output.products if name not in storable]
    if wrong:
        names = ", ".join(name for name in table if name in storable)
        right = f"should be arrays that this radar and engine make: {names}"
        raise ConfigError(f"output.products = {json.dumps(wrong)}: {right}")
    return plan(table, asked, ["scene"])


def products(config: Config) -> dict[str, Product]:
    """Collect every product that a scene of a config can have, {name: product}.

    Raises:
        ConfigError: a product of a user's own would replace one that a board does not have.
    """
    if not isinstance(config.radar, BoardRadar):
        echo = _echo(config)
    else:
        from radhar_cli.products.board import board_products  # slow to import

        for own in own_products():
            if own.name in ("antennas", "paths", "receiver"):
                raise ConfigError(
                    f"product {own.name}: has no effect with radar.cfg; should be 'channels' or "
                    "'cube'"
                )
        echo = board_products(config)
    rows = (*_physics(config), *_signals(config), *_maps(config), *echo, *own_products())
    table = {row.name: row for row in rows}
    if isinstance(config.radar, CwRadar) and config.radar.output == "real":
        table["signal_iq"] = replace(table["signal"], name="signal_iq")
        table["signal"] = Product(
            "signal", ("signal_iq",), in_phase, "in-phase channel", is_array=True
        )
    return table


def in_phase(signal: Signal) -> Signal:
    """Signal of a receiver without a quadrature channel: the real part alone."""
    return signal.with_samples(signal.x.real.astype(complex))


def products_of_signals(config: AnyConfig) -> dict[str, Product]:
    """Collect every product that a recorded signal can have, {name: product}."""
    rows = (*_signals(config), *_maps(config), *_gate(config), *own_products())
    return {row.name: row for row in rows}


def _physics(c: Config) -> Iterator[Product]:
    def of_people(
        scene: Scene,
        motions: tuple[Motion, ...],
        antennas: Antennas,
        wall: Wall | None,
        w: Waveform,
    ) -> PathSource:
        return snr_paths(c, scene, motions, antennas, wall, w)

    def torso_track(
        motions: tuple[Motion, ...], antennas: Antennas, wall: Wall | None, w: Waveform
    ) -> Float:
        torso = TorsoPath(motions[0], antennas, wall)
        exact = c.engine.kind != "direct"
        return delay_track(torso, w, inf if exact else _knots_per_second(c, torso, w))

    seen = ("motions", "antennas", "wall", "waveform")
    walled = "through the wall" if c.wall is not None else "through air"
    yield Product("waveform", ("scene",), waveform_of, "chirps and pulses")
    yield Product("antennas", ("scene",), antennas_of, "positions and gains")
    yield Product("wall", ("scene",), wall_of, "the slab, or none")
    yield Product(
        "motions", ("scene",), lambda s: tuple(map(moving, s.people)), "scatterers that move"
    )
    room = ("room",) if c.room.reflectors else ()
    if room:
        yield Product("room", ("scene",), reflectors_of, "what stands in the room")
    parts = f"delay and amplitude of every {c.body.scatterers.removesuffix('s')}, {walled}"
    yield Product("paths", ("scene", *seen, *room), lambda *g: sum_of_paths(sources_of(*g)), parts)
    if snr_of_other_paths(c):
        yield Product("snr_paths", ("scene", *seen), of_people, "paths of people, for the SNR")
    yield Product(
        "torso_track", seen, torso_track, "delay of the torso at every pulse", is_array=True
    )


def _knots_per_second(c: Config, source: PathSource, w: Waveform) -> float:
    """Knots per second at which positions are evaluated: the echo's, or inf for every pulse.

    Every pulse is evaluated where a wide band needs knots closer than the echo's.
    """
    chosen = settings(first_aim(c.engine.tolerance_db), w, source.highest_frequency)
    per_second, least = chosen.spacing.per_second, (GatedEcho if _gated(c) else DirectEcho).min_step
    return per_second if w.prf >= least * per_second else inf


def _echo(c: Config) -> Iterator[Product]:
    yield Product("canceller", ("waveform",), lambda w: canceller_of(c, w.prf), _clutter(c))
    yield from _receiver(c)
    yield from _gate(c)
    if isinstance(c.radar, ImpulseRadar):
        yield from _impulse(c)
    else:
        yield from _direct(c) if c.engine.kind == "direct" else _exact(c)


def _gated(c: AnyConfig) -> bool:
    return c.processing.range_sum == "gated"


def _clutter(c: Config) -> str:
    kind, highpass = c.processing.clutter, c.processing.highpass
    if kind != "highpass":
        return {
            "difference": "first difference of the pulses",
            "mean": "the mean of the recording is taken out",
            "none": "nothing is taken out",
        }[kind]
    return f"high-pass of order {highpass.order}{', both ways' if highpass.zero_phase else ''}"


def _receiver(c: Config) -> Iterator[Product]:
    if not c.has_noise:
        yield Product("receiver", (), tuple, "nothing: no noise")
        return
    yield Product("channel", ("scene", "antennas"), channel_of, "whose noise it is")
    yield from noise_products(c, "channel")
    yield Product(
        "receiver",
        ("scene", "noise", "waveform"),
        lambda s, n, w: (n, *impairments_of(s, n, w)),
        "noise, interference",
    )


ECHO_NEEDS = ("paths", "waveform", "canceller", "receiver")  # of signals made from paths


def signal_of_look(x: Complex, look: Look) -> Signal:
    """Make the signal of one channel of what a look shows.

    Args:
        x: samples [K, M]: K range bins, or one sum over range, at M pulses.
        look: pulses, taps and range axis of the samples; times are in the middle of the taps.
    """
    w, later = look.fast.waveform, (len(look.taps) - 1) / 2
    times = PulseTimes.even(look.count, w.prf, later / w.prf)
    if not isinstance(look.pulses, range):
        each = (look.pulses + later) / w.prf
        times = PulseTimes(each, np.arange(look.count), look.count, w.prf)
    if not isinstance(look.fast, RangeBins):
        return Signal(x[None], times, w.f0)
    bins = look.fast.bins or slice(0, w.n_bins)
    return Signal(x[None], times, w.f0, w.range_axis()[bins], bins.start, w.range_step)


def received(
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


def _exact_signals(
    c: Config,
    paths: PathSource,
    canceller: Canceller,
    receiver: tuple[Impairment, ...],
    looks: list[Look],
) -> list[Signal]:
    """Signals after the canceller from raw samples, in one pass; a `Fir` is applied to those."""
    fir = isinstance(canceller, Fir)
    static = fir or not canceller.removes_static
    echoes = exact_echo(paths, looks, receiver, static, c.engine.motion_in_chirp)
    signals = [signal_of_look(x, look) for x, look in zip(echoes, looks, strict=True)]
    return signals if fir else [signal.cancelled(canceller) for signal in signals]


def _taps(canceller: Canceller) -> tuple[float, ...]:
    """Taps of a canceller that acts before W; (1,) for one that acts on the whole recording."""
    return canceller.taps if isinstance(canceller, Fir) else (1.0,)


def _profile_look(c: Config, w: Waveform, canceller: Canceller) -> Look:
    """Look at the pulses that a range-time map shows, after a `Fir`; at all before another one."""
    if not isinstance(canceller, Fir):
        return Look.of_all("range_signals", RangeBins(w), spans=[slice(0, w.n_pulses)] * w.n_bins)
    shown = shown_pulses(w.n_pulses - canceller.lost, c.image.size_px[1])
    from_start = replace(w, centred=False)  # of which the power is the same, for a product less
    return Look("range_profiles", RangeBins(from_start), shown, canceller.taps)


def _direct(c: Config) -> Iterator[Product]:
    engine, width = c.engine, c.image.size_px[1]

    def direct(source: PathSource, w: Waveform, canceller: Canceller) -> DirectEcho:
        double = engine.precision == "double"
        return DirectEcho(source, w, engine.tolerance_db, double, canceller)

    def power(source: PathSource, w: Waveform) -> float:
        return mean_power(source, w, _knots_per_second(c, source, w))

    def signal(
        echo: tuple[Complex, EchoAccuracy],
        made_by: DirectEcho,
        canceller: Canceller,
        receiver: tuple[Impairment, ...],
    ) -> Signal:
        return received(echo[0], made_by.look, receiver, canceller)

    def range_profiles(
        paths: PathSource, w: Waveform, canceller: Canceller, receiver: tuple[Impairment, ...]
    ) -> Signal:
        look = _profile_look(c, w, canceller)
        if not isinstance(canceller, Fir):
            (x,) = exact_echo(paths, [look], static=not canceller.removes_static)
            return received(x, look, receiver, canceller).columns(width)
        x = look.fast(beat_at(paths, w, np.asarray(look.pulses), look.taps))
        return received(x, look, receiver)

    yield Product("direct", ECHO_NEEDS[:3], direct, "closed form of the echo at knots")
    does = "samples and their measured error, of the sum over range"
    yield Product("echo", ("direct", "scene"), partial(_echo_of, c), does)
    yield Product(
        "slow_time",
        ("echo", "direct"),
        lambda echo, direct: signal_of_look(echo[0], direct.look),
        "slow-time signal without noise",
        is_array=True,
    )
    needs = ("echo", "direct", "canceller", "receiver")
    yield Product("signal", needs, signal, "receiver, then canceller", is_array=True)
    does = "range profiles at the pulses that the range-time map shows"
    yield Product("range_profiles", ECHO_NEEDS, range_profiles, does, is_array=True)
    engine_row = "gated" if _gated(c) else "direct"  # from the knots that are there anyway
    if snr_of_other_paths(c):
        yield Product("signal_power", ("snr_paths", "waveform"), power, "P_s, for snr_db")
    else:
        yield Product("signal_power", (engine_row,), DirectEcho.signal_power, "P_s, for snr_db")
    echo_row = "gated_echo" if _gated(c) else "echo"
    yield Product("accuracy", (echo_row,), lambda echo: echo[1], "its measured error")
    if not _gated(c):
        return

    def needed(
        gate: Gate, frames: Frames, w: Waveform, canceller: Canceller
    ) -> tuple[Index, Index] | None:
        if not isinstance(canceller, Fir):
            return None
        return gate.needed(frames, w.n_pulses, canceller.lost + c.processing.savgol.frame)

    def gated(
        paths: PathSource,
        w: Waveform,
        canceller: Canceller,
        gate: Gate,
        needed: tuple[Index, Index] | None,
    ) -> GatedEcho:
        double, spans = engine.precision == "double", None if needed is None else gate.spans(needed)
        tolerance = engine.tolerance_db
        return GatedEcho(paths, w, tolerance, double, canceller, gate.bins, needed, spans)

    of_frames = ("gate", "frames", "waveform", "canceller")
    yield Product("gate_needed", of_frames, needed, "its bins that frames show, pulse by pulse")
    of_gate = (*ECHO_NEEDS[:3], "gate", "gate_needed")
    yield Product("gated", of_gate, gated, "closed form of them at knots")
    needs = ("gated_echo", "gated", "canceller", "receiver")
    does = "samples and their measured error, of the gate's bins"
    yield Product("gated_echo", ("gated", "scene"), partial(_echo_of, c), does)
    yield Product(
        "range_signals",
        needs,
        signal,
        "receiver, then canceller, of the gate's bins",
        is_array=True,
    )


def _echo_of(c: Config, echo: DirectEcho, scene: Scene) -> tuple[Complex, EchoAccuracy]:
    """Samples x [K, M] of the direct engine and their error, or of the exact engine and why.

    Raises:
        SceneError: the direct engine cannot keep the tolerance, and `engine.fallback` is refuse.
    """
    try:
        return echo.rows()
    except AccuracyError as error:
        fallback = fall_back(c, scene, error)
        static = not echo.canceller.removes_static
        return exact_echo(echo.source, [echo.look], static=static)[0], fallback


def _exact(c: Config) -> Iterator[Product]:
    """Rows of the exact engine: all signals are made from raw samples, noise included."""

    def beat_cube(
        paths: PathSource, w: Waveform, canceller: Canceller, receiver: tuple[Impairment, ...]
    ) -> list[Signal]:
        looks = [Look.of_all("slow_time", RangeSum(w), _taps(canceller))]
        if isinstance(canceller, Fir):
            looks.append(_profile_look(c, w, canceller))
        return _exact_signals(c, paths, canceller, receiver, looks)

    def range_profiles(
        signals: list[Signal],
        paths: PathSource,
        w: Waveform,
        canceller: Canceller,
        receiver: tuple[Impairment, ...],
    ) -> Signal:
        if len(signals) > 1:
            return signals[1]
        look = _profile_look(c, w, canceller)
        (signal,) = _exact_signals(c, paths, canceller, receiver, [look])
        return signal.columns(c.image.size_px[1])

    def range_signals(
        gate: Gate,
        paths: PathSource,
        w: Waveform,
        canceller: Canceller,
        receiver: tuple[Impairment, ...],
    ) -> Signal:
        bins = RangeBins(replace(w, centred=True), gate.bins)
        look = Look.of_all("range_signals", bins, _taps(canceller))
        return _exact_signals(c, paths, canceller, receiver, [look])[0]

    power_of = "snr_paths" if snr_of_other_paths(c) else "paths"
    yield Product("signal_power", (power_of, "waveform"), signal_power, "P_s, for snr_db")
    does = "the whole beat matrix, cancelled, compressed"
    yield Product("beat_cube", ECHO_NEEDS, beat_cube, does)
    yield Product(
        "signal",
        ("beat_cube",),
        lambda signals: signals[0],
        "its sum over the kept bins",
        is_array=True,
    )
    yield Product(
        "range_profiles",
        ("beat_cube", *ECHO_NEEDS),
        range_profiles,
        "its range bins",
        is_array=True,
    )
    if _gated(c):
        does = "the beat matrix, compressed, of the gate's bins"
        yield Product("range_signals", ("gate", *ECHO_NEEDS), range_signals, does, is_array=True)


def _impulse(c: Config) -> Iterator[Product]:
    """Rows of an impulse radar: all signals are made from samples of its profiles."""

    def signal(
        r: Float, w: Impulse, canceller: Canceller, receiver: tuple[Impairment, ...]
    ) -> Signal:
        look = Look.of_all("profiles", ProfileSamples(w))
        return received(r.astype(complex), look, receiver, canceller)

    power_of = "snr_paths" if snr_of_other_paths(c) else "paths"
    does = "real samples over range, a pulse at its delay for every path"
    yield Product("profiles", ("paths", "waveform"), impulse_echo, does, is_array=True)
    yield Product("signal_power", (power_of, "waveform"), impulse_power, "P_s, for snr_db")
    needs = ("profiles", "waveform", "canceller", "receiver")
    yield Product("range_signals", needs, signal, "receiver, then canceller", is_array=True)
    profiles = lambda x: x.columns(c.image.size_px[1])  # noqa: E731
    yield Product(
        "range_profiles", ("range_signals",), profiles, "those that the map shows", is_array=True
    )
    yield Product(
        "signal", ("range_signals",), Signal.summed, "their sum over range", is_array=True
    )
    yield Product("accuracy", (), lambda: Accuracy(1, 0, False, -inf), "paths at every pulse")


def _signals(c: AnyConfig) -> Iterator[Product]:
    def compensated(x: Signal, torso_track: Float) -> Signal:
        return x.with_samples(compensate(x.x, torso_track, x.f0))

    def denoised(x: Signal) -> Signal:
        given = c.processing.savgol
        smooth = partial(savgol, order=given.order, frame=given.frame)
        parts = [np.apply_along_axis(smooth, -1, x.x[..., part]) for part in x.times.slices]
        return x.with_samples(parts[0] if len(parts) == 1 else np.concatenate(parts, axis=-1))

    for raw in ("signal", *(["range_signals"] if _gated(c) else [])):
        smooth = "Savitzky-Golay filter"
        yield Product(f"{raw}_denoised", (raw,), denoised, smooth, is_array=True)
        yield Product(
            f"{raw}_compensated",
            (raw, "torso_track"),
            compensated,
            "bulk Doppler compensation",
            is_array=True,
        )
        yield Product(
            f"{raw}_compensated_denoised", (f"{raw}_compensated",), denoised, smooth, is_array=True
        )


def _gate(c: AnyConfig) -> Iterator[Product]:
    within = c.processing.gate_m

    def gate(ranges: Float, frames: Frames, canceller: Canceller, torso_track: Float) -> Gate:
        starts = frames.starts([slice(0, torso_track.size - canceller.lost)])
        middle = np.rint(starts + (frames.length - 1) / 2 + canceller.delay).astype(np.intp)
        return gate_of(c, ranges, torso_track[middle] * (SPEED_OF_LIGHT / 2))

    if not _gated(c):
        return
    ranges = lambda w: w.range_axis()  # noqa: E731 - an impulse radar's begins elsewhere
    yield Product("range_axis", ("waveform",), ranges, "ranges of the bins", is_array=True)
    if isinstance(within, tuple):
        place = f"range bins from {within[0]:g} to {within[1]:g} m"
        yield Product("gate", ("range_axis",), lambda ranges: gate_of(c, ranges, None), place)
    else:
        place = f"range bins within {within:g} m of the torso, frame by frame"
        needs = ("range_axis", "frames", "canceller", "torso_track")
        yield Product("gate", needs, gate, place)


def _maps(c: AnyConfig) -> Iterator[Product]:
    size, masks = c.image.size_px, ("cfar",) if c.image.kind == "cfar" else ()

    def rtm(profiles: Signal) -> PowerMap:
        x, ranges, gain = profiles.x, profiles.ranges, c.processing.range_gain_power
        assert ranges is not None
        if gain > 0 and ranges[-1] > 0:  # of the one bin at range 0 it is 1
            x = x * ((ranges / ranges[-1]) ** gain)[:, None]
        power = (x.real**2 + x.imag**2).sum(axis=0)
        real = x[0].real if c.image.kind == "signed" else None
        rows = Axis("range", "m", ranges, profiles.range_step)
        return PowerMap(power, rows, Axis("time", "s", profiles.t, 1 / profiles.prf), real)

    def map_image(power_map: PowerMap, cfar: CellAveraging | None = None) -> MapImage:
        if power_map.real is not None:
            grey = signed_levels(power_map.real, size, c.image.clipped)
            return MapImage(grey, power_map.entropy, power_map.extent)
        small = partial(reduced_map, power_map.power, size)
        return _image(c, cfar, small, power_map.extent, binary_exponent(power_map.power))

    yield Product("rtm", ("range_profiles",), rtm, "power of the range profiles", is_array=True)
    if masks:
        yield Product("cfar", ("scene",), lambda s: cfar_of(s.config), "threshold of the masks")
    for name in ("rtm", *(product.name for product in own_products())):
        yield Product(f"image:{name}", (name, *masks), map_image, f"its {_shape(c)}")
    for name, of in ("frames", frames_of), ("fsst_frames", fsst_frames_of):
        make = lambda w, of=of: of(c, w.duration, w.prf, w.f0)  # noqa: E731
        yield Product(name, ("waveform",), make, f"of the {'FSST' if 'fsst' in name else 'STFT'}")
    for signal in SIGNALS:
        yield from _doppler_maps(c, signal)


class DopplerPower(NamedTuple):
    """Power of a Doppler-time map in blocks, in units of 2^(2 exponent), and its axes.

    Attributes:
        blocks: blocks [columns, rows] in the order of time, for one pass.
    """

    blocks: Iterator[Float]
    exponent: int
    rows: Axis
    columns: Axis


def _doppler_maps(c: AnyConfig, signal: str) -> Iterator[Product]:
    """Rows of the STFT and FSST of a signal, in float64, and of their images, from float32."""
    suffix = signal.removeprefix("signal")
    masks = ("cfar",) if c.image.kind == "cfar" else ()
    # A mask compares cells with their neighbours, down to the noise, if there is any.
    shallow = c.has_noise if masks else c.image.dynamic_range_db <= SINGLE_RANGE_DB
    shallow = shallow and not c.output.power
    kinds: dict[str, tuple[tuple[str, ...], str]]
    kinds = {"stft": ((signal, "frames"), "STFT"), "fsst": ((signal, "fsst_frames"), "FSST")}
    if _gated(c):
        summed = "magnitudes" if c.processing.gate_sum == "magnitude" else "powers"
        from_bins = (f"range_signals{suffix}", "frames", "gate")
        kinds = {"stft": (from_bins, f"STFTs, {summed} summed over the gate")}
    for kind, (needs, does) in kinds.items():
        power = partial(_doppler_power, c, kind)
        single = c.engine.precision == "auto" and shallow
        image = partial(_doppler_image, c, power, single)
        yield Product(
            kind + suffix,
            needs,
            partial(_doppler_map, power),
            f"power of the {does}",
            is_array=True,
        )
        yield Product(
            f"image:{kind}{suffix}",
            (*masks, *needs),
            image if masks else partial(image, None),
            f"power of the {does}{', in float32' * single}; its {_shape(c)}",
        )


MakePower: TypeAlias = Callable[..., DopplerPower]


def _doppler_power(
    c: AnyConfig, kind: str, single: bool, x: Signal, frames: Frames, gate: Gate | None = None
) -> DopplerPower:
    """Compute the power at the bins whose middle lies within `image.doppler_limits_mps`.

    Args:
        c: limits, FFT length and thresholds.
        kind: stft or fsst.
        single: whether it is computed in float32.
        x: signal.
        frames: windows.
        gate: range bins of each window whose powers are summed; None for all of the signal.
    """
    bins = c.processing.stft_fft_length if kind == "stft" else None
    of_stft = single and kind == "stft"
    stft = Stft(x, frames, bins, of_stft, gate, c.processing.gate_sum == "magnitude")
    power = stft.power_blocks()
    if kind == "fsst":
        power = fsst.power_blocks(stft, c.processing.fsst_threshold, single)
    kept, frequency = slice(None), stft.frequency
    if c.image.doppler_limits_mps is not None:
        limits = np.array(c.image.doppler_limits_mps) * 2 * x.f0 / SPEED_OF_LIGHT
        limits += 1e-9 * np.array([-1, 1]) * x.prf
        kept = slice(*np.searchsorted(frequency.values, limits).tolist())
    rows = replace(frequency, values=frequency.values[kept])
    return DopplerPower((block[:, kept] for block in power), stft.exponent, rows, stft.time)


def _shape(c: AnyConfig) -> str:
    return f"{'CFAR mask' if c.image.kind == 'cfar' else 'image'} and entropy"


def image_of(config: AnyConfig, power_map: PowerMap) -> MapImage:
    """Make the image of a measured map as a data set has it; masks by numbers at their middle."""
    cfar = cfar_of(config) if config.image.kind == "cfar" else None
    small = partial(reduced_map, power_map.power, config.image.size_px)
    return _image(config, cfar, small, power_map.extent, binary_exponent(power_map.power))


def _image(
    c: AnyConfig,
    cfar: CellAveraging | None,
    resize: Callable[[Callable[[Float], Float] | None], Reduced],
    extent: tuple[float, float, float, float],
    exponent: int,
) -> MapImage:
    """Make the image of a map from its resized power, with its decibels where they are stored.

    Args:
        c: what pixels show, and whether unclipped decibels are stored.
        cfar: threshold of masks; None for grey levels.
        resize: resizes a function of the power, or for None the power itself.
        extent: edges of the map, (left, right, low, high).
        exponent: the power is in units of 2^exponent.
    """
    masks_decibels = cfar is not None and cfar.decibel
    small = resize(decibels_of if masks_decibels else None)
    grey = cfar.levels(small.cells) if cfar else levels(small.cells, c.image.dynamic_range_db)
    image = MapImage(grey, small.entropy, extent)
    if c.output.power is None:
        return image
    power = resize(None).cells if masks_decibels else small.cells
    stored, largest_db = unclipped(power, exponent)
    return replace(image, decibels=stored, largest_db=largest_db)


def _doppler_map(make: MakePower, x: Signal, frames: Frames, gate: Gate | None = None) -> PowerMap:
    doppler = make(False, x, frames, gate)
    power = np.concatenate(list(doppler.blocks), dtype=float)
    np.ldexp(power, 2 * doppler.exponent, out=power)
    return PowerMap(power.T, doppler.rows, doppler.columns)


def _doppler_image(
    c: AnyConfig,
    make: MakePower,
    single: bool,
    cfar: CellAveraging | None,
    x: Signal,
    frames: Frames,
    gate: Gate | None = None,
) -> MapImage:
    doppler = make(single, x, frames, gate)

    def passes_over_blocks() -> Iterator[Iterator[Float]]:
        yield doppler.blocks
        while True:
            yield make(single, x, frames, gate).blocks

    passes = passes_over_blocks()

    def small(of: Callable[[Float], Float] | None) -> Reduced:
        return reduced(next(passes), doppler.columns.values.size, c.image.size_px, of)

    extent = (*doppler.columns.edges, *doppler.rows.edges)
    return _image(c, cfar, small, extent, 2 * doppler.exponent)
