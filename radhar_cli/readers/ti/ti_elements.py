"""Elements of the antennas as the lines of a TI .cfg have them, beside those of a device.

The device's are simulated. A chain of the firmware believes the file's: where they differ by more
than a common shift, a common sign, or rows that are counted downwards, its angles are wrong.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.radar.board import DEVICES, Array, Places
from radhar_cli.radar.ti_family import Family
from radhar_cli.readers.ti.ti_commands import SUBFRAME, CfgLine

if TYPE_CHECKING:
    from radhar_cli.readers.ti.ti_cfg import BoardHeader

Antennas: TypeAlias = Sequence[tuple[int, int]]  # (transmitter, receiver) of each virtual element

CORRECTIONS = "compRangeBiasAndRxChanPhase"
GEOMETRY = "antGeometry0", "antGeometry1", "antPhaseRot"
APART = 0.1  # half wavelengths from which places differ
MM = 1e-3
TWINS = "AWR1443", "AWR1642", "AWR1843", "AWR1243", "AWR2243"  # of the elements of IWR boards
ANTENNAS = 4  # most transmitters, and most receivers
TURNED = np.radians(5)  # phase from which corrections are of other feeds


@dataclass(frozen=True)
class FileElements:
    """Elements of the virtual channels of a board, as a .cfg has them.

    Attributes:
        places: Places (left, up) of the virtual elements, half wavelengths or m; () where the file
            has none.
        of_places: Commands that have them.
        is_in_m: Whether places are in m.
        counts_down: Whether rows may be counted downwards.
        phases: Factors of the channels that correct their feeds; () where the file has none.
        of_phases: Commands that have them.
    """

    places: Places = ()
    of_places: tuple[str, ...] = ()
    is_in_m: bool = False
    counts_down: bool = False
    phases: tuple[complex, ...] = ()
    of_phases: tuple[str, ...] = ()


@dataclass(frozen=True)
class ElementDifference:
    """Elements of a file that are not a device's, in words.

    Attributes:
        commands: Commands that differ; () for none.
        is_calibration: Whether they are corrections that turn no feed by more than a right angle.
    """

    commands: tuple[str, ...] = ()
    is_calibration: bool = False


def read_rows_and_columns(
    lines: Mapping[str, CfgLine], antennas: Antennas, family: Family
) -> FileElements:
    """Read the places of the elements by rows and columns, as newer software has them.

    Args:
        lines: Last line of each command.
        antennas: Transmitter and receiver of each virtual element.
        family: Software that the file is for.

    Returns:
        The elements, without places where the file has none, or not those of all antennas.

    Raises:
        CaptureError: A line cannot be read.
    """
    spacing = _numbers_of("antGeometryDist", lines)
    of_places: tuple[str, ...] = ("antGeometryCfg",)
    numbers, count = _numbers_of("antGeometryCfg", lines), 2 * len(antennas)
    if len(numbers) in (count, count + 2):
        grid, spacing = numbers[:count].reshape(-1, 2), numbers[count:]
    else:
        of_places = "antGeometryTX", "antGeometryRx"
        tx, rx = (_numbers_of(name, lines)[: 2 * ANTENNAS] for name in of_places)
        last = np.max(antennas, axis=0) + 1
        if len(tx) % 2 or len(rx) % 2 or len(tx) < 2 * last[0] or len(rx) < 2 * last[1]:
            return FileElements()
        grid = np.array([tx.reshape(-1, 2)[t] + rx.reshape(-1, 2)[r] for t, r in antennas])
        of_places = (*of_places, *("antGeometryDist",) * bool(len(spacing)))
    is_in_m = len(spacing) == 2 and family is Family.L_SDK
    unit = spacing * (MM if is_in_m else 2) if len(spacing) == 2 else np.ones(2)
    places = grid[:, ::-1] * unit
    return FileElements(
        places=tuple((float(left), float(up)) for left, up in places),
        of_places=of_places,
        is_in_m=is_in_m,
        counts_down=True,
    )


def read_geometry(lines: Mapping[str, CfgLine], channels: int) -> FileElements | None:
    """Read the places and signs of the virtual elements, as the lines of people tracking have them.

    Args:
        lines: Last line of each command.
        channels: Number of virtual channels.

    Returns:
        The elements; None without a number of each channel in all three lines.

    Raises:
        CaptureError: A line cannot be read.
    """
    numbers = [_numbers_of(name, lines) for name in GEOMETRY]
    if any(len(of_line) != channels for of_line in numbers):
        return None
    right, up, signs = (of_line.tolist() for of_line in numbers)
    return FileElements(
        places=tuple(zip((-x for x in right), up, strict=True)),
        of_places=GEOMETRY[:2],
        phases=tuple(map(complex, signs)),
        of_phases=GEOMETRY[2:],
    )


def correct_feeds(elements: FileElements, corrections: Sequence[complex]) -> FileElements:
    """Multiply the factors of feeds by those of another line; () for none."""
    has_both = len(set(corrections)) > 1
    names = elements.of_phases if len(set(elements.phases)) > 1 or not has_both else ()
    factors = corrections or (1,) * len(elements.phases)
    return replace(
        elements,
        phases=tuple(p * c for p, c in zip(elements.phases, factors, strict=True)),
        of_phases=(*names, *(CORRECTIONS,) * has_both),
    )


def _numbers_of(name: str, lines: Mapping[str, CfgLine]) -> Float:
    """Numbers of a command; none where the file lacks it."""
    numbers = lines[name].numbers if name in lines else {}
    return np.array([number for key, number in numbers.items() if key != SUBFRAME.name], float)


def compare_elements(elements: FileElements, array: Array, antennas: Antennas) -> ElementDifference:
    """Compare the elements of a .cfg with those of a device.

    Args:
        elements: Elements of the file.
        array: Elements of the device.
        antennas: Transmitter and receiver of each virtual element, all of which the device has.
    """
    unit = (array.unit_m or 1.0) if elements.is_in_m else 1.0
    device = unit * np.array([np.add(array.tx[t], array.rx[r]) for t, r in antennas], float)
    is_same = not elements.places or _is_same_array(elements, device, APART * unit)
    commands = () if is_same else elements.of_places
    turn = _largest_turn(elements.phases, array, antennas)
    if turn <= TURNED:
        return ElementDifference(commands)
    is_calibration = is_same and turn < np.pi / 2
    return ElementDifference((*commands, *elements.of_phases), is_calibration)


def fitting_devices(header: "BoardHeader") -> list[str]:
    """Name the devices whose elements, software and band are those of a .cfg.

    Of boards with the same elements IWR stands for all. A file that says nothing of
    elements fits any device that has its antennas.
    """
    return [
        name
        for name, device in DEVICES.items()
        if not name.startswith(TWINS)
        and header.family in (Family.ANY, *device.families)
        and low_ghz(name) <= header.timing.start_hz / 1e9 < low_ghz(name) + 10
        and _has_antennas(device.array, header.timing.antennas_of_channels)
        and _could_be(header.elements, device.array, header.timing.antennas_of_channels)
    ]


def _could_be(elements: FileElements, array: Array, antennas: Antennas) -> bool:
    """Whether elements may be an array's: of its places or, where they have none, of its feeds."""
    elements = replace(elements, phases=()) if elements.places else elements
    difference = compare_elements(elements, array, antennas)
    return not difference.commands or difference.is_calibration


def low_ghz(device: str) -> float:
    """Lower end (GHz) of the band that a device may send in, or a little less."""
    return 55.0 if "6843" in device or device.startswith("IWRL") else 75.0


def _has_antennas(array: Array, antennas: Antennas) -> bool:
    """Whether an array has the transmitters and receivers of a .cfg."""
    return all(t < len(array.tx) and r < len(array.rx) for t, r in antennas)


def _is_same_array(elements: FileElements, device: Float, apart: float) -> bool:
    """Whether places are the same but for a shift, and rows that may be counted downwards."""
    places = np.array(elements.places)
    ups = (1, -1) if elements.counts_down else (1,)
    differences = [places * (1, up) - device for up in ups]
    return any(float(np.ptp(one, axis=0).max()) <= apart for one in differences)


def _largest_turn(phases: tuple[complex, ...], array: Array, antennas: Antennas) -> float:
    """Largest phase (rad) between the corrected feeds of two channels; 0 without corrections."""
    if not phases:
        return 0.0
    tx_sign = array.tx_sign or (1.0,) * len(array.tx)
    signs = np.array([tx_sign[t] * array.rx_sign[r] for t, r in antennas])
    corrected: Complex = np.array(phases) * signs
    return float(np.abs(np.angle(corrected * np.conj(corrected[0]))).max())
