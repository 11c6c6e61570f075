"""Margins: the fastest, farthest and nearest that a config draws, and the work of a sample."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.errors import RadharError
from radhar_cli.processing.map_kind import Transform, kind_of
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.radar.propagation import bistatic_delay, leg
from radhar_cli.scene.checks.validity import MIN_DISTANCE_M
from radhar_cli.scene.motion import moving
from radhar_cli.scene.radar import antennas_of, board_of, waveform_of
from radhar_cli.scene.scene import Scene, nominal_scene

CHECKS_PER_S = 200.0
MOST_CHECKS = 4000
MOST_CYCLES = 1e10  # of phase, beyond which float64 is off by 1e-6 of a cycle


@dataclass(frozen=True)
class Reach:
    """Distances and speed of the joints of a scene."""

    farthest: float  # largest bistatic range, half of the way from antenna to antenna, m
    nearest: float  # least distance of a joint from an antenna, m
    fastest: float  # largest speed along the way, m/s


@dataclass(frozen=True)
class Margin:
    """Extreme number that a config draws, beside the limit of its radar or of the arithmetic."""

    name: str
    drawn: float  # the extreme of all scenes that were drawn
    limit: float  # where it ends
    unit: str  # unit of both
    source: str  # what ends there: model or arithmetic
    beyond: str  # what happens beyond


def reach_of(scene: Scene) -> Reach:
    """Find how far and how fast the joints of everybody in a scene are."""
    antennas = antennas_of(scene)
    count = min(max(int(CHECKS_PER_S * scene.seconds), 2), MOST_CHECKS)
    t = np.linspace(0, scene.seconds, count)
    farthest, nearest, fastest = 0.0, np.inf, 0.0
    for person in scene.people:
        p = moving(person).positions(t)
        legs = leg(p, antennas.tx), leg(p, antennas.rx)
        r = bistatic_delay(*legs) * (SPEED_OF_LIGHT / 2)
        farthest = max(farthest, float(r.max()))
        nearest = min(nearest, float(legs[0].min()), float(legs[1].min()))
        fastest = max(fastest, float(np.abs(np.diff(r)).max() / (t[1] - t[0])))
    return Reach(farthest, nearest, fastest)


def margins_of(scenes: Sequence[Scene], reaches: Sequence[Reach]) -> list[Margin]:
    """Compare what scenes of a config draw with what its radar tells apart."""
    waveforms = [waveform_of(scene) for scene in scenes]
    farthest = max(reach.farthest for reach in reaches)
    cycles = 2 * farthest / min(w.wavelength for w in waveforms)
    margins = [
        Margin(
            "fastest joint, along the line of sight",
            max(reach.fastest for reach in reaches),
            min(w.highest_speed for w in waveforms),
            *("m/s", "model", "its Doppler folds: warned"),
        ),
        Margin(
            *("farthest joint", farthest, min(w.half_band_range for w in waveforms), "m", "model"),
            "its echo leaves the range axis: on_invalid decides, or warned",
        ),
        Margin(
            "nearest joint to an antenna",
            min(reach.nearest for reach in reaches),
            *(MIN_DISTANCE_M, "m", "model", "the far field ends: drawn again, or refused"),
        ),
        Margin(
            *("cycles of phase of the farthest echo", cycles, MOST_CYCLES, "", "arithmetic"),
            "float64 is off by 1e-6 of a cycle: nothing says so",
        ),
    ]
    return margins if scenes[0].radar.has_range else [margins[0], *margins[2:]]


def counted_work(config: Config) -> dict[str, float]:
    """Counts of the parts of a sample of a config; each costs in proportion, at most.

    Pulses, samples of all chirps where they are held, windows times their length, pixels, people
    and points of bodies; of the first activity, by the middle of all draws.
    """
    scene = nominal_scene(config, config.chosen_activities[0])
    w, processing = waveform_of(scene), config.processing
    radar = scene.radar
    is_array = isinstance(radar, ArrayRadar)
    channels = board_of(radar, scene.seconds).channels if isinstance(radar, ArrayRadar) else 1
    is_cube = config.engine.kind == "cube" or processing.range_sum == "gated"
    holds_samples = is_array or is_cube or "rtm" in config.maps
    pulses = float(w.n_pulses)
    counts = {
        "pulses": pulses,
        "samples": pulses * w.n_fft * channels if holds_samples else 1.0,
        "pixels": float(config.image.size_px[0] * config.image.size_px[1]),
        "people": 1.0 + len(config.people),
        "points": float(config.body.points_per_segment),
    }
    kinds = [kind for name in config.maps if (kind := kind_of(name)) is not None]
    for transform, make in (
        (Transform.STFT, processing.make_frames),
        (Transform.FSST, processing.make_fsst_frames),
    ):
        if any(kind.transform is transform for kind in kinds):
            frames = make(w.duration, w.prf, w.f0)
            length = processing.stft_fft_length or frames.length
            counts[transform.name.lower()] = pulses / max(frames.hop, 1) * length
    return counts


def work_ratio(config: Config, base: dict[str, float]) -> float:
    """Return the largest ratio of a config's counts of work to those of `base`; inf if refused."""
    try:
        counts = counted_work(config)
    except RadharError:
        return inf
    return max(counts[name] / base[name] for name in base if name in counts)
