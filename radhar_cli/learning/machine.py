"""Execution of a run on this machine: device, precision, reading processes."""

import os

import torch

from radhar_cli.dataset.workers import cores
from radhar_cli.errors import MachineError, did_you_mean
from radhar_cli.learning.settings import Auto

CUDA_WORKERS = 8


def use_deterministic_algorithms(device: torch.device) -> None:
    """Have PyTorch use algorithms that give the same bits each time; other devices where they can.

    An operation without such an algorithm is an error on the CPU, a warning elsewhere. cuBLAS needs
    its workspace fixed before its first use. No layer reads memory that it did not write, which is
    thus not filled first.
    """
    os.environ.setdefault("CUBLAS_WORKSPACE_CONFIG", ":4096:8")
    torch.use_deterministic_algorithms(True, warn_only=device.type != "cpu")
    torch.utils.deterministic.fill_uninitialized_memory = False  # type: ignore[attr-defined]


def choose_device(name: str) -> torch.device:
    """Device of a name: auto (the best there is), cuda, mps or cpu.

    Raises:
        MachineError: it is no device, or is not on this machine.
    """
    is_available = {
        "cuda": torch.cuda.is_available(),
        "mps": torch.backends.mps.is_available(),
        "cpu": True,
    }
    if name == "auto":
        name = next(device for device, is_there in is_available.items() if is_there)
    if name not in is_available:
        hint = did_you_mean(name, is_available, f"the devices are auto, {', '.join(is_available)}")
        raise MachineError(f'device = "{name}": is not a device; {hint}')
    if not is_available[name]:
        listed = ", ".join(device for device, is_there in is_available.items() if is_there)
        raise MachineError(f'device = "{name}": is not on this machine; it has {listed}')
    if name == "cuda":
        # Or convolutions of float32 would have TF32's 11 bits.
        torch.backends.cudnn.allow_tf32 = False
    return torch.device(name)


def choose_precision(setting: str, device: torch.device) -> torch.dtype:
    """Precision of a setting: auto, float32 or bfloat16.

    auto is bfloat16 where the device computes in it; elsewhere it is emulated, many times slower.
    """
    if setting != "auto":
        return torch.bfloat16 if setting == "bfloat16" else torch.float32
    if device.type == "cuda":
        computes_in_bfloat16 = torch.cuda.is_bf16_supported(including_emulation=False)
    elif device.type == "cpu":
        capabilities = torch.cpu.get_capabilities()
        computes_in_bfloat16 = bool(capabilities.get("amx_bf16") or capabilities.get("avx512_bf16"))
    else:
        computes_in_bfloat16 = False
    return torch.bfloat16 if computes_in_bfloat16 else torch.float32


def autocast(device: torch.device, precision: torch.dtype) -> torch.autocast:
    """Context of mixed precision for a forward pass; does nothing for float32."""
    lower = precision != torch.float32
    return torch.autocast(device.type, precision if lower else torch.bfloat16, enabled=lower)


def reading_workers(setting: Auto, device: torch.device) -> int:
    """Number of processes that read images: the setting, or for auto some with CUDA, else none."""
    if setting != "auto":
        return setting
    return min(CUDA_WORKERS, cores()) if device.type == "cuda" else 0
