"""The paper's network: parameters, and the filter by half a spectrum."""

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from learning.patterns import split_tree, trained

from radhar_cli.errors import ModelError
from radhar_cli.learning.models.build import build_model, compute_features_and_logits
from radhar_cli.learning.models.fftnet import Block, FFTNet, GlobalFilter
from radhar_cli.learning.models.outputs import Outputs


def full_form(weight, x):
    """Re IFFT2(K FFT2(x)), without any symmetry."""
    return torch.fft.ifft2(torch.view_as_complex(weight) * torch.fft.fft2(x)).real


def test_parameters_and_filters_are_the_papers():
    with torch.device("meta"):
        model = FFTNet(12, 256, 256)
    assert sum(p.numel() for p in model.parameters()) == 6_496_012
    filters = [m.weight.shape for m in model.modules() if isinstance(m, GlobalFilter)]
    assert filters == [(c, s, s, 2) for c, s in ((64, 64), (128, 32), (256, 16)) for _ in range(2)]
    convolutions = [m for m in model.modules() if isinstance(m, torch.nn.Conv2d)]
    assert all(m.bias is not None and m.kernel_size == (3, 3) for m in convolutions)
    assert len(convolutions) == 1 + 6 * 2 + 3


@settings(max_examples=40, deadline=None)
@given(
    height=st.integers(1, 9),
    width=st.integers(1, 9),
    channels=st.integers(1, 3),
    seed=st.integers(0, 2**31),
)
def test_half_a_spectrum_is_the_whole_one(height, width, channels, seed):
    torch.manual_seed(seed)
    layer = GlobalFilter(channels, height, width).double()
    x = torch.randn(2, channels, height, width, dtype=torch.float64, requires_grad=True)
    probe = torch.randn_like(x)
    half = layer(x)
    half_gradients = torch.autograd.grad((half * probe).sum(), (x, layer.weight))
    full = full_form(layer.weight, x)
    full_gradients = torch.autograd.grad((full * probe).sum(), (x, layer.weight))
    torch.testing.assert_close(half, full, rtol=1e-12, atol=1e-12)
    for ours, theirs in zip(half_gradients, full_gradients, strict=True):
        torch.testing.assert_close(ours, theirs, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("size", [(8, 8), (5, 7), (6, 9), (7, 4), (2, 1)])
def test_filter_passes_gradcheck(size):
    layer = GlobalFilter(2, *size).double()
    x = torch.randn(1, 2, *size, dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(
        lambda x, k: torch.func.functional_call(layer, {"weight": k}, (x,)), (x, layer.weight)
    )


def test_filter_weights_start_normal_with_sd_of_a_fiftieth():
    torch.manual_seed(0)
    values = GlobalFilter(64, 32, 32).weight.detach().numpy().ravel()
    assert abs(values.std() / 0.02 - 1) < 0.01
    assert abs(values.mean()) < 3e-4
    assert abs((values**4).mean() / values.var() ** 2 - 3) < 0.1, "normal, not uniform"


def test_block_is_branches_times_each_other_plus_filter_plus_input():
    torch.manual_seed(1)
    block = Block(3, 4, 6).eval()
    x = torch.randn(2, 3, 4, 6)
    with torch.no_grad():
        for branch in (block.a, block.b):
            assert isinstance(branch[1], torch.nn.BatchNorm2d)
            branch[1].running_mean.uniform_(-1, 1)
            assert (branch(x) >= 0).all()
            assert (branch(x) == 0).any()
        expected = torch.relu(block.a(x) * block.b(x) + full_form(block.g.weight, x) + x)
        torch.testing.assert_close(block(x), expected)
        assert (block(x) == 0).any()


@pytest.mark.parametrize("size", [(32, 32), (64, 32), (32, 96)])
def test_shapes_from_images_to_logits(size):
    model = build_model("fftnet", Outputs(5), size).eval()
    x = torch.randn(2, 3, *size)
    with torch.no_grad():
        maps = model.forward_features(x)
        assert maps.shape == (2, 512, size[0] // 32, size[1] // 32)
        features, logits = compute_features_and_logits(model, x)
        assert torch.equal(logits, model(x))
        torch.testing.assert_close(features, maps.mean((2, 3)))
    assert logits.shape == (2, 5)


@pytest.mark.parametrize("size", [(48, 32), (32, 33), (16, 16)])
def test_sides_that_are_no_multiples_of_32_are_refused(size):
    with pytest.raises(ModelError, match=f"{size[0]} x {size[1]} px; both sides should be multi"):
        build_model("fftnet", Outputs(3), size)


def test_filter_computes_in_float32_under_autocast():
    layer, x = GlobalFilter(2, 8, 8), torch.randn(1, 2, 8, 8)
    with torch.autocast("cpu", torch.bfloat16):
        assert layer(x.bfloat16()).dtype == torch.float32


def test_training_lowers_the_loss(tmp_path):
    """The loss of stripes in three directions falls by more than rounding could undo."""
    root = split_tree(tmp_path / "tree")
    history = trained(root, tmp_path / "run", epochs=4, model="fftnet").history
    assert min(row.train_loss for row in history) < 0.8 * history[0].train_loss
