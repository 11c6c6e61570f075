"""`radhar eval`: how good trained networks are, in numbers and figures."""

from pathlib import Path
from typing import Annotated, Any

import typer

from radhar_cli.commands.learning_options import Classes, Device, Resize, TrainedMap
from radhar_cli.commands.options import ReplaceResults
from radhar_cli.commands.tell import report, tell
from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.files.untrusted import read_json


def evaluate(
    paths: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN... DATA...",
            help="Training runs, and data sets to evaluate them on; one or more of each.",
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="Folder of the report. The default is RUN/eval."),
    ] = None,
    split: Annotated[
        str | None,
        typer.Option(
            help="Split to use: train, val (or validation), test or all. The default is test where "
            "the data has it, else val."
        ),
    ] = None,
    map_: TrainedMap = None,
    tsne: Annotated[
        bool,
        typer.Option(
            "--tsne", help="Draw t-SNE plots of the maps and of the network's last features."
        ),
    ] = False,
    filters: Annotated[
        bool,
        typer.Option("--filters", help="Draw the weights of the global filters of fftnet."),
    ] = False,
    in_place_vs_moving: Annotated[
        bool,
        typer.Option(
            "--in-place-vs-moving",
            help="Also draw the confusion matrix of two groups, in place (S1 to S7) and moving (S8 "
            "to S12).",
        ),
    ] = False,
    events: Annotated[
        str | None,
        typer.Option(
            metavar="CLASS,...",
            help="Classes of frames that are one kind of event, such as falls: how many are found, "
            "false alarms an hour, delays.",
        ),
    ] = None,
    event_threshold: Annotated[
        float, typer.Option(help="Probability of the events from which on there is an alarm.")
    ] = 0.5,
    event_tolerance: Annotated[
        float, typer.Option(help="Time after an event until which an alarm is of it, s.")
    ] = 5.0,
    batch: Annotated[int, typer.Option(min=1, help="Number of images per batch.")] = 32,
    resize: Resize = False,
    classes: Classes = None,
    device: Device = "auto",
    overwrite: ReplaceResults = False,
) -> None:
    """Evaluate trained networks on data sets.

    Example:

      radhar eval runs/quickstart datasets/quickstart --tsne

      radhar eval runs/falls datasets/falls --events falling,falling_off_seat,falling_on_rising

    Each run is evaluated on each data set, for example to compare networks, or to test one that was
    trained at a single SNR at all others.
    """
    from radhar_cli.commands.learning_options import (
        needs_torch,
        refuse_output_inside_data,
        split_runs_and_data,
    )

    needs_torch()
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.files.replacing import refuse_links
    from radhar_cli.learning.event_metrics import AlarmRules
    from radhar_cli.learning.images.classes import read_classes
    from radhar_cli.learning.images.image_set import check_split_name
    from radhar_cli.learning.machine import choose_device
    from radhar_cli.learning.report import evaluate as evaluate_runs
    from radhar_cli.learning.report import main_scores
    from radhar_cli.learning.tasks.predictions import EvalOptions

    runs, data = split_runs_and_data(paths)
    options = EvalOptions(
        split=None if split is None else check_split_name(split),
        map=map_,
        tsne=tsne,
        in_place_vs_moving=in_place_vs_moving,
        batch=batch,
        resize=resize,
        names=read_classes(classes),
        filters=filters,
        events=() if events is None else _read_events(events),
        event_threshold=_require_within("--event-threshold", event_threshold, 1e-6, 1),
        alarms=AlarmRules(late_s=_require_within("--event-tolerance", event_tolerance, 0, 3600)),
    )
    inside = runs[0] if runs[0].is_dir() else runs[0].parent
    folder = out or inside / "eval"
    if out is None:
        refuse_links(inside, folder)
    refuse_output_inside_data(folder, data)
    inputs = {"of": [str(path.resolve()) for path in (*runs, *data)]}
    _refuse_another_report(folder, inputs | {"split": options.split}, overwrite)
    with BarProgress("image") as bars:
        evaluation = evaluate_runs(runs, data, options, choose_device(device), bars)
    evaluation.numbers |= inputs
    evaluation.write(folder)
    files = {"page": folder / "report.html", "numbers": folder / "report.json"}
    report(**files, **main_scores(evaluation.numbers["runs"]))
    tell(f"{folder / 'report.html'}: {len(evaluation.figures)} figures; numbers in report.json")


def _read_events(words: str) -> tuple[str, ...]:
    """Names of classes, which commas separate, each once."""
    names = tuple(dict.fromkeys(name.strip() for name in words.split(",")))
    if "" in names:
        raise ConfigError(f"--events = {words}: should be names of classes, separated by commas")
    return names


def _require_within(option: str, value: float, low: float, high: float) -> float:
    """Value of an option; ConfigError if it is not within two ends."""
    if not low <= value <= high:
        raise ConfigError(f"{option} = {value:g}: should be from {low:g} to {high:g}")
    return value


def _refuse_another_report(folder: Path, about: dict[str, Any], replace: bool) -> None:
    """Refuse a folder that holds the report of other runs, data or another split."""
    path = folder / "report.json"
    if replace or not path.exists():
        return
    try:
        stored = read_json(path)
    except FolderError:
        stored = None
    if not isinstance(stored, dict) or any(stored.get(key) != about[key] for key in about):
        raise FolderError(
            f"{folder}: holds another report; --overwrite replaces it, -o names another folder"
        )
