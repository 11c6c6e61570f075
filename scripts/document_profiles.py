"""Write the table of built-in radars, with the points of somebody who walks, into the documents.

    python scripts/document_profiles.py COMMIT [--seeds 5]

Each radar of `radhar config init --radar list` stands 1 m high and level; one person walks to it
from 6.4 m in a room without faces, at the default noise figure of the board. Points are counted in
the frames in which the torso is within 0.3 m of 2, 4 and 6 m, and those within 0.3 m of a joint.
Settings of the profiles were chosen on seeds 1 and 2, and the table has others. It stands in
docs/guide/board_profiles.md, between `<!-- begin profiles -->` and `<!-- end profiles -->`.
"""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from page_parts import replace_part

from radhar_cli.config import Config
from radhar_cli.config.built_in_radars import BuiltInRadar, read_radars
from radhar_cli.config.documents import RADARS
from radhar_cli.numerics.arrays import Float
from radhar_cli.scene.single.simulate import simulate

PAGE = Path(__file__).resolve().parents[1] / "docs/guide/board_profiles.md"
RANGES_M = 2, 4, 6
NEAR_M = 0.3
FIRST_SEED = 3
HEAD = (
    "| name | chain | range: step, to | speed: step, to | frames a second "
    "| points at 2 m | 4 m | 6 m |\n| --- | --- | --- | --- | --- | --- | --- | --- |"
)


def measure_points(radar: BuiltInRadar, seeds: Sequence[int]) -> dict[int, tuple[float, float]]:
    """Count the points of somebody who walks to a radar.

    Args:
        radar: Built-in radar.
        seeds: Seeds of the walks.

    Returns:
        {range, m: (mean points a frame, share of them near a joint, nan without points)}.
    """
    counts: dict[int, list[int]] = {place: [] for place in RANGES_M}
    near: dict[int, list[float]] = {place: [] for place in RANGES_M}
    for seed in seeds:
        for place, distances in _distances_of_walk(radar, seed):
            counts[place].append(len(distances))
            near[place].extend(distances < NEAR_M)
    return {
        place: (
            float(np.mean(counts[place])),
            float(np.mean(near[place])) if near[place] else np.nan,
        )
        for place in RANGES_M
    }


def _distances_of_walk(radar: BuiltInRadar, seed: int) -> Iterator[tuple[int, Float]]:
    """Yield a range (m) and the distances (m) of a frame's points from the nearest joints."""
    document = {
        "seed": seed,
        "radar": {
            "cfg": RADARS[radar.name].read_text(),
            "device": radar.device,
            "position_m": [0, 0, 1],
            "yaw_deg": 0,
            "tilt_deg": 0,
        },
        "activities": ["walking"],
        "duration_s": 5.5,
        "motion": {"range_m": 6.4, "angle_deg": 180},
        "body": {"scatterers": "surfaces"},
        "cloud": {"chain": radar.chain},
        "maps": ["points"],
    }
    frames = simulate(Config.model_validate(document), "walking", maps=("points",)).frames
    cloud, joints = frames["cloud"], frames["skeletons"].positions[:, 0]
    for frame, torso_m in enumerate(np.linalg.norm(joints[:, 0], axis=1)):
        points = cloud.points[cloud.start[frame] : cloud.start[frame + 1], None, :3]
        for place in RANGES_M:
            if abs(torso_m - place) < NEAR_M:
                yield place, np.linalg.norm(points - joints[frame], axis=2).min(axis=1, initial=9)


def table_row(radar: BuiltInRadar, points: dict[int, tuple[float, float]]) -> str:
    """Row of a radar."""
    cells = [
        f"`{radar.name}`",
        radar.chain,
        f"{100 * radar.header.timing.range_step_m:.1f} cm, {radar.header.timing.farthest_m:.1f} m",
        f"{radar.header.timing.doppler_step_mps():.3f}, ±{radar.header.timing.fastest_mps:.1f} m/s",
        f"{radar.frames_per_s:.3g}",
        *(f"{count:.3g}; {share:.2f}".replace("; 0.", "; .") for count, share in points.values()),
    ]
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("commit", help="commit that is measured")
    parser.add_argument("--seeds", type=int, default=5, help="number of walks")
    arguments = parser.parse_args()
    seeds = range(FIRST_SEED, FIRST_SEED + arguments.seeds)
    rows = []
    for radar in read_radars():
        rows.append(table_row(radar, measure_points(radar, seeds)))
        print(rows[-1], flush=True)
    note = (
        f"(`python scripts/document_profiles.py COMMIT --seeds {arguments.seeds}`, at "
        f"{arguments.commit})"
    )
    PAGE.write_text(replace_part(PAGE.read_text(), "profiles", "\n".join((HEAD, *rows, "", note))))


if __name__ == "__main__":
    main()
