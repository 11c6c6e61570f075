"""Device, precision and threads of the machine."""

import pytest
import torch

from radhar_cli.errors import MachineError
from radhar_cli.learning.machine import autocast, choose_device, choose_precision

CPU = torch.device("cpu")


def test_a_device_that_is_not_there_is_named():
    if torch.cuda.is_available():
        pytest.skip("it is there")
    with pytest.raises(MachineError, match='device = "cuda": is not on this machine; it has'):
        choose_device("cuda")
    assert choose_device("cpu") == CPU


def test_precision_is_as_requested(monkeypatch):
    assert choose_precision("bfloat16", CPU) == torch.bfloat16
    assert choose_precision("float32", CPU) == torch.float32
    for able, chosen in (({}, torch.float32), ({"amx_bf16": True}, torch.bfloat16)):
        monkeypatch.setattr(torch.cpu, "get_capabilities", lambda able=able: able)
        assert choose_precision("auto", CPU) == chosen


def test_float32_is_computed_in_float32():
    for precision in (torch.float32, torch.bfloat16):
        with autocast(CPU, precision):
            assert (torch.ones(2, 2) @ torch.ones(2, 2)).dtype == precision


@pytest.mark.skipif(not torch.cuda.is_available(), reason="needs a GPU")
def test_convolutions_of_float32_have_its_bits_on_a_gpu():
    """TF32, which PyTorch would take, is off by some 3e-4."""
    device = choose_device("cuda")
    torch.manual_seed(1)
    x, kernel = torch.randn(4, 64, 32, 32), torch.randn(64, 64, 3, 3)
    exact = torch.nn.functional.conv2d(x.double(), kernel.double())
    found = torch.nn.functional.conv2d(x.to(device), kernel.to(device)).cpu()
    assert float((found - exact).norm() / exact.norm()) < 1e-5
