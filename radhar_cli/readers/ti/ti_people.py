"""Detection of people as the lines of a TI .cfg set it: 3D people tracking, and people counting."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TypeAlias

from radhar_cli.radar.people_tracking import (
    ElevationSearch,
    FineMotion,
    PeopleCounting,
    PeopleTracking,
    StaticSearch,
    TwoPassCfar,
    Zoom,
)
from radhar_cli.radar.ti_family import Family
from radhar_cli.readers.ti.ti_commands import (
    SUBFRAME,
    CfgLine,
    describe_missing,
    lines_of_detection,
)
from radhar_cli.readers.ti.ti_detection import read_coefficients

Lines: TypeAlias = Mapping[str, CfgLine]  # {command: its last line}
MAX_ANGLES = 20_000  # directions of a map
WALL = 1  # detectionMethod of an azimuth map and a search over elevation
# {family: {command that its chain needs: a line that would do}}
NEEDED: Mapping[Family, Mapping[str, str]] = {
    Family.PEOPLE_3D: {
        "dynamicRACfarCfg": "dynamicRACfarCfg -1 4 4 2 2 8 12 4 8 4.00 8.00 0.40 1 1",
        "dynamicRangeAngleCfg": "dynamicRangeAngleCfg -1 0.75 0.0010 1 0",
        "dynamic2DAngleCfg": "dynamic2DAngleCfg -1 1.5 0.0300 1 0 1 0.30 0.85 8.00",
        "fovCfg": "fovCfg -1 70.0 20.0",
        "antGeometry0": "antGeometry0 0 -1 -2 -3 -2 -3 -4 -5 -4 -5 -6 -7",
        "antGeometry1": "antGeometry1 -1 -1 -1 -1 0 0 0 0 -1 -1 -1 -1",
        "antPhaseRot": "antPhaseRot 1 1 1 1 1 1 1 1 1 1 1 1",
    },
    Family.PEOPLE: {
        "cfarCfg": "cfarCfg 6 4 4 0 0 16 16 4 4 50 62 0",
        "doaCfg": "doaCfg 600 1875 30 1",
    },
    Family.OBSTACLES: {"cfarCfg": "cfarCfg 1 4 12 4 2 8 2 350 30 2 0 5 50 0.5"},
}


def last_lines(lines: Iterable[CfgLine], subframe: int = 0) -> Lines:
    """Find the last line of each command that sets the detection of a subframe."""
    return {line.name: line for line in lines_of_detection(lines, subframe)}


def reasons_against(line_of: Lines, family: Family, others: Lines, bins: int) -> tuple[str, ...]:
    """List reasons why the chain of a family does not run: commands missing, or otherwise.

    Args:
        line_of: Line of each command that sets the detection; other families' do not count.
        family: Software that the file is for.
        others: Line of each command that has an effect which is not simulated.
        bins: Number of range bins.

    Returns:
        A line for each reason, a missing command with a line that would do; () if it runs.

    Raises:
        CaptureError: A line of the detection cannot be read.
    """
    names = {
        name for name, line in line_of.items() if line.command and line.command.family is family
    }
    reasons = tuple(
        f"{name} of {len(others[name].words)} numbers is not simulated"
        if name in others
        else describe_missing(name, example)
        for name, example in NEEDED.get(family, {}).items()
        if name not in names
    )
    if reasons or family not in NEEDED:
        return reasons
    return tuple(
        _describe_mirror(line, cfar, bins)
        for line, cfar in _range_cfars(line_of, family)
        if not cfar.mirrors_within(bins)
    )


def _range_cfars(line_of: Lines, family: Family) -> list[tuple[CfgLine, TwoPassCfar]]:
    """Lines of the CFARs of a chain, and these."""
    if family is Family.PEOPLE:
        return [(line_of["cfarCfg"], _read_counting_cfar(line_of["cfarCfg"]))]
    static = _read_static(line_of)
    moving = [(line_of["dynamicRACfarCfg"], _read_cfar(line_of["dynamicRACfarCfg"]))]
    return moving + ([] if static is None else [(line_of["staticRACfarCfg"], static.cfar)])


def _describe_mirror(line: CfgLine, cfar: TwoPassCfar, bins: int) -> str:
    """Describe the range bins left out by a CFAR that reads beyond its map."""
    window, guard, end = cfar.window[0], cfar.guard[0], cfar.skip_range[1]
    return (
        f"{line.name} leaves out so many of {bins} range bins that the firmware reads beside its "
        f"map: {bins} - {end} - {window} (window) - {guard} (guard) = "
        f"{bins - end - window - guard}, less than {end}"
    )


def read_people(
    line_of: Lines, family: Family, channels: int, bins: int
) -> PeopleTracking | PeopleCounting | None:
    """Read the detection of people of a family of software that has one; None for others.

    Args:
        line_of: Line of each command that sets the detection, of all of NEEDED.
        family: Software that the file is for.
        channels: Number of virtual channels.
        bins: Number of range bins.

    Raises:
        CaptureError: A line cannot be read.
    """
    if family is Family.PEOPLE_3D:
        return read_people_tracking(line_of, channels, bins)
    if family is Family.PEOPLE:
        return read_people_counting(line_of, channels, bins)
    return None


def read_people_tracking(line_of: Lines, channels: int, bins: int) -> PeopleTracking:
    """Read the detection of 3D people tracking.

    Args:
        line_of: Line of each command that sets the detection, of all of NEEDED.
        channels: Number of virtual channels.
        bins: Number of range bins.

    Raises:
        CaptureError: A line cannot be read.
    """
    search, view = line_of["dynamicRangeAngleCfg"].numbers, line_of["fovCfg"].numbers
    geometry = [
        _read_elements(line_of[name], channels)
        for name in ("antGeometry0", "antGeometry1", "antPhaseRot")
    ]
    settings = PeopleTracking(
        right=geometry[0],
        up=geometry[1],
        rotation=geometry[2],
        coefficients=_read_corrections(line_of, channels),
        half_view_deg=(view["azimFoV"], view["elevFoV"]),
        step_deg=search["searchStep"],
        gamma=search["mvdr_alpha"],
        refinement=_read_refinement(line_of),
        dynamic=_read_cfar(line_of["dynamicRACfarCfg"]),
        static=_read_static(line_of),
        fine_motion=_read_fine_motion(line_of),
    )
    _require_fitting(settings, line_of, bins)
    return settings


def read_people_counting(line_of: Lines, channels: int, bins: int) -> PeopleCounting:
    """Read the detection of people counting.

    Arguments and errors are those of `read_people_tracking`.
    """
    line, search = line_of["cfarCfg"], line_of["doaCfg"].numbers
    cfar = _read_counting_cfar(line)
    settings = PeopleCounting(
        half_view_deg=search["estAngleRange"] / 10,
        step_deg=search["estAngleResolution"] / 1000,
        gamma=search["gamma"] / 1000,
        coefficients=_read_corrections(line_of, channels),
        cfar=cfar,
    )
    _require_cfar_within(cfar, line, ("refWinSize0", "refWinSize1"), bins, settings.angles_deg.size)
    return settings


def _read_counting_cfar(line: CfgLine) -> TwoPassCfar:
    """Read a line cfarCfg of people counting."""
    numbers = line.numbers
    return TwoPassCfar(
        skip_range=_pair(line, "cfarDiscardRangeLeft", "cfarDiscardRangeRight"),
        skip_angle=_pair(line, "cfarDiscardAngleLeft", "cfarDiscardAngleRight"),
        window=_pair(line, "refWinSize0", "refWinSize1"),
        guard=_pair(line, "guardWinSize0", "guardWinSize1"),
        threshold=(numbers["rangeThre"] / 10, numbers["azimuthThre"] / 10),
        sidelobe=None,
        second_pass=True,
    )


def _read_elements(line: CfgLine, channels: int) -> tuple[float, ...]:
    """Read a number of each virtual element."""
    values = tuple(value for name, value in line.numbers.items() if name != SUBFRAME.name)
    if len(values) != channels:
        raise line.refusal(
            "antenna1 ..", f"{len(values)} numbers", f"{channels}, one a virtual channel"
        )
    if line.name == "antPhaseRot" and not set(values) <= {1.0, -1.0}:
        raise line.refusal("antenna1 ..", " ".join(line.words), "1 or -1 each")
    return values


def _read_corrections(line_of: Lines, channels: int) -> tuple[complex, ...]:
    """Read the phase and gain corrections of the virtual channels; () without such a line."""
    line = line_of.get("compRangeBiasAndRxChanPhase")
    return () if line is None else read_coefficients(line, channels)


def _read_refinement(line_of: Lines) -> ElevationSearch | Zoom:
    """Read how a cell of the map becomes a direction; the method tells which numbers are right."""
    line, method = line_of["dynamic2DAngleCfg"], line_of["dynamicRangeAngleCfg"].numbers
    numbers, is_wall = line.numbers, method["detectionMethod"] == WALL
    if is_wall != ("elevSearchStep" in numbers):
        count = 9 if is_wall else 7
        raise line.refusal(
            "..",
            f"{len(line.words)} numbers",
            f"{count} with dynamicRangeAngleCfg detectionMethod {1 if is_wall else 2}",
        )
    if is_wall:
        return ElevationSearch(numbers["elevSearchStep"], numbers["mvdr_alpha"])
    return Zoom(
        factor=int(numbers["zoominFactor"]),
        reach=int(numbers["peakExpSamples"]),
        relative=numbers["peakExpRelThr"],
        least_snr=numbers["peakExpSNRThr"],
        neighbours=int(numbers["localMaxCheckFlag"]),
    )


def _read_cfar(line: CfgLine) -> TwoPassCfar:
    """Read a line dynamicRACfarCfg or staticRACfarCfg."""
    numbers = line.numbers
    return TwoPassCfar(
        skip_range=_pair(line, "leftSkipSize", "rightSkipSize"),
        skip_angle=_pair(line, "leftSkipSizeAzimuth", "rightSkipSizeAngle"),
        window=_pair(line, "searchWinSizeRange", "searchWinSizeAngle"),
        guard=_pair(line, "guardSizeRange", "guardSizeAngle"),
        threshold=(numbers["threRange"], numbers["threAngle"]),
        sidelobe=numbers["threSidelob"],
        second_pass=bool(numbers["enSecondPass"]),
    )


def _pair(line: CfgLine, first: str, second: str) -> tuple[int, int]:
    """Two whole numbers of a line, by the names of their arguments."""
    return int(line.numbers[first]), int(line.numbers[second])


def _read_static(line_of: Lines) -> StaticSearch | None:
    """Read the search for what stands still; None where it is off."""
    line = line_of.get("staticRangeAngleCfg")
    if line is None or not line.numbers["staticProcEnabled"]:
        return None
    if "staticRACfarCfg" not in line_of:
        raise line.refusal("staticProcEnabled", 1, "0 without a line staticRACfarCfg")
    # As in the firmware, the ranges of the moving points are skipped, and no pass is along angle.
    skip_range = _read_cfar(line_of["dynamicRACfarCfg"]).skip_range
    cfar = _read_cfar(line_of["staticRACfarCfg"])
    return StaticSearch(
        cfar=replace(cfar, skip_range=skip_range, second_pass=False),
        decimation=_pair(line, "staticAzimStepDeciFactor", "staticElevStepDeciFactor"),
    )


def _read_fine_motion(line_of: Lines) -> FineMotion | None:
    """Read the frames of slow movements; None where they are off, or where numbers lack."""
    line = line_of.get("fineMotionCfg")
    if line is None or not line.numbers["fineMotionProcEnabled"] or is_short_fine_motion(line):
        return None
    numbers = line.numbers
    return FineMotion(
        seconds=numbers["fineMotionObservationTime"],
        cycle=int(numbers["fineMotionProcCycle"]),
        highest_bin=int(numbers["fineMotionDopplerThrIdx"]),
    )


def is_short_fine_motion(line: CfgLine) -> bool:
    """Whether a line fineMotionCfg is on but lacks numbers, as in files for vital signs.

    It switches nothing on here.
    """
    is_on = bool(line.numbers["fineMotionProcEnabled"])
    return is_on and "fineMotionDopplerThrIdx" not in line.numbers


def _require_fitting(settings: PeopleTracking, line_of: Lines, bins: int) -> None:
    """Raise CaptureError where a view is too narrow for its steps, or a window for its map."""
    view, search = line_of["fovCfg"], line_of["dynamicRangeAngleCfg"]
    if isinstance(settings.refinement, Zoom) and settings.step_deg >= min(settings.half_view_deg):
        right = f"below azimFoV and elevFoV, {min(settings.half_view_deg):g} (fovCfg)"
        raise search.refusal("searchStep", settings.step_deg, right)
    angles = settings.nu.values.size
    if isinstance(settings.refinement, Zoom):
        angles *= settings.mu.values.size
    if angles > MAX_ANGLES:
        raise view.refusal("azimFoV", settings.half_view_deg[0], f"less: {angles} directions")
    names = ("searchWinSizeRange", "searchWinSizeAngle")
    _require_cfar_within(settings.dynamic, line_of["dynamicRACfarCfg"], names, bins, angles)
    if settings.static is not None:
        looked_at = [
            axis.values[::every].size
            for axis, every in zip(
                (settings.nu, settings.mu), settings.static.decimation, strict=True
            )
        ]
        cfar, line = settings.static.cfar, line_of["staticRACfarCfg"]
        _require_cfar_within(cfar, line, names, bins, looked_at[0] * looked_at[1])


def _require_cfar_within(
    cfar: TwoPassCfar,
    line: CfgLine,
    names: tuple[str, str],
    bins: int,
    angles: int,
) -> None:
    """Raise CaptureError where windows and ends that are left out do not fit a map.

    Args:
        cfar: Settings.
        line: Their line.
        names: Names of its windows along range and angle.
        bins: Number of range bins.
        angles: Number of angles.
    """
    if not cfar.fits_bins(bins):
        ends, sides = cfar.skip_range, f"2 ({cfar.window[0]} + {cfar.guard[0]})"
        right = (
            f"less: windows and guards on both sides, {sides} bins, do not fit between the ends "
            f"that are left out, {bins} - {ends[0]} - {ends[1]} = {bins - sum(ends)} bins"
        )
        raise line.refusal(names[0], cfar.window[0], right)
    if sum(cfar.skip_angle) >= angles or not cfar.fits_angles(angles):
        ends, sides = cfar.skip_angle, f"2 ({cfar.window[1]} + {cfar.guard[1]})"
        right = (
            f"less: windows and guards on both sides, {sides}, or the ends that are left out, "
            f"{ends[0]} + {ends[1]}, do not fit {angles} angles"
        )
        raise line.refusal(names[1], cfar.window[1], right)
