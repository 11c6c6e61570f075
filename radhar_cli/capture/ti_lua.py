"""The header of a capture in a script of mmWave Studio (Lua).

Order and units of arguments: mmWave Studio User's Guide, calls `ar1.ProfileConfig`, `ChirpConfig`,
`FrameConfig`, `ChanNAdcConfig`, `LVDSLaneConfig` and `DataFmtConfig`. The script is followed
(`lua_script.py`); it reaches nothing outside itself.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from radhar_cli.capture.lua_script import (
    DeviceCall,
    Script,
    Table,
    Unknown,
    Value,
    are_alike,
)
from radhar_cli.capture.lua_syntax import parse_lua
from radhar_cli.capture.lvds_format import LvdsFormat
from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import text_of
from radhar_cli.radar.frame_header import ChirpProfile, FrameHeader, Sampling
from radhar_cli.radar.ti_cfg import ChirpRange, FrameTiming, make_frame_header

MAX_LUA = 2**20  # bytes
NEEDED = ("ChanNAdcConfig", "ProfileConfig", "ChirpConfig", "FrameConfig")
FEWEST = {
    "ChanNAdcConfig": 10,
    "ProfileConfig": 15,
    "ChirpConfig": 8,
    "FrameConfig": 5,
    "LVDSLaneConfig": 5,
    "DataFmtConfig": 4,
}
NAMES = {name.lower(): name for name in FEWEST}
UNREAD = {"advanceframeconfig", "advancedframeconfig"}
TRANSMITTERS, RECEIVERS = 3, 4
LARGEST = 1e12
KEYS = "carrier_hz, bandwidth_hz, adc_rate_hz, prf_hz, samples, receivers, frame_pulses, frame_s"


class Call(NamedTuple):
    """A call of a script.

    Attributes:
        place: File and line.
        name: Name after `ar1.`.
        arguments: Numbers of the arguments.
    """

    place: str
    name: str
    arguments: tuple[float, ...]

    def whole_number(self, place: int) -> int:
        """Argument at a place as a whole number.

        Raises:
            CaptureError: it is none, or is negative.
        """
        value = self.arguments[place]
        if value != int(value) or value < 0:
            raise CaptureError(
                f"{self.place}: {self.name} argument {place + 1} = {value:g}: should be a whole "
                "number"
            )
        return int(value)


def read_lua(path: Path) -> tuple[FrameHeader, LvdsFormat]:
    """Read a header from a script of mmWave Studio.

    Args:
        path: the script.

    Returns:
        Chirps, frames and samples, and the order of words in the capture.

    Raises:
        CaptureError: a call is missing, depends on what the script does not say, or asks for what
            is not read; names line and argument.
    """
    calls = _calls(text_of(path, MAX_LUA, CaptureError), path)
    missing = [f"ar1.{name}" for name in NEEDED if not _calls_of(name, calls)]
    if missing:
        raise CaptureError(
            f"{path}: should call {', '.join(missing)} with numbers; of other scripts give the "
            f"keys by --set or in YAML: {KEYS}"
        )
    channels = _calls_of("ChanNAdcConfig", calls)[-1]  # the last call is the one that holds
    frame = _calls_of("FrameConfig", calls)[-1]
    receivers = sum(bool(channels.whole_number(TRANSMITTERS + n)) << n for n in range(RECEIVERS))
    header = make_frame_header(
        {call.whole_number(0): _profile(call) for call in _calls_of("ProfileConfig", calls)},
        [_chirps(call) for call in _calls_of("ChirpConfig", calls)],
        FrameTiming(
            frame.whole_number(0),
            frame.whole_number(1),
            frame.whole_number(3),
            frame.whole_number(2),
            frame.arguments[4],
            frame.place,
        ),
        receivers,
        _sampling(channels),
        12 + 2 * min(channels.whole_number(7), 2),
    )
    lanes = _calls_of("LVDSLaneConfig", calls)
    count = 4 if lanes and lanes[-1].whole_number(3) and lanes[-1].whole_number(4) else 2
    formats = _calls_of("DataFmtConfig", calls)
    is_q_first = bool(channels.whole_number(9)) or (
        bool(formats) and formats[-1].whole_number(2) == 1
    )
    is_interleaved = bool(formats) and formats[-1].whole_number(3) == 0
    return header, LvdsFormat(count, is_interleaved, is_q_first)


class _Record:
    """Calls of a script that hold: the last of a name, of a profile, or of chirps.

    Args:
        path: the script.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.calls, self.starts = Table(), Table()  # {name and number: its arguments}
        self.lines = dict[Value, list[int]]()

    def __call__(self, script: Script, call: DeviceCall) -> None:
        """Store a call of the radar if it is read.

        Raises:
            CaptureError: it sets what is not read.
        """
        name, arguments = call.name.lower(), call.arguments
        if name in UNREAD:
            raise CaptureError(
                f"{self.path}:{call.line}: {call.name}: frames of subframes are not read from "
                "scripts; --radar should name the .mmwave.json that mmWave Studio exports"
            )
        if name.startswith("startframe"):
            self._start(script, call.line)
        if name.endswith("_mult"):  # of cascades: a mask of devices comes first
            name, arguments = name.removesuffix("_mult"), arguments[1:]
            if name in NAMES and call.arguments[:1] != (1.0,):
                raise CaptureError(
                    f"{self.path}:{call.line}: {call.name}: device 1 alone is read; of cascades of "
                    f"several chips give the keys by --set: {KEYS}"
                )
        if name in NAMES:
            numbers = {"profileconfig": 1, "chirpconfig": 2}.get(name, 0)
            words = [f"{v:g}" for v in arguments[:numbers] if isinstance(v, float)]
            key = " ".join([NAMES[name], *words])
            self.lines.setdefault(key, []).append(call.line)
            script.write(
                self.calls, key, Table({float(n): value for n, value in enumerate(arguments)})
            )

    def _start(self, script: Script, line: int) -> None:
        """Note the calls that hold when frames are started.

        Raises:
            CaptureError: frames were started before, with other calls.
        """
        calls = Table({**self.calls.entries})
        before = self.starts.entries.get("calls", calls)
        if not are_alike(before, calls):
            raise CaptureError(
                f"{self.path}:{line}: StartFrame: starts frames again, with other settings; "
                "--radar should name a copy of the script with those of this capture alone"
            )
        script.write(self.starts, "calls", calls)

    def effective_calls(self) -> list[Call]:
        """Calls that hold at the start of the frames, or at the end of a script without.

        Raises:
            CaptureError: a call depends on what the script does not say.
        """
        started = self.starts.entries.get("calls")
        calls = (started if isinstance(started, Table) else self.calls).entries
        return [self._call(str(key), arguments) for key, arguments in calls.items()]

    def _call(self, key: str, arguments: Value) -> Call:
        """Call of a name with its arguments, all numbers.

        Raises:
            CaptureError: an argument is none, or depends on what the script does not say.
        """
        name, line = key.partition(" ")[0], self.lines[key][-1]
        place = f"{self.path}:{line}"
        if isinstance(arguments, Unknown):
            raise self._refusal(name, self.lines[key][0], arguments.cause)
        values = [*arguments.entries.values()] if isinstance(arguments, Table) else []
        if len(values) < FEWEST[name]:
            raise CaptureError(
                f"{place}: {name}: has {len(values)} arguments; should have {FEWEST[name]} or more"
            )
        for index, value in enumerate(values):
            argument = f"{name} argument {index + 1}"
            if isinstance(value, Unknown):
                raise self._refusal(argument, line, value.cause)
            if not isinstance(value, float | bool) or not abs(value) < LARGEST:
                raise CaptureError(
                    f"{place}: {argument}: should be a number, or a name that is set to one"
                )
        numbers = [float(value) for value in values if isinstance(value, float | bool)]
        return Call(place, name, tuple(numbers))

    def _refusal(self, argument: str, line: int, cause: str) -> CaptureError:
        """Error of what depends on something that is unknown."""
        mend = f"`{cause} = ...` before it" if cause.isidentifier() else "the number in its place"
        return CaptureError(
            f"{self.path}:{line}: {argument} depends on {cause}, which is known to no reader of "
            f"the script: --radar should name a copy with {mend}, or --set give {KEYS}"
        )


def _calls(text: str, path: Path) -> list[Call]:
    """Calls that hold, with their numbers.

    Raises:
        CaptureError: the text is no Lua, or a call is not of numbers that the script says.
    """
    record = _Record(path)
    Script(str(path), record).follow(parse_lua(text.removeprefix("\ufeff"), str(path)))
    return record.effective_calls()


def _calls_of(name: str, calls: Sequence[Call]) -> list[Call]:
    """Calls of a name, in their order."""
    return [call for call in calls if call.name == name]


def _profile(call: Call) -> ChirpProfile:
    """Ramp and samples of a profile."""
    numbers = call.arguments
    for place in (1, 11, 14):
        if numbers[place] <= 0:
            raise CaptureError(
                f"{call.place}: ProfileConfig argument {place + 1} = {numbers[place]:g}: should be "
                "above 0"
            )
    return ChirpProfile(
        start_ghz=numbers[1],
        idle_us=numbers[2],
        adc_start_us=numbers[3],
        ramp_end_us=numbers[4],
        slope_mhz_per_us=numbers[11],
        samples=call.whole_number(13),
        rate_ksps=numbers[14],
        place=f"{call.place}: ProfileConfig argument 14",
    )


def _chirps(call: Call) -> ChirpRange:
    """Chirps of a call, and their transmitters.

    Raises:
        CaptureError: their profile is changed, or nobody sends.
    """
    if any(call.arguments[3:7]):
        raise CaptureError(
            f"{call.place}: ChirpConfig arguments 4 to 7 = {call.arguments[3:7]}: should be 0; "
            "chirps that differ are not read"
        )
    flags = call.arguments[7 : 7 + TRANSMITTERS]
    mask = sum(bool(flag) << n for n, flag in enumerate(flags))
    if not mask:
        raise CaptureError(f"{call.place}: ChirpConfig: should switch a transmitter on")
    return ChirpRange(
        call.whole_number(0), call.whole_number(1), call.whole_number(2), mask, call.place
    )


def _sampling(call: Call) -> Sampling:
    """Kind of the samples, by the last but one argument that tells the format of the ADC."""
    kind = call.whole_number(8)
    if kind > 2:
        raise CaptureError(f"{call.place}: ChanNAdcConfig argument 9 = {kind}: should be 0, 1 or 2")
    return Sampling(kind)
