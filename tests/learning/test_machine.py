"""What a machine offers."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.errors import MachineError
from radhar_cli.learning.machine import (
    autocast,
    choose_device,
    choose_precision,
    convolutions_channels_last,
    largest_batch,
    memory_bytes,
)
from radhar_cli.learning.processes import Group, joined

CPU = torch.device("cpu")


def test_a_device_that_is_not_there_is_named() -> None:
    if torch.cuda.is_available():
        pytest.skip("it is there")
    with pytest.raises(MachineError, match='device = "cuda": is not on this machine; it has'):
        choose_device("cuda")
    assert choose_device("cpu") == CPU


def test_precision_is_what_was_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    assert choose_precision("bfloat16", CPU) == torch.bfloat16
    assert choose_precision("float32", CPU) == torch.float32
    for able, chosen in (({}, torch.float32), ({"amx_bf16": True}, torch.bfloat16)):
        monkeypatch.setattr(torch.cpu, "get_capabilities", lambda able=able: able)
        assert choose_precision("auto", CPU) == chosen


def test_float32_is_computed_in_float32() -> None:
    for precision in (torch.float32, torch.bfloat16):
        with autocast(CPU, precision):
            assert (torch.ones(2, 2) @ torch.ones(2, 2)).dtype == precision


@given(saved=st.integers(1, 2**36), processes=st.integers(1, 64))
def test_a_batch_fits_in_half_the_memory(saved: int, processes: int) -> None:
    found = largest_batch(saved, CPU, processes)
    assert found >= 1
    if found > 1:
        assert found * saved * processes <= memory_bytes(CPU) / 2


def test_layout_does_not_change_the_answer() -> None:
    layer, x = torch.nn.Conv2d(3, 4, 3), torch.randn(1, 3, 8, 8)
    before = layer(x)
    convolutions_channels_last(layer)
    assert layer.weight.is_contiguous(memory_format=torch.channels_last)
    torch.testing.assert_close(layer(x), before)


def test_alone_without_torchrun(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("WORLD_SIZE", "TORCHELASTIC_RUN_ID"):
        monkeypatch.delenv(name, raising=False)
    with joined(CPU) as group:
        assert group == Group(0, 1, 1)
        assert group.leads
    assert not Group(1, 2).leads
