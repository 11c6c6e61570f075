"""The header of a capture in a script of mmWave Studio (Lua).

Order and units of arguments: mmWave Studio User's Guide, calls `ar1.ProfileConfig`, `ChirpConfig`,
`FrameConfig`, `ChanNAdcConfig`, `LVDSLaneConfig` and `DataFmtConfig`. The script is read, not run
(`lua_calls.py`): calls that differ, and arguments that are no numbers there, are asked for.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import text_of
from radhar_cli.radar.frame_timing import FrameTiming, Sampling
from radhar_cli.readers.ti.lua_calls import DeviceCall, read_device_calls
from radhar_cli.readers.ti.lvds_format import LvdsFormat
from radhar_cli.readers.ti.ti_chirps import ChirpProfile, ChirpRange, StatedFrame, make_timing

MAX_LUA = 2**18  # bytes
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


def read_lua(path: Path) -> tuple[FrameTiming, LvdsFormat]:
    """Read a header from a script of mmWave Studio.

    Returns:
        Chirps, frames and samples, and the order of words in the capture.

    Raises:
        CaptureError: A call is missing, differs from another, has an argument that is no number, or
            asks for what is not read; names line and argument.
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
    timing = make_timing(
        {call.whole_number(0): _profile(call) for call in _calls_of("ProfileConfig", calls)},
        [_chirps(call) for call in _calls_of("ChirpConfig", calls)],
        StatedFrame(
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
    return timing, LvdsFormat(count, is_interleaved, is_q_first)


def _calls(text: str, path: Path) -> list[Call]:
    """Calls that hold when frames are started: one of each name, of each profile and of each chirp.

    Raises:
        CaptureError: Two of them differ, or one is not of numbers that the script says.
    """
    calls, is_started, is_changed = dict[tuple[object, ...], DeviceCall](), False, False
    for device_call in read_device_calls(text.removeprefix("\ufeff")):
        call = _of_first_device(device_call, path)
        place = f"{path}:{call.line}: {call.name}"
        if call.name.lower().startswith("startframe"):
            if is_changed:
                raise CaptureError(
                    f"{place}: starts frames again, with other settings; --radar should name a "
                    "copy of the script with those of this capture alone"
                )
            is_started = True
        if call.name.lower() not in NAMES:
            continue
        name = NAMES[call.name.lower()]
        count = {"ProfileConfig": 1, "ChirpConfig": 2}.get(name, 0)
        before = calls.setdefault((name, *call.arguments[:count]), call)
        if is_started:
            is_changed |= before.arguments != call.arguments or before.line == call.line
        elif before.arguments != call.arguments:
            raise CaptureError(
                f"{place}: differs from line {before.line}, and the script does not tell which "
                "holds; --radar should name a copy with one of them"
            )
    return [_numbers_of(NAMES[call.name.lower()], call, path) for call in calls.values()]


def _of_first_device(call: DeviceCall, path: Path) -> DeviceCall:
    """Return a call with the name and the arguments that it has of a single chip.

    Raises:
        CaptureError: It sets what is not read.
    """
    name = call.name.lower()
    if name in UNREAD:
        raise CaptureError(
            f"{path}:{call.line}: {call.name}: frames of subframes are not read from "
            "scripts; --radar should name the .mmwave.json that mmWave Studio exports"
        )
    single = name.removesuffix("_mult")  # of cascades: a mask of devices comes first
    if single == name or single not in NAMES:
        return call
    if call.arguments[:1] != (1.0,):
        raise CaptureError(
            f"{path}:{call.line}: {call.name}: device 1 alone is read; of cascades of "
            f"several chips give the keys by --set: {KEYS}"
        )
    return DeviceCall(call.line, single, call.arguments[1:])


def _numbers_of(name: str, call: DeviceCall, path: Path) -> Call:
    """Return a call whose arguments are all numbers.

    Raises:
        CaptureError: An argument is none in the script, or there are too few.
    """
    place = f"{path}:{call.line}"
    numbers = [argument for argument in call.arguments if isinstance(argument, float)]
    for index, argument in enumerate(call.arguments):
        if isinstance(argument, str):
            cause = argument[:60] or "nothing"
            is_name = cause.isidentifier() and cause not in ("nil", "true", "false")
            mend = f"`{cause} = ...` before it" if is_name else "the number in its place"
            raise CaptureError(
                f"{place}: {name} argument {index + 1} depends on {cause}, which is no number in "
                f"the script: --radar should name a copy with {mend}, or --set give {KEYS}"
            )
    if len(numbers) < FEWEST[name]:
        raise CaptureError(
            f"{place}: {name}: has {len(numbers)} arguments; should have {FEWEST[name]} or more"
        )
    return Call(place, name, tuple(numbers))


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
