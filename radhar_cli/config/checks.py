"""Checks that span several sections of a config, and what to warn of in it."""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from math import ceil
from typing import Any, NamedTuple

from radhar_cli.activities.activity import (
    ACTIVITIES,
    DEFAULT,
    Activity,
    activity_named,
    own_activities,
)
from radhar_cli.config.annotations import Limits, People, at, of_kind
from radhar_cli.config.number import MAX_NUMBER, nominal, support
from radhar_cli.config.schema import (
    FRAME_MAPS,
    MAP_NAMES,
    MIN_WINDOW,
    OF_FRAMES,
    OF_POINTS,
    AnyConfig,
    Config,
    ConfigOfRecordings,
    MeasuredConfig,
    PerActivity,
    ProcessedConfig,
    SequenceConfig,
    WallConfig,
    class_activities,
    for_activity,
    why_no_map,
)
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.radar.board import DEVICES
from radhar_cli.radar.impulse import Impulse
from radhar_cli.radar.waveform import Waveform

MAX_PULSES = 2**24
MAX_PADDING = 64
MAX_CUBE = 2**27  # samples of all channels
BOARD_PRODUCTS = (*FRAME_MAPS, *OF_POINTS, "points_kind", *OF_FRAMES, "cube")
MAX_BIN_SAMPLES = 2**27  # of range bins in memory, 16 bytes each
MIN_CUTOFF = 1e-4  # of PRF/2; below, rounding spoils a filter of order 10 in float64


class Problem(NamedTuple):
    """A mistake that spans several keys: dotted key, its value, and what would be right."""

    key: str
    value: object
    right: str


def problems(c: Config) -> Iterator[Problem]:
    """Find what does not go together in a config with its defaults filled in.

    Args:
        c: the config; of a `ConfigOfRecordings` the keys of recordings alone are checked, of a
            `ProcessedConfig` those of the processing.
    """
    if isinstance(c, ConfigOfRecordings):
        radar_problems = _board_problems(c) if c.radar.cfg else _impulse_problems(c)
        measured_sections = MeasuredConfig.model_fields
        yield from (
            problem
            for problem in radar_problems
            if problem.key.partition(".")[0] in measured_sections
        )
        return
    if isinstance(c, ProcessedConfig):  # windows are shortened, or refused, where gaps are known
        lengths = ("duration_s", "processing.window_s", "processing.savgol.frame")
        mistakes = (*_profile_problems(c), *_processing_problems(c))
        yield from (problem for problem in mistakes if problem.key not in lengths)
        return
    if not c.chosen_activities:
        yield Problem("classes", {}, "should have files of each class with motion.model: file")
        return
    yield from _unknown_activities(c)
    if c.radar.cfg is not None:
        yield from _board_problems(c)
    else:
        of_boards = [name for name in c.output.products if name in BOARD_PRODUCTS]
        if of_boards:
            right = "should have the board that makes them: radar.cfg"
            yield Problem("output.products", of_boards, right)
        yield from _step_problems(c)
        yield from _impulse_problems(c)
    yield from _processing_problems(c)
    yield from _wall_problems(c)
    yield from _back_wall_problems(c)
    yield from _room_problems(c)
    yield from _tone_problems(c)
    if c.motion.model == "human":
        yield from _human_problems(c)
    yield from _class_problems(c)
    yield from _people_problems(c)
    if c.engine.motion_in_chirp and c.engine.kind == "direct":
        right = "should be false with engine.kind: direct, which freezes a chirp; cube can have it"
        yield Problem("engine.motion_in_chirp", True, right)
    split = c.split
    fewest = min(c.chosen_activities, key=c.samples_of)
    if split.subjects is not None and split.subjects > c.samples_of(fewest):
        whose = "" if isinstance(c.samples_per_class, int) else f" of {fewest.slug}"
        most = f"samples_per_class = {c.samples_of(fewest)}{whose}"
        right = f"should be at most {most}: every person performs every activity"
        yield Problem("split.subjects", split.subjects, right)


def measured_problems(c: MeasuredConfig) -> Iterator[Problem]:
    """Find what does not go together in a data set of recordings."""
    if not c.recordings.counts:
        right = "should be at most as long as the longest part of a recording"
        yield Problem("recordings.window_s", c.recordings.window_s, right)
    if others := [name for name in c.maps if name not in MAP_NAMES]:
        right = f"should be some of {', '.join(MAP_NAMES)}; `radhar process` makes those of boards"
        yield Problem("maps", others, right)
    for key in ("column_labels", "slow_time", "products"):
        if value := getattr(c.output, key):
            yield Problem(f"output.{key}", value, "should be left out: recordings have none")
    named = {part.person for part in c.recordings.parts}
    if c.split.subjects is not None and (None in named or c.split.subjects != len(named)):
        right = f"should be the number of persons, {len(named - {None})}; every part names one"
        yield Problem("split.subjects", c.split.subjects, right)
    yield from _profile_problems(c)
    yield from _processing_problems(c)


def map_problem(c: AnyConfig, names: Iterable[str]) -> Problem | None:
    """Find the maps that the radar of a config cannot make, and say why; None if it makes all."""
    reasons = {name: why for name in names if (why := why_no_map(c, name)) is not None}
    if not reasons:
        return None
    possible = [name for name in (*MAP_NAMES, *FRAME_MAPS) if why_no_map(c, name) is None]
    right = f"should be some of {', '.join(possible)}"
    return Problem("maps", list(reasons), f"{right}: {'; '.join(dict.fromkeys(reasons.values()))}")


def problems_of_maps(c: Config, names: tuple[str, ...]) -> list[Problem]:
    """Find what keeps a config's radar and processing from making maps of other names."""
    return list(_processing_problems(c.model_copy(update={"maps": names})))


def _processing_problems(c: AnyConfig) -> Iterator[Problem]:
    names = c.maps if isinstance(c, Config) else [one for one in c.maps if one in MAP_NAMES]
    if (of_maps := map_problem(c, names)) is not None:
        yield of_maps
    if c.radar.cfg is None:
        yield from _waveform_problems(c)
        yield from _clutter_problems(c)
    yield from _signal_problems(c)
    yield from _gate_problems(c)
    yield from _image_problems(c)


def _step_problems(c: Config) -> Iterator[Problem]:
    """Keys of stepped frequencies that do not fit together."""
    radar = c.radar
    for key in ("steps", "dwell_s"):
        value = getattr(radar, key)
        if (value is None) == (radar.waveform == "sfcw"):
            right = "should be given" if value is None else "should be null"
            yield Problem(f"radar.{key}", value, f"{right} with radar.waveform: {radar.waveform}")
    if radar.output == "real" and radar.waveform != "cw":
        right = f"should be iq with radar.waveform: {radar.waveform}; cw alone can be real"
        yield Problem("radar.output", "real", right)
    if radar.waveform == "cw":
        if c.processing.range_sum == "gated":
            right = "should be coherent with radar.waveform: cw, which has no range"
            yield Problem("processing.range_sum", "gated", right)
        right = "should be false with radar.waveform: cw, which has no chirp"
        for key in ("radar.residual_video_phase", "engine.motion_in_chirp"):
            if at(c, key):
                yield Problem(key, True, right)
    for key, number in radar.chirp_keys.items():
        value = getattr(radar, key)
        if not (isinstance(value, (int, float)) and abs(value - number) <= 1e-9 * number):
            gives = f"gives {number:.17g}" if radar.waveform == "sfcw" else "has none"
            right = f"should be left out: radar.waveform: {radar.waveform} {gives}"
            yield Problem(f"radar.{key}", value, right)


def _impulse_problems(c: Config) -> Iterator[Problem]:
    """Keys that an impulse radar alone may have, and keys that it may not have."""
    yield from _profile_problems(c)
    if c.radar.waveform != "impulse":
        return
    radar, of = c.radar, "with radar.waveform: impulse"
    if c.engine.kind == "cube":
        yield Problem("engine.kind", "cube", f"should be direct {of}, which has no beat")
    if c.output.slow_time:
        yield Problem("output.slow_time", True, f"should be false {of}: there is no sum over range")
    if radar.residual_video_phase:
        yield Problem("radar.residual_video_phase", True, f"should be false {of}")
    if c.snr_db is None and c.receiver.noise_figure_db is not None:
        right = f"should be null {of}: how many pulses its samples are means of is not said; snr_db"
        yield Problem("receiver.noise_figure_db", c.receiver.noise_figure_db, right)
    for key in ("receiver.noise_corner_hz", "receiver.tones"):
        if at(c, key) not in (0, ()):
            yield Problem(key, at(c, key), f"should be left out {of}, whose samples are real")


def _profile_problems(c: AnyConfig) -> Iterator[Problem]:
    """Keys that do not fit range profiles, or chirps, simulated or recorded."""
    radar, of = c.radar, "with radar.waveform: impulse"
    if radar.waveform != "impulse":
        if radar.profile_m is not None:
            right = f"should be null with radar.waveform: {radar.waveform}"
            yield Problem("radar.profile_m", list(radar.profile_m), right)
        if c.image.kind == "signed":
            right = "should be decibel or cfar without radar.waveform: impulse"
            yield Problem("image.kind", "signed", right)
        return
    if radar.profile_m is None or not 0 <= radar.profile_m[0] < radar.profile_m[1]:
        value = radar.profile_m and list(radar.profile_m)
        yield Problem("radar.profile_m", value, f"should be [from, to], 0 <= from < to, {of}")
        return
    fc, band = support(radar.carrier_hz)[1], support(radar.bandwidth_hz)[1]
    step = (radar.profile_m[1] - radar.profile_m[0]) / radar.profile_samples
    finest = SPEED_OF_LIGHT / (4 * (fc + 1.5 * band))
    if step > finest:
        fewest = ceil((radar.profile_m[1] - radar.profile_m[0]) / finest)
        right = f"should be {fewest} or more: steps of {step:.3g} m are coarser than {finest:.3g} m"
        yield Problem("radar.profile_samples", radar.profile_samples, right)
    if c.image.kind == "signed" and c.maps != ("rtm",):
        yield Problem("maps", list(c.maps), "should be [rtm] with image.kind: signed")


def _people_problems(c: Config) -> Iterator[Problem]:
    """Keys of `people` that other people in a scene cannot have."""
    if c.people and c.motion.model == "paper":
        right = "should be empty with motion.model: paper, where one person is the sample"
        yield Problem("people", len(c.people), right)
        return
    for number, one in enumerate(c.people, 1):
        key = f"people.{number - 1}"
        if one.motion.model != "human":
            yield Problem(f"{key}.motion.model", one.motion.model, "should be human")
            continue
        try:
            activities = c.activities_of(number)
        except ValueError as error:
            yield Problem(f"{key}.activity", ", ".join(one.names), str(error))
            continue
        files = [a.slug for a in activities if c.files_of(a) is not None]
        if files:
            yield Problem(f"{key}.activity", files[0], "should be a movement, not motion files")
            continue
        slugs = tuple(a.slug for a in activities)
        for problem in _human_problems(
            c.of_person(number).model_copy(update={"activities": slugs})
        ):
            yield problem._replace(key=f"{key}.{problem.key}")


def _board_problems(c: Config) -> Iterator[Problem]:
    """Keys that a board cannot have, or that are not simulated for boards."""
    board, radar, clutter = c.radar.header, c.radar, c.processing.clutter
    if radar.waveform != "fmcw":
        right = "should be left out with radar.cfg: a board sends chirps (fmcw)"
        yield Problem("radar.waveform", radar.waveform, right)
        return
    if radar.elements is None:
        right = (
            f"should name the board that radar.cfg runs on: {', '.join(DEVICES)}; or radar.array"
        )
        yield Problem("radar.device", radar.device, right)
        return
    tx, rx = len(radar.elements.tx), len(radar.elements.rx)
    if max(board.order) >= tx or max(board.receivers) >= rx:
        masks = [1 << n for n in board.order]
        right = (
            f"should name transmitters and receivers of the array, {tx} and {rx}: it has the "
            f"masks {masks} and receivers {[n + 1 for n in board.receivers]}"
        )
        yield Problem("radar.cfg", "chirpCfg, channelCfg", right)
        return
    for key, number in board.numbers.items():
        value = getattr(radar, key)
        if not (isinstance(value, (int, float)) and abs(value - number) <= 1e-9 * number):
            yield Problem(f"radar.{key}", value, f"should be left out: radar.cfg gives {number:g}")
    if support(c.duration_s)[0] < board.period_s:
        right = f"should hold a frame of {board.period_s:g} s"
        yield Problem("duration_s", c.duration_s, right)
    chirps = support(c.duration_s)[1] / board.period_s * board.loops * len(board.order)
    most = chirps * len(board.receivers) * board.samples
    if most > MAX_CUBE:
        seconds = support(c.duration_s)[1] * MAX_CUBE / most
        right = f"should be at most {seconds:.3g} s: a cube of {MAX_CUBE} samples is held at once"
        yield Problem("duration_s", c.duration_s, right)
    if clutter not in ("mean", "none"):
        right = "should be mean (of each frame) or none with radar.cfg"
        yield Problem("processing.clutter", clutter, right)
    if clutter == "mean" and board.loops == 1:
        right = "should be none with frames of 1 loop (frameCfg), of which a mean leaves nothing"
        yield Problem("processing.clutter", clutter, right)
    if c.image.kind == "signed":
        right = "should be decibel or cfar without radar.waveform: impulse"
        yield Problem("image.kind", "signed", right)
    sheets = [name for name in c.maps if name in FRAME_MAPS]
    for key in ("power", "column_labels") if sheets else ():
        if value := getattr(c.output, key):
            right = (
                f"should be left out with {', '.join(sheets)}, whose images are sheets of frames"
            )
            yield Problem(f"output.{key}", value, right)
    products = [name for name in c.output.products if name in FRAME_MAPS]
    if reasons := [why for name in products if (why := why_no_map(c, name)) is not None]:
        yield Problem("output.products", products, f"should not have these: {reasons[0]}")
    corner = c.receiver.noise_corner_hz
    for name, value in (
        ("tones", [one.model_dump(mode="json") for one in c.receiver.tones]),
        ("noise_corner_hz", corner if support(corner)[1] > 0 else None),
    ):
        if value:
            right = "should be left out with radar.cfg: it is of one channel"
            yield Problem(f"receiver.{name}", value, right)
    if c.engine.motion_in_chirp:
        right = "should be false with radar.cfg: positions are frozen when a chirp begins"
        yield Problem("engine.motion_in_chirp", True, right)
    if c.output.slow_time:
        right = "should be false with radar.cfg; output.products: [cube] stores raw samples"
        yield Problem("output.slow_time", True, right)


def _class_problems(c: Config) -> Iterator[Problem]:
    """Classes that the model of motion cannot make."""
    model = c.motion.model
    for slug, one in c.classes.items():
        if model != "human" and isinstance(one, SequenceConfig):
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
    own = class_activities(c.classes)
    names = {DEFAULT, *(a.slug for a in (*ACTIVITIES, *own.values(), *own_activities()))}
    keys = ["samples_per_class"]
    of_people = [f"people.{n}." for n in range(len(c.people))]
    keys += [
        f"{whose}{name}.{key}"
        for whose in ("", *of_people)
        for name in ("motion", "timing")
        for key in type(at(c, name)).model_fields
    ]
    for key in keys:
        value = at(c, key)
        for slug, number in value.per_activity.items() if isinstance(value, PerActivity) else ():
            if slug in names:
                continue
            try:
                advice = f"should be called {activity_named(slug, own).slug}"
            except ValueError as error:
                advice = str(error)
            yield Problem(f"{key}.per_activity.{slug}", number, advice)


ENDS = ("carrier_hz", "bandwidth_hz", "chirp_s", "adc_rate_hz", "prf_hz", "duration_s")


def _waveform(c: AnyConfig, *largest: str) -> Waveform:
    """Waveform of the smallest numbers that a config draws, and of the largest of those named."""
    numbers = {key: c.duration_s if key == "duration_s" else getattr(c.radar, key) for key in ENDS}
    fc, bandwidth, chirp, rate, prf, duration = (
        support(number)[key in largest] for key, number in numbers.items()
    )
    processing = c.processing
    length, centred = processing.range_fft_length, processing.range_reference == "centre"
    parameters = fc, bandwidth, chirp, rate, prf, duration, length, centred
    if c.radar.waveform == "impulse" and c.radar.profile_m is not None:
        return Impulse(*parameters, profile=c.radar.profile_m, samples=c.radar.profile_samples)
    return Waveform(*parameters)


def _waveform_problems(c: AnyConfig) -> Iterator[Problem]:
    radar, fft_length = c.radar, c.processing.range_fft_length
    fewest, most = _waveform(c).n_adc, _waveform(c, *ENDS).n_adc
    shortest_interval = 1 / support(radar.prf_hz)[1]
    samples = "ADC samples per chirp (adc_rate_hz * chirp_s is"
    key = "processing.range_fft_length"
    if radar.waveform in ("cw", "impulse"):
        right = f"should be left out with radar.waveform: {radar.waveform}, which has no chirp"
        for key in ("processing.range_fft_length", "processing.range_reference"):
            if at(c, key) not in (None, "centre"):
                yield Problem(key, at(c, key), right)
        return
    if not support(radar.chirp_s)[1] < shortest_interval:
        right = f"should be shorter than the pulse interval 1/prf_hz = {shortest_interval:g} s"
        if radar.waveform == "sfcw":
            right = f"{right} (steps * dwell_s is {radar.chirp_s:g} s)"
            yield Problem("radar.steps", radar.steps, right)
        else:
            yield Problem("radar.chirp_s", radar.chirp_s, right)
    if fewest < 2:
        right = f"should give at least 2 {samples} {fewest})"
        yield Problem("radar.adc_rate_hz", radar.adc_rate_hz, right)
    if most > 2**20:
        right = f"should give at most {2**20} {samples} {most})"
        yield Problem("radar.adc_rate_hz", radar.adc_rate_hz, right)
    if fft_length is not None and fft_length < most:
        right = f"should be null or an even number of at least the {most} ADC samples"
        yield Problem(key, fft_length, right)
    if fft_length is not None and fft_length > MAX_PADDING * fewest:
        right = f"should be null or at most {MAX_PADDING} times the {fewest} ADC samples"
        yield Problem(key, fft_length, right)


def _window(c: AnyConfig, w: Waveform) -> int:
    """Pulses of the STFT's window of a waveform, at most those of a board's frame."""
    length = c.processing.window_pulses(w.duration, w.prf, w.f0)
    return length if c.radar.cfg is None else min(length, c.radar.header.loops)


def _prf_in_words(c: AnyConfig, w: Waveform) -> str:
    """The pulse rate of a waveform, and the key that one would change it by."""
    board = c.radar.cfg is not None
    return f"radar.cfg has a PRF of {w.prf:g} Hz" if board else f"radar.prf_hz may be {w.prf:g}"


HIGHEST_F0 = ("carrier_hz", "bandwidth_hz", "chirp_s", "adc_rate_hz")


def _signal_problems(c: AnyConfig) -> Iterator[Problem]:
    processing, padding, board = c.processing, c.processing.stft_fft_length, c.radar.cfg is not None
    shortest, longest = _waveform(c, *HIGHEST_F0), _waveform(c, "duration_s", "prf_hz")
    pulses, most_pulses = shortest.n_pulses, longest.n_pulses
    window, longest_window = _window(c, shortest), _window(c, longest)
    usable_pulses = pulses - 1 if processing.clutter == "difference" else pulses
    pulses_meant = "pulses there are"
    if board:  # frames are cancelled, filtered and windowed one by one
        usable_pulses = c.radar.header.loops
        pulses_meant = "pulses of a frame, the loops of radar.cfg"
    doppler = [name for name in c.maps if name != "rtm" and name not in FRAME_MAPS]
    duration_entry: tuple[str, object] = ("duration_s", c.duration_s)
    window_is_given = "window_s" in processing.model_fields_set and processing.window_s is not None
    window_entry = (
        ("processing.window_s", processing.window_s) if window_is_given else duration_entry
    )
    if most_pulses > MAX_PULSES and not board:
        right = f"at most {MAX_PULSES} pulses (duration_s * prf_hz is {most_pulses})"
        yield Problem(*duration_entry, f"should give {right}: radar.prf_hz may be {longest.prf:g}")
    if pulses < 2 and not board:
        yield Problem(*duration_entry, f"should hold at least 2 pulses (it holds {pulses})")
    if doppler and window < min(MIN_WINDOW, usable_pulses if board else MIN_WINDOW):
        right = f"the window of window_s * prf_hz at least {MIN_WINDOW} pulses (it has {window})"
        yield Problem(*window_entry, f"should make {right}: {_prf_in_words(c, shortest)}")
    if doppler and window > usable_pulses:
        right = (
            f"should make the window at most the {usable_pulses} {pulses_meant} (it has {window})"
        )
        yield Problem(*window_entry, right)
    if any("denoised" in name for name in doppler) and processing.savgol.frame > usable_pulses:
        right = f"should be at most the {usable_pulses} {pulses_meant}"
        yield Problem("processing.savgol.frame", processing.savgol.frame, right)
    if padding is not None and padding < longest_window:
        right = f"should be null or at least the window of {longest_window} pulses"
        yield Problem("processing.stft_fft_length", padding, right)
    if padding is not None and padding > MAX_PADDING * max(window, MIN_WINDOW):
        right = f"should be null or at most {MAX_PADDING} times the window of {window} pulses"
        yield Problem("processing.stft_fft_length", padding, right)


def _clutter_problems(c: AnyConfig) -> Iterator[Problem]:
    processing, prf = c.processing, support(c.radar.prf_hz)
    cutoff_hz = processing.highpass.cutoff_hz
    if processing.clutter == "highpass" and cutoff_hz is not None:
        least, most = 2 * cutoff_hz / prf[1], 2 * cutoff_hz / prf[0]
        if most >= 1 or least < MIN_CUTOFF:
            right = (
                f"should be from {MIN_CUTOFF:g} times PRF/2 to below PRF/2 in every scene "
                f"(it is {least:g} to {most:g} times PRF/2)"
            )
            yield Problem("processing.highpass.cutoff_hz", cutoff_hz, right)
    if "rtm" in c.maps and processing.clutter in ("mean", "highpass"):
        yield from _bin_problems(c, "processing.clutter", processing.clutter, "the rtm")


def _gate_problems(c: AnyConfig) -> Iterator[Problem]:
    processing = c.processing
    if processing.range_sum != "gated":
        return
    within = processing.gate_m
    half_band = _waveform(c, "bandwidth_hz").half_band_range  # the least
    if c.radar.cfg is not None:  # of whose complex samples every range bin is kept
        half_band = SPEED_OF_LIGHT * c.radar.header.adc_rate_hz / (2 * c.radar.header.slope_hz)
    if isinstance(within, tuple):
        if within[1] >= half_band:
            right = f"should end before the range half-band does, at {half_band:.4g} m"
            yield Problem("processing.gate_m", list(within), right)
    elif 2 * within >= half_band:
        right = f"should be less than half the range half-band of {half_band:.4g} m"
        yield Problem("processing.gate_m", within, right)
    if c.radar.cfg is None:
        yield from _bin_problems(c, "processing.range_sum", "gated", "the gate")


def _bin_problems(c: AnyConfig, key: str, value: object, what: str) -> Iterator[Problem]:
    """A request for which more range bins of all pulses than memory allows have to be held.

    Args:
        c: the config, whose largest recording counts.
        key: dotted key that asks for them.
        value: its value.
        what: what they are held for, in words.
    """
    w = _waveform(c, *ENDS)
    bins, pulses = w.n_bins, w.n_pulses
    if bins * pulses > MAX_BIN_SAMPLES:
        right = (
            f"should not go with {pulses} pulses of {bins} range bins: for {what} they are held "
            f"at once, {MAX_BIN_SAMPLES} samples at most"
        )
        yield Problem(key, value, right)


def _wall_problems(c: Config) -> Iterator[Problem]:
    if c.wall is None:
        return
    yield from _layer_problems(c, c.wall)
    depth = sum(support(layer.thickness_m)[1] for layer in c.wall.layers or ())
    sizes = [depth if size is None else support(size)[1] for size in c.wall.size_m]
    for name in ("tx_m", "rx_m") if c.radar.cfg is None else ("position_m",):
        antenna = getattr(c.radar, name)
        along = zip(map(support, antenna), map(support, c.wall.center_m), sizes, strict=True)
        if all(p[0] <= m[1] + size / 2 and p[1] >= m[0] - size / 2 for p, m, size in along):
            given = f"wall.center_m = {list(c.wall.center_m)}, wall.size_m = {list(c.wall.size_m)}"
            right = f"should be outside the wall, whose faces count as inside ({given})"
            yield Problem(f"radar.{name}", list(antenna), right)


def _layer_problems(c: Config, wall: WallConfig) -> Iterator[Problem]:
    """Layers and exact echoes of a wall that do not go with other keys."""
    if (wall.layers is None) != (wall.size_m[0] is not None):
        right = "should be null with wall.layers" if wall.layers else "should be a number"
        yield Problem("wall.size_m.0", wall.size_m[0], right)
    for number, layer in enumerate(wall.layers or ()):
        given = (layer.material is not None) + (layer.eps_r is not None)
        if given != 1 or (layer.material and layer.loss_tangent):
            right = "should have a material, or eps_r and loss_tangent"
            yield Problem(f"wall.layers.{number}", layer.model_dump(mode="json"), right)
    default = WallConfig()
    for key in ("eps_r", "loss_tangent") if wall.layers else ():
        if getattr(wall, key) != getattr(default, key):
            yield Problem(f"wall.{key}", getattr(wall, key), "should be left to wall.layers")
    if wall.echoes == "none":
        if wall.layers:
            yield Problem("wall.echoes", "none", "should be exact with wall.layers")
        return
    if wall.rays != "plane":
        yield Problem("wall.rays", wall.rays, "should be plane with wall.echoes: exact")
    if wall.fresnel != "normal":
        right = "should be left out with wall.echoes: exact, which has radar.polarisation"
        yield Problem("wall.fresnel", wall.fresnel, right)
    if c.radar.cfg is not None:
        yield Problem("wall.echoes", "exact", "should be none with radar.cfg")
    elif c.engine.kind == "direct" and c.radar.waveform != "impulse":
        right = "should be cube with wall.echoes: exact, which the direct engine does not have"
        yield Problem("engine.kind", "direct", right)


def _back_wall_problems(c: Config) -> Iterator[Problem]:
    key, wall = "room.back_wall_m", c.room.back_wall_m
    if wall is None:
        return
    if c.wall is not None:
        right = "should be null with a wall in front: one of the two is simulated"
        yield Problem(key, wall, right)
    for at_range, _, ends in _coordinates(c, "range_m"):
        farthest = max([0.0, *(end for _, end in ends)])
        if support(wall)[0] <= farthest:
            where = f"at up to {farthest:g} m ({at_range})"
            yield Problem(key, wall, f"should be beyond the people, who stand {where}")


def _coordinates(c: Config, name: str) -> Iterator[tuple[str, Any, list[tuple[float, float]]]]:
    """Find the coordinates of everybody under one name, `range_m` or `cross_range_m`.

    Yields:
        (dotted key, value, [(least, most) of each activity]) of each person.
    """
    everybody = [("", c.motion, c.chosen_activities)]
    with suppress(ValueError):  # of an unknown activity, which is told by itself
        everybody += [
            (f"people.{n}.", one.motion, c.activities_of(n + 1)) for n, one in enumerate(c.people)
        ]
    for prefix, motion, activities in everybody:
        value = getattr(motion, name)
        numbers = [for_activity(value, one) for one in activities]
        yield f"{prefix}motion.{name}", value, [support(one) for one in numbers if one is not None]


def _room_problems(c: Config) -> Iterator[Problem]:
    """Faces, box and antennas that do not go together."""
    room, radar = c.room, c.radar
    if radar.beam is not None and radar.cfg is not None:
        right = "should be null with radar.cfg, whose pattern is radar.half_power_deg"
        yield Problem("radar.beam", radar.beam.model_dump(mode="json"), right)
    if room.faces is None:
        return
    if room.back_wall_m is not None:
        right = "should be null with room.faces, of which back is one"
        yield Problem("room.back_wall_m", room.back_wall_m, right)
    if room.box_m is None:
        for name in ("tx_m", "rx_m") if radar.cfg is None else ("position_m",):
            if support(getattr(radar, name)[2])[0] <= 0:
                right = "should be above the floor of room.faces, at a height of 0"
                yield Problem(f"radar.{name}", list(getattr(radar, name)), right)
        if walls := [name for name in room.faces.given if name != "floor"]:
            right = f"should say where {', '.join(walls)} of room.faces are; a floor needs none"
            yield Problem("room.box_m", None, right)
        return
    box, height = room.box_m, support(room.box_m.height)
    for key, (low, high) in (("x", box.x), ("y", box.y)):
        if support(low)[1] >= support(high)[0]:
            yield Problem(f"room.box_m.{key}", [low, high], "should be [lower, higher]")
            return
    tall = support(c.subject.height_m)[0]
    if height[1] <= tall:
        right = f"should be above people, {tall:g} m tall or more (subject.height_m)"
        yield Problem("room.box_m.height", box.height, right)
    within = [(support(low)[1], support(high)[0]) for low, high in (box.x, box.y)]
    within.append((0.0, height[0]))
    for name in ("tx_m", "rx_m") if radar.cfg is None else ("position_m",):
        antenna = getattr(radar, name)
        places = [support(one) for one in antenna]
        before = places[0][1] < support(box.x[0])[0]
        inside = [low < a and b < high for (a, b), (low, high) in zip(places, within, strict=True)]
        if before and all(inside[1:]) and c.wall is None:
            right = "should be inside room.box_m, or have a wall: to see through"
            yield Problem(f"radar.{name}", list(antenna), right)
        elif not all(inside[1:] if before else inside):
            right = "should be inside room.box_m, or before its front"
            yield Problem(f"radar.{name}", list(antenna), right)
    for key, name, ends_of_box in (("x", "range_m", box.x), ("y", "cross_range_m", box.y)):
        low, high = support(ends_of_box[0])[0], support(ends_of_box[1])[1]
        for where, value, ends in _coordinates(c, name):
            if any(most <= low or least >= high for least, most in ends):
                right = f"should be inside room.box_m.{key}, {low:g} to {high:g} m"
                yield Problem(where, value, right)


def _tone_problems(c: Config) -> Iterator[Problem]:
    extra = {"tones": c.receiver.tones, "noise_corner_hz": support(c.receiver.noise_corner_hz)[1]}
    for key in [key for key, is_used in extra.items() if is_used and not c.has_noise]:
        right = (
            f"should be a number, or receiver.noise_figure_db be given: receiver.{key} is relative "
            "to the noise"
        )
        yield Problem("snr_db", None, right)


def _image_problems(c: AnyConfig) -> Iterator[Problem]:
    cfar, size = c.image.cfar, c.image.size_px
    reach = [2 * (g + t) + 1 for g, t in zip(cfar.guard, cfar.training, strict=True)]
    if c.image.kind == "cfar" and not any(cfar.training):
        yield Problem("image.cfar.training", list(cfar.training), "should be 1 or more of a side")
    if c.image.kind == "cfar" and any(r > px for r, px in zip(reach, size, strict=True)):
        right = (
            f"should fit into the image of {size[0]} x {size[1]} pixels: with the guard cells "
            f"{list(cfar.guard)} on each side it takes {reach[0]} x {reach[1]}"
        )
        yield Problem("image.cfar.training", list(cfar.training), right)
    limits = c.image.doppler_limits_mps
    if limits is None or not set(c.maps) - {"rtm", *FRAME_MAPS}:
        return
    shortest = _waveform(c, *HIGHEST_F0)
    fastest = shortest.highest_speed
    if max(-limits[0], limits[1]) > fastest * (1 + 1e-9):
        right = (
            f"should be within the unambiguous band, -{fastest:.6g} to {fastest:.6g} m/s "
            f"(c prf_hz / 4 f0: {_prf_in_words(c, shortest)})"
        )
        yield Problem("image.doppler_limits_mps", list(limits), right)
    step = SPEED_OF_LIGHT * shortest.prf / (2 * _waveform(c).f0 * max(_window(c, shortest), 1))
    if limits[1] - limits[0] < 2 * step:
        right = f"should hold at least 2 Doppler bins (one has {step:.3g} m/s)"
        yield Problem("image.doppler_limits_mps", list(limits), right)


# Where the motion of people holds, {key: (least, most)}; beyond, legs would be too short.
_limits: tuple[tuple[str, Limits | People], ...] = (
    *of_kind(Config, Limits),
    *of_kind(Config, People),
)
HUMAN_LIMITS = {key: (one.low, one.high) for key, one in _limits if one.high < MAX_NUMBER}


def _human_problems(c: Config) -> Iterator[Problem]:
    """Numbers beyond what people do, of the activities that depend on them."""
    for key, (low, high) in HUMAN_LIMITS.items():
        number = at(c, key)
        users = [one for one in c.chosen_activities if c.depends_on(one, key)]
        if number is None or not users:
            continue
        ends = [support(for_activity(number, one)) for one in users]
        least, most = min(end[0] for end in ends), max(end[1] for end in ends)
        if least < low or most > high:
            right = f"should be from {low:g} to {high:g} with motion.model: human"
            right = f"{right} (this one reaches from {least:g} to {most:g})"
            yield Problem(key, number, right)


def tone_warnings(c: Config) -> list[str]:
    """Say which interference tones of a config alias, a sentence for each."""
    highest = support(c.radar.prf_hz)[0] / 2
    return [
        f"receiver.tones.{number}.doppler_hz reaches beyond PRF/2 = {highest:g} Hz: the tone "
        "aliases, to that frequency less a multiple of the PRF"
        for number, tone in enumerate(c.receiver.tones)
        if max(map(abs, support(tone.doppler_hz))) > highest
    ]


def timing_warnings(c: Config, activities: Iterable[Activity] | None = None) -> list[str]:
    """Say which movements begin after the end of the recording, a sentence for each.

    Args:
        c: the config; numbers that are drawn are taken at their middle.
        activities: activities that are looked at; None for all of the config.
    """
    length = nominal(c.duration_s)
    warnings = []
    for activity in c.chosen_activities if activities is None else activities:
        for key in ("seat_start_s", "walk_begin_s", "walk_start_s", "walk_stop_s"):
            number = for_activity(getattr(c.timing, key), activity)
            if number is None or not c.depends_on(activity, f"timing.{key}"):
                continue
            start = nominal(number)
            if start >= length:
                warnings.append(
                    f"{activity.label} {activity.slug}: timing.{key} = {start:g} s is not before "
                    f"the end of the recording, {length:g} s: what begins then is never seen"
                )
    return warnings
