"""`room.faces` and `radar.beam`: people seen again by way of walls, floor and ceiling."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from helpers.boards import CFG

from radhar_cli.config import load_config
from radhar_cli.config.data_set import Config
from radhar_cli.dataset.scene_fields import fields
from radhar_cli.errors import ConfigError, SceneError
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.checks.flags import Flags
from radhar_cli.scene.checks.validity import check_scene
from radhar_cli.scene.checks.warnings import config_warnings
from radhar_cli.scene.products.run import record
from radhar_cli.scene.radar import antennas_of
from radhar_cli.scene.scene import draw_scene, nominal_scene
from radhar_cli.scene.single.scene_file import write_all
from radhar_cli.scene.single.simulate import simulate

C = 299792458.0
PLACE = {"tx_m": [0.4, -0.1, 1.1], "rx_m": [0.4, 0.1, 1.1]}
RADAR = {"carrier_hz": 10e9, "bandwidth_hz": 1e9, "prf_hz": 500, "adc_rate_hz": 4e6, **PLACE}
BOX = {"x": [0, 7], "y": [-2.5, 2.5], "height": 2.8}
FACES = {"floor": "concrete", "left": {"eps_r": 5, "loss_tangent": 0.01}, "back": "metal"}
WALKING = activity_named("walking")


def config(**more: Any) -> Config:
    motion = {"range_m": 5, "angle_deg": 180, "cross_range_m": 0.5, "walking": {"speed_mps": 1.0}}
    document = {"radar": RADAR, "activities": ["walking"], "duration_s": 2, "motion": motion}
    return Config.model_validate(document | {"room": {"box_m": BOX, "faces": FACES}} | more)


@pytest.mark.parametrize(
    "more",
    [
        {"body": {"scatterers": "points"}, "room": {"box_m": BOX, "faces": FACES, "order": 2}},
        {"body": {"scatterers": "segments", "points_per_segment": 3}},
        {"wall": {"center_m": [1.0, 0, 1.4], "size_m": [0.2, 5, 2.8]}},
        {"radar": RADAR | {"beam": {"azimuth_deg": 70, "elevation_deg": 30, "tilt_deg": 5}}},
        {"people": [{"activity": "punching", "motion": {"range_m": 2.5, "cross_range_m": -1.5}}]},
    ],
    ids=["order 2", "segments", "wall", "beam", "people"],
)
def test_the_fast_echo_keeps_its_tolerance(more: dict[str, Any]) -> None:
    scene = nominal_scene(config(snr_db=None, duration_s=1, **more), WALKING)
    fast = record(scene, ["signal", "accuracy"])
    exact = record(
        nominal_scene(config(snr_db=None, duration_s=1, engine={"kind": "cube"}, **more), WALKING),
        ["signal"],
    )["signal"].x
    error = np.linalg.norm(fast["signal"].x - exact) / np.linalg.norm(exact)
    assert 20 * np.log10(error) < -80
    assert fast["accuracy"].error_db < -85


def test_every_path_is_in_the_truth(tmp_path: Path) -> None:
    scene = simulate(config(body={"scatterers": "points"}), nominal=True, maps=("stft",))
    write_all(scene, tmp_path)
    with h5py.File(tmp_path / "scene.h5") as file:
        paths = {name: values[:] for name, values in file["truth/paths"].items()}
        positions, time = file["truth/positions"][:], file["truth/time"][:]
    kinds = paths["kind"].astype(str)
    assert list(dict.fromkeys(kinds)) == [
        "-/-", "-/back", "-/left", "-/floor", "back/-", "left/-", "floor/-"
    ]  # fmt: skip
    assert paths["delay"].shape == (7 * 13, 256)
    np.testing.assert_array_equal(paths["bounces"], (kinds != "-/-").astype(int))
    np.testing.assert_array_equal(paths["scatterer"], np.tile(np.arange(13), 7))
    assert not paths["person"].any()
    at = np.searchsorted(time, paths["time"][100])
    straight = np.linalg.norm(positions[at] - RADAR["tx_m"], axis=1)
    floor = np.linalg.norm(positions[at] * [1, 1, -1] - RADAR["rx_m"], axis=1)
    found = paths["delay"][kinds == "-/floor", 100] * C
    np.testing.assert_allclose(found, straight + floor, atol=1e-9)


def test_the_snr_refers_to_the_straight_paths() -> None:
    alone, room = (
        record(nominal_scene(config(snr_db=10, **more), WALKING), ["signal", "noise"])["noise"]
        for more in ({"room": {}}, {})
    )
    assert room.sigma == pytest.approx(alone.sigma)


def test_a_ghost_trails_in_range_at_another_doppler() -> None:
    """By way of metal behind and back: farther than the person, and receding as they approach."""
    room, far = {"box_m": BOX, "faces": {"back": "metal"}, "order": 2}, {"range_limits_m": [0, 16]}
    shown = [
        record(nominal_scene(config(snr_db=None, room=one, image=far), WALKING), ["rtm", "stft"])
        for one in ({}, room)
    ]
    power = [one["rtm"].power[one["rtm"].rows.values > 6.2].sum() for one in shown]
    assert power[1] > 5 * power[0]
    away = [one["stft"].power[one["stft"].rows.values < -15].sum() for one in shown]
    assert away[1] > 10 * away[0]


def test_a_beam_takes_the_sides() -> None:
    beam = {"azimuth_deg": 20, "elevation_deg": 20, "pan_deg": 90}
    sources = [
        record(nominal_scene(config(room={}, radar=RADAR | more), WALKING), ["paths"])["paths"]
        for more in ({}, {"beam": beam})
    ]
    wide, aside = (source(np.zeros(1)).amplitude for source in sources)
    np.testing.assert_allclose(20 * np.log10(aside / wide), -60, atol=1e-9)


def test_who_leaves_the_room_is_warned_of() -> None:
    near = {"range_m": 5, "angle_deg": 180, "cross_range_m": 2.4, "walking": {"speed_mps": 1.0}}
    inside, outside = (nominal_scene(config(**more), WALKING) for more in ({}, {"motion": near}))
    assert Flags.WALL not in check_scene(inside).flags
    assert Flags.WALL in check_scene(outside).flags


def test_who_cannot_stay_in_the_room_is_told_where_they_were(tmp_path: Path) -> None:
    near = {"range_m": 5, "angle_deg": 180, "cross_range_m": 2.4, "walking": {"speed_mps": 1.0}}
    for whose, more in (("", {"motion": near}), ("people.0.", {"people": [{"motion": near}]})):
        drawn = rf"{whose}motion.range_m = 5, {whose}motion.cross_range_m = 2.4"
        with pytest.raises(SceneError, match=drawn):
            draw_valid_scene(config(on_invalid="error", **more), WALKING, 0)


def test_ghosts_beyond_the_half_band_are_warned_of() -> None:
    """By way of the wall at 7 m a person at 5 m is seen at up to 9 m."""
    told = "echoes by way of room.faces come from up to"
    for rate, order, warned in (
        (4e6, 1, False),
        (2e6, 1, True),
        (2.4e6, 1, False),
        (2.4e6, 2, True),
    ):
        room = {"box_m": BOX, "faces": {"back": "metal"}, "order": order}
        given = config(radar=RADAR | {"adc_rate_hz": rate}, room=room)
        assert any(told in line for line in config_warnings(given)) == warned, (rate, order)


def test_rooms_are_drawn() -> None:
    box = {**BOX, "x": [0, {"uniform": [6, 8]}]}
    wet = {"floor": {"eps_r": {"uniform": [4, 9]}}}
    drawn = config(room={"box_m": box, "faces": wet})
    found = {draw_scene(drawn, WALKING, index).config.room.model_dump_json() for index in range(3)}
    assert len(found) == 3
    names = [field.name for field in fields(drawn)]
    assert len(set(names)) == len(names)
    assert {"room_x_from", "room_x_to", "room_height", "floor_eps_r"} <= set(names)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("room: {faces: {left: brick}}", r"room.box_m = null: should say where left of room.faces"),
        ("room: {faces: {left: bricks}}", r"room.faces.left.*bricks"),
        (
            "room: {box_m: {x: [3, 1], y: [-2, 2], height: 3}, faces: {left: brick}}",
            r"box_m.x.*low",
        ),
        ("room: {faces: {floor: wood}, back_wall_m: 40}", r"back_wall_m.*null with room.faces"),
        ("room: {faces: {floor: wood}, order: 3}", r"room.order"),
        (
            "room: {box_m: {x: [2, 9], y: [-2, 2], height: 3}, faces: {left: wood}}",
            r"radar.tx_m.*have a wall: to see through",
        ),
        (
            "room: {box_m: {x: [0, 9], y: [-2, 2], height: 1.2}, faces: {left: wood}}",
            r"radar.tx_m.*inside room.box_m",
        ),
        ("room: {faces: {floor: wood}}\nradar: {rx_m: [0, 0, -1]}", r"radar.rx_m.*above the floor"),
        (
            "room: {box_m: {x: [0, 7]}, faces: {left: wood}}\nmotion: {range_m: 8}",
            r"motion.range_m = 8.0: should be inside room.box_m.x, 0 to 7 m",
        ),
        (
            "room: {box_m: {x: [0, 20]}, faces: {left: wood}}\nmotion: {range_m: 8}\n"
            "people: [{motion: {range_m: 8, cross_range_m: {uniform: [3, 4]}}}]",
            r"people.0.motion.cross_range_m = .*inside room.box_m.y, -2.5 to 2.5 m",
        ),
        (
            "room: {box_m: {x: [0, 20], height: 1.6}, faces: {left: wood}}\n"
            "subject: {height_m: 1.8}",
            r"room.box_m.height = 1.6: should be above people, 1.8 m tall",
        ),
        ("room: {faces: {left: {eps_r: 0.5}}}", r"room.faces.left.eps_r = 0.5: should be 1"),
        ("radar: {beam: {azimuth_deg: 0}}", r"radar.beam.azimuth_deg"),
    ],
)
def test_what_does_not_go_together(text: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "wrong.yaml").write_text(text)
    with pytest.raises(ConfigError, match=words):
        load_config(tmp_path / "wrong.yaml")


def test_a_beam_is_of_each_antenna() -> None:
    """Two antennas far apart see a point from different sides."""
    apart = {"tx_m": [0, -2, 1.5], "rx_m": [0, 2, 1.5]}
    beam = {"azimuth_deg": 40, "elevation_deg": 40}
    at = np.array([4.0, 2, 1.5])[:, None, None]
    scene = nominal_scene(config(room={}, radar=RADAR | apart | {"beam": beam}), WALKING)
    field = antennas_of(scene).field(at)
    assert field is not None
    assert 20 * np.log10(field.item()) == pytest.approx(-12 * (45 / 40) ** 2, abs=1e-9)


def test_points_of_side_walls_say_so_too(tmp_path: Path) -> None:
    (tmp_path / "board.cfg").write_text(CFG)
    (tmp_path / "room.yaml").write_text(
        "radar: {device: IWR1443BOOST, cfg: board.cfg, position_m: [0.1, 0, 1]}\n"
        "activities: [punching]\nmotion: {range_m: 1.6}\nduration_s: 0.6\nmaps: [points]\n"
        "body: {scatterers: surfaces}\ncloud: {chain: board}\nsamples_per_class: 1\n"
        "room: {box_m: {x: [0, 4], y: [-3, 0.9], height: 3}, faces: {left: metal}}\n"
    )
    scene = nominal_scene(load_config(tmp_path / "room.yaml"), activity_named("punching"))
    found = record(scene, ["cloud", "points_kind"])
    aside = found["cloud"].points[:, 1] > 0.7  # to the left, where nobody stands
    assert aside.sum() > 5
    assert (found["points_kind"][aside] > 0).mean() > 0.3


def test_points_of_ghosts_say_so(tmp_path: Path) -> None:
    """Of a metal wall close behind: points beyond the person are by way of it."""
    (tmp_path / "board.cfg").write_text(CFG)
    (tmp_path / "room.yaml").write_text(
        "radar: {device: IWR1443BOOST, cfg: board.cfg, position_m: [0.1, 0, 1]}\n"
        "activities: [punching]\nmotion: {range_m: 1.6}\nduration_s: 0.6\nmaps: [points]\n"
        "body: {scatterers: surfaces}\ncloud: {chain: board}\nsamples_per_class: 1\n"
        "room: {box_m: {x: [0, 2.2], y: [-3, 3], height: 3}, faces: {back: metal}}\n"
    )
    scene = nominal_scene(load_config(tmp_path / "room.yaml"), activity_named("punching"))
    found = record(scene, ["cloud", "points_person", "points_kind"])
    far = found["cloud"].points[:, 0] > 2.0
    assert far.any()
    assert set(found["points_kind"][far]) <= {-1, 1, 2}
    assert (found["points_kind"][far] > 0).mean() > 0.5
    assert (found["points_kind"][~far] == 0).mean() > 0.9
    assert set(found["points_person"][found["points_kind"] >= 0]) == {0}
