"""The .cfg of a TI radar: its chirps and frames, how points are found, where the board stands."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import accumulate
from math import inf

from radhar_cli.errors import CaptureError
from radhar_cli.radar.board import DEVICES
from radhar_cli.radar.detection import Detection, Firmware
from radhar_cli.radar.frame_timing import FrameTiming, Sampling
from radhar_cli.radar.people_tracking import PeopleCounting, PeopleTracking
from radhar_cli.radar.room import RoomBox
from radhar_cli.radar.ti_family import Family
from radhar_cli.readers.ti.ti_chirps import (
    MAX_CHIRPS,
    MOST_ANTENNAS,
    ChirpPair,
    ChirpProfile,
    ChirpRange,
    StatedFrame,
    make_timing,
)
from radhar_cli.readers.ti.ti_commands import (
    CHIRP_VARIATIONS,
    COUNT,
    PROFILE_ID,
    THIRD_TILT,
    CfgLine,
    Effect,
    describe_missing,
    find_family,
    split_lines,
)
from radhar_cli.readers.ti.ti_detection import read_detection
from radhar_cli.readers.ti.ti_elements import (
    CORRECTIONS,
    FileElements,
    correct_feeds,
    read_geometry,
    read_rows_and_columns,
)
from radhar_cli.readers.ti.ti_l_sdk import read_l_sdk
from radhar_cli.readers.ti.ti_people import (
    is_short_fine_motion,
    last_lines,
    read_people,
    reasons_against,
)

MAX_CFG = 2**16  # characters


@dataclass(frozen=True)
class BoardPose:
    """Place and direction of a board, in the coordinates of scenes.

    Attributes:
        position_m: Position, m.
        yaw_deg: Angle of boresight from the x axis to the left, degree.
        tilt_deg: Angle of boresight below the horizontal, degree.
    """

    position_m: tuple[float, float, float]
    yaw_deg: float
    tilt_deg: float


@dataclass(frozen=True, kw_only=True)
class BoardHeader:
    """Board of a .cfg that is simulated, whichever device it runs on.

    That is more than its frames: how its firmware finds points, and where the board stands.

    Attributes:
        timing: Chirps and frames.
        family: Software that the file is for.
        detection: Detection of its points.
        has_cfar: Whether a line sets the CFAR of an out-of-box demo.
        people: Detection of people tracking or counting; None for neither.
        why_no_chain: Reasons why the chain of the family does not run, such as commands that the
            file lacks, with lines that would do.
        pose: Place and direction by sensorPosition; None without that line.
        box: Box of the room by boundaryBox, or by SceneryParam; None without either.
        grid: Elements as people tracking has them (antGeometry0, antGeometry1, antPhaseRot), or by
            rows and columns (antGeometryCfg, antGeometryTX and antGeometryRx).
        unknown: Commands that radhar does not know.
        not_simulated: Commands that switch on what is not simulated.
    """

    timing: FrameTiming
    family: Family
    detection: Detection
    has_cfar: bool
    people: PeopleTracking | PeopleCounting | None
    why_no_chain: tuple[str, ...]
    pose: BoardPose | None
    box: RoomBox | None
    grid: FileElements
    unknown: tuple[str, ...]
    not_simulated: tuple[str, ...]

    @property
    def firmware(self) -> Firmware | None:
        """Chain of TI's firmware whose commands the file has; None without any."""
        if isinstance(self.people, PeopleTracking):
            return "people_tracking"
        if isinstance(self.people, PeopleCounting):
            return "people_counting"
        if not self.has_cfar or self.family is Family.L_SDK:
            return None
        return "sdk3" if self.family in (Family.SDK_3, Family.MCU_PLUS) else "sdk1"

    @property
    def elements(self) -> FileElements:
        """Elements that the detection of the file takes the board for, and factors of its feeds.

        A chain of the firmware takes all feeds for equal where the file has no factors.
        """
        corrections = self.detection.coefficients
        if self.grid.phases:
            return correct_feeds(self.grid, corrections)
        if not corrections and self.firmware is not None:
            corrections = (1,) * self.timing.channels
        return replace(self.grid, phases=corrections, of_phases=(CORRECTIONS,))


@lru_cache(maxsize=16)
def parse_ti_cfg(
    text: str, where: str = "radar.cfg", device: str | None = None, subframe: int = 0
) -> BoardHeader:
    """Parse the .cfg of a board that is to be simulated.

    Args:
        text: Lines of the .cfg.
        where: File or key that messages name.
        device: Board that the file runs on, which says how fast xWRL boards sample; None for the
            likely one.
        subframe: Number of the subframe that counts, or the last if there are fewer.

    Raises:
        CaptureError: A line cannot be read, or asks for what boards of radhar cannot do.
    """
    lines = _Lines(text, where)
    lines.require_none(Effect.NOT_SIMULATED)
    timings = _read_subframes(lines, device)
    if lines.family is not Family.L_SDK:
        _require_antennas(lines.of_name("channelCfg")[-1], device)
        for timing in timings:
            _require_simulated(timing, lines)
    timing = timings[min(subframe, len(timings) - 1)]
    channels, bins = timing.channels, timing.n_bins
    family = lines.family
    detection = read_detection(lines.lines, channels, bins, timing.subframe)
    line_of = last_lines(lines.lines, timing.subframe)
    others = {line.name: line for line in lines.with_effect(Effect.WARNING)}
    why_no_chain = reasons_against(line_of, family, others, bins)
    return BoardHeader(
        timing=timing,
        family=family,
        detection=detection,
        has_cfar=any(
            line.name == "cfarCfg" and "thresholdScale" in line.numbers
            for line in lines.with_effect(Effect.POINTS)
        ),
        people=None if why_no_chain else read_people(line_of, family, channels, bins),
        why_no_chain=why_no_chain,
        pose=_read_pose(lines.with_effect(Effect.POSE)),
        box=_read_box(lines.with_effect(Effect.BOX)),
        grid=read_geometry(line_of, channels)
        or read_rows_and_columns(
            {line.name: line for line in lines.with_effect(Effect.ELEMENTS)},
            timing.antennas_of_channels,
            family,
        ),
        unknown=tuple(dict.fromkeys(line.name[:40] for line in lines.lines if not line.command)),
        not_simulated=tuple(dict.fromkeys(filter(None, map(_name_if_not_simulated, lines.lines)))),
    )


def parse_frames(text: str, where: str) -> tuple[list[FrameTiming], Sequence[CfgLine]]:
    """Parse chirps, frames and samples of a .cfg, as a raw capture needs them.

    Args:
        text: Lines of the .cfg.
        where: File that messages name.

    Returns:
        The timing of each subframe of a frame, in order, or of the frame; and all lines, in which
        other readers find their own.

    Raises:
        CaptureError: A line on chirps, frames or samples cannot be read.
    """
    lines = _Lines(text, where)
    return _read_subframes(lines, None), lines.lines


class _Lines:
    """The lines of a .cfg with a command."""

    def __init__(self, text: str, where: str) -> None:
        self.where = where
        self.lines = split_lines(text, where)
        self.family = find_family(self.lines)

    def with_effect(self, effect: Effect) -> list[CfgLine]:
        """Return the lines of commands with an effect."""
        return [line for line in self.lines if line.command and line.command.effect is effect]

    def of_name(self, name: str) -> list[CfgLine]:
        """Return the lines of a command."""
        return [line for line in self.lines if line.name == name]

    def require(self, name: str, example: str) -> list[CfgLine]:
        """Return the lines of a command; raise CaptureError without any, with one that would do."""
        lines = self.of_name(name)
        if not lines:
            raise CaptureError(f"{self.where}: {describe_missing(name, example)}")
        return lines

    def drop(self, lines: Collection[CfgLine]) -> None:
        """Leave out lines that do not matter."""
        self.lines = tuple(line for line in self.lines if line not in lines)

    def require_none(self, effect: Effect) -> None:
        """Raise CaptureError for the first line that is refused by its command or its numbers."""
        for line in self.with_effect(effect):
            assert line.command is not None
            if line.command.reason:
                raise CaptureError(f"{line.place}: {line.command.reason}")
            _ = line.numbers


def _read_subframes(lines: _Lines, device: str | None) -> list[FrameTiming]:
    """Read all that the lines say of chirps, frames and samples, of each subframe."""
    lines.require_none(Effect.NOT_READ)
    if lines.family is Family.L_SDK:
        return [read_l_sdk(lines.lines, lines.where, device)]
    receivers = lines.require("channelCfg", "channelCfg 15 7 0")[-1]
    adc = lines.require("adcCfg", "adcCfg 2 1")[-1]
    profiles = lines.require("profileCfg", "profileCfg 0 77 10 6 48 0 0 70 1 128 3200 0 0 30")
    chirps = lines.require("chirpCfg", "chirpCfg 0 0 0 0 0 0 0 1")
    frames = _read_frames(lines)
    used = _chirps_in_use(chirps, frames)
    for line in used:
        _require_plain(line)
    lines.drop(_unused_profiles(profiles, used))
    for line in lines.with_effect(Effect.SIGNAL):
        _ = line.numbers  # lines that do not hold must be right, too
    adc_numbers = adc.numbers
    bits = 12 + 2 * int(adc_numbers["numADCBits"])
    subframes = [
        make_timing(
            dict(map(_read_profile, lines.of_name("profileCfg"))),
            [_read_chirp(line) for line in chirps],
            frame,
            int(receivers.numbers["rxChannelEn"]),
            Sampling(int(adc_numbers["adcOutputFmt"])),
            bits,
            _read_pair(lines, subframe),
        )
        for subframe, frame in enumerate(frames)
    ]
    _require_stated_samples(subframes[0], lines)
    return _place_subframes(subframes)


def _chirps_in_use(chirps: Sequence[CfgLine], frames: Sequence[StatedFrame]) -> list[CfgLine]:
    """Return the lines chirpCfg of the chirps that frames send, of which the last counts."""
    line_of = {
        index: line
        for line in chirps
        for index in range(
            int(line.numbers["startIdx"]), min(int(line.numbers["endIdx"]), MAX_CHIRPS - 1) + 1
        )
    }
    sent = {
        index for frame in frames for index in range(frame.first, min(frame.last, MAX_CHIRPS) + 1)
    }
    return list(dict.fromkeys(line for index, line in line_of.items() if index in sent))


def _require_plain(line: CfgLine) -> None:
    """Raise CaptureError for a chirp that is sent, and differs from its profile or is silent."""
    numbers = line.numbers
    for name in CHIRP_VARIATIONS:
        if numbers[name]:
            right = "0 (chirps that differ from their profile are not read)"
            raise line.refusal(name, numbers[name], right)
    if not numbers["txEnable"]:
        raise line.refusal("txEnable", 0, "a mask of transmitters: the frame sends this chirp")


def _unused_profiles(profiles: Sequence[CfgLine], chirps: Sequence[CfgLine]) -> list[CfgLine]:
    """Return the lines profileCfg that chirps do not name; none where they name a missing one."""
    number_of = {line: PROFILE_ID.parse((*line.words, "")[0], line.place) for line in profiles}
    named = {line.numbers["profileId"] for line in chirps}
    if not named <= set(number_of.values()):
        return []
    return [line for line, number in number_of.items() if number not in named]


def _require_stated_samples(timing: FrameTiming, lines: _Lines) -> None:
    """Raise CaptureError where frameCfg has another number of samples than the profile."""
    for frame in lines.of_name("frameCfg"):
        samples = frame.numbers.get("numAdcSamples")
        if samples not in (None, timing.samples):
            right = f"{timing.samples}, as profileCfg has it"
            raise frame.refusal("numAdcSamples", samples or 0, right)


def _place_subframes(timings: Sequence[FrameTiming]) -> list[FrameTiming]:
    """Set the times of subframes, which follow each other; a frame lasts as long as all."""
    if len(timings) == 1:
        return [*timings]
    begins = [0.0, *accumulate(timing.period_s for timing in timings)]
    return [
        replace(
            timing,
            subframe=subframe,
            subframes=len(timings),
            delay_s=begins[subframe],
            period_s=begins[-1],
        )
        for subframe, timing in enumerate(timings)
    ]


def _read_frames(lines: _Lines) -> list[StatedFrame]:
    """Read the chirps of a frame, or of each of its subframes."""
    modes = [line.numbers["modeType"] for line in lines.of_name("dfeDataOutputMode")]
    names = {line.name for line in lines.lines}
    if modes[-1:] != [3] and (modes or "frameCfg" in names or "advFrameCfg" not in names):
        return [_read_frame(lines.require("frameCfg", "frameCfg 0 0 64 0 50 1 0")[-1])]
    advanced = lines.require("advFrameCfg", "advFrameCfg 2 0 0 1 0")[-1]
    count, frames = (int(advanced.numbers[name]) for name in ("numOfSubFrames", "numFrames"))
    example = "subFrameCfg {} 0 0 1 64 50 0 1 1 50"
    by_number = {
        int(line.numbers["subFrameNum"]): line
        for line in lines.require("subFrameCfg", example.format(0))
    }
    for number in range(count):
        if number not in by_number:
            name = f"subFrameCfg subFrameNum = {number}"
            raise CaptureError(f"{lines.where}: {describe_missing(name, example.format(number))}")
    return [_read_subframe(by_number[number], frames) for number in range(count)]


def _read_subframe(line: CfgLine, frames: int) -> StatedFrame:
    """Read a line subFrameCfg of so many frames."""
    numbers = line.numbers
    first = int(numbers["chirpStartIdx"])
    return StatedFrame(
        first=first,
        last=first + int(numbers["numOfChirps"]) - 1,
        loops=int(numbers["numLoops"]),
        frames=frames,
        period_ms=numbers["subFramePeriodicity"],
        place=line.place,
        chirps_name="first and last chirp",
        period_name="subFramePeriodicity",
    )


def _read_profile(line: CfgLine) -> tuple[int, ChirpProfile]:
    """Read a line profileCfg as a number and its profile."""
    numbers = line.numbers
    codes = int(numbers["txOutPower"])  # a byte each, that of the first transmitter lowest
    return int(numbers["profileId"]), ChirpProfile(
        start_ghz=numbers["startFreq"],
        idle_us=numbers["idleTime"],
        adc_start_us=numbers["adcStartTime"],
        ramp_end_us=numbers["rampEndTime"],
        slope_mhz_per_us=numbers["freqSlopeConst"],
        samples=int(numbers["numAdcSamples"]),
        rate_ksps=numbers["digOutSampleRate"],
        backoff_db=tuple(float(code) for code in codes.to_bytes(4, "little")) if codes else (),
        place=f"{line.place} numAdcSamples",
    )


def _read_chirp(line: CfgLine) -> ChirpRange:
    """Read a line chirpCfg."""
    numbers = line.numbers
    return ChirpRange(
        first=int(numbers["startIdx"]),
        last=int(numbers["endIdx"]),
        profile=int(numbers["profileId"]),
        mask=int(numbers["txEnable"]),
        place=line.place,
    )


def _read_frame(line: CfgLine) -> StatedFrame:
    """Read a line frameCfg."""
    numbers = line.numbers
    return StatedFrame(
        first=int(numbers["chirpStartIdx"]),
        last=int(numbers["chirpEndIdx"]),
        loops=int(numbers["numLoops"]),
        frames=int(numbers["numFrames"]),
        period_ms=numbers["framePeriodicity"],
        place=line.place,
    )


def _lines_of_pair(lines: _Lines, subframe: int) -> list[CfgLine]:
    """Lines bpmCfg of a subframe, of which the last holds."""
    return [line for line in lines.of_name("bpmCfg") if line.holds_for(subframe)]


def _read_pair(lines: _Lines, subframe: int) -> ChirpPair | None:
    """Read the chirps in which two transmitters of a subframe send together; None for none."""
    pair_lines = _lines_of_pair(lines, subframe)
    if not pair_lines or not pair_lines[-1].numbers["enabled"]:
        return None
    numbers = pair_lines[-1].numbers
    return ChirpPair(int(numbers["chirp0Idx"]), int(numbers["chirp1Idx"]), pair_lines[-1].place)


def _read_box(lines: Sequence[CfgLine]) -> RoomBox | None:
    """Read the last of lines of a box, whose x is to the right."""
    if not lines:
        return None
    numbers = [line.numbers for line in lines][-1]
    if "near" in numbers:
        right, ahead = (numbers["left"], numbers["right"]), (numbers["near"], numbers["far"])
        return RoomBox(ahead, (0.0 - right[1], 0.0 - right[0]), (-inf, inf))
    return RoomBox(
        (numbers["Ymin"], numbers["Ymax"]),
        (0.0 - numbers["Xmax"], 0.0 - numbers["Xmin"]),
        (numbers["Zmin"], numbers["Zmax"]),
    )


def _read_pose(lines: Sequence[CfgLine]) -> BoardPose | None:
    """Read the last of lines sensorPosition, whose angles are to the right and down."""
    if not lines:
        return None
    numbers = [line.numbers for line in lines][-1]
    right, ahead = numbers.get("xOffset", 0.0), numbers.get("yOffset", 0.0)
    height = numbers.get("zOffset", numbers.get("height", 0.0))
    return BoardPose(
        position_m=(ahead, 0.0 - right, height),
        yaw_deg=0.0 - numbers["azimuthTilt"],
        tilt_deg=numbers["elevationTilt"],
    )


def _require_antennas(line: CfgLine, device: str | None) -> None:
    """Raise CaptureError for receivers or transmitters that are on and that the board lacks.

    Args:
        line: Line channelCfg.
        device: Board that the file runs on; None for one of MOST_ANTENNAS of either.
    """
    array = DEVICES[device].array if device is not None and device in DEVICES else None
    counts = {
        "rxChannelEn": ("receivers", len(array.rx) if array else MOST_ANTENNAS),
        "txChannelEn": ("transmitters", len(array.tx) if array else MOST_ANTENNAS),
    }
    for argument, (noun, count) in counts.items():
        mask = int(line.numbers[argument])
        largest = 2**count - 1
        if mask > largest:
            owner = f"the {device} has" if array else "boards have"
            raise line.refusal(argument, mask, f"at most {largest}: {owner} {count} {noun}")


def _require_simulated(timing: FrameTiming, lines: _Lines) -> None:
    """Raise CaptureError for chirps and samples that boards of radhar do not have."""
    channels = lines.of_name("channelCfg")[-1]
    if not timing.receivers:
        raise channels.refusal("rxChannelEn", channels.words[0], "1 to 15: a receiver that is on")
    transmitters = int(channels.numbers.get("txChannelEn", COUNT))
    shared = None if timing.bpm is None else timing.masks[timing.bpm[0]]
    for line in lines.of_name("chirpCfg"):
        mask = _read_chirp(line).mask
        if mask in timing.masks and mask.bit_count() != 1 and mask != shared:
            right = (
                "one transmitter a chirp (the TDM demo's profile), or two in two chirps with "
                "bpmCfg enabled: DDMA is not simulated"
            )
            raise line.refusal("txEnable", mask, right)
        if mask in timing.masks and mask & ~transmitters:
            right = f"of transmitters that are on (channelCfg txChannelEn = {transmitters})"
            raise line.refusal("txEnable", mask, right)
    if timing.bpm is not None:
        _require_known_pair(timing, _lines_of_pair(lines, timing.subframe)[-1])
    elif len(set(timing.masks)) < len(timing.masks):
        raise lines.of_name("chirpCfg")[-1].refusal(
            "txEnable",
            " ".join(map(str, timing.masks[:8])) + " ..." * (len(timing.masks) > 8),
            "each transmitter once, and again in the same order",
        )


def _require_known_pair(timing: FrameTiming, line: CfgLine) -> None:
    """Raise CaptureError for a loop that no firmware decodes."""
    masks, bpm = timing.masks, timing.bpm
    assert bpm is not None
    alone = [mask for place, mask in enumerate(masks) if place not in bpm]
    if len(alone) > 1 or any(mask & masks[bpm[0]] for mask in alone):
        raise line.refusal(
            "chirp0Idx chirp1Idx",
            f"{line.numbers['chirp0Idx']:g} {line.numbers['chirp1Idx']:g}",
            "the two chirps of a loop, or two of three, the other of which has another "
            f"transmitter: chirpCfg txEnable = {' '.join(map(str, masks))}",
        )


def _name_if_not_simulated(line: CfgLine) -> str | None:
    """Name of a line's command if it switches on what neither a cube nor its points have."""
    command = line.command
    if command is None:
        return None
    if command.name == "profileCfg":
        return command.name if line.numbers["txPhaseShifter"] else None
    if command.name == "adcCfg":  # samples are not rounded
        return command.name if line.numbers["numADCBits"] != 2 else None
    if command.name == "sensorPosition":
        return f"sensorPosition {THIRD_TILT}" if line.numbers.get(THIRD_TILT) else None
    if command.name == "fineMotionCfg":
        return command.name if is_short_fine_motion(line) else None
    if command.name == "cfarCfg" and command.family is Family.MCU_PLUS:
        return command.name  # for what stands behind the numbers of SDK 3
    if command.effect is not Effect.WARNING:
        return None
    is_on = line.numbers.get("enabled", 1) if command.arguments else 1
    return command.name if is_on else None
