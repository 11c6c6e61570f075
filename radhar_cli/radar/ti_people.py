"""Detection of people as the lines of a TI .cfg set it: 3D people tracking, and people counting."""

from collections.abc import Iterable, Mapping, Sequence
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
from radhar_cli.radar.ti_commands import ALL_SUBFRAMES, SUBFRAME, CfgLine, Effect
from radhar_cli.radar.ti_family import Family

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
}
_SKIPS = ("leftSkipSize", "rightSkipSize"), ("leftSkipSizeAzimuth", "rightSkipSizeAngle")
_COUNTING_SKIPS = (
    ("cfarDiscardRangeLeft", "cfarDiscardRangeRight"),
    ("cfarDiscardAngleLeft", "cfarDiscardAngleRight"),
)


def lines_of_subframe(lines: Iterable[CfgLine], subframe: int) -> Lines:
    """Find the last line of each command of detection that holds for a subframe."""
    held = dict[str, CfgLine]()
    for line in lines:
        if line.command is None or line.command.effect is not Effect.POINTS:
            continue
        if line.numbers[SUBFRAME.name] in (ALL_SUBFRAMES, subframe):
            held[line.name] = line
    return held


def missing_commands(lines: Iterable[CfgLine], family: Family) -> tuple[str, ...]:
    """Commands that the chain of a family needs and lines lack, each with a line that would do."""
    names = {line.name for line in lines}
    needed = NEEDED.get(family, {}).items()
    return tuple(
        f"{name} is missing; a line that would do: {example}"
        for name, example in needed
        if name not in names
    )


def read_people(
    lines: Iterable[CfgLine], family: Family, channels: int, bins: int, subframe: int = 0
) -> PeopleTracking | PeopleCounting | None:
    """Read the detection of people of a family of software that has one; None for others.

    Args:
        lines: Lines of a .cfg that has all of NEEDED.
        family: Software that it is for.
        channels: Number of virtual channels.
        bins: Number of range bins.
        subframe: Number of the subframe, from 0 on.

    Raises:
        CaptureError: A line cannot be read.
    """
    if family is Family.PEOPLE_3D:
        return read_people_tracking(lines, channels, bins, subframe)
    if family is Family.PEOPLE:
        return read_people_counting(lines, channels, bins, subframe)
    return None


def read_people_tracking(
    lines: Iterable[CfgLine], channels: int, bins: int, subframe: int = 0
) -> PeopleTracking:
    """Read the detection of 3D people tracking.

    Args:
        lines: Lines of a .cfg that has all of NEEDED.
        channels: Number of virtual channels.
        bins: Number of range bins.
        subframe: Number of the subframe, from 0 on.

    Raises:
        CaptureError: A line cannot be read.
    """
    held = lines_of_subframe(lines, subframe)
    search, view = held["dynamicRangeAngleCfg"].numbers, held["fovCfg"].numbers
    geometry = [
        _read_elements(held[name], channels)
        for name in ("antGeometry0", "antGeometry1", "antPhaseRot")
    ]
    settings = PeopleTracking(
        right=geometry[0],
        up=geometry[1],
        rotation=geometry[2],
        coefficients=_read_corrections(held, channels),
        half_view_deg=(view["azimFoV"], view["elevFoV"]),
        step_deg=search["searchStep"],
        gamma=search["mvdr_alpha"],
        refinement=_read_refinement(held),
        dynamic=_read_cfar(held["dynamicRACfarCfg"]),
        static=_read_static(held),
        fine_motion=_read_fine_motion(held),
    )
    _require_fitting(settings, held, bins)
    return settings


def read_people_counting(
    lines: Iterable[CfgLine], channels: int, bins: int, subframe: int = 0
) -> PeopleCounting:
    """Read the detection of people counting, of two lines.

    Args:
        lines: Lines of a .cfg that has all of NEEDED.
        channels: Number of virtual channels.
        bins: Number of range bins.
        subframe: Number of the subframe, from 0 on.

    Raises:
        CaptureError: A line cannot be read.
    """
    held = lines_of_subframe(lines, subframe)
    line, search = held["cfarCfg"], held["doaCfg"].numbers
    numbers = line.numbers
    skip = _pairs(numbers, _COUNTING_SKIPS)
    cfar = TwoPassCfar(
        skip_range=skip[0],
        skip_angle=skip[1],
        window=(int(numbers["refWinSize0"]), int(numbers["refWinSize1"])),
        guard=(int(numbers["guardWinSize0"]), int(numbers["guardWinSize1"])),
        threshold=(numbers["rangeThre"] / 10, numbers["azimuthThre"] / 10),
        sidelobe=None,
        second_pass=True,
    )
    settings = PeopleCounting(
        half_view_deg=search["estAngleRange"] / 10,
        step_deg=search["estAngleResolution"] / 1000,
        gamma=search["gamma"] / 1000,
        coefficients=_read_corrections(held, channels),
        cfar=cfar,
    )
    _require_cfar_within(cfar, line, ("refWinSize0", "refWinSize1"), bins, settings.angles_deg.size)
    return settings


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


def _read_corrections(held: Lines, channels: int) -> tuple[complex, ...]:
    """Read the phase and gain corrections of the virtual channels; () without such a line."""
    line = held.get("compRangeBiasAndRxChanPhase")
    if line is None:
        return ()
    parts: Sequence[float] = [
        value for name, value in line.numbers.items() if name[:2] in ("Re", "Im")
    ]
    return tuple(complex(*pair) for pair in zip(parts[::2], parts[1::2], strict=True))[:channels]


def _read_refinement(held: Lines) -> ElevationSearch | Zoom:
    """Read how a cell of the map becomes a direction; the method tells which numbers are right."""
    line, method = held["dynamic2DAngleCfg"], held["dynamicRangeAngleCfg"].numbers
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
    skip = _pairs(numbers, _SKIPS)
    return TwoPassCfar(
        skip_range=skip[0],
        skip_angle=skip[1],
        window=(int(numbers["searchWinSizeRange"]), int(numbers["searchWinSizeAngle"])),
        guard=(int(numbers["guardSizeRange"]), int(numbers["guardSizeAngle"])),
        threshold=(numbers["threRange"], numbers["threAngle"]),
        sidelobe=numbers["threSidelob"],
        second_pass=bool(numbers["enSecondPass"]),
    )


def _pairs(numbers: Mapping[str, float], names: Sequence[tuple[str, str]]) -> list[tuple[int, int]]:
    """Pairs of whole numbers by the names of their arguments."""
    return [(int(numbers[low]), int(numbers[high])) for low, high in names]


def _read_static(held: Lines) -> StaticSearch | None:
    """Read the search for what stands still; None where it is off."""
    line = held.get("staticRangeAngleCfg")
    if line is None or not line.numbers["staticProcEnabled"]:
        return None
    if "staticRACfarCfg" not in held:
        raise line.refusal("staticProcEnabled", 1, "0 without a line staticRACfarCfg")
    numbers = line.numbers
    decimation = (
        int(numbers["staticAzimStepDeciFactor"]),
        int(numbers["staticElevStepDeciFactor"]),
    )
    skip_range = _read_cfar(held["dynamicRACfarCfg"]).skip_range  # which its own yield to
    cfar = replace(_read_cfar(held["staticRACfarCfg"]), skip_range=skip_range)
    return StaticSearch(cfar, decimation)


def _read_fine_motion(held: Lines) -> FineMotion | None:
    """Read the frames of slow movements; None where they are off, or where numbers lack."""
    line = held.get("fineMotionCfg")
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


def _require_fitting(settings: PeopleTracking, held: Lines, bins: int) -> None:
    """Raise CaptureError where a view is too narrow for its steps, or a window for its map."""
    view, search = held["fovCfg"], held["dynamicRangeAngleCfg"]
    if isinstance(settings.refinement, Zoom) and settings.step_deg >= min(settings.half_view_deg):
        right = f"below azimFoV and elevFoV, {min(settings.half_view_deg):g} (fovCfg)"
        raise search.refusal("searchStep", settings.step_deg, right)
    angles = settings.nu.values.size
    if isinstance(settings.refinement, Zoom):
        angles *= settings.mu.values.size
    if angles > MAX_ANGLES:
        raise view.refusal("azimFoV", settings.half_view_deg[0], f"less: {angles} directions")
    names = ("searchWinSizeRange", "searchWinSizeAngle")
    _require_cfar_within(settings.dynamic, held["dynamicRACfarCfg"], names, bins, angles)
    if settings.static is not None:
        looked_at = [
            axis.values[::every].size
            for axis, every in zip(
                (settings.nu, settings.mu), settings.static.decimation, strict=True
            )
        ]
        cfar, line = settings.static.cfar, held["staticRACfarCfg"]
        _require_cfar_within(cfar, line, names, bins, looked_at[0] * looked_at[1], is_static=True)


def _require_cfar_within(
    cfar: TwoPassCfar,
    line: CfgLine,
    names: tuple[str, str],
    bins: int,
    angles: int,
    is_static: bool = False,
) -> None:
    """Raise CaptureError where windows and ends that are left out do not fit a map.

    Args:
        cfar: Settings.
        line: Their line.
        names: Names of its windows along range and angle.
        bins: Number of range bins.
        angles: Number of angles.
        is_static: Whether there is no pass along angle.
    """
    if not cfar.fits_bins(bins):
        right = f"less: both windows, guards and ends that are left out do not fit {bins} bins"
        raise line.refusal(names[0], cfar.window[0], right)
    if sum(cfar.skip_angle) >= angles or not (is_static or cfar.fits_angles(angles)):
        right = f"less: both windows, guards and ends that are left out do not fit {angles} angles"
        raise line.refusal(names[1], cfar.window[1], right)
