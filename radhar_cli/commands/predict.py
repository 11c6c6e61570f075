"""`radhar predict`: classes of single maps, or joints in sequences."""

from pathlib import Path
from typing import Annotated

import typer

from radhar_cli.commands.learning_options import Device, Resize, Run, Split, TrainedMap
from radhar_cli.commands.tell import counted, report, tell


def predict(
    run: Run,
    paths: Annotated[
        list[Path],
        typer.Argument(metavar="IMAGE_OR_DATA...", help="Images, folders of images, or data sets."),
    ],
    top: Annotated[
        int, typer.Option(min=1, help="Number of classes to print, most likely first.")
    ] = 3,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            help="For networks trained on skeletons: file for the joints, .npz or .csv.",
        ),
    ] = None,
    map_: TrainedMap = None,
    split: Split = "all",
    resize: Resize = False,
    device: Device = "auto",
) -> None:
    """Print the most likely classes of images; or joints of sequences.

    Example:

      radhar predict runs/quickstart datasets/quickstart/png/stft/test/walking/00011.png

      radhar predict runs/joints datasets/boards -o joints.npz

    An .npz file holds joints [sample, frame, joint, 3] in m (x ahead of the radar, y to its left, z
    up; NaN after the end of a sample), joint_names, samples, and first_frame, the number in its
    sample of the first frame. A .csv file holds one row for each joint in each frame.
    """
    from radhar_cli.commands.learning_options import needs_torch

    needs_torch()
    from radhar_cli.learning.evaluation import predict_paths
    from radhar_cli.learning.images.image_set import check_split_name
    from radhar_cli.learning.machine import choose_device

    chosen, split_part = choose_device(device), check_split_name(split)
    if out is not None:
        from radhar_cli.learning.estimated_joints import check_joints_file, predict_joints

        check_joints_file(out)
        sequences = predict_joints(run, paths, chosen, map_, split_part)
        sequences.write(out)
        count = len(sequences.samples)
        report(file=out, samples=count, joints=list(sequences.names))
        tell(f"{out}: {len(sequences.names)} joints in {counted(count, 'sequence')}")
        return

    def warn(note: str) -> None:
        tell(note, err=True)

    for name, probabilities in predict_paths(run, paths, chosen, map_, split_part, resize, warn):
        ranked = sorted(probabilities.items(), key=lambda item: -item[1])
        report(**{"image": name, "class": ranked[0][0], "probabilities": probabilities})
        likely = ", ".join(f"{label} {100 * p:.1f} %" for label, p in ranked[:top])
        tell(f"{name}: {likely}")
