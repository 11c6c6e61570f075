"""What a user adds to learning: a network of gray images, and a task that is no classification."""

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
from torch import Tensor, nn

from radhar_cli.learning.batches import Targets
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.models.outputs import Outputs
from radhar_cli.learning.registry import NETWORKS, TASKS, NetworkChoice, TaskChoice
from radhar_cli.learning.tasks.task import Evaluation, Task


class Pooling(nn.Module):
    """Mean of 4 x 4 parts of an image [B, 1, H, W], and one layer."""

    def __init__(self, outputs: int) -> None:
        super().__init__()
        self.features = nn.Sequential(nn.AdaptiveAvgPool2d(4), nn.Flatten())
        self.head = nn.Linear(16, outputs)

    def forward(self, x: Tensor) -> Tensor:
        result: Tensor = self.head(self.features(x))
        return result


def build(outputs: Outputs, size: tuple[int, int]) -> nn.Module:
    return Pooling(outputs.count)


class Brightness(Task):
    """How bright an image is on average, 0 to 1."""

    score_name: ClassVar[str] = "brightness within 0.05"
    score_key: ClassVar[str] = "val_within_5_percent"
    loss_name: ClassVar[str] = "squared error"
    finds: ClassVar[str] = "brightness"
    outputs_name: ClassVar[str] = "brightness"
    names_key: ClassVar[str] = "quantities"
    main_number: ClassVar[str] = "rms_error"

    def names(self, known: object) -> tuple[str, ...]:
        return ("brightness",)

    def targets(self, images: ImageSet) -> Targets:
        levels = (images.pixels.read(row) for row in range(len(images)))
        return np.array([image.mean() / 255 for image in levels], np.float32)

    def loss(self, outputs: Tensor, targets: Tensor) -> Tensor:
        return (outputs[:, 0] - targets).square()

    def score(self, outputs: Tensor, targets: Tensor) -> Tensor:
        return ((outputs[:, 0] - targets).abs() < 0.05).float()

    def predict(self, outputs: Tensor) -> Tensor:
        return outputs[:, 0]

    def report(self, evaluation: Evaluation) -> dict[str, Any]:
        found = evaluation.predictions
        error = found.values - np.array(self.targets(found.images))[found.rows]
        evaluation.table("errors", ("image", "error"), zip(found.rows, error, strict=True))
        return {"images": len(error), "rms_error": float(np.sqrt(np.mean(error**2)))}

    def summarise(self, numbers: Mapping[str, Any]) -> str:
        return f"brightness to {numbers['rms_error']:.3f}"


NETWORKS["pooling"] = NetworkChoice("extending.brightness:build", channels=1)
TASKS["brightness"] = TaskChoice("extending.brightness:Brightness")
