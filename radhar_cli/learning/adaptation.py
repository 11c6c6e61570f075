"""Fit a trained network to images of another radar whose labels nobody knows.

Batch norm keeps mean and variance of what each layer saw while it learned. Replaced by those of the
new images they take away what differs between the two sources alone (Li et al., Adaptive batch
normalization for practical domain adaptation, Pattern Recognition 80, 2018).
"""

from pathlib import Path

import torch
from torch import nn
from torch.nn.modules.batchnorm import _BatchNorm

from radhar_cli.arrays import Index
from radhar_cli.dataset.files import read_bytes, write_whole
from radhar_cli.dataset.folder import folder_lock
from radhar_cli.errors import ConfigError
from radhar_cli.learning import run_folder
from radhar_cli.learning.batches import Reader, pieces
from radhar_cli.learning.evaluation import open_for, rows_of
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.images.scan import content_hash, scan
from radhar_cli.learning.run_files import TRAINED_ON
from radhar_cli.learning.run_folder import MAX_TABLE, RunMetadata, load_best
from radhar_cli.randomness import TRAINING, stream

FEWEST, BATCH = 16, 128


def adapt(
    run: Path,
    data: Path,
    folder: Path,
    device: torch.device,
    map_name: str | None = None,
    split: str = "all",
    resize: bool = False,
    overwrite: bool = False,
) -> RunMetadata:
    """Write a copy of a run whose batch norm has the statistics of all images of `data`.

    Classes of `data` are not looked at, and may be others than the model's. The images should show
    the classes about as often as those that will be predicted: statistics are of the mixture.

    Args:
        run: a training run.
        data: a data set or a tree of images.
        folder: of the copy.
        device: where to compute.
        map_name: of a data set, if not the one of the run.
        split: of `data`, where it has any.
        resize: bring images to the model's size.
        overwrite: replace a run that the folder holds.

    Raises:
        RunError, FolderError: one of them cannot be used.
        ConfigError: the network has no batch norm, or there are fewer than FEWEST images.
    """
    metadata, model = load_best(run)
    if not run.is_dir():
        raise run_folder.RunError(f"{run}: should be the folder of a run")
    if run.resolve() == folder.resolve():
        raise run_folder.RunError(f"{folder}: is the run itself; -o should name another folder")
    history = run_folder.read_history(run)
    images = open_for(metadata, data, map_name, labelled=False, resize=resize)
    rows, _ = rows_of(images, split)
    if not any(isinstance(layer, _BatchNorm) for layer in model.modules()):
        raise ConfigError(f"{run}: the network {metadata.model} has no batch norm to adapt")
    if rows.size < FEWEST:
        raise ConfigError(f"{data}: has {rows.size} images; should have at least {FEWEST}")
    adapt_batch_norm(model.to(device), metadata, images, rows, device)
    seen = content_hash(images, rows, scan(images, rows).digests)
    metadata = metadata.model_copy(update={"work": {**metadata.work, "adapted_to": seen}})
    with folder_lock(folder):
        run_folder.reserve_run(folder, metadata, overwrite)
        best = run_folder.best_epoch(history)
        run_folder.write_best(folder, metadata, best, model.state_dict())
        run_folder.write_history(folder, history)
        if (run / TRAINED_ON).exists():
            write_whole(folder, folder / TRAINED_ON, read_bytes(run / TRAINED_ON, MAX_TABLE))
    return metadata


def adapt_batch_norm(
    model: nn.Module, metadata: RunMetadata, images: ImageSet, rows: Index, device: torch.device
) -> None:
    """Replace the statistics of every batch norm by their average over rows of an image set.

    The rows are shuffled, as stored ones may be sorted by class, and batches are nearly equal.
    """
    for layer in model.modules():
        if isinstance(layer, _BatchNorm):
            layer.train()
            layer.reset_running_stats()
            layer.momentum = None  # the plain average over all batches
    seed = int(metadata.config.get("seed", 0))
    order = rows[stream(seed, TRAINING, name="adaptation").permutation(rows.size)]
    size = -(-order.size // max(1, order.size // BATCH))
    with torch.inference_mode():
        for levels, _ in Reader(images, images.label, workers=0, pin=False)(pieces(order, size)):
            model(metadata.normalisation(levels.to(device)))
    model.eval()
