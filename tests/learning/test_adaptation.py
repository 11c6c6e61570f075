"""Batch norm of unlabelled images."""

from pathlib import Path

import numpy as np
import pytest
import torch
from learning.patterns import Watched, same, trained, tree
from PIL import Image
from torch import nn

from radhar_cli.errors import ConfigError
from radhar_cli.learning.adaptation import adapt
from radhar_cli.learning.evaluation import open_for, predict
from radhar_cli.learning.run_folder import RunError, load_best

CPU = torch.device("cpu")


def accuracy(run: Path, data: Path) -> float:
    metadata, model = load_best(run)
    images = open_for(metadata, data, None)
    found = predict(model, metadata, images, np.arange(len(images)), CPU, 32)
    return float((found.predicted == found.truth).mean())


def another_radar(data: Path) -> Path:
    """Darkens all images of a tree and takes most of their contrast."""
    for path in data.rglob("*.png"):
        levels = np.asarray(Image.open(path)).astype(float)
        Image.fromarray((levels * 0.25).astype(np.uint8)).save(path)
    return data


@pytest.fixture(scope="module")
def learned(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    run = tmp_path_factory.mktemp("learned") / "run"
    trained(data, run, epochs=8)
    return run


def test_adaptation_restores_accuracy_at_another_contrast(learned: Path, tmp_path: Path) -> None:
    measured = another_radar(tree(tmp_path / "measured", seed=5))
    adapt(learned, measured, tmp_path / "adapted", CPU)
    assert accuracy(learned, measured) < 0.7
    assert accuracy(tmp_path / "adapted", measured) > 0.9


def test_statistics_alone_change_and_labels_do_not_matter(learned: Path, tmp_path: Path) -> None:
    tree(tmp_path / "one", seed=5)
    (tmp_path / "one/walking").rename(tmp_path / "one/unknown")  # an unknown class
    metadata = adapt(learned, tmp_path / "one", tmp_path / "adapted", CPU)
    assert "adapted_to" in metadata.work
    (_, before), (_, after) = load_best(learned), load_best(tmp_path / "adapted")
    norms = {n for n, layer in before.named_modules() if isinstance(layer, nn.BatchNorm2d)}
    for name, tensor in before.state_dict().items():
        same = torch.equal(tensor, after.state_dict()[name])
        layer, _, part = name.rpartition(".")
        assert same != (layer in norms and part.startswith(("running", "num_batches"))), name


def information(run: Path, data: Path) -> float:
    """Mutual information of images and predictions: entropy of the mean less mean entropy, nats."""
    metadata, model = load_best(run)
    images = open_for(metadata, data, None)
    p = predict(model, metadata, images, np.arange(len(images)), CPU, 32).probabilities
    entropy = -(p * np.log(p)).sum(1).mean()
    return float(-(p.mean(0) * np.log(p.mean(0))).sum() - entropy)


def test_epochs_raise_the_information_of_predictions_and_lose_no_accuracy(
    learned: Path, tmp_path: Path
) -> None:
    measured = another_radar(tree(tmp_path / "measured", seed=5))
    watched = Watched()
    adapt(learned, measured, tmp_path / "norms", CPU)
    adapt(learned, measured, tmp_path / "epochs", CPU, epochs=6, progress=watched)
    assert len(watched.messages) == 6
    assert information(tmp_path / "epochs", measured) > information(tmp_path / "norms", measured)
    assert accuracy(tmp_path / "epochs", measured) > 0.9


def test_epochs_leave_the_last_layer_and_do_not_look_at_labels(
    learned: Path, tmp_path: Path
) -> None:
    one, other = (tree(tmp_path / name / "tree", seed=5) for name in ("one", "other"))
    for number, name in enumerate(("punching", "kicking", "walking")):  # the order stays
        (other / name).rename(other / f"class_{number}")
    for data in (one, other):
        adapt(learned, data, data.parent / "adapted", CPU, epochs=2)
    before, after, blind = (
        load_best(run)[1].state_dict()
        for run in (learned, tmp_path / "one/adapted", tmp_path / "other/adapted")
    )
    assert same(after, blind)
    for name, tensor in before.items():
        assert torch.equal(tensor, after[name]) == name.startswith("head"), name


@pytest.mark.parametrize("epochs", [0, 2])
def test_adaptation_is_reproducible(learned: Path, tmp_path: Path, epochs: int) -> None:
    measured = tree(tmp_path / "measured", seed=5)
    for name in ("one", "two"):
        adapt(learned, measured, tmp_path / name, CPU, epochs=epochs)
    # Not the files' bytes: safetensors writes its metadata in any order.
    (about, one), (again, two) = (load_best(tmp_path / name) for name in ("one", "two"))
    assert about == again
    assert same(one.state_dict(), two.state_dict())


def test_what_cannot_be_adapted_is_refused(learned: Path, data: Path, tmp_path: Path) -> None:
    few = tree(tmp_path / "few", classes=("walking",))
    with pytest.raises(ConfigError, match="has 8 images; should have at least 16"):
        adapt(learned, few, tmp_path / "no", CPU)
    with pytest.raises(RunError, match="is the run itself"):
        adapt(learned, data, learned, CPU)
