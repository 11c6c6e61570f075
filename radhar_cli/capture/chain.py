"""Maps of a recording, made by the chain that processes simulated signals.

No difference and no window crosses a gap. The columns of a map are then put on an even grid of
times. Powers of several receivers are added up.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from radhar_cli.capture.content import Beat, RangeProfiles, Ranging, SlowTime
from radhar_cli.capture.findings import LOST
from radhar_cli.capture.recording import Recording
from radhar_cli.capture.tracking import TorsoTrack, track_torso, without_static
from radhar_cli.config.data_set import AnyConfig
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.errors import CaptureError
from radhar_cli.numerics.arrays import Bool, Complex
from radhar_cli.numerics.phasor import unit_phasor
from radhar_cli.processing.canceller import NO_CANCELLER, Canceller, MeanRemoval
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.map_kind import RTM, treatment_of
from radhar_cli.processing.power_map import PowerMap
from radhar_cli.processing.signal import Signal, nearest
from radhar_cli.processing.track import StandingTrack
from radhar_cli.radar.board import Board
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.scene.products.run import process
from radhar_cli.scene.radar import board_of
from radhar_cli.scene.scene import fixed_radar

MAX_BYTES = 3 * 2**29  # of range bins that are held at once
PIECE_SAMPLES = 2**20
MIN_FRAME_PULSES = 8  # pulses of a window


@dataclass
class Maps:
    """Maps of a recording, or of a part of it, and the track of the torso."""

    maps: dict[str, PowerMap]  # {map name: PowerMap}; times are those of the recording
    track: TorsoTrack | None  # of the torso; None of slow time, and where nothing moves
    f0: float  # frequency at which the Doppler is read, Hz
    notes: list[str]  # what was shortened, filled in or not found, in words
    # {product: what a board's frames gave}, and the board, where there is one
    frames: dict[str, Any] = field(default_factory=dict)
    board: Board | None = None

    def add_products_of_frames(self, products: Mapping[str, Any]) -> None:
        """Add the products of a board's frames: maps over time to maps, all else to frames."""
        for name, product in products.items():
            if isinstance(product, PowerMap):
                self.maps[name] = product
            else:
                self.frames[name] = product


@dataclass(frozen=True)
class RecordingPart:
    """Pulses of a part of a recording, of some of its receivers."""

    recording: Recording
    receivers: Sequence[int]  # numbers of the receivers
    first: int  # number of the first pulse
    stop: int  # number after the last pulse
    segments: PulseTimes  # times of these pulses, numbered from 0

    @property
    def pulses(self) -> int:
        """Number M of pulses."""
        return self.stop - self.first

    @property
    def lost(self) -> Bool:
        """Whether a pulse lacks samples [M]."""
        return (self.recording.flags[self.first : self.stop] & LOST).astype(bool)

    def pieces(self, length: int) -> Iterator[tuple[slice, Complex]]:
        """Yield (pulses of the part, samples [receiver, N, pulse] of the recording) of each piece.

        Args:
            length: number of pulses of a piece, the last may be shorter.
        """
        for start in range(self.first, self.stop, length):
            stop = min(start + length, self.stop)
            yield slice(start - self.first, stop - self.first), self.recording.beat(start, stop)


def part_of(
    recording: Recording, start: float | None, stop: float | None, receiver: int | None = None
) -> RecordingPart:
    """Find the pulses of a recording from start to stop.

    Args:
        start: time since the first pulse, s; None is the start.
        stop: time since the first pulse, s; None is the end.
        receiver: number of the only receiver; None for all.

    Raises:
        CaptureError: there are fewer than MIN_FRAME_PULSES, or no such receiver.
    """
    receivers = recording.info.receivers
    if receiver is not None and not 0 <= receiver < receivers:
        raise CaptureError(f"{recording.path}: receiver {receiver}: should be below {receivers}")
    segments = recording.segments
    times = segments.times(np.arange(segments.pulses))
    origin = float(times[0])
    half = 0.5 / segments.prf  # a time that a decimal rounds is that of its pulse
    first = 0 if start is None else int(np.searchsorted(times, origin + start - half))
    last = times.size if stop is None else int(np.searchsorted(times, origin + stop - half))
    if last - first < MIN_FRAME_PULSES:
        until = "the end" if stop is None else f"{stop:g} s"
        raise CaptureError(
            f"{recording.path}: from {start or 0:g} s to {until} there are "
            f"{max(last - first, 0)} pulses; it lasts {segments.duration:.4g} s"
        )
    numbers = range(receivers) if receiver is None else [receiver]
    return part_of_pulses(recording, numbers, first, last)


def part_of_pulses(
    recording: Recording, receivers: Sequence[int], first: int, stop: int
) -> RecordingPart:
    """Take pulses first .. stop - 1 of some receivers of a recording."""
    segments = _within(recording.segments, first, stop)
    return RecordingPart(recording, receivers, first, stop, segments)


def maps_of(
    recording: Recording,
    config: AnyConfig,
    names: Sequence[str],
    start: float | None = None,
    stop: float | None = None,
    receiver: int | None = None,
) -> Maps:
    """Make maps of a recording.

    Args:
        config: config whose `processing` and `image` are used.
        names: maps to make.
        start: begin of the part of the recording that is used, s; None is the start.
        stop: end of that part, s; None is the end.
        receiver: number of the only receiver to use; None for the sum of the powers of all.

    Raises:
        CaptureError: the part is too short or too large, or its samples do not suffice for a map.
    """
    part = part_of(recording, start, stop, receiver)
    notes = _notes_of_lost_pulses(part)
    _refuse_ringing(part, config)
    track: TorsoTrack | None = None
    if isinstance(recording.info.content, SlowTime):
        _refuse_without_ranges(recording, config, names)
        signal = Signal(slow_time_of_part(part), part.segments, recording.info.carrier_hz)
    else:
        signal, track = _range_signal(part, recording.info.content, config)
        notes += [] if track else ["nothing moves: no torso was found"]
    _refuse_doppler_of_magnitudes(recording, signal, names)
    # The mean is taken out here; difference and windows cross no gap.
    clutter = config.processing.clutter
    canceller = NO_CANCELLER if clutter == "mean" else config.processing.make_canceller(signal.prf)
    signal = _without_mean(signal, config) if clutter == "mean" else signal
    maps: dict[str, PowerMap] = {}
    rtm = str(RTM)
    if rtm in names:
        maps[rtm] = process(signal, config, [rtm], canceller=canceller)[rtm]
    doppler = [name for name in names if name != rtm]
    if doppler:
        signal, (frames, fine) = _windows(signal, canceller, config, doppler, recording, notes)
        inputs: dict[str, Any] = {"frames": frames, "fsst_frames": fine}
        if signal.ranges is None:
            signal = signal.cancelled(canceller)
        else:
            inputs["torso_track"] = track or StandingTrack(float(signal.ranges.mean()))
        results = process(signal, config, doppler, canceller=canceller, **inputs)
        maps |= {name: even_columns(results[name]) for name in doppler}
    return Maps({name: maps[name] for name in names}, track, signal.f0, list(dict.fromkeys(notes)))


def _without_mean(signal: Signal, config: AnyConfig) -> Signal:
    """Take the mean out of a recording, of a radar with frames out of each frame, as simulated."""
    if not isinstance(config.radar, ArrayRadar):
        return signal.with_samples(without_static(signal.x))
    if config.radar.timing.loops == 1:  # of which the mean of a frame would leave nothing
        return signal
    return signal.cancelled(MeanRemoval())


def _notes_of_lost_pulses(part: RecordingPart) -> list[str]:
    """Note on the pulses that are filled in, if any.

    Raises:
        CaptureError: all pulses are lost.
    """
    lost = part.lost
    if lost.all():
        path = part.recording.path
        raise CaptureError(f"{path}: each of its {lost.size} pulses there lacks samples")
    if not lost.any():
        return []
    return [f"{np.count_nonzero(lost)} pulses lack samples: filled in from their neighbours"]


def _refuse_ringing(part: RecordingPart, config: AnyConfig) -> None:
    """Refuse a high-pass of a part with gaps."""
    if config.processing.clutter == "highpass" and len(part.segments) > 1:
        raise CaptureError(
            f"{part.recording.path}: has {len(part.segments)} stretches with gaps between; "
            "processing.clutter should be mean or difference, a high-pass would ring in each"
        )


def _range_signal(
    part: RecordingPart, content: Ranging, config: AnyConfig
) -> tuple[Signal, TorsoTrack | None]:
    """Make the range bins of a part, and track the torso in them; None if nothing moves.

    Raises:
        CaptureError: the recording is not of the config's board.
    """
    processing = config.processing
    centred = processing.range_reference == "centre" or processing.range_sum == "gated"
    duration = part.segments.pulses / part.segments.prf
    waveform = content.waveform(duration, processing.range_fft_length, centred)
    radar = fixed_radar(config)
    if isinstance(radar, ArrayRadar):  # whose samples have no half band
        board = board_of(radar)
        if isinstance(content, Beat) and content.samples != board.samples:
            raise CaptureError(
                f"{part.recording.path}: samples = {content.samples}: should be {board.samples}, "
                f"as {radar.named} has it"
            )
        waveform = replace(board.waveform, centred=centred)
    if isinstance(content, Beat):
        waveform = replace(waveform, window=processing.make_chirp_window())
    x = bins_of_part(part, content, waveform)
    is_real = isinstance(content, RangeProfiles) and part.recording.samples.parts == 1
    has_signs = is_real and bool((x.real < 0).any())  # magnitudes have none
    moving_bins = without_static(analytic(x) if has_signs else x)
    track = track_torso(moving_bins, part.segments, waveform)
    if isinstance(content, Beat):
        x *= unit_phasor(np.arange(waveform.n_bins)[:, None] * (waveform.n0 / waveform.n_fft))
    ranges, step = waveform.range_axis(), waveform.range_step
    return Signal(x, part.segments, waveform.f0, ranges, range_step=step), track


def _within(segments: PulseTimes, first: int, last: int) -> PulseTimes:
    """Segments of pulses first .. last - 1, numbered from 0; times stay those of the recording."""
    inside = (segments.first > first) & (segments.first < last)
    numbers = np.concatenate([[first], segments.first[inside]])
    return PulseTimes(segments.times(numbers), numbers - first, last - first, segments.prf)


def fill_lost_pulses(x: Complex, lost: Bool) -> Complex:
    """Interpolate lost pulses linearly between their neighbours.

    Args:
        x: samples [..., pulse]; they are overwritten.
        lost: whether a pulse is lost [pulse]; not all may be.

    Returns:
        The samples [..., pulse].
    """
    if not lost.any():
        return x
    rows = x.reshape(-1, lost.size)
    good = np.flatnonzero(~lost)
    lost_at = np.flatnonzero(lost)
    for row in rows:
        row[lost_at] = np.interp(lost_at, good, row[good])
    return rows.reshape(x.shape)


def _refuse_too_much(part: RecordingPart, bins: int) -> None:
    """Refuse more than MAX_BYTES of range bins [receiver, bin, pulse] of a part.

    --receiver helps only where there are several receivers.
    """
    receivers, seconds = len(part.receivers), part.pulses / part.recording.info.prf_hz
    size = 16 * receivers * bins * part.pulses
    if size <= MAX_BYTES:
        return
    remedy = f"--start and --stop should choose at most {MAX_BYTES / size * seconds:.3g} s"
    if receivers > 1:
        remedy += ", or --receiver 0 one receiver"
    holder = f"{receivers} receivers" if receivers > 1 else "a receiver"
    raise CaptureError(
        f"{part.recording.path}: {seconds:.4g} s of {holder} take {size / 2**30:.1f} GiB; {remedy}"
    )


def slow_time_of_part(part: RecordingPart) -> Complex:
    """Read the slow time [receiver, 1, M] of a part; lost pulses are filled in.

    Raises:
        CaptureError: it takes more than MAX_BYTES.
    """
    _refuse_too_much(part, 1)
    x = np.empty((len(part.receivers), 1, part.pulses), dtype=complex)
    for pulses, samples in part.pieces(max(PIECE_SAMPLES // part.recording.info.receivers, 1)):
        x[:, :, pulses] = samples[list(part.receivers), :1]
    return fill_lost_pulses(x, part.lost)


def analytic(profiles: Complex) -> Complex:
    """Analytic range profiles [receiver, K, M] of real ones; their Doppler has a sign.

    cos(2 pi fm (2 R/c - tau)) along the range R becomes exp(+j 2 pi fm (2 R/c - tau)).
    """
    from scipy.signal import hilbert

    signal: Complex = hilbert(profiles.real, axis=1)
    return signal


def bins_of_part(part: RecordingPart, content: Ranging, w: Waveform) -> Complex:
    """Compute range bins [receiver, K, M] of a part, referred to the chirp's start.

    Lost pulses are filled in.

    Args:
        part: part of a recording, of which not all pulses are lost.
        w: waveform, which says how long the transform over a chirp is.

    Raises:
        CaptureError: the bins take more than MAX_BYTES.
    """
    _refuse_too_much(part, w.n_bins)
    w = replace(w, centred=False)
    x = np.empty((len(part.receivers), w.n_bins, part.pulses), dtype=complex)
    samples_of_pulse = max(w.n_fft, w.n_bins) * part.recording.info.receivers
    for pulses, samples in part.pieces(max(PIECE_SAMPLES // samples_of_pulse, 1)):
        for row, number in enumerate(part.receivers):
            x[row, :, pulses] = content.range_bins(samples[number], w)
    return fill_lost_pulses(x, part.lost)


def _windows(
    signal: Signal,
    canceller: Canceller,
    config: AnyConfig,
    names: Sequence[str],
    recording: Recording,
    notes: list[str],
) -> tuple[Signal, tuple[Frames, ...]]:
    """Choose the stretches that hold a window, and the windows of STFT and FSST.

    Shortened windows and omitted stretches are added to `notes`.
    """
    windows = _windows_of_config(signal, config)
    lengths = signal.times.lengths - canceller.lost
    usual = int(np.median(lengths))
    length = min(windows[0].length, usual)
    denoises = any(treatment_of(name).denoised for name in names)
    filter_pulses = config.processing.savgol.frame if denoises else 0
    if length < MIN_FRAME_PULSES:
        raise CaptureError(
            f"{recording.path}: stretches of {usual + canceller.lost} pulses without a gap are too "
            f"short for a Doppler map; should have {MIN_FRAME_PULSES + canceller.lost}"
        )
    if usual < filter_pulses:
        raise CaptureError(
            f"{recording.path}: processing.savgol.frame = {filter_pulses}: should be at most "
            f"{usual}, the pulses of a stretch without a gap after the clutter filter"
        )
    if length < windows[0].length:
        notes.append(
            f"windows have the {length} pulses of a frame, not {windows[0].length} "
            "(processing.window_s)"
        )
    least_pulses = max(length, filter_pulses)
    short_stretches = np.count_nonzero(lengths < least_pulses)
    if short_stretches:
        shortest = "a window" if length == least_pulses else "the filter of the denoised maps"
        notes.append(f"{short_stretches} stretches are shorter than {shortest} and are left out")
        signal = signal.stretches(least_pulses + canceller.lost)
    if length < windows[0].length:
        windows = [one.within(length, are_apart=False) for one in windows]
    return signal, tuple(windows)


def _windows_of_config(signal: Signal, config: AnyConfig) -> list[Frames]:
    """Windows of STFT and FSST that a config asks for, those of a radar with frames within them."""
    radar, times = config.radar, signal.times
    duration = signal.pulses / signal.prf
    if isinstance(radar, ArrayRadar) and radar.frames_apart:
        duration = float(times.start[-1] - times.start[0]) + radar.timing.period_s
    processing, arguments = config.processing, (duration, signal.prf, signal.f0)
    windows = [processing.make_frames(*arguments), processing.make_fsst_frames(*arguments)]
    if not isinstance(radar, ArrayRadar):
        return windows
    are_apart = radar.frames_apart and len(times) > 1
    return [one.within(radar.timing.loops, are_apart) for one in windows]


def even_columns(power_map: PowerMap) -> PowerMap:
    """Put a map of stretches over time on an even grid; where no column is near, the power is 0."""
    if power_map.columns.name != "time":
        return power_map
    t = power_map.columns.values
    step = float(np.median(np.diff(t))) if t.size > 1 else 1.0
    grid = t[0] + step * np.arange(round((t[-1] - t[0]) / step) + 1)
    if grid.size == t.size:
        return power_map
    columns = nearest(t, grid)
    has_column = np.abs(t[columns] - grid) <= step
    even_axis = replace(power_map.columns, values=grid)
    return PowerMap(power_map.power[:, columns] * has_column, power_map.rows, even_axis)


def _refuse_doppler_of_magnitudes(
    recording: Recording, signal: Signal, names: Sequence[str]
) -> None:
    """Refuse Doppler maps of real range profiles without a phase.

    They are magnitudes, none of which is negative, or lie too far apart for the pulse as it comes.
    """
    content = recording.info.content
    refused = [name for name in names if name != str(RTM)]
    if not (isinstance(content, RangeProfiles) and recording.samples.parts == 1 and refused):
        return
    are_magnitudes = signal.x.real.min() >= 0
    if are_magnitudes or not content.are_waves:
        step = content.range_step_m
        why = "are magnitudes" if are_magnitudes else f"are real, with steps of {step:g} m"
        raise CaptureError(
            f"{recording.path}: its range profiles {why}, and have no phase; {refused[0]} cannot "
            "be made of them (maps: rtm)"
        )


def _refuse_without_ranges(recording: Recording, config: AnyConfig, names: Sequence[str]) -> None:
    """Refuse maps that need ranges, as slow time has none."""
    refused = [name for name in names if name == str(RTM) or treatment_of(name).compensated]
    if refused or config.processing.range_sum == "gated":
        raise CaptureError(
            f"{recording.path}: is slow time without ranges; {refused[0] if refused else 'a gate'} "
            "cannot be made of it (maps: stft, fsst, stft_denoised, fsst_denoised; "
            "processing.range_sum: coherent)"
        )
