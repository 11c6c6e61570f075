"""The section `radar` of a config whose simulations have the maps of a recording.

Samples and times tell carrier, band, sampling and frames. What they do not tell (where receivers
stand, a TI board's .cfg, whether frequencies are steps) a recording has in its attribute `radar`,
from the header of the import or from the config that simulated it.
"""

from collections.abc import Mapping, Sequence
from math import log2
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.capture.content import (
    Beat,
    Content,
    RangeProfiles,
    SlowTime,
    describe_other_chirps,
)
from radhar_cli.capture.recording import Recording
from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import (
    RADARS,
    AnyRadar,
    ArrayRadar,
    BoardRadar,
    class_of_radar,
)
from radhar_cli.config.reading import validated, with_overrides
from radhar_cli.errors import CaptureError, did_you_mean
from radhar_cli.radar.frame_timing import Sampling
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.schema.number import nominal

TOLERANCE = 1e-3  # relative difference of the numbers of one radar, as clocks differ
KEYS = frozenset(key for kind in RADARS for key in kind.model_fields)
HOW = "docs/guide/captures.md"
FRAME_S = 0.1  # of frames that are chosen, in which a walker's torso stays in a range bin
FEWEST_CHIRPS, MOST_CHIRPS = 8, 256


class RecordedFrames(NamedTuple):
    """Frames of a recording: so many pulses, so often.

    Attributes:
        pulses: Number of pulses of each transmitter in a frame.
        period_s: Time from frame to frame, s.
    """

    pulses: int
    period_s: float

    @property
    def text(self) -> str:
        """Words for them in messages."""
        return f"frames of {self.pulses} pulses every {self.period_s * 1e3:.4g} ms"


def require_known_keys(radar: Mapping[str, Any], where: str) -> None:
    """Require that what a header says of a radar has keys of a config's section `radar`.

    Raises:
        CaptureError: names the first key that it has not.
    """
    for key in radar:
        if key not in KEYS:
            hint = did_you_mean(str(key), KEYS, "it has the keys of radar: in a config")
            raise CaptureError(f"{where}: radar.{key} is an unknown key; {hint}")


def frames_in(segments: PulseTimes) -> RecordedFrames | None:
    """Frames that the stretches of a recording are; None where there are no such.

    All have the same pulses but the last, which may be cut off. Frames may be missing.
    """
    lengths, steps = segments.lengths, np.diff(segments.start)
    if len(segments) < 2 or np.ptp(lengths[:-1]) or lengths[-1] > lengths[0]:
        return None
    period = float(np.median(steps))
    counts = np.rint(steps / period)
    if counts.min() < 1 or np.abs(steps / period - counts).max() > 0.01:
        return None
    return RecordedFrames(int(lengths[0]), float(steps.sum() / counts.sum()))


def radar_of_recording(recording: Recording, overrides: Sequence[str] = ()) -> dict[str, Any]:
    """Section `radar` of a config that has the radar of a recording.

    Args:
        overrides: KEY=VALUE of a config; those of `radar` say what the recording does not.

    Raises:
        CaptureError: the recording has what no radar of a config has, or does not say where its
            receivers stand.
        ConfigError: an override, or what the recording says of its radar, cannot be used.
    """
    of_radar = [text for text in overrides if text.strip().startswith("radar.")]
    note = with_overrides({"radar": dict(recording.radar)}, of_radar)["radar"]
    where = str(recording.path)
    require_known_keys(note, where)
    if note.get("cfg") is not None:
        return _board(recording, note)
    content = recording.info.content
    frames = frames_in(recording.segments)
    match content:
        case Beat():
            section = _chirps(recording, content, note, frames)
        case SlowTime():
            section = _tone(recording, content, note, frames)
        case RangeProfiles():
            _require_plain_pulses(recording, frames)
            section = _pulses(content, note, recording.samples.parts == 2)
    kind = class_of_radar(section)
    assert kind is not None
    known_keys = kind.model_fields.keys() - {k for k, value in section.items() if value is None}
    return {key: value for key, value in section.items() if key in known_keys}


def differing_key(section: Any, other: Any, key: str = "radar") -> str | None:
    """Describe the first key that differs from another section by more than TOLERANCE, or None."""
    if isinstance(section, dict) and isinstance(other, dict):
        keys = [*dict.fromkeys([*section, *other])]
        pairs = [(section.get(name), other.get(name), f"{key}.{name}") for name in keys]
    elif isinstance(section, (list, tuple)) and isinstance(other, (list, tuple)):
        if len(section) != len(other):
            return f"{key} = {section}: should be {other}"
        pairs = [(a, b, f"{key}.{n}") for n, (a, b) in enumerate(zip(section, other, strict=True))]
    else:
        numbers = isinstance(section, (int, float)) and isinstance(other, (int, float))
        same = section == other
        if numbers and not same:
            same = abs(section - other) <= TOLERANCE * abs(other)
        if same:
            return None
        return f"{key} = {_as_text(section)}: should be {_as_text(other)}"
    return next(filter(None, (differing_key(*pair) for pair in pairs)), None)


def _as_text(value: Any) -> str:
    """Write a plain value as a message shows it: 10 digits of a number, 60 characters at most."""
    return f"{value:.10g}" if isinstance(value, float) else str(value)[:60]


def _number(value: float) -> float:
    """A number without the digits that are rounding."""
    return float(f"{value:.9g}")


def _chirps(
    recording: Recording, content: Beat, note: Mapping[str, Any], frames: RecordedFrames | None
) -> dict[str, Any]:
    """Radar that sends chirps: with frames and an array, or plain ones of one antenna pair."""
    has_steps = note.get("waveform") == "sfcw"
    waves: dict[str, Any] = {
        "carrier_hz": _number(content.carrier_hz),
        "bandwidth_hz": _number(content.bandwidth_hz),
        "adc_rate_hz": _number(content.adc_rate_hz),
        "chirp_s": _number(content.samples / content.adc_rate_hz),
        "waveform": "sfcw" if has_steps else "fmcw",
    }
    if has_steps:
        waves |= {"steps": content.samples, "dwell_s": _number(1 / content.adc_rate_hz)}
    turns = _turns_of(recording, content)
    if frames is None and not _has_frames(note):
        if _why_frames(recording, content, turns):
            note = dict(note) | {"frame": {"chirps": chirps_of_frames(recording)}}
        else:
            return dict(note) | waves | {"prf_hz": _number(content.prf_hz)}
    return dict(note) | waves | _frame_keys(recording, content, note, frames)


def _tone(
    recording: Recording, content: SlowTime, note: Mapping[str, Any], frames: RecordedFrames | None
) -> dict[str, Any]:
    """Radar that takes a sample a pulse: with frames and an array, or of one antenna pair."""
    if frames is None and not _has_frames(note):
        if recording.info.receivers == 1:
            return _pulses(content, note, recording.samples.parts == 2)
        note = dict(note) | {"frame": {"chirps": chirps_of_frames(recording)}}
    waves = {"waveform": "cw", "carrier_hz": _number(content.carrier_hz)}
    return dict(note) | waves | _frame_keys(recording, content, note, frames)


def _has_frames(note: Mapping[str, Any]) -> bool:
    """Whether the known keys of a radar give the number of chirps of a frame."""
    return "chirps" in (note.get("frame") or {})


def chirps_of_frames(recording: Recording) -> int:
    """Choose the chirps of a frame where only frames fit a radar, and nothing tells them.

    They are a power of two that takes about FRAME_S, without a pause between frames.
    """
    pulses = FRAME_S * recording.info.prf_hz
    power = round(log2(max(pulses, 1)))
    return int(min(max(2**power, FEWEST_CHIRPS), MOST_CHIRPS))


def describe_chosen_frames(recording: Recording, section: Mapping[str, Any]) -> str | None:
    """Describe the frames chosen for a recording that has none, with the reason; None if none were.

    Args:
        section: section `radar` of a config, by `radar_of_recording`.
    """
    content, chirps = recording.info.content, (section.get("frame") or {}).get("chirps")
    is_told = frames_in(recording.segments) is not None or _has_frames(recording.radar)
    if chirps is None or is_told or section.get("cfg") is not None:
        return None
    turns = _turns_of(recording, content)
    why = f"has {recording.info.receivers} receivers"
    if isinstance(content, Beat):
        why = _why_frames(recording, content, turns) or why
    return (
        f"the recording {why}, and no frames: frames of {chirps} chirps without a pause are "
        f"chosen; --set radar.frame.chirps=N has others ({HOW})"
    )


def _turns_of(recording: Recording, content: Content) -> int:
    """Number of transmitters that take turns."""
    return len({round(delay * content.prf_hz, 6) for delay in recording.info.receiver_delay_s})


def _frame_keys(
    recording: Recording, content: Content, note: Mapping[str, Any], frames: RecordedFrames | None
) -> dict[str, Any]:
    """Keys of a radar's frames and of its array; no rate, which follows from the frames."""
    known, turns = note.get("frame") or {}, _turns_of(recording, content)
    interval = _number(1 / (content.prf_hz * turns))
    frame: dict[str, Any] = {"chirps": known.get("chirps"), "interval_s": interval}
    period = known.get("period_s")
    if frames is not None:
        frame["chirps"] = frames.pulses
        period = frames.period_s
    is_apart = period is not None and period > frame["chirps"] * turns * interval * (1 + 1e-6)
    if period is not None and is_apart:
        frame["period_s"] = _number(period)
    output = "iq" if recording.samples.parts == 2 else "real"
    array = _elements(recording, note, turns)
    return {"frame": frame, "prf_hz": None, "output": output, "array": array}


def _why_frames(recording: Recording, content: Beat, turns: int) -> str | None:
    """Return why a plain radar of chirps does not fit a recording; None if it fits."""
    receivers = recording.info.receivers
    if turns > 1:
        return f"has {turns} transmitters that take turns"
    if receivers > 1:
        return f"has {receivers} receivers"
    if content.is_whole:
        return "has echoes in both halves of the band"
    if recording.samples.parts == 1:
        return "has real samples"
    return None


def _elements(recording: Recording, note: Mapping[str, Any], turns: int) -> dict[str, Any]:
    """Places of transmitters and receivers.

    Raises:
        CaptureError: nothing says where they are, or other numbers of them.
    """
    receivers = recording.info.receivers // turns
    array = dict(note.get("array") or {})
    sizes = {"tx": turns, "rx": receivers}
    names = {"tx": "transmitter", "rx": "receiver"}
    missing = [side for side, size in sizes.items() if size > 1 and side not in array]
    if missing:
        counts = " and ".join(f"{sizes[s]} {names[s]}s" for s in missing)
        sets = " ".join(f"--set 'radar.array.{s}={_row(sizes[s])}'" for s in missing)
        raise CaptureError(
            f"{recording.path}: has {counts}, whose places nothing says: {sets} with your places, "
            "[left, up] in half wavelengths, looking out of the radar, which are these of a row"
        )
    for side, size in sizes.items():
        places = array.setdefault(side, [[0.0, 0.0]])
        if isinstance(places, (list, tuple)) and len(places) != size:
            raise CaptureError(
                f"{recording.path}: radar.array.{side} has {len(places)} places; the recording has "
                f"{size} {names[side]}{'s' * (size > 1)}"
            )
    return array


def _row(count: int) -> str:
    """Places of a row of elements, half a wavelength apart, as --set takes them."""
    return "[" + ",".join(f"[{n},0]" for n in range(count)) + "]"


def _require_plain_pulses(recording: Recording, frames: RecordedFrames | None) -> None:
    """Refuse slow time and profiles of frames or of several receivers, which no radar has.

    Raises:
        CaptureError: says what would differ, and what to do.
    """
    info = recording.info
    problems = [] if frames is None else [f"{len(recording.segments)} {frames.text}"]
    problems += [f"{info.receivers} receivers"] if info.receivers > 1 else []
    if problems:
        raise CaptureError(
            f"{recording.path}: has {' and '.join(problems)}; the radar of a config that makes "
            f"{info.content.noun} has one receiver and sends without a pause: import one receiver "
            "of one burst, or write the config by hand"
        )


def _pulses(content: Content, note: Mapping[str, Any], is_iq: bool) -> dict[str, Any]:
    """Radar that takes a sample a pulse, or one that samples range profiles."""
    numbers: dict[str, Any] = {"prf_hz": _number(content.prf_hz)}
    if isinstance(content, SlowTime):
        numbers |= {"waveform": "cw", "carrier_hz": _number(content.carrier_hz)}
        return dict(note) | numbers | {"output": "iq" if is_iq else "real"}
    assert isinstance(content, RangeProfiles)
    w = content.waveform(1.0)
    return dict(note) | {
        **numbers,
        "waveform": "impulse",
        "output": "iq" if is_iq else "rf",
        "carrier_hz": _number(w.fc),
        "bandwidth_hz": _number(w.bandwidth),
        "profile_m": [_number(content.first_range_m), _number(w.half_band_range)],
        "profile_samples": content.samples,
    }


def _board(recording: Recording, note: Mapping[str, Any]) -> dict[str, Any]:
    """Radar of a TI board, whose .cfg has to be that of the recording.

    Raises:
        CaptureError: it is not, or nothing says where the antennas are.
    """
    where = str(recording.path)
    section = {key: value for key, value in note.items() if key in BoardRadar.model_fields}
    if "\n" not in str(section["cfg"]).strip():
        raise CaptureError(f"{where}: radar.cfg should be the text of a .cfg, of several lines")
    if section.get("device") is None and section.get("array") is None:
        raise CaptureError(
            f"{where}: has {recording.info.receivers} virtual receivers, and the .cfg does not say "
            "where they are: --set radar.device=IWR1443BOOST with your board, or --set "
            "'radar.array={tx: [[0,0]], rx: [[0,0],[1,0]]}' with the places of all, [left, up] in "
            "half wavelengths"
        )
    radar = read_radar(section, where)
    assert isinstance(radar, ArrayRadar)
    timing = radar.timing
    difference = describe_other_chirps(recording.info.content, Beat.of_frames(timing), TOLERANCE)
    if recording.info.receivers != timing.channels:
        difference = f"receivers = {recording.info.receivers}: should be {timing.channels}"
    frames = frames_in(recording.segments)
    if frames is not None and frames.pulses != timing.loops:
        difference = f"frame_pulses = {frames.pulses}: should be {timing.loops}"
    if difference is not None:
        raise CaptureError(f"{where}: {difference}, as the .cfg of the import has it")
    return section


def read_radar(section: Mapping[str, Any], where: str = "radar") -> AnyRadar:
    """Read a section `radar` of a config.

    Raises:
        ConfigError: it cannot be used; `where` names its file.
    """
    maps = ["rtm"] if section.get("output") == "rf" else ["stft"]
    return validated(Config, {"radar": dict(section), "maps": maps}, where, {}).radar


def has_beam(radar: AnyRadar) -> bool:
    """Whether the antennas of a radar weaken echoes from beside their boresight."""
    return isinstance(radar, ArrayRadar) or getattr(radar, "beam", None) is not None


def keeps_whole_band(section: Mapping[str, Any]) -> bool:
    """Whether the radar of a section has ranges in both halves of the band of its samples."""
    radar = read_radar(section)
    return isinstance(radar, ArrayRadar) and radar.timing.sampling is Sampling.COMPLEX


def place_of(radar: AnyRadar) -> float:
    """Distance x of the antennas of a radar along the x axis, m, numbers at their middle."""
    places = [getattr(radar, key) for key in radar.place_keys]
    return float(np.mean([nominal(place[0]) for place in places]))
