"""A network by its name."""

from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor, nn

from radhar_cli.errors import ModelError
from radhar_cli.learning.models import cloudnet, framenet, smallnet
from radhar_cli.learning.models.fftnet import NAME, STRIDE, FFTNet
from radhar_cli.learning.models.zoo import zoo_model


@dataclass(frozen=True)
class Cost:
    """Parameters and multiply-adds of a network."""

    parameters: int  # trainable ones
    # of one image: convolutions, matrix products, and FFTs at 5/4 N log2 N a real transform of N
    # numbers (half of a complex one's 5 N log2 N operations, two a multiply-add)
    multiply_adds: int


def build_model(
    name: str, outputs: int, size: tuple[int, int], per_frame: bool = False
) -> nn.Module:
    """Build a network with fresh weights.

    Args:
        name: fftnet, smallnet, smallnet_bn, or any name that timm knows (needs the extra `zoo`); of
            sequences cloudnet, framenet.
        outputs: number of classes, or of coordinates of all joints.
        size: (H, W) of an image or a frame, (frames, points) of clouds.
        per_frame: every frame of a sequence has outputs.

    Raises:
        ModelError: no such network, or it cannot take inputs of that size.
    """
    height, width = size
    if name == cloudnet.NAME:
        return cloudnet.CloudNet(outputs, per_frame)
    if name == framenet.NAME:
        if min(size) < framenet.MIN_SIDE:
            raise ModelError(
                f"model framenet: frames are {height} x {width} cells; both sides should have at "
                f"least {framenet.MIN_SIDE}"
            )
        return framenet.FrameNet(outputs, per_frame)
    if name == NAME:
        if height % STRIDE or width % STRIDE:
            raise ModelError(
                f"model fftnet: images are {height} x {width} px; both sides should be multiples "
                f"of {STRIDE}"
            )
        return FFTNet(outputs, height, width)
    if name in (smallnet.NAME, smallnet.WITH_BATCH_NORM):
        if min(size) < smallnet.MIN_SIDE:
            raise ModelError(
                f"model {name}: images are {height} x {width} px; both sides should have at "
                f"least {smallnet.MIN_SIDE}"
            )
        return smallnet.SmallNet(outputs, name == smallnet.WITH_BATCH_NORM)
    return zoo_model(name, outputs, size)


def features_and_logits(model: nn.Module, x: Tensor) -> tuple[Tensor, Tensor]:
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


def cost(
    name: str, outputs: int, size: tuple[int, int], per_frame: bool = False, channels: int = 3
) -> Cost:
    """Parameters and multiply-adds of a network, without computing or allocating anything.

    Args:
        name: name of the network, as for `build_model`.
        outputs: number of outputs.
        size: (H, W) of an image or a frame, (frames, points) of clouds.
        per_frame: every frame of a sequence has outputs.
        channels: channels of the input: colours, frames, or columns of a cloud.
    """
    from torch.utils.flop_counter import FlopCounterMode

    def fft_operations(shape: Any, *_: Any, out_shape: Any = None, **__: Any) -> int:
        rows, columns = max(shape[-2], out_shape[-2]), max(shape[-1], out_shape[-1])
        transforms = torch.Size(shape[:-2]).numel()
        return int(2.5 * transforms * rows * columns * torch.tensor(rows * columns).log2().item())

    aten = torch.ops.aten
    real_ffts: dict[Any, Any] = {aten._fft_r2c: fft_operations, aten._fft_c2r: fft_operations}
    with torch.device("meta"):
        model = build_model(name, outputs, size, per_frame).eval()
        image = torch.zeros(1, channels, *size)
    counter = FlopCounterMode(display=False, custom_mapping=real_ffts)
    with counter, torch.no_grad():
        model(image)
    return Cost(parameter_count(model), counter.get_total_flops() // 2)


def parameter_count(model: nn.Module) -> int:
    """Number of trainable parameters."""
    return sum(p.numel() for p in model.parameters() if p.requires_grad)
