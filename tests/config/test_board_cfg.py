"""The .cfg of a board in a config: its pose, its chain, what is said of its commands."""

from pathlib import Path
from typing import Any

import pytest
from helpers.boards import CFG

from radhar_cli.config import Config
from radhar_cli.config.radar import BoardRadar
from radhar_cli.config.starting_file import of_board
from radhar_cli.scene_checks.warnings import config_warnings

TRACKING = f"{CFG}sensorPosition 2 10 15\n"
WITHOUT_CFAR = CFG.replace("cfarCfg 0 2 8 4 3 0 1130\n", "")


def board(cfg: str, cloud: dict[str, Any] | None = None, **radar: Any) -> Config:
    """Config of an IWR1443BOOST; its radar's other keys by name."""
    keys = {"cfg": cfg, "device": "IWR1443BOOST", **radar}
    return Config.model_validate(
        {"radar": keys, "duration_s": 1.0, "maps": ["rtm"], "cloud": cloud or {}}
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
    with pytest.raises(ValueError, match=r"radar\.cfg has no cfarCfg"):
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
    ],
)
def test_a_started_config_has_the_likely_device(lines: str, device: str, tmp_path: Path) -> None:
    (tmp_path / "board.cfg").write_text(f"{WITHOUT_CFAR}{lines}\n")
    assert f"device: {device}," in of_board(str(tmp_path / "board.cfg"), tmp_path)


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
