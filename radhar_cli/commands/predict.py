"""`radhar predict`: classify single maps."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.learning_options import Device, Resize, Run, Split, TrainedMap
from radhar_cli.commands.tell import report, tell


def predict(
    run: Run,
    paths: Annotated[
        list[Path], typer.Argument(metavar="IMAGE_OR_DATA...", help="Images or data sets.")
    ],
    top: Annotated[int, typer.Option(min=1, help="Classes to print, most likely first.")] = 3,
    map_: TrainedMap = None,
    split: Split = "all",
    resize: Resize = False,
    device: Device = "auto",
) -> None:
    """Print the most likely classes of every image.

    Example:

      radhar predict runs/quickstart datasets/quickstart/png/stft/val/walking/00003.png
    """
    from radhar_cli.commands.learning_options import needs_torch

    needs_torch()
    from radhar_cli.learning.evaluation import predict_paths
    from radhar_cli.learning.images.image_set import split_named
    from radhar_cli.learning.machine import choose_device

    predictions = predict_paths(run, paths, choose_device(device), map_, split_named(split), resize)
    for name, probabilities in predictions:
        ranked = sorted(probabilities.items(), key=lambda item: -item[1])
        report(**{"image": name, "class": ranked[0][0], "probabilities": probabilities})
        likely = ", ".join(f"{label} {100 * p:.1f} %" for label, p in ranked[:top])
        tell(f"{name}: {likely}")
