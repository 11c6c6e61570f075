"""A capture of any format becomes a recording."""

import shlex
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.capture import findings
from radhar_cli.capture.content import Beat, Content, RangeProfiles, SlowTime
from radhar_cli.capture.recording import (
    MAX_PULSE,
    Label,
    RecordingInfo,
    SampleStream,
    SourceNote,
    write_recording,
)
from radhar_cli.capture.subframes import read_subframes
from radhar_cli.config.reading import validated
from radhar_cli.errors import CaptureError
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.radar.board import BoardWaveform
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.impulse import Impulse
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.readers.captures.formats import open_capture
from radhar_cli.readers.captures.settings import CaptureSettings
from radhar_cli.readers.captures.source import CaptureFiles, MissingKeysError, Parts, Source

GAP = 0.5  # shortest gap between frames, in pulse intervals
MAX_HZ = 1e15
JITTER = 0.1  # in pulse intervals, above which it is reported


def read_settings(header: Path | None, overrides: Sequence[str]) -> CaptureSettings:
    """Read the settings of a capture without subframes, or of the subframe that is chosen.

    Args:
        header: TI's JSON or .cfg, or YAML with radhar's keys; None for overrides alone.
        overrides: KEY=VALUE of each.

    Raises:
        RadharError: the header or an override cannot be used, or no subframe is chosen.
    """
    settings = [*read_subframes(header, overrides).values()]
    if len(settings) > 1:
        raise CaptureError(f"{header}: has {len(settings)} subframes; subframe=0 chooses one")
    return settings[0]


def import_capture(
    paths: Sequence[Path],
    out: Path,
    settings: CaptureSettings,
    header: str = "--set",
    overwrite: bool = True,
) -> RecordingInfo:
    """Read a capture in pieces and write it as a recording; findings are in `source.found`.

    Args:
        paths: its files, or the first of those that are numbered.
        out: recording to write.
        settings: header of the capture.
        header: file of the header, for messages.
        overwrite: replace an existing recording.

    Raises:
        CaptureError: the capture is damaged, or does not fit its header.
        FolderError: another process wrote the recording meanwhile.
        UnfinishedError: it cannot be written.
    """
    return import_subframes(paths, {out: settings}, header, overwrite)[0]


def import_subframes(
    paths: Sequence[Path],
    subframes: Mapping[Path, CaptureSettings],
    header: str = "--set",
    overwrite: bool = True,
) -> list[RecordingInfo]:
    """Write each subframe of a capture as a recording, once all of them fit their headers.

    Args:
        paths: files of the capture, or the first of those that are numbered.
        subframes: {recording to write: header of a subframe}; one of a capture without subframes.
        header: file of the headers, for messages.
        overwrite: replace existing recordings.

    Raises:
        CaptureError: the capture is damaged, does not fit its header, or is of a format that holds
            one subframe.
        FolderError: another process wrote a recording meanwhile.
        UnfinishedError: one cannot be written.
    """
    first = next(iter(subframes))
    first.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=f".{first.name}.", dir=first.parent) as scratch:
        captures = [
            (out, *_open_capture(CaptureFiles(paths, s, header, Path(scratch), len(subframes))))
            for out, s in subframes.items()
        ]
        return [
            _write_capture(source, out, settings, header, exclusive=not overwrite)
            for out, source, settings in captures
        ]


def require_header(
    paths: Sequence[Path], subframes: Iterable[CaptureSettings], header: str = "--set"
) -> None:
    """Require that a capture has all keys that its import needs, and write nothing.

    Args:
        paths: files of the capture, or the first of those that are numbered.
        subframes: headers of its subframes.
        header: file of the headers, for messages.

    Raises:
        CaptureError: as `import_subframes`.
    """
    settings = [*subframes]
    with tempfile.TemporaryDirectory() as scratch:
        for subframe in settings:
            files = CaptureFiles(paths, subframe, header, Path(scratch), len(settings))
            _require_keys(*_open_capture(files), header)


def _open_capture(files: CaptureFiles) -> tuple[Source, CaptureSettings]:
    """Open a capture of any format; return it, and the settings, filled in by its own."""
    settings = files.settings
    try:
        source = open_capture(files)
    except MissingKeysError as error:
        raise CaptureError(_with_missing_keys(error, files)) from None
    if 16 * source.receivers * (source.samples or 1) > MAX_PULSE:
        raise CaptureError(
            f"{source.name}: a pulse of {source.receivers} receivers and {source.samples} samples "
            f"should take at most {MAX_PULSE} bytes, 16 per sample"
        )
    known = {key: value for key, value in source.settings.items() if getattr(settings, key) is None}
    document = settings.model_dump(exclude_none=True) | known
    return source, validated(CaptureSettings, document, source.name, {})


def _write_capture(
    source: Source, out: Path, s: CaptureSettings, header: str, exclusive: bool
) -> RecordingInfo:
    """Write an open capture as a recording, with radhar's coding and sign of the beat."""
    _require_keys(source, s, header)
    notes = [*source.notes]
    probed = findings.probe(source)
    coding = _coding(probed, s, source.name, notes)
    probed = [findings.decoded(piece, coding, s.adc_bits) for piece in probed]
    swapped = s.iq == "qi" and source.parts == 2
    if swapped:
        notes.append("Q before I, as the header says")
        probed = [piece[..., ::-1] for piece in probed]
    _require_beat(probed, source, s)
    conjugated = _conjugated(probed, source, s, notes)
    segments = _segments(source, s, header, notes)
    is_whole = source.parts == 2 and findings.lies_beyond_half_band(probed, conjugated)
    info = _info(source, s, segments, notes, is_whole)
    damage = findings.Damage(findings.full_scale(source.dtype, coding, s.adc_bits))
    if s.are_profiles and source.samples is not None:  # which are 0 where nothing echoes
        damage.lost_run = source.samples

    def pieces() -> Iterator[tuple[int, Parts]]:
        for first, stop in source.pieces():
            raw, gone = findings.checked(source.read(first, stop), first, source.name, coding)
            values = findings.decoded(raw, coding, s.adc_bits)
            damage.add(raw, values, gone)
            values = values[..., ::-1] if swapped else values
            if conjugated:
                values = values.copy()
                if values.dtype == np.int16:
                    np.maximum(values[..., 1], -32767, out=values[..., 1])  # -32768 has no negative
                values[..., 1] *= -1
            yield first, values

    number, parts = probed[0].dtype, source.parts
    stream = SampleStream(number, parts, pieces())
    return write_recording(out, info, stream, segments, damage, exclusive)


def _coding(
    probed: list[Parts], s: CaptureSettings, name: str, notes: list[str]
) -> findings.Coding:
    """Find the coding of the samples, or check the one in the header; add a note."""
    try:
        coding = findings.coding_of(probed, s.coding, s.adc_bits)
    except ValueError as error:
        raise CaptureError(f"{name}: coding = {s.coding}: {error}") from None
    if s.coding is not None:
        if (detected := findings.coding_of(probed)) != coding:
            detected_name = "offset" if detected.offset else "signed"
            notes.append(f"samples look {detected_name}; read as {s.coding}, as asked")
    elif coding.offset:
        notes.append(
            f"offset binary: {coding.offset} is subtracted from samples (coding=signed to keep)"
        )
    elif coding.words and probed[0].dtype != np.int16:
        notes.append("two's complement of 16 bits: 65536 is subtracted from samples above 32767")
    elif probed[0].dtype.kind in "iu":
        notes.append("two's complement")
    return coding


def _conjugated(probed: list[Parts], source: Source, s: CaptureSettings, notes: list[str]) -> bool:
    """Whether samples have to be conjugated for radhar's sign of the beat; add a note.

    Raises:
        CaptureError: neither the samples nor a document of their maker tells the sign.
    """
    if source.parts == 1 or source.samples is None or s.are_profiles:
        return source.parts == 2 and s.beat == "positive"
    shares = findings.positive_share(probed)
    moving, still = (f"{100 * share:.0f} %" for share in shares)
    shares_text = f"{moving} of what moves, {still} of all lies at positive beat frequencies"
    signs_are_negative = [
        share > 0.5 for share in shares if abs(share - 0.5) >= findings.SURE - 0.5
    ]
    sign: str | None = s.beat or (
        ("negative", "positive")[signs_are_negative[0]] if signs_are_negative else None
    )
    if s.beat is not None:
        notes.append(f"beat {s.beat}, as asked ({shares_text})")
    elif sign is None and source.usual_beat is None:
        raise CaptureError(
            f"{source.name}: {shares_text}: the sign of the beat is unclear; should be told by "
            "--set beat=negative (as radhar's own) or --set beat=positive (as TI's boards)"
        )
    elif sign is None:
        sign = source.usual_beat
        notes.append(f"{shares_text}: beat {sign}, as its maker has it (set beat=...)")
    else:
        notes.append(f"beat {sign}: {shares_text}")
    if sign == "positive":
        notes.append("samples are conjugated, as radhar's beat is negative")
    return sign == "positive"


def _segments(source: Source, s: CaptureSettings, header: str, notes: list[str]) -> PulseTimes:
    """Times of the pulses, from their times or the frames of the header; add a note."""
    if source.times is not None:
        return _segments_of_times(source, source.times, s, notes)
    assert s.prf_hz is not None  # as `_require_keys` found
    if s.frame_pulses is None and s.frame_s is None:
        return PulseTimes.even(source.pulses, s.prf_hz, s.frame_delay_s)
    if s.frame_pulses is None or s.frame_s is None:
        raise CaptureError(
            f"{header}: frame_pulses and frame_s must be given together, or axes=[...] "
            "name the axis frame"
        )
    if s.frame_pulses / s.prf_hz > s.frame_s * (1 + 1e-6):
        raise CaptureError(
            f"{header}: frame_s = {s.frame_s:g}: should be at least {s.frame_pulses / s.prf_hz:g}, "
            f"{s.frame_pulses} pulses at {s.prf_hz:g} Hz"
        )
    gap = s.frame_s - s.frame_pulses / s.prf_hz
    if gap * s.prf_hz <= GAP and not source.is_part:
        prf = s.frame_pulses / s.frame_s
        notes.append(f"frames without gaps: slow time is uniform, {prf:.6g} pulses/s")
        return PulseTimes.even(source.pulses, prf, s.frame_delay_s)
    first = np.arange(0, source.pulses, s.frame_pulses)
    notes.append(
        f"slow time is not uniform: {first.size} frames of {s.frame_pulses} pulses "
        f"({s.frame_pulses / s.prf_hz * 1e3:.4g} ms) every {s.frame_s * 1e3:.4g} ms, "
        f"{gap * 1e3:.4g} ms of each without a pulse"
    )
    starts = np.arange(first.size) * s.frame_s + s.frame_delay_s
    return PulseTimes(starts, first, source.pulses, s.prf_hz)


def _segments_of_times(
    source: Source, times: Float, s: CaptureSettings, notes: list[str]
) -> PulseTimes:
    """Find the stretches without gaps in the times of the pulses [pulse], s; add notes."""
    if times.size != source.pulses:
        raise CaptureError(
            f"{source.name}: {times.size} times; should be {source.pulses}, one per pulse"
        )
    if times.size < 2 or not np.isfinite(times).all() or not (np.diff(times) > 0).all():
        raise CaptureError(f"{source.name}: times should increase from pulse to pulse")
    step = np.diff(times)
    interval = float(np.median(step))
    gaps = step > 1.5 * interval
    jitter = float(np.abs(step[~gaps] - interval).max()) / interval
    first = np.concatenate([[0], np.flatnonzero(gaps) + 1]).astype(np.int64)
    prf = s.prf_hz or 1 / interval
    if s.prf_hz is not None and abs(s.prf_hz * interval - 1) > JITTER:
        raise CaptureError(
            f"{source.name}: prf_hz = {s.prf_hz:g}: the times have {1 / interval:.6g} pulses/s"
        )
    if jitter > JITTER:
        notes.append(f"pulse times deviate by up to {100 * jitter:.0f} % of the interval")
    if first.size > 1:
        notes.append(f"slow time is not uniform: {first.size} stretches with gaps between")
    # Pulses of a stretch are taken as evenly spaced; the mean rate avoids a drift.
    lengths = np.diff(first, append=times.size)
    if s.prf_hz is None and (inside := int((lengths - 1).sum())):
        prf = inside / float(step[~gaps].sum())
    if prf > MAX_HZ:
        raise CaptureError(f"{source.name}: {prf:.3g} pulses/s; times should be in s")
    return PulseTimes(times[first] - times[0], first, source.pulses, prf)


def _info(
    source: Source, s: CaptureSettings, segments: PulseTimes, notes: list[str], is_whole: bool
) -> RecordingInfo:
    """Describe the recording that is made of a capture, whose echoes may fill the whole band."""
    content = _content(source, s, segments.prf)
    if isinstance(content, Beat) and is_whole:
        content = replace(content, is_whole=True)
        notes.append(
            "what moves lies in both halves of the band: ranges reach from 0 to "
            f"{content.waveform(1.0).half_band_range:.4g} m"
        )
    if s.transmitters > 1:
        notes.append(
            f"{s.transmitters} transmitters take turns: {segments.prf:.6g} pulses/s each, "
            f"{source.receivers} virtual receivers"
        )
    per_turn = source.receivers // s.transmitters
    chirp = 1 / (segments.prf * s.transmitters)
    name = source.files[0].suffix.lower().lstrip(".")
    return RecordingInfo(
        content=content,
        receivers=source.receivers,
        pulses=source.pulses,
        segments=len(segments),
        receiver_delay_s=[n // per_turn * chirp for n in range(source.receivers)],
        labels=[] if s.label is None else [Label(label=s.label, person=s.person)],
        source=SourceNote(format=name, files=[path.name for path in source.files], findings=notes),
        radar=_radar_note(s, content),
    )


def _radar_note(s: CaptureSettings, content: Content) -> dict[str, Any]:
    """Return the header's keys of the radar, as in a config; frames even where they are joined."""
    note = dict(s.radar or {})
    if (
        not isinstance(content, RangeProfiles)
        and s.frame_pulses is not None
        and s.frame_s is not None
    ):
        note.setdefault("frame", {"chirps": s.frame_pulses, "period_s": s.frame_s})
    return note


def _content(source: Source, s: CaptureSettings, prf_hz: float) -> Content:
    """Content of a capture whose keys are known: chirps, range profiles, or slow time."""
    assert s.carrier_hz is not None
    if source.samples is None:
        return SlowTime(s.carrier_hz, prf_hz)
    if s.are_profiles:
        assert s.first_range_m is not None
        assert s.range_step_m is not None
        last_m = s.first_range_m + (source.samples - 1) * s.range_step_m
        if last_m > FARTHEST_PROFILE_M:
            raise CaptureError(
                f"{source.name}: {source.samples} bins from first_range_m = {s.first_range_m:g} in "
                f"steps of range_step_m = {s.range_step_m:g} end at {last_m:.4g} m; should end at "
                f"most at {FARTHEST_PROFILE_M:g} m: both keys are in m, 5 cm is 0.05"
            )
        assert s.bandwidth_hz is not None
        return RangeProfiles(
            s.carrier_hz,
            s.bandwidth_hz,
            source.samples,
            prf_hz,
            s.first_range_m,
            s.range_step_m,
            source.parts == 2,
        )
    assert s.bandwidth_hz is not None
    assert s.adc_rate_hz is not None
    return Beat(s.carrier_hz, s.bandwidth_hz, s.adc_rate_hz, source.samples, prf_hz)


BEAT_KEYS = ("bandwidth_hz", "adc_rate_hz")
PROFILE_KEYS = ("bandwidth_hz", "first_range_m", "range_step_m")
HINT_ON_BINS = "range bins have first_range_m and range_step_m instead of adc_rate_hz"
FARTHEST_PROFILE_M = 1000.0
# {key: a value of it that a message shows}
EXAMPLES = {
    "carrier_hz": "77e9",
    "prf_hz": "1000",
    "bandwidth_hz": "1e9",
    "adc_rate_hz": "5e6",
    "first_range_m": "0.3",
    "range_step_m": "0.05",
    "frame_s": "0.1",
}


def _command_with(
    files: Sequence[Path], keys: Mapping[str, str], s: CaptureSettings, header: str
) -> str:
    """Command that imports files with keys besides those that are given already."""
    known = s.model_dump(exclude_defaults=True, exclude={"radar", "label", "person"})
    words = {} if header != "--set" else {key: _as_word(value) for key, value in known.items()}
    sets = " ".join(f"--set {key}={value}" for key, value in (words | {**keys}).items())
    names = shlex.join(map(str, files[:3])) + (" ..." if len(files) > 3 else "")
    radar = "" if header == "--set" else f"--radar {shlex.quote(header)} "
    texts = {"--label": s.label, "--person": s.person}
    labels = "".join(f"{option} {shlex.quote(text)} " for option, text in texts.items() if text)
    return f"radhar import {names} {radar}{sets} {labels}-o walk.h5"


def _as_word(value: object) -> str:
    """Value of a key as a word of a command line."""
    if isinstance(value, list | tuple):
        return f"[{','.join(map(str, value))}]"
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def _with_missing_keys(error: MissingKeysError, files: CaptureFiles) -> str:
    """Message of keys that opening needs, with others that are missing, and a command."""
    s = files.settings
    examples = error.examples
    has_samples = "samples" in examples or "sample" in examples.get("axes", "")
    of_samples = PROFILE_KEYS if s.are_profiles else BEAT_KEYS
    usual = ["carrier_hz", "prf_hz"] + [*of_samples] * has_samples
    missing = {k: EXAMPLES[k] for k in usual if getattr(s, k) is None}
    also = f"; so may be {', '.join(missing)}" if missing else ""
    keys = {**missing, **examples}
    bins = f"; {HINT_ON_BINS}" if has_samples and not s.are_profiles and missing else ""
    command = _command_with(files.paths, keys, s, files.header)
    return f"{error}{also}; with your values: {command}{bins}"


def _require_keys(source: Source, s: CaptureSettings, header: str) -> None:
    """Require the keys that a capture needs, and name all that are missing at once.

    Raises:
        CaptureError: keys are missing; a command that gives them follows.
    """
    keys = ["carrier_hz"] + ["prf_hz"] * (source.times is None)
    if source.samples is not None:
        keys += PROFILE_KEYS if s.are_profiles else BEAT_KEYS
    if s.frame_pulses is not None:
        keys += ["frame_s"]
    missing = [key for key in keys if getattr(s, key) is None]
    if not missing:
        return
    are = "are" if len(missing) > 1 else "is"
    examples = {key: EXAMPLES[key] for key in missing}
    command = _command_with(source.files, examples, s, header)
    several = "s" * (source.receivers > 1)
    shape = f"{source.receivers} receiver{several}, {source.samples or 'no'} samples a pulse, "
    also = ""
    if source.samples is not None and not s.are_profiles:
        also = f"; {HINT_ON_BINS}"
    if s.are_profiles and s.range_step_m and "bandwidth_hz" in missing:
        step_hz = SPEED_OF_LIGHT / (2 * s.range_step_m)
        also += (
            f"; bandwidth_hz is that of the pulse, of bins of a transform without padding "
            f"{min(step_hz, s.carrier_hz or step_hz):.4g}"
        )
    raise CaptureError(
        f"{header}: {', '.join(missing)} {are} missing; of {shape}{source.pulses} pulses, with "
        f"your numbers: {command}, or --radar FILE with these keys{also}"
    )


def _require_beat(probed: list[Parts], source: Source, s: CaptureSettings) -> None:
    """Refuse samples that look like range bins, unless the header says what they are.

    Raises:
        CaptureError: they look like range bins, and nothing says that they are beat signals.
    """
    is_known = s.holds is not None or s.are_profiles or source.usual_beat == "positive"
    if is_known or source.samples is None or not findings.look_like_range_bins(probed):
        return
    raise CaptureError(
        f"{source.name}: the power of its {source.samples} samples a pulse lies in few of them, as "
        "of range bins, not of beat signals: --set first_range_m=... --set range_step_m=... say "
        "where bins lie; --set holds=beat takes them for beat signals"
    )


class SimulatedPulses(NamedTuple):
    """Pulses of a simulated board.

    Attributes:
        times: Times of the pulses.
        delays: Delay of the pulses of each receiver, s.
        bpm: Places in a loop of the chirps in which two transmitters send; None for none.
    """

    times: PulseTimes
    delays: Sequence[float] = (0.0,)
    bpm: tuple[int, int] | None = None


def write_simulated(
    out: Path,
    beat: Complex | Float,
    waveform: Waveform,
    label: Label,
    pulses: SimulatedPulses | None = None,
    radar: Mapping[str, Any] = MappingProxyType({}),
) -> RecordingInfo:
    """Write simulated samples as a recording: of chirps, of range profiles, or of slow time.

    Args:
        out: recording to write.
        beat: samples [receiver, N_ADC, M]; real numbers are stored as such. One sample a pulse
            makes a recording of slow time.
        waveform: waveform; that of an impulse radar makes a recording of range profiles.
        label: activity and person.
        pulses: pulses of a board; None is one receiver without gaps.
        radar: section `radar` of the scene's config, plain values.

    Raises:
        UnfinishedError: it cannot be written.
    """
    receivers, samples, count = beat.shape
    pulses = pulses or SimulatedPulses(PulseTimes.even(count, waveform.prf))
    content: Content = SlowTime(waveform.fc, waveform.prf)
    if isinstance(waveform, Impulse):
        content = RangeProfiles(
            waveform.f0,
            waveform.bandwidth,
            samples,
            waveform.prf,
            waveform.profile[0],
            waveform.range_step,
            waveform.is_iq,
        )
    elif samples > 1:
        is_whole = isinstance(waveform, BoardWaveform) and waveform.n_bins == waveform.n_fft
        content = Beat.of_waveform(waveform, is_whole)
    info = RecordingInfo(
        content=content,
        receivers=receivers,
        pulses=count,
        receiver_delay_s=pulses.delays,
        labels=[label],
        source=SourceNote(format="simulated"),
        bpm=pulses.bpm,
        radar=radar,
    )
    parts = 2 if np.iscomplexobj(beat) else 1
    values = np.ascontiguousarray(beat).view(beat.real.dtype).reshape(*beat.shape, parts)
    stream = SampleStream(values.dtype, parts, [(0, values)])
    return write_recording(out, info, stream, pulses.times)
