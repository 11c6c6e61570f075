"""How a run is executed on this machine: device, precision, micro batch, reading processes."""

import os
from dataclasses import dataclass
from itertools import pairwise

import torch

from radhar_cli.learning.machine import choose_precision
from radhar_cli.learning.settings import TrainConfig

CUDA_WORKERS = 8


@dataclass(frozen=True)
class ExecutionPlan:
    """Device, precision, micro batch and reading processes of a run.

    Attributes:
        device, precision: of the forward and backward passes.
        micro_batch: most images in one pass of one process; gradients are accumulated over passes.
        workers: reading processes.
    """

    device: torch.device
    precision: torch.dtype
    micro_batch: int
    workers: int

    def parts(self, images: int) -> list[slice]:
        """Micro batches of a process's share of a batch: nearly equal, none of a single image."""
        count = max(1, min(-(-images // self.micro_batch), images // 2))
        edges = [number * images // count for number in range(count + 1)]
        return [slice(*pair) for pair in pairwise(edges)]

    @property
    def precision_name(self) -> str:
        """float32 or bfloat16."""
        return str(self.precision).removeprefix("torch.")


def choose_execution_plan(
    config: TrainConfig, device: torch.device, synthesises: bool = False
) -> ExecutionPlan:
    """Fill in what the config leaves to `auto`; `micro_batch: auto` is the whole batch at once.

    Args:
        config: of the run.
        device: that computes.
        synthesises: the images are made while training.
    """
    micro_batch = config.images_a_step if config.micro_batch == "auto" else config.micro_batch
    precision = choose_precision(config.precision, device)
    workers = reading_workers(config, device, synthesises)
    return ExecutionPlan(device, precision, micro_batch, workers)


def reading_workers(config: TrainConfig, device: torch.device, synthesises: bool) -> int:
    """Reading processes: none on the CPU, whose cores the network keeps busy.

    Samples of a stream take longer to synthesise than a step: every core gets a worker.
    """
    if config.workers != "auto":
        return config.workers
    from radhar_cli.dataset.workers import cores

    if synthesises:
        return max(1, cores() // int(os.environ.get("LOCAL_WORLD_SIZE", 1)))
    return min(CUDA_WORKERS, cores()) if device.type == "cuda" else 0
