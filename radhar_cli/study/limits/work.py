"""Work of a sample, counted: how many times that of another config a config asks for."""

from math import inf

from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.errors import RadharError
from radhar_cli.processing.map_kind import Transform, kind_of
from radhar_cli.scene.radar import board_of, waveform_of
from radhar_cli.scene.scene import nominal_scene

Counts = dict[str, float]


def counted_work(config: Config) -> Counts:
    """Numbers of what a sample of a config consists of; each costs in proportion, at most.

    Pulses, samples of all chirps where they are held, windows times their length, pixels, people
    and points of bodies; of the first activity, by the middle of all draws.
    """
    scene = nominal_scene(config, config.chosen_activities[0])
    w = waveform_of(scene)
    processing, channels = config.processing, 1
    if isinstance(scene.radar, ArrayRadar):
        board = board_of(scene.radar, scene.seconds)
        channels = board.channels
    holds_samples = (
        isinstance(scene.radar, ArrayRadar)
        or config.engine.kind == "cube"
        or "rtm" in config.maps
        or processing.range_sum == "gated"
    )
    pulses = float(w.n_pulses)
    counts = {
        "pulses": pulses,
        "samples": pulses * w.n_fft * channels if holds_samples else 1.0,
        "pixels": float(config.image.size_px[0] * config.image.size_px[1]),
        "people": 1.0 + len(config.people),
        "points": float(config.body.points_per_segment),
    }
    for transform, make in (
        (Transform.STFT, processing.make_frames),
        (Transform.FSST, processing.make_fsst_frames),
    ):
        kinds = [kind for name in config.maps if (kind := kind_of(name)) is not None]
        if any(kind.transform is transform for kind in kinds):
            frames = make(w.duration, w.prf, w.f0)
            length = processing.stft_fft_length or frames.length
            counts[transform.name.lower()] = pulses / max(frames.hop, 1) * length
    return counts


def work_ratio(config: Config, base: Counts) -> float:
    """How many times the work of another config one asks for, at most, by what grows most."""
    try:
        counts = counted_work(config)
    except RadharError:
        return inf
    return max(counts[name] / base[name] for name in base if name in counts)
