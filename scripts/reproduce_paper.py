"""Build the paper's data sets, train its networks, evaluate them, and write docs/records/runs.md.

    python scripts/reproduce_paper.py --scale smoke|weights|cpu|full [--only WORD ...]
        [--report-only | --filters]

Every step is a `radhar` command and resumes where it was stopped; run the same line again. Each
finished run leaves one record, docs/records/paper/SCALE/RUN.json, which is committed; data sets and
runs are not. The tables are made from the records alone, so a machine that has one run adds its
row and the others stay; a row that has a record of all epochs is run --again only. See SCALES for
what each scale does. --filters draws the paper's figure of weights, docs/images/filters_*.png: the
global filters of the scale's networks by layer and SNR; what is not trained is trained first.

Beside each data set and each run that it makes, the script notes commit and machine
(NAME.made.json), for the record.
"""

import argparse
import csv
import json
import os
import platform
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from functools import cache
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
from page_parts import replace_part
from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
FOLDER = "paper"  # of the records, beside the page
BEGIN, END = "<!-- tables: scripts/reproduce_paper.py -->", "<!-- end of tables -->"
SCENARIOS = {"free_space": "free space", "through_wall": "through the wall"}
FRESH_SEED = 20261121
SUBJECTS = 20
PAPER_EPOCHS, PAPER_RATE = 20, 0.00147
PAGE_SCALES = ("cpu", "full")
PAPER_TRAINING, ROBUST = (
    ROOT / "configs" / "train" / name for name in ("paper.yaml", "robust.yaml")
)
DRAWN_SNR = (-20, 30)
DRAWN_TESTED = (30, 20, 10, 0, -10, -20)
# Where the network of all SNRs falls short without failing: its confusion matrix is that one.
DRAWN_SHOWN = {"free_space": -10, "through_wall": 10}
FEW_MISTAKES = 0.99  # accuracy above which a confusion matrix shows nothing
UNKNOWN, NOT_RUN = "not recorded", "not run"
ENDING = ["core hours", "commit", "record"]
# What a commit has to say about a result; a change elsewhere is none of it.
CODE = ("radhar_cli", "configs", "scripts")

# Paper, Table III: validation accuracy (%), parameters (M), seconds with model loading.
PAPER = {
    ("free_space", "fftnet"): (100.00, 6.50, 0.22),
    ("free_space", "mobilenetv2_100"): (97.50, 2.23, 0.15),
    ("free_space", "resnet50"): (98.75, 23.58, 0.50),
    ("free_space", "vgg19"): (99.17, 139.55, 1.00),
    ("free_space", "vit_base_patch16_224"): (100.00, 85.24, 0.80),
    ("free_space", "convnext_tiny"): (100.00, 28.24, 0.60),
    ("through_wall", "fftnet"): (99.44, 6.50, 0.22),
    ("through_wall", "mobilenetv2_100"): (94.86, 2.23, 0.15),
    ("through_wall", "resnet50"): (96.81, 23.58, 0.50),
    ("through_wall", "vgg19"): (98.33, 139.55, 1.00),
    ("through_wall", "vit_base_patch16_224"): (99.72, 85.24, 0.80),
    ("through_wall", "convnext_tiny"): (99.44, 28.24, 0.60),
}
# Paper, section V.B, in words only.
PAPER_BY_SNR = {
    ("free_space", 30): "100.00 (Table III); above 95",
    ("free_space", 20): "above 95",
    ("free_space", 10): "not given",
    ("free_space", 0): "80 to 90",
    ("free_space", -10): "80 to 90",
    ("through_wall", 30): "99.44 (Table III); elsewhere below 95, below 90",
    ("through_wall", 20): "below 95",
    ("through_wall", 10): "below 95",
    ("through_wall", 0): "65 to 85",
    ("through_wall", -10): "65 to 75; the network fails",
}
RIVALS = tuple(dict.fromkeys(model for _, model in PAPER if model != "fftnet"))
# Those that the paper's learning rate is too high for, from fresh weights, and a common lower rate.
UNSTABLE, LOWER_RATE = ("vgg19", "vit_base_patch16_224"), 1e-4


@dataclass(frozen=True)
class Training:
    """One run: a scenario, an SNR, a network, its settings, and how the data are split.

    An SNR of None is drawn for each map, uniformly within DRAWN_SNR. The seed is that of the
    training; the data stay.
    """

    scenario: str
    snr_db: int | None
    model: str = "fftnet"
    epochs: int = 20
    by_subject: bool = False
    learning_rate: float = PAPER_RATE
    seed: int = 1

    @property
    def settings(self) -> list[str]:
        """Overrides of the paper's training config."""
        values = {"epochs": self.epochs, "learning_rate": self.learning_rate, "seed": self.seed}
        plain = {"epochs": PAPER_EPOCHS, "learning_rate": PAPER_RATE, "seed": 1}
        return [f"{key}={value}" for key, value in values.items() if value != plain[key]]

    @property
    def named_settings(self) -> list[str]:
        """Settings that are part of the name, in words: the learning rate and the seed."""
        rate = [] if self.learning_rate == PAPER_RATE else [f"rate {self.learning_rate:g}"]
        return rate + ([] if self.seed == 1 else [f"seed {self.seed}"])


@dataclass(frozen=True)
class Scale:
    """How much of the paper is run.

    Attributes:
        size_px: side of the maps; the paper's is 256.
        per_class: maps a class for training and validation; the paper's is 300.
        fresh_per_class: maps a class of the fresh seed.
        trainings: in the order in which they are run.
        on_gpu: is for a GPU; what has no record is named below the tables instead of in a row.
    """

    size_px: int
    per_class: int
    fresh_per_class: int
    trainings: tuple[Training, ...]
    generate: tuple[str, ...] = ()
    train: tuple[str, ...] = field(default=())
    on_gpu: bool = False


SCALES = {
    # A few minutes: a little of everything, to see that the script works.
    "smoke": Scale(
        size_px=64,
        per_class=4,
        fresh_per_class=2,
        trainings=(
            Training("free_space", 30, epochs=2),
            Training("through_wall", 30, epochs=2),
            Training("free_space", -10, epochs=2),
            Training("free_space", None, epochs=2),
        ),
        generate=("radar.prf_hz=500", "radar.carrier_hz=10e9"),
        train=("batch_size=12",),
    ),
    # Some ten minutes: networks by SNR, for --filters.
    "weights": Scale(
        size_px=64,
        per_class=40,
        fresh_per_class=0,
        trainings=(
            *(Training("free_space", n, epochs=12) for n in (30, 10, 0, -10)),
            Training("through_wall", 30, epochs=12),
            *(Training("through_wall", n, epochs=6) for n in (10, 0)),
        ),
        train=("batch_size=32",),
    ),
    # Two cores, a night, and the large networks for a GPU: the paper's protocol with maps of half
    # its size.
    "cpu": Scale(
        size_px=128,
        per_class=300,
        fresh_per_class=100,
        trainings=(
            *(Training(s, n) for n in (30, -10, 10, 20, 0) for s in ("through_wall", "free_space")),
            *(Training(s, None) for s in ("free_space", "through_wall")),
            *(Training(s, 30, by_subject=True) for s in ("through_wall", "free_space")),
            *(Training(s, 30, m) for m in RIVALS for s in ("through_wall", "free_space")),
        ),
    ),
    # The paper's protocol, for a GPU.
    "full": Scale(
        size_px=256,
        per_class=300,
        fresh_per_class=100,
        trainings=(
            *(Training(s, n) for n in (30, 20, 10, 0, -10, None) for s in SCENARIOS),
            *(Training(s, 30, by_subject=True) for s in SCENARIOS),
            *(Training(s, 30, m) for m in RIVALS for s in SCENARIOS),
            *(Training(s, 30, m, learning_rate=LOWER_RATE) for m in UNSTABLE for s in SCENARIOS),
            *(Training(s, 30, seed=n) for n in (2, 3) for s in SCENARIOS),
        ),
        on_gpu=True,
    ),
}


@dataclass
class Reproduction:
    """The steps of one scale and what they leave.

    Attributes:
        name: of the scale.
        results: folder of the records and figures that are committed.
    """

    name: str
    scale: Scale
    data_root: Path
    runs_root: Path
    results: Path
    jobs: int | None = None

    def data(self, scenario: str, snr_db: int | None, kind: str = "") -> Path:
        """Folder of a data set; `kind` is fresh or subjects."""
        ending = f"_{kind}" if kind else ""
        return self.data_root / f"{scenario}_{snr_name(snr_db)}_{self.scale.size_px}px{ending}"

    def run(self, training: Training) -> Path:
        """Folder of a run."""
        return self.runs_root / run_name(self.scale, training)

    def generate(self, scenario: str, snr_db: int | None, kind: str = "") -> Path:
        """Build a data set, or find it complete; returns its folder."""
        folder = self.data(scenario, snr_db, kind)
        if (folder / "dataset.h5").exists():
            return folder
        scale = self.scale
        per_class = scale.fresh_per_class if kind == "fresh" else scale.per_class
        settings = [
            f"image.size_px={scale.size_px}",
            f"samples_per_class={per_class}",
            f"snr_db={f'{{uniform: {[*DRAWN_SNR]}}}' if snr_db is None else snr_db}",
            "output.png=false",
            *(scale.generate if scenario == "free_space" else ()),
        ]
        if kind == "fresh":
            settings.append(f"seed={FRESH_SEED}")
        if kind == "subjects":
            settings += ["split.by=subject", f"split.subjects={min(SUBJECTS, per_class)}"]
        config = ROOT / "configs" / "paper" / f"{scenario}.yaml"
        jobs = ["--jobs", str(self.jobs)] if self.jobs else []
        write_note(folder)
        radhar("generate", config, "-o", folder, *_set(settings), *jobs)
        return folder

    def train(self, training: Training) -> None:
        """Build the data of a run and train it, or find it finished."""
        run = self.run(training)
        if (run / "metrics.json").exists():
            return
        data = self.generate(training.scenario, training.snr_db, _kind(training))
        write_note(run)
        settings = _set([*training.settings, *self.scale.train])
        config = ROBUST if training.snr_db is None else PAPER_TRAINING
        radhar("train", data, "-o", run, "--config", config, "--model", training.model, *settings)

    def record(self, training: Training) -> None:
        """Evaluate a finished run and write its record and its figures."""
        run, plain = self.run(training), _plain(training)
        if not (run / "metrics.json").exists():
            return
        data = self.generate(training.scenario, training.snr_db, _kind(training))
        own = self._eval(
            run,
            "val",
            [data],
            *(["--tsne"] if training.snr_db == 30 and plain else []),
            *(["--in-place-vs-moving"] if training.model == "fftnet" else []),
        )
        if training.snr_db is None:
            snrs = [*DRAWN_TESTED]
        else:
            snrs = tested_snrs(self.scale, training.scenario) if plain else [training.snr_db]
        fresh: dict[int, Path] = {}
        others: dict[str, Any] = {}
        if not training.by_subject:
            fresh = {snr: self.generate(training.scenario, snr, "fresh") for snr in snrs}
            others = self._eval(run, "fresh", list(fresh.values()))
        self.results.mkdir(parents=True, exist_ok=True)
        (self.results / f"{run.name}.json").write_text(
            as_text(self._contents(training, data, own, fresh, others))
        )
        for name in _figures(training):
            for kind in ("val", "fresh"):
                source = self._reports(run, kind) / f"{name}.png"
                if source.exists():
                    shutil.copyfile(source, self.results / f"{run.name}_{name}.png")
                    break

    def draw_filters(self, trainings: list[Training], images: Path) -> None:
        """Train the networks of one SNR among some, and draw their filters, a figure a scenario."""
        for scenario in SCENARIOS:
            mine = [t for t in trainings if t.scenario == scenario and _has_weights_drawn(t)]
            for training in mine:
                self.train(training)
            if not mine:
                continue
            out = self.runs_root / f"reports_{self.name}" / f"{scenario}_filters"
            # Weights are the same on any data; the split with the fewest maps is read.
            data = self.generate(scenario, mine[0].snr_db)
            radhar("eval", *map(self.run, mine), data, "-o", out, "--split", "val", "--filters")
            images.mkdir(parents=True, exist_ok=True)
            with Image.open(out / "filters.png") as figure:
                figure.convert("RGB").save(images / f"filters_{scenario}.png", optimize=True)

    def _contents(
        self,
        training: Training,
        data: Path,
        own: dict[str, Any],
        fresh: dict[int, Path],
        others: dict[str, Any],
    ) -> dict[str, Any]:
        run = self.run(training)
        metrics = read_json(run / "metrics.json")
        with (run / "history.csv").open(newline="") as file:
            history = list(csv.DictReader(file))
        config, (evaluated, validation) = metrics["config"], _parts(own)[0]
        seconds = sum(float(row["seconds"]) for row in history)
        # What it says class by class is in the confusion matrix.
        parts = {
            part["name"]: {key: value for key, value in part.items() if key != "classes"}
            for _, part in _parts(others)
        }
        return {
            "name": run.name,
            "scenario": training.scenario,
            "snr_db": training.snr_db,
            "model": training.model,
            "size_px": metrics["size_px"][0],
            "subjects": min(SUBJECTS, self.scale.per_class) if training.by_subject else None,
            "epochs": config["epochs"],
            "reduced": config["epochs"] < PAPER_EPOCHS,
            "config": config,
            "command": f"python scripts/reproduce_paper.py --scale {self.name} --only {run.name}",
            "note": None,
            "training": {
                **read_note(run),
                "versions": metrics["versions"],
                "device": metrics["device"],
                "precision": metrics["precision"],
                "threads": metrics["threads"],
                "seconds": round(seconds, 1),
                "core_hours": round(seconds * metrics["threads"] / 3600, 3),
            },
            "data": {
                **read_note(data),
                **{key: metrics["data"][key] for key in ("hash", "train", "val")},
            },
            "evaluation": {**read_note(self._reports(run, "val")), "threads": own["threads"]},
            "best_epoch": metrics["best_epoch"],
            "parameters": metrics["parameters"],
            "multiply_adds": metrics["multiply_adds"],
            "speed": evaluated["speed"],
            "labels": metrics["classes"],
            "validation": validation,
            "fresh": {
                str(snr): {**read_note(folder), **parts[folder.name]}
                for snr, folder in fresh.items()
            },
            "history": {
                key: [float(row[key]) for row in history]
                for key in ("train_loss", "train_accuracy", "val_loss", "val_accuracy", "seconds")
            },
        }

    def _reports(self, run: Path, kind: str) -> Path:
        return self.runs_root / f"reports_{self.name}" / f"{run.name}_{kind}"

    def _eval(self, run: Path, kind: str, data: list[Path], *more: str) -> dict[str, Any]:
        """Report of a run on some data sets, made again if the run is newer or a set is missing."""
        out = self._reports(run, kind)
        stamp, newest = out / "report.json", (run / "metrics.json").stat().st_mtime
        there = read_json(stamp) if stamp.exists() and stamp.stat().st_mtime >= newest else {}
        if {folder.name for folder in data} == {part["name"] for _, part in _parts(there)}:
            return there
        out.parent.mkdir(parents=True, exist_ok=True)
        _note_file(out).unlink(missing_ok=True)
        write_note(out, load=round(os.getloadavg()[0], 1))
        split = "all" if kind == "fresh" else kind
        radhar("eval", run, *data, "-o", out, "--split", split, *more)
        return read_json(stamp)


def run_name(scale: Scale, training: Training) -> str:
    """Name of a run's folder and of its record."""
    kind = "_subjects" if training.by_subject else ""
    stem = f"{training.scenario}_{snr_name(training.snr_db)}_{scale.size_px}px{kind}"
    settings = "".join(f"_{words.replace(' ', '')}" for words in training.named_settings)
    return f"{stem}_{training.model}{settings}"


def snr_name(snr_db: int | None) -> str:
    """An SNR in names of files."""
    return "{}to{}dB".format(*DRAWN_SNR) if snr_db is None else f"{snr_db}dB"


def _snr(snr_db: int | None) -> str:
    """An SNR in captions."""
    return "{} to {} dB".format(*DRAWN_SNR) if snr_db is None else f"{snr_db} dB"


def tested_snrs(scale: Scale, scenario: str) -> list[int]:
    """SNRs at which every plain network of a scenario is tested, highest first."""
    mine = [t for t in scale.trainings if t.scenario == scenario and _plain(t)]
    return sorted({t.snr_db for t in mine if t.snr_db is not None})[::-1]


def _plain(training: Training) -> bool:
    return training.model == "fftnet" and not training.by_subject and not training.named_settings


def _has_weights_drawn(training: Training) -> bool:
    """Those of one SNR; as in the paper without -10 dB through the wall, where none is learned."""
    fails = (training.scenario, training.snr_db) == ("through_wall", -10)
    return _plain(training) and training.snr_db is not None and not fails


def _kind(training: Training) -> str:
    return "subjects" if training.by_subject else ""


def _figures(training: Training) -> dict[str, str]:
    """Figures of a run that are copied, {name: caption}: of the paper's network, by its SNR."""
    if not _plain(training):
        return {}
    captions = {}
    if training.snr_db in (30, -10):
        captions |= {"curves": "Training curves"}
    if training.snr_db == 30:
        captions |= {"tsne": "t-SNE of maps and of features"}
    return captions


def read_json(path: Path) -> dict[str, Any]:
    """What a JSON file holds."""
    contents: dict[str, Any] = json.loads(path.read_text())
    return contents


def _set(settings: list[str]) -> list[str]:
    return [word for setting in settings for word in ("--set", setting)]


def _parts(report: dict[str, Any]) -> list[tuple[dict[str, Any], dict[str, Any]]]:
    """(run, result on a data set, its name included) of every data set of a report."""
    return [
        (run, {"name": Path(name).name, **part})
        for run in report.get("runs", {}).values()
        for name, part in run["data"].items()
    ]


def radhar(*words: object) -> None:
    """Run a radhar command; its own messages say what it does."""
    line = [sys.executable, "-m", "radhar_cli", *map(str, words)]
    print("+ radhar", *map(str, words), flush=True)
    subprocess.run(line, check=True, cwd=ROOT)


def _git(*words: str) -> str | None:
    """What git says of this checkout, or None where there is none."""
    try:
        line = ["git", "-C", str(ROOT), *words]
        return subprocess.run(line, check=True, capture_output=True, text=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return None


@cache
def commit() -> dict[str, Any]:
    """Commit of this checkout, and whether its code has changes that are not committed."""
    head = _git("rev-parse", "HEAD")
    changes = _git("status", "--porcelain", "--", *CODE)
    return {"commit": head, "dirty": None if head is None else bool(changes)}


@cache
def machine() -> dict[str, Any]:
    """Processor, cores, GPU if there is one."""
    import torch

    names = [
        line.partition(":")[2].strip()
        for file in [Path("/proc/cpuinfo")]
        if file.exists()
        for line in file.read_text().splitlines()
        if line.startswith("model name")
    ]
    return {
        "processor": f"{(names or [platform.processor()])[0]} ({platform.machine()})",
        "cores": os.cpu_count(),
        "gpu": torch.cuda.get_device_name() if torch.cuda.is_available() else None,
    }


def _note_file(folder: Path) -> Path:
    return folder.parent / f"{folder.name}.made.json"


def read_note(folder: Path) -> dict[str, Any]:
    """What is noted beside a folder; nothing is known of one without a note."""
    file = _note_file(folder)
    note: dict[str, Any] = {"commits": [], "machine": None}
    return note | (read_json(file) if file.exists() else {})


def write_note(folder: Path, **more: float) -> None:
    """Note beside a folder that work on it begins, or goes on, at this commit on this machine."""
    commits = [known for known in read_note(folder)["commits"] if known != commit()]
    folder.parent.mkdir(parents=True, exist_ok=True)
    note = {"commits": [*commits, commit()], "machine": machine(), **more}
    _note_file(folder).write_text(json.dumps(note, indent=1) + "\n")


def as_text(record: dict[str, Any]) -> str:
    """JSON with a line for every row of numbers."""
    text = json.dumps(record, indent=1)
    return re.sub(r"\[[^][{}]*\]", lambda match: " ".join(match[0].split()), text) + "\n"


def read_records(folder: Path) -> dict[str, dict[str, Any]]:
    """Records of a folder by their names; leaves the program at a file that is none."""
    records = {}
    for file in sorted(folder.glob("*.json")):
        try:
            record = read_json(file)
            missing = {"name", "scenario", "snr_db", "model", "training"} - set(record)
        except (ValueError, TypeError) as error:
            sys.exit(f"reproduce_paper: {file}: is not a record of a run ({error})")
        if missing:
            sys.exit(f"reproduce_paper: {file}: has no {min(missing)!r}; should be a run's record")
        records[record["name"]] = record
    return records


def percent(part: dict[str, Any] | None) -> str:
    """Accuracy with its interval."""
    if part is None:
        return UNKNOWN
    low, high = part["accuracy_95"]
    return f"{100 * part['accuracy']:.2f} ({100 * low:.2f} to {100 * high:.2f})"


def _number(value: float | None, form: str = ".0f", factor: float = 1.0) -> str:
    return UNKNOWN if value is None else f"{factor * value:{form}}"


def _milliseconds(seconds: float | None) -> str:
    """Seconds in ms, below 10 ms with a decimal."""
    return _number(seconds, ".0f" if seconds is None or seconds >= 0.01 else ".1f", 1e3)


def _epochs(record: dict[str, Any]) -> str:
    return f"{record['epochs']}{' (reduced)' if record['reduced'] else ''}"


def _commit(record: dict[str, Any]) -> str:
    known = [
        f"{made['commit'][:7]}{' with changes' if made['dirty'] else ''}"
        for made in record["training"]["commits"]
        if made["commit"]
    ]
    return ", ".join(known) or UNKNOWN


def _hours(record: dict[str, Any]) -> str:
    """Core hours of a training; of one on a GPU its seconds."""
    training = record["training"]
    if training["device"] in ("cpu", None):
        return _number(training["core_hours"], ".2f")
    gpu = (training["machine"] or {}).get("gpu")
    return f"{_number(training['seconds'])} s on {gpu or 'a GPU'}"


def table(head: list[str], rows: list[list[str]]) -> list[str]:
    """A table, as lines of Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return [f"| {' | '.join(line)} |" for line in lines] + [""]


@dataclass(frozen=True)
class Row:
    """A row of a table: a run that is wanted, its record if there is one."""

    training: Training
    name: str
    record: dict[str, Any] | None
    link: str

    def cells(self, first: list[str], count: int) -> list[str]:
        """The first cells, then "not run" in the others, which are `count`."""
        return first + [NOT_RUN] + [""] * (count - len(first) - 1)

    def ending(self) -> list[str]:
        """Core hours of training, its commit, the record."""
        assert self.record is not None
        return [_hours(self.record), _commit(self.record), f"[JSON]({self.link})"]


def rows_of(name: str, scale: Scale, records: dict[str, dict[str, Any]]) -> list[Row]:
    """The runs of a scale in its order, then what else has a record."""
    trainings = {run_name(scale, training): training for training in scale.trainings}
    for key, record in records.items():
        other = Training(
            record["scenario"],
            record["snr_db"],
            record["model"],
            by_subject=record["subjects"] is not None,
            learning_rate=record["config"]["learning_rate"],
            seed=record["config"]["seed"],
        )
        trainings.setdefault(key, other)
    return [
        Row(training, key, records.get(key), f"{FOLDER}/{name}/{key}.json")
        for key, training in trainings.items()
    ]


def tables(name: str, records: dict[str, dict[str, Any]]) -> list[str]:
    """The tables of a scale, as lines of Markdown, out of its records alone."""
    scale = SCALES[name]
    rows = rows_of(name, scale, records)
    left_out = [row.name for row in rows if scale.on_gpu and row.record is None]
    rows = [row for row in rows if row.name not in left_out]
    maps = 12 * scale.per_class
    lines = [
        f"Maps of {scale.size_px} x {scale.size_px} px, {maps} a data set, 8:2; fresh seed: "
        f"{12 * scale.fresh_per_class} maps. `python scripts/reproduce_paper.py --scale {name} "
        "--only RUN` makes the row whose record is RUN.json.",
        "",
    ]
    order = list(SCENARIOS)
    rows.sort(key=lambda row: (order.index(row.training.scenario), -(row.training.snr_db or 0)))
    drawn = [row for row in rows if row.training.snr_db is None]
    plain = [row for row in rows if _plain(row.training) and row not in drawn]
    apart = [row for row in rows if row.training.by_subject]
    networks = [row for row in rows if row.training.snr_db == 30 and not row.training.by_subject]
    lines += ["### Accuracy by SNR and scenario", "", *_by_snr(plain)]
    lines += ["### Trained at one SNR, tested at the others (fresh seed)", ""]
    for scenario in SCENARIOS:
        if mine := [row for row in plain if row.training.scenario == scenario]:
            lines += _robustness(scale, scenario, mine)
    if drawn:
        lines += _one_network(drawn, plain)
    if apart:
        lines += _subjects(apart)
    lines += ["### Networks at 30 dB", "", *_networks(networks)]
    if noted := [row.record for row in rows if row.record and row.record["note"]]:
        lines += [*(f"- {record['name']}: {record['note']}" for record in noted), ""]
    if left_out:
        lines += [f"Not run: {', '.join(left_out)}.", ""]
    return lines


def _by_snr(rows: list[Row]) -> list[str]:
    head = ["scenario", "SNR (dB)", "epochs", "best epoch", "validation", "fresh seed", "paper"]
    head += ENDING
    body = []
    for row in rows:
        t, record = row.training, row.record
        paper = PAPER_BY_SNR.get((t.scenario, t.snr_db), "not given")
        cells = [SCENARIOS[t.scenario], str(t.snr_db)]
        if record is None:
            body.append([*cells, NOT_RUN, "", "", "", paper, "", "", ""])
            continue
        cells += [_epochs(record), _number(record["best_epoch"]), percent(record["validation"])]
        cells += [percent(record["fresh"].get(str(t.snr_db))), paper, *row.ending()]
        body.append(cells)
    return table(head, body)


def _robustness(scale: Scale, scenario: str, rows: list[Row]) -> list[str]:
    snrs = tested_snrs(scale, scenario)
    body = []
    for row in rows:
        cells = [f"{row.training.snr_db} dB"]
        if row.record is None:
            body.append(row.cells(cells, len(snrs) + 1))
            continue
        if row.record["reduced"]:
            cells = [f"{cells[0]} (reduced)"]
        parts = [row.record["fresh"].get(str(snr)) for snr in snrs]
        body.append(
            cells
            + [NOT_RUN if part is None else _number(part["accuracy"], ".2f", 100) for part in parts]
        )
    return table(
        [f"{SCENARIOS[scenario]}, trained at", *(f"tested at {snr} dB" for snr in snrs)], body
    )


def _one_network(rows: list[Row], specialists: list[Row]) -> list[str]:
    """One network for every SNR beside those trained at the SNR at which they are tested."""
    low, high = DRAWN_SNR
    head = ["scenario", "network", *(f"{snr} dB" for snr in DRAWN_TESTED), "epochs", *ENDING]
    body = []
    for row in rows:
        scenario, record = row.training.scenario, row.record
        cells = [SCENARIOS[scenario], f"one, trained at {low} to {high} dB"]
        if record is None:
            body.append(row.cells(cells, len(head)))
        else:
            cells += [percent(record["fresh"].get(str(snr))) for snr in DRAWN_TESTED]
            body.append([*cells, _epochs(record), *row.ending()])
        own = {
            other.training.snr_db: other.record
            for other in specialists
            if other.training.scenario == scenario and other.record
        }
        cells = [SCENARIOS[scenario], "of that SNR alone"]
        for snr in DRAWN_TESTED:
            part = own[snr]["fresh"].get(str(snr)) if snr in own else None
            reduced = " (reduced)" if part and own[snr]["reduced"] else ""
            cells.append(percent(part) + reduced if part else NOT_RUN)
        body.append([*cells, *[""] * (len(head) - len(cells))])
    words = (
        f"Trained on maps whose SNR is drawn (`snr_db: {{uniform: {[low, high]}}}`, "
        "`configs/train/robust.yaml`), tested on the fresh seed, beside the "
        "networks of the table above that were trained at the SNR at which they are tested."
    )
    return ["### One network for every SNR", "", words, "", *table(head, body)]


def _subjects(rows: list[Row]) -> list[str]:
    head = ["scenario", "SNR (dB)", "epochs", "validation on persons never seen", *ENDING]
    body = []
    for row in rows:
        t, record = row.training, row.record
        cells = [SCENARIOS[t.scenario], str(t.snr_db)]
        body.append(
            row.cells(cells, len(head))
            if record is None
            else [*cells, _epochs(record), percent(record["validation"]), *row.ending()]
        )
    return [
        f"### Persons kept apart (`split.by: subject`, {SUBJECTS} persons)",
        "",
        *table(head, body),
    ]


def _networks(rows: list[Row]) -> list[str]:
    head = [
        "scenario",
        "network",
        "epochs",
        "validation",
        "paper",
        "fresh seed",
        "parameters (M)",
        "paper (M)",
        "one image (ms)",
        "with loading (ms)",
        "paper (ms)",
        *ENDING,
    ]
    body = []
    for row in rows:
        t, record = row.training, row.record
        paper = PAPER.get((t.scenario, t.model))
        theirs = (
            [_number(paper[0], ".2f"), _number(paper[1], ".2f"), _number(paper[2], ".0f", 1e3)]
            if paper
            else ["not given"] * 3
        )
        cells = [SCENARIOS[t.scenario], ", ".join([t.model, *t.named_settings])]
        if record is None:
            body.append(
                [*cells, NOT_RUN, "", theirs[0], "", "", theirs[1], "", "", theirs[2], "", "", ""]
            )
            continue
        speed = record["speed"] or {}
        load = record["evaluation"].get("load")
        busy = " (busy)" if load and load > record["evaluation"]["machine"]["cores"] else ""
        cells += [_epochs(record), percent(record["validation"]), theirs[0]]
        cells.append(percent(record["fresh"].get(str(t.snr_db))))
        cells += [_number(record["parameters"], ".2f", 1e-6), theirs[1]]
        cells += [_milliseconds(speed.get(key)) + busy for key in ("image_s", "load_and_image_s")]
        body.append([*cells, theirs[2], *row.ending()])
    return table(head, body)


def _snr_order(snr_db: int | None) -> float:
    """The SNR; one that is drawn comes below all others."""
    return -inf if snr_db is None else snr_db


def _shown_part(record: dict[str, Any]) -> dict[str, Any] | None:
    """The result on the fresh seed whose confusion matrix is shown, if mistakes are to be seen.

    Of the paper's network alone.
    """
    if record["model"] != "fftnet":
        return None
    drawn = record["snr_db"] is None
    snr = DRAWN_SHOWN[record["scenario"]] if drawn else record["snr_db"]
    part: dict[str, Any] | None = record["fresh"].get(str(snr))
    return part if part and part["accuracy"] < FEW_MISTAKES else None


def confusion_figures(name: str, results: Path, records: dict[str, dict[str, Any]]) -> None:
    """Draw the confusion matrices on the fresh seed of records that have one to be shown."""
    from radhar_cli.figures.evaluation import confusion_png

    for key, record in records.items():
        if part := _shown_part(record):
            title = f"{SCENARIOS[record['scenario']]}, {part['snr_db']:.0f} dB, fresh seed: "
            title += f"{100 * part['accuracy']:.2f} % of {part['images']}"
            png = confusion_png(np.array(part["confusion"]), record["labels"], title)
            (results / name / f"{key}_confusion.png").write_bytes(png)


def snr_figures(name: str, results: Path, records: dict[str, dict[str, Any]]) -> None:
    """Draw the accuracy over the SNR of each scenario, a line for every record."""
    from radhar_cli.figures.evaluation import Point, robustness_png

    for scenario in SCENARIOS:
        mine = [record for record in records.values() if record["scenario"] == scenario]
        lines = {
            f"trained at {_snr(record['snr_db'])}{', reduced' if record['reduced'] else ''}": [
                Point(snr, float(snr), part["accuracy"], *part["accuracy_95"])
                for snr, part in record["fresh"].items()
            ]
            for record in sorted(mine, key=lambda record: -_snr_order(record["snr_db"]))
            if len(record["fresh"]) > 1
        }
        if lines:
            (results / name / f"{scenario}_snr.png").write_bytes(robustness_png(lines))


def figures(name: str, results: Path, records: dict[str, dict[str, Any]]) -> list[str]:
    """The figures that are there, as lines of Markdown."""
    named = []
    for scenario, words in SCENARIOS.items():
        named.append((f"{scenario}_snr.png", f"Accuracy over the SNR of the test, {words}."))
        rows = rows_of(name, SCALES[name], records)
        for row in sorted(rows, key=lambda row: -_snr_order(row.training.snr_db)):
            t = row.training
            if t.scenario == scenario:
                if row.record and (part := _shown_part(row.record)):
                    trained = f"trained at {_snr(t.snr_db)}, tested at {part['snr_db']:.0f} dB"
                    caption = f"Confusion matrix, fresh seed, {words}, {trained}."
                    named.append((f"{row.name}_confusion.png", caption))
                named += [
                    (f"{row.name}_{figure}.png", f"{caption}, {words}, {_snr(t.snr_db)}.")
                    for figure, caption in _figures(t).items()
                ]
    return [
        line
        for file, caption in named
        if (results / name / file).exists()
        for line in (f"![{caption}]({FOLDER}/{name}/{file})", "", caption, "")
    ]


def page_text(scales: tuple[str, ...], results: Path) -> str:
    """What stands between the markers of the page: every scale that has a record."""
    lines = [
        "Printed by `python scripts/reproduce_paper.py --scale cpu --report-only` from the records "
        f"in docs/records/{FOLDER}. Accuracy in per cent with Wilson's 95 % interval. The epoch is "
        "chosen by the validation maps, so their accuracy is optimistic; no choice was made on the "
        "fresh seed. Core hours: seconds of all epochs times threads, with what else the machine "
        "did meanwhile; on a GPU the seconds, of which several runs at a time had their share. "
        "Commit: of the training. Networks are tested in float32, the best epoch is "
        "chosen in the precision of the training. Latency is marked busy where more processes ran "
        "than there are cores. On the GPU it was "
        "measured with all other work stopped, the weights copied there at each loading.",
        "",
    ]
    for name in scales:
        records = read_records(results / name)
        size = SCALES[name].size_px
        lines += [f"## Maps of {size} px (`--scale {name}`)", ""]
        if records:
            lines += tables(name, records)
            lines += figures(name, results, records)
        else:
            lines += ["Not run.", ""]
    return "\n".join(lines)


def write_page(path: Path, text: str) -> None:
    """Replace what stands between the markers of a page; the words around it stay."""
    page = path.read_text() if path.exists() else "# Results\n\n"
    if BEGIN not in page:
        page += f"{BEGIN}\n{END}\n"
    path.write_text(replace_part(page, "tables", text, BEGIN, END))


def wanted(scale: Scale, words: list[str], results: Path, again: bool) -> list[Training]:
    """Runs whose names have all the words; of those with a record of all epochs only `again`."""
    records = read_records(results)
    full = {name for name, record in records.items() if not record["reduced"] and not again}
    names = {training: run_name(scale, training) for training in scale.trainings}
    return [
        training
        for training, name in names.items()
        if name not in full and all(word in name for word in words)
    ]


def report(name: str, page: Path) -> None:
    """Write the page from the records beside it."""
    results = page.parent / FOLDER
    scales = PAGE_SCALES if name in PAGE_SCALES else (name,)
    for scale in scales:
        records = read_records(results / scale)
        snr_figures(scale, results, records)
        confusion_figures(scale, results, records)
    write_page(page, page_text(scales, results))
    print(f"wrote {page}")


def main() -> None:
    """Run a scale."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scale", choices=SCALES, required=True)
    parser.add_argument("--only", nargs="*", default=[], help="words that a run's name contains")
    parser.add_argument(
        "--report-only", action="store_true", help="write the tables from the records, no more"
    )
    parser.add_argument(
        "--filters", action="store_true", help="draw the global filters of the networks, no more"
    )
    parser.add_argument("--again", action="store_true", help="also rows that have a record")
    parser.add_argument("--jobs", type=int, help="processes that generate")
    parser.add_argument("--datasets", type=Path, default=ROOT / "datasets" / "results")
    parser.add_argument("--runs", type=Path, default=ROOT / "runs" / "results")
    parser.add_argument("--page", type=Path, help="default: docs/records/runs.md; smoke: in --runs")
    options = parser.parse_args()
    scale = SCALES[options.scale]
    smoke = options.scale not in PAGE_SCALES
    page = options.page or (options.runs / "smoke.md" if smoke else ROOT / "docs/records/runs.md")
    results = page.parent / FOLDER / options.scale
    names = [run_name(scale, training) for training in scale.trainings]
    if not any(all(word in name for word in options.only) for name in names):
        parser.error(f"--only {' '.join(options.only)}: no run has that; runs: {', '.join(names)}")
    # Commands run in the root of the repository, whatever the folder this was called in.
    folders = options.datasets.absolute(), options.runs.absolute()
    work = Reproduction(options.scale, scale, *folders, results, options.jobs)
    if options.filters:
        chosen = [
            t
            for t, n in zip(scale.trainings, names, strict=True)
            if all(w in n for w in options.only)
        ]
        work.draw_filters(chosen, ROOT / "docs" / "images")
        return
    todo = [] if options.report_only else wanted(scale, options.only, results, options.again)
    if not todo and not options.report_only:
        print("there is a record of all epochs of what is asked for; --again runs it again")
    for training in todo:
        work.train(training)
        work.record(training)
        report(options.scale, page)
    report(options.scale, page)


if __name__ == "__main__":
    main()
