"""A small plain network that learns in seconds on a processor: to compare data sets, not networks.

Four blocks of 3 x 3 convolution, group norm, ReLU and max-pool; global average pool; one layer.
Group norm (Wu and He, ECCV 2018) has each image's own statistics; those of batch norm remember the
images of the simulator, and measured ones are others. With batch norm `radhar adapt` does better.
"""

import torch
from torch import Tensor, nn

from radhar_cli.errors import ModelError
from radhar_cli.learning.models.outputs import Outputs

WIDTHS = (16, 32, 64, 128)
GROUPS = 8
MIN_SIDE = 2 ** len(WIDTHS)


class GroupNorm(nn.GroupNorm):
    """Group norm in float32, as on CUDA: processors are slow in bfloat16 with channels last."""

    def forward(self, x: Tensor) -> Tensor:
        """Normalised values [B, C, H, W], float32."""
        return super().forward(x.float())


def block(inputs: int, outputs: int, batch_norm: bool = False) -> nn.Sequential:
    """Layers of a 3 x 3 convolution, group or batch norm, max-pool of 2 x 2, and ReLU.

    ReLU and max-pool may change places, and after the pool a quarter is left to do. With
    channels last in memory a step takes three quarters of the time.
    """
    layers = nn.Sequential(
        nn.Conv2d(inputs, outputs, 3, padding=1, bias=False),
        nn.BatchNorm2d(outputs) if batch_norm else GroupNorm(GROUPS, outputs),
        nn.MaxPool2d(2),
        nn.ReLU(inplace=True),
    )
    layers.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
    return layers


class Pooled(nn.Module):
    """Network of layers from images to feature maps, of whose means one layer makes logits."""

    layers: nn.Sequential
    head: nn.Linear

    def forward_features(self, x: Tensor) -> Tensor:
        """Last feature maps of normalised images [B, 3, H, W]."""
        features: Tensor = self.layers(x)
        return features

    def forward_head(self, features: Tensor, pre_logits: bool = False) -> Tensor:
        """Logits [B, classes] of feature maps; with `pre_logits` the maps' means [B, F]."""
        pooled = features.mean((2, 3))
        return pooled if pre_logits else self.head(pooled)

    def forward(self, x: Tensor) -> Tensor:
        """Logits [B, classes] of normalised images [B, 3, H, W]."""
        return self.forward_head(self.forward_features(x))


class SmallNet(Pooled):
    """Network of images of any size whose sides have at least 16 px.

    99,228 parameters at 12 classes; the last feature maps are [B, 128, H//16, W//16].
    """

    def __init__(self, classes: int, batch_norm: bool = False) -> None:
        super().__init__()
        pairs = zip((3, *WIDTHS[:-1]), WIDTHS, strict=True)
        self.layers = nn.Sequential(*(block(*pair, batch_norm) for pair in pairs))
        self.head = nn.Linear(WIDTHS[-1], classes)


def build(outputs: Outputs, size: tuple[int, int]) -> nn.Module:
    """Build smallnet for images of (H, W)."""
    _require_size("smallnet", size)
    return SmallNet(outputs.count)


def build_with_batch_norm(outputs: Outputs, size: tuple[int, int]) -> nn.Module:
    """Build smallnet_bn, which has batch norm, for images of (H, W)."""
    _require_size("smallnet_bn", size)
    return SmallNet(outputs.count, batch_norm=True)


def _require_size(name: str, size: tuple[int, int]) -> None:
    """Raise ModelError for images that four max-pools leave nothing of."""
    if min(size) < MIN_SIDE:
        raise ModelError(
            f"model {name}: images are {size[0]} x {size[1]} px; both sides should have at least "
            f"{MIN_SIDE}"
        )
