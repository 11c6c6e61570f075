"""One run that finds joints on one data set: its errors, and found beside true skeletons."""

from typing import Any

import numpy as np
import torch

from radhar_cli.figures.evaluation import bars_png
from radhar_cli.figures.skeletons import skeletons_png
from radhar_cli.learning.found_joints import joint_batches
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.report_files import Report
from radhar_cli.learning.run_folder import RunMetadata
from radhar_cli.learning.targets import NEAR_M
from radhar_cli.motion.skeleton import JOINTS, PARENTS
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.processes.progress import NO_PROGRESS, Progress

AXES = ("ahead", "left", "up")
DISTANCE = "mean distance between found and true joint (cm)"
SHOWN = 6  # skeletons of the figure


def predict_skeletons(
    model: torch.nn.Module,
    metadata: RunMetadata,
    images: ImageSet,
    rows: Index,
    device: torch.device,
    batch: int,
    progress: Progress = NO_PROGRESS,
) -> tuple[Float, Float]:
    """Predicted and true joints of sequences.

    Args:
        model: network in evaluation mode, on the device.
        metadata: description of the model.
        images: sequences with joints.
        rows: N rows of `images`.
        device: where the network is.
        batch: rows at a time.
        progress: receives the number of rows done.

    Returns:
        Predicted joints, true joints; each [N, T, joint, 3], m, radar's axes. True ones are NaN
        after the end of a sample.
    """
    predicted = list[Float]()
    for joints in joint_batches(model, metadata, images.pixels, rows, device, batch):
        predicted.append(joints)
        progress.advance(len(joints))
    true = [images.skeletons[int(row)] for row in rows]
    return np.concatenate(predicted), np.stack(true)


def evaluate_skeletons(
    report: Report,
    predicted: Float,
    true: Float,
    images: ImageSet,
    rows: Index,
    stem: str,
    title: str,
) -> dict[str, Any]:
    """Numbers of a network that finds joints: errors in cm, by joint, axis and class.

    Beside them the error of the mean pose at its true place: the mean skeleton of these frames
    moved to the mean of the true joints, which asks for no movement of the limbs.

    Args:
        report: report that receives figures and tables.
        predicted: [N, T, joint, 3] predicted joints, m.
        true: [N, T, joint, 3] true joints, m; NaN in frames that do not count.
        images: sequences with joints.
        rows: N rows of `images`.
        stem: end of the names of files.
        title: title of the figures.

    Returns:
        Plain numbers by their keys in report.json.
    """
    is_known = np.isfinite(true).all((2, 3))  # [N, T]
    deviation, joints = (predicted - true)[is_known], true[is_known]  # [frame, joint, 3]
    centre = joints.mean(1, keepdims=True)
    mean_pose_deviation = (joints - centre).mean(0) + centre - joints
    by_joint = 100 * np.linalg.norm(deviation, axis=2).mean(0)
    by_axis = 100 * np.abs(deviation).mean(0)  # [joint, 3]
    label = np.repeat(images.label[rows], is_known.sum(1))
    names = images.joints
    table = [
        (name, *map("{:.2f}".format, (*axes, error)))
        for name, axes, error in zip(names, by_axis.tolist(), by_joint.tolist(), strict=True)
    ]
    header = ("joint", *(f"{axis}_cm" for axis in AXES), "mpjpe_cm")
    report.table(f"joints{stem}.csv", header, table, "Joint by joint, mean errors")
    errors = np.linalg.norm(deviation, axis=2).mean(1)
    numbers = {
        "images": int(rows.size),
        "frames": int(is_known.sum()),
        "mean_absolute_error_cm": float(100 * np.abs(deviation).mean()),
        "mpjpe_cm": float(by_joint.mean()),
        "mpjpe_of_the_mean_pose_in_place_cm": float(
            100 * np.linalg.norm(mean_pose_deviation, axis=2).mean()
        ),
        "within_15_cm": float((np.linalg.norm(deviation, axis=2) < NEAR_M).mean()),
        "joints": {
            name: {"mpjpe_cm": error, **dict(zip(header[1:4], axes, strict=True))}
            for name, axes, error in zip(names, by_axis.tolist(), by_joint.tolist(), strict=True)
        },
        "classes": {
            name: {"frames": int(in_class.sum()), "mpjpe_cm": float(100 * errors[in_class].mean())}
            for n, name in enumerate(images.classes)
            if (in_class := label == n).any()
        },
    }
    caption = f"Error of each joint, mean distance, {title}."
    report.figure(f"joints{stem}.png", caption, bars_png(names, by_joint.tolist(), DISTANCE, title))
    places = np.argwhere(is_known)[np.linspace(0, is_known.sum() - 1, SHOWN).astype(int)]
    pairs = [
        (true[row, frame], predicted[row, frame], f"{images.names[rows[row]]}, frame {frame}")
        for row, frame in places.tolist()
    ]
    parents = PARENTS if names == JOINTS else ()
    caption = f"True skeletons (grey) and those found (red), from ahead and from the side, {title}."
    report.figure(f"skeletons{stem}.png", caption, skeletons_png(pairs, parents, title))
    return numbers
