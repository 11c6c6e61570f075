"""Activities of everybody in a scene: yes or no for each class (`target: labels`)."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from torch import Tensor
from torch.nn.functional import binary_cross_entropy_with_logits

from radhar_cli.learning.batches import Targets
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.intervals import interval_in_words
from radhar_cli.learning.tasks.categories import Categories
from radhar_cli.learning.tasks.task import Evaluation, Names
from radhar_cli.numerics.arrays import Index


class Labels(Categories):
    """The activities that anybody in a scene performs, each by itself."""

    score_name: ClassVar[str] = "all labels right"
    score_key: ClassVar[str] = "val_exact_match"
    loss_name: ClassVar[str] = "binary cross-entropy"
    finds: ClassVar[str] = "several labels at a time"
    main_number: ClassVar[str] = "mean_average_precision"

    def relabel(self, images: ImageSet) -> ImageSet:
        """Images with all activities of anybody as classes.

        The label of an image is still that of its main person.
        """
        activities = {name for names in images.activities for name in names}
        further_classes = sorted(activities.difference(images.classes))
        return replace(images, classes=(*images.classes, *further_classes))

    def targets(self, images: ImageSet) -> Targets:
        """Multi-hot labels [N, classes]."""
        return images.multi_hot(images.classes)

    def occurring_classes(self, images: ImageSet, rows: Index) -> set[int]:
        """Numbers of the classes that anybody performs in some rows."""
        return set(np.flatnonzero(images.multi_hot(images.classes)[rows].any(0)).tolist())

    def describe(self, known: Names) -> str:
        """Number of labels, in words."""
        return f"{len(known.classes)} labels"

    def loss(self, outputs: Tensor, targets: Tensor) -> Tensor:
        """Mean binary cross-entropy [B] of logits [B, classes] and labels [B, classes], 0 or 1."""
        labels = targets.to(outputs.dtype)
        return binary_cross_entropy_with_logits(outputs, labels, reduction="none").mean(1)

    def score(self, outputs: Tensor, targets: Tensor) -> Tensor:
        """1 where all labels of an input are right, else 0 [B]."""
        return ((outputs > 0) == (targets > 0)).all(1).float()

    def predict(self, outputs: Tensor) -> Tensor:
        """Probabilities [B, classes] of logits, each by itself."""
        return outputs.sigmoid()

    def report(self, evaluation: Evaluation) -> dict[str, Any]:
        """Average precision of each label, and how often all labels are right."""
        from radhar_cli.learning.tasks.labels_report import report_labels

        return report_labels(evaluation)

    def summarise(self, numbers: Mapping[str, Any]) -> str:
        """Mean average precision, and the share with all labels right, in words."""
        interval = interval_in_words(numbers["exact_match_95"], numbers["interval_over"])
        return (
            f"mean average precision {100 * numbers['mean_average_precision']:.2f} %, all labels "
            f"right in {100 * numbers['exact_match']:.2f} % {interval} of {numbers['images']}"
        )

    def evaluation_warnings(self, images: ImageSet, name: str) -> list[str]:
        """Warning of a data set that knows the activity of one person alone."""
        if images.samples.activities is not None:
            return []
        return [f"warning: {name} says of one person alone what they do"]
