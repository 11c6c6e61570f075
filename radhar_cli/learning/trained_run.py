"""A trained network in Python: `radhar.load_run`."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, overload

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from radhar_cli.dataset.png import colour_table
from radhar_cli.errors import FolderError
from radhar_cli.learning.estimates import RunEstimates, joined_estimates
from radhar_cli.learning.evaluation import (
    PREDICT_BATCH,
    Inputs,
    open_unlabelled,
    predict_batches,
)
from radhar_cli.learning.images.image_set import check_split_name
from radhar_cli.learning.images.sequences import COLUMNS
from radhar_cli.learning.machine import choose_device
from radhar_cli.learning.run_files import RunError
from radhar_cli.learning.run_folder import RunMetadata, load_best
from radhar_cli.learning.tasks.skeleton import Skeleton
from radhar_cli.numerics.arrays import Float


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

    @property
    def target(self) -> str:
        """Name of what it has learned: classes, labels, count, person, frames or skeleton."""
        return self.metadata.settings.target

    @property
    def input_shape(self) -> tuple[int, ...]:
        """Shape of an input.

        [H, W, 3] of RGB, [H, W] of gray images, [T, H, W] of frames, [T, points, 6] of clouds.
        """
        about = self.metadata
        last = {"rgb": (3,), "gray": (), "frames": (), "clouds": (len(COLUMNS),)}[about.input]
        return ((about.channels,) if about.input == "frames" else ()) + (*about.size, *last)

    @property
    def units(self) -> dict[str, str]:
        """Quantities and units of the inputs and of the outputs, in words."""
        levels = "uint8, highest Doppler or farthest range first, time to the right"
        inputs = {
            "rgb": f"pixels 0 to 255, {levels}",
            "gray": f"grey levels 0 to 255, {levels}",
            "frames": "grey levels 0 to 255 of a map, uint8, frame by frame",
            "clouds": "x ahead, y left, z up (m), Doppler (m/s, approaching), SNR (dB/10), 1 where "
            "there is a point",
        }
        joints = "x ahead of the radar, y left, z up (m)"
        task = self.metadata.task
        return {
            "inputs": inputs[self.metadata.input],
            "outputs": joints if task.coordinates else f"{task.values_name}, 0 to 1",
        }

    @overload
    def __call__(self, inputs: NDArray[Any]) -> Float: ...

    @overload
    def __call__(self, inputs: Tensor) -> Tensor: ...

    def __call__(self, inputs: NDArray[Any] | Tensor) -> Float | Tensor:
        """Probabilities [N, classes], or joints [N, T, joint, 3] in m, of a batch of inputs.

        Args:
            inputs: array [N, *input_shape] as data sets have it; grey levels of a network of RGB
                are coloured as its pictures were. Or a tensor as the network takes it: [N, 3, H,
                W], gray [N, 1, H, W], frames [N, T, H, W], clouds [N, 6, T, points].

        Raises:
            FolderError: an array of another shape or type.
        """
        if isinstance(inputs, np.ndarray):
            stored = torch.from_numpy(self._arrange_as_stored(inputs))
            starts = range(0, len(stored), PREDICT_BATCH)
            batches = [self(stored[start : start + PREDICT_BATCH]).cpu() for start in starts]
            return np.concatenate([batch.numpy() for batch in batches])
        with torch.inference_mode():
            outputs: Tensor = self.network(self.metadata.normalisation(inputs.to(self.device)))
            return self.metadata.task.predict(outputs)

    def _arrange_as_stored(self, inputs: NDArray[Any]) -> NDArray[Any]:
        """Arrange an array [N, *input_shape] as data sets store it, [N, C, H, W].

        Raises:
            FolderError: it has another shape or type.
        """
        shape, about = self.input_shape, self.metadata
        colours = about.colours if about.input == "rgb" else None
        if colours is not None and inputs.shape[1:] == shape[:-1] and inputs.dtype == np.uint8:
            inputs = colour_table(colours)[inputs]
        kind = np.float32 if about.input == "clouds" else np.uint8
        is_float = about.input == "clouds" and inputs.dtype.kind == "f"
        if inputs.shape[1:] != shape or not len(inputs) or not (is_float or inputs.dtype == kind):
            sides = ", ".join(map(str, shape))
            raise FolderError(
                f"an array of {inputs.dtype} {[*inputs.shape]}: should be {np.dtype(kind)} "
                f"[N, {sides}]: {self.units['inputs']}"
            )
        if about.input == "gray":
            inputs = inputs[:, None]
        elif about.input != "frames":
            inputs = np.moveaxis(inputs, -1, 1)
        return np.ascontiguousarray(inputs, kind)

    def predict(
        self,
        path: str | Path,
        map: str | None = None,
        split: str = "all",
        resize: bool = False,
        settings: Mapping[str, Any] | None = None,
    ) -> RunEstimates:
        """Find classes or joints in an image, a folder of images, a table of points or a data set.

        Args:
            path: image, folder of images, table or recording of points, or data set.
            map: map of a data set; None is the one that the run was trained on.
            split: split of a data set: train, val, test or all.
            resize: bring images to the size of those in training.
            settings: what a table of points does not say: {"axes": ["right", "ahead", "up"],
                "doppler": "receding"}.

        Raises:
            RadharError: no such data, or images of another size.
        """
        part = check_split_name(split)
        inputs = open_unlabelled(self.metadata, Path(path), map, part, resize, settings or {})
        return joined_estimates([*self.estimate(inputs)])

    def estimate(self, inputs: Inputs) -> Iterator[RunEstimates]:
        """Yield what the network finds, batch by batch.

        Raises:
            RunError: an output is not finite.
        """
        about, task, done = self.metadata, self.metadata.task, 0
        reading = (inputs.pixels, inputs.rows, self.device, PREDICT_BATCH)
        for values in predict_batches(self.network, about, *reading):
            part = slice(done, done + len(values))
            done = part.stop
            if task.axes[:1] == ("frame",):
                for sequence, length in zip(values, inputs.lengths[part].tolist(), strict=True):
                    sequence[length:] = np.nan
            values = values.reshape(len(values), *(values.shape[1:] or (1,)))
            names = task.names(about)
            yield RunEstimates(inputs.names[part], names, values, inputs.first[part], task)

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
