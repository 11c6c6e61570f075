"""Networks by name: timm's, and what a network costs."""

import pytest
import torch
from helpers.slow import slow
from learning.patterns import SIZE, trained

from radhar_cli.errors import ModelError
from radhar_cli.learning import run_folder as run
from radhar_cli.learning.models.build import (
    build_model,
    compute_features_and_logits,
    cost,
    parameter_count,
)
from radhar_cli.learning.models.outputs import Outputs

# The paper's rivals (Table III) under their timm names.
RIVALS = ("mobilenetv2_100", "resnet50", "vgg19", "vit_base_patch16_224", "convnext_tiny")
LARGE = ("resnet50", "convnext_tiny")
SMALL = ("smallnet", *(n for n in RIVALS if n not in LARGE))


@pytest.mark.parametrize("name", [*SMALL, *slow(LARGE)])
def test_networks_build_and_take_a_step(zoo, name):
    torch.manual_seed(0)
    size = (64, 64) if name == "convnext_tiny" else (SIZE, SIZE)
    if name in ("vgg19", "vit_base_patch16_224"):  # 139 and 86 M parameters, without memory
        with torch.device("meta"):
            model, x = build_model(name, Outputs(4), size).eval(), torch.zeros(2, 3, *size)
        assert model(x).shape == (2, 4)
        return
    model = build_model(name, Outputs(4), size).train()
    x = torch.randn(2, 3, *size)
    before = [p.detach().clone() for p in model.parameters()]
    optimiser = torch.optim.SGD(model.parameters(), 0.1)
    logits = model(x)
    assert logits.shape == (2, 4)
    torch.nn.functional.cross_entropy(logits, torch.tensor([0, 3])).backward()
    optimiser.step()
    moved = [not torch.equal(p, b) for p, b in zip(model.parameters(), before, strict=True)]
    assert sum(moved) > 0.25 * len(moved), "not all: some residual branches start at zero"
    with torch.no_grad():
        features, again = compute_features_and_logits(model.eval(), x)
        torch.testing.assert_close(again, model(x))
    assert features.ndim == 2
    assert features.shape[0] == 2


def test_a_rival_is_trained_and_loaded(zoo, data, tmp_path):
    done = trained(data, tmp_path / "run", epochs=1, model="mobilenetv2_100")
    metadata, _ = run.load_best(tmp_path / "run")
    assert metadata.model == "mobilenetv2_100"
    assert len(done.history) == 1


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("fftnett", "fftnet"),
        ("smalnet", "smallnet"),
        ("resnet5O", "resnet50"),
        ("convnext_tinny", "convnext_tiny"),
    ],
)
def test_unknown_names_get_a_suggestion(zoo, name, near):
    with pytest.raises(ModelError, match=f"did you mean '{near}") as caught:
        build_model(name, Outputs(4), (32, 32))
    assert caught.value.status == 2


def test_unrecognisable_names_point_to_the_list(zoo):
    with pytest.raises(ModelError, match=r"list_models\(\) has them all"):
        build_model("qqqqqqqqqqqqqqqq", Outputs(4), (32, 32))


def test_smallnet_needs_sixteen_pixels():
    with pytest.raises(ModelError, match="15 x 64 px; both sides should have at least 16"):
        build_model("smallnet", Outputs(4), (15, 64))


def test_smallnet_is_trained_and_loaded(data, tmp_path):
    """The loss of stripes in three directions falls by more than rounding could undo."""
    history = trained(data, tmp_path / "run", epochs=6, model="smallnet").history
    assert history[-1].train_loss < 0.8 * history[0].train_loss
    metadata, model = run.load_best(tmp_path / "run")
    assert metadata.model == "smallnet"
    assert parameter_count(model) == cost("smallnet", Outputs(3), (SIZE, SIZE)).parameters


def test_smallnet_by_hand():
    """9 inputs outputs of each convolution, two numbers a channel of batch norm, the last layer."""
    pairs = ((3, 16), (16, 32), (32, 64), (64, 128))
    convolutions = [9 * inputs * outputs for inputs, outputs in pairs]
    price = cost("smallnet", Outputs(12), (64, 64))
    assert price.parameters == sum(convolutions) + 2 * (16 + 32 + 64 + 128) + 129 * 12
    pixels = (64**2, 32**2, 16**2, 8**2)
    by_hand = sum(n * p for n, p in zip(convolutions, pixels, strict=True)) + 128 * 12
    assert price.multiply_adds == by_hand


def test_cost_of_the_papers_network():
    price = cost("fftnet", Outputs(12), (256, 256))
    assert price.parameters == 6_496_012
    small = cost("fftnet", Outputs(12), (32, 32))
    assert small.parameters == parameter_count(build_model("fftnet", Outputs(12), (32, 32)))
    assert 50 < price.multiply_adds / small.multiply_adds < 70, "pixels, and a little for the FFTs"


def test_multiply_adds_of_the_convolutions_by_hand():
    """All but the FFTs: 9 inputs outputs pixels each, and the last layer."""
    convolutions = 9 * 3 * 64 * 16 * 16
    for width, wider, side in ((64, 128, 8), (128, 256, 4), (256, 512, 2)):
        convolutions += 4 * 9 * width * width * side**2 + 9 * width * wider * (side // 2) ** 2
    ffts = sum(
        2 * 2 * 1.25 * c * s * s * (2 * torch.tensor(s).log2().item())
        for c, s in ((64, 8), (128, 4), (256, 2))
    )
    found = cost("fftnet", Outputs(5), (32, 32)).multiply_adds
    assert found == pytest.approx(convolutions + 512 * 5 + ffts, rel=1e-3)
