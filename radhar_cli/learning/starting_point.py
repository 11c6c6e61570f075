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
    """What a run starts from."""

    sha256: str  # of the weights
    normalisation: Normalisation  # of the earlier run; the weights were learned with it
    notes: tuple[str, ...]  # what was not taken over, in words


def start_from(run: Path, model: nn.Module, config: TrainConfig, images: ImageSet) -> StartingPoint:
    """Load the best weights of a run into a new model.

    Where the classes differ, the last layer keeps its random weights.
    """
    metadata, earlier = load_best(run)
    for what, theirs, ours in (
        ("model", metadata.model, config.model),
        ("input", metadata.input, config.input_kind),
        ("image size", metadata.size, images.size),
        ("target", metadata.settings.target, config.target),
        ("list of joints", metadata.joints, images.joints),
    ):
        if theirs != ours:
            cure = "; --resize brings the images there" if what == "image size" else ""
            raise ConfigError(f"--init {run}: its {what} is {theirs}, here it is {ours}{cure}")
    weights = earlier.state_dict()
    digest = hashlib.sha256()
    for name, tensor in weights.items():
        digest.update(name.encode() + tensor.numpy().tobytes())
    notes: tuple[str, ...] = ()
    if metadata.classes != images.classes and not metadata.finds_joints:
        last = {name for name, old in model.state_dict().items() if is_of_last_layer(name, model)}
        weights = {name: tensor for name, tensor in weights.items() if name not in last}
        notes = (f"--init {run}: knows other classes; the last layer is learned from nothing",)
    model.load_state_dict(weights, strict=False)
    return StartingPoint(digest.hexdigest(), metadata.normalisation, notes)


def is_of_last_layer(name: str, model: nn.Module) -> bool:
    """Whether a parameter is one of the layer that makes the logits."""
    network: Any = model
    last = network.get_classifier() if hasattr(model, "get_classifier") else network.head
    return model.get_submodule(name.rpartition(".")[0]) is last
