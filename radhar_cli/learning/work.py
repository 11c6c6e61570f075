"""How a machine does the work of a run: where, in what precision, in what portions."""

import copy
from dataclasses import dataclass
from itertools import pairwise

import torch
from torch import Tensor, nn

from radhar_cli.learning.machine import autocast, choose_precision, largest_batch
from radhar_cli.learning.processes import Group
from radhar_cli.learning.settings import TrainConfig

CUDA_WORKERS = 8


@dataclass(frozen=True)
class Work:
    """How this machine does the work.

    Attributes:
        device, precision: where and in what.
        micro_batch: images at once in one process; gradients are summed over as many as needed.
        workers: reading processes.
    """

    device: torch.device
    precision: torch.dtype
    micro_batch: int
    workers: int

    def parts(self, images: int) -> list[slice]:
        """Nearly equal parts in which a process does its share of a batch, none of one image."""
        count = max(1, min(-(-images // self.micro_batch), images // 2))
        edges = [number * images // count for number in range(count + 1)]
        return [slice(*pair) for pair in pairwise(edges)]

    @property
    def described(self) -> str:
        """Name of the precision."""
        return str(self.precision).removeprefix("torch.")


def choose_work(
    config: TrainConfig,
    model: nn.Module,
    size: tuple[int, int],
    device: torch.device,
    group: Group,
) -> Work:
    """Decide how this machine trains a network, still on the CPU, on images of a size (H, W)."""
    precision = choose_precision(config.precision, device)
    micro_batch = _micro_batch(config, model, size, device, precision, group)
    return Work(device, precision, micro_batch, _workers(config, device))


def _micro_batch(
    config: TrainConfig,
    model: nn.Module,
    size: tuple[int, int],
    device: torch.device,
    precision: torch.dtype,
    group: Group,
) -> int:
    if config.micro_batch != "auto":
        return config.micro_batch
    saved = _saved_bytes(model, size, precision)
    return min(config.batch_size, largest_batch(saved, device, group.local_size))


def _saved_bytes(model: nn.Module, size: tuple[int, int], precision: torch.dtype) -> int:
    """Bytes of one image that a forward pass keeps for the backward pass."""
    kept: dict[int, int] = {}

    def pack(tensor: Tensor) -> Tensor:
        kept[tensor.untyped_storage().data_ptr()] = tensor.untyped_storage().nbytes()
        return tensor

    trial, images = copy.deepcopy(model).train(), torch.zeros(2, 3, *size)
    own = {p.untyped_storage().data_ptr() for p in trial.parameters()}
    with (
        torch.random.fork_rng(devices=[]),
        torch.autograd.graph.saved_tensors_hooks(pack, lambda tensor: tensor),
        autocast(torch.device("cpu"), precision),
    ):
        trial(images)
    return sum(n for pointer, n in kept.items() if pointer not in own) // 2 + 1


def _workers(config: TrainConfig, device: torch.device) -> int:
    """On the CPU the cores are busy with the network, and reading is a few per cent of a step."""
    if config.workers != "auto":
        return config.workers
    from radhar_cli.dataset.workers import cores

    return min(CUDA_WORKERS, cores()) if device.type == "cuda" else 0
