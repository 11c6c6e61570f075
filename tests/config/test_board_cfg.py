"""The .cfg of a board in a config: its pose, its chain, what is said of its commands."""

from pathlib import Path
from typing import Any

import pytest
from helpers.boards import CFG
from helpers.scatterers import ISK_CFG

from radhar_cli.config import Config
from radhar_cli.config.radar import BoardRadar
from radhar_cli.config.starting_file import of_board
from radhar_cli.radar.board import device_name
from radhar_cli.radar.room import RoomBox
from radhar_cli.scene.checks.warnings import config_warnings

TRACKING = f"{CFG}sensorPosition 2 10 15\n"
WITHOUT_CFAR = CFG.replace("cfarCfg 0 2 8 4 3 0 1130\n", "")

COUNTING = """
channelCfg 15 3 0
adcCfg 2 1
profileCfg 0 77 30 7 62 0 0 60 1 128 2500 0 0 30
chirpCfg 0 0 0 0 0 0 0 1
chirpCfg 1 1 0 0 0 0 0 2
frameCfg 0 1 128 0 50 1 0
cfarCfg 6 4 4 0 0 16 16 4 4 50 62 0
doaCfg 600 1875 30 1
"""


def board(cfg: str, cloud: dict[str, Any] | None = None, **radar: Any) -> Config:
    """Config of an IWR1443BOOST; its radar's other keys by name."""
    keys = {"cfg": cfg, "device": "IWR1443BOOST", **radar}
    maps = keys.pop("maps", ["rtm"])
    return Config.model_validate(
        {"radar": keys, "duration_s": 1.0, "maps": maps, "cloud": cloud or {}}
    )


def radar_of(config: Config) -> BoardRadar:
    assert isinstance(config.radar, BoardRadar)
    return config.radar


def test_pose_is_that_of_sensorPosition() -> None:
    radar = radar_of(board(TRACKING))
    assert (radar.position_m, radar.yaw_deg, radar.tilt_deg) == ((0, 0, 2), -10, 15)
    usual = radar_of(board(CFG))
    assert (usual.position_m, usual.yaw_deg, usual.tilt_deg) == ((0, 0, 1), 0, 0)


def test_each_key_of_the_config_wins_over_the_file_and_that_is_said() -> None:
    config = board(TRACKING, tilt_deg=5.0)
    radar = radar_of(config)
    assert (radar.position_m, radar.yaw_deg, radar.tilt_deg) == ((0, 0, 2), -10, 5)
    (line,) = (line for line in config_warnings(config) if "sensorPosition" in line)
    assert line == "radar.cfg: sensorPosition yields to the config's radar.tilt_deg"
    equal = board(TRACKING, position_m=(0, 0, 2), yaw_deg=-10, tilt_deg=15)
    assert not [line for line in config_warnings(equal) if "sensorPosition" in line]


def test_a_started_config_leaves_the_pose_to_the_file(tmp_path: Path) -> None:
    (tmp_path / "board.cfg").write_text(TRACKING)
    assert "position_m" not in of_board(str(tmp_path / "board.cfg"), tmp_path)
    (tmp_path / "board.cfg").write_text(CFG)
    assert "position_m: [0, 0, 1]" in of_board(str(tmp_path / "board.cfg"), tmp_path)


def test_the_chain_of_a_board_needs_its_cfar(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"radar\.cfg: cfarCfg is missing"):
        board(WITHOUT_CFAR, cloud={"chain": "board"})
    assert board(WITHOUT_CFAR).cloud.chain == "best"
    (tmp_path / "board.cfg").write_text(WITHOUT_CFAR)
    assert "chain: best" in of_board(str(tmp_path / "board.cfg"), tmp_path)


@pytest.mark.parametrize(
    ("lines", "device"),
    [
        ("", "IWR1443BOOST"),
        ("cfarCfg -1 0 2 8 4 3 0 15 1", "IWR1843BOOST"),
        ("doaCfg 600 1875 30 1", "IWR1642BOOST"),
        (
            "frameCfg 0 2 32 0 100 1 0\nprofileCfg 0 60 17 7 40 0 0 80 1 80 2499 0 0 30",
            "IWR6843ISK",
        ),
        (
            "% Platform:xWR16xx\nchannelCfg 15 3 0\nframeCfg 0 1 32 0 100 1 0\n"
            "chirpCfg 1 1 0 0 0 0 0 2\ncfarCfg -1 0 2 8 4 3 0 15 1",
            "IWR1642BOOST",
        ),
        (
            "% Platform:xWR68xx_AOP\nprofileCfg 0 60 17 7 40 0 0 80 1 80 2499 0 0 30\n"
            "cfarCfg -1 0 2 8 4 3 0 15 1\n"
            f"compRangeBiasAndRxChanPhase 0.0{6 * ' 1 0 -1 0'}",
            "IWR6843AOP",
        ),
    ],
)
def test_a_started_config_has_the_likely_device(lines: str, device: str, tmp_path: Path) -> None:
    (tmp_path / "board.cfg").write_text(f"{WITHOUT_CFAR}{lines}\n")
    assert f"device: {device}," in of_board(str(tmp_path / "board.cfg"), tmp_path)


@pytest.mark.parametrize(
    ("spelling", "device"),
    [
        ("awr1243", "AWR1243BOOST"),
        ("AWR2243_BOOST", "AWR2243BOOST"),
        ("xWR2243", "AWR2243BOOST"),
        ("AWR1443BOOST", "AWR1443BOOST"),
        ("iwr1642boost", "IWR1642BOOST"),
        ("AWR1642", "IWR1642BOOST"),
        ("AWR2944", "AWR2944EVM"),
        ("IWR6843AOPEVM", "IWR6843AOP"),
        ("AWR6843AOP", "IWR6843AOP"),
        ("IWR6843ISK_ODS", "IWR6843ISK-ODS"),
        ("IWR6843", None),
        ("AWR1843AOP", None),
    ],
)
def test_a_device_has_the_names_that_one_guesses(spelling: str, device: str | None) -> None:
    assert device_name(spelling) == device
    assert radar_of(board(WITHOUT_CFAR, device="xWR1443")).device == "IWR1443BOOST"


@pytest.mark.parametrize("device", ["IWR6843", "AWR2544EVM", "BGT60TR13C"])
def test_a_board_that_is_not_known_leads_to_places_of_antennas(device: str) -> None:
    with pytest.raises(
        ValueError, match=r"should be one of IWR1443BOOST, .*; or leave it out, and"
    ):
        board(WITHOUT_CFAR, device=device)


def test_a_demo_of_SDK_3_runs_on_an_IWR1642() -> None:
    cfg = CFG.replace("channelCfg 15 7 0", "channelCfg 15 3 0").replace(
        "cfarCfg 0 2 8 4 3 0 1130", "cfarCfg -1 0 2 8 4 3 0 15 1"
    )
    two = cfg.replace("chirpCfg 1 1 0 0 0 0 0 4", "chirpCfg 1 1 0 0 0 0 0 2")
    two = two.replace("chirpCfg 2 2 0 0 0 0 0 2\n", "").replace("frameCfg 0 2", "frameCfg 0 1")
    assert board(two, device="IWR1642BOOST", maps=["points"]).cloud.chain == "sdk3"


def test_commands_without_effect_are_named_in_a_line() -> None:
    lines = (
        "quantumCfg 1\nwarpCfg 2\nnearFieldCfg -1 1 0 9\nextendedMaxVelocity -1 1\ntrackingCfg 1\n"
    )
    said = [line for line in config_warnings(board(CFG + lines)) if "radar.cfg" in line]
    assert said == [
        "radar.cfg: quantumCfg, warpCfg are not known and have no effect",
        "radar.cfg: nearFieldCfg, extendedMaxVelocity: what is set there is not simulated",
    ]
    assert not [line for line in config_warnings(board(CFG)) if "radar.cfg" in line]


@pytest.mark.parametrize(
    ("cfg", "device", "chain"),
    [
        (CFG, "IWR1443BOOST", "sdk1"),
        (
            CFG.replace("cfarCfg 0 2 8 4 3 0 1130", "cfarCfg -1 0 2 8 4 3 0 15 1"),
            "IWR1843BOOST",
            "sdk3",
        ),
        (ISK_CFG, "IWR6843ISK", "people_tracking"),
        (COUNTING, "IWR1642BOOST", "people_counting"),
        (WITHOUT_CFAR, "IWR1443BOOST", "best"),
        (ISK_CFG.replace("fovCfg", "% fovCfg"), "IWR6843ISK", "best"),
    ],
)
def test_the_chain_is_that_of_the_commands_of_the_file_and_is_said(
    cfg: str, device: str, chain: str
) -> None:
    config = board(cfg, device=device, maps=["points"])
    assert config.cloud.chain == chain
    (said,) = (line for line in config_warnings(config) if "cloud.chain" in line)
    assert said.startswith(f"cloud.chain: {chain}")
    assert ("fovCfg is missing" in said) == ("% fovCfg" in cfg)
    asked = board(cfg, {"chain": chain}, device=device, maps=["points"])
    assert not [line for line in config_warnings(asked) if "cloud.chain" in line]


@pytest.mark.parametrize("chain", ["sdk1", "sdk3", "people_counting"])
def test_a_chain_whose_commands_are_missing_is_refused(chain: str) -> None:
    with pytest.raises(ValueError, match=r"should be people_tracking or best"):
        board(ISK_CFG, {"chain": chain}, device="IWR6843ISK")
    lacking = ISK_CFG.replace("antPhaseRot", "% antPhaseRot")
    with pytest.raises(ValueError, match=r"antPhaseRot is missing; a line that would do"):
        board(lacking, {"chain": "board"}, device="IWR6843ISK")


def test_the_short_fine_motion_of_other_firmware_is_said() -> None:
    short = ISK_CFG.replace("fineMotionCfg -1 0", "fineMotionCfg -1 1")
    said = [line for line in config_warnings(board(short, device="IWR6843ISK")) if "fine" in line]
    assert said == ["radar.cfg: fineMotionCfg: what is set there is not simulated"]


@pytest.mark.parametrize(
    ("written", "wrong", "words"),
    [
        ("Cfg -1 0.75 0.0010 1 0", "Cfg -1 0.75 0.0010 0 0", "detectionMethod = 0: should be 1"),
        ("Cfg -1 0.75 0.0010 1 0", "Cfg -1 0.75 0.0010 2 0", "should be 7 with dynamicRangeAngle"),
        ("-1 4 4 2 2 8 12", "-1 4 4 2 2 80 12", "searchWinSizeRange = 80: should be less"),
        ("-1 4 4 2 2 8 12", "-1 4 4 2 2 8 120", "searchWinSizeAngle = 120: should be less"),
        ("antPhaseRot 1 1", "antPhaseRot 0 1", "should be 1 or -1 each"),
        ("antGeometry1 -1", "antGeometry1", "11 numbers: should be 12, one a virtual channel"),
        ("staticRangeAngleCfg -1 0", "staticRangeAngleCfg -1 2", "staticProcEnabled = 2: should"),
    ],
)
def test_wrong_numbers_of_people_tracking_are_refused(written: str, wrong: str, words: str) -> None:
    assert written in ISK_CFG
    with pytest.raises(ValueError, match=words):
        board(ISK_CFG.replace(written, wrong), device="IWR6843ISK")


def test_a_box_of_the_room_is_kept_to_on_demand() -> None:
    with pytest.raises(ValueError, match=r"radar\.cfg has no boundaryBox"):
        board(CFG, cloud={"boundary_box": True})
    lines = f"{CFG}boundaryBox -1 2 0.5 6 0 2\n"
    assert not board(lines).cloud.boundary_box
    config = board(lines, cloud={"boundary_box": True})
    assert config.cloud.boundary_box
    assert config.radar.header.box == RoomBox((0.5, 6), (-2, 1), (0, 2))


TOGETHER = """
channelCfg 15 7 0
adcCfg 2 1
bpmCfg -1 1 0 1
profileCfg 0 60.75 30 25 59.1 0 0 54.71 1 96 2950 2 1 36
chirpCfg 0 1 0 0 0 0 0 5
frameCfg 0 1 48 0 55 1 0
cfarCfg -1 0 2 8 4 3 0 15 1
"""
THREE = TOGETHER.replace("frameCfg 0 1", "chirpCfg 1 1 0 0 0 0 0 2\nframeCfg 0 2").replace(
    "chirpCfg 0 1 ", "chirpCfg 0 2 "
)
THREE = THREE.replace("bpmCfg -1 1 0 1", "bpmCfg -1 1 0 2")


def test_the_out_of_box_demo_takes_two_chirps_of_two_transmitters() -> None:
    """TX1 + TX3 on a 6843; three transmitters with BPM it refuses, and so do we for its chain."""
    assert board(TOGETHER, device="IWR6843ISK", maps=["points"]).cloud.chain == "sdk3"
    for text, words in (
        (THREE, "with the masks 5 2 5 (chirpCfg txEnable): the out-of-box firmware takes two ch"),
        (TOGETHER.replace("0 0 0 0 5", "0 0 0 0 3"), "the out-of-box firmware takes the mask 5 "),
    ):
        for chain in ("board", "sdk3"):
            with pytest.raises(ValueError, match="radar") as caught:
                board(text, {"chain": chain}, device="IWR6843ISK", maps=["points"])
            assert words in str(caught.value)
        config = board(text, device="IWR6843ISK", maps=["points"])
        assert config.cloud.chain == "best"
        (said,) = (line for line in config_warnings(config) if "cloud.chain: best" in line)
        assert words in said


def test_what_people_counting_of_a_6843_lacks_is_said() -> None:
    newer = COUNTING.replace("77 30 7", "60.25 30 7")
    for chain in ({}, {"chain": "board"}, {"chain": "people_counting"}):
        said = config_warnings(board(newer, chain, device="IWR6843ISK", maps=["points"]))
        assert len([line for line in said if "Doppler CFAR of an IWR6843" in line]) == 1
        said = config_warnings(board(COUNTING, chain, device="IWR1642BOOST", maps=["points"]))
        assert not [line for line in said if "Doppler CFAR" in line]
