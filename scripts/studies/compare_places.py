"""Whether where people are tells what they do: Kolmogorov-Smirnov distances between classes.

    python scripts/studies/compare_places.py [--config configs/quickstart.yaml] [--count 300]

draws scenes, without echoes, and compares the range of the torso of every two classes at a random
instant, at 0 s, in the middle, at the end, and what is drawn. A pair differs at 5 %, by Bonferroni.
"""

import argparse
from itertools import combinations
from pathlib import Path

import numpy as np
from scipy.stats import ks_2samp
from shared import ROOT

from radhar_cli.config import load_config
from radhar_cli.numerics.arrays import Float
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.motion import moving

POINTS = 61  # instants of a recording
QUANTITIES = (
    *("range at a random instant", "range at 0 s", "range in the middle", "range at the end"),
    *("place", "instant", "heading", "onset"),
)


def main() -> None:
    """Print how many pairs of classes differ, by quantity."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--config", type=Path, default=ROOT / "configs/quickstart.yaml")
    parser.add_argument("--count", type=int, default=300)
    asked = parser.parse_args()
    config, rng = load_config(asked.config), np.random.default_rng(5)
    tables, redrawn = dict[str, Float](), 0
    for activity in config.chosen_activities:
        rows = []
        for index in range(asked.count):
            scene, _ = draw_valid_scene(config, activity, index)
            redrawn += scene.attempt
            person = scene.people[0]
            torso = moving(person).torso(np.linspace(0, scene.seconds, POINTS))[:2, 0]
            r, place = np.hypot(*torso), person.motion.place
            ranges = r[rng.integers(POINTS)], r[0], r[POINTS // 2], r[-1]
            drawn = place.range_m, place.instant, person.motion.angle_deg, person.timing.onset
            rows.append((*ranges, *drawn))
        tables[activity.slug] = np.array(rows)
    pairs = list(combinations(tables, 2))
    print(f"{len(tables)} classes of {asked.count} scenes, {redrawn} drawn again")
    for column, name in enumerate(QUANTITIES):
        tests = [ks_2samp(tables[a][:, column], tables[b][:, column]) for a, b in pairs]
        differ = sum(test.pvalue * len(pairs) < 0.05 for test in tests)
        at_most, pair = max((test.statistic, pair) for test, pair in zip(tests, pairs, strict=True))
        print(f"{name}: {differ} of {len(pairs)} differ, at most {at_most:.2f}:", *pair)
    for slug, table in tables.items():
        print(f"{slug}: {table[:, 0].mean():.2f} +- {table[:, 0].std():.2f} m at a random instant")


if __name__ == "__main__":
    main()
