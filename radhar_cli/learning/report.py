"""`radhar eval`: every figure and table of some runs on some data sets."""

import json
import platform
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import torch

from radhar_cli.build_version import build_version
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
from radhar_cli.progress import Progress

NETWORK = ("model", "parameters", "multiply_adds", "best_epoch")


def evaluate(
    runs: Sequence[Path],
    data: Sequence[Path],
    options: EvalOptions,
    device: torch.device,
    progress: Progress,
) -> Report:
    """Evaluate every run on every data set."""
    opened = [open_run(name, path, device) for name, path in _name_paths(runs).items()]
    check_options(opened, options)
    named_data = _name_paths(data)
    eval_sets = {  # all opened first: data that do not fit are reported before any computing
        (run.name, name): open_eval_set(run, path, options)
        for run in opened
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
        title=f"{', '.join(run.name for run in opened)} on {', '.join(named_data)}",
        about=(
            f"radhar eval {build_version()}, split {options.split}; on {device.type}, "
            f"threads: {torch.get_num_threads()}, float32. Intervals are Wilson's, 95 %."
        ),
    )

    def say(line: str) -> None:
        progress.say(line)
        report.line(line)

    for note in dict.fromkeys(n for one in eval_sets.values() for n in one.images.notes):
        say(note)
    for message in dict.fromkeys(
        left_out_message(eval_set.images, options.names) for eval_set in eval_sets.values()
    ):
        if message:
            say(f"warning: {message}")
    lines: dict[str, list[Point]] = {}
    for run in opened:
        say(f"{run.name}: {run.metadata.model}, {run.metadata.answers}")
        results = {}
        for data_name in named_data:
            one = len(opened) == len(named_data) == 1
            stem = "" if one else f"_{run.name}__{data_name}"
            eval_set = eval_sets[run.name, data_name]
            report.section(f"{run.name} on {data_name}, {eval_set.split}")
            numbers = evaluate_one(
                report, run, data_name, eval_set, stem, options, device, progress
            )
            results[data_name] = numbers
            say(f"  {data_name}, {numbers['split']}: {_result_in_words(numbers)}")
            if "accuracy" in numbers:
                interval = numbers["accuracy_95"]
                point = Point(data_name, eval_set.images.snr_db, numbers["accuracy"], *interval)
                lines.setdefault(run.name, []).append(point)
            if run.metadata.settings.target == "labels" and eval_set.images.person_classes is None:
                say(f"  warning: {data_name} says of one person alone what they do")
            seen = numbers["seen_in_training"]
            if any(seen.values()):
                say(
                    f"  warning: {seen['images']} of these {numbers['images']} images, and the "
                    f"person and motion of {seen['scenes']}, were trained on: this does not test "
                    "on unseen data"
                )
        first = eval_sets[run.name, next(iter(named_data))]
        timed = measure_speed(run.folder, first.images, int(first.rows[0]), device, options.batch)
        report.numbers["runs"][run.name] = _describe_run(run) | {"speed": timed, "data": results}
    about = report.numbers["runs"].items()
    networks = ([n, *(one[key] for key in NETWORK), *one["speed"].values()] for n, one in about)
    report.section("Networks" if len(opened) > 1 else "Network")
    listed = [*networks]
    report.table("networks.csv", ["run", *NETWORK, *SPEEDS], listed)
    _show_networks(report, listed)
    _add_curves(report, opened, lines)
    if options.filters:
        _show_filters(report, opened)
    report.section("How they were trained")
    for run in opened:
        report.details(run.name, _training_as_json(run.metadata))
    return report


def _show_networks(report: Report, rows: Sequence[Sequence[object]]) -> None:
    """The table of networks with a column a run, in units that people read."""
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
    about = {
        "data": metadata.data["path"],
        "images": {"train": metadata.data["train"], "validation": metadata.data["val"]},
        "map": metadata.map,
        "size": list(metadata.size),
        "versions": metadata.versions,
        "config": metadata.config,
    }
    return json.dumps(about, indent=2, ensure_ascii=False)


def _describe_run(run: Run) -> dict[str, Any]:
    """What report.json says of a run, whatever it is evaluated on."""
    metadata, price = run.metadata, run.metadata.cost
    return {
        "model": metadata.model,
        "parameters": price.parameters,
        "multiply_adds": price.multiply_adds,
        "size_px": list(metadata.size),
        "map": metadata.map,
        "trained_on": metadata.data,
        "epochs": len(run.history),
        "best_epoch": best_epoch(run.history).epoch if run.history else None,
    }


def _result_in_words(numbers: Mapping[str, Any]) -> str:
    """What was found, in words."""
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


def _add_curves(report: Report, runs: Sequence[Run], lines: Mapping[str, Sequence[Point]]) -> None:
    """Curves of the runs, and their accuracy over several data sets."""
    with_history = {run.name: run.history for run in runs if run.history}
    if with_history:
        best = {name: best_epoch(rows).epoch for name, rows in with_history.items()}
        targets = dict.fromkeys(run.metadata.settings.target for run in runs if run.history)
        score, loss = (" or ".join(names[one] for one in targets) for names in (SCORES, LOSSES))
        png = curves_png(with_history, best, score, loss)
        report.figure("curves.png", "Training curves.", png)
    if any(len(points) > 1 for points in lines.values()):
        caption = "Accuracy over the data sets."
        report.figure("robustness.png", caption, robustness_png(lines))
        rows = (
            (name, p.data, p.snr_db, p.accuracy, p.low, p.high)
            for name, points in lines.items()
            for p in points
        )
        head = ("run", "data", "snr_db", "accuracy", "low_95", "high_95")
        report.table("robustness.csv", head, rows)


def _show_filters(report: Report, runs: Sequence[Run]) -> None:
    """The paper's figure of weights: a row for every network, a column for every global filter."""
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
    every = ([name, *row.values()] for name, rows in tables.items() for row in rows)
    report.table("filters.csv", ["run", *keys], every)


def _name_paths(paths: Sequence[Path]) -> dict[str, Path]:
    """A short name for every path: its last part, with more of it where two are alike.

    dataset.h5 and best.safetensors go by their folder.
    """
    whole = [path.resolve() for path in paths]
    whole = [p.parent if p.is_file() and p.name in (DATASET, BEST) else p for p in whole]
    parts = [path.parts[1:] or (path.anchor,) for path in whole]
    for depth in range(1, max(map(len, parts)) + 1):
        names = ["-".join(p[-depth:]) for p in parts]
        if len(set(names)) == len(names):
            return dict(zip(names, paths, strict=True))
    raise FolderError(f"{paths[0]}: is given twice")
