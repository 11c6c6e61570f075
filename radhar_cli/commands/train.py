"""`radhar train`: a data set becomes a trained network."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.learning_options import Classes
from radhar_cli.commands.options import Overrides, StartOver, resumable
from radhar_cli.commands.tell import report, tell
from radhar_cli.processes import interrupts


def train(
    data: Annotated[
        list[Path],
        typer.Argument(
            help="Data sets to train on: dataset.h5, a folder that `radhar generate` wrote, or a "
            "tree of class folders. Several are combined, as data_weights and sampling say."
        ),
    ],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder to write the run to.")],
    config: Annotated[
        Path | None, typer.Option(help="Training config (YAML). The defaults suit small data sets.")
    ] = None,
    set_: Overrides = None,
    map_: Annotated[
        str | None, typer.Option("--map", help="Map to train on. The default is the first one.")
    ] = None,
    model: Annotated[
        str | None,
        typer.Option(
            help="Network: for images smallnet, smallnet_bn, fftnet or any model of timm; for "
            "frames of streams tcn; for sequences framenet or cloudnet."
        ),
    ] = None,
    target: Annotated[
        str | None,
        typer.Option(
            help="What to learn: classes (the activity of the main person), labels (the activities "
            "of everybody), count (the number of people), person (who it is), frames (every column "
            "of a stream) or skeleton (joints in every frame)."
        ),
    ] = None,
    init: Annotated[
        Path | None, typer.Option(help="Run whose best weights training starts from.")
    ] = None,
    resize: Annotated[
        bool,
        typer.Option("--resize", help="With --init: resize images to the size used in that run."),
    ] = False,
    tensorboard: Annotated[
        bool, typer.Option("--tensorboard", help="Also log the training curves for TensorBoard.")
    ] = False,
    classes: Classes = None,
    overwrite: StartOver = False,
) -> None:
    """Train a network on a data set.

    Example:

      radhar train datasets/quickstart -o runs/quickstart

      radhar train datasets/boards -o runs/joints --model cloudnet --target skeleton

      radhar train datasets/streams -o runs/frames --model tcn --target frames

      radhar train measured -o runs/tuned --init runs/simulated --resize --set learning_rate=1e-4

    An interrupted run is resumed after its last finished epoch by the same command. With
    --tensorboard, `tensorboard --logdir runs` shows the curves of all runs.
    """
    from radhar_cli.commands.learning_options import needs, needs_torch, refuse_output_inside_data

    needs_torch()
    if tensorboard:
        needs("tensorboard")
    from radhar_cli.commands.terminal import TrainingView
    from radhar_cli.config.reading import Override, load_section
    from radhar_cli.learning import run_files, training
    from radhar_cli.learning.images.classes import read_classes
    from radhar_cli.learning.settings import TrainConfig

    named = {"map": map_, "model": model, "target": target}
    overrides = [Override(key, value, f"--{key}") for key, value in named.items() if value]
    settings = load_section(TrainConfig, config, [*(set_ or []), *overrides])
    refuse_output_inside_data(out, [*data, *([init] if init else [])])
    options = training.TrainOptions(
        names=read_classes(classes),
        start=init,
        resize=resize,
        overwrite=overwrite,
        tensorboard=tensorboard,
    )
    with resumable(f"the last finished epoch in {out}"), TrainingView() as view:
        outcome = training.train(settings, data, out, view, options)
        interrupts.complete(str(out))
    best = outcome.best
    report(
        folder=out,
        epochs=len(outcome.history),
        resumed=outcome.resumed,
        best=asdict(best),
        weights=out / run_files.BEST,
    )
    if outcome.resumed == len(outcome.history):
        tell(f"{out} is complete: {outcome.resumed} epochs; nothing to do")
    tell(
        f"best epoch {best.epoch}: validation {outcome.score} {100 * best.val_accuracy:.2f} % "
        f"{outcome.interval}, by which it was chosen: `radhar eval` tells of a test part"
    )
    for name in (run_files.BEST, run_files.CURVES, run_files.METRICS):
        tell(f"  {out / name}")
