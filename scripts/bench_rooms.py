"""What boards in rooms cost, beside another tree of radhar: processor time, in turn.

    python scripts/bench_rooms.py [--rounds 1] [--against TREE] [--only walker,people,dry,capon]

walker: the echo of one person of 12 s in a room of six faces before an IWR6843ISK. people: that of
two people of 6 s. dry: `radhar generate --dry-run` of 12 samples of these two. capon: points of ten
frames of the people-tracking chain of TI's 3D profile there, and their milliseconds a frame.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parents[1]
ROOM = """
activities: [walking]
samples_per_class: 12
radar: {device: IWR6843ISK, cfg: iwr6843isk, position_m: [0, 0, 1.5]}
motion: {place: {range_m: 3}}
room:
  box_m: {x: [-1, 7], y: [-3, 3], height: 2.6}
  faces: {floor: concrete, ceiling: concrete, left: plasterboard, right: plasterboard,
          front: brick, back: brick}
body: {scatterers: surfaces}
maps: [range_doppler, points]
on_invalid: keep
"""
SECOND = """
people:
  - activity: punching
    motion: {place: {range_m: {uniform: [1, 6]}, cross_range_m: {uniform: [-2.5, 2.5]}}}
"""
TRACKING = ROOM.replace("cfg: iwr6843isk,", f"cfg: {ROOT}/tests/radar/cfg/people_isk_bpm.cfg,")
DOCUMENTS = {
    "walker": ROOM + "duration_s: 12\n",
    "people": ROOM + SECOND + "duration_s: 6\n",
    "dry": ROOM + SECOND + "duration_s: 6\n",
    "capon": TRACKING + "duration_s: 0.56\n",
}
MADE = {"walker": "echo", "people": "echo", "capon": "cloud"}
# A first scene of half a second loads what is loaded once.
_SCENE = """
import json, sys
from time import process_time
from radhar_cli.config import load_config
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import draw_scene

def seconds(*more):
    config = load_config(sys.argv[1], [*more])
    scene = draw_scene(config, config.chosen_activities[0], 0)
    start = process_time()
    done = record(scene, ["board", sys.argv[2]])
    total = process_time() - start
    return total, done.seconds[sys.argv[2]], done["board"].frames

seconds("duration_s=0.5")
print(json.dumps(seconds()))
"""


def measure_scene(tree: Path, config: Path, product: str) -> dict[str, float]:
    """Processor time (s) of a product of a scene in a tree, with all that it needs, and alone."""
    done = run_in(tree, "-c", _SCENE, str(config), product)
    total, alone, frames = json.loads(done.splitlines()[-1])
    return {"s": total, "ms a frame, this step": 1e3 * alone / frames}


def measure_dry_run(tree: Path, config: Path) -> dict[str, float]:
    """Processor time (s) of a dry run, start included."""
    before = os.times()
    with tempfile.TemporaryDirectory() as folder:
        command = ["generate", str(config), "-o", f"{folder}/out", "--dry-run"]
        run_in(tree, "-m", "radhar_cli", *command)
    after = os.times()
    seconds = after.children_user - before.children_user
    return {"s": seconds + after.children_system - before.children_system}


def run_in(tree: Path, *words: str) -> str:
    """Run Python with the radhar of a tree, in one thread, and return what it prints."""
    one_thread = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(tree)}
    done = subprocess.run(
        [sys.executable, *words], env=os.environ | one_thread, cwd=tree, stdout=subprocess.PIPE,
        text=True, check=True,
    )  # fmt: skip
    return done.stdout


def main() -> None:
    """Print the times of each round, and their ratios."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--against", type=Path, help="another tree of radhar")
    parser.add_argument("--only", default=",".join(DOCUMENTS))
    arguments = parser.parse_args()
    trees = {"this": ROOT} | ({"against": arguments.against} if arguments.against else {})
    with tempfile.TemporaryDirectory() as folder:
        for name in arguments.only.split(","):
            config = Path(folder) / f"{name}.yaml"
            config.write_text(DOCUMENTS[name])
            seconds: dict[str, list[float]] = {tree: [] for tree in trees}
            for _ in range(arguments.rounds):
                for tree, path in trees.items():
                    found = (
                        measure_dry_run(path, config)
                        if name == "dry"
                        else measure_scene(path, config, MADE[name])
                    )
                    seconds[tree].append(found["s"])
                    print(name, tree, {k: round(v, 2) for k, v in found.items()}, flush=True)
            if "against" in trees:
                ratios = [a / b for a, b in zip(seconds["against"], seconds["this"], strict=True)]
                print(name, f"{median(ratios):.1f} times faster", flush=True)


if __name__ == "__main__":
    main()
