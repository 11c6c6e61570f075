"""`radhar eval`: every figure and table of some runs on some data sets."""

import platform
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import torch

from radhar_cli.dataset.layout import DATASET
from radhar_cli.errors import FolderError
from radhar_cli.figures.robustness import Point
from radhar_cli.learning.comparison import compare
from radhar_cli.learning.evaluation import speed
from radhar_cli.learning.images.classes import unknown_message
from radhar_cli.learning.models.build import cost
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
    seen_message,
)
from radhar_cli.progress import Messages


def evaluate(
    runs: Sequence[Path],
    data: Sequence[Path],
    options: EvalOptions,
    device: torch.device,
    progress: Messages,
) -> Report:
    """Evaluate every run on every data set.

    Raises:
        RunError: a run that cannot be read.
        FolderError: data that does not fit a run.
    """
    opened = [open_run(name, path, device) for name, path in _named(runs).items()]
    check_options(opened, options)
    named_data = _named(data)
    eval_sets = {  # all opened first: data that do not fit are reported before any computing
        (run.name, name): open_eval_set(run, path, options)
        for run in opened
        for name, path in named_data.items()
    }
    for message in dict.fromkeys(
        unknown_message(eval_set.images, options.names) for eval_set in eval_sets.values()
    ):
        if message:
            progress.say(f"warning: {message}")
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
    lines: dict[str, list[Point]] = {}
    for run in opened:
        progress.say(f"{run.name}: {run.metadata.model}, {len(run.metadata.classes)} classes")
        results = {}
        for data_name in named_data:
            one = len(opened) == len(named_data) == 1
            stem = "" if one else f"_{run.name}__{data_name}"
            predictions, numbers = evaluate_one(
                report, run, data_name, eval_sets[run.name, data_name], stem, options, device
            )
            results[data_name] = numbers
            low, high = numbers["accuracy_95"]
            point = Point(data_name, predictions.images.snr_db, numbers["accuracy"], low, high)
            lines.setdefault(run.name, []).append(point)
            progress.say(
                f"  {data_name}, {numbers['split']}: {100 * numbers['accuracy']:.2f} % "
                f"({100 * low:.2f} to {100 * high:.2f} %) of {numbers['images']}"
            )
            if numbers["seen_in_training"]["images"] or numbers["seen_in_training"]["scenes"]:
                progress.say(f"  warning: {seen_message(numbers)}")
        first = eval_sets[run.name, next(iter(named_data))]
        report.numbers["runs"][run.name] = {
            **_about_run(run),
            "speed": speed(run.folder, first.images, int(first.rows[0]), device, options.batch),
            "data": results,
        }
    compare(report, opened, lines, options)
    return report


def _named(paths: Sequence[Path]) -> dict[str, Path]:
    """A short name for every path: its last part, with more of it where two are alike.

    Raises:
        FolderError: the same path twice.
    """
    parts = [_name_parts(path) for path in paths]
    for depth in range(1, max(map(len, parts)) + 1):
        names = ["-".join(p[-depth:]) for p in parts]
        if len(set(names)) == len(names):
            return dict(zip(names, paths, strict=True))
    raise FolderError(f"{paths[0]}: is given twice")


def _name_parts(path: Path) -> tuple[str, ...]:
    """Parts of a path for its name; dataset.h5 and best.safetensors go by their folder."""
    whole = path.resolve()
    if path.is_file() and path.name in (DATASET, BEST):
        whole = whole.parent
    return whole.parts[1:] or (whole.anchor,)


def _about_run(run: Run) -> dict[str, Any]:
    price = cost(run.metadata.model, len(run.metadata.classes), run.metadata.size)
    return {
        "model": run.metadata.model,
        "parameters": price.parameters,
        "multiply_adds": price.multiply_adds,
        "size_px": list(run.metadata.size),
        "map": run.metadata.map,
        "trained_on": run.metadata.data,
        "epochs": len(run.history),
        "best_epoch": best_epoch(run.history).epoch if run.history else None,
    }
