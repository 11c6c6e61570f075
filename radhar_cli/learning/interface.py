"""Training and evaluation from Python: `radhar.train`, `radhar.evaluate`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from radhar_cli.config.reading import load_section
from radhar_cli.figures.report.report import Report
from radhar_cli.learning import training
from radhar_cli.learning.images.image_set import check_split_name
from radhar_cli.learning.machine import choose_device
from radhar_cli.learning.report import evaluate as evaluate_runs
from radhar_cli.learning.report import main_scores
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.tasks.predictions import EvalOptions
from radhar_cli.learning.trained_run import TrainedRun, load_run
from radhar_cli.processes.progress import NO_PROGRESS, Progress

Paths: TypeAlias = str | Path | Sequence[str | Path]


@dataclass(frozen=True)
class EvaluatedRuns:
    """Networks that were evaluated on data sets.

    Attributes:
        report: numbers, sentences, tables and figures, which `report.write(folder)` writes.
    """

    report: Report

    @property
    def scores(self) -> dict[str, dict[str, dict[str, float]]]:
        """{score: {run: {data set: value}}}: the number by which each result is summed up."""
        return main_scores(self.report.numbers["runs"])


def train(
    data: Paths,
    folder: str | Path,
    settings: TrainConfig | str | Path | Mapping[str, Any] | None = None,
    *,
    init: str | Path | None = None,
    overwrite: bool = False,
    progress: training.TrainingProgress | None = None,
) -> TrainedRun:
    """Train a network, or resume its training, as the command `radhar train`, and load it.

    Args:
        data: data set, tree of class folders, or several of them.
        folder: folder of the run.
        settings: training config: a file, or keys such as {"model": "smallnet", "epochs": 20}.
        init: run whose best weights training starts from.
        overwrite: start over in a folder that holds a run.
        progress: is told of messages, steps and epochs.

    Raises:
        ConfigError: a setting is out of place.
        RadharError: as the command; its message says what is wrong.
    """
    if not isinstance(settings, TrainConfig):
        source = Path(settings) if isinstance(settings, str) else settings
        settings = load_section(TrainConfig, source)
    options = training.TrainOptions(start=Path(init) if init else None, overwrite=overwrite)
    watched = progress or training.NoTrainingProgress()
    training.train(settings, _paths(data), Path(folder), watched, options)
    return load_run(folder)


def evaluate(
    runs: Paths,
    data: Paths,
    folder: str | Path | None = None,
    *,
    split: str | None = None,
    device: str = "auto",
    progress: Progress = NO_PROGRESS,
) -> EvaluatedRuns:
    """Evaluate trained networks on data sets, as the command `radhar eval`.

    Args:
        runs: folder of a run, or several.
        data: data set, or several.
        folder: folder that the report is written to; None writes nothing.
        split: train, val, test or all; None is test where the data has it, else val.
        device: auto, cpu or cuda.
        progress: is told of the lines of the report and the images done.

    Raises:
        RadharError: as the command; its message says what is wrong.
    """
    options = EvalOptions(split=None if split is None else check_split_name(split))
    report = evaluate_runs(_paths(runs), _paths(data), options, choose_device(device), progress)
    if folder is not None:
        report.write(Path(folder))
    return EvaluatedRuns(report)


def _paths(paths: Paths) -> list[Path]:
    """Make one path, or several, a list."""
    return [Path(paths)] if isinstance(paths, (str, Path)) else [*map(Path, paths)]
