"""A small network of streams: convolutions over Doppler in each column, then over time.

The temporal part is a stack of dilated residual convolutions (Abu Farha and Gall, MS-TCN, CVPR
2019), which sees 63 columns to both sides.
"""

from torch import Tensor, nn

from radhar_cli.errors import ModelError
from radhar_cli.learning.models.outputs import Outputs
from radhar_cli.learning.models.smallnet import GroupNorm

WIDTHS = (16, 24, 32, 48)
FEATURES, GROUPS = 96, 8
DILATIONS = (1, 2, 4, 8, 16, 32)
DROPOUT = 0.2
MIN_HEIGHT = 2 ** len(WIDTHS)


class DilatedBlock(nn.Module):
    """Residual block of a dilated convolution over time."""

    def __init__(self, dilation: int) -> None:
        super().__init__()
        self.layers = nn.Sequential(
            nn.Conv1d(FEATURES, FEATURES, 3, padding=dilation, dilation=dilation),
            nn.ReLU(inplace=True),
            nn.Conv1d(FEATURES, FEATURES, 1),
            nn.Dropout(DROPOUT),
        )

    def forward(self, x: Tensor) -> Tensor:
        """Features [B, F, W] of features."""
        features: Tensor = x + self.layers(x)
        return features


class TemporalNet(nn.Module):
    """Network of images over time [B, 3, H, W], whose columns have outputs of their own.

    Args:
        outputs: number and shape of its outputs.
        height: H, of which four strides of 2 leave a row or more.
    """

    def __init__(self, outputs: Outputs, height: int) -> None:
        super().__init__()
        self.outputs = outputs
        layers, rows = list[nn.Module](), height
        for inputs, width in zip((3, *WIDTHS[:-1]), WIDTHS, strict=True):
            layers += [
                nn.Conv2d(inputs, width, (5, 3), stride=(2, 1), padding=(2, 1), bias=False),
                GroupNorm(GROUPS, width),
                nn.ReLU(inplace=True),
            ]
            rows = (rows + 1) // 2
        self.columns = nn.Sequential(*layers)
        self.squeeze = nn.Conv1d(WIDTHS[-1] * rows, FEATURES, 1)
        self.time = nn.Sequential(*(DilatedBlock(dilation) for dilation in DILATIONS))
        self.head = nn.Linear(FEATURES, outputs.count)

    def forward_features(self, x: Tensor) -> Tensor:
        """Features [B, F, W] of normalised images [B, 3, H, W]."""
        maps: Tensor = self.columns(x)  # [B, C, H / 16, W]
        features: Tensor = self.time(self.squeeze(maps.flatten(1, 2)))
        return features

    def forward_head(self, features: Tensor, pre_logits: bool = False) -> Tensor:
        """Logits [B, W, count] of features, or [B, count] of an image; or their features."""
        by_column = features.transpose(1, 2)
        pooled = by_column if self.outputs.per_frame else by_column.mean(1)
        return pooled if pre_logits else self.head(pooled)

    def forward(self, x: Tensor) -> Tensor:
        """Logits of normalised images [B, 3, H, W]."""
        return self.forward_head(self.forward_features(x))


def build(outputs: Outputs, size: tuple[int, int]) -> nn.Module:
    """Build tcn for images of (H, W).

    Raises:
        ModelError: they are too low.
    """
    if size[0] < MIN_HEIGHT:
        raise ModelError(
            f"model tcn: images are {size[0]} px high; should be at least {MIN_HEIGHT} px"
        )
    return TemporalNet(outputs, size[0])
