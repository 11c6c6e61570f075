"""A trained network in Python: `radhar.load_run`."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from radhar_cli.learning.estimated_joints import EstimatedJoints, find_joints
from radhar_cli.learning.evaluation import PREDICT_BATCH, open_unlabelled, predict_batches
from radhar_cli.learning.images.image_set import check_split_name
from radhar_cli.learning.machine import choose_device
from radhar_cli.learning.run_files import RunError
from radhar_cli.learning.run_folder import RunMetadata, load_best
from radhar_cli.learning.tasks.skeleton import Skeleton
from radhar_cli.numerics.arrays import Float


@dataclass(frozen=True)
class EstimatedClasses:
    """Probabilities of every class, image by image; N is the number of images."""

    samples: tuple[str, ...]  # [N] names
    classes: tuple[str, ...]
    probabilities: Float  # [N, classes]; of labels each by itself, else they add up to 1

    @property
    def likeliest(self) -> list[str]:
        """Likeliest class of each image [N]."""
        return [self.classes[number] for number in self.probabilities.argmax(1)]


@dataclass(frozen=True)
class TrainedRun:
    """Network with the best weights of a training run, and its description.

    Attributes:
        metadata: classes, size, map, normalisation and settings, as best.safetensors has them.
        network: network in evaluation mode, which takes normalised inputs.
        device: device of the network.
    """

    metadata: RunMetadata
    network: nn.Module
    device: torch.device

    @property
    def classes(self) -> tuple[str, ...]:
        """Names of the classes, in the order of the outputs; of no meaning for joints."""
        return self.metadata.classes

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints that it finds, in the order of the outputs; empty for classes."""
        return self.metadata.joints if isinstance(self.metadata.task, Skeleton) else ()

    def __call__(self, inputs: Tensor) -> Tensor:
        """Probabilities [B, classes], or joints [B, T, joint, 3] in m, of a batch of inputs.

        Args:
            inputs: as they are stored: images uint8 [B, 3, H, W], gray ones [B, 1, H, W], frames
                uint8 [B, T, H, W], clouds float32 [B, 6, T, points] (`Sequences` has the columns
                last).
        """
        with torch.inference_mode():
            outputs: Tensor = self.network(self.metadata.normalisation(inputs.to(self.device)))
            return self.metadata.task.predict(outputs)

    def predict(
        self,
        path: str | Path,
        map: str | None = None,
        split: str = "all",
        resize: bool = False,
    ) -> EstimatedClasses | EstimatedJoints:
        """Classes or joints that the network finds in an image, a folder of images, or a data set.

        Args:
            path: image, folder of images, or data set.
            map: map of a data set; None is the one that the run was trained on.
            split: split of a data set: train, val, test or all.
            resize: bring images to the size of those in training.

        Raises:
            FolderError: no such data, or images of another size.
        """
        where, part = Path(path), check_split_name(split)
        if isinstance(self.metadata.task, Skeleton):
            return find_joints(self.metadata, self.network, [where], self.device, map, part)
        inputs = open_unlabelled(self.metadata, where, map, part, resize)
        reading = (inputs.pixels, inputs.rows, self.device, PREDICT_BATCH)
        batches = predict_batches(self.network, self.metadata, *reading)
        probabilities = np.concatenate(list(batches))
        return EstimatedClasses(inputs.names, self.classes, probabilities)

    def __repr__(self) -> str:
        about = self.metadata
        return f"<TrainedRun: {about.model}, {about.outputs_in_words}, of {about.shape}>"


def load_run(path: str | Path, device: str = "auto") -> TrainedRun:
    """Load a network that `radhar train` wrote; the file runs no code.

    `load_run("runs/quickstart").predict("datasets/quickstart", split="val").likeliest` is the list
    of the classes that it finds.

    Args:
        path: folder of the run, or its best.safetensors.
        device: auto, cpu, cuda or mps.

    Raises:
        RunError: it is no run, or is damaged.
        MachineError: a device that is not available.
    """
    run = Path(path)
    if not run.exists():
        raise RunError(f"{run}: no such file or folder")
    torch_device = choose_device(device)
    metadata, network = load_best(run)
    return TrainedRun(metadata, network.to(torch_device), torch_device)
