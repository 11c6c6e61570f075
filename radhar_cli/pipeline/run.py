"""Run a plan on one scene. The only file that knows what each stage calls.

Order (paper, figure "Signal processing overflow"): MTI -> range compression -> [range-time map] ->
sum over the kept bins -> [compensation] -> [denoising] -> STFT or FSST.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import ceil
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.arrays import Complex, Float, Levels
from radhar_cli.config.engine import MAX_TOLERANCE_DB
from radhar_cli.config.experiment import Config
from radhar_cli.echo import cube
from radhar_cli.echo.accuracy import AccuracyError
from radhar_cli.echo.direct import Accuracy, DirectEcho, slow_time_noise
from radhar_cli.echo.knots import mean_power
from radhar_cli.echo.range_profiles import beat_at, noise_at, shown_pulses
from radhar_cli.errors import SceneError
from radhar_cli.pipeline.body_paths import BodyPaths
from radhar_cli.pipeline.models import antennas_of, body_of, wall_of, waveform_of
from radhar_cli.pipeline.plan import Plan, Stage
from radhar_cli.processing import fsst, stft
from radhar_cli.processing.denoising import savgol
from radhar_cli.processing.doppler_compensation import compensate
from radhar_cli.processing.entropy import entropy_bits
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.image import levels
from radhar_cli.processing.long_map import LongMap, joined
from radhar_cli.processing.mti import FIRST_DIFFERENCE, mti, mti_in_place
from radhar_cli.processing.range_compression import (
    half_band_signal,
    range_bins,
    range_compression,
    range_power,
)
from radhar_cli.processing.stft import Spectra
from radhar_cli.radar.noise import noise_variance
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import Waveform
from radhar_cli.randomness import NOISE, stream
from radhar_cli.scenario import Scene

CHUNK = 2**18  # pulses at work at once, where each is on its own


@dataclass
class Recording:
    """One scene on its way through a plan.

    Attributes:
        scene, config, plan: what is simulated, and how.
        joints: numbers of the scatterers that are kept; all of them for None.
        products: {stage name: what it made}, of those that the plan was asked for.
        seconds: {stage name: time it took}.
        accuracy: of the slow-time signal, where the direct engine made it.
        fallback: why the cube made it instead.
    """

    scene: Scene
    config: Config
    plan: Plan
    joints: tuple[int, ...] | None = None
    products: dict[str, Any] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)
    accuracy: Accuracy | None = None
    fallback: str | None = None

    @cached_property
    def waveform(self) -> Waveform:
        return waveform_of(self.scene, self.config)

    @cached_property
    def frames(self) -> Frames:
        processing = self.config.processing
        return Frames.of(
            processing.window_fraction,
            processing.overlap_fraction,
            self.waveform.duration,
            self.waveform.prf,
        )

    @cached_property
    def fsst_frames(self) -> Frames:
        """`frames`, with the hop of the FSST where it has its own."""
        hop = self.config.processing.fsst_hop_pulses
        return self.frames if hop is None else Frames(self.frames.length, hop)

    @cached_property
    def shown(self) -> np.ndarray[Any, np.dtype[np.intp]]:
        """Pulses (or first pulses of MTI pairs) that the range-time map shows."""
        kept = self.waveform.n_pulses - self.config.processing.mti
        return shown_pulses(kept, self.config.image.size_px[1])

    def noise(self, name: str) -> np.random.Generator:
        """The stream of unit-variance noise of this sample with that name."""
        key = (self.scene.activity.index, self.scene.index)
        return stream(self.scene.seed, NOISE, *key, name=name)

    @property
    def sigma(self) -> float:
        """Standard deviation of the raw noise; 0 without noise."""
        if "signal_power" not in self.plan:
            return 0.0
        power = self.products["signal_power"]
        return float(np.sqrt(noise_variance(power, self.scene.values["snr_db"])))


class CubeProducts(NamedTuple):
    """What one pass over the beat matrix leaves: x[m] and |S[k, m_j]|^2, where asked for."""

    signal: Complex | None
    range_power: Float | None


def run(
    plan: Plan, scene: Scene, config: Config, joints: tuple[int, ...] | None = None
) -> Recording:
    """Run every stage of the plan, once, in its order; release what nobody needs any more."""
    recording = Recording(scene, config, plan, joints)
    for stage in plan.stages:
        start = perf_counter()
        recording.products[stage.name] = STAGES[stage.kind](recording, stage)
        recording.seconds[stage.name] = perf_counter() - start
        for name in plan.done_with[stage.name]:
            del recording.products[name]
    return recording


def _wall(r: Recording, stage: Stage) -> Wall | None:
    return wall_of(r.scene, r.config)


def _paths(r: Recording, stage: Stage) -> BodyPaths:
    return BodyPaths(
        body=body_of(r.scene),
        antennas=antennas_of(r.scene),
        fc=r.waveform.fc,
        wall=r.products.get("wall"),
        joints=r.joints,
    )


def _torso_track(r: Recording, stage: Stage) -> Float:
    track, paths = np.empty(r.waveform.n_pulses), r.products["paths"]
    for start in range(0, track.size, CHUNK):
        part = track[start : start + CHUNK]
        pulses = np.arange(start, start + part.size, dtype=float)
        part[:] = paths.torso_delay(r.waveform.times(pulses))
    return track


def _canceller(r: Recording) -> tuple[float, ...]:
    return FIRST_DIFFERENCE if r.config.processing.mti else (1.0,)


def _echo(r: Recording, stage: Stage) -> DirectEcho:
    engine, paths = r.config.engine, r.products["paths"]
    double = engine.precision == "double"
    return DirectEcho(paths, r.waveform, engine.tolerance_db, double, _canceller(r))


def _signal_power(r: Recording, stage: Stage) -> float:
    """Of the paths, without the wall's loss where the SNR refers to free space."""
    paths: BodyPaths = r.products["paths"]
    without_wall = paths.wall is not None and r.config.snr_reference == "free_space"
    source = replace(paths, wall=None) if without_wall else paths
    if "echo" not in r.products:
        return cube.signal_power(source, r.waveform)
    return mean_power(source, r.waveform) if without_wall else r.products["echo"].signal_power()


def _slow_time(r: Recording, stage: Stage) -> Complex:
    echo: DirectEcho = r.products["echo"]
    try:
        y, r.accuracy = echo.slow_time()
    except AccuracyError as error:
        if r.config.engine.fallback == "refuse":
            raise SceneError(_refusal(r, error)) from None
        r.fallback = str(error)
        blocks = _beat_blocks(r, 0.0, None)
        return np.concatenate(
            [half_band_signal(range_compression(block, r.waveform)) for _, block in blocks]
        )
    return mti_in_place(y) if r.config.processing.mti else y


def _refusal(r: Recording, error: AccuracyError) -> str:
    tolerance_db = r.config.engine.tolerance_db
    what = f"sample {r.scene.name}: engine.tolerance_db = {tolerance_db:g}: "
    if error.limit_db > MAX_TOLERANCE_DB:
        return what + f"no tolerance can be kept here ({error}); set engine.fallback: cube"
    return what + (
        f"should be {ceil(error.limit_db)} or more, which is what the direct engine reaches here, "
        "or engine.fallback: cube"
    )


def _slow_time_noise(r: Recording, stage: Stage) -> Complex:
    noise = slow_time_noise(r.noise("slow_time"), r.waveform)
    noise *= r.sigma
    return mti_in_place(noise) if r.config.processing.mti else noise


def _beat_blocks(
    r: Recording, sigma: float, rng: np.random.Generator | None
) -> Iterator[tuple[int, Complex]]:
    """(first pulse or pair, beat matrix after MTI where the config has one), block by block."""
    moving = r.config.engine.motion_in_chirp
    for first, block in cube.beat_blocks(r.products["paths"], r.waveform, sigma, rng, moving):
        own = mti(block) if r.config.processing.mti else block[:, (1 if first else 0) :]
        if own.shape[1]:
            yield (first if r.config.processing.mti or not first else first + 1), own


def _beat_cube(r: Recording, stage: Stage) -> CubeProducts:
    wants_signal, wants_range = "signal:plain" in r.plan, "rtm" in r.plan
    rng = r.noise("beat") if "signal_power" in r.plan else None
    kept = r.waveform.n_pulses - r.config.processing.mti
    signal, profiles = np.empty(kept if wants_signal else 0, dtype=complex), []
    for start, own in _beat_blocks(r, r.sigma, rng):
        if wants_range:
            here = r.shown[(r.shown >= start) & (r.shown < start + own.shape[1])]
            profiles.append(range_power(range_bins(own[:, here - start], r.waveform)))
        if wants_signal:
            stop = start + own.shape[1]
            signal[start:stop] = half_band_signal(range_compression(own, r.waveform))
    return CubeProducts(
        signal if wants_signal else None,
        np.concatenate(profiles, axis=1) if profiles else None,
    )


def _range_profiles(r: Recording, stage: Stage) -> Complex:
    beat = beat_at(r.products["paths"], r.waveform, r.shown, _canceller(r))
    bins = range_bins(beat, r.waveform)
    if "range_noise" in r.products:
        bins = bins + r.products["range_noise"]
    return bins


def _range_noise(r: Recording, stage: Stage) -> Complex:
    """Noise of the kept bins. Unpadded, a transform of white noise is white: the bins are drawn."""
    rng, with_mti, w = r.noise("range_profiles"), r.config.processing.mti, r.waveform
    if w.n_fft == w.n_adc:
        scale = r.sigma * np.sqrt(w.n_adc)
        return np.asarray(scale * noise_at(rng, w.n_bins, r.shown, with_mti))
    return range_bins(r.sigma * noise_at(rng, w.n_adc, r.shown, with_mti), w)


def _rtm(r: Recording, stage: Stage) -> Float:
    if "beat_cube" in r.products:
        power = r.products["beat_cube"].range_power
        assert power is not None
        return np.asarray(power)
    return range_power(r.products["range_profiles"])


def _signal(r: Recording, stage: Stage) -> Complex:
    if stage.variant == "plain":
        return _plain_signal(r)
    if stage.variant == "compensated":
        return compensate(r.products["signal:plain"], r.products["torso_track"], r.waveform.f0)
    savgol_config = r.config.processing.savgol
    before = r.products[stage.needs[0]]
    return savgol(before, savgol_config.order, savgol_config.frame)


def _plain_signal(r: Recording) -> Complex:
    if "beat_cube" in r.products:
        return np.asarray(r.products["beat_cube"].signal)
    x: Complex = r.products["slow_time"]
    return x + r.products["slow_time_noise"] if "slow_time_noise" in r.products else x


def _spectrum(r: Recording, stage: Stage) -> Spectra:
    padded = stage.kind == "padded_spectrum"
    length = r.config.processing.stft_fft_length if padded else None
    frames = r.fsst_frames if stage.kind == "fsst_spectrum" else r.frames
    return stft.spectra(r.products[stage.needs[0]], frames, length)


def _stft(r: Recording, stage: Stage) -> Float | LongMap:
    spectra: Spectra = r.products[stage.needs[0]]
    return _map(r, stage, spectra, map(stft.power_map, spectra))


def _fsst(r: Recording, stage: Stage) -> Float | LongMap:
    x, spectra = (r.products[need] for need in stage.needs)
    threshold = r.config.processing.fsst_threshold
    return _map(r, stage, spectra, fsst.power_blocks(x, spectra, r.fsst_frames, threshold))


def _map(r: Recording, stage: Stage, spectra: Spectra, blocks: Iterable[Float]) -> Float | LongMap:
    """The whole map where it is one block or was asked for, else what its image needs."""
    if isinstance(spectra, tuple):
        return next(iter(blocks))
    frames = spectra.frames.count(spectra.x.size)
    if stage.name in r.plan.asked:
        return joined(blocks, frames)
    return LongMap(blocks, frames, r.config.image.size_px)


def _entropy(r: Recording, stage: Stage) -> float:
    power = r.products[stage.variant]
    return power.entropy_bits if isinstance(power, LongMap) else entropy_bits(power)


def _levels(r: Recording, stage: Stage) -> Levels:
    power, image = r.products[stage.variant], r.config.image
    if isinstance(power, LongMap):
        return power.levels(image.dynamic_range_db)
    return levels(power, image.size_px, image.dynamic_range_db)


STAGES: Mapping[str, Callable[[Recording, Stage], Any]] = {
    "wall": _wall,
    "paths": _paths,
    "torso_track": _torso_track,
    "echo": _echo,
    "signal_power": _signal_power,
    "slow_time": _slow_time,
    "slow_time_noise": _slow_time_noise,
    "beat_cube": _beat_cube,
    "range_noise": _range_noise,
    "range_profiles": _range_profiles,
    "rtm": _rtm,
    "signal": _signal,
    "spectrum": _spectrum,
    "padded_spectrum": _spectrum,
    "fsst_spectrum": _spectrum,
    **{
        f"{kind}{suffix}": run_map
        for kind, run_map in (("stft", _stft), ("fsst", _fsst))
        for suffix in ("", "_compensated", "_denoised", "_compensated_denoised")
    },
    "entropy": _entropy,
    "levels": _levels,
}
