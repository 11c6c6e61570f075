"""`radhar eval`: every figure and table of some runs on some data sets."""

import platform
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import torch

from radhar_cli.dataset.layout import DATASET
from radhar_cli.errors import FolderError
from radhar_cli.figures.evaluation import Point, curves_png, robustness_png
from radhar_cli.learning.evaluation import SPEEDS, speed
from radhar_cli.learning.images.classes import unknown_message
from radhar_cli.learning.report_files import Report
from radhar_cli.learning.run_files import BEST
from radhar_cli.learning.run_folder import best_epoch
from radhar_cli.learning.single_result import (
    EvalOptions,
    Run,
    check_options,
    evaluate_one,
    open_eval_set,
    open_run,
)
from radhar_cli.learning.targets import LOSSES, SCORES
from radhar_cli.progress import Messages

NETWORK = ("model", "parameters", "multiply_adds", "best_epoch")


def evaluate(
    runs: Sequence[Path],
    data: Sequence[Path],
    options: EvalOptions,
    device: torch.device,
    progress: Messages,
) -> Report:
    """Evaluate every run on every data set."""
    opened = [open_run(name, path, device) for name, path in _named(runs).items()]
    check_options(opened, options)
    named_data = _named(data)
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
        }
    )

    def say(line: str) -> None:
        progress.say(line)
        report.lines.append(line)

    for message in dict.fromkeys(
        unknown_message(eval_set.images, options.names) for eval_set in eval_sets.values()
    ):
        if message:
            say(f"warning: {message}")
    lines: dict[str, list[Point]] = {}
    for run in opened:
        say(f"{run.name}: {run.metadata.model}, {len(run.metadata.classes)} classes")
        results = {}
        for data_name in named_data:
            one = len(opened) == len(named_data) == 1
            stem = "" if one else f"_{run.name}__{data_name}"
            eval_set = eval_sets[run.name, data_name]
            numbers = evaluate_one(report, run, data_name, eval_set, stem, options, device)
            results[data_name] = numbers
            say(f"  {data_name}, {numbers['split']}: {_found(numbers)}")
            if "accuracy" in numbers:
                interval = numbers["accuracy_95"]
                point = Point(data_name, eval_set.images.snr_db, numbers["accuracy"], *interval)
                lines.setdefault(run.name, []).append(point)
            if run.metadata.settings.target == "labels" and eval_set.images.everybody is None:
                say(f"  warning: {data_name} says of one person alone what they do")
            seen = numbers["seen_in_training"]
            if any(seen.values()):
                say(
                    f"  warning: {seen['images']} of these {numbers['images']} images, and the "
                    f"person and motion of {seen['scenes']}, were trained on: this does not test "
                    "on unseen data"
                )
        first = eval_sets[run.name, next(iter(named_data))]
        timed = speed(run.folder, first.images, int(first.rows[0]), device, options.batch)
        report.numbers["runs"][run.name] = _about(run) | {"speed": timed, "data": results}
    about = report.numbers["runs"].items()
    networks = ([n, *(one[key] for key in NETWORK), *one["speed"].values()] for n, one in about)
    report.table("networks.csv", ["run", *NETWORK, *SPEEDS], networks)
    _compare(report, opened, lines)
    return report


def _about(run: Run) -> dict[str, Any]:
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


def _found(numbers: Mapping[str, Any]) -> str:
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


def _compare(report: Report, runs: Sequence[Run], lines: Mapping[str, Sequence[Point]]) -> None:
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


def _named(paths: Sequence[Path]) -> dict[str, Path]:
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
