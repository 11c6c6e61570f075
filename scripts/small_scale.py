"""What decides the accuracy at low SNR: small experiments, one factor at a time.

    python scripts/small_scale.py [--only WORD ...] [--report-only]

Maps of 64 px, 100 a class to learn from, 25 to choose the epoch by, 75 to test; the scenes are
the same whatever the SNR, the image and the processing. Unless a row says otherwise the network is
smallnet (15 epochs, batch 32, rate 0.003, cosine). Every experiment leaves one record,
docs/results/small/NAME.json, of which the tables are made; a row that has one is run --again only.
"""

import argparse
import re
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from reproduce_paper import (
    NOT_RUN,
    ROOT,
    SCENARIOS,
    as_text,
    machine,
    radhar,
    read_json,
    read_note,
    table,
    write_note,
    write_page,
)
from snr_budget import read_budget, readings

from radhar_cli.arrays import Float, Index
from radhar_cli.learning.evaluation import open_for, predict
from radhar_cli.learning.metrics import wilson
from radhar_cli.learning.run_folder import load_best

BEGIN = "<!-- tables: scripts/small_scale.py -->"
RESULTS = ROOT / "docs" / "results" / "small"
SPLIT = "split={train: 0.5, validation: 0.125, test: 0.375}"
DATA = ("image.size_px=64", "samples_per_class=200", SPLIT, "output.png=false")
SMALLNET = (
    "model=smallnet",
    "epochs=15",
    "batch_size=32",
    "learning_rate=0.003",
    "schedule.kind=cosine",
)
FFTNET = ("model=fftnet", "batch_size=32")  # and the paper's 20 epochs, rate and steps
LONGER = (*SMALLNET, "epochs=60")
CONSTANT = "schedule.kind=constant"
ONE_THREAD = "threads=1"
BOUND, CURVE, FACTORS, ADVICE, EVERY = "bound", "curve", "factors", "advice", "every"
TABLES = {
    BOUND: "Network or physics",
    CURVE: "Accuracy over the SNR",
    FACTORS: "Size of the map, epochs, schedule, network at -10 dB, free space",
    ADVICE: "What brings accuracy at -10 dB",
    EVERY: "One network for every SNR, where it misses most",
}


@dataclass(frozen=True)
class Experiment:
    """Networks of some seeds on the maps of one config.

    Attributes:
        label: of its row.
        snr_db: None is noiseless.
        data: changes of the paper's config.
        train: settings of the training.
        learned: what is changed further in the maps it learns from, and not in those of the test.
        of: labels of other experiments on the same scenes instead: their probabilities are
            averaged, seed by seed.
    """

    table: str
    label: str
    scenario: str
    snr_db: int | None
    data: tuple[str, ...] = ()
    train: tuple[str, ...] = SMALLNET
    seeds: tuple[int, ...] = (1,)
    learned: tuple[str, ...] = ()
    of: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Of its record."""
        return f"{data_name(self)}_{plain(self.label)}"


def plain(words: str) -> str:
    """Words as a name of a file."""
    return re.sub(r"[^a-z0-9.-]+", "_", words.lower()).strip("_")


def data_name(one: Experiment) -> str:
    """Of the data set, without what is changed in it."""
    noise = "noiseless" if one.snr_db is None else f"{one.snr_db}dB"
    return f"{one.scenario}_{noise}"


def settings(one: Experiment) -> list[str]:
    """Changes of the paper's config that make its maps."""
    return [*DATA, f"snr_db={'null' if one.snr_db is None else one.snr_db}", *one.data]


SEVERAL = ("maps=[stft, stft_compensated, stft_denoised, fsst, rtm]",)
FREE, WALL = SCENARIOS


SMALL, GATED, MORE = "smallnet", "gate of 1 m about the torso", "400 maps a class to learn from"
FIXED = "all bins from 0.5 to 8 m, powers summed"
LONG, PAPERS = "window of 0.8 s", "the paper's: stft, coherent sum of the bins"
GATE = ("processing.range_sum=gated",)
ONE = "one network, trained at -20 to 30 dB"
DRAWN = ("snr_db={uniform: [-20, 30]}",)
NARROW = ("snr_db={uniform: [0, 30]}",)
FIVE_HUNDRED = ("samples_per_class=500", "seed=2", "split={train: 0.8, validation: 0.2}")
HARDEST = ((FREE, -10), (WALL, 10))  # where one network falls shortest of that of the SNR alone


EXPERIMENTS: tuple[Experiment, ...] = (
    Experiment(BOUND, SMALL, FREE, -10, seeds=(1, 2, 3)),
    Experiment(BOUND, SMALL, WALL, -10, seeds=(1, 2, 3)),
    Experiment(BOUND, SMALL, WALL, None),
    Experiment(BOUND, SMALL, FREE, None),
    Experiment(ADVICE, GATED, WALL, -10, GATE, seeds=(1, 2)),
    *(Experiment(CURVE, SMALL, WALL, snr) for snr in (10, 0)),
    Experiment(CURVE, SMALL, FREE, -20),
    Experiment(ADVICE, FIXED, WALL, -10, (*GATE, "processing.gate_m=[0.5, 8]")),
    Experiment(ADVICE, "map rtm", WALL, -10, SEVERAL, train=(*SMALLNET, "map=rtm")),
    Experiment(ADVICE, "gate and map rtm, averaged", WALL, -10, of=(GATED, "map rtm")),
    Experiment(FACTORS, "smallnet, 5 epochs", FREE, -10, train=(*SMALLNET, "epochs=5")),
    Experiment(
        FACTORS,
        "smallnet, rate / 10 after 8 of 15 epochs",
        FREE,
        -10,
        train=(*SMALLNET, "schedule={kind: step, every_epochs: 8}"),
    ),
    Experiment(FACTORS, "smallnet, 32 px", FREE, -10, ("image.size_px=32",)),
    Experiment(CURVE, SMALL, FREE, -15),
    Experiment(ADVICE, f"{GATED}, {LONG}", WALL, -10, (*GATE, "processing.window_s=0.8")),
    Experiment(FACTORS, "smallnet, 128 px", FREE, -10, ("image.size_px=128",)),
    Experiment(ADVICE, LONG, FREE, -10, ("processing.window_s=0.8",)),
    Experiment(ADVICE, MORE, FREE, -10, learned=FIVE_HUNDRED),
    *(
        Experiment(ADVICE, f"map {name}", FREE, -10, SEVERAL, train=(*SMALLNET, f"map={name}"))
        for name in ("rtm", "stft_denoised", "stft_compensated", "fsst")
    ),
    Experiment(FACTORS, "fftnet, rate / 10 after 10 of 20 epochs", FREE, -10, train=FFTNET),
    Experiment(ADVICE, f"{GATED}, {MORE}", WALL, -10, GATE, learned=FIVE_HUNDRED),
    Experiment(FACTORS, "fftnet, rate constant", FREE, -10, train=(*FFTNET, CONSTANT)),
    Experiment(
        FACTORS,
        "fftnet, rate / 10 after 3 of 6 epochs",
        FREE,
        -10,
        train=(*FFTNET, "epochs=6", "schedule.every_epochs=3"),
    ),
    Experiment(
        ADVICE, "60 epochs, the steps of 15 on four times the maps", FREE, -10, train=LONGER
    ),
    Experiment(ADVICE, MORE, WALL, -10, learned=FIVE_HUNDRED),
    Experiment(EVERY, "one network, trained at 0 to 30 dB", WALL, 10, learned=NARROW),
    *(
        Experiment(EVERY, label, scenario, snr, learned=learned)
        for scenario, snr in HARDEST
        for label, learned in ((ONE, DRAWN), (f"{ONE}, {MORE}", (*FIVE_HUNDRED, *DRAWN)))
    ),
)


@dataclass(frozen=True)
class Bench:
    """Where the data sets and runs of the experiments lie, and their records."""

    out: Path
    results: Path

    def maps(self, one: Experiment, learned: bool = False) -> Path:
        """The data set of an experiment, to test or to learn from."""
        changes = [*one.data, *(one.learned if learned else ())]
        folder = self.out / "data" / "_".join([data_name(one), *map(plain, changes)])
        if not (folder / "dataset.h5").exists():
            words = _set([*settings(one), *(one.learned if learned else ())])
            config = ROOT / "configs" / "paper" / f"{one.scenario}.yaml"
            radhar("generate", config, "-o", folder, "--jobs", 1, *words)
        return folder

    def run(self, one: Experiment, seed: int) -> Path:
        """Folder of the training with one seed."""
        return self.out / "runs" / f"{one.name}_{seed}"

    def probabilities(self, one: Experiment, seed: int) -> tuple[Float, Index]:
        """Probabilities [N, 12] of the test maps after training with one seed, true classes [N]."""
        if one.of:
            parts = [self.probabilities(other, seed) for other in averaged(one)]
            return np.mean([p for p, _ in parts], axis=0), parts[0][1]
        run = self.run(one, seed)
        if not (run / "metrics.json").exists():
            write_note(run)
            words = _set([*one.train, f"seed={seed}", ONE_THREAD])
            paper = ROOT / "configs/train/paper.yaml"
            radhar("train", self.maps(one, learned=True), "-o", run, "--config", paper, *words)
        metadata, model = load_best(run)
        images = open_for(metadata, self.maps(one), None)
        predictions = predict(
            model, metadata, images, images.rows("test"), torch.device("cpu"), 128
        )
        return predictions.probabilities, predictions.truth

    def record(self, one: Experiment, again: bool = False) -> None:
        """Run an experiment, training included where it is to be run again; write its record."""
        runs = [self.run(part, seed) for part in averaged(one) or [one] for seed in one.seeds]
        for run in runs if again and not one.of else []:
            shutil.rmtree(run, ignore_errors=True)
        answers = [self.probabilities(one, seed) for seed in one.seeds]
        truth = answers[0][1]
        correct = [int((p.argmax(1) == truth).sum()) for p, _ in answers]
        together = np.mean([p for p, _ in answers], axis=0).argmax(1)
        confusion = np.zeros((12, 12), int)
        np.add.at(confusion, (truth, together), 1)
        commits = [made for run in runs for made in read_note(run)["commits"]]
        contents = {
            "name": one.name,
            "scenario": one.scenario,
            "snr_db": one.snr_db,
            "data": settings(one),
            "learned": list(one.learned),
            "train": list(one.train),
            "of": list(one.of),
            "seeds": list(one.seeds),
            "command": f"python scripts/small_scale.py --only {one.name}",
            "commits": [made for n, made in enumerate(commits) if made not in commits[:n]],
            "machine": machine(),
            "precision": [read_json(run / "metrics.json")["precision"] for run in runs],
            "tested": int(truth.size),
            "correct": correct,
            "correct_together": int(np.trace(confusion)),
            "confusion_together": confusion.tolist(),
        }
        self.results.mkdir(parents=True, exist_ok=True)
        (self.results / f"{one.name}.json").write_text(as_text(contents))


def _set(words: list[str]) -> list[str]:
    return [part for word in words for part in ("--set", word)]


def averaged(one: Experiment) -> list[Experiment]:
    """The experiments whose probabilities one averages."""
    return [named(f"{data_name(one)}_{plain(label)}") for label in one.of]


def named(name: str) -> Experiment:
    """An experiment by its name."""
    return next(one for one in EXPERIMENTS if one.name == name)


def _share(correct: float, tested: int) -> str:
    return f"{100 * correct / tested:.1f}"


def cells(record: dict[str, Any] | None) -> list[str]:
    """Mean accuracy of the seeds with Wilson's interval for the maps, their spread, together."""
    if record is None:
        return [NOT_RUN, "", "", ""]
    correct, tested = record["correct"], record["tested"]
    mean = float(np.mean(correct))
    low, high = wilson(mean, tested)
    seeds = ", ".join(_share(one, tested) for one in correct)
    together = _share(record["correct_together"], tested) if len(correct) > 1 else ""
    link = f"[JSON](results/small/{record['name']}.json)"
    return [
        f"{_share(mean, tested)} ({100 * low:.1f} to {100 * high:.1f})",
        seeds,
        together,
        link,
    ]


def page_text(results: Path) -> str:
    """The tables of all experiments that there are, out of their records alone."""
    lines = []
    for key, title in TABLES.items():
        body = []
        rows = [one for one in EXPERIMENTS if one.table == key]
        if key in (CURVE, ADVICE):
            rows += [one for one in EXPERIMENTS if one.table == BOUND and one.label == SMALL]
        if key == FACTORS:
            rows += [one for one in EXPERIMENTS if one.name == f"{FREE}_-10dB_{SMALL}"]
        if key == EVERY:
            of_one_snr = {f"{scenario}_{snr}dB_{SMALL}" for scenario, snr in HARDEST}
            rows += [one for one in EXPERIMENTS if one.name in of_one_snr]
        if key == ADVICE:
            rows = [one for one in rows if one.snr_db == -10]
        snr = [999 if one.snr_db is None else one.snr_db for one in rows]
        order = {one: n for n, one in enumerate(EXPERIMENTS)}
        keys = {one: (one.scenario, -s, order[one]) for one, s in zip(rows, snr, strict=True)}
        for one in sorted(rows, key=lambda one: keys[one]):
            file = results / f"{one.name}.json"
            record = read_json(file) if file.exists() else None
            noise = "noiseless" if one.snr_db is None else str(one.snr_db)
            what = PAPERS if key == ADVICE and one.label == SMALL else one.label
            body.append([SCENARIOS[one.scenario], noise, what, *cells(record)])
        head = ["scenario", "SNR (dB)", "what", "accuracy, mean of seeds", "each seed"]
        lines += [f"### {title}", "", *table([*head, "seeds together", "record"], body)]
        if key == CURVE:
            lines += _other_places(results)
    return "\n".join(lines)


def _other_places(results: Path) -> list[str]:
    """What the curves say of an SNR of -10 dB that refers to another place of the chain."""
    budget = results.parent / "snr_budget.json"
    if not budget.exists():
        return []
    body: dict[str, list[str]] = {}
    for scenario in SCENARIOS:
        curve: dict[float, float] = {}
        for one in EXPERIMENTS:
            file = results / f"{one.name}.json"
            of_curve = (one.label, one.scenario) == (SMALL, scenario)
            if of_curve and one.snr_db is not None and file.exists():
                record = read_json(file)
                curve[one.snr_db] = float(100 * np.mean(record["correct"]) / record["tested"])
        for place, snr in readings(read_budget(budget)["scenarios"][scenario]).items():
            share = NOT_RUN
            if snrs := sorted(curve):
                share = f"{np.interp(snr, snrs, [curve[n] for n in snrs]):.0f}"
                share = f"{'at most ' * (snr < snrs[0])}{'at least ' * (snr > snrs[-1])}{share}"
            body.setdefault(place, [place]).extend([f"{snr:+.1f}", share])
    head = ["if -10 dB were the SNR of"]
    for words in SCENARIOS.values():
        head += [f"our `snr_db`, {words}", "accuracy"]
    words = "Other places to which an SNR could refer; accuracy between the points of the curves:"
    return [words, "", *table(head, list(body.values()))]


def main() -> None:
    """Run what has no record, and write the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="*", default=[], help="names, or words in one")
    parser.add_argument("--report-only", action="store_true", help="write the tables, no more")
    parser.add_argument("--again", action="store_true", help="also rows that have a record")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "small_scale")
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "results.md")
    options = parser.parse_args()
    results = options.page.parent / "results" / "small"
    wanted = [one for one in EXPERIMENTS if one.name in options.only] or [
        one for one in EXPERIMENTS if all(word in one.name for word in options.only)
    ]
    if not wanted:
        sys.exit(f"small_scale: --only {' '.join(options.only)}: no experiment has that")
    bench = Bench(options.out.absolute(), results.absolute())
    for one in [] if options.report_only else wanted:
        if options.again or not (results / f"{one.name}.json").exists():
            bench.record(one, options.again)
            write_page(options.page, page_text(results), BEGIN)
    write_page(options.page, page_text(results), BEGIN)


if __name__ == "__main__":
    main()
