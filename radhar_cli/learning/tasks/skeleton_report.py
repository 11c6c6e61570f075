"""One network that finds joints, on one data set: its errors, and found beside true skeletons."""

from typing import Any

import numpy as np

from radhar_cli.errors import FolderError
from radhar_cli.figures.evaluation import bars_png
from radhar_cli.figures.skeletons import skeletons_png
from radhar_cli.learning.intervals import Groups, numbers_of_mean, numbers_of_share
from radhar_cli.learning.metrics import NEAR_M
from radhar_cli.learning.tasks.predictions import Predictions
from radhar_cli.learning.tasks.task import Evaluation
from radhar_cli.motion.skeleton import JOINTS, PARENTS
from radhar_cli.numerics.arrays import Bool, Float

AXES = ("ahead", "left", "up")
DISTANCE = "mean distance between found and true joint (cm)"
DRAWN = 5  # skeletons of the figure


def report_skeletons(evaluation: Evaluation) -> dict[str, Any]:
    """Report the errors of joints in cm, by joint, axis and class.

    Beside them the error of the mean pose at its true place: the mean skeleton of these frames
    moved to the mean of the true joints, which asks for no movement of the limbs.

    Returns:
        Plain numbers by their keys in report.json.

    Raises:
        FolderError: no frame has a true skeleton, as where nobody is in any of them.
    """
    predictions = evaluation.predictions
    rows, names = predictions.rows, predictions.names
    skeletons = predictions.images.skeletons
    true = np.stack([skeletons[int(row)] for row in rows])  # [N, T, joint, 3], NaN after the end
    is_known: Bool = np.all(np.isfinite(true), axis=(2, 3))  # [N, T]
    if not is_known.any():
        raise FolderError(f"{predictions.images.where}: has no frame with a true skeleton")
    deviation, joints = (predictions.values - true)[is_known], true[is_known]  # [frame, joint, 3]
    distance = np.linalg.norm(deviation, axis=2)  # [frame, joint]
    group = np.repeat(evaluation.groups.number, is_known.sum(1))  # [frame]
    groups = Groups(group, evaluation.groups.kind)
    by_joint = 100 * distance.mean(0)
    by_axis = 100 * np.abs(deviation).mean(0)  # [joint, 3]
    header = ("joint", *(f"{axis}_cm" for axis in AXES), "mpjpe_cm")
    errors = list(zip(names, by_axis.tolist(), by_joint.tolist(), strict=True))
    table = [(name, *(round(cm, 2) for cm in (*axes, error))) for name, axes, error in errors]
    evaluation.table("joints", header, table, "Joint by joint, mean errors")
    png = bars_png(names, by_joint.tolist(), DISTANCE, evaluation.title)
    evaluation.figure("joints", f"Error of each joint, mean distance, {evaluation.title}.", png)
    _draw_skeletons(evaluation, true, is_known, 100 * distance.mean(1))
    return {
        "images": int(rows.size),
        "frames": int(is_known.sum()),
        "mean_absolute_error_cm": float(100 * np.abs(deviation).mean()),
        "mpjpe_cm": float(by_joint.mean()),
        "mpjpe_of_the_mean_pose_in_place_cm": _mean_pose_error_cm(joints),
        **numbers_of_mean("mpjpe_cm", 100 * distance.mean(1), groups),
        "within_15_cm": float((distance < NEAR_M).mean()),
        **numbers_of_share("within_15_cm", (distance < NEAR_M).mean(1), groups),
        "joints": {
            name: {"mpjpe_cm": error, **dict(zip(header[1:4], axes, strict=True))}
            for name, axes, error in errors
        },
        "classes": _errors_by_class(predictions, distance.mean(1), is_known),
    }


def _mean_pose_error_cm(joints: Float) -> float:
    """Mean distance of joints [frame, joint, 3] from the mean pose at the place of each, cm."""
    centre = joints.mean(1, keepdims=True)
    deviation = (joints - centre).mean(0) + centre - joints
    return float(100 * np.linalg.norm(deviation, axis=2).mean())


def _errors_by_class(
    predictions: Predictions, errors: Float, is_known: Bool
) -> dict[str, dict[str, float]]:
    """Frames and mean error in cm of each class that occurs.

    Args:
        predictions: joints of N rows.
        errors: mean distance of the joints of each known frame [frame], m.
        is_known: [N, T], whether a frame has a true skeleton.
    """
    images = predictions.images
    label = np.repeat(images.samples.label[predictions.rows], is_known.sum(1))  # [frame]
    numbers = {}
    for number, name in enumerate(images.classes):
        in_class = label == number
        if in_class.any():
            error_cm = float(100 * errors[in_class].mean())
            numbers[name] = {"frames": int(in_class.sum()), "mpjpe_cm": error_cm}
    return numbers


def _draw_skeletons(evaluation: Evaluation, true: Float, is_known: Bool, errors_cm: Float) -> None:
    """Add found beside true skeletons of frames from the smallest to the largest error.

    Args:
        true: true skeletons [N, T, joint, 3], m.
        is_known: [N, T], whether a frame has one.
        errors_cm: mean error of each known frame [frame], cm.
    """
    predictions, title = evaluation.predictions, evaluation.title
    images, predicted = predictions.images, predictions.values
    places = np.argsort(errors_cm, kind="stable")
    chosen = places[np.linspace(0, places.size - 1, DRAWN).astype(int)]
    pairs = []
    for (row, frame), error in zip(
        np.argwhere(is_known)[chosen].tolist(), errors_cm[chosen].tolist(), strict=True
    ):
        name = images.samples.name[predictions.rows[row]]
        words = f"{name}\nframe {frame}: {error:.0f} cm"
        pairs.append((true[row, frame], predicted[row, frame], words))
    parents = PARENTS if predictions.names == JOINTS else ()
    caption = (
        "True skeletons (grey) and those found (red), from the radar and from the side: from the "
        f"frame with the smallest mean error to the one with the largest, {title}."
    )
    evaluation.figure("skeletons", caption, skeletons_png(pairs, parents, title))
