"""Positions of a person's joints in every frame of a sequence (`target: skeleton`)."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from torch import Tensor

from radhar_cli.errors import FolderError
from radhar_cli.learning.batches import Targets
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.intervals import Groups, ends_in_words
from radhar_cli.learning.metrics import NEAR_M
from radhar_cli.learning.models.outputs import Outputs, OutputShape
from radhar_cli.learning.tasks.task import Evaluation, Names, Task
from radhar_cli.numerics.arrays import Float, Index


class Skeleton(Task):
    """The joints of the person in every frame, m, in the radar's axes.

    Frames without a true skeleton, which is NaN there, count neither for the loss nor the score.
    """

    score_name: ClassVar[str] = "joints within 15 cm"
    score_key: ClassVar[str] = "val_within_15_cm"
    loss_name: ClassVar[str] = "mean absolute error, m"
    finds: ClassVar[str] = "joints"
    outputs_name: ClassVar[str] = "joints"
    names_key: ClassVar[str] = "joints"
    main_number: ClassVar[str] = "mpjpe_cm"
    values_name: ClassVar[str] = "joints"
    axes: ClassVar[tuple[str, ...]] = ("frame", "joint")
    coordinates: ClassVar[tuple[str, ...]] = ("x_m", "y_m", "z_m")

    def targets(self, images: ImageSet) -> Targets:
        """Joints [T, joint, 3] of each row, m; NaN after the end of a sample.

        Raises:
            FolderError: the data set has no true joints.
        """
        if not images.joints:
            raise FolderError(
                f"{images.where}: is measured, and has no true joints to learn or to compare with"
            )
        return images.skeletons

    def names(self, known: Names) -> tuple[str, ...]:
        """Names of the joints.

        Raises:
            FolderError: there are none, as in measured data.
        """
        if not known.joints:
            raise FolderError("target = skeleton: needs true joints, which measured data lack")
        return known.joints

    def groups(self, images: ImageSet, rows: Index) -> Groups:
        """Persons or recordings of some rows, else the sequences, whose frames are alike."""
        groups = super().groups(images, rows)
        return replace(groups, kind="sequence") if groups.kind == "sample" else groups

    def outputs(self, known: Names) -> Outputs:
        """Three coordinates a joint, in every frame."""
        return Outputs(3 * len(self.names(known)), OutputShape.PLACES)

    def loss(self, outputs: Tensor, targets: Tensor) -> Tensor:
        """Mean absolute error [B] of coordinates, m.

        Args:
            outputs: [B, T, joint, 3] joints, m.
            targets: [B, T, joint, 3] true joints, m.
        """
        is_known = targets.isfinite()
        deviation = (outputs - targets.nan_to_num()) * is_known
        mean: Tensor = deviation.abs().sum((1, 2, 3)) / is_known.sum((1, 2, 3)).clamp_min(1)
        return mean

    def score(self, outputs: Tensor, targets: Tensor) -> Tensor:
        """Share of joints within 15 cm [B]."""
        is_known = targets.isfinite().all(3)  # [B, T, joint]
        distance = (outputs - targets.nan_to_num()).norm(dim=3)
        is_near = (distance < NEAR_M) & is_known
        share: Tensor = is_near.sum((1, 2)) / is_known.sum((1, 2)).clamp_min(1)
        return share

    def predict(self, outputs: Tensor) -> Tensor:
        """Joints [B, T, joint, 3], m, as the network gives them."""
        return outputs

    def describe_values(self, values: Float, names: tuple[str, ...], first: int, top: int) -> str:
        """Mean place of the joints in the first and the last frame, in words."""
        places = values[np.isfinite(values).all((1, 2))].mean(1)  # [frame, 3]
        ahead, left, _ = (
            f"{a:.2f} to {b:.2f} m" for a, b in zip(places[0], places[-1], strict=True)
        )
        return f"{len(names)} joints in {len(places)} frames, {ahead} ahead, {left} left"

    def report(self, evaluation: Evaluation) -> dict[str, Any]:
        """Errors in cm, by joint, axis and class."""
        from radhar_cli.learning.tasks.skeleton_report import report_skeletons

        return report_skeletons(evaluation)

    def summarise(self, numbers: Mapping[str, Any]) -> str:
        """Errors of the coordinates and of the joints, in words."""
        in_place = numbers["mpjpe_of_the_mean_pose_in_place_cm"]
        interval = ends_in_words(numbers["mpjpe_cm_95"], "cm", numbers["interval_over"])
        return (
            f"mean absolute error {numbers['mean_absolute_error_cm']:.2f} cm, MPJPE "
            f"{numbers['mpjpe_cm']:.2f} cm {interval}, the mean pose in its place "
            f"{in_place:.2f} cm, {numbers['frames']} frames"
        )
