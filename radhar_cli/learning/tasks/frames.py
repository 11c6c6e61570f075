"""Activity of the main person in every column of a stream (`target: frames`)."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import cross_entropy

from radhar_cli.errors import FolderError
from radhar_cli.learning.batches import Targets
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.intervals import Groups, interval_in_words
from radhar_cli.learning.models.outputs import Outputs, OutputShape
from radhar_cli.learning.tasks.task import Evaluation, Names, Task
from radhar_cli.numerics.arrays import Float, Index

RARE = 0.01  # share of the columns below which a class is warned of


@dataclass(frozen=True)
class FrameLabels(Task):
    """The class at the time of each column, pauses and transitions included.

    Columns without a label, -1, count neither for the loss nor the score.
    """

    weights: tuple[float, ...] | None = None  # [classes] of a column in the loss; None: 1 each

    score_name: ClassVar[str] = "frame accuracy"
    score_key: ClassVar[str] = "val_frame_accuracy"
    loss_name: ClassVar[str] = "label-smoothed cross-entropy"
    finds: ClassVar[str] = "labels of frames"
    main_number: ClassVar[str] = "frame_accuracy"
    values_name: ClassVar[str] = "probabilities"
    axes: ClassVar[tuple[str, ...]] = ("column",)

    def relabel(self, images: ImageSet) -> ImageSet:
        """Images whose classes are those of their columns."""
        if images.samples.frame_labels is None:
            raise FolderError(
                f"{images.where}: has no labels in time: target: frames is of streams"
            )
        label = np.zeros(len(images), np.intp)
        samples = replace(images.samples, label=label)
        return replace(images, classes=images.frame_classes, samples=samples)

    def match(self, images: ImageSet, known: Names, names: Mapping[str, str | None]) -> ImageSet:
        """Images whose columns have the numbers of the classes that a network knows.

        Columns of other classes, and of those that `names` leaves out, have none.
        """
        images = self.relabel(images)
        places = {name: number for number, name in enumerate(known.classes)}
        renamed = [names.get(name, name) for name in images.frame_classes]
        numbers = np.array([places.get(name or "", -1) for name in renamed] + [-1])
        assert images.samples.frame_labels is not None
        labels = numbers[images.samples.frame_labels]
        samples = replace(images.samples, frame_labels=labels)
        return replace(images, classes=known.classes, frame_classes=known.classes, samples=samples)

    def targets(self, images: ImageSet) -> Targets:
        """Number of the class of each column of each row [N, W]."""
        assert images.samples.frame_labels is not None
        return images.samples.frame_labels.astype(np.int64)

    def weighted_for(self, images: ImageSet) -> "FrameLabels":
        """Task whose columns weigh 1/sqrt(share of their class), a mean of 1, if asked for."""
        if self.settings.class_weights == "equal":
            return self
        share = _column_shares(images)
        roots = np.where(share > 0, share, 1) ** -0.5
        return replace(self, weights=tuple((roots / (share @ roots)).tolist()))

    def training_warnings(self, images: ImageSet) -> list[str]:
        """Warn of rare classes, which equal weights may leave unlearned."""
        shares = zip(images.classes, _column_shares(images).tolist(), strict=True)
        rare = [f"{name} {100 * share:.2f} %" for name, share in shares if 0 < share < RARE]
        if not rare or self.settings.class_weights != "equal":
            return []
        return [
            f"warning: few columns are {', '.join(rare)}: class_weights = equal may leave such "
            "classes unlearned; should be inverse_root to find them"
        ]

    def groups(self, images: ImageSet, rows: Index) -> Groups:
        """Persons or recordings of some rows, else the streams, whose frames are alike."""
        groups = super().groups(images, rows)
        return replace(groups, kind="stream") if groups.kind == "sample" else groups

    def outputs(self, known: Names) -> Outputs:
        """Logits of every column."""
        return Outputs(len(self.names(known)), OutputShape.FRAMES)

    def loss(self, outputs: Tensor, targets: Tensor) -> Tensor:
        """Mean cross-entropy [B] of logits [B, W, classes] and class numbers [B, W], smoothed.

        Columns count by the weights of their true classes.
        """
        is_known = targets >= 0
        by_column = cross_entropy(
            outputs.transpose(1, 2),
            targets.clamp_min(0),
            label_smoothing=self.settings.label_smoothing,
            reduction="none",
        )
        if self.weights is not None:
            weights = torch.tensor(self.weights, device=outputs.device)
            by_column = by_column * weights[targets.clamp_min(0)]
        mean: Tensor = (by_column * is_known).sum(1) / is_known.sum(1).clamp_min(1)
        return mean

    def score(self, outputs: Tensor, targets: Tensor) -> Tensor:
        """Share of the columns whose likeliest class is right [B]."""
        is_known = targets >= 0
        is_right = (outputs.argmax(2) == targets) & is_known
        share: Tensor = is_right.sum(1) / is_known.sum(1).clamp_min(1)
        return share

    def predict(self, outputs: Tensor) -> Tensor:
        """Probabilities [B, W, classes] of logits."""
        return outputs.softmax(2)

    def describe_values(self, values: Float, names: tuple[str, ...], first: int, top: int) -> str:
        """Likeliest class of the columns and where it begins, in words."""
        likeliest = values.argmax(1)
        starts = [0, *(np.flatnonzero(np.diff(likeliest)) + 1).tolist()]
        return ", ".join(f"{names[likeliest[start]]} from {first + start}" for start in starts)

    def report(self, evaluation: Evaluation) -> dict[str, Any]:
        """Accuracy of frames, F1 of segments, edit score, and labels drawn under the maps."""
        from radhar_cli.learning.tasks.frames_report import report_frames

        return report_frames(evaluation)

    def summarise(self, numbers: Mapping[str, Any]) -> str:
        """Accuracy of frames, F1 of segments and edit score, and alarms of events, in words."""
        from radhar_cli.learning.tasks.events_report import summarise_events

        interval = interval_in_words(numbers["frame_accuracy_95"], numbers["interval_over"])
        events = f"; {summarise_events(numbers['events'])}" if "events" in numbers else ""
        f1 = ", ".join(f"{100 * numbers[f'segment_f1_{k}']:.1f}" for k in (10, 25, 50))
        return (
            f"{100 * numbers['frame_accuracy']:.2f} % {interval} of {numbers['frames']} frames, "
            f"segment F1 at IoU 0.10, 0.25, 0.50: {f1} %, edit score "
            f"{100 * numbers['edit_score']:.1f} %{events}"
        )


def _column_shares(images: ImageSet) -> Float:
    """Share of each class in the columns of the training images [classes]."""
    assert images.samples.frame_labels is not None
    labels = images.samples.frame_labels[images.rows("train")]
    counts = np.bincount(labels[labels >= 0], minlength=len(images.classes))
    shares: Float = counts / max(1, counts.sum())
    return shares
