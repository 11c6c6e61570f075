"""`radhar eval`: every figure and table of some runs on some data sets."""

import csv
import io
import json
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import torch
from torch import nn

from radhar_cli.activity import ACTIVITIES
from radhar_cli.arrays import Index
from radhar_cli.dataset.files import write_whole
from radhar_cli.errors import FolderError
from radhar_cli.figures.confusion import confusion_csv, confusion_png
from radhar_cli.figures.curves import curves_png
from radhar_cli.figures.embedding import embeddings_png
from radhar_cli.figures.filters import filters_png
from radhar_cli.figures.mistakes import captioned_png
from radhar_cli.figures.reliability import reliability_png
from radhar_cli.figures.robustness import Point, robustness_png
from radhar_cli.learning import metrics
from radhar_cli.learning.evaluation import Predictions, open_for, predict, speed
from radhar_cli.learning.filter_weights import magnitudes, table
from radhar_cli.learning.images import ImageSet, scan
from radhar_cli.learning.models.build import cost
from radhar_cli.learning.run_folder import (
    About,
    Epoch,
    RunError,
    best_epoch,
    load_best,
    read_history,
    read_trained_on,
)

MOST_MISTAKES = 12
GROUPS = ("in place", "moving")


class Progress(Protocol):
    """Who is told how far an evaluation is."""

    def say(self, message: str) -> None:
        """Something the user should read."""


@dataclass(frozen=True)
class Asked:
    """What the user wants besides the numbers."""

    split: str = "val"
    map: str | None = None
    tsne: bool = False
    filters: bool = False
    in_place_vs_moving: bool = False
    batch: int = 32


@dataclass
class Report:
    """Files of a report, in the order in which they are read, and its numbers."""

    numbers: dict[str, Any]
    figures: list[tuple[str, str, bytes]] = field(default_factory=list)
    tables: list[tuple[str, str]] = field(default_factory=list)

    def figure(self, name: str, caption: str, png: bytes) -> None:
        """Add a figure."""
        self.figures.append((name, caption, png))

    def write(self, folder: Path) -> None:
        """Write everything into a folder; report.json comes last."""
        from radhar_cli.learning.report_page import report_html

        for name, _, png in self.figures:
            write_whole(folder, folder / name, png)
        for name, text in self.tables:
            write_whole(folder, folder / name, text.encode())
        write_whole(
            folder, folder / "report.html", report_html(self.numbers, self.figures).encode()
        )
        text = json.dumps(self.numbers, indent=2) + "\n"
        write_whole(folder, folder / "report.json", text.encode())


@dataclass(frozen=True)
class _Run:
    name: str
    folder: Path
    about: About
    model: nn.Module
    history: list[Epoch]


def evaluate(
    runs: Sequence[Path],
    data: Sequence[Path],
    asked: Asked,
    device: torch.device,
    progress: Progress,
) -> Report:
    """Evaluate every run on every data set.

    Raises:
        RunError: a run that cannot be read.
        FolderError: data that does not fit a run.
    """
    opened = [_open_run(name, path, device) for name, path in _named(runs).items()]
    named_data = _named(data)
    for run in opened:  # what does not fit is said before anything is computed
        for path in named_data.values():
            open_for(run.about, path, asked.map).rows(asked.split)
    report = Report(
        {
            "split": asked.split,
            "device": device.type,
            "machine": platform.machine(),
            "threads": torch.get_num_threads(),
            "runs": {},
        }
    )
    lines: dict[str, list[Point]] = {}
    for run in opened:
        progress.say(f"{run.name}: {run.about.model}, {len(run.about.classes)} classes")
        results = {}
        for data_name, path in named_data.items():
            one = len(opened) == len(named_data) == 1
            stem = "" if one else f"_{run.name}_{data_name}"
            answers, numbers = _evaluate_one(report, run, data_name, path, stem, asked, device)
            results[data_name] = numbers
            low, high = numbers["accuracy_95"]
            point = Point(data_name, answers.images.snr_db, numbers["accuracy"], low, high)
            lines.setdefault(run.name, []).append(point)
            progress.say(
                f"  {data_name}, {asked.split}: {100 * numbers['accuracy']:.2f} % "
                f"({100 * low:.2f} to {100 * high:.2f} %) of {numbers['images']}"
            )
            if numbers["seen_in_training"]["images"] or numbers["seen_in_training"]["scenes"]:
                progress.say(f"  warning: {_seen_message(numbers)}")
        first = open_for(run.about, data[0], asked.map)
        report.numbers["runs"][run.name] = {
            **_about_run(run),
            "speed": speed(run.folder, first, int(first.rows(asked.split)[0]), device, asked.batch),
            "data": results,
        }
    _across(report, opened, lines, asked)
    return report


def _open_run(name: str, path: Path, device: torch.device) -> _Run:
    about, model = load_best(path)
    folder = path if path.is_dir() else path.parent
    try:
        history = read_history(folder)
    except RunError:
        history = []  # weights alone, copied from elsewhere
    return _Run(name, path, about, model.to(device), history)


def _named(paths: Sequence[Path]) -> dict[str, Path]:
    """A short name for every path: its last part, with more of it where two are alike.

    Raises:
        FolderError: the same path twice.
    """
    parts = [p.resolve().parent if p.is_file() else p.resolve() for p in paths]
    for depth in range(1, 40):
        names = ["-".join(p.parts[-depth:]) for p in parts]
        if len(set(names)) == len(names):
            return dict(zip(names, paths, strict=True))
    raise FolderError(f"{paths[0]}: is given twice")


def _about_run(run: _Run) -> dict[str, Any]:
    price = cost(run.about.model, len(run.about.classes), run.about.size)
    return {
        "model": run.about.model,
        "parameters": price.parameters,
        "multiply_adds": price.multiply_adds,
        "size_px": list(run.about.size),
        "map": run.about.map,
        "trained_on": run.about.data,
        "epochs": len(run.history),
        "best_epoch": best_epoch(run.history).epoch if run.history else None,
    }


def _evaluate_one(
    report: Report,
    run: _Run,
    data_name: str,
    path: Path,
    stem: str,
    asked: Asked,
    device: torch.device,
) -> tuple[Predictions, dict[str, Any]]:
    images = open_for(run.about, path, asked.map)
    rows = images.rows(asked.split)
    answers = predict(run.model, run.about, images, rows, device, asked.batch)
    names, title = run.about.classes, f"{run.name} on {data_name}, {asked.split}"
    numbers = metrics.summary(answers.truth, answers.probabilities, names)
    numbers["seen_in_training"] = _seen(run, images, rows)
    numbers["snr_db"] = images.snr_db
    counts = np.array(numbers["confusion"])
    right = 100 * numbers["accuracy"]
    report.figure(
        f"confusion{stem}.png",
        f"Confusion matrix of {title}: counts, and shares of the true class.",
        confusion_png(counts, names, f"{title}: {right:.2f} % of {rows.size}"),
    )
    report.tables.append((f"confusion{stem}.csv", confusion_csv(counts, names)))
    report.tables.append((f"predictions{stem}.csv", _predictions_csv(answers, names)))
    if asked.in_place_vs_moving:
        _in_place_vs_moving(report, answers, names, stem, title, numbers)
    bins = metrics.calibration(answers.truth, answers.probabilities)
    report.figure(
        f"reliability{stem}.png",
        f"How often predictions of each confidence are right, {title}.",
        reliability_png(
            bins.confidence,
            bins.accuracy,
            bins.count.astype(float),
            f"calibration error {100 * bins.error:.2f} %",
        ),
    )
    _mistakes(report, answers, names, stem, title)
    if asked.tsne:
        _tsne(report, answers, names, stem, title, numbers)
    return answers, numbers


def _seen(run: _Run, images: ImageSet, rows: Index) -> dict[str, int]:
    """How many of the evaluated images, and of the scenes behind them, were trained on."""
    folder = run.folder if run.folder.is_dir() else run.folder.parent
    pixels, scenes = read_trained_on(folder)
    prints = scan(images, rows).prints if pixels else ()
    return {
        "images": sum(p in pixels for p in prints),
        "scenes": sum(images.scenes[row] in scenes for row in rows) if images.scenes else 0,
    }


def _seen_message(numbers: Mapping[str, Any]) -> str:
    seen = numbers["seen_in_training"]
    return (
        f"{seen['images']} of these {numbers['images']} images, and the person and motion of "
        f"{seen['scenes']}, were trained on: this is no test of what the network has not seen"
    )


def _predictions_csv(answers: Predictions, names: Sequence[str]) -> str:
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["image", "true", "predicted", "probability"])
    best = answers.probabilities.max(1)
    for place, row in enumerate(answers.rows):
        predicted = int(answers.predicted[place])
        writer.writerow(
            [
                answers.images.names[row],
                names[int(answers.truth[place])],
                names[predicted],
                f"{best[place]:.6f}",
            ]
        )
    return text.getvalue()


def _in_place_vs_moving(
    report: Report,
    answers: Predictions,
    names: Sequence[str],
    stem: str,
    title: str,
    numbers: dict[str, Any],
) -> None:
    """The paper's two groups: S1 to S7 against S8 to S12.

    Raises:
        FolderError: a class that is none of ours.
    """
    moving = {activity.slug: activity.number >= 8 for activity in ACTIVITIES}
    for name in names:
        if name not in moving:
            raise FolderError(
                f"--in-place-vs-moving: {name!r} is none of the twelve activities; its group is "
                "unknown"
            )
    group = np.array([int(moving[name]) for name in names])
    counts = metrics.confusion(group[answers.truth], group[answers.predicted], 2)
    numbers["in_place_vs_moving"] = counts.tolist()
    share = 100 * np.trace(counts) / max(1, counts.sum())
    report.figure(
        f"in_place_vs_moving{stem}.png",
        f"Standing activities (S1 to S7) against moving ones (S8 to S12), {title}.",
        confusion_png(counts, GROUPS, f"{share:.2f} %"),
    )
    report.tables.append((f"in_place_vs_moving{stem}.csv", confusion_csv(counts, GROUPS)))


def _mistakes(
    report: Report, answers: Predictions, names: Sequence[str], stem: str, title: str
) -> None:
    """The surest mistakes, or the least sure right answers where there are none."""
    sure, wrong = answers.probabilities.max(1), answers.predicted != answers.truth
    order = np.argsort(-sure, kind="stable")
    chosen = order[wrong[order]][:MOST_MISTAKES]
    what = "The mistakes it is surest of"
    if not chosen.size:
        chosen, what = order[::-1][: MOST_MISTAKES // 3], "No mistakes; the least sure answers"
    images = [answers.images.pixels.read(int(answers.rows[i])) for i in chosen]
    captions = [
        f"{names[int(answers.truth[i])]}\n-> {names[int(answers.predicted[i])]}, "
        f"{100 * sure[i]:.0f} %"
        for i in chosen
    ]
    report.figure(f"hardest{stem}.png", f"{what}, {title}.", captioned_png(images, captions, what))


def _tsne(
    report: Report,
    answers: Predictions,
    names: Sequence[str],
    stem: str,
    title: str,
    numbers: dict[str, Any],
) -> None:
    from radhar_cli.learning.embedding import chosen, embed, separation, shrunk

    picked = chosen(answers.rows.size)
    maps = np.stack([shrunk(answers.images.pixels.read(int(answers.rows[i]))) for i in picked])
    features, label = answers.features[picked], answers.truth[picked]
    before, after = separation(maps, label), separation(features, label)
    numbers["silhouette"] = {"maps": before, "features": after}
    panels = {"input maps": embed(maps), "features before the last layer": embed(features)}
    silhouettes = " and ".join("unknown" if s is None else f"{s:.2f}" for s in (before, after))
    report.figure(
        f"tsne{stem}.png",
        f"t-SNE of {len(picked)} maps and of their features, {title}; silhouettes {silhouettes}.",
        embeddings_png(panels, label, names, title),
    )


def _across(
    report: Report, runs: Sequence[_Run], lines: Mapping[str, Sequence[Point]], asked: Asked
) -> None:
    """What compares runs or data sets."""
    with_history = {run.name: run.history for run in runs if run.history}
    if with_history:
        best = {name: best_epoch(rows).epoch for name, rows in with_history.items()}
        report.figure("curves.png", "Training curves.", curves_png(with_history, best))
    if any(len(points) > 1 for points in lines.values()):
        caption = "Accuracy over the data sets."
        report.figure("robustness.png", caption, robustness_png(lines))
        rows = ["run,data,snr_db,accuracy,low_95,high_95"]
        rows += [
            f"{name},{p.data},{'' if p.snr_db is None else p.snr_db},{p.accuracy:.6f},{p.low:.6f},"
            f"{p.high:.6f}"
            for name, points in lines.items()
            for p in points
        ]
        report.tables.append(("robustness.csv", "\n".join(rows) + "\n"))
    if asked.filters:
        filters = {run.name: magnitudes(run.model) for run in runs}
        filters = {name: found for name, found in filters.items() if found}
        if not filters:
            raise RunError("--filters: none of these networks has global filters; fftnet has six")
        report.figure(
            "filters.png",
            "Magnitude of the global filters by spatial frequency, mean over channels; the zero "
            "frequency is in the middle.",
            filters_png(filters),
        )
        tables = {name: table(found) for name, found in filters.items()}
        report.numbers["filters"] = tables
        keys = list(next(iter(tables.values()))[0])
        rows = [",".join(["run", *keys])]
        rows += [
            ",".join([name, *(str(row[key]) for key in keys)])
            for name, found in tables.items()
            for row in found
        ]
        report.tables.append(("filters.csv", "\n".join(rows) + "\n"))
