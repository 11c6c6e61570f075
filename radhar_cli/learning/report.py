"""`radhar eval`: every figure and table of some runs on some data sets."""

import json
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import nan
from pathlib import Path
from typing import Any

import torch

from radhar_cli.dataset.audited import read_audit
from radhar_cli.dataset.build_version import build_version
from radhar_cli.dataset.layout import DATASET
from radhar_cli.dataset.split import TEST
from radhar_cli.errors import FolderError
from radhar_cli.figures.class_shares import ShareBar, class_shares_png
from radhar_cli.figures.evaluation import Point, curves_png, filters_png, robustness_png
from radhar_cli.figures.report.parts import Details, ReportFigure, ReportTable, Sentences
from radhar_cli.figures.report.report import Report
from radhar_cli.learning.evaluated_run import (
    EvalSet,
    Run,
    check_options,
    count_seen,
    open_eval_set,
    open_run,
)
from radhar_cli.learning.evaluation import SPEEDS, last_features, measure_speed, predict
from radhar_cli.learning.filter_weights import filter_magnitudes, filter_table
from radhar_cli.learning.images.classes import left_out_message
from radhar_cli.learning.run_files import BEST
from radhar_cli.learning.run_folder import RunMetadata, best_epoch
from radhar_cli.learning.tasks.categories import Classifier
from radhar_cli.learning.tasks.predictions import EvalOptions
from radhar_cli.learning.tasks.task import Evaluation
from radhar_cli.processes.progress import Progress

INTERVALS = (
    "Intervals of 95 % are Wilson's, of as many samples as vary like whole persons or recordings "
    "drawn anew where these are known, else of single samples."
)
TESTED = ("network", "trained on", "tested on", "result")
NETWORK = ("model", "parameters", "multiply_adds", "best_epoch")


def evaluate(
    runs: Sequence[Path],
    data: Sequence[Path],
    options: EvalOptions,
    device: torch.device,
    progress: Progress,
) -> Report:
    """Evaluate every run on every data set.

    Args:
        runs: folders of runs, or weights' files.
        data: data sets, or trees of images.
        options: options of the evaluation, and its figures.
        progress: receives the lines of the report and the images done.

    Raises:
        RunError: a run is damaged, or a figure cannot be drawn of it.
        FolderError: data do not fit a network; it is raised before anything is computed.
    """
    open_runs = [open_run(name, path, device) for name, path in _name_paths(runs).items()]
    check_options(open_runs, options)
    named_data = _name_paths(data)
    eval_sets = {  # all opened first: data that do not fit are reported before any computing
        (run.name, name): open_eval_set(run, path, options)
        for run in open_runs
        for name, path in named_data.items()
    }
    report = _begin_report([run.name for run in open_runs], [*named_data], options, device)
    evaluation = _Evaluation(report, options, device, progress)
    evaluation.say_notes(list(eval_sets.values()))
    is_single = len(eval_sets) == 1
    for run in open_runs:
        progress.say(f"{run.name}: {run.metadata.model}, {run.metadata.outputs_in_words}")
        for data_name in named_data:
            stem = "" if is_single else f"_{run.name}__{data_name}"
            evaluation.add(run, data_name, eval_sets[run.name, data_name], stem)
        evaluation.add_speed(run, eval_sets[run.name, next(iter(named_data))])
    report.sections[0].parts.insert(0, _tested_table(evaluation.tested))
    _add_curves(report, open_runs, evaluation.accuracies)
    _list_networks(report)
    if options.filters:
        _show_filters(report, open_runs)
    for data_name, path in named_data.items():
        _add_audit(report, data_name, path, single=len(named_data) == 1)
    report.section("How it was trained and measured")
    for run in open_runs:
        report.add(Details(f"Training of {run.name}", _training_as_json(run.metadata)))
    report.add(Sentences([INTERVALS]))
    return report


def main_scores(runs: dict[str, Any]) -> dict[str, dict[str, dict[str, float]]]:
    """{score: {run: {data set: value}}}: the number by which each result is summed up."""
    scores = dict[str, dict[str, dict[str, float]]]()
    for run, of_run in runs.items():
        for data, numbers in of_run["data"].items():
            score = numbers["main_number"]
            scores.setdefault(score, {}).setdefault(run, {})[data] = numbers[score]
    return scores


def _begin_report(
    runs: Sequence[str], data: Sequence[str], options: EvalOptions, device: torch.device
) -> Report:
    """Report on some runs and data sets, by name, in which nothing is found yet."""
    threads = torch.get_num_threads()
    return Report(
        {
            "split": options.split,
            "batch": options.batch,
            "resize": options.resize,
            "device": device.type,
            "machine": platform.machine(),
            "threads": threads,
            "runs": {},
        },
        title=f"{', '.join(runs)} on {', '.join(data)}",
        about=f"radhar eval {build_version()}; on {device.type}, threads: {threads}, float32.",
        formats=("html",),
        lists_files=True,
    )


@dataclass
class _Evaluation:
    """Evaluation under way: results go to a report, run by run and set by set."""

    report: Report
    options: EvalOptions
    device: torch.device
    progress: Progress
    # {run: its accuracy on each data set}, of classifiers
    accuracies: dict[str, list[Point]] = field(default_factory=dict)
    tested: list[tuple[str, ...]] = field(default_factory=list)  # as in TESTED, a row a result

    def say(self, line: str) -> None:
        """Show a line, and add it to the top of the page."""
        self.progress.say(line)
        self.report.line(line)

    def say_notes(self, eval_sets: Sequence[EvalSet]) -> None:
        """Print, each once, the changes that made the images fit, and the images left out."""
        for note in dict.fromkeys(note for s in eval_sets for note in s.images.notes):
            self.say(note)
        left_out = (left_out_message(s.images, self.options.names) for s in eval_sets)
        for message in dict.fromkeys(left_out):
            if message:
                self.say(f"warning: {message}")

    def add(self, run: Run, data: str, eval_set: EvalSet, stem: str) -> None:
        """Evaluate a run on a data set.

        Args:
            run: network.
            data: name of the data set.
            eval_set: its images.
            stem: end of the names of files.
        """
        title = f"{run.name} on {data}, {eval_set.split}"
        self.report.section(title)
        numbers = self._evaluate(run, eval_set, stem, title)
        runs = self.report.numbers["runs"]
        runs.setdefault(run.name, _describe_run(run) | {"data": {}})["data"][data] = numbers
        task = run.metadata.task
        summary = task.summarise(numbers)
        self.progress.say(f"  {data}, {eval_set.split}: {summary}")
        self.tested.append((*_describe_test(run, data, eval_set, numbers["images"]), summary))
        if isinstance(task, Classifier):
            interval = numbers["accuracy_95"] or (nan, nan)
            point = Point(data, eval_set.images.snr_db, numbers["accuracy"], *interval)
            self.accuracies.setdefault(run.name, []).append(point)
        for warning in task.evaluation_warnings(eval_set.images, data):
            self.say(f"  {warning}")
        if numbers["chose_the_epoch"]:
            self.say(f"  {_chosen_by(run, eval_set, numbers)}")
        trained_on = numbers["seen_in_training"]
        if any(trained_on.values()):
            self.say(
                f"  warning: {trained_on['images']} of these {numbers['images']} images, and "
                f"the person and motion of {trained_on['scenes']}, were trained on: this does "
                "not test on unseen data"
            )

    def _evaluate(self, run: Run, eval_set: EvalSet, stem: str, title: str) -> dict[str, Any]:
        """Add figures and tables of a run on a data set; return plain numbers for report.json."""
        images, rows, metadata = eval_set.images, eval_set.rows, run.metadata
        device, options, task = self.device, self.options, metadata.task
        unit = "image" if images.is_pictures else "sequence"
        self.progress.stage(title, len(rows), 0, unit)
        counts = count_seen(run, images, rows)
        predictions = predict(
            run.model, metadata, images, rows, device, options.batch, self.progress
        )
        features = partial(last_features, run.model, metadata, images, device=device)
        evaluation = Evaluation(
            self.report, stem, title, predictions, task.groups(images, rows), options, features
        )
        numbers = task.report(evaluation)
        self.report.sections[-1].parts.sort(key=lambda part: not isinstance(part, ReportFigure))
        return {
            **numbers,
            **counts,
            "main_number": task.main_number,
            "split": eval_set.split,
            "map": images.map,
            "snr_db": images.snr_db,
            "left_out": dict(images.left_out),
        }

    def add_speed(self, run: Run, eval_set: EvalSet) -> None:
        """Time a run on the first image of a data set."""
        images, row = eval_set.images, int(eval_set.rows[0])
        speeds = measure_speed(run.folder, images, row, self.device, self.options.batch)
        self.report.numbers["runs"][run.name]["speed"] = speeds


def _chosen_by(run: Run, eval_set: EvalSet, numbers: Mapping[str, Any]) -> str:
    """Sentence that these images chose the epoch, and advice for an accuracy of others."""
    count, epochs = numbers["chose_the_epoch"], len(run.history)
    part = eval_set.split if count == numbers["images"] else f"{count} of these images"
    best = f"the best of {epochs} epochs" if epochs else "the best epoch"
    split = eval_set.images.samples.split
    has_test = eval_set.split != "test" and split is not None and (split == TEST).any()
    cure = (
        "--split test scores images that did not"
        if has_test
        else ("a test part (`split.test` of the config) would tell how good it is on others")
    )
    return f"{part} chose the epoch, {best}, so that this is optimistic; {cure}"


def _describe_test(run: Run, data: str, eval_set: EvalSet, count: int) -> tuple[str, str, str]:
    """Network, what it was trained on and what it is tested on, in words."""
    metadata, images = run.metadata, eval_set.images
    unit = "images" if images.is_pictures else "sequences"
    of_map = "" if images.map is None else f" of {images.map}"
    snr = "" if images.snr_db is None else f", SNR {images.snr_db:g} dB"
    part = "all" if eval_set.split == "all" else f"the {eval_set.split} part"
    return (
        f"{run.name}: {metadata.model}, {metadata.outputs_in_words}",
        f"{metadata.data['train']} {unit} of {metadata.data['path']}",
        f"{part} of {data}: {count} {unit}{of_map}{snr}",
    )


def _tested_table(tested: Sequence[Sequence[str]]) -> ReportTable:
    """Table of what was tested with what; of a single result a line for each fact."""
    if len(tested) == 1:
        header, *rows = zip(TESTED, tested[0], strict=True)
        return ReportTable(header, rows)
    return ReportTable(TESTED, tested)


def _list_networks(report: Report) -> None:
    """Add the table of networks, and its file."""
    run_numbers = report.numbers["runs"].items()
    rows = [
        [name, *(numbers[key] for key in NETWORK), *numbers["speed"].values()]
        for name, numbers in run_numbers
    ]
    report.section("Networks" if len(rows) > 1 else "Network")
    header = ["run", *NETWORK, *SPEEDS]
    report.add(ReportTable(header, rows, file="networks.csv", is_shown=False))
    _show_networks(report, rows)


def _show_networks(report: Report, rows: Sequence[Sequence[Any]]) -> None:
    """Add the table of networks with a column for each run, in units that people read."""
    units = (
        *("network", "parameters", "million multiply-adds an image", "best epoch", "loading, s"),
        *("an image, s", "loading and an image, s", "images of a batch", "images/s in batches"),
        "images/s in batches, loading included",
    )
    head = ["", *(row[0] for row in rows)]
    in_millions = (
        [name, parameters, None if adds is None else round(adds / 1e6, 2), *others]
        for _, name, parameters, adds, *others in rows
    )
    columns = zip(*in_millions, strict=True)
    lines = [[unit, *column] for unit, column in zip(units, columns, strict=True)]
    report.add(ReportTable(head, lines, "Size and speed"))


def _training_as_json(metadata: RunMetadata) -> str:
    """Data, settings and versions of a run, as JSON."""
    description = {
        "data": metadata.data["path"],
        "images": {"train": metadata.data["train"], "validation": metadata.data["val"]},
        "map": metadata.map,
        "size": list(metadata.size),
        "versions": metadata.versions,
        "config": metadata.config,
    }
    return json.dumps(description, indent=2, ensure_ascii=False)


def _describe_run(run: Run) -> dict[str, Any]:
    """Numbers of report.json of a run, whatever it is evaluated on."""
    metadata, cost = run.metadata, run.metadata.cost
    return {
        "model": metadata.model,
        "parameters": cost.parameters,
        "multiply_adds": cost.multiply_adds,
        "size_px": list(metadata.size),
        "map": metadata.map,
        "trained_on": metadata.data,
        "epochs": len(run.history),
        "best_epoch": best_epoch(run.history).epoch if run.history else None,
    }


def _add_curves(
    report: Report, runs: Sequence[Run], accuracies: Mapping[str, Sequence[Point]]
) -> None:
    """Add the training curves, and the accuracy of runs over several data sets."""
    with_history = {run.name: run.history for run in runs if run.history}
    if with_history:
        best = {name: best_epoch(rows).epoch for name, rows in with_history.items()}
        tasks = [run.metadata.task for run in runs if run.history]
        score = " or ".join(dict.fromkeys(task.score_name for task in tasks))
        loss = " or ".join(dict.fromkeys(task.loss_name for task in tasks))
        png = curves_png(with_history, best, score, loss)
        report.add(ReportFigure("curves.png", "Training curves.", png))
    if any(len(points) > 1 for points in accuracies.values()):
        caption = "Accuracy over the data sets."
        report.add(ReportFigure("robustness.png", caption, robustness_png(accuracies)))
        rows = [
            (name, p.data, p.snr_db, p.accuracy, p.low, p.high)
            for name, points in accuracies.items()
            for p in points
        ]
        head = ("run", "data", "snr_db", "accuracy", "low_95", "high_95")
        report.add(ReportTable(head, rows, file="robustness.csv", is_shown=False))


def _show_filters(report: Report, runs: Sequence[Run]) -> None:
    """Add the paper's figure of weights: a row for each network, a column for each filter."""
    weights = {run.name: filter_magnitudes(run.model) for run in runs}
    weights = {name: filters for name, filters in weights.items() if filters}
    caption = (
        "Weight heat maps of the global filters (the paper's figure): magnitude of the effective "
        "weight by spatial frequency, mean over channels, each over its largest value; Doppler "
        "axis down, time axis across, the zero frequency in the middle."
    )
    report.add(ReportFigure("filters.png", caption, filters_png(weights)))
    tables = {name: filter_table(filters) for name, filters in weights.items()}
    report.numbers["filters"] = tables
    keys = list(next(iter(tables.values()))[0])
    filter_rows = [[name, *row.values()] for name, rows in tables.items() for row in rows]
    report.add(ReportTable(["run", *keys], filter_rows, file="filters.csv", is_shown=False))


def _add_audit(report: Report, name: str, data: Path, single: bool) -> None:
    """Add the figure of the audit's evidence, if data have been audited.

    Args:
        name: name of the data set.
        data: its path.
        single: whether it is the only one.
    """
    try:
        stored = read_audit(data)
    except FolderError as error:
        report.line(f"warning: {error}")
        return
    if stored is None:
        return
    report.section(f"What else tells the classes{'' if single else f' of {name}'}")
    bars = [ShareBar(*line[:6]) for line in stored.lines]
    title = f"{name}: how often the class is told from what is not the movement"
    leaks = "; ".join(f"{line.name}: {line.verdict}" for line in stored.lines if line.cure)
    caption = (
        f"What a small forest tells of the classes of {name} without the movement "
        f"({stored.samples} samples, {stored.held_out}s held out; radhar audit): "
        f"{leaks or 'nothing beyond chance'}."
    )
    stem = "" if single else f"_{name}"
    report.add(ReportFigure(f"audit{stem}.png", caption, class_shares_png(bars, title)))


def _name_paths(paths: Sequence[Path]) -> dict[str, Path]:
    """{short name: path}: the last part of each path, with more of it where two are alike.

    dataset.h5 and best.safetensors go by their folder.

    Raises:
        FolderError: a path is given twice.
    """
    resolved = [path.resolve() for path in paths]
    resolved = [p.parent if p.is_file() and p.name in (DATASET, BEST) else p for p in resolved]
    parts = [path.parts[1:] or (path.anchor,) for path in resolved]
    for depth in range(1, max(map(len, parts)) + 1):
        names = ["-".join(p[-depth:]) for p in parts]
        if len(set(names)) == len(names):
            return dict(zip(names, paths, strict=True))
    raise FolderError(f"{paths[0]}: is given twice")
