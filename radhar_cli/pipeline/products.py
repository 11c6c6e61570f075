"""The table of products: name, needs and function of all that can be made of a scene.

Order (paper, figure "Signal processing overflow"): canceller -> range compression -> [range-time
map] -> sum over the kept bins -> [compensation] -> [denoising] -> STFT or FSST.

    scene      what is simulated                     paths     delay and amplitude over time
    slow_time  y[m], noiseless, before the canceller signal    x[m], what the Doppler maps show
    <map>      PowerMap                              image:<map>  MapImage
"""

from collections.abc import Callable, Iterator
from functools import partial
from math import ceil
from typing import NamedTuple, TypeAlias

import numpy as np

from radhar_cli.arrays import Complex, Float, Index
from radhar_cli.config.schema import MAX_TOLERANCE_DB, Config
from radhar_cli.echo import cube
from radhar_cli.echo.accuracy import AccuracyError
from radhar_cli.echo.direct import Accuracy, DirectEcho
from radhar_cli.echo.knots import mean_power
from radhar_cli.echo.paths import PathSource
from radhar_cli.echo.range_profiles import beat_at, shown_pulses
from radhar_cli.errors import SceneError
from radhar_cli.motion.protocol import Motion
from radhar_cli.pipeline.motion_paths import MotionPaths, SumOfPaths, point_delay
from radhar_cli.pipeline.physics import (
    antennas_of,
    canceller_of,
    frames_of,
    fsst_frames_of,
    motion_of,
    noise_stream,
    wall_of,
    waveform_of,
)
from radhar_cli.pipeline.plan import Plan, Product, plan
from radhar_cli.processing import fsst, stft
from radhar_cli.processing.canceller import Canceller
from radhar_cli.processing.denoising import savgol
from radhar_cli.processing.doppler_compensation import compensate
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.image import levels, reduced, reduced_map
from radhar_cli.processing.power_map import Axis, MapImage, PowerMap
from radhar_cli.processing.range_compression import (
    half_band_signal,
    range_bins,
    range_compression,
    range_power,
)
from radhar_cli.processing.signal import Signal
from radhar_cli.processing.stft import Spectra
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import Waveform
from radhar_cli.receiver.impairment import Impairment
from radhar_cli.receiver.noise import WhiteNoise, noise_variance
from radhar_cli.scene import Scene

CHUNK = 2**18  # pulses at work at once, where each is on its own
SINGLE_RANGE_DB = 70.0  # of images: up to here float32 changes a pixel in 1e5, by one level
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


def plan_images(config: Config) -> Plan:
    """The plan of a data set: the image of every map, those of one signal together."""
    maps = sorted(config.maps, key=lambda name: SIGNALS.index(signal_of(name)))
    asked = [f"image:{name}" for name in maps]
    if config.engine.kind == "direct" and set(maps) != {"rtm"}:
        asked.append("accuracy")
    return plan(products(config), asked, ["scene"])


def products(config: Config) -> dict[str, Product]:
    """Every product there could be under a config, by name."""
    rows = (*_physics(config), *_echo(config), *_signals(config), *_maps(config))
    return {row.name: row for row in rows}


def _physics(c: Config) -> Iterator[Product]:
    def paths(
        motions: tuple[Motion, ...], antennas: Antennas, wall: Wall | None, w: Waveform
    ) -> PathSource:
        each = [MotionPaths(one, antennas, w.fc, wall) for one in motions]
        return each[0] if len(each) == 1 else SumOfPaths(tuple(each))

    def through_air(motions: tuple[Motion, ...], antennas: Antennas, w: Waveform) -> PathSource:
        return paths(motions, antennas, None, w)

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
    yield Product("paths", seen, paths, f"delay and amplitude of every scatterer, {walled}")
    if _snr_in_free_space(c):
        needs = ("motions", "antennas", "waveform")
        yield Product("snr_paths", needs, through_air, "paths without the wall, for the SNR")
    yield Product("torso_track", seen, torso_track, "delay of the torso at every pulse")


def _snr_in_free_space(c: Config) -> bool:
    """Whether the SNR refers to an echo that is not the simulated one: that without the wall."""
    return c.wall is not None and c.snr_reference == "free_space"


def _echo(c: Config) -> Iterator[Product]:
    def signal(y: Signal, canceller: Canceller, receiver: tuple[Impairment, ...]) -> Signal:
        x = y.x
        for impairment in receiver:
            x = impairment.slow_time(x)
        return y.with_samples(canceller(x), canceller.delay)

    yield Product("canceller", (), lambda: canceller_of(c), "what removes the static echo")
    yield from _receiver(c)
    yield from _cube(c) if c.engine.kind == "cube" else _direct(c)
    if c.engine.kind == "direct":
        yield Product(
            "signal", ("slow_time", "canceller", "receiver"), signal, "receiver, then canceller"
        )


def _receiver(c: Config) -> Iterator[Product]:
    def noise(scene: Scene, power: float, w: Waveform) -> WhiteNoise:
        assert isinstance(scene.config.snr_db, (int, float))
        sigma = np.sqrt(noise_variance(power, scene.config.snr_db))
        return WhiteNoise(float(sigma), w, lambda name: noise_stream(scene, name))

    if c.snr_db is None:
        yield Product("receiver", (), tuple, "nothing: snr_db is null")
        return
    yield Product("noise", ("scene", "signal_power", "waveform"), noise, "white noise, by snr_db")
    yield Product("receiver", ("noise",), lambda *impairments: impairments, "impairments, in order")


def _direct(c: Config) -> Iterator[Product]:
    engine = c.engine

    def direct(source: PathSource, w: Waveform, canceller: Canceller) -> DirectEcho:
        double = engine.precision == "double"
        return DirectEcho(source, w, engine.tolerance_db, double, canceller.taps)

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
        bins = range_bins(beat_at(paths, w, shown, canceller.taps), w)
        for impairment in receiver:
            bins = impairment.range_bins(bins, shown, canceller)
        return RangeProfiles(bins, shown)

    seen = ("waveform", "canceller")
    yield Product("direct", ("paths", *seen), direct, "closed form of the echo at knots")
    if _snr_in_free_space(c):
        yield Product("signal_power", ("snr_paths", "waveform"), mean_power, "P_s, for snr_db")
    else:
        yield Product("signal_power", ("direct",), DirectEcho.signal_power, "P_s, for snr_db")
    yield Product("echo", ("direct", "scene"), echo, "slow-time samples and their measured error")
    yield Product("slow_time", ("echo", "waveform"), slow_time, "slow-time signal without noise")
    yield Product("accuracy", ("echo",), lambda echo: echo[1], "its measured error")
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
    ) -> tuple[Signal, RangeProfiles]:
        x, bins = np.empty(w.n_pulses - canceller.lost, dtype=complex), []
        shown = shown_pulses(x.size, c.image.size_px[1])
        for first, block in _blocks(c, paths, w, canceller, receiver):
            x[first : first + block.shape[1]] = half_band_signal(range_compression(block, w))
            here = shown[(shown >= first) & (shown < first + block.shape[1])]
            bins.append(range_bins(block[:, here - first], w))
        return (
            Signal(x, canceller.delay / w.prf, w.prf, w.f0),
            RangeProfiles(np.concatenate(bins, axis=1), shown),
        )

    power_of = "snr_paths" if _snr_in_free_space(c) else "paths"
    yield Product("signal_power", (power_of, "waveform"), cube.signal_power, "P_s, for snr_db")
    yield Product("beat_cube", needs, beat_cube, "the whole beat matrix, cancelled, compressed")
    yield Product("signal", ("beat_cube",), lambda both: both[0], "its sum over the kept bins")
    yield Product("range_profiles", ("beat_cube",), lambda both: both[1], "its range bins")


def _blocks(
    c: Config,
    paths: PathSource,
    w: Waveform,
    canceller: Canceller,
    receiver: tuple[Impairment, ...],
) -> Iterator[tuple[int, Complex]]:
    """(first output of the canceller, beat matrix after it), block by block."""
    blocks = cube.beat_blocks(paths, w, c.engine.motion_in_chirp)
    for impairment in receiver:
        blocks = impairment.beat(blocks)
    carried, first = np.empty((w.n_adc, 0), dtype=complex), 0
    for block in blocks:
        wide = np.concatenate([carried, block], axis=1) if carried.size else block
        carried = wide[:, wide.shape[1] - canceller.lost :]
        if wide.shape[1] > canceller.lost:
            cancelled = canceller(wide)
            yield first, cancelled
            first += cancelled.shape[1]


def _signals(c: Config) -> Iterator[Product]:
    def compensated(x: Signal, torso_track: Float) -> Signal:
        return x.with_samples(compensate(x.x, torso_track, x.f0))

    def denoised(x: Signal) -> Signal:
        return x.with_samples(savgol(x.x, c.processing.savgol.order, c.processing.savgol.frame))

    smooth = "Savitzky-Golay filter"
    yield Product("signal_denoised", ("signal",), denoised, smooth)
    yield Product(
        "signal_compensated", ("signal", "torso_track"), compensated, "bulk Doppler compensation"
    )
    yield Product("signal_compensated_denoised", ("signal_compensated",), denoised, smooth)


def _maps(c: Config) -> Iterator[Product]:
    range_db, size = c.image.dynamic_range_db, c.image.size_px

    def rtm(profiles: RangeProfiles, w: Waveform, canceller: Canceller) -> PowerMap:
        time = Axis("time", "s", (profiles.pulses + canceller.delay) / w.prf)
        return PowerMap(range_power(profiles.bins), Axis("range", "m", w.range_axis()), time)

    def rtm_image(found: PowerMap) -> MapImage:
        small = reduced_map(found.power, size)
        return MapImage(levels(small.power, range_db), small.entropy, found.extent)

    needs = ("range_profiles", "waveform", "canceller")
    yield Product("rtm", needs, rtm, "power of the range profiles")
    yield Product("image:rtm", ("rtm",), rtm_image, "its image and entropy")
    yield Product("frames", ("waveform",), lambda w: frames_of(c, w.duration, w.prf), "of the STFT")
    yield Product(
        "fsst_frames", ("waveform",), lambda w: fsst_frames_of(c, w.duration, w.prf), "of the FSST"
    )
    for signal in SIGNALS:
        yield from _doppler_maps(c, signal)


def _doppler_maps(c: Config, signal: str) -> Iterator[Product]:
    """STFT and FSST of a signal, whole in float64, and their images.

    Images of the STFT come from float32. Those of the FSST do not: a coefficient that lies within
    float32's rounding of the border between two bins would move its power to another pixel.
    """
    suffix, threshold = signal.removeprefix("signal"), c.processing.fsst_threshold
    single = c.engine.precision == "auto" and c.image.dynamic_range_db <= SINGLE_RANGE_DB
    squeezed = partial(fsst.power_blocks, threshold=threshold)
    for name, frames, bins, blocks, is_single, does in (
        ("stft", "frames", c.processing.stft_fft_length, stft.power_blocks, single, "STFT"),
        ("fsst", "fsst_frames", None, squeezed, False, "STFT, synchrosqueezed"),
    ):
        needs = (signal, frames)
        yield Product(
            name + suffix, needs, partial(_doppler_map, blocks, bins), f"power of the {does}"
        )
        yield Product(
            f"image:{name}{suffix}",
            needs,
            partial(_doppler_image, c, blocks, bins, is_single),
            f"power of the {does}{', in float32' if is_single else ''}; its image and entropy",
        )


Blocks: TypeAlias = Callable[[Spectra], Iterator[Float]]


def _doppler_map(blocks: Blocks, bins: int | None, x: Signal, frames: Frames) -> PowerMap:
    spectra = Spectra(x.x, frames, bins or frames.length)
    power = np.concatenate(list(blocks(spectra)), dtype=float)
    np.ldexp(power, 2 * spectra.exponent, out=power)
    return PowerMap(power.T, *_doppler_axes(x, spectra))


def _doppler_image(
    c: Config, blocks: Blocks, bins: int | None, single: bool, x: Signal, frames: Frames
) -> MapImage:
    spectra = Spectra(x.x, frames, bins or frames.length, single)
    rows, columns = _doppler_axes(x, spectra)
    small = reduced(blocks(spectra), spectra.count, c.image.size_px)
    grey = levels(small.power, c.image.dynamic_range_db)
    return MapImage(grey, small.entropy, (*columns.edges, *rows.edges))


def _doppler_axes(x: Signal, spectra: Spectra) -> tuple[Axis, Axis]:
    frames = spectra.frames
    frequency = np.fft.fftshift(np.fft.fftfreq(spectra.bins, 1 / x.prf))
    centres = x.times(frames.starts(x.x.size) + (frames.length - 1) / 2)
    return Axis("frequency", "Hz", frequency), Axis("time", "s", centres)
