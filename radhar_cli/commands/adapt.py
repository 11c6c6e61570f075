"""`radhar adapt`: a trained network is adapted to unlabelled images of another radar."""

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
        Path,
        typer.Argument(help="Data set or tree of images of the other radar; labels are not used."),
    ],
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder to write the adapted run to.")],
    map_: TrainedMap = None,
    split: Split = "all",
    epochs: Annotated[
        int | None,
        typer.Option(
            min=0,
            max=1000,
            help="Epochs of training on the unlabelled images; the loss is the mean entropy of the "
            "predictions less the entropy of their mean. 0 recomputes batch-norm statistics only. "
            "The default is 0 for a network with batch norm and without --mix, else 20.",
        ),
    ] = None,
    mix: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="DATA",
            help="Labelled data that RUN was trained on, shown in the same epochs; may be given "
            "several times.",
        ),
    ] = None,
    resize: Resize = False,
    overwrite: StartOver = False,
    device: Device = "auto",
) -> None:
    """Adapt a trained network to another radar's unlabelled images.

    RUN stays as it is. In the copy, batch-norm statistics are recomputed on the images; with
    --epochs, all layers but the last are also trained on them.

    Example:

      radhar adapt runs/simulated measured -o runs/adapted --epochs 20 --mix datasets/simulated

    This is for a network that was trained on simulated maps and will be used with a real radar.
    The images should show the classes about as often as later use will; with --epochs, about
    equally often.
    """
    from radhar_cli.commands.learning_options import needs_torch, refuse_output_inside_data

    needs_torch()
    from radhar_cli.commands.terminal import BarProgress
    from radhar_cli.learning import adaptation
    from radhar_cli.learning.images.image_set import check_split_name
    from radhar_cli.learning.machine import choose_device

    if mix and epochs == 0:
        raise ConfigError("--mix: needs --epochs, during which its data are used")
    refuse_output_inside_data(out, [data, *(mix or [])])
    options = adaptation.AdaptOptions(
        map=map_,
        split=check_split_name(split),
        resize=resize,
        overwrite=overwrite,
        epochs=epochs,
        mix=tuple(mix or ()),
    )
    adapted = adaptation.adapt(run, data, out, choose_device(device), options, BarProgress())
    passes = int(adapted.work["adapted_epochs"])
    report(folder=out, run=run, data=data, epochs=passes)
    more = f", after {counted(passes, 'epoch')} without labels" if passes else ""
    tell(f"{out}: {run}, adapted to {data}{more}")
