"""What motion and body of a person cost: `python scripts/bench_motion.py [CONFIG] [--rounds N]`.

Processor time of one sample of each class and of the check of its scene, ms: medians over rounds
of the means over the twelve, all three kinds in every round, in a shuffled order.
"""

import argparse
from pathlib import Path
from random import Random
from time import process_time

import numpy as np

from radhar_cli.activity import ACTIVITIES
from radhar_cli.config import load_config
from radhar_cli.pipeline.run import record
from radhar_cli.pipeline.validity import check_scene
from radhar_cli.scene import Scene, draw_scene

CONFIG = Path(__file__).resolve().parents[1] / "configs" / "human" / "free_space_77GHz.yaml"
KINDS = {
    "paper, 13 points": ("motion.model=paper", "body.scatterers=points"),
    "human, 13 points": ("body.scatterers=points",),
    "human, segments": ("body.scatterers=segments",),
}


def main() -> None:
    """Print a table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("config", type=Path, nargs="?", default=CONFIG)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    spent: dict[str, list[tuple[float, float]]] = {kind: [] for kind in KINDS}
    order = Random(0)
    for number in range(options.rounds + 1):  # the first fills caches
        for kind in order.sample([*KINDS], len(KINDS)):
            config = load_config(options.config, KINDS[kind])
            scenes = [draw_scene(config, activity, number) for activity in ACTIVITIES]
            times = sample_and_check(scenes)
            if number:
                spent[kind].append(times)
    print("| motion, body | a sample, ms | its check, ms |\n| --- | --- | --- |")
    for kind, times in spent.items():
        sample, check = np.median(times, axis=0) * 1e3
        print(f"| {kind} | {sample:.1f} | {check:.2f} |")


def sample_and_check(scenes: list[Scene]) -> tuple[float, float]:
    """Means over the scenes, s."""
    begin = process_time()
    for scene in scenes:
        check_scene(scene)
    between = process_time()
    for scene in scenes:
        record(scene, [f"image:{name}" for name in scene.config.maps])
    return (process_time() - between) / len(scenes), (between - begin) / len(scenes)


if __name__ == "__main__":
    main()
