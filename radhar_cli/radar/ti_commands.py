"""Commands of the .cfg of a TI board: their arguments, and what radhar makes of each.

The names are TI's. Sources: mmWave SDK user guide, "Configuration (.cfg) File Format"; the command
lines of TI's demos, SDK 1 to 4 and MMWAVE-L-SDK, and of its people counting and tracking. The page
docs/reference/ti_commands.md is made of this table.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property
from math import isfinite
from types import MappingProxyType

from radhar_cli.errors import CaptureError
from radhar_cli.radar.ti_family import Family

ALL_SUBFRAMES = -1
COUNT = 2**32 - 1  # largest whole number
LARGEST = 1e9  # of every other number


class Effect(Enum):
    """What a command does here."""

    SIGNAL = "describes the chirps, frames and samples: simulated, and read of captures"
    POINTS = "sets the detection of points: simulated"
    POSE = "sets the pose of the board, where the config does not"
    ELEMENTS = "describes the elements, which are the device's: a difference is said"
    BOX = "keeps the points in a box of the room, with `cloud.boundary_box: true`"
    WARNING = "is not simulated, and a warning says so"
    SILENT = "changes nothing here"
    NOT_SIMULATED = "is refused as radar.cfg"
    NOT_READ = "is refused"


class Subframe(Enum):
    """Whether the number of a subframe stands in front of a command's arguments."""

    NEVER = ""
    OPTIONAL = "[subFrameIdx]"
    ALWAYS = "subFrameIdx"


@dataclass(frozen=True)
class Argument:
    """One number of a command.

    Attributes:
        name: TI's name.
        low: Smallest number that is right.
        high: Largest number that is right.
        is_whole: Whether only whole numbers are right.
        meaning: What the numbers stand for, in messages; "" where the limits say all.
        is_optional: Whether a line may end before it.
        choices: Numbers that alone are right; () for those within the limits.
    """

    name: str
    low: float = -LARGEST
    high: float = LARGEST
    is_whole: bool = False
    meaning: str = ""
    is_optional: bool = False
    choices: tuple[int, ...] = ()

    @property
    def right(self) -> str:
        """What is right, as in "should be ..."."""
        return self._limits + f" ({self.meaning})" * bool(self.meaning)

    @property
    def _limits(self) -> str:
        if self.choices or (self.is_whole and self.high - self.low <= 3):
            numbers = self.choices or range(int(self.low), int(self.high) + 1)
            *choices, last = map(str, numbers)
            return f"{', '.join(choices)} or {last}" if choices else last
        if self.low == self.high:
            return f"{self.low:g}"
        kind = "a whole number" if self.is_whole else "a number"
        if self.high == (COUNT if self.is_whole else LARGEST):
            return kind if self.low < 0 else f"{kind} from {self.low:g}"
        return f"{kind} from {self.low:g} to {self.high:.10g}"

    def parse(self, word: str, place: str) -> float:
        """Parse a word, decimal or 0x.

        Args:
            word: The number as text.
            place: FILE:LINE and command, which messages name.

        Raises:
            CaptureError: The word is no number, or not one that is right.
        """
        try:
            value = float(int(word, 16) if word[:2].lower() == "0x" else float(word))
        except (ValueError, OverflowError):
            value = float("nan")
        if not isfinite(value):
            raise CaptureError(
                f"{place} {self.name} = {word[:40]}: should be a number, decimal or 0x"
            )
        is_right = value in self.choices if self.choices else self.low <= value <= self.high
        if not is_right or (self.is_whole and value != int(value)):
            raise CaptureError(f"{place} {self.name} = {word[:40]}: should be {self.right}")
        return value


@dataclass(frozen=True)
class Command:
    """A command, as one family of software has it.

    Attributes:
        name: TI's name.
        effect: What it does here.
        arguments: Its numbers in order, without the number of a subframe; empty where nothing
            is made of them.
        family: Software that has it so.
        subframe: Whether the number of a subframe stands in front.
        reason: What is wrong and what would be right, of a command that is refused.
    """

    name: str
    effect: Effect
    arguments: tuple[Argument, ...] = ()
    family: Family = Family.ANY
    subframe: Subframe = Subframe.NEVER
    reason: str = ""

    @property
    def usage(self) -> str:
        """The command with the names of its arguments, as in a user guide."""
        names = [f"[{a.name}]" if a.is_optional else a.name for a in self.arguments]
        if len(names) > 16:
            names = [*names[:5], "..."]
        return " ".join(filter(None, (self.name, self.subframe.value, *names)))

    @cached_property
    def counts(self) -> range:
        """How many numbers a line may have."""
        required = sum(not argument.is_optional for argument in self.arguments)
        least = required + (self.subframe is Subframe.ALWAYS)
        return range(least, len(self.arguments) + (self.subframe is not Subframe.NEVER) + 1)

    def parse(self, words: Sequence[str], place: str) -> dict[str, float]:
        """Parse the words behind the command.

        Args:
            words: As many as `counts` has.
            place: FILE:LINE and command, which messages name.

        Returns:
            {argument: number} of those that are there, and subFrameIdx, -1 for all subframes.

        Raises:
            CaptureError: A word is not what its argument asks for.
        """
        arguments = self.arguments
        has_subframe = self.subframe is Subframe.ALWAYS or (
            self.subframe is Subframe.OPTIONAL and len(words) > len(arguments)
        )
        if has_subframe:
            arguments = (SUBFRAME, *arguments)
        numbers = {SUBFRAME.name: float(ALL_SUBFRAMES)}
        for argument, word in zip(arguments, words, strict=False):
            numbers[argument.name] = argument.parse(word, place)
        return numbers


@dataclass(frozen=True)
class CfgLine:
    """A line of a .cfg.

    Attributes:
        name: Its command.
        words: The words behind it.
        place: FILE:LINE and command, which messages name.
        family: Software that the file is for.
    """

    name: str
    words: tuple[str, ...]
    place: str
    family: Family = Family.ANY

    @cached_property
    def command(self) -> Command | None:
        """The command as the file's family has it; None for one that is not known.

        Where the family has none of so many numbers, another's that has them; not of L-SDK, whose
        lines are others by the same name.
        """
        commands = self._candidates
        fitting = [command for command in commands if len(self.words) in command.counts]
        of_family = (command for command in fitting if command.family is self.family)
        return next(of_family, (*fitting, *commands, None)[0])

    @property
    def _candidates(self) -> tuple[Command, ...]:
        """Commands of the line's name that the file's family may have."""
        is_measurement = self.name.startswith(POWER_MEASUREMENT.rstrip("*"))
        commands = COMMANDS.get(POWER_MEASUREMENT if is_measurement else self.name, ())
        is_l_sdk = self.family is Family.L_SDK
        of_kind = (one for one in commands if (one.family is Family.L_SDK) is is_l_sdk)
        return tuple(of_kind) or commands

    @cached_property
    def numbers(self) -> Mapping[str, float]:
        """Numbers of the line, {argument: number}.

        Raises:
            CaptureError: There are too few or too many numbers, or one is wrong.
        """
        command = self.command
        assert command is not None
        if len(self.words) not in command.counts:
            families = self._candidates
            usages = " or ".join(
                one.usage + f" ({one.family.value})" * (len(families) > 1) for one in families
            )
            raise CaptureError(
                f"{self.place} has {len(self.words)} numbers: should be {self._right_counts}: "
                f"{usages}"
            )
        return command.parse(self.words, self.place)

    @property
    def _right_counts(self) -> str:
        """How many numbers the line may have, as words."""
        counts = sorted({count for one in self._candidates for count in one.counts})
        if len(counts) > MAX_COUNTS:
            return f"{counts[0]} to {counts[-1]}"
        *fewer, largest = map(str, counts)
        return f"{', '.join(fewer)} or {largest}" if fewer else largest

    def holds_for(self, subframe: int) -> bool:
        """Whether the line is of a subframe, or of all.

        Raises:
            CaptureError: There are too few or too many numbers, or one is wrong.
        """
        return self.numbers[SUBFRAME.name] in (ALL_SUBFRAMES, subframe)

    def refusal(self, argument: str, value: float | str, right: str) -> CaptureError:
        """Error that names the line, an argument, its value and what would be right."""
        value = value if isinstance(value, str) else f"{value:.10g}"
        return CaptureError(f"{self.place} {argument} = {value}: should be {right}")


MAX_COUNTS = 6  # of numbers of a line, that a message lists one by one
POWER_MEASUREMENT = "powerMeas*"  # all commands whose names begin so
COMMENT = re.compile("%|//|#")


def split_lines(text: str, where: str) -> tuple[CfgLine, ...]:
    """Split a .cfg into its lines with a command.

    A byte-order mark, and what follows %, // or #, is left out.

    Args:
        text: Text of the .cfg.
        where: File or key that messages name.
    """
    lines = list[CfgLine]()
    for number, line in enumerate(text.removeprefix("\ufeff").splitlines(), 1):
        name, *words = COMMENT.split(line, maxsplit=1)[0].split() or [""]
        if name:
            lines.append(CfgLine(name, tuple(words), f"{where}:{number}: {name}"))
    family = find_family(lines)
    return tuple(replace(line, family=family) for line in lines)


def lines_of_detection(lines: Iterable[CfgLine], subframe: int) -> Iterator[CfgLine]:
    """Yield the lines that set the detection of points of a subframe.

    Raises:
        CaptureError: A line of the detection cannot be read.
    """
    for line in lines:
        sets_points = line.command is not None and line.command.effect is Effect.POINTS
        if sets_points and line.holds_for(subframe):
            yield line


def describe_missing(name: str, example: str) -> str:
    """Say that a command is missing, and which line would do."""
    return f"{name} is missing; a line that would do: {example}"


def find_family(lines: Sequence[CfgLine]) -> Family:
    """Find the software that lines are for; `ANY` where no command tells."""
    counts = {line.name: len(line.words) for line in lines}
    if "chirpComnCfg" in counts:
        return Family.L_SDK
    if counts.get("frameCfg") == 8 or counts.get("channelCfg") == 5 or "subDataFrameCfg" in counts:
        return Family.MCU_PLUS
    if "dynamicRACfarCfg" in counts and "dynamicRangeAngleCfg" in counts:
        return Family.PEOPLE_3D
    if counts.get("cfarCfg") == 14 or (counts.get("cfarCfg") == 13 and "dbscanCfg" in counts):
        return Family.OBSTACLES
    if "doaCfg" in counts or counts.get("cfarCfg") in (12, 13):
        return Family.PEOPLE
    by_count = {7: Family.SDK_1, 8: Family.SDK_2, 9: Family.SDK_3}
    return by_count.get(counts.get("cfarCfg", 0), Family.ANY)


def _wholes(*names: str, low: float = 0, high: float = COUNT) -> tuple[Argument, ...]:
    return tuple(Argument(name, low, high, is_whole=True) for name in names)


def _flags(*names: str) -> tuple[Argument, ...]:
    return _wholes(*names, high=1)


def _optional(*names: str) -> tuple[Argument, ...]:
    return tuple(Argument(name, is_optional=True) for name in names)


def _positive(name: str, meaning: str) -> Argument:
    return Argument(name, 1e-3, 1e6, meaning=meaning)


def _places(antenna: str, count: int, more: str = "") -> tuple[Argument, ...]:
    """Arguments of the places of so many antennas or fewer, of which two numbers may follow."""
    meaning = f"row and column of each {antenna}{more}"
    first = Argument("number1", 0, LARGEST, meaning=meaning)
    others = range(2, 2 * count + (3 if more else 1))
    return first, *(Argument(f"number{n}", 0, LARGEST, is_optional=True) for n in others)


_MIMO_PATTERNS = (0, 1, 4)
CHIRP_VARIATIONS = "startFreqVar", "freqSlopeVar", "idleTimeVar", "adcStartTimeVar"
PROFILE_ID = _wholes("profileId")[0]
SUBFRAME = Argument("subFrameIdx", -1, 3, True, "-1 for all subframes")
_SIGNAL = (
    Command(
        "dfeDataOutputMode",
        Effect.SIGNAL,
        (
            Argument(
                "modeType",
                meaning="frames of frameCfg, of advFrameCfg; others are not read",
                choices=(1, 3),
            ),
        ),
    ),
    Command(
        "channelCfg",
        Effect.SIGNAL,
        (
            Argument("rxChannelEn", 0, COUNT, True, "a mask of receivers"),
            Argument("txChannelEn", 0, COUNT, True, "a mask of transmitters"),
            Argument("cascading", 0, 0, True, "a single device; cascades are not read"),
            *_optional("ethOscClkEn", "driveStrength"),
        ),
    ),
    Command(
        "adcCfg",
        Effect.SIGNAL,
        (
            Argument("numADCBits", 0, 2, True, "12, 14 and 16 bits"),
            Argument("adcOutputFmt", 0, 2, True, "real, complex 1x and complex 2x"),
        ),
    ),
    Command(
        "profileCfg",
        Effect.SIGNAL,
        (
            PROFILE_ID,
            _positive("startFreq", "GHz"),
            Argument("idleTime", 0, 1e6, meaning="us"),
            Argument("adcStartTime", 0, 1e6, meaning="us"),
            _positive("rampEndTime", "us"),
            Argument("txOutPower", 0, COUNT, True, "dB less, a byte a transmitter"),
            *_wholes("txPhaseShifter"),
            _positive("freqSlopeConst", "MHz/us"),
            Argument("txStartTime", meaning="us"),
            *_wholes("numAdcSamples", low=2, high=2**16),
            _positive("digOutSampleRate", "ksps"),
            *(Argument(name) for name in ("hpfCornerFreq1", "hpfCornerFreq2", "rxGain")),
        ),
    ),
    Command(
        "chirpCfg",
        Effect.SIGNAL,
        (
            *_wholes("startIdx", "endIdx", "profileId"),
            *(Argument(name, meaning="0 of chirps in use") for name in CHIRP_VARIATIONS),
            Argument("txEnable", 0, COUNT, True, "a mask of transmitters, not 0 of chirps in use"),
        ),
    ),
    Command(
        "frameCfg",
        Effect.SIGNAL,
        (
            *_wholes("chirpStartIdx", "chirpEndIdx"),
            *_wholes("numLoops", low=1),
            *_wholes("numFrames"),
            _positive("framePeriodicity", "ms"),
            Argument("triggerSelect"),
            *_optional("frameTriggerDelay"),
        ),
        Family.SDK_1_TO_3,
    ),
    Command(
        "frameCfg",
        Effect.SIGNAL,
        (
            *_wholes("chirpStartIdx", "chirpEndIdx"),
            *_wholes("numLoops", low=1),
            *_wholes("numFrames"),
            *_wholes("numAdcSamples", low=2, high=2**16),
            _positive("framePeriodicity", "ms"),
            Argument("triggerSelect"),
            Argument("frameTriggerDelay"),
        ),
        Family.MCU_PLUS,
    ),
    Command(
        "advFrameCfg",
        Effect.SIGNAL,
        (
            *_wholes("numOfSubFrames", low=1, high=4),
            Argument(
                "forceProfile", 0, 0, meaning="profiles of chirpCfg; forced ones are not read"
            ),
            *_wholes("numFrames"),
            Argument("triggerSelect"),
            Argument("frameTrigDelay"),
        ),
    ),
    Command(
        "subFrameCfg",
        Effect.SIGNAL,
        (
            *_wholes("subFrameNum", high=3),
            *_wholes("forceProfileIdx", "chirpStartIdx"),
            *_wholes("numOfChirps", "numLoops", low=1),
            _positive("burstPeriodicity", "ms"),
            Argument("chirpStartIdxOffset"),
            *(
                Argument(name, 1, 1, meaning="a burst; several are not read")
                for name in ("numOfBurst", "numOfBurstLoops")
            ),
            _positive("subFramePeriodicity", "ms"),
        ),
    ),
    Command(
        "bpmCfg",
        Effect.SIGNAL,
        (*_flags("enabled"), *_wholes("chirp0Idx", "chirp1Idx", high=511)),
        subframe=Subframe.ALWAYS,
    ),
)
_SIGNAL_OF_L_SDK = (
    Command(
        "channelCfg",
        Effect.SIGNAL,
        (
            Argument("rxChCtrlBitMask", 1, 255, True, "a mask of receivers"),
            Argument("txChCtrlBitMask", 1, 255, True, "a mask of transmitters"),
            Argument("miscCtrl"),
        ),
        Family.L_SDK,
    ),
    Command(
        "chirpComnCfg",
        Effect.SIGNAL,
        (
            *_wholes("digOutputSampRate", low=1, high=1000),
            *_wholes("digOutputBitsSel", "dfeFirSel"),
            *_wholes("numOfAdcSamples", low=2, high=2**16),
            Argument(
                "chirpTxMimoPatSel",
                meaning="0, 1: in turns; 4: two together",
                choices=_MIMO_PATTERNS,
            ),
            _positive("chirpRampEndTime", "us"),
            *_wholes("chirpRxHpfSel"),
        ),
        Family.L_SDK,
    ),
    Command(
        "chirpTimingCfg",
        Effect.SIGNAL,
        (
            Argument("chirpIdleTime", 0, 1e6, meaning="us"),
            *_wholes("chirpAdcSkipSamples", high=2**16),
            Argument("chirpTxStartTime", meaning="us"),
            _positive("chirpRfFreqSlope", "MHz/us"),
            _positive("chirpRfFreqStart", "GHz"),
        ),
        Family.L_SDK,
    ),
    Command(
        "frameCfg",
        Effect.SIGNAL,
        (
            *_wholes("numOfChirpsInBurst", low=1, high=2**16),
            *_wholes("numOfChirpsAccum", high=2**10),
            _positive("burstPeriodicity", "us"),
            *_wholes("numOfBurstsInFrame", low=1, high=2**16),
            _positive("framePeriodicity", "ms"),
            *_wholes("numOfFrames"),
        ),
        Family.L_SDK,
    ),
    Command(
        "factoryCalibCfg",
        Effect.SIGNAL,
        (
            *_flags("saveEnable", "restoreEnable"),
            Argument("rxGain"),
            Argument("txBackoff", 0, 255, meaning="dB less of all transmitters"),
            Argument("flashOffset"),
        ),
        Family.L_SDK,
    ),
)
_CFAR = (
    *_flags("procDirection"),
    Argument("averageMode", 0, 2, True, "CA, CAGO and CASO"),
    *_wholes("winLen", low=1, high=1024),
    *_wholes("guardLen", high=1024),
    *_wholes("noiseDiv"),
    *_flags("cyclicMode"),
    Argument("thresholdScale", 0, 1e6),
)
CELLS = 1024  # most cells of a window, a guard, or an end that is left out
_CFAR_OF_PEOPLE = (
    Argument("cfarMethod", 6, 6, meaning="two passes along range and angle"),
    *_wholes("cfarDiscardRangeLeft", "cfarDiscardRangeRight", high=CELLS),
    *_wholes("cfarDiscardAngleLeft", "cfarDiscardAngleRight", high=CELLS),
    *_wholes("refWinSize0", "refWinSize1", low=1, high=CELLS),
    *_wholes("guardWinSize0", "guardWinSize1", high=CELLS),
    Argument("rangeThre", 0, 1e6, meaning="tenths of a power ratio"),
    Argument("azimuthThre", 0, 1e6, meaning="tenths of a power ratio"),
    *_wholes("log2MagFlag"),
    *_optional("inputScaleDown"),
)
_CFAR_OF_TRACKING = (
    *_wholes("leftSkipSize", "rightSkipSize", high=CELLS),
    *_wholes("leftSkipSizeAzimuth", "rightSkipSizeAngle", high=CELLS),
    *_wholes("searchWinSizeRange", "searchWinSizeAngle", low=1, high=CELLS),
    *_wholes("guardSizeRange", "guardSizeAngle", high=CELLS),
    *(
        Argument(name, 0, 1e6, meaning="a power ratio")
        for name in ("threRange", "threAngle", "threSidelob")
    ),
    *_flags("enSecondPass"),
    *_optional("dynamicFlag"),
)
_CFAR_OF_OCCUPANTS = (  # with a window of its own up to rangeRefIndex
    *_CFAR_OF_TRACKING[:6],
    *_wholes("searchWinSizeNear", high=CELLS),
    *_CFAR_OF_TRACKING[6:8],
    *_wholes("guardSizeNear", high=CELLS),
    *_CFAR_OF_TRACKING[8:12],
    *_wholes("rangeRefIndex", high=CELLS),
)
_CFAR_OF_OBSTACLES = (
    Argument("detectMethod", 1, 2, True),
    *_wholes("leftSkipBin", "closeInRangeBin", high=CELLS),
    *_wholes("searchWinSizeRange", "guardSizeRange", high=CELLS),
    *_wholes("searchWinSizeSpreading", "guardSizeSpreading", high=CELLS),
    Argument("rangeThresh", meaning="tenths"),
    Argument("fftSpreadingThresh", meaning="1e-5"),
    *_wholes("noiseCalcType", high=2),
    *_wholes("localPeakEnable", "peakAngleDiffThresh"),
    Argument("maxRangeForDetection", meaning="tenths of a m"),
    *_optional("secondPeakThresh"),
)
_CFAR_OF_L_SDK = tuple(
    Argument(name)
    for name in (
        *("averageMode", "winLen", "guardLen", "noiseDivShift", "cyclicMode", "threshold"),
        *("peakGroupingEn", "sideLobeThreshold", "enableLocalMaxRange", "enableLocalMaxAzimuth"),
        *("enableInterpRangeDom", "enableInterpAzimuthDom"),
    )
)
_CFAR_OF_MCU_PLUS = (
    *_CFAR,
    *_flags("peakGroupingEn"),
    *(Argument(name) for name in ("osKvalue", "osEdgeKscaleEn", "isEnabled")),
    *_optional("variableThresholdMode"),
)
CHANNELS = 16  # most virtual channels of compRangeBiasAndRxChanPhase
_POINTS = (
    Command("cfarCfg", Effect.POINTS, _CFAR, Family.SDK_1),
    Command("cfarCfg", Effect.POINTS, _CFAR, Family.SDK_2, Subframe.ALWAYS),
    Command(
        "cfarCfg", Effect.POINTS, (*_CFAR, *_flags("peakGroupingEn")), Family.SDK_3, Subframe.ALWAYS
    ),
    Command("cfarCfg", Effect.POINTS, _CFAR_OF_PEOPLE, Family.PEOPLE),
    Command("cfarCfg", Effect.WARNING, _CFAR_OF_OBSTACLES, Family.OBSTACLES),
    Command("cfarCfg", Effect.WARNING, _CFAR_OF_L_SDK, Family.L_SDK),
    Command("cfarCfg", Effect.POINTS, _CFAR_OF_MCU_PLUS, Family.MCU_PLUS, Subframe.ALWAYS),
    Command(
        "peakGrouping",
        Effect.POINTS,
        (
            *_wholes("groupingMode"),
            *_flags("rangeDimEn", "dopplerDimEn"),
            *_wholes("startRangeIdx", "endRangeIdx", high=2**16),
        ),
        subframe=Subframe.OPTIONAL,
    ),
    Command(
        "multiObjBeamForming",
        Effect.POINTS,
        (*_flags("enabled"), Argument("threshold", 0, 1)),
        subframe=Subframe.OPTIONAL,
    ),
    Command("clutterRemoval", Effect.POINTS, _flags("enabled"), subframe=Subframe.OPTIONAL),
    Command(
        "compRangeBiasAndRxChanPhase",
        Effect.POINTS,
        (
            Argument("rangeBias", -100, 100, meaning="m"),
            Argument("Re1"),
            Argument("Im1"),
            *_optional(*(f"{part}{n}" for n in range(2, CHANNELS + 1) for part in ("Re", "Im"))),
        ),
    ),
    Command(
        "aoaFovCfg",
        Effect.POINTS,
        tuple(
            Argument(name, -180, 180, meaning="degree")
            for name in ("minAzimuthDeg", "maxAzimuthDeg", "minElevationDeg", "maxElevationDeg")
        ),
        subframe=Subframe.OPTIONAL,
    ),
    Command(
        "cfarFovCfg",
        Effect.POINTS,
        (
            Argument("procDirection", 0, 1, True, "range in m, speed in m/s"),
            Argument("min"),
            Argument("max"),
        ),
        subframe=Subframe.OPTIONAL,
    ),
    Command(
        "rangeSelCfg",
        Effect.POINTS,
        (Argument("min", meaning="m"), Argument("max", meaning="m")),
        Family.L_SDK,
    ),
)
_GAMMA = Argument("mvdr_alpha", 1e-6, 1, meaning="loading over the mean power")
_RATIOS = tuple(
    Argument(name, 0, 1e6, meaning="a power ratio") for name in ("peakExpRelThr", "peakExpSNRThr")
)
_PEOPLE_TRACKING = (
    *(
        Command(name, Effect.POINTS, _CFAR_OF_TRACKING, Family.PEOPLE_3D, Subframe.ALWAYS)
        for name in ("dynamicRACfarCfg", "staticRACfarCfg")
    ),
    Command(
        "dynamicRACfarCfg",
        Effect.WARNING,
        _CFAR_OF_OCCUPANTS,
        Family.PEOPLE_3D,
        Subframe.ALWAYS,
    ),
    Command(
        "dynamicRangeAngleCfg",
        Effect.POINTS,
        (
            Argument("searchStep", 0.05, 45, meaning="degree"),
            _GAMMA,
            Argument("detectionMethod", 1, 2, True, "azimuth then elevation, or both then a zoom"),
            Argument("dopplerEstMethod", 0, 0, meaning="the largest peak"),
        ),
        Family.PEOPLE_3D,
        Subframe.ALWAYS,
    ),
    Command(
        "dynamic2DAngleCfg",
        Effect.POINTS,
        (
            Argument("elevSearchStep", 0.05, 45, meaning="degree"),
            _GAMMA,
            *(
                Argument(name)
                for name in ("maxNpeak2Search", "peakExpSamples", "elevOnly", "sideLobThr")
            ),
            *_RATIOS,
        ),
        Family.PEOPLE_3D,
        Subframe.ALWAYS,
    ),
    Command(
        "dynamic2DAngleCfg",
        Effect.POINTS,
        (
            *_wholes("zoominFactor", low=1, high=32),
            Argument("zoominNn8bors"),
            *_wholes("peakExpSamples", high=32),
            *_RATIOS,
            *_wholes("localMaxCheckFlag", high=2),
        ),
        Family.PEOPLE_3D,
        Subframe.ALWAYS,
    ),
    Command(
        "staticRangeAngleCfg",
        Effect.POINTS,
        (
            *_flags("staticProcEnabled"),
            *_wholes("staticAzimStepDeciFactor", "staticElevStepDeciFactor", low=1, high=CELLS),
        ),
        Family.PEOPLE_3D,
        Subframe.ALWAYS,
    ),
    Command(
        "fineMotionCfg",
        Effect.POINTS,
        (
            *_flags("fineMotionProcEnabled"),
            Argument("fineMotionObservationTime", 1e-3, 1e3, False, "s", True),
            Argument("fineMotionProcCycle", 1, CELLS, True, "frames", True),
            Argument("fineMotionDopplerThrIdx", 0, CELLS, True, "Doppler bins", True),
        ),
        Family.PEOPLE_3D,
        Subframe.ALWAYS,
    ),
    Command(
        "fovCfg",
        Effect.POINTS,
        tuple(Argument(name, 1, 90, meaning="degree, half") for name in ("azimFoV", "elevFoV")),
        Family.PEOPLE_3D,
        Subframe.ALWAYS,
    ),
    *(
        Command(
            name,
            Effect.POINTS,
            tuple(
                Argument(f"antenna{n}", -high, high, meaning=meaning, is_optional=n > 1)
                for n in range(1, CHANNELS + 1)
            ),
            Family.PEOPLE_3D,
        )
        for name, high, meaning in (
            ("antGeometry0", 100, "half wavelengths to the right"),
            ("antGeometry1", 100, "half wavelengths upwards"),
            ("antPhaseRot", 1, "1 or -1"),
        )
    ),
)
_DOA = Command(
    "doaCfg",
    Effect.POINTS,
    (
        Argument("estAngleRange", 10, 900, meaning="tenths of a degree"),
        Argument("estAngleResolution", 50, 45000, meaning="thousandths of a degree"),
        Argument("gamma", 1e-3, 1000, meaning="thousandths"),
        *_flags("clutterRemovalFlag"),
        *_optional(*(f"argument{number}" for number in range(5, 11))),
    ),
    Family.PEOPLE,
)
THIRD_TILT = "thirdTilt"  # of sensorPosition of in-cabin demos
_POSE = (
    Command(
        "sensorPosition",
        Effect.POSE,
        (
            Argument("height", 0, 1000, meaning="m above the floor"),
            Argument("azimuthTilt", -360, 360, meaning="degree to the right"),
            Argument("elevationTilt", -360, 360, meaning="degree down"),
        ),
        Family.PEOPLE_3D,
    ),
    *(
        Command(
            "sensorPosition",
            Effect.POSE,
            (
                *(
                    Argument(name, -1000, 1000, meaning="m")
                    for name in ("xOffset", "yOffset", "zOffset")
                ),
                Argument("azimuthTilt", -360, 360, meaning="degree to the right"),
                Argument("elevationTilt", -360, 360, meaning="degree down"),
                Argument(THIRD_TILT, -360, 360, meaning="degree", is_optional=True),
            ),
            family,
        )
        for family in (Family.PEOPLE_3D, Family.L_SDK)
    ),
)
_BOX = (
    Command(
        "boundaryBox",
        Effect.BOX,
        tuple(
            Argument(name, -1000, 1000, meaning="m")
            for name in ("Xmin", "Xmax", "Ymin", "Ymax", "Zmin", "Zmax")
        ),
    ),
    Command(
        "SceneryParam",
        Effect.BOX,
        tuple(
            Argument(name, -1000, 1000, meaning="m") for name in ("left", "right", "near", "far")
        ),
        Family.PEOPLE,
    ),
)
_ELEMENTS = (
    *(
        Command(
            "antGeometryCfg",
            Effect.ELEMENTS,
            _places("virtual element", CHANNELS, f", then their spacings, {unit}"),
            family,
        )
        for family, unit in ((Family.L_SDK, "mm"), (Family.MCU_PLUS, "wavelengths"))
    ),
    *(
        Command(name, Effect.ELEMENTS, _places(antenna, 4), Family.L_SDK)
        for name, antenna in (("antGeometryTX", "transmitter"), ("antGeometryRx", "receiver"))
    ),
    Command(
        "antGeometryDist",
        Effect.ELEMENTS,
        tuple(Argument(name, 1e-3, 1000, meaning="mm") for name in ("dX", "dZ")),
        Family.L_SDK,
    ),
)
_WITH_WARNING = (
    Command("extendedMaxVelocity", Effect.WARNING, _wholes("enabled"), subframe=Subframe.OPTIONAL),
    Command(
        "nearFieldCfg",
        Effect.WARNING,
        _wholes("enabled", "startRangeIdx", "endRangeIdx"),
        subframe=Subframe.OPTIONAL,
    ),
    Command(
        "calibDcRangeSig",
        Effect.WARNING,
        (
            *_wholes("enabled"),
            Argument("negativeBinIdx"),
            *_wholes("positiveBinIdx", "numAvgFrames"),
        ),
        subframe=Subframe.OPTIONAL,
    ),
    *(
        Command(name, Effect.WARNING, family=Family.L_SDK)
        for name in ("sigProcChainCfg", "cfarProcCfg", "aoaProcCfg")
    ),
    Command(
        "measureRangeBiasAndRxChanPhase",
        Effect.WARNING,
        (*_wholes("enabled"), Argument("targetDistance"), Argument("searchWin")),
    ),
)
# Control of the demo, tracker, presence, vital signs: nothing of them is in a cube or its points.
_SILENT = {
    Family.ANY: (
        *("sensorStart", "sensorStop", "flushCfg", "lowPower", "guiMonitor", "dataLogger"),
        *("analogMonitor", "CQRxSatMonitor", "CQSigImgMonitor", "calibData", "configDataPort"),
        *("baudRate", "queryDemoStatus", "pmicCfg", "idlePowerCycle", "adcDataDitherCfg"),
        *("gpAdcMeasConfig", "apllFreqShiftEn", "runtimeCalibCfg", "adcDataSource", "adcLogging"),
        *("lowPowerCfg", "compressionCfg", "intfMitigCfg", "localMaxCfg", "rangeProcCfg"),
        *("antennaCalibParams", "enetStreamCfg", "spreadSpectrumConfig", "subDataFrameCfg"),
        POWER_MEASUREMENT,
    ),
    Family.L_SDK: ("antGeometryBoard",),
    Family.OBSTACLES: ("dbscanCfg",),
    Family.PEOPLE: (
        *("GatingParam", "StateParam", "AllocationParam", "VariationParam"),
        *("AccelerationParam", "PointCloudEn"),
    ),
    Family.PEOPLE_3D: (
        *("staticBoundaryBox", "presenceBoundaryBox", "gatingParam", "stateParam"),
        *("allocationParam", "maxAcceleration", "trackingCfg", "classifierCfg", "vitalsign"),
        *("VSRangeIdxCfg", "VSTargetId", "mpdBoundaryBox", "clusterCfg", "majorStateCfg"),
        *("minorStateCfg", "microDopplerCfg", "profileSwitchCfg"),
        "dopplerCfarCfg",  # of a search for Doppler that is not the largest peak's
    ),
}
_DDMA = "DDMA is not simulated; should be one transmitter a chirp (the TDM demo's profile)"
_REFUSED = (
    *(
        Command(
            name, Effect.NOT_READ, reason="is not read; should be profileCfg, chirpCfg, frameCfg"
        )
        for name in ("contModeCfg", "advChirpCfg", "LUTDataCfg")
    ),
    Command("ddmPhaseShiftAntOrder", Effect.NOT_SIMULATED, family=Family.MCU_PLUS, reason=_DDMA),
    Command(
        "bpmCfgAdvanced",
        Effect.NOT_SIMULATED,
        reason="is not simulated; should be one transmitter a chirp",
    ),
)
_PROCESSING = tuple(
    Command(
        name,
        Effect.NOT_SIMULATED,
        (
            Argument("procChain", 0, 0, meaning="TDM; DDMA is not simulated"),
            *_optional(*(f"argument{number}" for number in range(2, 9))),
        ),
        Family.MCU_PLUS,
    )
    for name in ("procChain", "procChainCfg")
)
_CAPTURES = (  # of the words of a raw capture
    Command(
        "adcbufCfg",
        Effect.SILENT,
        _wholes("adcOutputFmt", "SampleSwap", "ChanInterleave", "ChirpThreshold"),
        subframe=Subframe.OPTIONAL,
    ),
    Command(
        "lvdsStreamCfg",
        Effect.SILENT,
        _wholes("enableHeader", "dataFmt", "enableSW"),
        subframe=Subframe.ALWAYS,
    ),
)


def _by_name() -> Mapping[str, tuple[Command, ...]]:
    """The table: {name: the command as each family has it}."""
    silent = (
        Command(name, Effect.SILENT, family=family)
        for family, names in _SILENT.items()
        for name in names
    )
    commands = dict[str, tuple[Command, ...]]()
    points = *_POINTS, *_PEOPLE_TRACKING, _DOA
    signal = *_SIGNAL, *_SIGNAL_OF_L_SDK
    for command in (
        *signal,
        *points,
        *_POSE,
        *_BOX,
        *_ELEMENTS,
        *_WITH_WARNING,
        *_CAPTURES,
        *silent,
        *_REFUSED,
        *_PROCESSING,
    ):
        commands[command.name] = (*commands.get(command.name, ()), command)
    return MappingProxyType(commands)


COMMANDS = _by_name()
