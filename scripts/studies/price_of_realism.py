"""What each piece of a scene costs, changes, and is worth to a network.

    python scripts/studies/price_of_realism.py -o OUT [--per-class 80]
        [--tested 60] [--seeds 3] [--only X]

Each row adds one thing to five activities of one person 2 to 8 m from a radar. Time: of a sample
with it over without it. Pixels: the share that changes by more than 6 dB, scene by scene. A
smallnet learns from maps without it and another from maps with it; both are tested on other people
without and with it (learned, tested): accuracy by the sample's own person, or of target labels the
share of maps with all labels right and the mean average precision; mean and range of the seeds.
What is in OUT is kept, so that the same line goes on where it was stopped.
"""

import argparse
from hashlib import sha256
from pathlib import Path
from statistics import mean, median
from typing import NamedTuple

import numpy as np
import torch
from few_shots import Silent
from sklearn.metrics import average_precision_score

from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import load_config
from radhar_cli.dataset.build import build
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.learning.evaluation import predict_classes
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.single_result import open_eval_set, open_run
from radhar_cli.learning.tasks.predictions import EvalOptions
from radhar_cli.learning.tasks.task import create_task
from radhar_cli.learning.training import train
from radhar_cli.study.tradeoff.scenes import Scenes
from radhar_cli.study.tradeoff.setting import Setting
from radhar_cli.study.tradeoff.settings import BEAM
from radhar_cli.study.tradeoff.timing import time_setting

FIXED = {"epochs": 20, "device": "cpu", "threads": 1, "workers": 0}
SCENES = """
radar: {carrier_hz: 24e9, bandwidth_hz: 1e9, prf_hz: 2000}
activities: [walking, punching, kicking, grabbing, sitting_down]
duration_s: 3
motion: {range_m: {per_activity: {default: {uniform: [2, 4]}, walking: {uniform: [6, 8]}}}}
on_invalid: keep  # the same people with and without
maps: [stft]
image: {size_px: 64}
"""
OTHER = (
    "people=[{activity: {choice: [walking, punching, kicking, grabbing, sitting_down]}, motion: "
    "{range_m: {per_activity: {default: {uniform: [2, 4]}, walking: {uniform: [6, 8]}}}}}]",
)
SIDES = ("floor", "ceiling", "left", "right", "front", "back")
ROOM = (
    "room.box_m={x: [0, 10], y: [-4, 4], height: 2.8}",
    f"room.faces={{{', '.join(f'{one}: concrete' for one in SIDES)}}}",
)
TWICE = "room.order=2"
BAND = "radar={carrier_hz: 1.5e9, bandwidth_hz: 1e9, prf_hz: 256, adc_rate_hz: 5e6}"
WALL = (BAND, "engine.kind=cube", "wall={center_m: [1, 0, 1.25], size_m: [0.24, 8, 3]}")
EXACT = ("wall.echoes=exact",)


class Row(NamedTuple):
    """What is added to what, what a network learns of which map, and whether also with it."""

    name: str
    base: tuple[str, ...]
    added: tuple[str, ...]
    map: str = "stft"
    target: str = "classes"
    learned: bool = True


ROWS = (
    Row("another person", (), OTHER),
    Row("another person, all labels", (), OTHER, target="labels"),
    Row("another person, gate on the own", ("processing.range_sum=gated",), OTHER),
    Row("a room, one bounce", (), ROOM),
    Row("beams of 70 x 30 degrees", (), (BEAM,)),
    Row("the same beams in the room", ROOM, (BEAM,), learned=False),
    Row("reflections inside a wall", WALL, EXACT, learned=False),
    Row("reflections inside a wall, range-time", (*WALL, "maps=[rtm]"), EXACT, "rtm"),
    Row("a room, two bounces", (), (*ROOM, TWICE), learned=False),  # a second a map
    Row("the second bounce alone", ROOM, (TWICE,), learned=False),
)


class Study(NamedTuple):
    """Data sets and networks of a folder, each made once."""

    out: Path
    sizes: dict[str, int]  # samples a class, learned and tested
    seeds: range

    def data(self, on: tuple[str, ...], part: str) -> Path:
        """The data set of some overrides to learn from or to test on."""
        folder = self.out / part / digest(on)
        own = (f"samples_per_class={self.sizes[part]}", f"seed={1 + (part == 'tested')}")
        build(load_config(self.out / "scenes.yaml", (*on, *own)), folder, 1, BarProgress())
        return folder

    def score(self, row: Row, learned: tuple[str, ...], on: tuple[str, ...]) -> str:
        """Accuracy of all seeds; of labels the share of maps with all right, and mAP; per cent."""
        images, found = open_images(self.data(learned, "learned"), row.map, "rgb"), []
        for seed in self.seeds:
            run = self.out / "runs" / f"{digest(learned)}_{row.map}_{row.target}_{seed}"
            if not (run / "done").exists():
                settings = TrainConfig(target=row.target, map=row.map, seed=seed, **FIXED)
                train(settings, create_task(settings).relabel(images), run, Silent())
                (run / "done").touch()
            opened, cpu = open_run("run", run, torch.device("cpu")), torch.device("cpu")
            data = open_eval_set(opened, self.data(on, "tested"), EvalOptions("all"))
            made = predict_classes(opened.model, opened.metadata, data.images, data.rows, cpu, 64)
            shown = data.images.multi_hot(opened.metadata.classes) > 0
            each = [(made.predicted == made.truth).mean()]
            if row.target == "labels":
                right = ((made.probabilities > 0.5) == shown).all(axis=1)
                each = [right.mean(), average_precision_score(shown, made.probabilities)]
            found.append([100 * float(one) for one in each])
        told = [f"{mean(s):.1f} ({min(s):.1f} to {max(s):.1f})" for s in zip(*found, strict=True)]
        return ", mAP ".join(told)

    def pixels(self, row: Row) -> float:
        """Share of pixels of the tested maps that the addition changes by more than 6 dB."""
        levels = []
        for on in (row.base, row.base + row.added):
            with open_dataset(self.data(on, "tested")) as data:
                levels.append(np.asarray(data.maps[row.map][:], float))
        return float((np.abs(levels[1] - levels[0]) * (50 / 255) > 6).mean())

    def time(self, row: Row) -> float:
        """How many times as long a sample takes with the addition, median of nine rounds."""
        setting = Setting("", row.name, row.base + row.added, row.base)
        scenes = Scenes(self.out / "scenes.yaml", (), False)
        return median(time_setting(scenes, setting, turn).ratio for turn in range(9))


def digest(on: tuple[str, ...]) -> str:
    """Name of what is made with some overrides."""
    return sha256(repr(on).encode()).hexdigest()[:8]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--per-class", type=int, default=80)
    parser.add_argument("--tested", type=int, default=60)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--only", default="", help="rows whose names have this")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    (given.out / "scenes.yaml").write_text(SCENES)
    sizes = {"learned": given.per_class, "tested": given.tested}
    study = Study(given.out, sizes, range(1, given.seeds + 1))
    print(
        "| added | time | pixels | trained and tested without | trained without, tested with "
        "| trained with, tested without | trained and tested with |"
    )
    print("| --- | ---: | ---: | --- | --- | --- | --- |", flush=True)
    for row in ROWS:
        if given.only in row.name:
            off, on = row.base, row.base + row.added
            cells = [f"{study.time(row):.1f}", f"{100 * study.pixels(row):.1f} %"]
            pairs = [(off, off), (off, on)] + [(on, off), (on, on)] * row.learned
            cells += [study.score(row, *pair) for pair in pairs] + [""] * (4 - len(pairs))
            print(f"| {row.name} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
