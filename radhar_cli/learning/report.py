"""`radhar eval`: every figure and table of some runs on some data sets."""

import json
import platform
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import torch

from radhar_cli.code_identity.build_version import build_version
from radhar_cli.dataset.layout import DATASET
from radhar_cli.errors import FolderError
from radhar_cli.figures.evaluation import Point, curves_png, filters_png, robustness_png
from radhar_cli.learning.evaluation import SPEEDS, measure_speed
from radhar_cli.learning.filter_weights import filter_magnitudes, filter_table
from radhar_cli.learning.images.classes import left_out_message
from radhar_cli.learning.report_files import Report
from radhar_cli.learning.run_files import BEST
from radhar_cli.learning.run_folder import RunMetadata, best_epoch
from radhar_cli.learning.single_result import (
    EvalOptions,
    Run,
    check_options,
    evaluate_one,
    open_eval_set,
    open_run,
)
from radhar_cli.learning.targets import LOSSES, SCORES
from radhar_cli.processes.progress import Progress

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
        options: what is evaluated, and which figures are drawn.
        device: where the networks run.
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
    report = Report(
        {
            "split": options.split,
            "batch": options.batch,
            "resize": options.resize,
            "device": device.type,
            "machine": platform.machine(),
            "threads": torch.get_num_threads(),
            "runs": {},
        },
        title=f"{', '.join(run.name for run in open_runs)} on {', '.join(named_data)}",
        about=(
            f"radhar eval {build_version()}, split {options.split}; on {device.type}, "
            f"threads: {torch.get_num_threads()}, float32. Intervals are Wilson's, 95 %."
        ),
    )

    def say(line: str) -> None:
        progress.say(line)
        report.line(line)

    for note in dict.fromkeys(
        note for eval_set in eval_sets.values() for note in eval_set.images.notes
    ):
        say(note)
    for message in dict.fromkeys(
        left_out_message(eval_set.images, options.names) for eval_set in eval_sets.values()
    ):
        if message:
            say(f"warning: {message}")
    accuracies: dict[str, list[Point]] = {}
    for run in open_runs:
        say(f"{run.name}: {run.metadata.model}, {run.metadata.answers}")
        results = {}
        for data_name in named_data:
            is_single = len(open_runs) == len(named_data) == 1
            file_stem = "" if is_single else f"_{run.name}__{data_name}"
            eval_set = eval_sets[run.name, data_name]
            report.section(f"{run.name} on {data_name}, {eval_set.split}")
            numbers = evaluate_one(
                report, run, data_name, eval_set, file_stem, options, device, progress
            )
            results[data_name] = numbers
            say(f"  {data_name}, {numbers['split']}: {_result_in_words(numbers)}")
            if "accuracy" in numbers:
                interval = numbers["accuracy_95"]
                point = Point(data_name, eval_set.images.snr_db, numbers["accuracy"], *interval)
                accuracies.setdefault(run.name, []).append(point)
            if run.metadata.settings.target == "labels" and eval_set.images.person_classes is None:
                say(f"  warning: {data_name} says of one person alone what they do")
            trained_on = numbers["seen_in_training"]
            if any(trained_on.values()):
                say(
                    f"  warning: {trained_on['images']} of these {numbers['images']} images, and "
                    f"the person and motion of {trained_on['scenes']}, were trained on: this does "
                    "not test on unseen data"
                )
        first_set = eval_sets[run.name, next(iter(named_data))]
        speeds = measure_speed(
            run.folder, first_set.images, int(first_set.rows[0]), device, options.batch
        )
        report.numbers["runs"][run.name] = _describe_run(run) | {"speed": speeds, "data": results}
    run_numbers = report.numbers["runs"].items()
    networks = (
        [name, *(numbers[key] for key in NETWORK), *numbers["speed"].values()]
        for name, numbers in run_numbers
    )
    report.section("Networks" if len(open_runs) > 1 else "Network")
    rows = [*networks]
    report.table("networks.csv", ["run", *NETWORK, *SPEEDS], rows)
    _show_networks(report, rows)
    _add_curves(report, open_runs, accuracies)
    if options.filters:
        _show_filters(report, open_runs)
    report.section("How they were trained")
    for run in open_runs:
        report.details(run.name, _training_as_json(run.metadata))
    return report


def _show_networks(report: Report, rows: Sequence[Sequence[object]]) -> None:
    """Add the table of networks with a column for each run, in units that people read."""
    units = (
        *("network", "parameters", "multiply-adds of an image", "best epoch", "loading, s"),
        *("an image, s", "loading and an image, s", "images of a batch", "images/s in batches"),
        "images/s in batches, loading included",
    )
    head = ["", *(row[0] for row in rows)]
    columns = zip(*(row[1:] for row in rows), strict=True)
    lines = [[unit, *column] for unit, column in zip(units, columns, strict=True)]
    report.show_table("Size and speed", head, lines)


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


def _result_in_words(numbers: Mapping[str, Any]) -> str:
    """Result of a run on a data set, as a line for people."""
    if "mpjpe_cm" in numbers:
        in_place = numbers["mpjpe_of_the_mean_pose_in_place_cm"]
        return (
            f"mean absolute error {numbers['mean_absolute_error_cm']:.2f} cm, MPJPE "
            f"{numbers['mpjpe_cm']:.2f} cm (the mean pose in its place {in_place:.2f} cm), "
            f"{numbers['frames']} frames"
        )
    if "mean_average_precision" in numbers:
        return (
            f"mean average precision {100 * numbers['mean_average_precision']:.2f} %, all labels "
            f"right in {100 * numbers['exact_match']:.2f} % of {numbers['images']}"
        )
    low, high = numbers["accuracy_95"]
    return (
        f"{100 * numbers['accuracy']:.2f} % ({100 * low:.2f} to {100 * high:.2f} %) of "
        f"{numbers['images']}, macro F1 {numbers['macro_f1']:.4f}, calibration error "
        f"{numbers['calibration_error']:.4f}"
    )


def _add_curves(
    report: Report, runs: Sequence[Run], accuracies: Mapping[str, Sequence[Point]]
) -> None:
    """Add the training curves, and the accuracy of runs over several data sets."""
    with_history = {run.name: run.history for run in runs if run.history}
    if with_history:
        best = {name: best_epoch(rows).epoch for name, rows in with_history.items()}
        targets = dict.fromkeys(run.metadata.settings.target for run in runs if run.history)
        score, loss = (
            " or ".join(names[target] for target in targets) for names in (SCORES, LOSSES)
        )
        png = curves_png(with_history, best, score, loss)
        report.figure("curves.png", "Training curves.", png)
    if any(len(points) > 1 for points in accuracies.values()):
        caption = "Accuracy over the data sets."
        report.figure("robustness.png", caption, robustness_png(accuracies))
        rows = (
            (name, p.data, p.snr_db, p.accuracy, p.low, p.high)
            for name, points in accuracies.items()
            for p in points
        )
        head = ("run", "data", "snr_db", "accuracy", "low_95", "high_95")
        report.table("robustness.csv", head, rows)


def _show_filters(report: Report, runs: Sequence[Run]) -> None:
    """Add the paper's figure of weights: a row for each network, a column for each filter."""
    weights = {run.name: filter_magnitudes(run.model) for run in runs}
    weights = {name: filters for name, filters in weights.items() if filters}
    caption = (
        "Weight heat maps of the global filters (the paper's figure): magnitude of the effective "
        "weight by spatial frequency, mean over channels, each over its largest value; Doppler "
        "axis down, time axis across, the zero frequency in the middle."
    )
    report.figure("filters.png", caption, filters_png(weights))
    tables = {name: filter_table(filters) for name, filters in weights.items()}
    report.numbers["filters"] = tables
    keys = list(next(iter(tables.values()))[0])
    filter_rows = ([name, *row.values()] for name, rows in tables.items() for row in rows)
    report.table("filters.csv", ["run", *keys], filter_rows)


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
