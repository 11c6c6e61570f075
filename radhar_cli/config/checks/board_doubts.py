"""Lines of a .cfg and keys of a board that have no effect, or another one than on the board."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from math import asin, degrees
from typing import TYPE_CHECKING

from radhar_cli.config.first_level import Request
from radhar_cli.config.radar import ArrayRadar, BoardRadar
from radhar_cli.processing.angle_time import ANGLE_TIME_KINDS
from radhar_cli.processing.frame_maps import FRAME_MAP_KINDS
from radhar_cli.processing.map_kind import kind_of
from radhar_cli.radar.board import longest_rows
from radhar_cli.radar.detection import Chain
from radhar_cli.radar.ti_family import Family

if TYPE_CHECKING:
    from radhar_cli.readers.ti.ti_cfg import BoardHeader

SPARSE = 1.5  # half wavelengths, from which a row of elements by hand is said to be sparse
MAX_COMMANDS = 20  # of a .cfg, in a warning


def board_warnings(config: Request) -> Iterator[str]:
    """Warn of unknown commands, of too long windows, and of lines of a .cfg without effect."""
    radar = config.radar
    if isinstance(radar, BoardRadar):
        yield from _unknown_commands(radar)
    if isinstance(radar, ArrayRadar):
        yield from _window_warnings(config, radar)
    if isinstance(radar, BoardRadar):
        yield from _header_warnings(config, radar)


def _unknown_commands(radar: BoardRadar) -> Iterator[str]:
    """Warn of commands of a .cfg that are not known."""
    header = radar.header
    if header.unknown:
        verb = "is not known and has" if len(header.unknown) == 1 else "are not known and have"
        hidden = len(header.unknown) - MAX_COMMANDS
        names = ", ".join(header.unknown[:MAX_COMMANDS]) + f" and {hidden} more" * (hidden > 0)
        yield f"radar.cfg: {names} {verb} no effect"


def _window_warnings(config: Request, radar: ArrayRadar) -> Iterator[str]:
    """Warn of a window longer than the chirps of a frame, beyond which it has no effect."""
    frame_s = radar.timing.loops * radar.timing.loop_s
    window_s = config.processing.window_s if _gives_window(config) else None
    if window_s is not None and window_s > frame_s:
        yield (
            f"processing.window_s has no effect beyond the {frame_s:.3g} s of a frame's chirps "
            f"({radar.named}): it is {window_s:g} s"
        )


def _header_warnings(config: Request, radar: BoardRadar) -> Iterator[str]:
    """Warn of lines of a .cfg that have no effect, or another one than on the board."""
    header = radar.header
    if header.not_simulated:
        names = ", ".join(header.not_simulated)
        yield f"radar.cfg: {names}: what is set there is not simulated"
    if "chain" not in config.cloud.model_fields_set and "points" in config.stored:
        yield _describe_chain(config.cloud.chain, radar)
    is_6843 = str(radar.device).startswith("IWR6843") and "points" in config.stored
    if is_6843 and _counts_people(config.cloud.chain, header):
        yield (
            "cloud.chain: people_counting: of the Doppler CFAR of an IWR6843, which makes several "
            "points of a cell, the largest Doppler alone is modelled"
        )
    yield from _elements_warnings(config, radar)
    if radar.timing.is_real and header.family not in (Family.MCU_PLUS, Family.L_SDK):
        yield "radar.cfg: adcCfg has real samples, which firmware of SDK 1 to 3 does not take"
    pose = {} if header.pose is None else vars(header.pose)
    config_keys = [f"radar.{key}" for key, number in pose.items() if getattr(radar, key) != number]
    if config_keys:
        yield f"radar.cfg: sensorPosition yields to the config's {', '.join(config_keys)}"


def _elements_warnings(config: Request, radar: BoardRadar) -> Iterator[str]:
    """Warn, in one line, that the elements of the file are not those of the board."""
    from radhar_cli.readers.ti.ti_elements import (  # of boards alone
        compare_elements,
        fitting_devices,
    )

    header, array = radar.header, radar.elements
    assert array is not None
    is_best = config.cloud.chain == "best"  # which believes the device alone
    elements = replace(header.elements, phases=()) if is_best else header.elements
    difference = compare_elements(elements, array, radar.timing.antennas_of_channels)
    if not difference.commands:
        return
    names = " and ".join(
        filter(None, (", ".join(difference.commands[:-1]), difference.commands[-1]))
    )
    board = radar.device if radar.array is None else "radar.array"
    if difference.is_calibration:
        yield (
            f"radar.cfg: {names} corrects feeds of one board, which the simulated {board} does not "
            "have: angles of points are off by that"
        )
        return
    differ = "differs" if len(difference.commands) == 1 else "differ"
    others = [name for name in fitting_devices(header) if name != radar.device]
    fit = f", and would fit {' or '.join(others)}" if others else ""
    effect = "the device's count" if is_best else "angles of points are wrong, as on the board"
    yield f"radar.cfg: {names} {differ} from the elements of {board}{fit}: {effect}"


def _counts_people(chain: Chain, header: "BoardHeader") -> bool:
    """Whether people counting finds the points."""
    return "people_counting" in (chain, header.firmware if chain == "board" else None)


def _describe_chain(chain: Chain, radar: BoardRadar) -> str:
    """Describe the chain that finds the points by default, with the reason for it."""
    header = radar.header
    if chain != "best":
        return f"cloud.chain: {chain}, the firmware whose commands radar.cfg has"
    if header.firmware is not None:
        return f"cloud.chain: best, as {radar.why_no_points(header.firmware)}"
    if header.why_no_chain:
        return f"cloud.chain: best, as {header.why_no_chain[0]}"
    return "cloud.chain: best, as radar.cfg has no detection of a firmware that is simulated"


def _gives_window(config: Request) -> bool:
    """Whether a config gives the window of maps that it asks for."""
    kinds = [kind for name in config.maps if (kind := kind_of(name)) is not None]
    has_windows = any(kind.is_doppler_time for kind in kinds)
    return has_windows and "window_s" in config.processing.model_fields_set


def angle_warnings(config: Request) -> Iterator[str]:
    """Warn that elements by hand are so far apart that angles fold."""
    radar = config.radar
    if not isinstance(radar, ArrayRadar) or getattr(radar, "array", None) is None:
        return
    axes = {name: kind.array_axis for name, kind in FRAME_MAP_KINDS.items()}
    axes |= {name: kind.array_axis for name, kind in ANGLE_TIME_KINDS.items()}
    places = radar.virtual_places
    for axis in {axes[name] for name in config.maps if axes.get(name) is not None}:
        assert axis is not None
        spacings = [
            abs(places[right][axis] - places[left][axis])
            for row in longest_rows(places, axis)
            for left, right in pairwise(row)
        ]
        if spacings and min(spacings) > SPARSE:
            yield (
                f"radar.array: elements are {min(spacings):.3g} half wavelengths apart or more, so "
                f"that angles beyond {degrees(asin(1 / min(spacings))):.0f} degrees fold (places "
                "in millimetres have radar.half_wavelength_m: 0.001)"
            )
