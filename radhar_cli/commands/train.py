"""`radhar train`: a data set becomes a trained network."""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from radhar_cli.commands.learning_options import Classes
from radhar_cli.commands.options import Overrides, StartOver, resumable
from radhar_cli.commands.tell import report, tell
from radhar_cli.errors import ConfigError
from radhar_cli.processes import interrupts

if TYPE_CHECKING:
    from radhar_cli.learning import training
    from radhar_cli.learning.tasks.predictions import EvalOptions


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
    shots: Annotated[
        str | None,
        typer.Option(
            metavar="K,...",
            help="With --init: accuracy after learning from K labelled images of each class of the "
            "first DATA, beside a network from scratch; others are shown beside them.",
        ),
    ] = None,
    repeats: Annotated[
        int, typer.Option(min=1, help="With --shots: number of draws of each K.")
    ] = 5,
    overwrite: StartOver = False,
) -> None:
    """Train a network on a data set.

    Example:

      radhar train datasets/quickstart -o runs/quickstart

      radhar train datasets/boards -o runs/joints --model cloudnet --target skeleton

      radhar train datasets/streams -o runs/frames --model tcn --target frames

      radhar train measured -o runs/tuned --init runs/simulated --resize --set learning_rate=1e-4

      radhar train measured -o out/shots --init runs/simulated --shots 0,1,5,20

    An interrupted run is resumed after its last finished epoch by the same command. With
    --tensorboard, `tensorboard --logdir runs` shows the curves of all runs.
    """
    from radhar_cli.commands.learning_options import needs, needs_torch, refuse_output_inside_data

    needs_torch()
    if tensorboard:
        needs("tensorboard")
    from radhar_cli.commands.terminal import TrainingView
    from radhar_cli.config.reading import Override, load_section
    from radhar_cli.learning import training
    from radhar_cli.learning.images.classes import read_classes
    from radhar_cli.learning.settings import TrainConfig
    from radhar_cli.learning.tasks.predictions import EvalOptions

    refuse_output_inside_data(out, [*data, *([init] if init else [])])
    if shots is not None:
        without_effect = {
            "--config": config,
            "--model": model,
            "--target": target,
            "--overwrite": overwrite,
        }
        start = _start_of_shots(init, {**without_effect, "--tensorboard": tensorboard})
        reading = EvalOptions("all", map=map_, resize=resize, names=read_classes(classes))
        _train_few_shots(data, start, out, _parse_shots(shots), repeats, set_ or [], reading)
        return
    named = {"map": map_, "model": model, "target": target}
    overrides = [Override(key, value, f"--{key}") for key, value in named.items() if value]
    settings = load_section(TrainConfig, config, [*(set_ or []), *overrides])
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
    _print_outcome(outcome)


def _print_outcome(outcome: "training.Outcome") -> None:
    """Print and report what a training has led to."""
    from radhar_cli.learning import run_files

    best = outcome.best
    report(
        folder=outcome.folder,
        epochs=len(outcome.history),
        resumed=outcome.resumed,
        best=asdict(best),
        weights=outcome.folder / run_files.BEST,
    )
    if outcome.resumed == len(outcome.history):
        tell(f"{outcome.folder} is complete: {outcome.resumed} epochs; nothing to do")
    tell(
        f"best epoch {best.epoch}: validation {outcome.score} {100 * best.val_accuracy:.2f} % "
        f"{outcome.interval}, by which it was chosen: `radhar eval` tells of a test part"
    )
    for name in (run_files.BEST, run_files.CURVES, run_files.METRICS):
        tell(f"  {outcome.folder / name}")


def _start_of_shots(init: Path | None, options: dict[str, object]) -> Path:
    """Run that learns from a few labels; options that say nothing then are refused.

    Raises:
        ConfigError: names the option.
    """
    if init is None:
        raise ConfigError("--shots: needs --init, a run that goes on learning")
    for option, value in options.items():
        if value:
            raise ConfigError(f"{option}: has no effect with --shots; should be left out")
    return init


def _parse_shots(text: str) -> list[int]:
    """Numbers of labelled images, in order, of a text such as 0,5,20.

    Raises:
        ConfigError: it is none.
    """
    words = text.split(",")
    if not all(word.strip().isdecimal() and len(word) < 7 for word in words):
        raise ConfigError(f"--shots {text}: should be numbers such as 0,1,5,20")
    return sorted({int(word) for word in words})


def _train_few_shots(
    data: list[Path],
    init: Path,
    out: Path,
    shots: list[int],
    repeats: int,
    settings: list[str],
    reading: "EvalOptions",
) -> None:
    """Print and write the table of few shots."""
    from radhar_cli.commands.terminal import TrainingView
    from radhar_cli.learning.few_shots import TABLE, ShotOptions, measure_few_shots

    options = ShotOptions(shots, repeats, data[1:], 0, settings, reading)
    with resumable(f"what is trained in {out}"), TrainingView() as view:
        results = measure_few_shots(init, data[0], out, options, view)
        interrupts.complete(str(out))
    report(folder=out, table=[asdict(result) for result in results])
    for result in results:
        tell(str(result))
    tell(f"  {out / TABLE}")
