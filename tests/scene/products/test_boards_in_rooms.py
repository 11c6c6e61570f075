"""Boards in rooms: ways by faces share what they have in common, and the fast sum its tolerance."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.slow import slow

from radhar_cli.config.data_set import Config
from radhar_cli.echo.board_cube import combine_transmitters, exact_cube, fast_cube, mean_power
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.scene.paths import Link, make_path_sources, sum_of_paths
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import Scene, nominal_scene

FILES = Path(__file__).resolve().parents[2] / "radar" / "cfg"
FACES = {
    "floor": "concrete", "ceiling": "wood", "left": "plasterboard", "right": "metal",
    "front": "brick", "back": "concrete",
}  # fmt: skip
BOX = {"x": [-1, 6], "y": [-2.5, 2.5], "height": 2.6}
ROOM = {"room": {"box_m": BOX, "faces": FACES}}
TWICE = {"room": {"box_m": BOX, "faces": {"floor": "concrete", "left": "metal"}, "order": 2}}
FLOOR = {"room": {"faces": {"floor": "concrete"}}}
SECOND = {"people": [{"activity": "punching", "motion": {"range_m": 2.5, "cross_range_m": 0.2}}]}
WALL = {"wall": {"center_m": [1.0, 0, 1.3], "size_m": [0.1, 5, 2.6]}}
TDM = """
channelCfg 15 7 0
adcCfg 2 1
profileCfg 0 60.75 30.00 25.00 59.10 394758 0 54.71 1 96 2950.00 2 1 36
chirpCfg 0 0 0 0 0 0 0 1
chirpCfg 1 1 0 0 0 0 0 2
chirpCfg 2 2 0 0 0 0 0 4
frameCfg 0 2 48 0 55.00 1 0
"""
REAL = """
channelCfg 7 3 0
chirpComnCfg 15 5 0 128 1 34 3
chirpTimingCfg 6 26 1 47.95 60
frameCfg 2 0 600 64 200 0
"""
BOARDS = {
    "TDM": ("IWR6843ISK", TDM),
    "BPM": ("IWR6843ISK", (FILES / "people_isk_bpm.cfg").read_text()),
    "real": ("IWRL6432BOOST", REAL),
}
CASES = [
    ("surfaces", "TDM", ROOM),
    ("segments", "TDM", ROOM),
    ("points", "TDM", ROOM),
    ("surfaces", "BPM", ROOM),
    ("segments", "real", ROOM),
    ("points", "BPM", TWICE),
    ("surfaces", "TDM", TWICE),
    ("segments", "TDM", TWICE),
    ("surfaces", "TDM", FLOOR | SECOND),
    ("segments", "BPM", FLOOR | SECOND),
    ("segments", "TDM", WALL),
]
FAST = [CASES[number] for number in (4, 5, 8, 10)]  # each body, each board, each surrounding
SLOW = slow(one for one in CASES if one not in FAST)


def scene_of(body: str, board: str, more: dict[str, Any]) -> Scene:
    device, cfg = BOARDS[board]
    document = {
        "radar": {"device": device, "cfg": cfg, "position_m": [0, 0, 1.5]},
        "motion": {"range_m": 3.5, "angle_deg": 180},
        "activities": ["walking"],
        "duration_s": 0.4,
        "snr_db": None,
        "body": {"scatterers": body, "points_per_segment": 3},
    }
    return nominal_scene(Config.model_validate(document | more), activity_named("walking"))


@pytest.mark.parametrize(
    ("body", "board", "more"), FAST + slow(one for one in CASES if one not in FAST)
)
def test_the_stated_error_is_a_bound_over_all_channels(
    body: str, board: str, more: dict[str, Any]
) -> None:
    made = record(scene_of(body, board, more), ["channels", "board"])
    cube, power, stated = fast_cube(made["channels"], made["board"], -80)
    exact, exact_power = exact_cube(made["channels"], made["board"])
    error = 20 * np.log10(np.linalg.norm(cube - exact) / np.linalg.norm(exact))
    assert error <= stated <= -86
    assert power == pytest.approx(exact_power, rel=1e-6)
    assert mean_power(made["channels"], made["board"]) == pytest.approx(exact_power, rel=1e-6)


@pytest.mark.every(3)
@pytest.mark.parametrize(("body", "board", "more"), CASES)
def test_what_channels_share_is_what_each_has_alone(
    body: str, board: str, more: dict[str, Any]
) -> None:
    """Paths of the channels, asked in turn for the same times, and of each on its own."""
    scene = scene_of(body, board, more)
    made = record(scene, ["channels", "board", "motions", "wall"])
    board_, motions = made["board"], made["motions"]
    first = board_.antennas(*board_.pairs[0])
    t = 0.1 + board_.loop_s * np.arange(5.0)
    alone = [
        sum_of_paths(
            make_path_sources(
                scene,
                motions,
                Link(board_.antennas(k, r), made["wall"], board_.path_waveform, first),
            )
        )
        for k, r in board_.pairs
    ]
    for shared, own in zip(made["channels"], combine_transmitters(alone, board_), strict=True):
        paths, expected = shared(t), own(t)
        np.testing.assert_array_equal(paths.delay, expected.delay)
        np.testing.assert_array_equal(paths.amplitude, expected.amplitude)
