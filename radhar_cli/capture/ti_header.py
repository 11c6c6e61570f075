"""The header of a capture with a TI radar: mmWave Studio's JSON, or the .cfg of the SDK's demos.

Fields and units: mmWave SDK user guide, "Configuration (.cfg) File Format"; mmWave Radar Interface
Control Document; the JSON schema of mmWave Studio, as its rawDataReader.m reads it. A chirp takes
T_c = idle time + ramp end time. Transmitters that take turns have PRF = 1/(n T_c) each. The ADC
starts later than the ramp: carrier = start frequency + slope times that.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import AliasPath, BeforeValidator, ConfigDict, Field

from radhar_cli.config.reading import validated
from radhar_cli.config.schema import Section
from radhar_cli.errors import CaptureError, ConfigError
from radhar_cli.untrusted import read_json, read_text

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
    """A field whose value lies at that path of the JSON document."""
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
    """Settings (`CaptureSettings`) from a TI header.

    Raises:
        CaptureError: it is not a TI header, or describes a capture that radhar cannot use; names
            file, field, value.
    """
    try:
        if path.suffix.lower() == ".json":
            device = validated(_Studio, _studio(path), str(path), {}).devices[0]
        else:
            device = validated(_Device, *_demo(path))
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


def _timing(device: _Device, path: Path) -> dict[str, Any]:
    by_number = {
        number: chirp
        for chirp in device.chirps
        for number in range(chirp.first, min(chirp.last, MAX_CHIRPS - 1) + 1)
    }
    chirps = [by_number.get(n) for n in range(device.first, min(device.last, MAX_CHIRPS) + 1)]
    masks = [chirp.transmitters for chirp in chirps if chirp]
    if not masks or len(masks) < len(chirps):
        raise CaptureError(
            f"{path}: chirps {device.first} to {device.last} of a frame: should all be defined, at "
            f"most {MAX_CHIRPS}"
        )
    profiles = {one.number: one for one in device.profiles}
    used = {chirp.profile for chirp in chirps if chirp}
    if len(used) != 1 or not used <= profiles.keys():
        raise CaptureError(f"{path}: profileId {sorted(used)}: should be one that is defined")
    profile = profiles[used.pop()]
    rate_hz, slope_hz = profile.rate_ksps * 1e3, profile.slope * 1e12
    interval_s = (profile.idle_us + profile.ramp_us) * 1e-6
    sampled_us = profile.ramp_us - profile.adc_us
    if profile.samples / rate_hz > sampled_us * 1e-6 * (1 + 1e-6):
        raise CaptureError(
            f"{path}: numAdcSamples = {profile.samples}: at {rate_hz:g} Hz they end after the ramp "
            f"({profile.ramp_us:g} us); at most {max(int(sampled_us * rate_hz / 1e6), 0)} would fit"
        )
    turns = _period(masks)
    busy = device.loops * len(masks) * interval_s
    if busy > device.period_ms * 1e-3 * (1 + 1e-6):
        raise CaptureError(
            f"{path}: framePeriodicity = {device.period_ms:g}: should be at least "
            f"{busy * 1e3:.6g} ms, {device.loops} loops of {len(masks)} chirps of "
            f"{interval_s * 1e6:g} us"
        )
    return {
        "carrier_hz": profile.start_ghz * 1e9 + slope_hz * profile.adc_us * 1e-6,
        "bandwidth_hz": slope_hz * profile.samples / rate_hz,
        "adc_rate_hz": rate_hz,
        "prf_hz": 1 / (turns * interval_s),
        "samples": profile.samples,
        "transmitters": turns,
        "frame_pulses": device.loops * len(masks) // turns,
        "frame_s": device.period_ms * 1e-3,
    }


def _period(masks: Sequence[int]) -> int:
    """After how many chirps the sequence of transmitters repeats."""
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


def _demo(path: Path) -> tuple[dict[str, Any], str, dict[str, str]]:
    """A .cfg as (document of mmWave Studio, file, {key of the document: file:line})."""
    try:
        text = read_text(path, MAX_CFG)
    except (OSError, UnicodeDecodeError) as error:
        told = getattr(error, "strerror", None) or error
        raise CaptureError(f"{path}: cannot be read as text ({told})") from None
    rf: dict[str, Any] = {"rlProfiles": [], "rlChirps": []}
    swap, order, places = "0", "1", dict[str, str]()
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
            swap, order = words[-3:-1]  # SDK 2 put the sub-frame in front
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
        "rlDevLaneEnable_t": {"laneEn": "0xF" if order == "0" else "0x3"},
        "rlDevDataFmtCfg_t": {"chInterleave": order, "iqSwapSel": swap},
        "rlDevDataPathCfg_t": {"transferFmtPkt0": 1},
    }
    return {"rfConfig": rf, "rawDataCaptureConfig": raw}, str(path), places
