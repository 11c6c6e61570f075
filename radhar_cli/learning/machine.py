"""How a run is executed on this machine: device, precision, reading processes."""

import os

import torch

from radhar_cli.dataset.workers import cores
from radhar_cli.errors import MachineError, did_you_mean
from radhar_cli.learning.settings import Auto

CUDA_WORKERS = 8


def use_deterministic_algorithms(device: torch.device) -> None:
    """Ask for algorithms that give the same bits each time; elsewhere than on the CPU, if it can.

    cuBLAS needs its workspace fixed before its first use. No layer reads memory that it did not
    write, which is thus not filled first.
    """
    os.environ.setdefault("CUBLAS_WORKSPACE_CONFIG", ":4096:8")
    torch.use_deterministic_algorithms(True, warn_only=device.type != "cpu")
    torch.utils.deterministic.fill_uninitialized_memory = False  # type: ignore[attr-defined]


def choose_device(wanted: str) -> torch.device:
    """The device asked for, or the best there is."""
    there = {
        "cuda": torch.cuda.is_available(),
        "mps": torch.backends.mps.is_available(),
        "cpu": True,
    }
    if wanted == "auto":
        wanted = next(name for name, available in there.items() if available)
    if wanted not in there:
        hint = did_you_mean(wanted, there, f"the devices are auto, {', '.join(there)}")
        raise MachineError(f"--device {wanted}: is not a device; {hint}")
    if not there[wanted]:
        has = ", ".join(name for name, available in there.items() if available)
        raise MachineError(f'device = "{wanted}": is not on this machine; it has {has}')
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


def reading_workers(wanted: Auto, device: torch.device) -> int:
    """Reading processes; none where the CPU is busy with the network."""
    if wanted != "auto":
        return wanted
    return min(CUDA_WORKERS, cores()) if device.type == "cuda" else 0
