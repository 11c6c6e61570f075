"""`radhar adapt`: a trained network is fitted to unlabelled images of another radar."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.learning_options import Device, Resize, Run, Split, TrainedMap
from radhar_cli.commands.options import StartOver
from radhar_cli.commands.tell import counted, report, tell
from radhar_cli.errors import ConfigError


def adapt(
    run: Run,
    data: Annotated[
        Path, typer.Argument(help="A data set or a tree of images; its classes are not used.")
    ],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the adapted run.")],
    map_: TrainedMap = None,
    split: Split = "all",
    epochs: Annotated[
        int | None,
        typer.Option(
            min=0,
            max=1000,
            help="Epochs of training on the images: towards confident predictions, with all "
            "classes equally frequent. 0 adapts batch norm only; default: 0 if the network has "
            "batch norm and there is no --mix, else 20.",
        ),
    ] = None,
    mix: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="DATA",
            help="Labelled data that RUN was trained on, used in the same epochs; may repeat.",
        ),
    ] = None,
    resize: Resize = False,
    overwrite: StartOver = False,
    device: Device = "auto",
) -> None:
    """Adapt a copy of a run to another radar's images, without labels.

    Batch-norm statistics are recomputed on the images; in epochs the copy is trained on them.

    Example:

      radhar adapt runs/simulated measured -o runs/adapted --epochs 20 --mix datasets/simulated

    This is for a network that was trained on simulated maps and will be used with a real radar.
    The classes should be about as frequent in the images as in later use; with --epochs, about
    equally frequent.
    """
    from radhar_cli.commands.learning_options import apart, needs_torch

    needs_torch()
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.learning import adaptation
    from radhar_cli.learning.images.image_set import check_split_name
    from radhar_cli.learning.machine import choose_device

    if mix and epochs == 0:
        raise ConfigError("--mix: needs --epochs, during which its data are used")
    apart(out, [data, *(mix or [])])
    adapted = adaptation.adapt(
        run,
        data,
        out,
        choose_device(device),
        map_,
        check_split_name(split),
        resize,
        overwrite,
        epochs,
        tuple(mix or ()),
        BarProgress(),
    )
    passes = int(adapted.work["adapted_epochs"])
    report(folder=out, run=run, data=data, epochs=passes)
    more = f", after {counted(passes, 'epoch')} without labels" if passes else ""
    tell(f"{out}: {run}, adapted to {data}{more}")
