"""A small network of sequences of point clouds: PointNet in each frame, convolutions over time.

Every point goes through the same layers, the largest answer of each feature stands for the frame
(Qi et al., PointNet, 2017), and two convolutions look at five frames each.
"""

import torch
from torch import Tensor, nn
from torch.nn.functional import avg_pool1d

from radhar_cli.learning.images.sequences import COLUMNS
from radhar_cli.learning.models.outputs import Outputs, OutputShape
from radhar_cli.learning.models.smallnet import GROUPS

WIDTHS = (64, 128)
NEAR = 5  # frames whose points make the centre of one


def temporal_convolutions(channels: int) -> nn.Sequential:
    """Two convolutions over five frames each, from [B, C, T] to the same shape."""
    layers: list[nn.Module] = []
    for _ in range(2):
        layers += [nn.Conv1d(channels, channels, NEAR, padding=NEAR // 2)]
        layers += [nn.GroupNorm(GROUPS, channels), nn.ReLU(inplace=True)]
    return nn.Sequential(*layers)


def moving_centroid(clouds: Tensor) -> Tensor:
    """Mean place of the points of five frames, or of all frames where those are empty.

    Args:
        clouds: [B, 6, T, K].

    Returns:
        [B, 3, T] centre for each frame, m.
    """
    present = clouds[:, -1:]
    sums, counts = (clouds[:, :3] * present).sum(3), present.sum(3)
    overall_sum, overall_count = sums.mean(2, keepdim=True), counts.mean(2, keepdim=True)

    def mean_of_five_frames(values: Tensor) -> Tensor:
        return avg_pool1d(values, NEAR, 1, NEAR // 2)

    return (mean_of_five_frames(sums) + 1e-3 * overall_sum) / (
        mean_of_five_frames(counts) + 1e-3 * overall_count
    ).clamp_min(1e-6)


class OverTime(nn.Module):
    """Network whose features [B, 128, T] become outputs of a sequence, or of its frames."""

    head: nn.Linear

    def __init__(self, outputs: Outputs) -> None:
        super().__init__()
        self.outputs = outputs

    def forward_head(self, features: Tensor, pre_logits: bool = False) -> Tensor:
        """Outputs [B, count] of features [B, 128, T], or [B, T, count] for each frame.

        With `pre_logits` the features before the last layer: their mean over time, or all frames'.
        """
        pooled = features.transpose(1, 2) if self.outputs.per_frame else features.mean(2)
        return pooled if pre_logits else self.head(pooled)


class CloudNet(OverTime):
    """Network of clouds [B, 6, T, K]: COLUMNS of K points in T frames.

    Args:
        outputs: number and shape of its outputs; places are relative to the centre of the points
            of their frame.
    """

    def __init__(self, outputs: Outputs) -> None:
        super().__init__(outputs)
        first, second = WIDTHS
        self.points = nn.Sequential(
            nn.Conv2d(3 + len(COLUMNS) - 1, first, 1),
            nn.ReLU(inplace=True),
            nn.Conv2d(first, second, 1),
            nn.ReLU(inplace=True),
        )
        self.time = temporal_convolutions(second)
        self.head = nn.Linear(second, outputs.count)

    def forward_features(self, x: Tensor) -> Tensor:
        """Features [B, 128, T] of clouds [B, 6, T, K]."""
        present = x[:, -1:]  # [B, 1, T, K]
        from_centre = x[:, :3] - moving_centroid(x)[..., None]  # [B, 3, T, K]
        point_features = torch.cat([from_centre, x[:, :-1]], 1)  # [B, 8, T, K]
        features: Tensor = self.time((self.points(point_features * present) * present).amax(3))
        return features

    def forward(self, x: Tensor) -> Tensor:
        """Outputs of clouds [B, 6, T, K]."""
        outputs = self.forward_head(self.forward_features(x))
        if self.outputs.shape is not OutputShape.PLACES:
            return outputs
        places = outputs.view(*outputs.shape[:2], -1, 3)  # [B, T, count] -> [B, T, place, 3]
        return places + moving_centroid(x).transpose(1, 2)[:, :, None]


def build(outputs: Outputs, size: tuple[int, int]) -> nn.Module:
    """Build cloudnet for clouds of (frames, points), any of which it takes."""
    return CloudNet(outputs)
