"""The table of products: name, needs and function of all that can be made of a scene.

Order (paper, figure "Signal processing overflow"): canceller -> range compression -> [range-time
map] -> sum over the kept bins -> [compensation] -> [denoising] -> STFT or FSST. With
`processing.range_sum: gated` the sum comes last, over the powers of some bins.

    scene      what is simulated                     paths     delay and amplitude over time
    slow_time  y[m], noiseless, before the canceller signal    x[m], what the Doppler maps show
    range_signals  those of the gate's bins
    <map>      PowerMap                              image:<map>  MapImage
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import chain, repeat
from math import ceil, inf
from typing import Any, NamedTuple, TypeAlias, TypeVar

import numpy as np

from radhar_cli.arrays import Complex, Float, Index
from radhar_cli.config.schema import MAX_TOLERANCE_DB, Config
from radhar_cli.echo import cube
from radhar_cli.echo.accuracy import AccuracyError
from radhar_cli.echo.direct import Accuracy, DirectEcho
from radhar_cli.echo.gated import GatedEcho
from radhar_cli.echo.knots import mean_power
from radhar_cli.echo.paths import PathSource
from radhar_cli.echo.range_profiles import beat_at, shown_pulses
from radhar_cli.errors import SceneError
from radhar_cli.motion.protocol import Motion
from radhar_cli.phasor import unit_phasor
from radhar_cli.pipeline.bodies import paths_of
from radhar_cli.pipeline.motion_paths import point_delay
from radhar_cli.pipeline.physics import (
    antennas_of,
    canceller_of,
    cfar_of,
    channel_of,
    frames_of,
    fsst_frames_of,
    gate_of,
    impairments_of,
    motion_of,
    noise_stream,
    reflectors_of,
    wall_of,
    waveform_of,
)
from radhar_cli.pipeline.plan import Plan, Product, plan
from radhar_cli.processing import fsst, stft
from radhar_cli.processing.canceller import NO_CANCELLER, Canceller, Fir
from radhar_cli.processing.cfar import CellAveraging, decibels_of
from radhar_cli.processing.denoising import savgol
from radhar_cli.processing.doppler_compensation import compensate
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.gate import Gate, GatedPower
from radhar_cli.processing.image import (
    Reduced,
    binary_exponent,
    levels,
    reduced,
    reduced_map,
    unclipped,
)
from radhar_cli.processing.power_map import Axis, MapImage, PowerMap
from radhar_cli.processing.range_compression import (
    half_band_signal,
    range_bins,
    range_compression,
    range_power,
)
from radhar_cli.processing.range_signals import RangeSignals
from radhar_cli.processing.signal import Signal
from radhar_cli.processing.stft import Spectra
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import SPEED_OF_LIGHT, Waveform
from radhar_cli.receiver.impairment import Impairment
from radhar_cli.receiver.noise import WhiteNoise, noise_variance
from radhar_cli.scene import Scene

CHUNK = 2**18  # pulses per chunk of pulse-by-pulse work
SMALLEST_POWER = float(np.finfo(float).tiny)  # below it squares lose their digits, or are 0
SINGLE_RANGE_DB = 70.0  # of images in float32, in which a pixel in 1e5 differs by a level
# In the order in which few are held at once: each follows the one it is made from.
SIGNALS = ("signal", "signal_denoised", "signal_compensated", "signal_compensated_denoised")


class Fallback(NamedTuple):
    """The cube made the echo instead of the direct engine; says why."""

    reason: str


EchoAccuracy: TypeAlias = Accuracy | Fallback


class RangeProfiles(NamedTuple):
    """Range bins [N_FFT/2, some M] after the canceller, and the first pulse of each column."""

    bins: Complex
    pulses: Index


def signal_of(map_name: str) -> str:
    """Which of SIGNALS a Doppler-time map shows."""
    suffix = map_name.partition("_")[2]
    return f"signal_{suffix}" if suffix else "signal"


def plan_images(config: Config, entropy: bool = True) -> Plan:
    """The plan of a data set: the image of every map, those of one signal together.

    Args:
        config: of the data set.
        entropy: whether the maps' entropies are asked for.
    """
    maps = sorted(config.maps, key=lambda name: SIGNALS.index(signal_of(name)))
    asked = [f"image:{name}" for name in maps]
    if config.engine.kind == "direct" and set(maps) - {"rtm"}:
        asked.append("accuracy")
    if config.output.slow_time:
        asked.append("signal")
    if config.output.column_labels:
        asked.append("motions")
    return plan(products(config, entropy), asked, ["scene"])


def products(config: Config, entropy: bool = True) -> dict[str, Product]:
    """Every product there could be under a config, by name; images with or without entropy."""
    rows = (*_physics(config), *_echo(config), *_signals(config), *_maps(config, entropy))
    if _gated(config):
        rows = (*rows, *_gate(config))
    return {row.name: row for row in rows}


def _physics(c: Config) -> Iterator[Product]:
    def of_people(
        scene: Scene,
        motions: tuple[Motion, ...],
        antennas: Antennas,
        wall: Wall | None,
        w: Waveform,
    ) -> PathSource:
        through = None if c.snr_reference == "free_space" else wall
        return paths_of(scene, motions, antennas, through, w, mirrored=False)

    def torso_track(
        motions: tuple[Motion, ...], antennas: Antennas, wall: Wall | None, w: Waveform
    ) -> Float:
        track = np.empty(w.n_pulses)
        for first in range(0, track.size, CHUNK):
            t = w.times(np.arange(first, min(first + CHUNK, track.size), dtype=float))
            track[first : first + CHUNK] = point_delay(motions[0].torso(t), antennas, wall)[0]
        return track

    seen = ("motions", "antennas", "wall", "waveform")
    walled = "through the wall" if c.wall is not None else "through air"
    yield Product("waveform", ("scene",), lambda s: waveform_of(s.config), "chirps and pulses")
    yield Product("antennas", ("scene",), lambda s: antennas_of(s.config), "positions and gains")
    yield Product("wall", ("scene",), lambda s: wall_of(s.config), "the slab, or none")
    yield Product("motions", ("scene",), lambda s: (motion_of(s),), "scatterers that move")
    room = ("room",) if c.room.reflectors else ()
    if room:
        yield Product("room", ("scene",), reflectors_of, "what stands in the room")
    parts = f"delay and amplitude of every {c.body.scatterers.removesuffix('s')}, {walled}"
    yield Product("paths", ("scene", *seen, *room), paths_of, parts)
    if _snr_of_other_paths(c):
        yield Product("snr_paths", ("scene", *seen), of_people, "paths of people, for the SNR")
    yield Product("torso_track", seen, torso_track, "delay of the torso at every pulse")


def _snr_of_other_paths(c: Config) -> bool:
    """Whether the SNR refers to another echo than the simulated: no wall, or no room."""
    no_wall = c.wall is not None and c.snr_reference == "free_space"
    return no_wall or bool(c.room.reflectors) or c.room.back_wall_m is not None


def _echo(c: Config) -> Iterator[Product]:
    def signal(y: Signal, canceller: Canceller, receiver: tuple[Impairment, ...]) -> Signal:
        x = y.x
        for impairment in receiver:
            x = impairment.slow_time(x)
        return y.with_samples(canceller(x), canceller.delay)

    yield Product("canceller", ("waveform",), lambda w: canceller_of(c, w.prf), _clutter(c))
    yield from _receiver(c)
    yield from _cube(c) if c.engine.kind == "cube" else _direct(c)
    if c.engine.kind == "direct":
        yield Product(
            "signal", ("slow_time", "canceller", "receiver"), signal, "receiver, then canceller"
        )


def _gated(c: Config) -> bool:
    return c.processing.range_sum == "gated"


def _clutter(c: Config) -> str:
    """One line on the canceller."""
    kind, highpass = c.processing.clutter, c.processing.highpass
    if kind != "highpass":
        return {
            "difference": "first difference of the pulses",
            "mean": "the mean of the recording is taken out",
            "none": "nothing is taken out",
        }[kind]
    return f"high-pass of order {highpass.order}{', both ways' if highpass.zero_phase else ''}"


def _receiver(c: Config) -> Iterator[Product]:
    def noise(scene: Scene, power: float, w: Waveform, channel: object) -> WhiteNoise:
        assert isinstance(scene.config.snr_db, (int, float))
        if not SMALLEST_POWER <= power < inf:
            raise SceneError(
                f"{scene.name}: the echo's power is {power:g}; snr_db = {scene.config.snr_db:g} "
                f"needs one from {SMALLEST_POWER:.3g} on (wall.loss_tangent, radar.carrier_hz, "
                "motion.range_m), or should be null"
            )
        sigma = np.sqrt(noise_variance(power, scene.config.snr_db))
        return WhiteNoise(float(sigma), w, partial(noise_stream, scene, channel=channel))

    if c.snr_db is None:
        yield Product("receiver", (), tuple, "nothing: snr_db is null")
        return
    yield Product("channel", ("scene", "antennas"), channel_of, "whose noise it is")
    needs = ("scene", "signal_power", "waveform", "channel")
    yield Product("noise", needs, noise, "white noise, by snr_db")
    yield Product(
        "receiver",
        ("scene", "noise"),
        lambda s, n: (n, *impairments_of(s, n)),
        "noise, interference",
    )


def _direct(c: Config) -> Iterator[Product]:
    engine = c.engine

    def direct(source: PathSource, w: Waveform, canceller: Canceller) -> DirectEcho:
        double = engine.precision == "double"
        return DirectEcho(source, w, engine.tolerance_db, double, canceller)

    def echo(direct: DirectEcho, scene: Scene) -> tuple[Complex, EchoAccuracy]:
        try:
            return direct.slow_time()
        except AccuracyError as error:
            if engine.fallback == "refuse":
                raise SceneError(_refusal(scene.name, engine.tolerance_db, error)) from None
            blocks = cube.beat_blocks(direct.source, direct.waveform)
            y = [half_band_signal(range_compression(block, direct.waveform)) for block in blocks]
            return np.concatenate(y), Fallback(str(error))

    def slow_time(echo: tuple[Complex, EchoAccuracy], w: Waveform) -> Signal:
        return Signal(echo[0], 0.0, w.prf, w.f0)

    def range_profiles(
        paths: PathSource,
        w: Waveform,
        canceller: Canceller,
        receiver: tuple[Impairment, ...],
    ) -> RangeProfiles:
        shown = shown_pulses(w.n_pulses - canceller.lost, c.image.size_px[1])
        if not isinstance(canceller, Fir):
            x = _range_bins(c, paths, w, canceller, ())
            for impairment in receiver:
                x = impairment.range_signals(x, slice(0, w.n_bins))
            return RangeProfiles(canceller(x)[:, shown], shown)
        bins = range_bins(beat_at(paths, w, shown, canceller.taps), w)
        for impairment in receiver:
            bins = impairment.range_bins(bins, shown, canceller)
        return RangeProfiles(bins, shown)

    seen = ("waveform", "canceller")
    yield Product("direct", ("paths", *seen), direct, "closed form of the echo at knots")
    if _snr_of_other_paths(c):
        yield Product("signal_power", ("snr_paths", "waveform"), mean_power, "P_s, for snr_db")
    else:
        yield Product("signal_power", ("direct",), DirectEcho.signal_power, "P_s, for snr_db")
    yield Product("echo", ("direct", "scene"), echo, "slow-time samples and their measured error")
    yield Product("slow_time", ("echo", "waveform"), slow_time, "slow-time signal without noise")
    yield Product(
        "accuracy",
        ("gated_echo" if _gated(c) else "echo",),
        lambda echo: echo[1],
        "its measured error",
    )
    yield Product(
        "range_profiles",
        ("paths", "waveform", "canceller", "receiver"),
        range_profiles,
        "range profiles at the pulses that the range-time map shows",
    )


def _refusal(name: str, tolerance_db: float, error: AccuracyError) -> str:
    what = f"sample {name}: engine.tolerance_db = {tolerance_db:g}: "
    if error.limit_db > MAX_TOLERANCE_DB:
        return what + f"no tolerance can be kept here ({error}); set engine.fallback: cube"
    return what + (
        f"should be {ceil(error.limit_db)} or more, which is what the direct engine reaches here, "
        "or engine.fallback: cube"
    )


def _cube(c: Config) -> Iterator[Product]:
    needs = ("paths", "waveform", "canceller", "receiver")

    def beat_cube(
        paths: PathSource, w: Waveform, canceller: Canceller, receiver: tuple[Impairment, ...]
    ) -> tuple[Signal, RangeProfiles | None]:
        x, bins = np.empty(w.n_pulses - canceller.lost, dtype=complex), []
        shown = shown_pulses(x.size, c.image.size_px[1])
        for first, block in _blocks(c, paths, w, canceller, receiver):
            x[first : first + block.shape[1]] = half_band_signal(range_compression(block, w))
            here = shown[(shown >= first) & (shown < first + block.shape[1])]
            if isinstance(canceller, Fir):
                bins.append(range_bins(block[:, here - first], w))
        t0 = canceller.delay / w.prf
        if not isinstance(canceller, Fir):
            return Signal(canceller(x), t0, w.prf, w.f0), None
        return (
            Signal(x, t0, w.prf, w.f0),
            RangeProfiles(np.concatenate(bins, axis=1), shown),
        )

    def range_profiles(
        both: tuple[Signal, RangeProfiles | None],
        paths: PathSource,
        w: Waveform,
        canceller: Canceller,
        receiver: tuple[Impairment, ...],
    ) -> RangeProfiles:
        if both[1] is not None:
            return both[1]
        shown = shown_pulses(w.n_pulses, c.image.size_px[1])
        x = canceller(_range_bins(c, paths, w, canceller, receiver))
        return RangeProfiles(x[:, shown], shown)

    power_of = "snr_paths" if _snr_of_other_paths(c) else "paths"
    yield Product("signal_power", (power_of, "waveform"), cube.signal_power, "P_s, for snr_db")
    yield Product("beat_cube", needs, beat_cube, "the whole beat matrix, cancelled, compressed")
    yield Product("signal", ("beat_cube",), lambda both: both[0], "its sum over the kept bins")
    yield Product("range_profiles", ("beat_cube", *needs), range_profiles, "its range bins")


def _blocks(
    c: Config,
    paths: PathSource,
    w: Waveform,
    canceller: Canceller,
    receiver: tuple[Impairment, ...],
) -> Iterator[tuple[int, Complex]]:
    """(first pulse, beat matrix), block by block: after a `Fir`; before another canceller.

    What that removes for certain, the first pulse, is then taken out of every one: of an echo that
    stands still, however strong, nothing is left for range compression to round.
    """
    blocks = cube.beat_blocks(paths, w, c.engine.motion_in_chirp)
    for impairment in receiver:
        blocks = impairment.beat(blocks)
    carried, first, still = np.empty((w.n_adc, 0), dtype=complex), 0, None
    for block in blocks:
        if not isinstance(canceller, Fir):
            still = block[:, :1] if still is None else still
            yield first, block - still if canceller.removes_static else block
            first += block.shape[1]
            continue
        wide = np.concatenate([carried, block], axis=1) if carried.size else block
        carried = wide[:, wide.shape[1] - canceller.lost :]
        if wide.shape[1] > canceller.lost:
            cancelled = canceller(wide)
            yield first, cancelled
            first += cancelled.shape[1]


def _range_bins(
    c: Config,
    paths: PathSource,
    w: Waveform,
    canceller: Canceller,
    receiver: tuple[Impairment, ...],
    bins: slice = slice(None),
) -> Complex:
    """Range bins [K, M] of all pulses, from `_blocks`, referred to mid-chirp."""
    k = np.arange(w.n_bins)[bins, None]
    x = np.empty((k.size, w.n_pulses - canceller.lost), dtype=complex)
    for first, block in _blocks(c, paths, w, canceller, receiver):
        x[:, first : first + block.shape[1]] = range_bins(block, w)[bins]
    x *= unit_phasor(k * (w.n_adc / 2 / w.n_fft))
    return x


Samples = TypeVar("Samples", Signal, RangeSignals)


def _signals(c: Config) -> Iterator[Product]:
    def compensated(x: Samples, torso_track: Float) -> Samples:
        return x.with_samples(compensate(x.x, torso_track, x.f0))

    def denoised(x: Samples) -> Samples:
        given = c.processing.savgol
        return x.with_samples(
            np.apply_along_axis(savgol, -1, x.x, order=given.order, frame=given.frame)
        )

    for raw in ("signal", *(["range_signals"] if _gated(c) else [])):
        smooth = "Savitzky-Golay filter"
        yield Product(f"{raw}_denoised", (raw,), denoised, smooth)
        yield Product(
            f"{raw}_compensated", (raw, "torso_track"), compensated, "bulk Doppler compensation"
        )
        yield Product(f"{raw}_compensated_denoised", (f"{raw}_compensated",), denoised, smooth)


def _gate(c: Config) -> Iterator[Product]:
    """The bins of the gate, and their echo."""
    engine, within = c.engine, c.processing.gate_m
    needs = ("paths", "waveform", "canceller", "gate")

    def gate(ranges: Float, frames: Frames, canceller: Canceller, torso_track: Float) -> Gate:
        starts = frames.starts(torso_track.size - canceller.lost)
        middle = np.rint(starts + (frames.length - 1) / 2 + canceller.delay).astype(np.intp)
        return gate_of(c, ranges, torso_track[middle] * (SPEED_OF_LIGHT / 2))

    def from_cube(
        paths: PathSource,
        w: Waveform,
        canceller: Canceller,
        gate: Gate,
        receiver: tuple[Impairment, ...],
    ) -> RangeSignals:
        x = _range_bins(c, paths, w, canceller, receiver, gate.bins)
        x = x if isinstance(canceller, Fir) else canceller(x)
        return range_signals(x, w, gate).with_samples(x, canceller.delay)

    def needed_of(
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
        double = engine.precision == "double"
        return GatedEcho(paths, w, engine.tolerance_db, double, canceller, gate.bins, needed)

    def gated_echo(echo: GatedEcho, scene: Scene) -> tuple[Complex, EchoAccuracy]:
        try:
            return echo.range_bins()
        except AccuracyError as error:
            if engine.fallback == "refuse":
                raise SceneError(_refusal(scene.name, engine.tolerance_db, error)) from None
            before = NO_CANCELLER if isinstance(echo.canceller, Fir) else echo.canceller
            bins = _range_bins(c, echo.source, echo.waveform, before, (), echo.bins)
            return bins, Fallback(str(error))

    def from_echo(
        echo: tuple[Complex, EchoAccuracy],
        w: Waveform,
        canceller: Canceller,
        gate: Gate,
        needed: tuple[Index, Index] | None,
        receiver: tuple[Impairment, ...],
    ) -> RangeSignals:
        x, spans = echo[0], None if needed is None else gate.spans(needed)
        for impairment in receiver:
            x = impairment.range_signals(x, gate.bins, spans)
        return range_signals(x, w, gate).cancelled(canceller, spans)

    def range_signals(x: Complex, w: Waveform, gate: Gate) -> RangeSignals:
        f0 = replace(w, centred=True).f0
        return RangeSignals(x, w.range_axis()[gate.bins], 0.0, w.prf, f0, gate.bins.start)

    yield Product("range_axis", ("waveform",), Waveform.range_axis, "ranges of the bins")
    if isinstance(within, tuple):
        place = f"range bins from {within[0]:g} to {within[1]:g} m"
        yield Product("gate", ("range_axis",), lambda ranges: gate_of(c, ranges, None), place)
    else:
        place = f"range bins within {within:g} m of the torso, frame by frame"
        needs_of_gate = ("range_axis", "frames", "canceller", "torso_track")
        yield Product("gate", needs_of_gate, gate, place)
    if engine.kind == "cube":
        does = "the beat matrix, compressed, of the gate's bins"
        yield Product("range_signals", (*needs, "receiver"), from_cube, does)
    else:
        yield Product(
            "gate_needed",
            ("gate", "frames", "waveform", "canceller"),
            needed_of,
            "its bins that frames show, pulse by pulse",
        )
        yield Product("gated", (*needs, "gate_needed"), gated, "closed form of them at knots")
        if not _snr_of_other_paths(c):
            power = DirectEcho.signal_power  # from the knots that the bins are made of
            yield Product("signal_power", ("gated",), power, "P_s, for snr_db")
        does = "its bins and their measured error"
        yield Product("gated_echo", ("gated", "scene"), gated_echo, does)
        yield Product(
            "range_signals",
            ("gated_echo", *needs[1:], "gate_needed", "receiver"),
            from_echo,
            "receiver, then canceller, of the gate's bins",
        )


def _maps(c: Config, entropy: bool) -> Iterator[Product]:
    size, masks = c.image.size_px, ("cfar",) if c.image.kind == "cfar" else ()

    def rtm(profiles: RangeProfiles, w: Waveform, canceller: Canceller) -> PowerMap:
        time = Axis("time", "s", (profiles.pulses + canceller.delay) / w.prf)
        return PowerMap(range_power(profiles.bins), Axis("range", "m", w.range_axis()), time)

    def rtm_image(power_map: PowerMap, cfar: CellAveraging | None = None) -> MapImage:
        small = partial(reduced_map, power_map.power, size, entropy=entropy)
        return _image(c, cfar, small, power_map.extent, binary_exponent(power_map.power))

    needs = ("range_profiles", "waveform", "canceller")
    yield Product("rtm", needs, rtm, "power of the range profiles")
    if masks:
        yield Product("cfar", ("scene",), lambda s: cfar_of(s.config), "threshold of the masks")
    yield Product("image:rtm", ("rtm", *masks), rtm_image, f"its {_shape(c, entropy)}")
    yield Product(
        "frames", ("waveform",), lambda w: frames_of(c, w.duration, w.prf, w.f0), "of the STFT"
    )
    yield Product(
        "fsst_frames",
        ("waveform",),
        lambda w: fsst_frames_of(c, w.duration, w.prf, w.f0),
        "of the FSST",
    )
    for signal in SIGNALS:
        yield from _doppler_maps(c, signal, entropy)


class DopplerPower(NamedTuple):
    """The power of a Doppler-time map in blocks, in units of 2^(2 exponent), and its axes.

    Attributes:
        blocks: [some columns, rows] in the order of time.
    """

    blocks: Iterator[Float]
    exponent: int
    rows: Axis
    columns: Axis


def _doppler_maps(c: Config, signal: str, entropy: bool) -> Iterator[Product]:
    """STFT and FSST of a signal, whole in float64, and their images.

    Images of the STFT come from float32. Those of the FSST do not: a coefficient that lies within
    float32's rounding of the border between two bins would move its power to another pixel.
    """
    suffix, threshold = signal.removeprefix("signal"), c.processing.fsst_threshold
    masks = ("cfar",) if c.image.kind == "cfar" else ()
    shallow = c.image.dynamic_range_db <= SINGLE_RANGE_DB and not (masks or c.output.power)
    single = c.engine.precision == "auto" and shallow
    bins, squeezed = c.processing.stft_fft_length, partial(fsst.power_blocks, threshold=threshold)
    kinds: dict[str, tuple[tuple[str, ...], MakePower, bool, str]] = {
        "stft": ((signal, "frames"), partial(_power, c, stft.power_blocks, bins), single, "STFT"),
        "fsst": (
            (signal, "fsst_frames"),
            partial(_power, c, squeezed, None),
            False,
            "STFT, synchrosqueezed",
        ),
    }
    if _gated(c):
        magnitudes = c.processing.gate_sum == "magnitude"
        what = f"STFTs, {'magnitudes' if magnitudes else 'powers'} summed over the gate"
        from_bins = (f"range_signals{suffix}", "frames", "gate")
        kinds = {"stft": (from_bins, partial(_gated_power, c, magnitudes, bins), single, what)}
    for name, (needs, power, is_single, does) in kinds.items():
        yield Product(name + suffix, needs, partial(_doppler_map, power), f"power of the {does}")
        yield Product(
            f"image:{name}{suffix}",
            (*masks, *needs),
            partial(_doppler_mask if masks else _doppler_image, c, power, is_single, entropy),
            f"power of the {does}{', in float32' * is_single}; its {_shape(c, entropy)}",
        )


MakePower: TypeAlias = Callable[..., DopplerPower]


def _shape(c: Config, entropy: bool) -> str:
    shape = "CFAR mask" if c.image.kind == "cfar" else "image"
    return f"{shape} and entropy" if entropy else shape


def image_of(config: Config, power_map: PowerMap) -> MapImage:
    """The image of a map that was measured, as a data set shows it; masks by fixed numbers."""
    cfar = cfar_of(config) if config.image.kind == "cfar" else None
    small = partial(reduced_map, power_map.power, config.image.size_px)
    return _image(config, cfar, small, power_map.extent, binary_exponent(power_map.power))


def _image(
    c: Config,
    cfar: CellAveraging | None,
    resize: Callable[[Callable[[Float], Float] | None], Reduced],
    extent: tuple[float, float, float, float],
    exponent: int,
) -> MapImage:
    """The image of a map, and its unclipped decibels where they are stored.

    Args:
        c: the config.
        cfar: of masks.
        resize: makes the resized map of a function of its power, or of the power itself.
        extent: of the map.
        exponent: of the power of two that is the unit of what `resize` makes.
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


def _power(
    c: Config,
    blocks: Callable[[Spectra], Iterator[Float]],
    bins: int | None,
    single: bool,
    x: Signal,
    frames: Frames,
) -> DopplerPower:
    spectra = Spectra(x.x, frames, bins or frames.length, single)
    return _cropped(c, blocks(spectra), spectra.exponent, x, frames, spectra.bins)


def _gated_power(
    c: Config,
    magnitudes: bool,
    bins: int | None,
    single: bool,
    x: RangeSignals,
    frames: Frames,
    gate: Gate,
) -> DopplerPower:
    gated = GatedPower(x, gate, frames, bins or frames.length, magnitudes, single)
    return _cropped(c, iter(gated), gated.exponent, x, frames, gated.bins)


def _doppler_map(make: MakePower, *given: Any) -> PowerMap:
    doppler = make(False, *given)
    power = np.concatenate(list(doppler.blocks), dtype=float)
    np.ldexp(power, 2 * doppler.exponent, out=power)
    return PowerMap(power.T, doppler.rows, doppler.columns)


def _doppler_mask(
    c: Config, make: MakePower, single: bool, entropy: bool, cfar: CellAveraging, *given: Any
) -> MapImage:
    return _doppler_image(c, make, single, entropy, *given, cfar=cfar)


def _doppler_image(
    c: Config,
    make: MakePower,
    single: bool,
    entropy: bool,
    *given: Any,
    cfar: CellAveraging | None = None,
) -> MapImage:
    doppler = make(single, *given)
    again = (make(single, *given).blocks for _ in repeat(None))
    passes = chain([doppler.blocks], again)

    def small(of: Callable[[Float], Float] | None) -> Reduced:
        return reduced(next(passes), doppler.columns.values.size, c.image.size_px, of, entropy)

    extent = (*doppler.columns.edges, *doppler.rows.edges)
    return _image(c, cfar, small, extent, 2 * doppler.exponent)


def _cropped(
    c: Config,
    blocks: Iterator[Float],
    exponent: int,
    x: Signal | RangeSignals,
    frames: Frames,
    bins: int,
) -> DopplerPower:
    """Power at the bins whose middle lies within `image.doppler_limits_mps`, with its axes."""
    kept = slice(None)
    frequency = np.fft.fftshift(np.fft.fftfreq(bins, 1 / x.prf))
    if c.image.doppler_limits_mps is not None:
        limits = np.array(c.image.doppler_limits_mps) * 2 * x.f0 / SPEED_OF_LIGHT
        first, stop = np.searchsorted(frequency, limits + 1e-9 * np.array([-1, 1]) * x.prf)
        kept = slice(int(first), int(stop))
    centres = x.times(frames.starts(x.x.shape[-1]) + (frames.length - 1) / 2)
    return DopplerPower(
        (block[:, kept] for block in blocks),
        exponent,
        Axis("frequency", "Hz", frequency[kept]),
        Axis("time", "s", centres),
    )
