"""Tasks whose outputs are classes by name, and those that give every input one of them."""

from abc import abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from torch import Tensor
from torch.nn.functional import cross_entropy

from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.learning.batches import Targets
from radhar_cli.learning.images.classes import keep_known_classes, refuse_mistyped
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.intervals import interval_in_words
from radhar_cli.learning.run_files import RunError
from radhar_cli.learning.tasks.predictions import EvalOptions
from radhar_cli.learning.tasks.task import Evaluation, Names, Task
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.numerics.arrays import Float, Index


class Categories(Task):
    """Task whose outputs are logits [B, classes]; classes are matched by name."""

    values_name: ClassVar[str] = "probabilities"

    def match(self, images: ImageSet, known: Names, names: Mapping[str, str | None]) -> ImageSet:
        """Images of the classes that a network knows, under its names and numbers."""
        refuse_mistyped(names, known.classes)
        return keep_known_classes(self.relabel(images.renamed(names)), known.classes)

    def check_training(self, images: ImageSet, path: str) -> None:
        """Make sure that there are two classes, and training images of each."""
        if len(images.classes) < 2:
            raise FolderError(f"{path}: has the class {images.classes[0]!r} alone; should have two")
        occurring = self.occurring_classes(images, images.rows("train"))
        for number, name in enumerate(images.classes):
            if number not in occurring:
                raise FolderError(f"{path}: the class {name!r} has no training image")
        super().check_training(images, path)

    def training_warnings(self, images: ImageSet) -> list[str]:
        """Warnings of classes that are not validated."""
        validated = self.occurring_classes(images, images.rows("val"))
        return [
            f"warning: the class {name!r} has no validation image; the best epoch is chosen "
            "without it"
            for number, name in enumerate(images.classes)
            if number not in validated
        ]

    def describe_values(self, values: Float, names: tuple[str, ...], first: int, top: int) -> str:
        """Likeliest classes and their probabilities, in words."""
        order = np.argsort(-values, kind="stable")[:top]
        return ", ".join(f"{names[n]} {100 * values[n]:.1f} %" for n in order)

    @abstractmethod
    def occurring_classes(self, images: ImageSet, rows: Index) -> set[int]:
        """Numbers of the classes that occur in some rows."""


class Classifier(Categories):
    """Task that gives every input one class of several.

    Its loss is the label-smoothed cross-entropy: the target of class k is y_k (1 - zeta) + zeta/K
    (paper, equation of label smoothing).
    """

    score_name: ClassVar[str] = "accuracy"
    score_key: ClassVar[str] = "val_accuracy"
    loss_name: ClassVar[str] = "label-smoothed cross-entropy"
    finds: ClassVar[str] = "classes"
    main_number: ClassVar[str] = "accuracy"

    def targets(self, images: ImageSet) -> Targets:
        """Number of the class of each row [N]."""
        return images.samples.label

    def occurring_classes(self, images: ImageSet, rows: Index) -> set[int]:
        """Numbers of the classes of some rows."""
        return set(images.samples.label[rows].tolist())

    def loss(self, outputs: Tensor, targets: Tensor) -> Tensor:
        """Cross-entropy [B] of logits [B, classes] and class numbers [B], smoothed."""
        smoothing = self.settings.label_smoothing
        return cross_entropy(outputs, targets, label_smoothing=smoothing, reduction="none")

    def score(self, outputs: Tensor, targets: Tensor) -> Tensor:
        """1 where the likeliest class is right, else 0 [B]."""
        return (outputs.argmax(1) == targets).float()

    def predict(self, outputs: Tensor) -> Tensor:
        """Probabilities [B, classes] of logits."""
        return outputs.softmax(1)

    def check_options(self, run: str, options: EvalOptions, known: Names) -> None:
        """Refuse the paper's two groups of classes that are in neither."""
        activity_names = {activity.slug for activity in ACTIVITIES}
        for name in known.classes:
            if options.in_place_vs_moving and name not in activity_names:
                raise RunError(
                    f"--in-place-vs-moving: {name!r} is none of the twelve activities; its group "
                    "is unknown"
                )

    def report(self, evaluation: Evaluation) -> dict[str, Any]:
        """Accuracy, F1, calibration and confusion, and the figures that are asked for."""
        from radhar_cli.learning.tasks.classes_report import report_classes

        return report_classes(evaluation, self.settings.label_smoothing)

    def summarise(self, numbers: Mapping[str, Any]) -> str:
        """Accuracy with its interval, macro F1 and calibration error, in words."""
        interval = interval_in_words(numbers["accuracy_95"], numbers["interval_over"])
        return (
            f"{100 * numbers['accuracy']:.2f} % {interval} of {numbers['images']}, macro F1 "
            f"{numbers['macro_f1']:.4f}, calibration error {numbers['calibration_error']:.4f}"
        )


def require_classifier(run: Path, task: Task) -> Classifier:
    """Task of a run that gives every input one class.

    Raises:
        ConfigError: it finds something else.
    """
    if not isinstance(task, Classifier):
        raise ConfigError(f"{run}: finds {task.finds}; should be a run of classes")
    return task
