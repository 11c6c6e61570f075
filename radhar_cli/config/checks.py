"""Checks that span several sections of a config, and what to warn of in it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from radhar_cli.activity import Activity
from radhar_cli.config.number import nominal, support
from radhar_cli.rounding import half_up

if TYPE_CHECKING:
    from radhar_cli.config.schema import Config

MIN_WINDOW = 8
MAX_PULSES = 2**24
MAX_PADDING = 64


class Problem(NamedTuple):
    """One cross-field mistake: dotted key, the value found, what would be right."""

    key: str
    value: object
    right: str


def problems(c: Config) -> Iterator[Problem]:
    yield from _waveform_problems(c)
    yield from _signal_problems(c)
    yield from _wall_problems(c)
    if c.motion.model == "human":
        yield from _human_problems(c)
    elif c.classes:
        yield Problem("classes", list(c.classes), "should be none with motion.model: paper")
    if c.engine.motion_in_chirp and c.engine.kind == "direct":
        yield Problem(
            "engine.motion_in_chirp",
            True,
            "should be false with engine.kind: direct, which freezes positions during a chirp; "
            "engine.kind: cube can have it",
        )
    split = c.split
    if split.subjects is not None and split.subjects > c.samples_per_class:
        yield Problem(
            "split.subjects",
            split.subjects,
            f"should be at most samples_per_class = {c.samples_per_class}: "
            "every person performs every activity",
        )


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
    window = half_up(processing.window_fraction, duration[0], prf[0])
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
    if doppler and window < MIN_WINDOW:
        yield Problem(
            "duration_s",
            c.duration_s,
            f"should make the window of {processing.window_fraction:g} * duration_s * prf_hz at "
            f"least {MIN_WINDOW} pulses (it has {window}): radar.prf_hz may be {prf[0]:g}",
        )
    kept = pulses - 1 if processing.mti else pulses
    if doppler and window > kept:
        yield Problem(
            "processing.window_fraction",
            processing.window_fraction,
            f"should make the window at most the {kept} pulses there are (it has {window})",
        )
    if any("denoised" in name for name in doppler) and processing.savgol.frame > kept:
        yield Problem(
            "processing.savgol.frame",
            processing.savgol.frame,
            f"should be at most the {kept} pulses there are",
        )
    longest = half_up(processing.window_fraction, duration[1], prf[1])
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
    ("motion.ragged_speed", 0.0, 0.06),
    ("motion.stride_jitter", 0.0, 0.03),
    ("motion.width_jitter_m", 0.0, 0.02),
    ("motion.punch_hz", 0.05, 1.1),
    ("motion.kick_hz", 0.05, 0.6),
    ("motion.rotation_hz", 0.0, 1.0),
    ("motion.turn_deg", -90.0, 90.0),
    ("motion.strike_scale", 0.8, 1.25),
    ("motion.tempo_jitter", 0.0, 0.2),
    ("motion.size_jitter", 0.0, 0.15),
    ("motion.bend_deg", 30.0, 85.0),
    ("motion.dwell_s", 0.0, 60.0),
    ("motion.seat_height", 0.24, 0.33),
    ("motion.lean_deg", 0.0, 60.0),
    ("motion.recline_deg", -10.0, 45.0),
    ("motion.fidget_hz", 0.0, 2.0),
    ("motion.fidget_size", 0.0, 2.0),
    ("motion.shuffle_hz", 0.0, 0.5),
    ("timing.seat_duration_s", 1.0, 60.0),
    ("timing.grab_duration_s", 1.0, 60.0),
    ("timing.rise_duration_s", 1.0, 60.0),
    ("timing.sit_duration_s", 1.0, 60.0),
    ("timing.fall_duration_s", 0.7, 10.0),
    ("timing.overlap_s", 0.0, 0.8),
    ("timing.walk_stop_s", 0.5, 600.0),
    ("timing.walk_start_s", 0.0, 600.0),
)


def _human_problems(c: Config) -> Iterator[Problem]:
    """Numbers beyond what people do, of the activities that depend on them."""
    from radhar_cli.config.schema import for_activity

    lying = [slug for slug, one in c.classes.items() if _gets_up_after_a_fall(one.sequence)]
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


def timing_warnings(c: Config, activities: Iterable[Activity] | None = None) -> list[str]:
    """Say which activities never reach their second phase within the recording."""
    from radhar_cli.config.schema import for_activity

    length = nominal(c.duration_s)
    found = []
    for activity in c.chosen_activities if activities is None else activities:
        for key in ("seat_start_s", "walk_start_s", "walk_stop_s"):
            number = for_activity(getattr(c.timing, key), activity)
            if f"timing.{key}" not in activity.uses(c.motion.model) or number is None:
                continue
            start = nominal(number)
            if start >= length:
                found.append(
                    f"{activity.label} {activity.slug}: timing.{key} = {start:g} s is not before "
                    f"the end of the recording, {length:g} s: its second phase is never seen"
                )
    return found
