"""The joints that a network finds in sequences, and the file that `predict` writes of them."""

import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import nn

from radhar_cli.errors import ConfigError
from radhar_cli.files.replacing import write_output
from radhar_cli.files.table_text import csv_text
from radhar_cli.learning.evaluation import PREDICT_BATCH, open_unlabelled, predict_batches
from radhar_cli.learning.images.sequences import SequenceReader
from radhar_cli.learning.run_files import RunError
from radhar_cli.learning.run_folder import RunMetadata, load_best
from radhar_cli.learning.tasks.skeleton import Skeleton
from radhar_cli.numerics.arrays import Float, Index

SUFFIXES = (".npz", ".csv")


@dataclass(frozen=True)
class EstimatedJoints:
    """Joints that a network found in some sequences of one length."""

    samples: tuple[str, ...]  # [N] names
    names: tuple[str, ...]  # [joint]
    joints: Float  # [N, T, joint, 3] m, in the radar's axes; NaN after the end of a sample
    first_frame: Index  # [N] number of the first frame in its sample

    def write(self, path: Path) -> None:
        """Write the joints as NumPy arrays, or as CSV of a row for each joint and frame.

        Args:
            path: file that ends in .npz or .csv.

        Raises:
            FolderError: the file cannot be written.
        """
        if path.suffix == ".csv":
            content = csv_text(("sample", "frame", "joint", "x_m", "y_m", "z_m"), self._rows())
            data = content.encode("utf-8", "surrogateescape")
        else:
            buffer = io.BytesIO()
            np.savez(
                buffer,
                joints=self.joints.astype(np.float32),
                first_frame=self.first_frame,
                samples=np.array(self.samples),
                joint_names=np.array(self.names),
            )
            data = buffer.getvalue()
        write_output(path, data)

    def _rows(self) -> Iterator[tuple[object, ...]]:
        for sample, frames, first_frame in zip(
            self.samples, self.joints, self.first_frame, strict=True
        ):
            for number, skeleton in enumerate(frames, start=int(first_frame)):
                if np.isnan(skeleton).any():
                    continue
                for name, coordinates in zip(self.names, skeleton.tolist(), strict=True):
                    yield (sample, number, name, *(f"{x:.4f}" for x in coordinates))


def check_joints_file(path: Path) -> None:
    """Refuse a file name that says no format, before anything is computed.

    Raises:
        ConfigError: it ends in neither .npz nor .csv.
    """
    if path.suffix not in SUFFIXES:
        raise ConfigError(f"-o {path}: should end in {' or '.join(SUFFIXES)}")


def find_joints(
    metadata: RunMetadata,
    model: nn.Module,
    paths: Sequence[Path],
    device: torch.device,
    map_name: str | None,
    split: str,
) -> EstimatedJoints:
    """Joints in the sequences of data sets.

    Args:
        metadata: description of the model.
        model: network in evaluation mode, on the device.
        paths: data sets.
        map_name: product of a data set; None is the one of the training.
        split: split of a data set.
    """
    samples, joints, first_frames = list[str](), list[Float](), list[int]()
    for path in paths:
        inputs = open_unlabelled(metadata, path, map_name, split, resize=False)
        reader = inputs.pixels
        assert isinstance(reader, SequenceReader)
        batches = predict_batches(model, metadata, reader, inputs.rows, device, PREDICT_BATCH)
        joints.append(np.concatenate(list(batches)))
        for sequence, row in zip(joints[-1], inputs.rows.tolist(), strict=True):
            start, count = reader.span(row)
            sequence[count:] = np.nan
            first_frames.append(start)
        samples += inputs.names
    return EstimatedJoints(
        tuple(samples), metadata.joints, np.concatenate(joints), np.array(first_frames)
    )


def predict_joints(
    run: Path, paths: Sequence[Path], device: torch.device, map_name: str | None, split: str
) -> EstimatedJoints:
    """Joints that a run finds in data sets.

    Raises:
        RunError: the run finds no joints.
    """
    metadata, model = load_best(run)
    if not isinstance(metadata.task, Skeleton):
        raise RunError(f"{run}: finds {metadata.task.finds}; -o: is for networks that find joints")
    return find_joints(metadata, model.to(device), paths, device, map_name, split)
