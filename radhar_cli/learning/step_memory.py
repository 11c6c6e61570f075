"""Memory that a training step needs at least, counted without allocating it, and what would fit."""

import os
from dataclasses import dataclass
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


def step_memory(
    config: TrainConfig, classes: int, size: tuple[int, int], precision: torch.dtype
) -> StepMemory:
    """Least memory of a step: what is alive at once when its forward pass ends.

    Args:
        config: of the run.
        classes: outputs of the network.
        size: (H, W) of the images, px.
        precision: of the forward pass; bfloat16 keeps half the bytes.

    Raises:
        ModelError: no such network, or images that it cannot take.
    """
    with torch.device("meta"):
        model = build_model(config.model, classes, size)

    def kept(images: int) -> int:
        storages = dict[int, int]()
        alive = list[Tensor]()  # no address of a storage comes twice

        def keep(tensor: Tensor) -> Tensor:
            if not isinstance(tensor, Parameter):
                alive.append(tensor)
                storage = tensor.untyped_storage()
                storages[storage._cdata] = storage.nbytes()
            return tensor

        with torch.autograd.graph.saved_tensors_hooks(keep, lambda tensor: tensor):
            model(torch.zeros(images, 3, *size, device="meta"))
        return sum(storages.values())

    two, four = kept(2), kept(4)
    image, shared = (four - two) // 2, 2 * two - four
    if precision != torch.float32:
        image, shared = image // 2, shared // 2
    return StepMemory(COPIES[config.optimiser] * FLOAT * parameter_count(model) + shared, image)


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


def check_memory(
    config: TrainConfig,
    classes: int,
    size: tuple[int, int],
    images: int,
    precision: torch.dtype,
    device: torch.device,
) -> None:
    """Refuse a step that needs more memory than a device has; arguments as of `smaller_step`.

    Raises:
        MachineError: says what it needs, and what would fit.
        ModelError: no such network, or images that it cannot take.
    """
    total = total_memory(device)
    if step_memory(config, classes, size, precision).of(images) > total:
        smaller = smaller_step(config, classes, size, images, precision, total)
        raise MachineError(f"{device.type} has {_gib(total)} of memory; {smaller}")


def smaller_step(
    config: TrainConfig,
    classes: int,
    size: tuple[int, int],
    images: int,
    precision: torch.dtype,
    limit: float | None = None,
) -> str:
    """What a step needs, and which micro batch, or else which image size, needs at most `limit`.

    Args:
        config: of the run.
        classes: outputs of the network.
        size: (H, W) of the images, px.
        images: of one pass.
        precision: of the forward pass.
        limit: bytes; None is what half the images need.
    """
    needs = step_memory(config, classes, size, precision)
    limit = needs.of(images // 2) if limit is None else limit
    fewer = images
    while fewer > 2 and needs.of(fewer) > limit:
        fewer = max(2, fewer // 2)
    if needs.of(fewer) <= limit:
        advice = f"--set micro_batch={fewer} needs {_gib(needs.of(fewer))}"
    else:
        advice = _smaller_images(config, classes, size, fewer, precision, limit)
    return f"a step of {_images(images, size)} needs at least {_gib(needs.of(images))}; {advice}"


def _smaller_images(
    config: TrainConfig,
    classes: int,
    size: tuple[int, int],
    images: int,
    precision: torch.dtype,
    limit: float,
) -> str:
    while min(size) > MIN_SIDE:
        size = _halved(size[0]), _halved(size[1])
        try:
            needed = step_memory(config, classes, size, precision).of(images)
        except ModelError:  # a network that takes images of one size alone
            break
        if needed <= limit:
            return f"{_images(images, size)} (image.size_px of the data) need {_gib(needed)}"
    return "a smaller model may fit"


def _halved(side: int) -> int:
    """Half a side, on the grid of the strides of networks."""
    return max(MIN_SIDE, side // 2 // MIN_SIDE * MIN_SIDE)


def _images(count: int, size: tuple[int, int]) -> str:
    return f"{count} images of {size[0]} x {size[1]} px"


def _gib(memory: float) -> str:
    return f"{memory / 2**30:,.{0 if memory > 10 * 2**30 else 2}f} GiB"
