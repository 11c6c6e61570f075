"""`points_kind`: by way of which faces each point of a board was seen."""

from dataclasses import replace

import numpy as np
import pytest
from helpers.boards import MARS, Straight

from radhar_cli.config.data_set import Config
from radhar_cli.echo.board_cube import exact_cube
from radhar_cli.echo.receiver.noise import circular_gaussian
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.best_points import best_points
from radhar_cli.radar.board import DEVICES, Board
from radhar_cli.radar.room import Leg, names_of
from radhar_cli.scene.products.board_people import Skeletons, assign_points
from radhar_cli.scene.room import ways_of
from radhar_cli.scene.scene import Scene, nominal_scene

ISK = replace(
    MARS, array=DEVICES["IWR6843ISK"].array, masks=(1, 2, 4), frames=1, position=(0.1, 0.0, 1.0)
)


def _scene_by_wall(wall_m: float) -> Scene:
    room = {"box_m": {"x": [0, 9], "y": [-6, wall_m], "height": 3}, "faces": {"left": "metal"}}
    radar = {"carrier_hz": 77e9, "bandwidth_hz": 3e9, "polarisation": "horizontal"}
    config = Config.model_validate(
        {"radar": radar, "activities": ["walking"], "room": room | {"order": 2}}
    )
    return nominal_scene(config, activity_named("walking"))


def _echo(board: Board, p: Float, v: Float, legs: tuple[Leg, Leg]) -> Complex:
    places, speeds = p[:, None], v[:, None]
    channels = [
        Straight(places, speeds, np.ones(1), board.antennas(k, r).by_way(*legs))
        for k, r in board.pairs
    ]
    return exact_cube(channels, board)[0]


@pytest.mark.parametrize("device", ["IWR6843ISK", "IWR1443BOOST", "IWR6843AOP"])
def test_points_that_touch_a_side_wall_once_say_so(device: str) -> None:
    """Their direction is neither the scatterer's nor the image's: most lobes are elsewhere."""
    rng, board = np.random.default_rng(4), replace(ISK, array=DEVICES[device].array)
    count, right, far = 0, 0, 0
    for _ in range(12):
        wall, ahead = rng.uniform(0.8, 2.5), rng.uniform(1.5, 2.5)
        p = np.array([ahead, wall - rng.uniform(0.6, 1.2), 1.0])
        scene, v = _scene_by_wall(wall), np.array([rng.uniform(0.4, 0.9), 0.2, 0])
        ways = ways_of(scene)
        once = [legs for legs in ways if names_of(legs) in ("left/-", "-/left")]
        echo = sum(_echo(board, p, v, legs) for legs in once)
        noise = circular_gaussian(rng, echo.shape) * np.sqrt(np.mean(np.abs(echo) ** 2) / 10)
        cloud = best_points(echo + noise, board, True, 1e-7)
        seen = board.aim.to_radar(p + v * board.middles[0]).astype(np.float32)
        joint = seen.reshape(1, 1, 1, 3)
        owners = assign_points(cloud, Skeletons(joint, joint, ("torso",)), board, scene)
        count += len(owners.kind)
        right += sum(ways[kind - 1] in once for kind in owners.kind[owners.kind > 0])
        image = seen * [1, -1, 1] + [0, 2 * wall, 0]
        places = cloud.points[:, :3] / np.linalg.norm(cloud.points[:, :3], axis=1)[:, None]
        true = np.array([seen, image]) / np.linalg.norm([seen, image], axis=1)[:, None]
        far += int((np.abs(places[:, None] - true).max(axis=2).min(axis=1) > 0.2).sum())
        if len(owners.person):
            assert set(owners.person[owners.kind > 0]) <= {0}
    assert count >= 12
    assert far > 0.1 * count  # so that the lobes are needed
    assert right >= 0.9 * count


def test_the_way_is_that_whose_echo_is_stronger_in_the_lobe() -> None:
    """Receivers of an ISK are a row: by left/- a scatterer is nearer to its own direction.

    Within a quarter: lobes of transmitters four half wavelengths apart repeat in steps of 0.5.
    """
    scene, board = _scene_by_wall(1.5), ISK
    ways = ways_of(scene)
    joint = np.array([2.0, 0.2, 0.0], np.float32).reshape(1, 1, 1, 3)
    p, image = np.array([2.1, 0.2, 1.0]), np.array([2.0, 2.8, 0.0])
    for name in ("left/-", "-/left"):
        legs = next(way for way in ways if names_of(way) == name)
        echo = _echo(board, p, np.array([0.5, 0, 0]), legs)
        cloud = best_points(echo, board, True, 1e-7)
        strongest = cloud.points[[cloud.points[:, 4].argmax()]].copy()
        sine = {"left/-": 0.2 / 2, "-/left": 2.8 / np.linalg.norm(image)}[name]
        seen = strongest[0, 1] / np.linalg.norm(strongest[0, :3])
        assert abs((seen - sine + 1) % 2 - 1) < 0.26
        one = cloud._replace(points=strongest, start=np.array([0, 1]))
        kind = assign_points(one, Skeletons(joint, joint, ("torso",)), board, scene).kind
        assert [names_of(ways[k - 1]) for k in kind] == [name]
