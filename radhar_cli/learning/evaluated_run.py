"""Runs that are evaluated, the images they are evaluated on, and which of these they have seen."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from torch import nn

from radhar_cli.learning.evaluation import open_for_model, rows_of
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.images.scan import scan
from radhar_cli.learning.run_files import RunError
from radhar_cli.learning.run_folder import (
    Epoch,
    RunMetadata,
    load_best,
    read_history,
    read_trained_on,
)
from radhar_cli.learning.tasks.frames import FrameLabels
from radhar_cli.learning.tasks.predictions import EvalOptions
from radhar_cli.numerics.arrays import Index


@dataclass(frozen=True)
class Run:
    """A training run that is evaluated."""

    name: str  # in tables and figures
    folder: Path  # or the weights' file
    metadata: RunMetadata
    model: nn.Module  # on the device, in evaluation mode
    history: list[Epoch]  # empty where only the weights are there


@dataclass(frozen=True)
class EvalSet:
    """Images of a data set on which a run is evaluated."""

    images: ImageSet
    rows: Index  # rows of `images` that count
    split: str  # their split, or all


def open_eval_set(run: Run, path: Path, options: EvalOptions) -> EvalSet:
    """Open the images of a data set on which a run is evaluated.

    Raises:
        FolderError: data do not fit the network.
    """
    images = open_for_model(
        run.metadata, path, options.map, resize=options.resize, names=options.names
    )
    return EvalSet(images, *rows_of(images, options.split))


def check_options(runs: Sequence[Run], options: EvalOptions) -> None:
    """Refuse figures that cannot be drawn, before anything is computed.

    Raises:
        RunError: a figure that an option asks for is not of such a network.
    """
    for run in runs:
        if options.tsne and not run.metadata.reads_pictures:
            raise RunError(f"--tsne: {run.name} reads {run.metadata.input}; it is of images")
        run.metadata.task.check_options(run.name, options, run.metadata)
        _check_events(run, options.events)
    if options.filters and not any(run.metadata.model == "fftnet" for run in runs):
        raise RunError("--filters: none of these networks has global filters; fftnet has six")


def _check_events(run: Run, events: Sequence[str]) -> None:
    """Refuse events of a network that does not label frames, and classes that it does not know."""
    task = run.metadata.task
    if events and not isinstance(task, FrameLabels):
        raise RunError(
            f"--events: {run.name} finds {task.finds}; events are found by a run of target: frames"
        )
    unknown = [name for name in events if name not in run.metadata.classes]
    if unknown:
        raise RunError(
            f"--events = {unknown[0]}: is no class of {run.name}; should be of "
            f"{', '.join(run.metadata.classes)}"
        )


def open_run(name: str, path: Path, device: torch.device) -> Run:
    """Open a run for evaluation.

    Args:
        name: name of the run in tables and figures.
        path: folder of the run, or a copy of its weights alone.
        device: device that the network is moved to.

    Raises:
        RunError: it is no run, or is damaged.
    """
    metadata, model = load_best(path)
    folder = path if path.is_dir() else path.parent
    try:
        history = read_history(folder)
    except RunError:
        history = []  # weights alone, copied from elsewhere
    return Run(name, path, metadata, model.to(device), history)


def count_seen(run: Run, images: ImageSet, rows: Index) -> dict[str, Any]:
    """Numbers of the evaluated images that a run has seen, by their keys in report.json.

    Returns:
        Under `seen_in_training` images that it learned from, and scenes behind them;
        `chose_the_epoch`: images of its validation.
    """
    folder = run.folder if run.folder.is_dir() else run.folder.parent
    trained_on = read_trained_on(folder)
    digests = scan(images, rows).digests if trained_on.pixels else ()
    column = images.samples.scene
    evaluated_scenes = () if column is None else column[rows]
    return {
        "seen_in_training": {
            "images": sum(p in trained_on.pixels for p in digests),
            "scenes": sum(scene in trained_on.scenes for scene in evaluated_scenes),
        },
        "chose_the_epoch": sum(p in trained_on.validation for p in digests),
    }
