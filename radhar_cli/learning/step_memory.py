"""Memory that a training step needs at least, counted without allocating it, and what would fit."""

import os
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path

import torch
from torch import Tensor
from torch.nn import Parameter

from radhar_cli.errors import MachineError, ModelError
from radhar_cli.learning.models.build import build_model, parameter_count
from radhar_cli.learning.settings import TrainConfig

FLOAT = 4  # bytes
COPIES = {"adam": 4, "adamw": 4, "sgd": 3}  # weights, gradient, moments
CGROUP_LIMIT = Path("/sys/fs/cgroup/memory.max")
KEPT = 3  # times the least memory of a step; a process that keeps all of it has had 2.8 times
MIN_SIDE = 32  # px; no network takes smaller images


@dataclass(frozen=True)
class StepMemory:
    """Bytes of a step of n images: state + n * image.

    Attributes:
        state: weights, gradient, what the optimiser keeps, and what of a pass all images share.
        image: what the backward pass needs of each image.
    """

    state: int
    image: int

    def of(self, images: int) -> int:
        """Bytes of a step of so many images."""
        return self.state + images * self.image


@dataclass(frozen=True)
class Step:
    """One forward and backward pass of a run.

    Attributes:
        config: of the run.
        classes: outputs of the network.
        size: (H, W) of the images, px.
        images: of the pass.
        precision: of the forward pass; bfloat16 keeps half the bytes.
    """

    config: TrainConfig
    classes: int
    size: tuple[int, int]
    images: int
    precision: torch.dtype

    def memory(self) -> StepMemory:
        """Least memory: what is alive at once when the forward pass ends.

        Raises:
            ModelError: no such network, or images that it cannot take.
        """
        with torch.device("meta"):
            model = build_model(self.config.model, self.classes, self.size)
        two, four = (_kept(model, torch.zeros(n, 3, *self.size, device="meta")) for n in (2, 4))
        halves = 1 if self.precision == torch.float32 else 2
        image, shared = (four - two) // 2 // halves, (2 * two - four) // halves
        state = COPIES[self.config.optimiser] * FLOAT * parameter_count(model)
        return StepMemory(state + shared, image)

    def check(self, device: torch.device) -> None:
        """Refuse a step that needs more memory than a device has.

        Raises:
            MachineError: says what it needs, and what would fit.
            ModelError: no such network, or images that it cannot take.
        """
        total = total_memory(device)
        if self.memory().of(self.images) > total:
            advice = self.advice(total)
            raise MachineError(f"{device.type} has {_gib(total)} of memory; {advice}")

    def may_keep_memory(self, device: torch.device) -> bool:
        """Whether this is the CPU, with room for a process that returns no memory to the system."""
        return device.type == "cpu" and KEPT * self.memory().of(self.images) < total_memory(device)

    def advice(self, limit: float | None = None) -> str:
        """What the step needs, and the micro batch, or else the image size, that fits in `limit`.

        Args:
            limit: bytes; None is what half the images need.
        """
        memory, fewer = self.memory(), self.images
        limit = memory.of(self.images // 2) if limit is None else limit
        while fewer > 2 and memory.of(fewer) > limit:
            fewer = max(2, fewer // 2)
        if memory.of(fewer) <= limit:
            fits = f"--set micro_batch={fewer} needs {_gib(memory.of(fewer))}"
        else:
            fits = replace(self, images=fewer)._smaller_images(limit)
        return (
            f"a step of {self._described()} needs at least {_gib(memory.of(self.images))}; {fits}"
        )

    def _smaller_images(self, limit: float) -> str:
        step = self
        while min(step.size) > MIN_SIDE:
            # Half a side, on the grid of the strides of networks.
            height, width = (max(MIN_SIDE, side // 2 // MIN_SIDE * MIN_SIDE) for side in step.size)
            step = replace(step, size=(height, width))
            try:
                needed = step.memory().of(step.images)
            except ModelError:  # a network that takes images of one size alone
                break
            if needed <= limit:
                return f"{step._described()} (image.size_px of the data) need {_gib(needed)}"
        return "a smaller model may fit"

    def _described(self) -> str:
        return f"{self.images} images of {self.size[0]} x {self.size[1]} px"


def _kept(model: torch.nn.Module, images: Tensor) -> int:
    """Bytes that a forward pass keeps for the backward pass, parameters aside."""
    storages = dict[int, int]()
    alive = list[Tensor]()  # no address of a storage comes twice

    def keep(tensor: Tensor) -> Tensor:
        if not isinstance(tensor, Parameter):
            alive.append(tensor)
            storage = tensor.untyped_storage()
            storages[storage._cdata] = storage.nbytes()
        return tensor

    with torch.autograd.graph.saved_tensors_hooks(keep, lambda tensor: tensor):
        model(images)
    return sum(storages.values())


def total_memory(device: torch.device) -> float:
    """Bytes of memory that a device, or the container, has, used or not; infinite if unknown."""
    if device.type == "cuda":
        return torch.cuda.get_device_properties(device).total_memory
    try:
        total = float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError):  # Windows
        return inf
    try:
        return min(total, float(CGROUP_LIMIT.read_text()))
    except (OSError, ValueError):  # none, or "max"
        return total


def _gib(memory: float) -> str:
    return f"{memory / 2**30:,.{0 if memory > 10 * 2**30 else 2}f} GiB"
