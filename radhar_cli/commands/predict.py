"""`radhar predict`: what a network finds in images, sequences and clouds."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.learning_options import Device, Resize, Run, Split, TrainedMap
from radhar_cli.commands.tell import counted, report, tell
from radhar_cli.errors import ConfigError


def predict(
    run: Run,
    paths: Annotated[
        list[Path],
        typer.Argument(
            metavar="IMAGE_OR_DATA...",
            help="Images, folders of images, data sets, or for networks of clouds tables of points "
            "(.csv, .npz) and recordings of points.",
        ),
    ],
    top: Annotated[
        int, typer.Option(min=1, help="Number of classes to print, most likely first.")
    ] = 3,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o", "--out", help="File for classes or joints, .npz, .csv or .json, instead of print."
        ),
    ] = None,
    overlay: Annotated[
        Path | None,
        typer.Option(
            metavar="PNG",
            help="Picture to write: some inputs of the first path with what is found in them.",
        ),
    ] = None,
    map_: TrainedMap = None,
    split: Split = "all",
    resize: Resize = False,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="What a table of points does not say, as of `prepare points`: axes, doppler, "
            "columns.NAME; may be repeated.",
        ),
    ] = None,
    device: Device = "auto",
) -> None:
    """Find classes of images, or joints in clouds, without labels.

    Example:

      radhar predict runs/quickstart datasets/quickstart/png/stft/test/walking/00011.png

      radhar predict runs/joints datasets/boards -o joints.npz --overlay joints.png

      radhar predict runs/joints points.csv -o joints.csv --set axes=[right,ahead,up] --set
      doppler=receding

    An .npz file holds probabilities [sample, class] (of frames of streams [sample, column, class])
    or joints [sample, frame, joint, 3] in m (x ahead of the radar, y to its left, z up; NaN after
    the end of a sample), names of classes or joints, samples, and first_frame, the number in its
    sample of the first frame. A .csv file holds one row for each sample, or for each joint in each
    frame; a .json file a document a sample.
    """
    from radhar_cli.commands.learning_options import needs_torch

    needs_torch()
    from radhar_cli.files.replacing import write_output
    from radhar_cli.learning.estimates import RunEstimates, check_file_name, joined_estimates
    from radhar_cli.learning.evaluation import open_unlabelled
    from radhar_cli.learning.images.image_set import check_split_name
    from radhar_cli.learning.overlay import draw_overlay
    from radhar_cli.learning.trained_run import load_run

    split_part = check_split_name(split)
    if out is not None:
        check_file_name(out)
    if overlay is not None and overlay.suffix != ".png":
        raise ConfigError(f"--overlay {overlay}: should end in .png")
    network, parts = load_run(run, device), list[RunEstimates]()
    for path in paths:
        inputs = open_unlabelled(network.metadata, path, map_, split_part, resize, set_ or ())
        for note in inputs.notes:
            tell(note, err=True)
        first = len(parts)
        for estimates in network.estimate(inputs):
            parts.append(estimates)
            if out is None:
                facts = zip(
                    estimates.samples, estimates.documents(), estimates.lines(top), strict=True
                )
                for name, document, line in facts:
                    report(image=name, **document)
                    tell(f"{name}: {line}")
        if overlay is not None and path == paths[0]:
            drawn = draw_overlay(network.metadata, inputs, joined_estimates(parts[first:]), path)
            write_output(overlay, drawn)
            tell(str(overlay), err=True)
    if out is not None:
        together = joined_estimates(parts)
        together.write(out)
        kind = network.metadata.task.names_key
        report(file=out, samples=len(together), **{kind: list(together.names)})
        samples = counted(len(together), "sample")
        tell(f"{out}: {len(together.names)} {kind} in {samples}")
