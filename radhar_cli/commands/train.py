"""`radhar train`: a data set becomes a trained network."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.learning_options import Classes
from radhar_cli.commands.options import Overrides, StartOver, resumable
from radhar_cli.errors import FolderError


def train(
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the run.")],
    data: Annotated[
        list[Path] | None,
        typer.Argument(
            help="dataset.h5, a folder that generate wrote, or a tree of class folders; several "
            "are combined (data_weights, sampling). With --stream: the validation data."
        ),
    ] = None,
    stream: Annotated[
        Path | None,
        typer.Option(
            metavar="CONFIG",
            help="Train on samples of this config, synthesised on the fly, each used once.",
        ),
    ] = None,
    config: Annotated[
        Path | None,
        typer.Option(help="YAML file; settings that suit small data sets if not given."),
    ] = None,
    set_: Overrides = None,
    map_: Annotated[
        str | None, typer.Option("--map", help="Which map to learn; the first one if not given.")
    ] = None,
    model: Annotated[
        str | None,
        typer.Option(
            help="fftnet, smallnet, or a name of timm's, see radhar models; of sequences framenet "
            "or cloudnet."
        ),
    ] = None,
    target: Annotated[
        str | None,
        typer.Option(
            help="classes, labels (of everybody), count (of people), or skeleton (joints)."
        ),
    ] = None,
    init: Annotated[
        Path | None, typer.Option(help="A run whose best weights are the initial ones.")
    ] = None,
    classes: Classes = None,
    tensorboard: Annotated[
        bool, typer.Option("--tensorboard", help="Also write event files into RUN/tensorboard.")
    ] = False,
    overwrite: StartOver = False,
) -> None:
    """Train a network on a data set.

    Example:

      radhar train datasets/quickstart -o runs/quickstart

      radhar train datasets/boards -o runs/joints --model cloudnet --target skeleton

      radhar train datasets/measured -o runs/tuned --init runs/simulated --set learning_rate=1e-4

      radhar train --stream configs/quickstart.yaml -o runs/endless    # every image new

    The same command, run again, resumes after the last finished epoch.
    """
    from radhar_cli.commands.learning_options import apart, needs, needs_torch

    needs_torch()
    events = None
    if tensorboard:
        needs("tensorboard", ("tensorboard",))
        from radhar_cli.learning.event_files import EventFiles

        events = EventFiles(out)
    from radhar_cli.commands.training_view import TrainingView
    from radhar_cli.config.reading import load_config, load_section
    from radhar_cli.learning import training
    from radhar_cli.learning.images.classes import read_classes
    from radhar_cli.learning.settings import TrainConfig

    named = {"map": map_, "model": model, "target": target}
    overrides = [
        *(set_ or []),
        *(f"--{key} {key}={value}" for key, value in named.items() if value),
    ]
    settings = load_section(TrainConfig, config, overrides)
    data = data or []
    if not data and stream is None:
        raise FolderError("DATA is missing; should name a data set, or --stream a config")
    apart(out, [*data, *([init] if init else [])])
    names = read_classes(classes) if classes else {}
    with resumable(f"the last finished epoch in {out}"), TrainingView(events) as view:
        samples = load_config(stream) if stream else None
        outcome = training.train(settings, data, out, view, overwrite, names, init, samples)
    view.print_outcome(outcome)
