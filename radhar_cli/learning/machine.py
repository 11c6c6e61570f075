"""What a machine offers: device and precision."""

import os

import torch

from radhar_cli.errors import MachineError


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
        wanted = next(name for name, available in there.items() if available)
    if not there[wanted]:
        has = ", ".join(name for name, available in there.items() if available)
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


def out_of_memory(error: RuntimeError) -> bool:
    """Whether PyTorch could not allocate a tensor; on the CPU only the message says so."""
    return isinstance(error, torch.OutOfMemoryError) or "DefaultCPUAllocator" in str(error)
