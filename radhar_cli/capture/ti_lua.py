"""The header of a capture in a script of mmWave Studio (Lua), whose calls are read, not run.

Order and units of arguments: mmWave Studio User's Guide, calls `ar1.ProfileConfig`, `ChirpConfig`,
`FrameConfig`, `ChanNAdcConfig`, `LVDSLaneConfig` and `DataFmtConfig`.
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

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
TRANSMITTERS, RECEIVERS = 3, 4
_COMMENT = re.compile(r"--\[\[.*?\]\]|--[^\n]*", re.DOTALL)
_NUMBER = r"[-+]?(?:0[xX][0-9a-fA-F]+|\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+)"
_VALUE = re.compile(rf"^[ \t]*(?:local[ \t]+)?(\w+)[ \t]*=[ \t]*({_NUMBER})[ \t]*;?$", re.MULTILINE)
_CALL = re.compile(r"\bar1\.(\w+)\s*\(([^()]*)\)")


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
        CaptureError: a call is missing, or asks for what is not read; names line and argument.
    """
    calls = _calls(text_of(path, MAX_LUA, CaptureError), path)
    missing = [f"ar1.{name}" for name in NEEDED if not _calls_of(name, calls)]
    if missing:
        raise CaptureError(
            f"{path}: should call {', '.join(missing)} with numbers; of other scripts give the "
            "keys by --set or in YAML: carrier_hz, bandwidth_hz, adc_rate_hz, prf_hz, samples, "
            "receivers, frame_pulses, frame_s"
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
    is_q_first = bool(formats) and formats[-1].whole_number(2) == 1
    is_interleaved = bool(formats) and formats[-1].whole_number(3) == 0
    return header, LvdsFormat(count, is_interleaved, is_q_first)


def _calls(text: str, path: Path) -> list[Call]:
    """Calls with numbers in a script, whose names of numbers are replaced by their values.

    Raises:
        CaptureError: a call that is read has too few arguments, or others than numbers.
    """
    text = _COMMENT.sub(lambda comment: "\n" * comment[0].count("\n"), text)
    values = dict(_VALUE.findall(text))
    calls = list[Call]()
    for match in _CALL.finditer(text):
        name = match[1]
        if name not in FEWEST:
            continue
        place = f"{path}:{text.count(chr(10), 0, match.start()) + 1}"
        words = [word.strip() for word in match[2].split(",")]
        numbers = [_number(values.get(word, word)) for word in words]
        known = [number for number in numbers if number is not None]
        if len(known) < len(numbers) or len(known) < FEWEST[name]:
            raise CaptureError(
                f"{place}: {name}({match[2][:60]}): should have {FEWEST[name]} or more arguments, "
                "all numbers, or names that a line sets to one"
            )
        calls.append(Call(place, name, tuple(known)))
    return calls


def _number(word: str) -> float | None:
    """Number of a word of Lua; None of anything else, and of huge ones."""
    if not re.fullmatch(_NUMBER, word):
        return None
    value = float(int(word, 16)) if "x" in word.lower() else float(word)
    return value if abs(value) < 1e12 else None


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
