"""The header of a capture with a TI radar: mmWave Studio's JSON, or the .cfg of the SDK's demos.

Fields and units: mmWave SDK user guide, "Configuration (.cfg) File Format"; mmWave Radar Interface
Control Document; the JSON schema of mmWave Studio, as its rawDataReader.m reads it. A chirp takes
T_c = idle time + ramp end time. Transmitters that take turns have PRF = 1/(n T_c) each. The ADC
starts later than the ramp: carrier = start frequency + slope times that.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import isfinite
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, TypeAlias

from pydantic import AliasPath, BeforeValidator, ConfigDict, Field

from radhar_cli.config.reading import validated
from radhar_cli.config.section import Section
from radhar_cli.errors import CaptureError, ConfigError
from radhar_cli.files.untrusted import read_json, text_of
from radhar_cli.radar.detection import CA, CAGO, CASO, Cfar, Detection, ti_threshold_db

MAX_CFG = 2**16
MAX_CHIRPS = 512  # of a frame


def _hexadecimal(value: object) -> object:
    """A text such as 0x3 as a number, anything else as it is."""
    try:
        return int(value, 16) if isinstance(value, str) and value[:2].lower() == "0x" else value
    except ValueError:
        return value


Whole: TypeAlias = Annotated[int, BeforeValidator(_hexadecimal), Field(ge=0, lt=2**32)]
Number: TypeAlias = Annotated[float, Field(ge=0)]
Above: TypeAlias = Annotated[float, Field(gt=0)]
Same: TypeAlias = Annotated[float, Field(ge=0, le=0)]  # chirps that differ are not read


def _at(*path: str, default: Any = ...) -> Any:
    """Field whose value lies at a path of mmWave Studio's JSON document."""
    return Field(default, validation_alias=AliasPath(*path))


class _Ti(Section):
    model_config = ConfigDict(extra="ignore")


class _Profile(_Ti):
    number: Whole = _at("rlProfileCfg_t", "profileId")
    start_ghz: Above = _at("rlProfileCfg_t", "startFreqConst_GHz")
    idle_us: Number = _at("rlProfileCfg_t", "idleTimeConst_usec")
    adc_us: Number = _at("rlProfileCfg_t", "adcStartTimeConst_usec")
    ramp_us: Above = _at("rlProfileCfg_t", "rampEndTime_usec")
    slope: Above = _at("rlProfileCfg_t", "freqSlopeConst_MHz_usec")
    samples: Annotated[Whole, Field(ge=2)] = _at("rlProfileCfg_t", "numAdcSamples")
    rate_ksps: Above = _at("rlProfileCfg_t", "digOutSampleRate")


class _Chirp(_Ti):
    first: Whole = _at("rlChirpCfg_t", "chirpStartIdx")
    last: Whole = _at("rlChirpCfg_t", "chirpEndIdx")
    profile: Whole = _at("rlChirpCfg_t", "profileId")
    transmitters: Annotated[Whole, Field(ge=1)] = _at("rlChirpCfg_t", "txEnable")
    start_change: Same = _at("rlChirpCfg_t", "startFreqVar_MHz", default=0)
    slope_change: Same = _at("rlChirpCfg_t", "freqSlopeVar_KHz_usec", default=0)
    idle_change: Same = _at("rlChirpCfg_t", "idleTimeVar_usec", default=0)
    adc_change: Same = _at("rlChirpCfg_t", "adcStartTimeVar_usec", default=0)


class _Device(_Ti):
    receivers: Whole = _at("rfConfig", "rlChanCfg_t", "rxChannelEn")
    bits: Annotated[Whole, Field(le=2)] = _at("rfConfig", "rlAdcOutCfg_t", "fmt", "b2AdcBits")
    output: Annotated[Whole, Field(le=2)] = _at("rfConfig", "rlAdcOutCfg_t", "fmt", "b2AdcOutFmt")
    profiles: tuple[_Profile, ...] = _at("rfConfig", "rlProfiles")
    chirps: tuple[_Chirp, ...] = _at("rfConfig", "rlChirps")
    first: Whole = _at("rfConfig", "rlFrameCfg_t", "chirpStartIdx")
    frames: Whole = _at("rfConfig", "rlFrameCfg_t", "numFrames", default=0)
    last: Whole = _at("rfConfig", "rlFrameCfg_t", "chirpEndIdx")
    loops: Annotated[Whole, Field(ge=1)] = _at("rfConfig", "rlFrameCfg_t", "numLoops")
    period_ms: Above = _at("rfConfig", "rlFrameCfg_t", "framePeriodicity_msec")
    lanes: Whole = _at("rawDataCaptureConfig", "rlDevLaneEnable_t", "laneEn")
    interleave: Whole = _at("rawDataCaptureConfig", "rlDevDataFmtCfg_t", "chInterleave")
    swap: Whole = _at("rawDataCaptureConfig", "rlDevDataFmtCfg_t", "iqSwapSel")
    packet: Annotated[Literal[1], BeforeValidator(_hexadecimal)] = _at(
        "rawDataCaptureConfig", "rlDevDataPathCfg_t", "transferFmtPkt0"
    )


class _Studio(_Ti):
    devices: tuple[_Device] = _at("mmWaveDevices")  # cascades are not read


def read_header(path: Path) -> dict[str, Any]:
    """Read the settings of a capture (fields of `CaptureSettings`) from a TI header.

    Args:
        path: mmWave Studio's JSON, or a .cfg of the SDK's demos.

    Raises:
        CaptureError: the file cannot be read, or describes what is not supported; names file,
            field, value and what would be right.
    """
    try:
        if path.suffix.lower() == ".json":
            device = validated(_Studio, _studio(path), str(path), {}).devices[0]
        else:
            device = validated(_Device, *_demo(text_of(path, MAX_CFG, CaptureError), str(path)))
    except ConfigError as error:
        raise CaptureError(str(error).partition("\n")[0]) from None
    if device.lanes.bit_count() not in (2, 4):
        raise CaptureError(f"{path}: laneEn = {device.lanes:#x}: should enable 2 or 4 lanes")
    lanes = [n for n in range(4) if device.receivers >> n & 1]
    return {
        **_timing(device, path),
        "receivers": len(lanes),
        "receiver_lanes": lanes,
        "complex": device.output != 0,
        "adc_bits": 12 + 2 * device.bits,
        "lanes": device.lanes.bit_count(),
        "interleaved": device.interleave == 0,
        "iq": "qi" if device.swap == 1 else "iq",
    }


def _studio(path: Path) -> Any:
    document = read_json(path)
    if isinstance(document, dict) and "configUsed" in document:
        raise CaptureError(
            f"{path}: is the setup file of mmWave Studio; --radar should name the file of its "
            f"configUsed: {document['configUsed']}"
        )
    return document


class _Chirps(NamedTuple):
    """A frame's chirps: their profile, and the mask of transmitters of each."""

    profile: _Profile
    masks: list[int]

    @property
    def rate_hz(self) -> float:
        """Rate of the ADC's samples."""
        return self.profile.rate_ksps * 1e3

    @property
    def slope_hz(self) -> float:
        """Slope of the chirp, Hz per second."""
        return self.profile.slope * 1e12

    @property
    def interval_s(self) -> float:
        """Time from the start of a chirp to that of the next: idle time + ramp end time."""
        return (self.profile.idle_us + self.profile.ramp_us) * 1e-6

    @property
    def carrier_hz(self) -> float:
        """Frequency at the first sample that is kept."""
        return self.profile.start_ghz * 1e9 + self.slope_hz * self.profile.adc_us * 1e-6


def _chirps(device: _Device, where: str) -> _Chirps:
    by_number = {
        number: chirp
        for chirp in device.chirps
        for number in range(chirp.first, min(chirp.last, MAX_CHIRPS - 1) + 1)
    }
    chirps = [by_number.get(n) for n in range(device.first, min(device.last, MAX_CHIRPS) + 1)]
    masks = [chirp.transmitters for chirp in chirps if chirp]
    if not masks or len(masks) < len(chirps):
        raise CaptureError(
            f"{where}: chirps {device.first} to {device.last} of a frame: should all be defined, "
            f"at most {MAX_CHIRPS}"
        )
    profiles = {one.number: one for one in device.profiles}
    used = {chirp.profile for chirp in chirps if chirp}
    if len(used) != 1 or not used <= profiles.keys():
        raise CaptureError(f"{where}: profileId {sorted(used)}: should be one that is defined")
    found = _Chirps(profiles[used.pop()], masks)
    profile, rate_hz = found.profile, found.rate_hz
    sampled_us = profile.ramp_us - profile.adc_us
    if profile.samples / rate_hz > sampled_us * 1e-6 * (1 + 1e-6):
        raise CaptureError(
            f"{where}: numAdcSamples = {profile.samples}: at {rate_hz:g} Hz they end after the "
            f"ramp ({profile.ramp_us:g} us); at most {max(int(sampled_us * rate_hz / 1e6), 0)} "
            "would fit"
        )
    busy = device.loops * len(masks) * found.interval_s
    if busy > device.period_ms * 1e-3 * (1 + 1e-6):
        raise CaptureError(
            f"{where}: framePeriodicity = {device.period_ms:g}: should be at least "
            f"{busy * 1e3:.6g} ms, {device.loops} loops of {len(masks)} chirps of "
            f"{found.interval_s * 1e6:g} us"
        )
    return found


def _timing(device: _Device, path: Path) -> dict[str, Any]:
    chirps = _chirps(device, str(path))
    profile, turns = chirps.profile, _period(chirps.masks)
    return {
        "carrier_hz": chirps.carrier_hz,
        "bandwidth_hz": chirps.slope_hz * profile.samples / chirps.rate_hz,
        "adc_rate_hz": chirps.rate_hz,
        "prf_hz": 1 / (turns * chirps.interval_s),
        "samples": profile.samples,
        "transmitters": turns,
        "frame_pulses": device.loops * len(chirps.masks) // turns,
        "frame_s": device.period_ms * 1e-3,
    }


def _period(masks: Sequence[int]) -> int:
    """Number of chirps after which the sequence of transmitters repeats."""
    count = len(masks)
    return next(
        n
        for n in range(1, count + 1)
        if count % n == 0 and all(masks[k] == masks[k % n] for k in range(count))
    )


# {command: where mmWave Studio has its numbers, and their names there, in the order of the .cfg}
_COMMANDS = {
    "channelCfg": (("rlChanCfg_t",), ("rxChannelEn",)),
    "adcCfg": (("rlAdcOutCfg_t", "fmt"), ("b2AdcBits", "b2AdcOutFmt")),
    "profileCfg": (
        ("rlProfiles", "rlProfileCfg_t"),
        (
            *("profileId", "startFreqConst_GHz", "idleTimeConst_usec", "adcStartTimeConst_usec"),
            *("rampEndTime_usec", "txOutPower", "txPhaseShifter", "freqSlopeConst_MHz_usec"),
            *("txStartTime_usec", "numAdcSamples", "digOutSampleRate"),
        ),
    ),
    "chirpCfg": (
        ("rlChirps", "rlChirpCfg_t"),
        (
            *("chirpStartIdx", "chirpEndIdx", "profileId", "startFreqVar_MHz"),
            *("freqSlopeVar_KHz_usec", "idleTimeVar_usec", "adcStartTimeVar_usec", "txEnable"),
        ),
    ),
    "frameCfg": (
        ("rlFrameCfg_t",),
        ("chirpStartIdx", "chirpEndIdx", "numLoops", "numFrames", "framePeriodicity_msec"),
    ),
}


def _demo(text: str, path: str) -> tuple[dict[str, Any], str, dict[str, str]]:
    """A .cfg as (document of mmWave Studio, file, {key of the document: file:line})."""
    rf: dict[str, Any] = {"rlProfiles": [], "rlChirps": []}
    sample_swap, channel_interleave = "0", "1"
    places = dict[str, str]()
    for number, line in enumerate(text.splitlines(), 1):
        command, *words = line.partition("%")[0].split() or [""]
        where = f"{path}:{number}"
        if command in ("advFrameCfg", "subFrameCfg"):
            raise CaptureError(f"{where}: {command}: advanced frames are not read; use frameCfg")
        if command == "lvdsStreamCfg" and words[1:2] not in ([], ["0"]):
            raise CaptureError(f"{where}: {command} enableHeader = {words[1]}: should be 0")
        if command == "adcbufCfg":
            if len(words) < 4:
                raise CaptureError(f"{where}: {command}: should have 4 or 5 numbers")
            sample_swap, channel_interleave = words[-3:-1]  # SDK 2 put the sub-frame in front
        if command in _COMMANDS:
            (section, *inner), names = _COMMANDS[command]
            values: Any = dict(zip(names, words, strict=False))
            values = {inner[0]: values} if inner else values
            key = f"rfConfig.{section}"
            if isinstance(rf.get(section), list):
                key += f".{len(rf[section])}"
                rf[section].append(values)
            else:
                rf[section] = values
            places[key] = where
    for command, ((section, *_), _) in _COMMANDS.items():
        if not rf.get(section):
            raise CaptureError(f"{path}: {command} is missing")
    raw = {
        "rlDevLaneEnable_t": {"laneEn": "0xF" if channel_interleave == "0" else "0x3"},
        "rlDevDataFmtCfg_t": {"chInterleave": channel_interleave, "iqSwapSel": sample_swap},
        "rlDevDataPathCfg_t": {"transferFmtPkt0": 1},
    }
    return {"rfConfig": rf, "rawDataCaptureConfig": raw}, path, places


@dataclass(frozen=True)
class BoardHeader:
    """What a .cfg says of a board, whichever device it runs on."""

    start_hz: float  # frequency at which a ramp starts
    carrier_hz: float  # at the first sample that is kept
    slope_hz: float  # per second
    # adc_rate_hz, samples: of a chirp
    adc_rate_hz: float
    samples: int
    slot_s: float  # from chirp to chirp
    order: tuple[int, ...]  # numbers of the transmitters in their order within a loop, from 0 on
    receivers: tuple[int, ...]  # numbers of those that are on, from 0 on
    loops: int  # of a frame
    frames: int  # of the recording; 0 is as many as there is time for
    period_s: float  # from frame to frame
    detection: Detection  # of its point cloud
    unknown: tuple[str, ...]  # commands that say nothing here
    not_simulated: tuple[str, ...]  # commands that switch on what is not simulated

    @property
    def frames_apart(self) -> bool:
        """Whether there is time between the last chirp of a frame and the next frame."""
        chirps_s = self.loops * len(self.order) * self.slot_s
        return abs(self.period_s - chirps_s) >= 1e-9 * self.period_s

    @property
    def numbers(self) -> dict[str, float]:
        """{key of `radar`: number} of all that the .cfg gives."""
        chirp_s = self.samples / self.adc_rate_hz
        return {
            "carrier_hz": self.carrier_hz,
            "bandwidth_hz": self.slope_hz * chirp_s,
            "prf_hz": 1 / (self.slot_s * len(self.order)),
            "adc_rate_hz": self.adc_rate_hz,
            "chirp_s": chirp_s,
        }


@lru_cache(maxsize=16)
def board_header(text: str, where: str = "radar.cfg") -> BoardHeader:
    """Read a board from the text of its .cfg.

    Args:
        text: lines of the .cfg.
        where: file or key that messages name.

    Raises:
        CaptureError: a line cannot be read, or asks for what boards of radhar cannot do.
    """
    try:
        device = validated(_Device, *_demo(text, where))
    except ConfigError as error:
        raise CaptureError(str(error).partition("\n")[0]) from None
    if (device.bits, device.output) != (2, 1):
        raise CaptureError(
            f"{where}: adcCfg {device.bits} {device.output}: should be 2 1, complex samples of "
            "which no image is kept"
        )
    chirps = _chirps(device, where)
    if any(mask.bit_count() != 1 for mask in chirps.masks):
        raise CaptureError(
            f"{where}: chirpCfg: masks of transmitters {chirps.masks}: should name one transmitter "
            "a chirp (they take turns)"
        )
    order = tuple(mask.bit_length() - 1 for mask in chirps.masks)
    if len(set(order)) < len(order):
        raise CaptureError(
            f"{where}: frameCfg: masks {chirps.masks}: should send once a loop from each"
        )
    receivers = tuple(n for n in range(4) if device.receivers >> n & 1)
    if not receivers:
        raise CaptureError(f"{where}: channelCfg: should have a receiver that is on")
    detection, unknown = _detection(text, where, len(order) * len(receivers))
    profile = chirps.profile
    bins = 1 << (profile.samples - 1).bit_length()
    reach = detection.along_range.window + detection.along_range.guard
    if 2 * reach + 1 > bins:
        raise CaptureError(
            f"{where}: cfarCfg: {reach} cells on each side: should fit into {bins} range bins"
        )
    return BoardHeader(
        start_hz=profile.start_ghz * 1e9,
        carrier_hz=chirps.carrier_hz,
        slope_hz=chirps.slope_hz,
        adc_rate_hz=chirps.rate_hz,
        samples=profile.samples,
        slot_s=chirps.interval_s,
        order=order,
        receivers=receivers,
        loops=device.loops,
        frames=device.frames,
        period_s=device.period_ms * 1e-3,
        detection=detection,
        unknown=unknown,
        not_simulated=_find_switches_without_effect(text),
    )


_IGNORED = {
    *("sensorStop", "sensorStart", "flushCfg", "dfeDataOutputMode", "adcbufCfg", "lowPower"),
    *("guiMonitor", "analogMonitor", "CQRxSatMonitor", "CQSigImgMonitor", "calibDcRangeSig"),
    *("measureRangeBiasAndRxChanPhase", "lvdsStreamCfg", "calibData", "configDataPort"),
    *("bpmCfg", "extendedMaxVelocity", "nearFieldCfg"),
}
# {command: which of its last words switch it on; a sub-frame may stand in front}
_SWITCHES = {
    "extendedMaxVelocity": slice(-1, None),
    "bpmCfg": slice(-3, -2),
    "nearFieldCfg": slice(-3, -2),
    "calibDcRangeSig": slice(-4, -3),
    "measureRangeBiasAndRxChanPhase": slice(-3, -2),
    "profileCfg": slice(5, 7),  # lower transmit power, and turned phases
}
_BY_DEFAULT = Cfar(CASO, 8, 4, False, 15.0)


def _find_switches_without_effect(text: str) -> tuple[str, ...]:
    """Find commands, each once, that switch on what neither a cube nor its points have."""
    commands = dict[str, None]()
    for line in text.splitlines():
        command, *words = line.partition("%")[0].split() or [""]
        if any(
            float(word) != 0 for word in words[_SWITCHES.get(command, slice(0))] if _is_number(word)
        ):
            commands[command] = None
    return tuple(commands)


def _is_number(word: str) -> bool:
    try:
        return isfinite(float(word))
    except ValueError:
        return False


def _detection(text: str, where: str, channels: int) -> tuple[Detection, tuple[str, ...]]:
    """What the lines on detection say, and the commands that are not known."""
    found: dict[str, Any] = {}
    unknown = list[str]()
    for number, line in enumerate(text.splitlines(), 1):
        command, *words = line.partition("%")[0].split() or [""]
        if command in _COMMANDS or command in _IGNORED or not command:
            continue
        if command not in _LINES:
            unknown.append(command)
            continue
        counts, read = _LINES[command]
        try:
            values = [float(word) for word in words]
            if len(values) - 1 in counts:
                values = values[1:]  # the sub-frame, which SDK 3 puts in front
            elif len(values) not in counts:
                raise ValueError
            read(found, values, channels)
        except (ValueError, OverflowError):
            right = " or ".join(map(str, counts))
            raise CaptureError(
                f"{where}:{number}: {command} {' '.join(words)}: should have {right} numbers, as "
                "the user guide of the SDK has them"
            ) from None
    found.setdefault("along_range", _BY_DEFAULT)
    return Detection(**found), tuple(dict.fromkeys(unknown))


def _read_cfar(found: dict[str, Any], values: list[float], channels: int) -> None:
    """Read cfarCfg, of either axis; of SDK 1 it has the peak grouping, too."""
    along, mode, window, guard, _, cyclic, threshold, *grouping = values
    if mode not in (CA, CAGO, CASO) or not 1 <= window <= 1024 or not 0 <= guard <= 1024:
        raise ValueError
    decibels = threshold if grouping else ti_threshold_db(threshold, channels)
    cfar = Cfar(int(mode), int(window), int(guard), bool(cyclic), decibels)
    found["along_doppler" if along else "along_range"] = cfar
    if grouping:
        old = found.get("grouping", (False, False))
        found["grouping"] = (old[0], bool(grouping[0])) if along else (bool(grouping[0]), old[1])


def _read_grouping(found: dict[str, Any], values: list[float], channels: int) -> None:
    """Read peakGrouping: along which axes peaks are grouped, and the range bins that count."""
    _, ranges, doppler, first, last = values
    found["grouping"] = bool(ranges), bool(doppler)
    found["first_bin"], found["last_bin"] = int(first), int(last)


def _read_bias(found: dict[str, Any], values: list[float], channels: int) -> None:
    """Read compRangeBiasAndRxChanPhase: range bias, m, and a complex factor of each channel."""
    found["bias"] = values[0]
    pairs = zip(values[1::2], values[2::2], strict=True)
    coefficients = tuple(complex(*pair) for pair in pairs)[:channels]
    if len(coefficients) < channels:
        raise ValueError
    found["coefficients"] = () if set(coefficients) == {1 + 0j} else coefficients


def _read_beam_forming(found: dict[str, Any], values: list[float], channels: int) -> None:
    """Read multiObjBeamForming: share of the highest peak from which a second one counts."""
    enabled, threshold = values
    found["second_peak"] = threshold if enabled else None


def _read_clutter_removal(found: dict[str, Any], values: list[float], channels: int) -> None:
    """Read clutterRemoval: whether the mean of a frame is taken out."""
    found["remove_mean"] = bool(values[0])


def _read_angle_limits(found: dict[str, Any], values: list[float], channels: int) -> None:
    """Read aoaFovCfg: least and most azimuth and elevation of points, degrees."""
    found["azimuth_deg"], found["elevation_deg"] = tuple(values[:2]), tuple(values[2:])


def _read_cfar_limits(found: dict[str, Any], values: list[float], channels: int) -> None:
    """Read cfarFovCfg: least and most range, m, or speed, m/s, of points."""
    along_doppler, *limits = values
    found["doppler_mps" if along_doppler else "range_m"] = tuple(limits)


_Read: TypeAlias = Callable[[dict[str, Any], list[float], int], None]
# {command: (how many numbers it has, what reads them)}; SDK 3 has the sub-frame in front as well.
_LINES: dict[str, tuple[tuple[int, ...], _Read]] = {
    "cfarCfg": ((7, 8), _read_cfar),
    "peakGrouping": ((5,), _read_grouping),
    "multiObjBeamForming": ((2,), _read_beam_forming),
    "clutterRemoval": ((1,), _read_clutter_removal),
    "compRangeBiasAndRxChanPhase": ((*range(3, 26, 2),), _read_bias),
    "aoaFovCfg": ((4,), _read_angle_limits),
    "cfarFovCfg": ((3,), _read_cfar_limits),
}
