"""What a machine offers: device, precision, memory."""

import os

import torch
from torch import nn

from radhar_cli import process
from radhar_cli.errors import MachineError

_MEMORY_SHARE = 0.5
_STEP_OVER_SAVED = 1.6


def keep_memory() -> None:
    """Keep the memory of large tensors from step to step."""
    process.keep_memory(2**30, 2**31 - 1)


def repeatable(device: torch.device) -> None:
    """Ask for algorithms that give the same bits each time; elsewhere than on the CPU, if it can.

    cuBLAS needs its workspace fixed before its first use.
    """
    os.environ.setdefault("CUBLAS_WORKSPACE_CONFIG", ":4096:8")
    torch.use_deterministic_algorithms(True, warn_only=device.type != "cpu")


def choose_device(wanted: str) -> torch.device:
    """The device asked for, or the best there is.

    Raises:
        MachineError: it is not there.
    """
    there = {
        "cuda": torch.cuda.is_available(),
        "mps": torch.backends.mps.is_available(),
        "cpu": True,
    }
    if wanted == "auto":
        wanted = next(name for name, found in there.items() if found)
    if not there[wanted]:
        has = ", ".join(name for name, found in there.items() if found)
        raise MachineError(f'device = "{wanted}": is not on this machine; it has {has}')
    if wanted == "cuda":
        return torch.device("cuda", int(os.environ.get("LOCAL_RANK", 0)))
    return torch.device(wanted)


def choose_precision(wanted: str, device: torch.device) -> torch.dtype:
    """bfloat16 where the device computes in it; elsewhere it is emulated, many times slower."""
    if wanted != "auto":
        return torch.bfloat16 if wanted == "bfloat16" else torch.float32
    if device.type == "cuda":
        pays = torch.cuda.is_bf16_supported(including_emulation=False)
    elif device.type == "cpu":
        able = torch.cpu.get_capabilities()
        pays = bool(able.get("amx_bf16") or able.get("avx512_bf16"))
    else:
        pays = False
    return torch.bfloat16 if pays else torch.float32


def autocast(device: torch.device, precision: torch.dtype) -> torch.autocast:
    """Mixed precision around a forward pass; does nothing for float32."""
    lower = precision != torch.float32
    return torch.autocast(device.type, precision if lower else torch.bfloat16, enabled=lower)


def convolutions_channels_last(model: nn.Module) -> None:
    """Lay out the convolutions' weights channels last, which they are fastest with.

    Theirs alone: four-dimensional weights of other layers mean something else.
    """
    for layer in model.modules():
        if isinstance(layer, nn.Conv2d):
            layer.weight.data = layer.weight.data.contiguous(memory_format=torch.channels_last)


def memory_bytes(device: torch.device) -> int:
    """The whole memory of a device: a choice made from it does not change from day to day."""
    if device.type == "cuda":
        return int(torch.cuda.get_device_properties(device).total_memory)
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")


def largest_batch(saved_per_image: int, device: torch.device, processes: int) -> int:
    """Images that fit in half the memory, shared by the processes on this machine."""
    shares = processes if device.type != "cuda" else 1
    return max(
        1, int(_MEMORY_SHARE * memory_bytes(device) / shares / (_STEP_OVER_SAVED * saved_per_image))
    )
