"""Build the paper's data sets, train its networks, evaluate them, and write docs/results.md.

    python scripts/reproduce_paper.py --scale smoke|cpu|full [--only NAME ...] [--report-only]

Every step is a `radhar` command and resumes where it was stopped; run the same line again. A run
that is not there is left out of the tables and named. See SCALES for what each scale does.
"""

import argparse
import json
import platform
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
BEGIN, END = "<!-- tables: scripts/reproduce_paper.py -->", "<!-- end of tables -->"
SCENARIOS = {"free_space": "free space", "through_wall": "through the wall"}
FRESH_SEED = 20261121
SUBJECTS = 20

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


@dataclass(frozen=True)
class Training:
    """One run: a scenario, an SNR, a network, its settings, and how the data are split."""

    scenario: str
    snr_db: int
    model: str = "fftnet"
    epochs: int = 20
    drop_every: int = 10
    by_subject: bool = False

    @property
    def settings(self) -> list[str]:
        """Overrides of the paper's training config."""
        if (self.epochs, self.drop_every) == (20, 10):
            return []
        epochs = [f"epochs={self.epochs}"]
        return epochs + (
            [f"schedule.every_epochs={self.drop_every}"] if self.drop_every != 10 else []
        )


@dataclass(frozen=True)
class Scale:
    """How much of the paper is run.

    Attributes:
        size_px: side of the maps; the paper's is 256.
        per_class: maps a class for training and validation; the paper's is 300.
        fresh_per_class: maps a class of the fresh seed.
        trainings: in the order in which they are run.
    """

    size_px: int
    per_class: int
    fresh_per_class: int
    trainings: tuple[Training, ...]
    generate: tuple[str, ...] = ()
    train: tuple[str, ...] = field(default=())


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
        ),
        generate=("radar.prf_hz=500", "radar.carrier_hz=10e9"),
        train=("batch_size=12",),
    ),
    # Two cores, a night: the paper's protocol with maps of half its size, the hardest rows first.
    "cpu": Scale(
        size_px=128,
        per_class=300,
        fresh_per_class=100,
        trainings=(
            *(Training(s, n) for n in (30, -10, 10, 20, 0) for s in ("through_wall", "free_space")),
            *(Training(s, 30, by_subject=True) for s in ("through_wall", "free_space")),
            *(Training(s, 30, "mobilenetv2_100") for s in ("through_wall", "free_space")),
            Training("free_space", 30, "resnet50"),
        ),
    ),
    # The paper's protocol, for a GPU.
    "full": Scale(
        size_px=256,
        per_class=300,
        fresh_per_class=100,
        trainings=(
            *(Training(s, n) for n in (30, 20, 10, 0, -10) for s in SCENARIOS),
            *(Training(s, 30, by_subject=True) for s in SCENARIOS),
            *(Training(s, 30, m) for m in RIVALS for s in SCENARIOS),
        ),
    ),
}


@dataclass
class Reproduction:
    """The steps of one scale and what they left."""

    name: str
    scale: Scale
    data_root: Path
    runs_root: Path
    jobs: int | None

    def data(self, scenario: str, snr_db: int, kind: str = "") -> Path:
        """Folder of a data set; `kind` is fresh or subjects."""
        ending = f"_{kind}" if kind else ""
        return self.data_root / f"{scenario}_{snr_db}dB_{self.scale.size_px}px{ending}"

    def run(self, training: Training) -> Path:
        """Folder of a run."""
        kind = "_subjects" if training.by_subject else ""
        stem = f"{training.scenario}_{training.snr_db}dB_{self.scale.size_px}px{kind}"
        return self.runs_root / f"{stem}_{training.model}"

    def generate(self, scenario: str, snr_db: int, kind: str = "") -> None:
        """Build a data set, or find it complete."""
        scale = self.scale
        per_class = scale.fresh_per_class if kind == "fresh" else scale.per_class
        settings = [
            f"image.size_px={scale.size_px}",
            f"samples_per_class={per_class}",
            f"snr_db={snr_db}",
            "output.png=false",
            *(scale.generate if scenario == "free_space" else ()),
        ]
        if kind == "fresh":
            settings.append(f"seed={FRESH_SEED}")
        if kind == "subjects":
            settings += ["split.by=subject", f"split.subjects={min(SUBJECTS, per_class)}"]
        config = ROOT / "configs" / "paper" / f"{scenario}.yaml"
        jobs = ["--jobs", str(self.jobs)] if self.jobs else []
        radhar("generate", config, "-o", self.data(scenario, snr_db, kind), *_set(settings), *jobs)

    def train(self, training: Training) -> None:
        """Build the data of a run and train it, or find it complete."""
        kind = "subjects" if training.by_subject else ""
        self.generate(training.scenario, training.snr_db, kind)
        radhar(
            "train",
            self.data(training.scenario, training.snr_db, kind),
            "-o",
            self.run(training),
            "--model",
            training.model,
            *_set([*training.settings, *self.scale.train]),
        )

    def finished(self) -> list[Training]:
        """Runs that have come to their end."""
        return [t for t in self.scale.trainings if (self.run(t) / "metrics.json").exists()]

    def evaluate(self, folder: Path) -> dict[str, Any]:
        """Evaluate every finished run; returns {what: report.json} and leaves the figures."""
        done, reports = self.finished(), {}
        for training in done:
            kind = "subjects" if training.by_subject else ""
            out = folder / self.run(training).name
            reports[out.name] = self._eval(
                out,
                [self.run(training)],
                [self.data(training.scenario, training.snr_db, kind)],
                "val",
                *(["--tsne"] if self._first(training) else []),
                *(["--in-place-vs-moving"] if training.model == "fftnet" else []),
            )
        for scenario in SCENARIOS:
            mine = [t for t in done if t.scenario == scenario and _plain(t)]
            if not mine:
                continue
            for training in mine:
                if not (self.data(scenario, training.snr_db, "fresh") / "dataset.h5").exists():
                    self.generate(scenario, training.snr_db, "fresh")
            fresh = [self.data(scenario, t.snr_db, "fresh") for t in mine]
            out = folder / f"{scenario}_fresh"
            runs = [self.run(t) for t in mine]
            reports[out.name] = self._eval(out, runs, fresh, "all", "--filters")
        return reports

    def _first(self, training: Training) -> bool:
        return training.snr_db == 30 and _plain(training)

    def _eval(
        self, out: Path, runs: list[Path], data: list[Path], split: str, *more: str
    ) -> dict[str, Any]:
        stamp = out / "report.json"
        newest = max((run / "metrics.json").stat().st_mtime for run in runs)
        if not stamp.exists() or stamp.stat().st_mtime < newest:
            radhar("eval", *runs, *data, "-o", out, "--split", split, *more)
        report: dict[str, Any] = json.loads(stamp.read_text())
        return report


def _plain(training: Training) -> bool:
    return training.model == "fftnet" and not training.by_subject


def _set(settings: list[str]) -> list[str]:
    return [word for setting in settings for word in ("--set", setting)]


def radhar(*words: object) -> None:
    """Run a radhar command; its own messages say what it does."""
    line = [sys.executable, "-m", "radhar_cli", *map(str, words)]
    print("+ radhar", *map(str, words), flush=True)
    subprocess.run(line, check=True, cwd=ROOT)


def percent(part: dict[str, Any]) -> str:
    """Accuracy with its interval."""
    low, high = part["accuracy_95"]
    return f"{100 * part['accuracy']:.2f} ({100 * low:.2f} to {100 * high:.2f})"


def tables(work: Reproduction, reports: dict[str, Any], figures: list[tuple[str, str]]) -> str:
    """The Markdown between the markers of docs/results.md."""
    done = work.finished()
    missing = [work.run(t).name for t in work.scale.trainings if t not in done]
    not_run = ", ".join(missing) or "nothing; everything of this scale is here"
    size, maps = work.scale.size_px, 12 * work.scale.per_class
    lines = [
        f"Printed by `python scripts/reproduce_paper.py --scale {work.name}` on {_machine()}. "
        f"Maps of {size} x {size} px, {maps} a data set, 8:2. Accuracy in per cent with Wilson's "
        "95 % interval. The epoch is chosen by the validation maps, so their accuracy is "
        "optimistic; no choice was made on the fresh seed.",
        "",
        f"Not run: {not_run}.",
        "",
        "### Accuracy by SNR and scenario",
        "",
        "| scenario | SNR (dB) | epochs | best epoch | validation | fresh seed | paper |",
        "| --- " * 7 + "|",
    ]
    for t in done:
        if _plain(t):
            own = _own(work, reports, t)
            fresh = reports[f"{t.scenario}_fresh"]["runs"]
            row = fresh[_name(fresh, work.run(t))]["data"]
            there = row[_name(row, work.data(t.scenario, t.snr_db, "fresh"))]
            lines.append(
                f"| {SCENARIOS[t.scenario]} | {t.snr_db} | {_epochs(work, t)} "
                f"| {own[0]['best_epoch']} | {percent(own[1])} | {percent(there)} "
                f"| {PAPER_BY_SNR[t.scenario, t.snr_db]} |"
            )
    lines += ["", *_robustness(work, reports, done), *_subjects(work, reports, done)]
    lines += ["", *_models(work, reports, done), ""]
    for name, caption in figures:
        lines += [f"![{caption}](results/{name})", "", caption, ""]
    return "\n".join(lines)


def _own(work: Reproduction, reports: dict[str, Any], t: Training) -> tuple[Any, Any]:
    run = next(iter(reports[work.run(t).name]["runs"].values()))
    return run, next(iter(run["data"].values()))


def _name(known: dict[str, Any], path: Path) -> str:
    return next(name for name in known if name == path.name or name.endswith(path.name))


def _epochs(work: Reproduction, t: Training) -> str:
    """Epochs as the run itself records them."""
    config = json.loads((work.run(t) / "metrics.json").read_text())["config"]
    paper = config["epochs"] == 20 and config["schedule"]["every_epochs"] == 10
    return "20" if paper else f"{config['epochs']} (reduced)"


def _robustness(work: Reproduction, reports: dict[str, Any], done: list[Training]) -> list[str]:
    lines = ["### Trained at one SNR, tested at the others (fresh seed)", ""]
    for scenario, words in SCENARIOS.items():
        mine = [t for t in done if t.scenario == scenario and _plain(t)]
        if len(mine) < 2:
            continue
        mine.sort(key=lambda t: -t.snr_db)
        heads = [f"tested at {t.snr_db} dB" for t in mine]
        lines.append(f"| {words}, trained at | {' | '.join(heads)} |")
        lines.append("| --- " * (len(mine) + 1) + "|")
        runs = reports[f"{scenario}_fresh"]["runs"]
        for t in mine:
            row = runs[_name(runs, work.run(t))]["data"]
            cells = [
                f"{100 * row[_name(row, work.data(scenario, o.snr_db, 'fresh'))]['accuracy']:.2f}"
                for o in mine
            ]
            lines.append(f"| {t.snr_db} dB | {' | '.join(cells)} |")
        lines.append("")
    return lines


def _subjects(work: Reproduction, reports: dict[str, Any], done: list[Training]) -> list[str]:
    mine = [t for t in done if t.by_subject]
    if not mine:
        return []
    lines = [
        f"### Persons kept apart (`split.by: subject`, {SUBJECTS} persons)",
        "",
        "| scenario | SNR (dB) | epochs | validation on persons never seen |",
        "| --- | --- | --- | --- |",
    ]
    return lines + [
        f"| {SCENARIOS[t.scenario]} | {t.snr_db} | {_epochs(work, t)} | "
        f"{percent(_own(work, reports, t)[1])} |"
        for t in mine
    ]


def _models(work: Reproduction, reports: dict[str, Any], done: list[Training]) -> list[str]:
    lines = [
        "### Networks at 30 dB",
        "",
        "| scenario | network | epochs | validation | paper | parameters (M) | paper (M) "
        "| one image (ms) | with loading (ms) | paper (ms) |",
        "| --- " * 10 + "|",
    ]
    for t in done:
        if t.snr_db != 30 or t.by_subject:
            continue
        run, part = _own(work, reports, t)
        paper = PAPER[t.scenario, t.model]
        speed = run["speed"]
        cells = [
            SCENARIOS[t.scenario],
            t.model,
            _epochs(work, t),
            percent(part),
            f"{paper[0]:.2f}",
            f"{run['parameters'] / 1e6:.2f}",
            f"{paper[1]:.2f}",
            *(f"{1e3 * speed[key]:.0f}" for key in ("image_s", "load_and_image_s")),
            f"{1e3 * paper[2]:.0f}",
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def _machine() -> str:
    import torch

    if torch.cuda.is_available():
        return f"{torch.cuda.get_device_name()}, PyTorch {torch.__version__}"
    cores = torch.get_num_threads()
    return f"{cores} cores ({platform.machine()}), PyTorch {torch.__version__}"


def keep_figures(work: Reproduction, reports: Path, folder: Path) -> list[tuple[str, str]]:
    """Copy the figures worth keeping into docs/results; returns (file, caption)."""
    wanted = []
    for scenario, words in SCENARIOS.items():
        run = work.run(Training(scenario, 30)).name
        wanted += [
            (f"{scenario}_fresh/curves.png", f"Training curves, {words}, by SNR."),
            (f"{run}/confusion.png", f"Confusion matrix, {words}, 30 dB, validation."),
            (f"{run}/tsne.png", f"t-SNE of maps and of features, {words}, 30 dB."),
            (f"{scenario}_fresh/filters.png", f"Global filters, {words}, by SNR."),
            (f"{scenario}_fresh/robustness.png", f"Trained at one SNR, tested at all, {words}."),
        ]
    found = []
    for source, caption in wanted:
        if (reports / source).exists():
            folder.mkdir(parents=True, exist_ok=True)
            name = f"{work.name}_{source.replace('/', '_')}"
            shutil.copyfile(reports / source, folder / name)
            found.append((name, caption))
    return found


def write_report(path: Path, text: str) -> None:
    """Replace what stands between the markers of a page; the words around it stay."""
    page = path.read_text() if path.exists() else f"# Results\n\n{BEGIN}\n{END}\n"
    before, _, rest = page.partition(BEGIN)
    after = rest.partition(END)[2]
    path.write_text(f"{before}{BEGIN}\n{text}\n{END}{after}")


def main() -> None:
    """Run a scale."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scale", choices=SCALES, required=True)
    parser.add_argument("--only", nargs="*", default=[], help="words that a run's name contains")
    parser.add_argument(
        "--report-only", action="store_true", help="train nothing; evaluate what is there"
    )
    parser.add_argument("--jobs", type=int, help="processes that generate")
    parser.add_argument("--datasets", type=Path, default=ROOT / "datasets" / "results")
    parser.add_argument("--runs", type=Path, default=ROOT / "runs" / "results")
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "results.md")
    asked = parser.parse_args()
    work = Reproduction(asked.scale, SCALES[asked.scale], asked.datasets, asked.runs, asked.jobs)
    for training in work.scale.trainings:
        name = work.run(training).name
        if not asked.report_only and all(word in name for word in asked.only):
            work.train(training)
    reports_folder = asked.runs / f"reports_{asked.scale}"
    reports = work.evaluate(reports_folder)
    figures = keep_figures(work, reports_folder, asked.page.parent / "results")
    write_report(asked.page, tables(work, reports, figures))
    print(f"wrote {asked.page}")


if __name__ == "__main__":
    main()
