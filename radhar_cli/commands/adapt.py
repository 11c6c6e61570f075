"""`radhar adapt`: a trained network is fitted to unlabelled images of another radar."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.learning_options import Device, Resize, Run, Split, TrainedMap
from radhar_cli.commands.options import StartOver
from radhar_cli.commands.tell import report, tell
from radhar_cli.errors import ConfigError


def adapt(
    run: Run,
    data: Annotated[
        Path, typer.Argument(help="A data set or a tree of images; classes are not looked at.")
    ],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the adapted run.")],
    map_: TrainedMap = None,
    split: Split = "all",
    epochs: Annotated[
        int,
        typer.Option(
            min=0,
            max=1000,
            help="Passes in which it also learns from the images: to be sure of each, and of every "
            "class equally often.",
        ),
    ] = 0,
    mix: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="DATA",
            help="Of --epochs: labelled data that RUN learned from, shown at the same time; may "
            "repeat.",
        ),
    ] = None,
    resize: Resize = False,
    overwrite: StartOver = False,
    device: Device = "auto",
) -> None:
    """Fit a copy of a run to another radar's images, without labels.

    Its batch-norm statistics are taken from them, and with --epochs it learns from them.

    Example:

      radhar adapt runs/simulated measured -o runs/adapted --epochs 20 --mix datasets/simulated

    For a network that learned from simulated maps and is to work on a radar's. The images should
    show the classes about as often as those it will be asked about; with --epochs, every class
    about equally often.
    """
    from radhar_cli.commands.learning_options import apart, needs_torch

    needs_torch()
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.learning import adaptation
    from radhar_cli.learning.images.image_set import split_named
    from radhar_cli.learning.machine import choose_device

    if mix and not epochs:
        raise ConfigError("--mix: needs --epochs, in which it is shown")
    apart(out, [data, *(mix or [])])
    adaptation.adapt(
        run,
        data,
        out,
        choose_device(device),
        map_,
        split_named(split),
        resize,
        overwrite,
        epochs,
        tuple(mix or ()),
        BarProgress(),
    )
    report(folder=out, run=run, data=data, epochs=epochs)
    more = f", after {epochs} epoch{'s' * (epochs > 1)} without labels" if epochs else ""
    tell(f"{out}: {run} with the batch norm of {data}{more}")
