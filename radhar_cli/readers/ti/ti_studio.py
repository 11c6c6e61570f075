"""The header of a capture in the JSON of mmWave Studio.

Keys and units: the JSON schema of mmWave Studio, as its rawDataReader.m reads it; mmWave Radar
Interface Control Document.
"""

import json
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import (
    AliasPath,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
)

from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import read_json
from radhar_cli.radar.frame_timing import FrameTiming, Sampling
from radhar_cli.readers.ti.lvds_format import LvdsFormat
from radhar_cli.readers.ti.ti_chirps import ChirpProfile, ChirpRange, StatedFrame, make_timing


def _parse_hexadecimal(value: object) -> object:
    """Return a text such as 0x3 as a number, anything else as it is."""
    try:
        return int(value, 16) if isinstance(value, str) and value[:2].lower() == "0x" else value
    except ValueError:
        return value


Whole: TypeAlias = Annotated[int, BeforeValidator(_parse_hexadecimal), Field(ge=0, lt=2**32)]
Time: TypeAlias = Annotated[float, Field(ge=0, le=1e6)]
Above: TypeAlias = Annotated[float, Field(gt=0, le=1e6)]
Unvaried: TypeAlias = Annotated[float, Field(ge=0, le=0)]  # chirps that differ are not read


def _field_at(*path: str, default: Any = ...) -> Any:
    """Field whose value lies at a path of the document."""
    return Field(default, validation_alias=AliasPath(*path))


class _Ti(BaseModel):
    model_config = ConfigDict(extra="ignore", frozen=True, allow_inf_nan=False)


class _Profile(_Ti):
    number: Whole = _field_at("rlProfileCfg_t", "profileId")
    start_ghz: Above = _field_at("rlProfileCfg_t", "startFreqConst_GHz")
    idle_us: Time = _field_at("rlProfileCfg_t", "idleTimeConst_usec")
    adc_us: Time = _field_at("rlProfileCfg_t", "adcStartTimeConst_usec")
    ramp_us: Annotated[Above, Field(ge=1e-3)] = _field_at("rlProfileCfg_t", "rampEndTime_usec")
    slope: Annotated[Above, Field(ge=1e-3)] = _field_at("rlProfileCfg_t", "freqSlopeConst_MHz_usec")
    samples: Annotated[Whole, Field(ge=2)] = _field_at("rlProfileCfg_t", "numAdcSamples")
    rate_ksps: Annotated[Above, Field(ge=1e-3)] = _field_at("rlProfileCfg_t", "digOutSampleRate")

    def profile(self, place: str) -> ChirpProfile:
        """Return the profile, whose messages name `place`."""
        return ChirpProfile(
            self.start_ghz,
            self.idle_us,
            self.adc_us,
            self.ramp_us,
            self.slope,
            self.samples,
            self.rate_ksps,
            place=place,
        )


class _Chirp(_Ti):
    first: Whole = _field_at("rlChirpCfg_t", "chirpStartIdx")
    last: Whole = _field_at("rlChirpCfg_t", "chirpEndIdx")
    profile: Whole = _field_at("rlChirpCfg_t", "profileId")
    transmitters: Annotated[Whole, Field(ge=1)] = _field_at("rlChirpCfg_t", "txEnable")
    start_change: Unvaried = _field_at("rlChirpCfg_t", "startFreqVar_MHz", default=0)
    slope_change: Unvaried = _field_at("rlChirpCfg_t", "freqSlopeVar_KHz_usec", default=0)
    idle_change: Unvaried = _field_at("rlChirpCfg_t", "idleTimeVar_usec", default=0)
    adc_change: Unvaried = _field_at("rlChirpCfg_t", "adcStartTimeVar_usec", default=0)


class _Device(_Ti):
    receivers: Whole = _field_at("rfConfig", "rlChanCfg_t", "rxChannelEn")
    bits: Annotated[Whole, Field(le=2)] = _field_at("rfConfig", "rlAdcOutCfg_t", "fmt", "b2AdcBits")
    output: Annotated[Whole, Field(le=2)] = _field_at(
        "rfConfig", "rlAdcOutCfg_t", "fmt", "b2AdcOutFmt"
    )
    profiles: tuple[_Profile, ...] = _field_at("rfConfig", "rlProfiles")
    chirps: tuple[_Chirp, ...] = _field_at("rfConfig", "rlChirps")
    first: Whole = _field_at("rfConfig", "rlFrameCfg_t", "chirpStartIdx")
    frames: Whole = _field_at("rfConfig", "rlFrameCfg_t", "numFrames", default=0)
    last: Whole = _field_at("rfConfig", "rlFrameCfg_t", "chirpEndIdx")
    loops: Annotated[Whole, Field(ge=1)] = _field_at("rfConfig", "rlFrameCfg_t", "numLoops")
    period_ms: Above = _field_at("rfConfig", "rlFrameCfg_t", "framePeriodicity_msec")
    lanes: Whole = _field_at("rawDataCaptureConfig", "rlDevLaneEnable_t", "laneEn")
    interleave: Whole = _field_at("rawDataCaptureConfig", "rlDevDataFmtCfg_t", "chInterleave")
    swap: Whole = _field_at("rawDataCaptureConfig", "rlDevDataFmtCfg_t", "iqSwapSel")
    packet: Annotated[Literal[1], BeforeValidator(_parse_hexadecimal)] = _field_at(
        "rawDataCaptureConfig", "rlDevDataPathCfg_t", "transferFmtPkt0"
    )


class _Studio(_Ti):
    devices: tuple[_Device] = _field_at("mmWaveDevices")  # cascades are not read


def read_studio(path: Path) -> tuple[FrameTiming, LvdsFormat]:
    """Read a header from the JSON of mmWave Studio.

    Returns:
        Chirps, frames and samples, and the order of words in the capture.

    Raises:
        CaptureError: The file cannot be read, or describes what is not supported; names file,
            key, value and what would be right.
    """
    try:
        device = _Studio.model_validate(_read_document(path)).devices[0]
    except ValidationError as error:
        raise CaptureError(f"{path}: {_first_mistake(error)}") from None
    if device.lanes.bit_count() not in (2, 4):
        raise CaptureError(f"{path}: laneEn = {device.lanes:#x}: should enable 2 or 4 lanes")
    place = f"{path}:"
    timing = make_timing(
        {each.number: each.profile(f"{place} numAdcSamples") for each in device.profiles},
        [
            ChirpRange(each.first, each.last, each.profile, each.transmitters, place)
            for each in device.chirps
        ],
        StatedFrame(
            device.first, device.last, device.loops, device.frames, device.period_ms, place
        ),
        device.receivers,
        Sampling(device.output),
        12 + 2 * device.bits,
    )
    stream = LvdsFormat(device.lanes.bit_count(), device.interleave == 0, device.swap == 1)
    return timing, stream


def _first_mistake(error: ValidationError) -> str:
    """Describe the first value that is wrong, with its key and what would be right."""
    mistake = error.errors(include_url=False)[0]
    key, value = ".".join(map(str, mistake["loc"])), mistake["input"]
    right = mistake["msg"].removeprefix("Input ").removeprefix("Tuple ").partition(" after ")[0]
    if mistake["type"] == "missing":
        return f"{key}: is required"
    if isinstance(value, dict | list | tuple):
        return f"{key}: {right}"
    return f"{key} = {json.dumps(value, default=str):.60}: {right}"


def _read_document(path: Path) -> Any:
    document = read_json(path)
    if isinstance(document, dict) and "configUsed" in document:
        raise CaptureError(
            f"{path}: is the setup file of mmWave Studio; --radar should name the file of its "
            f"configUsed: {document['configUsed']}"
        )
    return document
