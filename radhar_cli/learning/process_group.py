"""The processes that train one network, and their collective operations."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import torch
from torch import nn

from radhar_cli.arrays import Float
from radhar_cli.errors import RadharError


@dataclass(frozen=True)
class Group:
    """The processes of one run: number of this one, and how many."""

    rank: int = 0
    size: int = 1

    @property
    def is_main(self) -> bool:
        """Whether this process writes the files and talks to the user."""
        return self.rank == 0


@contextmanager
def process_group(device: torch.device) -> Iterator[Group]:
    """Join the processes that torchrun started; alone without it."""
    if "TORCHELASTIC_RUN_ID" not in os.environ and "WORLD_SIZE" not in os.environ:
        yield Group()
        return
    import torch.distributed as dist

    if device.type == "cuda":
        torch.cuda.set_device(device)
    dist.init_process_group("nccl" if device.type == "cuda" else "gloo")
    try:
        yield Group(dist.get_rank(), dist.get_world_size())
    finally:
        dist.destroy_process_group()


def distributed(model: nn.Module, device: torch.device, group: Group) -> nn.Module:
    """The network with gradients averaged over the processes; itself where there is one process."""
    if group.size == 1:
        return model
    from torch.nn.parallel import DistributedDataParallel

    ids = [device.index] if device.type == "cuda" else None
    return DistributedDataParallel(model, device_ids=ids)


def broadcast_buffers(model: nn.Module, group: Group) -> None:
    """Copy rank 0's buffers, the running averages of batch norm, to every process."""
    if group.size > 1:
        import torch.distributed as dist

        for buffer in model.buffers():
            dist.broadcast(buffer, 0)


def all_reduce_sum(totals: Float, group: Group) -> Float:
    """Sum an array over the processes."""
    if group.size == 1:
        return totals
    import torch.distributed as dist

    device = "cuda" if dist.get_backend() == "nccl" else "cpu"
    tensor = torch.tensor(totals, dtype=torch.float64, device=device)
    dist.all_reduce(tensor)
    added: Float = tensor.cpu().numpy()
    return added


def barrier(group: Group) -> None:
    """Wait until all processes are here."""
    if group.size > 1:
        import torch.distributed as dist

        dist.barrier()


def on_rank_zero(group: Group, work: Callable[[], None]) -> None:
    """Run `work` on rank 0 while the others wait; what it raises is raised on every rank.

    Raises:
        RadharError: what `work` raised.
    """
    failed: list[RadharError | None] = [None]
    if group.is_main:
        try:
            work()
        except RadharError as error:
            failed = [error]
    if group.size > 1:
        import torch.distributed as dist

        dist.broadcast_object_list(failed, 0)
    if failed[0] is not None:
        raise failed[0]
