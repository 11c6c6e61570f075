"""Checks that span several sections of a config, and what to warn of in it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

from radhar_cli.activity import ACTIVITIES, DEFAULT, Activity, activity_named, own_activities
from radhar_cli.config.number import nominal, support
from radhar_cli.light import SPEED_OF_LIGHT
from radhar_cli.rounding import half_up

if TYPE_CHECKING:
    from radhar_cli.config.schema import Config

MIN_WINDOW = 8
MAX_PULSES = 2**24
MAX_PADDING = 64
MAX_BIN_SAMPLES = 2**27  # of range bins in memory, 16 bytes each
MIN_CUTOFF = 1e-4  # of PRF/2; below, rounding spoils a filter of order 10 in float64


class Problem(NamedTuple):
    """One cross-field mistake: dotted key, the value found, what would be right."""

    key: str
    value: object
    right: str


def problems(c: Config) -> Iterator[Problem]:
    if not c.chosen_activities:
        yield Problem("classes", {}, "should have files of each class with motion.model: file")
        return
    yield from _unknown_activities(c)
    yield from _waveform_problems(c)
    yield from _signal_problems(c)
    yield from _clutter_problems(c)
    yield from _gate_problems(c)
    yield from _wall_problems(c)
    yield from _back_wall_problems(c)
    yield from _image_problems(c)
    if c.motion.model == "human":
        yield from _human_problems(c)
    yield from _class_problems(c)
    if c.engine.motion_in_chirp and c.engine.kind == "direct":
        yield Problem(
            "engine.motion_in_chirp",
            True,
            "should be false with engine.kind: direct, which freezes positions during a chirp; "
            "engine.kind: cube can have it",
        )
    split = c.split
    fewest = min(c.chosen_activities, key=c.samples_of)
    if split.subjects is not None and split.subjects > c.samples_of(fewest):
        whose = "" if isinstance(c.samples_per_class, int) else f" of {fewest.slug}"
        yield Problem(
            "split.subjects",
            split.subjects,
            f"should be at most samples_per_class = {c.samples_of(fewest)}{whose}: "
            "every person performs every activity",
        )


def _class_problems(c: Config) -> Iterator[Problem]:
    """Classes that the model of motion cannot make."""
    model = c.motion.model
    for slug, one in c.classes.items():
        if model != "human" and hasattr(one, "sequence"):
            right = f"should have files with motion.model: {model}; sequences are of people (human)"
            yield Problem(f"classes.{slug}", list(one.sequence), right)
    if model != "file":
        return
    for activity in c.chosen_activities:
        if activity.motion is None and activity.slug not in c.classes:
            right = "should have files of it under classes, or motion.model: human makes it"
            yield Problem("activities", activity.slug, right)


def _unknown_activities(c: Config) -> Iterator[Problem]:
    """Names under `per_activity` that are neither an activity nor a user-defined class."""
    from radhar_cli.config.schema import PerActivity, class_activities

    own = class_activities(c.classes)
    names = {DEFAULT, *(a.slug for a in (*ACTIVITIES, *own.values(), *own_activities()))}
    values: dict[str, object] = {"samples_per_class": c.samples_per_class}
    for name in ("motion", "timing"):
        section = getattr(c, name)
        values |= {f"{name}.{key}": getattr(section, key) for key in type(section).model_fields}
    for key, value in values.items():
        for slug, number in value.per_activity.items() if isinstance(value, PerActivity) else ():
            if slug in names:
                continue
            try:
                advice = f"should be called {activity_named(slug, own).slug}"
            except ValueError as error:
                advice = str(error)
            yield Problem(f"{key}.per_activity.{slug}", number, advice)


def _waveform_problems(c: Config) -> Iterator[Problem]:
    radar = c.radar
    shortest_interval = 1 / support(radar.prf_hz)[1]
    if not support(radar.chirp_s)[1] < shortest_interval:
        yield Problem(
            "radar.chirp_s",
            radar.chirp_s,
            f"should be shorter than the pulse interval 1/prf_hz = {shortest_interval:g} s",
        )
    fewest = half_up(support(radar.adc_rate_hz)[0], support(radar.chirp_s)[0])
    most = half_up(support(radar.adc_rate_hz)[1], support(radar.chirp_s)[1])
    if fewest < 2:
        yield Problem(
            "radar.adc_rate_hz",
            radar.adc_rate_hz,
            f"should give at least 2 ADC samples per chirp (adc_rate_hz * chirp_s is {fewest})",
        )
    if most > 2**20:
        yield Problem(
            "radar.adc_rate_hz",
            radar.adc_rate_hz,
            f"should give at most {2**20} ADC samples per chirp (adc_rate_hz * chirp_s is {most})",
        )
    fft_length = c.processing.range_fft_length
    if fft_length is not None and fft_length < most:
        yield Problem(
            "processing.range_fft_length",
            fft_length,
            f"should be null or an even number of at least the {most} ADC samples",
        )
    if fft_length is not None and fft_length > MAX_PADDING * fewest:
        yield Problem(
            "processing.range_fft_length",
            fft_length,
            f"should be null or at most {MAX_PADDING} times the {fewest} ADC samples",
        )


def _signal_problems(c: Config) -> Iterator[Problem]:
    processing = c.processing
    duration, prf = support(c.duration_s), support(c.radar.prf_hz)
    pulses = half_up(duration[0], prf[0])
    window = processing.window_pulses(duration[0], prf[0], _doppler_carrier(c, 1))
    most = half_up(duration[1], prf[1])
    if most > MAX_PULSES:
        yield Problem(
            "duration_s",
            c.duration_s,
            f"should give at most {MAX_PULSES} pulses (duration_s * prf_hz is {most}): "
            f"radar.prf_hz may be {prf[1]:g}",
        )
    doppler = [name for name in c.maps if name != "rtm"]
    if pulses < 2:
        yield Problem(
            "duration_s", c.duration_s, f"should hold at least 2 pulses (it holds {pulses})"
        )
    of_window: tuple[str, object] = ("processing.window_s", processing.window_s)
    if "window_s" not in processing.model_fields_set:
        of_window = ("duration_s", c.duration_s)
    if doppler and window < MIN_WINDOW:
        yield Problem(
            *of_window,
            f"should make the window of window_s * prf_hz at least {MIN_WINDOW} pulses "
            f"(it has {window}): radar.prf_hz may be {prf[0]:g}",
        )
    kept = pulses - 1 if processing.clutter == "difference" else pulses
    if doppler and window > kept:
        yield Problem(
            *of_window,
            f"should make the window at most the {kept} pulses there are (it has {window})",
        )
    if any("denoised" in name for name in doppler) and processing.savgol.frame > kept:
        yield Problem(
            "processing.savgol.frame",
            processing.savgol.frame,
            f"should be at most the {kept} pulses there are",
        )
    longest = processing.window_pulses(duration[1], prf[1], _doppler_carrier(c, 0))
    if processing.stft_fft_length is not None and processing.stft_fft_length < longest:
        yield Problem(
            "processing.stft_fft_length",
            processing.stft_fft_length,
            f"should be null or at least the window of {longest} pulses",
        )
    padded = MAX_PADDING * max(window, MIN_WINDOW)
    if processing.stft_fft_length is not None and processing.stft_fft_length > padded:
        yield Problem(
            "processing.stft_fft_length",
            processing.stft_fft_length,
            f"should be null or at most {MAX_PADDING} times the window of {window} pulses",
        )


def _clutter_problems(c: Config) -> Iterator[Problem]:
    processing, prf = c.processing, support(c.radar.prf_hz)
    given = processing.highpass.cutoff_hz
    if processing.clutter == "highpass" and given is not None:
        least, most = 2 * given / prf[1], 2 * given / prf[0]
        if most >= 1 or least < MIN_CUTOFF:
            yield Problem(
                "processing.highpass.cutoff_hz",
                given,
                f"should be from {MIN_CUTOFF:g} times PRF/2 to below PRF/2 in every scene "
                f"(it is {least:g} to {most:g} times PRF/2)",
            )
    if "rtm" in c.maps and processing.clutter in ("mean", "highpass"):
        bins = (processing.range_fft_length or _max_samples(c) + 1) // 2
        yield from _too_many(c, bins, "processing.clutter", processing.clutter, "the rtm")


def _gate_problems(c: Config) -> Iterator[Problem]:
    processing = c.processing
    if processing.range_sum != "gated":
        return
    fsst = [name for name in c.maps if name.startswith("fsst")]
    if fsst:
        yield Problem(
            "maps",
            fsst,
            "should be stft maps and rtm with processing.range_sum: gated, which adds up powers of "
            "bins: the fsst moves coefficients by their phase",
        )
    within = processing.gate_m
    rate, chirp = support(c.radar.adc_rate_hz), support(c.radar.chirp_s)
    bandwidth = support(c.radar.bandwidth_hz)
    half_band = SPEED_OF_LIGHT * rate[0] * chirp[0] / (4 * bandwidth[1])  # c fs/(4 K), the least
    if isinstance(within, tuple):
        if within[1] >= half_band:
            yield Problem(
                "processing.gate_m",
                list(within),
                f"should end before the range half-band does, at {half_band:.4g} m",
            )
    elif 2 * within >= half_band:
        yield Problem(
            "processing.gate_m",
            within,
            "should reach so far to both sides that the gate is narrower than the range "
            f"half-band of {half_band:.4g} m",
        )
    bins = (processing.range_fft_length or _max_samples(c) + 1) // 2
    yield from _too_many(c, bins, "processing.range_sum", "gated", "the gate")


def _too_many(c: Config, bins: int, key: str, value: object, what: str) -> Iterator[Problem]:
    """A request for which range bins of all pulses have to be held."""
    pulses = half_up(support(c.duration_s)[1], support(c.radar.prf_hz)[1])
    if bins * pulses > MAX_BIN_SAMPLES:
        yield Problem(
            key,
            value,
            f"should not go with {pulses} pulses of {bins} range bins: for {what} they are held "
            f"at once, {MAX_BIN_SAMPLES} samples at most",
        )


def _max_samples(c: Config) -> int:
    return half_up(support(c.radar.adc_rate_hz)[1], support(c.radar.chirp_s)[1])


def _wall_problems(c: Config) -> Iterator[Problem]:
    if c.wall is None:
        return
    for name in ("tx_m", "rx_m"):
        antenna = getattr(c.radar, name)
        inside = True
        for at, centre, size in zip(antenna, c.wall.center_m, c.wall.size_m, strict=True):
            half = support(size)[1] / 2
            low, high = support(centre)[0] - half, support(centre)[1] + half
            inside &= support(at)[0] <= high and support(at)[1] >= low
        if inside:
            yield Problem(
                f"radar.{name}",
                list(antenna),
                "should be outside the wall, whose faces count as inside "
                f"(wall.center_m = {list(c.wall.center_m)}, wall.size_m = {list(c.wall.size_m)})",
            )


def _back_wall_problems(c: Config) -> Iterator[Problem]:
    from radhar_cli.config.schema import for_activity

    key, at = "room.back_wall_m", c.room.back_wall_m
    if at is None:
        return
    if c.wall is not None:
        yield Problem(key, at, "should be null with a wall in front: one of the two is simulated")
    given: Any = c.motion.range_m
    farthest = 0.0
    if given is not None:
        farthest = max(support(for_activity(given, one))[1] for one in c.chosen_activities)
    if support(at)[0] <= farthest:
        yield Problem(
            key,
            at,
            f"should be beyond the people, who stand at up to {farthest:g} m (motion.range_m)",
        )


def _flickers(c: Config) -> bool:
    return support(c.receiver.noise_corner_hz)[1] > 0


def _image_problems(c: Config) -> Iterator[Problem]:
    for key, extra in (("tones", c.receiver.tones), ("noise_corner_hz", _flickers(c))):
        if extra and c.snr_db is None:
            yield Problem(
                "snr_db", None, f"should be a number: receiver.{key} is relative to the noise"
            )
    cfar, size = c.image.cfar, c.image.size_px
    reach = [2 * (g + t) + 1 for g, t in zip(cfar.guard, cfar.training, strict=True)]
    if c.image.kind == "cfar" and not any(cfar.training):
        yield Problem("image.cfar.training", list(cfar.training), "should be 1 or more of a side")
    if c.image.kind == "cfar" and any(r > px for r, px in zip(reach, size, strict=True)):
        yield Problem(
            "image.cfar.training",
            list(cfar.training),
            f"should fit into the image of {size[0]} x {size[1]} pixels: with the guard cells "
            f"{list(cfar.guard)} on each side it takes {reach[0]} x {reach[1]}",
        )
    limits = c.image.doppler_limits_mps
    if limits is None or set(c.maps) == {"rtm"}:
        return
    prf, duration = support(c.radar.prf_hz), support(c.duration_s)
    fastest = SPEED_OF_LIGHT * prf[0] / (4 * _doppler_carrier(c, 1))
    if max(-limits[0], limits[1]) > fastest * (1 + 1e-9):
        yield Problem(
            "image.doppler_limits_mps",
            list(limits),
            f"should be within the unambiguous band, -{fastest:.6g} to {fastest:.6g} m/s "
            f"(c prf_hz / 4 f0: radar.prf_hz may be {prf[0]:g})",
        )
    window = c.processing.window_pulses(duration[0], prf[0], _doppler_carrier(c, 1))
    step = SPEED_OF_LIGHT * prf[0] / (2 * _doppler_carrier(c, 0) * max(window, 1))
    if limits[1] - limits[0] < 2 * step:
        yield Problem(
            "image.doppler_limits_mps",
            list(limits),
            f"should hold at least 2 Doppler bins (one has {step:.3g} m/s)",
        )


def _doppler_carrier(c: Config, end: int) -> float:
    """Lowest (0) or highest (1) frequency at which the Doppler is read, Hz."""
    centred = c.processing.range_reference == "centre"
    samples = [
        (half_up(rate, chirp), rate * chirp)
        for rate in support(c.radar.adc_rate_hz)
        for chirp in support(c.radar.chirp_s)
    ]
    shares = sorted(count / 2 / exact for count, exact in samples)
    share = shares[-end] if centred else 0.0
    return support(c.radar.carrier_hz)[end] + share * support(c.radar.bandwidth_hz)[end]


def _gets_up_after_a_fall(names: tuple[str, ...]) -> bool:
    return ("falling", "getting_up") in pairwise(names)


# Where the motion of people holds: (key, least, most). Beyond, legs would be too short.
HUMAN_LIMITS: tuple[tuple[str, float, float], ...] = (
    ("duration_s", 0.0, 600.0),
    ("subject.height_m", 1.5, 2.1),
    ("subject.sway_ahead_m", 0.0, 0.01),
    ("subject.sway_aside_m", 0.0, 0.01),
    ("subject.chest_m", 0.0, 0.01),
    ("subject.heart_m", 0.0, 0.002),
    ("subject.breathing_hz", 0.0, 2.0),
    ("subject.pulse_hz", 0.0, 4.0),
    ("motion.speed_mps", 0.3, 2.8),
    ("motion.period_scale", 0.85, 1.05),
    ("motion.cycle_phase", -1.0, 1.0),
    ("motion.arm_swing", 0.0, 2.0),
    ("motion.trunk_pitch_deg", -5.0, 15.0),
    ("motion.step_width", 0.02, 0.1),
    ("motion.step_asymmetry", -0.05, 0.05),
    ("motion.speed_ripple", 0.0, 0.2),
    ("motion.speed_ripple_asymmetry", -0.1, 0.1),
    ("motion.speed_variation", 0.0, 0.06),
    ("motion.stride_jitter", 0.0, 0.03),
    ("motion.width_jitter_m", 0.0, 0.02),
    ("motion.lane_m", 0.0, 1000.0),
    ("motion.lane_start", 0.0, 1.0),
    ("motion.speed_up", 0.4, 2.0),
    ("motion.punch_hz", 0.05, 1.1),
    ("motion.kick_hz", 0.05, 0.6),
    ("motion.rotation_hz", 0.0, 1.0),
    ("motion.turn_deg", -90.0, 90.0),
    ("motion.strike_scale", 0.8, 1.25),
    ("motion.tempo_jitter", 0.0, 0.2),
    ("motion.size_jitter", 0.0, 0.15),
    ("motion.bend_deg", 30.0, 85.0),
    ("motion.dwell_s", 0.0, 60.0),
    ("motion.rise_overlap", 0.0, 0.6),
    ("motion.seat_height", 0.24, 0.33),
    ("motion.lean_deg", 0.0, 60.0),
    ("motion.recline_deg", -10.0, 45.0),
    ("motion.recline_from", 0.0, 1.0),
    ("motion.hands_on_lap", 0.0, 1.0),
    ("motion.squat", -1.0, 1.0),
    ("motion.reach_deg", -10.0, 60.0),
    ("motion.free_arm", -0.5, 1.0),
    ("motion.joint_lag", 0.0, 0.6),
    ("motion.step_m", 0.0, 0.5),
    ("motion.look_deg", -60.0, 60.0),
    ("motion.settle_size", 0.0, 3.0),
    ("motion.kneel_s", 0.0, 3.0),
    ("motion.heels_deg", 0.0, 90.0),
    ("motion.fidget_hz", 0.0, 2.0),
    ("motion.fidget_size", 0.0, 2.0),
    ("motion.shuffle_hz", 0.0, 0.5),
    ("timing.seat_duration_s", 1.0, 60.0),
    ("timing.grab_duration_s", 1.0, 60.0),
    ("timing.rise_duration_s", 1.0, 60.0),
    ("timing.sit_duration_s", 1.0, 60.0),
    ("timing.fall_duration_s", 0.7, 10.0),
    ("timing.overlap_s", 0.0, 0.8),
    ("timing.walk_begin_s", 0.0, 600.0),
    ("timing.walk_stop_s", 0.5, 600.0),
    ("timing.walk_start_s", 0.0, 600.0),
)


def _human_problems(c: Config) -> Iterator[Problem]:
    """Numbers beyond what people do, of the activities that depend on them."""
    from radhar_cli.config.schema import for_activity

    sequences = {slug: getattr(one, "sequence", ()) for slug, one in c.classes.items()}
    lying = [slug for slug, names in sequences.items() if _gets_up_after_a_fall(names)]
    if lying and c.motion.fall != "forward":
        yield Problem(
            "motion.fall",
            c.motion.fall,
            f"should be forward: classes.{lying[0]} gets up from lying on the belly",
        )
    for key, low, high in HUMAN_LIMITS:
        section, _, name = key.rpartition(".")
        number = getattr(getattr(c, section) if section else c, name)
        for activity in c.chosen_activities:
            used = key in activity.human or key.startswith("motion.fidget_")
            if section in ("motion", "timing") and not used:
                continue
            if number is None:
                continue
            least, most = support(for_activity(number, activity))
            if least < low or most > high:
                yield Problem(
                    key,
                    number,
                    f"should be from {low:g} to {high:g} with motion.model: human "
                    f"(this one reaches from {least:g} to {most:g})",
                )
                break


def line_warnings(c: Config) -> list[str]:
    """Say which interference tones alias."""
    warnings = []
    prf = support(c.radar.prf_hz)[0]
    for number, line in enumerate(c.receiver.tones):
        least, most = support(line.doppler_hz)
        if max(-least, most) > prf / 2:
            warnings.append(
                f"receiver.tones.{number}.doppler_hz reaches beyond PRF/2 = {prf / 2:g} Hz: the "
                "line aliases, to that frequency less a multiple of the PRF"
            )
    return warnings


def timing_warnings(c: Config, activities: Iterable[Activity] | None = None) -> list[str]:
    """Say which movements begin after the end of the recording."""
    from radhar_cli.config.schema import for_activity

    length = nominal(c.duration_s)
    warnings = []
    for activity in c.chosen_activities if activities is None else activities:
        for key in ("seat_start_s", "walk_begin_s", "walk_start_s", "walk_stop_s"):
            number = for_activity(getattr(c.timing, key), activity)
            if f"timing.{key}" not in activity.uses(c.motion.model) or number is None:
                continue
            start = nominal(number)
            if start >= length:
                warnings.append(
                    f"{activity.label} {activity.slug}: timing.{key} = {start:g} s is not before "
                    f"the end of the recording, {length:g} s: what begins then is never seen"
                )
    return warnings
