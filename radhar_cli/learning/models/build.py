"""A network by its name."""

from dataclasses import dataclass
from typing import Any, Protocol

import torch
from torch import Tensor, nn

from radhar_cli.learning.models.outputs import Outputs
from radhar_cli.learning.models.timm_networks import build_zoo_model
from radhar_cli.learning.registry import NETWORKS, image_channels_of, load_place, sequences_of


class Builder(Protocol):
    """Builds a network with fresh weights; `choices.NETWORKS` names builders."""

    def __call__(self, outputs: Outputs, size: tuple[int, int]) -> nn.Module:
        """Build a network.

        Args:
            outputs: number and shape of its outputs.
            size: (H, W) of an image or a frame, (frames, points) of clouds.

        Raises:
            ModelError: it cannot take inputs of that size.
        """


@dataclass(frozen=True)
class Cost:
    """Parameters and multiply-adds of a network."""

    parameters: int  # trainable ones
    # of one image: convolutions, matrix products, and FFTs at 5/4 N log2 N a real transform of N
    # numbers (half of a complex one's 5 N log2 N operations, two a multiply-add)
    multiply_adds: int


def build_model(name: str, outputs: Outputs, size: tuple[int, int]) -> nn.Module:
    """Build a network with fresh weights.

    Args:
        name: one of `choices.NETWORKS`, or any name that timm knows (needs the extra `zoo`).
        outputs: number and shape of its outputs.
        size: (H, W) of an image or a frame, (frames, points) of clouds.

    Raises:
        ModelError: no such network, or it cannot take inputs of that size.
    """
    if name not in NETWORKS:
        return build_zoo_model(name, outputs.count, size)
    build: Builder = load_place(NETWORKS[name].place)
    return build(outputs, size)


def compute_features_and_logits(model: nn.Module, x: Tensor) -> tuple[Tensor, Tensor]:
    """Input [B, F] of a network's last layer, and its logits [B, classes].

    Args:
        model: network with `forward_features` and `forward_head`, as timm has them.
        x: normalised inputs.
    """
    network: Any = model
    maps = network.forward_features(x)
    features: Tensor = network.forward_head(maps, pre_logits=True)
    logits: Tensor = network.forward_head(maps)
    return features.flatten(1), logits


def cost(name: str, outputs: Outputs, size: tuple[int, int], channels: int = 3) -> Cost:
    """Parameters and multiply-adds of a network, without computing or allocating anything.

    Args:
        name: name of the network, as for `build_model`.
        outputs: number and shape of its outputs.
        size: (H, W) of an image or a frame, (frames, points) of clouds.
        channels: channels of an input of sequences: frames, or columns of a cloud.
    """
    from torch.utils.flop_counter import FlopCounterMode

    def fft_operations(shape: Any, *_: Any, out_shape: Any = None, **__: Any) -> int:
        rows, columns = max(shape[-2], out_shape[-2]), max(shape[-1], out_shape[-1])
        transforms = torch.Size(shape[:-2]).numel()
        return int(2.5 * transforms * rows * columns * torch.tensor(rows * columns).log2().item())

    aten = torch.ops.aten
    real_ffts: dict[Any, Any] = {aten._fft_r2c: fft_operations, aten._fft_c2r: fft_operations}
    with torch.device("meta"):
        model = build_model(name, outputs, size).eval()
        depth = channels if sequences_of(name) else image_channels_of(name)
        inputs = torch.zeros(1, depth, *size)
    counter = FlopCounterMode(display=False, custom_mapping=real_ffts)
    with counter, torch.no_grad():
        model(inputs)
    return Cost(parameter_count(model), counter.get_total_flops() // 2)


def parameter_count(model: nn.Module) -> int:
    """Number of trainable parameters."""
    return sum(p.numel() for p in model.parameters() if p.requires_grad)
