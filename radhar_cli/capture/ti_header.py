"""The header of a capture with a TI radar: mmWave Studio's JSON, or the .cfg of the SDK's demos.

Fields and units: mmWave SDK user guide, "Configuration (.cfg) File Format"; mmWave Radar Interface
Control Document; the JSON schema of mmWave Studio, as its rawDataReader.m reads it. A chirp takes
T_c = idle time + ramp end time. Transmitters that take turns have PRF = 1/(n T_c) each. The ADC
starts later than the ramp: carrier = start frequency + slope times that.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import Any, TypeVar

from radhar_cli.errors import CaptureError, did_you_mean
from radhar_cli.untrusted import read_json, read_text

T = TypeVar("T")
MAX_CFG = 2**16
MAX_CHIRPS = 512  # of a frame
TRANSMIT = "txEnable"


def read_header(path: Path) -> dict[str, Any]:
    """Settings (`CaptureSettings`) that a TI header says.

    Raises:
        CaptureError: it is none, or describes what radhar cannot use; names file, field, value.
    """
    return _studio(path) if path.suffix.lower() == ".json" else _demo(path)


class _Field:
    """A place in a JSON document, for reading and for messages."""

    def __init__(self, path: Path, value: Any, name: str = "") -> None:
        self.path, self.name = path, name
        self.value: Any = value

    @property
    def where(self) -> str:
        return f"{self.path}: {self.name}"

    def __getitem__(self, key: str | int) -> "_Field":
        name, kind = f"{self.name}.{key}".lstrip("."), list if isinstance(key, int) else dict
        if not isinstance(self.value, kind):
            raise CaptureError(f"{self.where}: should hold {key!r}")
        inner: Any = self.value
        try:
            return _Field(self.path, inner[key], name)
        except KeyError:
            hint = did_you_mean(str(key), map(str, self.value), "mmWave Studio writes it")
            raise CaptureError(f"{self.path}: {name}: is missing; {hint}") from None
        except IndexError:
            raise CaptureError(f"{self.path}: {name}: is missing") from None

    def __iter__(self) -> Iterator["_Field"]:
        if not isinstance(self.value, list):
            raise CaptureError(f"{self.where}: should be a list")
        return (self[n] for n in range(len(self.value)))

    def number(self) -> float:
        """A number, or a hexadecimal one in a text."""
        value = self.value
        if isinstance(value, str):
            try:
                return int(value, 16 if value.lower().startswith("0x") else 10)
            except ValueError:
                value = None
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not isfinite(value):
            raise CaptureError(f"{self.where} = {self.value!r}: should be a number")
        return value

    def whole(self) -> int:
        value = self.number()
        if value != int(value) or value < 0:
            raise CaptureError(f"{self.where} = {self.value!r}: should be a whole number from 0 on")
        return int(value)


def _studio(path: Path) -> dict[str, Any]:
    top = _Field(path, read_json(path))
    if isinstance(top.value, dict) and "configUsed" in top.value:
        raise CaptureError(
            f"{path}: is the setup file of mmWave Studio; --radar should name the file of its "
            f"configUsed: {top.value['configUsed']}"
        )
    devices = top["mmWaveDevices"]
    if len([*devices]) != 1:
        raise CaptureError(f"{devices.where}: should hold one device; cascades are not read")
    rf, raw = devices[0]["rfConfig"], devices[0]["rawDataCaptureConfig"]
    profiles = {
        one["rlProfileCfg_t"]["profileId"].whole(): one["rlProfileCfg_t"]
        for one in rf["rlProfiles"]
    }
    frame = rf["rlFrameCfg_t"]
    chirps = _studio_chirps(rf, frame)
    form = rf["rlAdcOutCfg_t"]["fmt"]
    used = {chirp.number() for chirp in (one["profileId"] for one in chirps)}
    if len(used) != 1 or not used <= profiles.keys():
        raise CaptureError(f"{rf['rlChirps'].where}: chirps should share one profile there is")
    profile = profiles[int(used.pop())]
    mask = rf["rlChanCfg_t"]["rxChannelEn"].whole()
    interleaved = raw["rlDevDataFmtCfg_t"]["chInterleave"].whole() == 0
    lanes = raw["rlDevLaneEnable_t"]["laneEn"]
    count = lanes.whole().bit_count()
    if count not in (2, 4):
        raise CaptureError(f"{lanes.where} = {lanes.value!r}: should enable 2 or 4 lanes")
    packet = raw["rlDevDataPathCfg_t"]["transferFmtPkt0"]
    if packet.whole() != 1:
        raise CaptureError(f"{packet.where} = {packet.value!r}: should be 0x1, ADC samples alone")
    return {
        **_timing(
            [one[TRANSMIT] for one in chirps],
            start_ghz=profile["startFreqConst_GHz"].number(),
            slope=profile["freqSlopeConst_MHz_usec"],
            idle_us=profile["idleTimeConst_usec"].number(),
            ramp_us=profile["rampEndTime_usec"].number(),
            adc_us=profile["adcStartTimeConst_usec"].number(),
            samples=profile["numAdcSamples"].whole(),
            rate=profile["digOutSampleRate"],
            loops=frame["numLoops"].whole(),
            frame=frame["framePeriodicity_msec"],
        ),
        **_receivers(mask),
        "complex": _is_complex(form["b2AdcOutFmt"]),
        "adc_bits": _bits(form["b2AdcBits"]),
        "lanes": count,
        "interleaved": interleaved,
        "iq": "qi" if raw["rlDevDataFmtCfg_t"]["iqSwapSel"].whole() == 1 else "iq",
    }


def _studio_chirps(rf: _Field, frame: _Field) -> list[_Field]:
    """The chirps of a frame, in order."""
    by_number: dict[int, _Field] = {}
    for one in rf["rlChirps"]:
        chirp = one["rlChirpCfg_t"]
        variable = ("startFreqVar_MHz", "freqSlopeVar_KHz_usec", "idleTimeVar_usec")
        _refuse_changes(chirp[key] for key in variable if key in chirp.value)
        by_number |= dict.fromkeys(_numbers(chirp["chirpStartIdx"], chirp["chirpEndIdx"]), chirp)
    return _of_frame(by_number, frame["chirpStartIdx"], frame["chirpEndIdx"], "rlChirps")


def _refuse_changes(variable: Iterable[_Field]) -> None:
    """Refuse chirps that differ from their profile."""
    for field in variable:
        if field.number() != 0:
            raise CaptureError(f"{field.where} = {field.value!r}: should be 0, all chirps alike")


def _numbers(first: _Field, last: _Field) -> range:
    """Numbers of the chirps that a line of the header defines."""
    return range(first.whole(), min(last.whole(), MAX_CHIRPS - 1) + 1)


def _of_frame(by_number: Mapping[int, T], first: _Field, last: _Field, where: str) -> list[T]:
    """The chirps of a frame, in order."""
    wanted = range(first.whole(), last.whole() + 1)
    count = wanted.stop - wanted.start  # len() has a limit
    if not 0 < count <= MAX_CHIRPS or not by_number.keys() >= {*wanted}:
        raise CaptureError(
            f"{last.where} = {last.value!r}: a frame should be made of chirps that {where} defines"
        )
    return [by_number[number] for number in wanted]


def _is_complex(output: _Field) -> bool:
    if output.whole() > 2:
        raise CaptureError(
            f"{output.where} = {output.value!r}: should be 0 (real), 1 or 2 (complex)"
        )
    return output.whole() != 0


def _bits(bits: _Field) -> int:
    if bits.whole() > 2:
        raise CaptureError(f"{bits.where} = {bits.value!r}: should be 0, 1 or 2 (12, 14, 16 bits)")
    return 12 + 2 * bits.whole()


def _receivers(mask: int) -> dict[str, Any]:
    lanes = [n for n in range(4) if mask >> n & 1]
    return {"receivers": len(lanes), "receiver_lanes": lanes}


def _timing(
    transmitters: Sequence[_Field],
    *,
    start_ghz: float,
    slope: _Field,
    idle_us: float,
    ramp_us: float,
    adc_us: float,
    samples: int,
    rate: _Field,
    loops: int,
    frame: _Field,
) -> dict[str, Any]:
    masks = [one.whole() for one in transmitters]
    if 0 in masks:
        raise CaptureError(f"{transmitters[masks.index(0)].where} = 0: should enable a transmitter")
    if not slope.number() > 0:
        raise CaptureError(f"{slope.where} = {slope.value!r}: should be above 0, a rising chirp")
    if not rate.number() > 0:
        raise CaptureError(f"{rate.where} = {rate.value!r}: should be above 0 (ksps)")
    rate_hz, slope_hz = rate.number() * 1e3, slope.number() * 1e12
    interval_s = (idle_us + ramp_us) * 1e-6
    if samples / rate_hz > (ramp_us - adc_us) * 1e-6 * (1 + 1e-6):
        most = int((ramp_us - adc_us) * 1e-6 * rate_hz)
        raise CaptureError(
            f"{rate.path}: {samples} samples at {rate_hz:g} Hz end after the ramp, {ramp_us:g} us; "
            f"{most} would fit, or {samples / (ramp_us - adc_us) * 1e3:.6g} ksps"
        )
    turns = _period(masks)
    frame_pulses = loops * len(masks) // turns
    busy, period = loops * len(masks) * interval_s, frame.number() * 1e-3
    if busy > period * (1 + 1e-6):
        raise CaptureError(
            f"{frame.where} = {frame.value!r}: should be at least {busy * 1e3:.6g} ms: "
            f"{loops} loops of {len(masks)} chirps of {interval_s * 1e6:g} us"
        )
    return {
        "carrier_hz": start_ghz * 1e9 + slope_hz * adc_us * 1e-6,
        "bandwidth_hz": slope_hz * samples / rate_hz,
        "adc_rate_hz": rate_hz,
        "prf_hz": 1 / (turns * interval_s),
        "samples": samples,
        "transmitters": turns,
        "frame_pulses": frame_pulses,
        "frame_s": period,
    }


def _period(masks: Sequence[int]) -> int:
    """After how many chirps the sequence of transmitters repeats."""
    count = len(masks)
    return next(
        n
        for n in range(1, count + 1)
        if count % n == 0 and all(masks[k] == masks[k % n] for k in range(count))
    )


# {command: names of its numbers}, in the order of the SDK's user guide.
_COMMANDS = {
    "channelCfg": ("rxChannelEn", "txChannelEn"),
    "adcCfg": ("numADCBits", "adcOutputFmt"),
    "profileCfg": (
        *("profileId", "startFreq", "idleTime", "adcStartTime", "rampEndTime", "txOutPower"),
        *("txPhaseShifter", "freqSlopeConst", "txStartTime", "numAdcSamples", "digOutSampleRate"),
    ),
    "chirpCfg": (
        *("startIdx", "endIdx", "profileId", "startFreqVar", "freqSlopeVar", "idleTimeVar"),
        *("adcStartTimeVar", TRANSMIT),
    ),
    "frameCfg": ("chirpStartIdx", "chirpEndIdx", "numLoops", "numFrames", "framePeriodicity"),
}


class _Commands:
    """The lines of a .cfg file."""

    def __init__(self, path: Path) -> None:
        self.path, self.lines = path, list[tuple[int, list[str]]]()
        try:
            text = read_text(path, MAX_CFG)
        except (OSError, UnicodeDecodeError) as error:
            told = getattr(error, "strerror", None) or error
            raise CaptureError(f"{path}: cannot be read as text ({told})") from None
        for number, line in enumerate(text.splitlines(), 1):
            words = line.partition("%")[0].split()
            if words:
                self.lines.append((number, words))

    def all(self, command: str) -> list[dict[str, _Field]]:
        names = _COMMANDS[command]
        return [
            {
                name: _Field(self.path, _plain(word), f"line {number}: {command} {name}")
                for name, word in zip(names, words[1:], strict=False)
            }
            for number, words in self.lines
            if words[0] == command
        ]

    def one(self, command: str) -> dict[str, _Field]:
        lines = self.all(command)
        if len(lines) != 1:
            raise CaptureError(f"{self.path}: {command}: should stand there once, not {len(lines)}")
        return self.whole(command, lines[0])

    def whole(self, command: str, fields: dict[str, _Field]) -> dict[str, _Field]:
        missing = [name for name in _COMMANDS[command] if name not in fields]
        if missing:
            raise CaptureError(f"{self.path}: {command}: {missing[0]} is missing")
        return fields

    def words(self, command: str) -> list[str]:
        return next((words[1:] for _, words in self.lines if words[0] == command), [])


def _plain(word: str) -> Any:
    try:
        return float(word) if "." in word or "e" in word.lower() else int(word)
    except ValueError:
        return word


def _demo(path: Path) -> dict[str, Any]:
    commands = _Commands(path)
    for command in ("advFrameCfg", "subFrameCfg"):
        if commands.words(command):
            raise CaptureError(f"{path}: {command}: advanced frames are not read; use frameCfg")
    profile, frame = commands.one("profileCfg"), commands.one("frameCfg")
    channels, adc = commands.one("channelCfg"), commands.one("adcCfg")
    by_number: dict[int, dict[str, _Field]] = {}
    for one in commands.all("chirpCfg"):
        chirp = commands.whole("chirpCfg", one)
        variable = ("startFreqVar", "freqSlopeVar", "idleTimeVar", "adcStartTimeVar")
        _refuse_changes(chirp[name] for name in variable)
        by_number |= dict.fromkeys(_numbers(chirp["startIdx"], chirp["endIdx"]), chirp)
    chirps = _of_frame(by_number, frame["chirpStartIdx"], frame["chirpEndIdx"], "chirpCfg")
    interleaved, swapped = _buffer(commands)
    return {
        **_timing(
            [one[TRANSMIT] for one in chirps],
            start_ghz=profile["startFreq"].number(),
            slope=profile["freqSlopeConst"],
            idle_us=profile["idleTime"].number(),
            ramp_us=profile["rampEndTime"].number(),
            adc_us=profile["adcStartTime"].number(),
            samples=profile["numAdcSamples"].whole(),
            rate=profile["digOutSampleRate"],
            loops=frame["numLoops"].whole(),
            frame=frame["framePeriodicity"],
        ),
        **_receivers(channels["rxChannelEn"].whole()),
        "complex": _is_complex(adc["adcOutputFmt"]),
        "adc_bits": _bits(adc["numADCBits"]),
        "lanes": 4 if interleaved else 2,
        "interleaved": interleaved,
        "iq": "qi" if swapped else "iq",
    }


def _buffer(commands: _Commands) -> tuple[bool, bool]:
    """(channels interleaved, Q before I), from adcbufCfg; its sub-frame came with SDK 2."""
    words, stream = commands.words("adcbufCfg"), commands.words("lvdsStreamCfg")
    if len(stream) > 1 and stream[1] != "0":
        raise CaptureError(
            f"{commands.path}: lvdsStreamCfg enableHeader = {stream[1]}: should be 0, samples alone"
        )
    if not words:
        return False, False
    if len(words) < 4:
        raise CaptureError(f"{commands.path}: adcbufCfg: should have 4 or 5 numbers")
    swap, order = words[-3], words[-2]
    return order == "0", swap == "1"
