"""Initial weights from an earlier run (`radhar train --init`)."""

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from torch import nn

from radhar_cli.errors import ConfigError
from radhar_cli.learning.batches import Normalisation
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.run_folder import load_best
from radhar_cli.learning.settings import TrainConfig


@dataclass(frozen=True)
class StartingPoint:
    """Weights and normalisation of an earlier run, from which a run starts."""

    sha256: str  # hash of the weights
    normalisation: Normalisation  # of the earlier run, with which its weights were learned
    notes: tuple[str, ...]  # what was not taken over, in words


def start_from(run: Path, model: nn.Module, config: TrainConfig, images: ImageSet) -> StartingPoint:
    """Load the best weights of a run into a new model.

    Where the classes differ, the last layer keeps its random weights.

    Args:
        run: folder of the earlier run.
        model: network with fresh weights, which are replaced.
        config: config of the new run.
        images: images that it learns from.

    Raises:
        ConfigError: model, input, image size, target or joints of the two runs differ.
        RunError: the earlier run is damaged.
    """
    metadata, earlier = load_best(run)
    finds_joints = bool(metadata.task.coordinates)
    size_cure = "--resize brings the images there"
    if metadata.input == "clouds":
        size_cure = "--set frames={} --set points={} would fit".format(*metadata.size)
    for aspect, earlier_value, new_value, cure in (
        ("model", metadata.model, config.model, f"--model {metadata.model} takes the same"),
        ("input", metadata.input, config.input_kind, ""),
        ("image size", metadata.size, images.size, size_cure),
        ("target", metadata.settings.target, config.target, ""),
        ("list of joints", metadata.joints, images.joints if finds_joints else metadata.joints, ""),
    ):
        if earlier_value != new_value:
            raise ConfigError(
                f"--init {run}: its {aspect} is {earlier_value}, here it is {new_value}"
                f"{'; ' * bool(cure)}{cure}"
            )
    weights = earlier.state_dict()
    digest = hashlib.sha256()
    for name, tensor in weights.items():
        digest.update(name.encode() + tensor.numpy().tobytes())
    notes: tuple[str, ...] = ()
    if metadata.task.names(metadata) != metadata.task.names(images):
        last_layer = {
            name for name, weight in model.state_dict().items() if is_of_last_layer(name, model)
        }
        weights = {name: tensor for name, tensor in weights.items() if name not in last_layer}
        notes = (f"--init {run}: knows other classes; the last layer is learned from nothing",)
    model.load_state_dict(weights, strict=False)
    return StartingPoint(digest.hexdigest(), metadata.normalisation, notes)


def is_of_last_layer(name: str, model: nn.Module) -> bool:
    """Whether a parameter, by its name, belongs to the layer that makes the logits."""
    network: Any = model
    last = network.get_classifier() if hasattr(model, "get_classifier") else network.head
    return model.get_submodule(name.rpartition(".")[0]) is last
