"""A small network of sequences of frames: convolutions in each frame, then over time."""

from torch import Tensor, nn

from radhar_cli.learning.models.cloudnet import OverTime, temporal_convolutions
from radhar_cli.learning.models.smallnet import block

NAME = "framenet"
WIDTHS = (8, 16, 32)
FEATURES, GRID = 128, 4
MIN_SIDE = 2 ** len(WIDTHS)


class FrameNet(OverTime):
    """Network of frames [B, T, H, W] whose sides have at least 8 cells.

    The place of an echo in its frame is kept, on a grid of 4 x 4.

    Args:
        outputs: number of outputs of a sequence; with `per_frame`, of a frame.
        per_frame: every frame has outputs, which are places.
    """

    def __init__(self, outputs: int, per_frame: bool = False) -> None:
        super().__init__(per_frame)
        pairs = zip((1, *WIDTHS[:-1]), WIDTHS, strict=True)
        self.frame = nn.Sequential(
            *(block(*pair) for pair in pairs),
            nn.AdaptiveAvgPool2d(GRID),
            nn.Flatten(),
            nn.Linear(WIDTHS[-1] * GRID**2, FEATURES),
        )
        self.time = temporal_convolutions(FEATURES)
        self.head = nn.Linear(FEATURES, outputs)

    def forward_features(self, x: Tensor) -> Tensor:
        """Features [B, 128, T] of frames [B, T, H, W]."""
        frames: Tensor = self.frame(x.flatten(0, 1)[:, None]).view(*x.shape[:2], -1)
        features: Tensor = self.time(frames.transpose(1, 2))
        return features

    def forward(self, x: Tensor) -> Tensor:
        """Outputs [B, outputs] of frames [B, T, H, W], or places [B, T, outputs/3, 3] in m."""
        outputs = self.forward_head(self.forward_features(x))
        return outputs.view(*outputs.shape[:2], -1, 3) if self.per_frame else outputs
