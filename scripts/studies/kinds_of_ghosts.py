"""How often `points_kind` names the way by which a point's echo came, beside a wall.

python scripts/studies/kinds_of_ghosts.py [--scenes 40] [--seed 1]

Before an IWR6843ISK with TI's profile of 3D people tracking somebody walks or punches beside a
metal wall. The way that a point is of is known from the echoes by each way alone: the one with the
most power in the point's cell of range and Doppler, if it exceeds the next by 6 dB. Both ways that
touch the wall once have the same ranges and speeds: either of them is right.
"""

import argparse
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from points_of_scatterers import ISK, chains

from radhar_cli.activities.activity import activity_named
from radhar_cli.assembly.bodies import Link, make_path_sources, sum_of_paths
from radhar_cli.assembly.room import kinds_of
from radhar_cli.config.data_set import Config
from radhar_cli.config.documents import cfg_text
from radhar_cli.echo.board_cube import combine_transmitters, fast_cube
from radhar_cli.motion.protocol import Motion, ScattererSubset, cache_motion
from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.processing.frame_maps import spectra
from radhar_cli.processing.points import Cloud
from radhar_cli.products.board_people import assign_points, locate_skeletons
from radhar_cli.products.run import record
from radhar_cli.radar.board import Board
from radhar_cli.radar.room import names_of
from radhar_cli.scene import Scene, nominal_scene

WAYS = ("direct", "wall once", "wall twice")
CLEAR = 10**0.6  # power of the way of a cell over that of any other
CHAINS = ("best, ISK", "sdk3, ISK", "people_tracking, ISK")
FRAMES = 3
SNR_DB = 0.0, 20.0  # of a sample


def draw_scene_by_wall(rng: np.random.Generator, scatterers: str) -> Scene:
    """Draw somebody beside a wall.

    Args:
        rng: Where the geometry comes from.
        scatterers: `body.scatterers`.
    """
    wall = rng.uniform(0.8, 2.5)
    while True:
        r, angle = rng.uniform(1.5, 5.0), np.radians(rng.uniform(-40, 40))
        ahead, left = r * np.cos(angle), r * np.sin(angle)
        if left < wall - 0.5:
            break
    activity = str(rng.choice(["walking", "punching"]))
    motion = {"range_m": ahead, "cross_range_m": left, "angle_deg": rng.uniform(-180, 180)}
    document = {
        "radar": {
            "device": "IWR6843ISK",
            "cfg": cfg_text("iwr6843isk", Path(), "radar.cfg"),
            "position_m": [0.1, 0, 1],
        },
        "activities": [activity],
        "duration_s": 1.0,
        "maps": ["points"],
        "body": {"scatterers": scatterers},
        "motion": motion,
        "room": {
            "box_m": {"x": [0, 9], "y": [-6, wall], "height": 3},
            "faces": {"left": "metal"},
            "order": 2,
        },
        "seed": int(rng.integers(1 << 30)),
    }
    return nominal_scene(Config.model_validate(document), activity_named(activity))


def echoes_of_ways(scene: Scene, motions: tuple[Motion, ...], board: Board) -> list[Complex]:
    """Echo [frame, loop, virtual, sample] by each of WAYS."""
    cached = tuple(map(cache_motion, motions))
    first = board.antennas(*board.pairs[0])
    each = []
    for k, r in board.pairs:
        link = Link(board.antennas(k, r), None, board.path_waveform, first)
        each.append(make_path_sources(scene, cached, link))
    echoes = []
    for touches in range(len(WAYS)):
        chosen = [[s for s in sources if _touches(names_of(s.legs)) == touches] for sources in each]
        channels = combine_transmitters([sum_of_paths(sources) for sources in chosen], board)
        echoes.append(fast_cube(channels, board, -80.0)[0])
    return echoes


def _touches(name: str) -> int:
    return name.count("left")


def ways_of_points(cloud: Cloud, echoes: list[Complex], board: Board) -> Index:
    """Number in WAYS of the way that each point is of [N], -1 where several are as strong."""
    frame = np.repeat(np.arange(len(cloud.start) - 1), np.diff(cloud.start))
    ranges = np.linalg.norm(cloud.points[:, :3].astype(float), axis=1)
    r = np.round(ranges / board.range_step).astype(int) % board.n_bins
    d = np.round(cloud.points[:, 3] / board.doppler_step()).astype(int) % board.n_doppler
    powers = []
    for echo in echoes:
        maps = np.concatenate([np.abs(x) ** 2 for _, x in spectra(echo, board, True)]).mean(axis=2)
        powers.append(maps[frame, d, r])
    power: Float = np.array(powers)
    ordered = np.sort(power, axis=0)
    return np.where(ordered[-1] > CLEAR * ordered[-2], power.argmax(axis=0), -1)


def count_kinds(scenes: int, seed: int, scatterers: str) -> Mapping[str, Counter[tuple[int, int]]]:
    """Count points of each chain by (way that they are of, way that `points_kind` names).

    Args:
        scenes: Number of scenes.
        seed: Seed of the geometries.
        scatterers: `body.scatterers`, or torso for one scatterer.
    """
    rng, counts = np.random.default_rng(seed), {name: Counter[tuple[int, int]]() for name in CHAINS}
    for _ in range(scenes):
        scene = draw_scene_by_wall(rng, "points" if scatterers == "torso" else scatterers)
        board = replace(ISK, frames=FRAMES, position=(0.1, 0.0, 1.0))
        motions = record(scene, ["motions"])["motions"]
        moving = motions
        if scatterers == "torso":
            moving = tuple(ScattererSubset(m, (m.names.index("torso"),)) for m in motions)
        echoes = echoes_of_ways(scene, moving, board)
        skeletons = locate_skeletons(scene, motions, board)
        touches = np.array([*map(_touches, kinds_of(scene.config)), -1])
        cube = add_noise(sum(echoes), rng)
        for name in CHAINS:
            cloud = _find(name)(cube, board)
            kinds = touches[assign_points(cloud, skeletons, board, scene).kind]
            true = ways_of_points(cloud, echoes, board)
            counts[name].update(zip(true.tolist(), kinds.tolist(), strict=True))
    return counts


def add_noise(cube: Complex, rng: np.random.Generator) -> Complex:
    """Add noise, some SNR_DB of a sample below a cube."""
    snr = 10 ** (rng.uniform(*SNR_DB) / 10)
    sigma = np.sqrt(np.mean(np.abs(cube) ** 2) / snr / 2)
    noise = rng.standard_normal((*cube.shape, 2)).view(complex)[..., 0]
    return cube + sigma * noise


def _find(name: str) -> Callable[[Complex, Board], Cloud]:
    return chains()[name][1]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=40, help="scenes a row")
    parser.add_argument("--seed", type=int, default=1, help="seed of the geometries")
    arguments = parser.parse_args()
    print("| body | chain | way | points | right | another way | none |")
    print("| --- | --- | --- | ---: | ---: | ---: | ---: |")
    for scatterers in ("torso", "surfaces"):
        counts = count_kinds(arguments.scenes, arguments.seed, scatterers)
        for name, count in counts.items():
            for way, words in enumerate(WAYS):
                of_way = {kind: n for (true, kind), n in count.items() if true == way}
                total = sum(of_way.values())
                right, none = of_way.get(way, 0), of_way.get(-1, 0)
                shares = [
                    f"{100 * n / max(total, 1):.1f} %" for n in (right, total - right - none, none)
                ]
                print(
                    f"| {scatterers} | {name} | {words} | {total} | {' | '.join(shares)} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
