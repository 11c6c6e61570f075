"""From a recording to its maps: the stages of a simulation, without the simulator.

Slow time with gaps is handled stretch by stretch: no difference and no window crosses a gap. The
columns of a map are then put on an even grid of times. Maps of several receivers are added up.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from radhar_cli.arrays import Bool, Complex, Float, Index
from radhar_cli.capture.findings import LOST
from radhar_cli.capture.recording import Recording, Segments
from radhar_cli.capture.tracking import TorsoTrack, track_torso, without_static
from radhar_cli.config.schema import Config, MapName
from radhar_cli.echo.range_profiles import shown_pulses
from radhar_cli.errors import CaptureError
from radhar_cli.phasor import unit_phasor
from radhar_cli.pipeline.physics import canceller_of, frames_of, fsst_frames_of
from radhar_cli.pipeline.run import process
from radhar_cli.processing.canceller import NO_CANCELLER, Canceller
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.power_map import Axis, PowerMap
from radhar_cli.processing.range_compression import range_bins, range_power
from radhar_cli.processing.range_signals import RangeSignals
from radhar_cli.processing.signal import Signal
from radhar_cli.radar.waveform import SPEED_OF_LIGHT, Waveform

MAX_BYTES = 3 * 2**29  # of range bins that are held at once
PIECE_SAMPLES = 2**20
MIN_FRAME_PULSES = 8  # pulses of a window


@dataclass(frozen=True)
class Maps:
    """What was made of a recording, or of a stretch of it.

    Attributes:
        maps: {map name: PowerMap}; times are those of the recording.
        track: of the torso; None of slow time, and where nothing moves.
        f0: frequency at which the Doppler is read, Hz.
        notes: what was shortened, filled in or not found, in words.
    """

    maps: dict[str, PowerMap]
    track: TorsoTrack | None
    f0: float
    notes: list[str]


def maps_of(
    recording: Recording,
    config: Config,
    names: Sequence[MapName],
    start: float | None = None,
    stop: float | None = None,
    receiver: int | None = None,
) -> Maps:
    """Make maps of a recording.

    Args:
        recording: an open one.
        config: its `processing` and `image` are used.
        names: of the maps.
        start, stop: which part, s; None is from the start, to the end.
        receiver: one of them, or None for the sum of all maps' powers.

    Raises:
        CaptureError: the part is empty or too long, or the recording cannot be processed so.
    """
    info = recording.info
    if receiver is not None and not 0 <= receiver < info.receivers:
        raise CaptureError(
            f"{recording.path}: receiver {receiver}: should be below {info.receivers}"
        )
    chosen = range(info.receivers) if receiver is None else [receiver]
    first, last, segments = pulses_between(recording, start, stop)
    lost = (recording.flags[first:last] & LOST).astype(bool)
    notes: list[str] = []
    if lost.all():
        raise CaptureError(f"{recording.path}: each of its {lost.size} pulses there lacks samples")
    if lost.any():
        notes.append(
            f"{np.count_nonzero(lost)} pulses lack samples: filled in from their neighbours"
        )
    _refuse_highpass_over_gaps(config, segments, recording)
    if info.samples is None:
        _refuse_too_much(recording, 1, info.receivers, first, last)
        signals = filled(recording.beat(first, last)[list(chosen), 0], lost)
        return _of_slow_time(recording, config, names, signals, segments, notes)
    processing = config.processing
    waveform = replace(
        info.waveform(processing.range_fft_length, processing.range_reference == "centre"),
        duration=segments.pulses / info.prf_hz,
    )
    bins = filled(bins_of_part(recording, waveform, chosen, first, last), lost)
    track = track_torso(without_static(bins), segments, waveform)
    if track is None:
        notes.append("nothing moves: no torso was found")
    referred = replace(waveform, centred=waveform.centred or processing.doppler == "gate")
    canceller, bins = _before(config, info.prf_hz, referred.f0, bins)
    ranges = waveform.range_axis()
    turn = unit_phasor(np.arange(waveform.n_bins)[:, None] * (referred.n0 / waveform.n_fft))
    doppler = [name for name in names if name != "rtm"]
    stretches = [*_stretches(segments, referred.f0, canceller, config, doppler, recording, notes)]
    powers: dict[str, list[list[PowerMap]]] = {name: [] for name in names}
    for one in bins:
        if "rtm" in names:
            powers["rtm"].append([_range_time(one, segments, ranges, canceller, config)])
        made = []
        for part, frames in stretches if doppler else []:
            t = segments.times(np.arange(part.start, part.stop))
            tau = np.full(t.size, ranges.mean() * 2 / SPEED_OF_LIGHT) if track is None else None
            signal = RangeSignals(
                one[:, part] * turn, ranges, float(t[0]), info.prf_hz, referred.f0
            )
            made.append(
                process(
                    signal,
                    config,
                    doppler,
                    canceller=canceller,
                    torso_track=tau if track is None else track.delays(t),
                    **frames,
                )
            )
        for name in doppler:
            powers[name].append([maps[name] for maps in made])
    return Maps(_joined(powers), track, referred.f0, list(dict.fromkeys(notes)))


def pulses_between(
    recording: Recording, start: float | None, stop: float | None
) -> tuple[int, int, Segments]:
    """(first, last + 1) of the pulses from start to stop, s, and their segments.

    Raises:
        CaptureError: there are none.
    """
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
    return first, last, _within(recording.segments, first, last)


def _within(segments: Segments, first: int, last: int) -> Segments:
    """The segments of pulses first .. last - 1, counted anew; times stay those of the recording."""
    inside = (segments.first > first) & (segments.first < last)
    numbers = np.concatenate([[first], segments.first[inside]])
    return Segments(segments.times(numbers), numbers - first, last - first, segments.prf)


def filled(x: Complex, lost: Bool) -> Complex:
    """Samples [..., pulse] whose lost pulses lie on straight lines between their neighbours."""
    if not lost.any():
        return x
    flat, kept, at = x.reshape(-1, lost.size), np.flatnonzero(~lost), np.flatnonzero(lost)
    for row in flat:
        row[at] = np.interp(at, kept, row[kept])
    return flat.reshape(x.shape)


def _refuse_too_much(
    recording: Recording, bins: int, receivers: int, first: int, last: int
) -> None:
    size, seconds = 16 * receivers * bins * (last - first), (last - first) / recording.info.prf_hz
    if size > MAX_BYTES:
        raise CaptureError(
            f"{recording.path}: {seconds:.4g} s of {receivers} receivers take "
            f"{size / 2**30:.1f} GiB; --start and --stop should choose at most "
            f"{MAX_BYTES / size * seconds:.3g} s, or --receiver one"
        )


def bins_of_part(
    recording: Recording,
    w: Waveform,
    chosen: Sequence[int],
    first: int,
    last: int,
    window: Float | None = None,
) -> Complex:
    """Range bins [receiver, K, M] of pulses first .. last - 1, referred to the chirp's start.

    Args:
        recording: an open one.
        w: its chirps.
        chosen: receivers.
        first, last: pulses.
        window: over the samples of a chirp [N_ADC]; None is none.

    Raises:
        CaptureError: they are more than MAX_BYTES.
    """
    _refuse_too_much(recording, w.n_bins, len(chosen), first, last)
    x = np.empty((len(chosen), w.n_bins, last - first), dtype=complex)
    step = max(PIECE_SAMPLES // (w.n_fft * recording.info.receivers), 1)
    for at in range(first, last, step):
        beat = recording.beat(at, min(at + step, last))
        if window is not None:
            beat *= window[:, None]
        for row, number in enumerate(chosen):
            x[row, :, at - first : at - first + beat.shape[2]] = range_bins(beat[number], w)
    return x


def _before(config: Config, prf: float, f0: float, x: Complex) -> tuple[Canceller, Complex]:
    """What is left of the clutter filter for each stretch, and samples after what is global."""
    if config.processing.clutter == "mean":
        return NO_CANCELLER, without_static(x)
    return canceller_of(config, prf, f0), x


def _stretches(
    segments: Segments,
    f0: float,
    canceller: Canceller,
    config: Config,
    names: Sequence[str],
    recording: Recording,
    notes: list[str],
) -> Iterator[tuple[slice, dict[str, Any]]]:
    """Pulses of every segment that holds a window, and the windows within it."""
    wanted = frames_of(config, segments.duration, segments.prf, f0)
    usual = int(np.median(segments.lengths)) - canceller.lost
    length = min(wanted.length, usual)
    needed = config.processing.savgol.frame if any("denoised" in n for n in names) else 0
    if length < max(MIN_FRAME_PULSES, needed):
        raise CaptureError(
            f"{recording.path}: stretches of {usual + canceller.lost} pulses without a gap are too "
            f"short for a Doppler map; should have {max(MIN_FRAME_PULSES, needed) + canceller.lost}"
        )
    if length < wanted.length:
        notes.append(
            f"windows have the {length} pulses of a frame, not {wanted.length} "
            "(processing.window_s)"
        )
    skipped, hop = 0, min(wanted.hop, length)
    fine = fsst_frames_of(config, segments.duration, segments.prf, f0)
    for part in segments.slices:
        if part.stop - part.start - canceller.lost < length:
            skipped += 1
            continue
        yield (
            part,
            {"frames": Frames(length, hop), "fsst_frames": Frames(length, min(fine.hop, length))},
        )
    if skipped:
        notes.append(f"{skipped} stretches are shorter than a window and are left out")


def _range_time(
    bins: Complex, segments: Segments, ranges: Float, canceller: Canceller, config: Config
) -> PowerMap:
    """The range-time map: pulses of even times, as many as the image has columns."""
    parts = [one for one in segments.slices if one.stop - one.start > canceller.lost]
    pieces = [canceller(bins[:, one]) for one in parts]
    x = pieces[0] if len(pieces) == 1 else np.concatenate(pieces, axis=1)
    numbers = np.concatenate([np.arange(one.start, one.stop - canceller.lost) for one in parts])
    t = segments.times(numbers) + canceller.delay / segments.prf
    width = config.image.size_px[1]
    if len(segments) == 1:
        shown = shown_pulses(x.shape[1], width)
    else:
        grid = t[0] + (np.arange(width) + 0.5) / width * (t[-1] - t[0])
        shown = _nearest(t, grid)
        t = t.copy()
        t[shown] = grid
    return PowerMap(
        range_power(x[:, shown]), Axis("range", "m", ranges), Axis("time", "s", t[shown])
    )


def _nearest(values: Float, wanted: Float) -> Index:
    """Numbers of the rising values nearest to those wanted."""
    after = np.clip(np.searchsorted(values, wanted), 1, max(values.size - 1, 1))
    before = after - 1
    if values.size == 1:
        return np.zeros(wanted.size, np.intp)
    nearer = wanted - values[before] <= values[after] - wanted
    return np.where(nearer, before, after).astype(np.intp)


def _joined(powers: dict[str, list[list[PowerMap]]]) -> dict[str, PowerMap]:
    """Powers of all receivers added up, stretches one after the other on an even grid of times."""
    joined = {}
    for name, receivers in powers.items():
        summed = [
            PowerMap(sum(one.power for one in same), same[0].rows, same[0].columns)
            for same in zip(*receivers, strict=True)
        ]
        joined[name] = _even(summed)
    return joined


def _even(maps: list[PowerMap]) -> PowerMap:
    """Maps of stretches as one; where no column is near, the power is 0."""
    if len(maps) == 1:
        return maps[0]
    power = np.concatenate([one.power for one in maps], axis=1)
    t = np.concatenate([one.columns.values for one in maps])
    step = float(np.median(np.diff(t))) if t.size > 1 else 1.0
    grid = t[0] + step * np.arange(round((t[-1] - t[0]) / step) + 1)
    nearest = _nearest(t, grid)
    there = np.abs(t[nearest] - grid) <= step
    columns = replace(maps[0].columns, values=grid)
    return PowerMap(power[:, nearest] * there, maps[0].rows, columns)


def _refuse_highpass_over_gaps(config: Config, segments: Segments, recording: Recording) -> None:
    if config.processing.clutter == "highpass" and len(segments) > 1:
        raise CaptureError(
            f"{recording.path}: has {len(segments)} stretches with gaps between; "
            "processing.clutter should be mean or difference, a high-pass would ring in each"
        )


def _of_slow_time(
    recording: Recording,
    config: Config,
    names: Sequence[MapName],
    x: Complex,
    segments: Segments,
    notes: list[str],
) -> Maps:
    """Maps of a radar without ranges: neither a range-time map, nor a torso, nor a gate."""
    wrong = [name for name in names if name == "rtm" or "compensated" in name]
    if wrong or config.processing.doppler == "gate":
        raise CaptureError(
            f"{recording.path}: is slow time without ranges; {wrong[0] if wrong else 'a gate'} "
            "cannot be made of it (maps: stft, fsst, stft_denoised, fsst_denoised; "
            "processing.doppler: half_band)"
        )
    f0, prf = recording.info.carrier_hz, recording.info.prf_hz
    canceller, x = _before(config, prf, f0, x)
    stretches = [*_stretches(segments, f0, canceller, config, names, recording, notes)]
    powers: dict[str, list[list[PowerMap]]] = {name: [] for name in names}
    for one in x:
        made = []
        for part, frames in stretches:
            t0 = float(segments.times(np.array([part.start]))[0]) + canceller.delay / prf
            made.append(process(Signal(canceller(one[part]), t0, prf, f0), config, names, **frames))
        for name in names:
            powers[name].append([maps[name] for maps in made])
    return Maps(_joined(powers), None, f0, list(dict.fromkeys(notes)))
