"""Count the points of `cloud.chain: best` on and off a walker, before every radar with an array.

python scripts/points_on_a_walker.py [--radar NAME ...] [--noise NAME ...] [--seed 1]

A person walks to each radar of `radhar config init --radar list` that has an array and frames, for
a second about 2, 4 and 6 m. Cells are points a frame within 0.3 m of a bone of the skeleton + all
others. The noise is that of the radar, none, or an SNR of a raw sample of 20, 60 or 120 dB.
"""

import argparse
from collections.abc import Iterator
from typing import Any

import numpy as np
from draw_radars import load_radar

from radhar_cli.config.documents import RADARS, WRITTEN_RADARS
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.motion.skeleton import PARENTS
from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.points import Cloud
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import Scene, draw_scene

NEAR_M, SPEED_MPS, SECONDS = 0.3, 1.2, 1.0
RANGES_M = 2.0, 4.0, 6.0
NOISES: dict[str, dict[str, Any]] = {
    "default": {},
    "none": {"snr_db": None, "receiver": {"noise_figure_db": None}},
    "20 dB": {"snr_db": 20},
    "60 dB": {"snr_db": 60},
    "120 dB": {"snr_db": 120},
}


def radars_with_clouds() -> list[str]:
    """Built-in radars that have frames and an array."""
    names = (*RADARS, *WRITTEN_RADARS)
    return [name for name in names if isinstance(load_radar(name).radar, ArrayRadar)]


def walk(name: str, range_m: float, seed: int, noise: str) -> Scene:
    """Draw the scene of a walker who is at a range in its middle."""
    config = load_radar(name)
    given = NOISES[noise]
    receiver = config.model_dump(exclude_unset=True).get("receiver", {})
    walker = {
        "seed": seed,
        "activities": ["walking"],
        "duration_s": SECONDS,
        "motion": {
            "range_m": range_m + SPEED_MPS * SECONDS / 2,
            "angle_deg": 180,
            "cross_range_m": 0.3,
            "walking": {"speed_mps": SPEED_MPS},
        },
        "subject": {"height_m": 1.75},
        "body": {"scatterers": "surfaces"},
        "timing": {"visible": 1},
        "on_invalid": "keep",
        "cloud": {"chain": "best"},
        "maps": ["points"],
    }
    more = given | ({"receiver": receiver | given["receiver"]} if "receiver" in given else {})
    config = load_radar(name, walker | more)
    return draw_scene(config, config.chosen_activities[0], 0)


def clouds_of_walk(
    name: str, range_m: float, seed: int, noises: list[str]
) -> Iterator[tuple[Cloud, Float]]:
    """Simulate a walker once, and yield the cloud of each noise.

    Yields:
        Cloud, and joints [frame, joint, 3] in the radar's axes, m.
    """
    made: dict[str, Any] = {}
    for noise in noises:
        scene = walk(name, range_m, seed, noise)
        results = record(scene, ["echo", "cloud", "skeleton"], **made)
        made = {"echo": results["echo"]}
        yield results["cloud"], results["skeleton"][:, 0]


def distance_to_bones(points: Float, joints: Float) -> Float:
    """Distances [n] of points [n, 3] to the nearest bone of joints [13, 3], m."""
    pairs = [(joint, parent) for joint, parent in enumerate(PARENTS) if parent is not None]
    start, end = (joints[list(ends)] for ends in zip(*pairs, strict=True))
    way = end - start
    apart = points[:, None] - start
    share = np.clip((apart * way).sum(axis=2) / (way**2).sum(axis=1), 0, 1)
    distance: Float = np.linalg.norm(apart - share[..., None] * way, axis=2).min(axis=1)
    return distance


def count_points(cloud: Cloud, joints: Float) -> tuple[float, float]:
    """Points a frame within NEAR_M of a bone, and others; joints are [frame, joint, 3]."""
    near = 0
    for first, stop, skeleton in zip(cloud.start[:-1], cloud.start[1:], joints, strict=True):
        points = cloud.points[first:stop, :3].astype(float)
        near += int((distance_to_bones(points, skeleton) < NEAR_M).sum())
    frames = len(joints)
    return near / frames, (len(cloud.points) - near) / frames


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--radar", nargs="+", default=radars_with_clouds())
    parser.add_argument("--noise", nargs="+", choices=NOISES, default=["default"])
    given = parser.parse_args()
    heads = [f"{noise}, {r:g} m" for r in RANGES_M for noise in given.noise]
    print(f"| radar | {' | '.join(heads)} |\n| --- {'| --- ' * len(heads)}|")
    for name in given.radar:
        cells = []
        for range_m in RANGES_M:
            for cloud, joints in clouds_of_walk(name, range_m, given.seed, given.noise):
                near, far = count_points(cloud, joints)
                cells.append(f"{near:.1f} + {far:.1f}")
        print(f"| `{name}` | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
