"""The images that a run learns from: opened, checked, and described with the run."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import torch

from radhar_cli import __version__
from radhar_cli.config.identity import resolved
from radhar_cli.errors import ConfigError
from radhar_cli.learning.batches import epoch_batches
from radhar_cli.learning.images.classes import renamed
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.images.joined import joined
from radhar_cli.learning.images.opening import open_inputs
from radhar_cli.learning.images.scan import content_hash, scan
from radhar_cli.learning.run_folder import RunMetadata
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.starting_point import StartingPoint
from radhar_cli.learning.tasks.task import Task, create_task

FEW_STEPS = 10  # an epoch; fewer are warned of
# Not part of the identity of a run; precision enters as chosen (RunMetadata.work).
NOT_IDENTITY = ("device", "workers", "threads", "precision")


def open_training_set(
    config: TrainConfig,
    data: Path | Sequence[Path],
    names: Mapping[str, str | None] | None = None,
    size: tuple[int, int] | None = None,
) -> ImageSet:
    """Open a data set, or several as one, and make sure that it can be learned from.

    Args:
        config: model, target and settings.
        data: one or several data sets, or trees of images.
        names: {class of the data: class here, or None to leave it out}.
        size: (H, W) to bring images to; None refuses those of several sizes.

    Raises:
        FolderError: data that cannot be used together, or lack labels that the task needs.
        ConfigError: `data_weights` does not have a weight for each data set.
    """
    paths = [data] if isinstance(data, Path) else list(data)
    if config.data_weights is not None and len(config.data_weights) != len(paths):
        raise ConfigError(
            f"data_weights = {list(config.data_weights)}: should have a weight for each of the "
            f"{len(paths)} data sets"
        )
    sets = [
        renamed(open_inputs(path, config.map, config, size), names or {}).cut(
            config.validation_share, config.seed
        )
        for path in paths
    ]
    task = create_task(config)
    images = task.relabel(joined(sets))
    task.check_training(images, " and ".join(map(str, paths)))
    return images


def training_warnings(config: TrainConfig, task: Task, images: ImageSet) -> list[str]:
    """Warnings of classes without validation, and of epochs too short to learn much in."""
    warnings = task.training_warnings(images)
    count, size = images.rows("train").size, config.images_a_step
    steps = len(epoch_batches(np.arange(count), size))
    if steps < FEW_STEPS:
        warnings.append(
            f"warning: batch_size = {size}: {count} images make {steps} steps an epoch; should be "
            f"{FEW_STEPS} or more, by a smaller batch, or else many more epochs"
        )
    return warnings


def describe_run(
    config: TrainConfig,
    images: ImageSet,
    precision: torch.dtype,
    starting_point: StartingPoint | None,
) -> tuple[RunMetadata, list[tuple[str, str, str, str]]]:
    """Describe a run before its first epoch; every image is read once.

    Args:
        config: settings of the run.
        images: images that it learns from and validates with.
        precision: of the passes.
        starting_point: earlier run, whose normalisation is taken; None takes that of the images.

    Returns:
        Metadata of the run; and (name, fingerprint, scene's fingerprint, part) of its images.
    """
    rows, validation_rows = images.rows("train"), images.rows("val")
    training_scan, validation_scan = scan(images, rows), scan(images, validation_rows)
    all_rows = np.concatenate([rows, validation_rows])
    digests = (*training_scan.digests, *validation_scan.digests)
    statistics = training_scan if starting_point is None else starting_point.normalisation
    metadata = RunMetadata(
        model=config.model,
        classes=images.classes,
        size=images.size,
        map=images.map,
        channels=images.channels,
        input=config.input_kind,
        joints=images.joints,
        colours=images.colours,
        mean=statistics.mean,
        sd=statistics.sd,
        config={k: v for k, v in resolved(config).items() if k not in NOT_IDENTITY},
        data={
            "path": str(images.where),
            "hash": content_hash(images, all_rows, digests),
            "train": rows.size,
            "val": validation_rows.size,
        },
        work={
            "precision": str(precision).removeprefix("torch."),
            **({"start": starting_point.sha256} if starting_point else {}),
        },
        versions={"radhar": __version__, "torch": torch.__version__, "numpy": np.__version__},
    )
    scenes = ("",) * len(images) if images.samples.scene is None else images.samples.scene
    parts = np.repeat(["train", "val"], [rows.size, validation_rows.size])
    return metadata, [
        (images.samples.name[row], pixels, scenes[row], str(part))
        for row, pixels, part in zip(all_rows.tolist(), digests, parts, strict=True)
    ]
