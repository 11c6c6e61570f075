"""Elements that a .cfg takes a board for, beside those of each device."""

import numpy as np
import pytest

from radhar_cli.config import Config
from radhar_cli.config.built_in_radars import BuiltInRadar, read_radars
from radhar_cli.config.documents import RADARS
from radhar_cli.radar.board import DEVICES
from radhar_cli.readers.ti.ti_cfg import parse_ti_cfg
from radhar_cli.readers.ti.ti_elements import compare_elements, fitting_devices
from radhar_cli.scene.checks.warnings import config_warnings

BUILT_IN = {radar.name: radar for radar in read_radars()}
ROW_AND_ONE_ABOVE = {"IWR6843ISK", "IWR1843BOOST", "AWR1843BOOST"}
OR_FRONT_END = ROW_AND_ONE_ABOVE | {"AWR1243BOOST", "AWR2243BOOST"}
# Devices on which nothing is said of the elements; on the others something is, or they are refused.
FITTING = {
    "iwr6843isk": OR_FRONT_END,
    "iwr6843isk_clouds": OR_FRONT_END,
    "iwr6843isk_people": ROW_AND_ONE_ABOVE,
    "iwr1843boost": OR_FRONT_END,
    "iwr1843boost_clouds": OR_FRONT_END,
    "iwr1843boost_people": ROW_AND_ONE_ABOVE,
    "iwr6843isk-ods_clouds": {"IWR6843ISK-ODS"},
    "iwr6843isk-ods_people": {"IWR6843ISK-ODS"},
    "iwr6843aop": {"IWR6843AOP"},
    "iwr6843aop_clouds": {"IWR6843AOP"},
    "iwr6843aop_people": {"IWR6843AOP"},
    "iwrl6432boost_clouds": {"IWRL6432BOOST"},
    "iwrl6844evm_clouds": {"IWRL6844EVM"},
    "awr2944evm_clouds": {"AWR2944EVM"},
}


def said_of_elements(cfg: str, device: str) -> list[str] | None:
    """What is said of the elements of a file on a device; None if the device is refused."""
    document = {"radar": {"cfg": cfg, "device": device}, "maps": ["points"]}
    try:
        config = Config.model_validate(document | {"cloud": {"chain": "board"}})
    except ValueError:
        try:
            config = Config.model_validate(document | {"cloud": {"chain": "best"}})
        except ValueError:
            return None
    words = "the elements of", "corrects feeds"
    return [line for line in config_warnings(config) if any(word in line for word in words)]


@pytest.mark.every(8)
@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("name", FITTING)
def test_a_file_of_other_elements_is_said_on_a_device(name: str, device: str) -> None:
    said = said_of_elements(RADARS[name].read_text(), device)
    if device in FITTING[name]:
        assert said == []
    else:
        assert said is None or len(said) == 1


def test_a_tracking_file_on_another_board_names_lines_and_the_board_that_fits() -> None:
    (said,) = said_of_elements(RADARS["iwr6843isk_people"].read_text(), "IWR6843ISK-ODS") or ()
    assert said == (
        "radar.cfg: antGeometry0, antGeometry1 and antPhaseRot differ from the elements of "
        "IWR6843ISK-ODS, and would fit IWR6843ISK: angles of points are wrong, as on the board"
    )


def changed(name: str, command: str, change: dict[str, str]) -> str:
    """Text of a built-in radar in whose line of a command words are replaced."""
    lines = RADARS[name].read_text().splitlines()
    (place,) = [n for n, line in enumerate(lines) if line.split()[:1] == [command]]
    first, *words = lines[place].split()
    lines[place] = " ".join((first, *(change.get(word, word) for word in words)))
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("name", "command", "change", "is_same"),
    [
        ("iwr6843aop_people", "antPhaseRot", {"1": "-1", "-1": "1"}, True),  # a common sign
        ("iwr6843isk_people", "antGeometry1", {"-1": "3", "0": "4"}, True),  # a common shift
        ("iwr6843isk_people", "antGeometry1", {"-1": "0", "0": "-1"}, False),  # upside down
        ("iwr6843isk_people", "antGeometry0", {"-7": "-8"}, False),
        ("iwr6843isk_people", "antGeometry0", {f"-{n}": f"{n}" for n in range(8)}, False),
        ("iwr6843aop_people", "antPhaseRot", {"-1": "1"}, False),
        ("iwrl6432boost_clouds", "antGeometryCfg", {"2.418": "2.45"}, True),
        ("iwrl6432boost_clouds", "antGeometryCfg", {"2.418": "4.8"}, False),
        ("iwrl6844evm_clouds", "antGeometryDist", {"2.54": "5"}, False),
    ],
)
def test_shifts_and_signs_in_common_are_no_difference(
    name: str, command: str, change: dict[str, str], is_same: bool
) -> None:
    device = BUILT_IN[name].device
    said = said_of_elements(changed(name, command, change), device)
    assert said is not None
    assert (said == []) is is_same
    assert is_same or command in said[0]


def test_rows_of_newer_software_may_be_counted_downwards() -> None:
    """As in TI's own antGeometryCfg, whose row 0 is on top."""
    text = RADARS["awr2944evm_clouds"].read_text()

    def said(lower: int, spacing: str) -> list[str] | None:
        upper = 1 - lower
        rows = [lower] * 4 + [upper] * 4 + [lower] * 8
        columns = [*range(4), *range(2, 6), *range(4, 12)]
        places = " ".join(f"{row} {column}" for row, column in zip(rows, columns, strict=True))
        return said_of_elements(f"{text}antGeometryCfg {places} {spacing}\n", "AWR2944EVM")

    assert said(1, "0.5 0.8") == said(0, "0.5 0.8") == []
    (line,) = said(1, "0.5 0.5") or ()
    assert line.startswith("radar.cfg: antGeometryCfg differs from the elements of AWR2944EVM")


def test_factors_of_a_calibration_are_said_for_what_they_are() -> None:
    """The board that was measured had other feeds than the simulated one."""
    turned = f"0.0 {np.cos(0.5):.4f} {np.sin(0.5):.4f} " + " ".join(["1 0"] * 11)
    text = RADARS["iwr6843isk_clouds"].read_text()
    line = f"compRangeBiasAndRxChanPhase {turned}\n"
    (said,) = said_of_elements(text + line, "IWR6843ISK") or ()
    assert said.startswith("radar.cfg: compRangeBiasAndRxChanPhase corrects feeds of one board")


def test_feeds_are_taken_for_equal_without_factors() -> None:
    """Of an ODS they are not, and its out-of-box demo without that line sees wrong angles."""
    lines = RADARS["iwr6843isk-ods_clouds"].read_text().splitlines()
    text = "\n".join(line for line in lines if not line.startswith("compRange"))
    (said,) = said_of_elements(text, "IWR6843ISK-ODS") or ()
    assert "compRangeBiasAndRxChanPhase differs" in said


def test_an_order_of_chirps_belongs_to_its_elements() -> None:
    """A file with masks 1, 4, 2 and elements for 1, 2, 4 is not the device's."""
    text = RADARS["iwr6843isk_people"].read_text()
    text = text.replace("chirpCfg 1 1 0 0 0 0 0 2", "chirpCfg 1 1 0 0 0 0 0 4")
    text = text.replace("chirpCfg 2 2 0 0 0 0 0 4", "chirpCfg 2 2 0 0 0 0 0 2")
    assert len(said_of_elements(text, "IWR6843ISK") or ()) == 1


@pytest.mark.parametrize("radar", BUILT_IN.values(), ids=BUILT_IN)
def test_a_built_in_radar_fits_its_device(radar: BuiltInRadar) -> None:
    assert radar.device in fitting_devices(radar.header)
    array = DEVICES[radar.device].array
    assert not compare_elements(
        radar.header.elements, array, radar.header.timing.antennas_of_channels
    ).commands


def test_places_of_a_file_are_those_of_its_virtual_elements() -> None:
    """TI's antGeometry lines of an AOP, by hand."""
    header = parse_ti_cfg(RADARS["iwr6843aop_people"].read_text())
    array = DEVICES["IWR6843AOP"].array
    places = np.array(header.elements.places)
    for (tx, rx), place in zip(header.timing.antennas_of_channels, places, strict=True):
        assert np.add(array.tx[tx], array.rx[rx]) == pytest.approx(place)
