"""The detection of a board: lines of the .cfg, as far as the device's firmware heeds them."""

import pytest
from helpers.boards import CFG

from radhar_cli.config.processing import ProcessingConfig
from radhar_cli.config.radar import BoardRadar
from radhar_cli.scene.radar import detection_of

LIMITS = "aoaFovCfg -1 -60 60 -30 30\ncfarFovCfg -1 0 0.5 6\ncfarFovCfg -1 1 -3 3\n"


@pytest.mark.parametrize(
    ("device", "heeds"), [("IWR1443BOOST", False), ("AWR1443BOOST", False), ("IWR1843BOOST", True)]
)
def test_limits_hold_where_the_firmware_knows_them(device: str, heeds: bool) -> None:
    radar = BoardRadar[float](cfg=CFG + LIMITS, device=device)
    detection = detection_of(radar, ProcessingConfig(clutter="none"))
    assert detection.azimuth_deg == ((-60, 60) if heeds else None)
    assert detection.elevation_deg == ((-30, 30) if heeds else None)
    assert detection.range_m == ((0.5, 6) if heeds else None)
    assert detection.doppler_mps == ((-3, 3) if heeds else None)
    assert not detection.remove_mean
