"""Commands of the .cfg of a TI board: their arguments, and what radhar makes of each.

The table of them is ti_commands.txt, of which docs/reference/ti_commands.md is made, too.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property
from math import isfinite
from pathlib import Path
from types import MappingProxyType

from radhar_cli.errors import CaptureError
from radhar_cli.files.numbered_words import expand_words
from radhar_cli.radar.ti_family import Family

ALL_SUBFRAMES = -1
COUNT = 2**32 - 1  # largest whole number
LARGEST = 1e9  # of every other number


class Effect(Enum):
    """Effect of a command on a simulated board."""

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
        """Values that are right, as in "should be ..."."""
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
        """Numbers that a line may have, from and to."""
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
        """Numbers that the line may have, as words."""
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
    """Describe a missing command, with a line that would do."""
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


CHIRP_VARIATIONS = "startFreqVar", "freqSlopeVar", "idleTimeVar", "adcStartTimeVar"
PROFILE_ID = Argument("profileId", 0, COUNT, is_whole=True)
SUBFRAME = Argument("subFrameIdx", -1, 3, True, "-1 for all subframes")
THIRD_TILT = "thirdTilt"  # of sensorPosition of in-cabin demos
TABLE = Path(__file__).with_name("ti_commands.txt")
_HEADER = re.compile(
    r"(?P<names>[^\[(:]*?)(?P<subframe>\[subFrameIdx\]|subFrameIdx)?\s*"
    r"(?:\((?P<families>[^)]*)\))?(?:: (?P<reason>.*))?"
)


def _read_table(text: str) -> Mapping[str, tuple[Command, ...]]:
    """Read the table of commands, whose form its first lines describe.

    Returns:
        {name: the command as each family has it}.
    """
    effect, blocks = Effect.SILENT, list[tuple[list[Command], list[Argument]]]()
    for line in text.splitlines():
        if line.startswith("["):
            effect = Effect[line.strip("[]")]
        elif line.startswith("  "):
            blocks[-1][1].extend(_read_arguments(line))
        elif line and not line.startswith("#"):
            blocks.append(([*_read_header(line, effect)], []))
    commands = dict[str, tuple[Command, ...]]()
    for of_block, arguments in blocks:
        for command in of_block:
            new = replace(command, arguments=tuple(arguments))
            commands[command.name] = (*commands.get(command.name, ()), new)
    return MappingProxyType(commands)


def _read_header(line: str, effect: Effect) -> Iterator[Command]:
    """Yield the commands of a line of their names, without arguments."""
    header = _HEADER.fullmatch(line)
    assert header is not None, line
    families = [Family[name] for name in (header["families"] or "ANY").split(", ")]
    subframe = Subframe(header["subframe"] or "")
    for name in header["names"].split():
        for family in families:
            yield Command(name, effect, (), family, subframe, header["reason"] or "")


def _read_arguments(line: str) -> Iterator[Argument]:
    """Yield the arguments of a line, all of which have the same limits."""
    words, _, meaning = line.partition("  # ")
    names, _, limits = words.partition(": ")
    is_whole = limits.startswith("whole")
    low, high = (0.0, float(COUNT)) if is_whole else (-LARGEST, LARGEST)
    choices: tuple[int, ...] = ()
    if ".." in limits:
        first, last = limits.removeprefix("whole ").split("..")
        low, high = float(first or low), float(last or high)
    elif limits and not is_whole:
        choices = tuple(map(int, limits.split(", ")))
    for name in expand_words(names):
        is_optional = name.endswith("?")
        yield Argument(name.rstrip("?"), low, high, is_whole, meaning, is_optional, choices)


COMMANDS = _read_table(TABLE.read_text(encoding="utf-8"))
