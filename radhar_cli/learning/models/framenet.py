"""A small network of sequences of frames: convolutions in each frame, then over time."""

from torch import Tensor, nn

from radhar_cli.errors import ModelError
from radhar_cli.learning.models.cloudnet import OverTime, temporal_convolutions
from radhar_cli.learning.models.outputs import Outputs, OutputShape
from radhar_cli.learning.models.smallnet import block

WIDTHS = (8, 16, 32)
FEATURES, GRID = 128, 4
MIN_SIDE = 2 ** len(WIDTHS)


class FrameNet(OverTime):
    """Network of frames [B, T, H, W] whose sides have at least 8 cells.

    The place of an echo in its frame is kept, on a grid of 4 x 4.

    Args:
        outputs: number and shape of its outputs.
    """

    def __init__(self, outputs: Outputs) -> None:
        super().__init__(outputs)
        pairs = zip((1, *WIDTHS[:-1]), WIDTHS, strict=True)
        self.frame = nn.Sequential(
            *(block(*pair) for pair in pairs),
            nn.AdaptiveAvgPool2d(GRID),
            nn.Flatten(),
            nn.Linear(WIDTHS[-1] * GRID**2, FEATURES),
        )
        self.time = temporal_convolutions(FEATURES)
        self.head = nn.Linear(FEATURES, outputs.count)

    def forward_features(self, x: Tensor) -> Tensor:
        """Features [B, 128, T] of frames [B, T, H, W]."""
        frames: Tensor = self.frame(x.flatten(0, 1)[:, None]).view(*x.shape[:2], -1)
        features: Tensor = self.time(frames.transpose(1, 2))
        return features

    def forward(self, x: Tensor) -> Tensor:
        """Outputs of frames [B, T, H, W]."""
        outputs = self.forward_head(self.forward_features(x))
        if self.outputs.shape is OutputShape.PLACES:
            return outputs.view(*outputs.shape[:2], -1, 3)  # [B, T, count] -> [B, T, place, 3]
        return outputs


def build(outputs: Outputs, size: tuple[int, int]) -> nn.Module:
    """Build framenet for frames of (H, W) cells.

    Raises:
        ModelError: a side is too short.
    """
    if min(size) < MIN_SIDE:
        raise ModelError(
            f"model framenet: frames are {size[0]} x {size[1]} cells; both sides should have at "
            f"least {MIN_SIDE}"
        )
    return FrameNet(outputs)
