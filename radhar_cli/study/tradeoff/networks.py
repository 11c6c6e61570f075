"""Accuracy of networks for the rows of a sweep that save time, and for the config as it is."""

import time
from collections.abc import Callable
from dataclasses import replace
from math import inf
from pathlib import Path

from radhar_cli.processes.progress import Progress
from radhar_cli.study.tradeoff.recommendation import saves
from radhar_cli.study.tradeoff.row import AccuracyNumbers
from radhar_cli.study.tradeoff.scenes import Scenes
from radhar_cli.study.tradeoff.sweep import Sweep


def measure_accuracies(
    scenes: Scenes,
    sweep: Sweep,
    seeds: int,
    folder: Path,
    progress: Progress,
    save: Callable[[], None],
    seconds: float = inf,
) -> None:
    """Train networks on data of the config as it is, and of each setting that saves time.

    Args:
        scenes: scenes of the sweep, whose config it is.
        sweep: rows, which get their accuracy.
        seeds: number of networks of a setting.
        folder: folder of their data sets and runs.
        progress: is told of networks that are done.
        save: keeps the sweep as it is.
        seconds: time after which no further network is begun, s.
    """
    from radhar_cli.study.tradeoff.accuracy import measure_accuracy  # of radhar[train]

    deadline = None if seconds == inf else time.monotonic() + seconds
    for number, row in enumerate(sweep.rows):
        is_wanted = row.is_default or saves(row, sweep.blur)
        if not is_wanted or (row.accuracy and len(row.accuracy.by_seed) >= seeds):
            continue
        measured = measure_accuracy(
            scenes.path, scenes.overrides, row.overrides, seeds, folder, progress, deadline
        )
        if measured is None:
            if row.is_default:
                return
            continue
        numbers = AccuracyNumbers(measured.by_seed, *measured.interval, measured.tested_on)
        sweep.rows[number] = replace(row, accuracy=numbers)
        save()
