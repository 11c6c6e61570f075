"""Batch norm of unlabelled images, and what networks with and without it learn of them."""

import numpy as np
import pytest
import torch
from learning.patterns import Watched, same, split_tree, trained, tree
from PIL import Image
from torch import nn

from radhar_cli.errors import ConfigError
from radhar_cli.learning import adaptation
from radhar_cli.learning.adaptation import AdaptOptions, Mixed, adapt
from radhar_cli.learning.evaluation import open_for_model, open_training_images, predict_classes
from radhar_cli.learning.images.joined import joined
from radhar_cli.learning.run_folder import RunError, load_best

CPU = torch.device("cpu")


def accuracy(run, data):
    metadata, model = load_best(run)
    images = open_for_model(metadata, data, None)
    found = predict_classes(model, metadata, images, np.arange(len(images)), CPU, 32)
    return float((found.predicted == found.truth).mean())


def cross_entropy(run, data):
    """With batch norm as in training: statistics of other images are not what is asked about."""
    metadata, model = load_best(run)
    images = open_training_images(metadata, data)
    levels = np.stack([images.pixels.read(row).transpose(2, 0, 1) for row in range(len(images))])
    with torch.inference_mode():
        logits = model.train()(metadata.normalisation(torch.from_numpy(levels)))
    return float(nn.functional.cross_entropy(logits, torch.from_numpy(images.samples.label)))


def another_radar(data):
    """Darkens all images of a tree and takes most of their contrast."""
    for path in data.rglob("*.png"):
        levels = np.asarray(Image.open(path)).astype(float)
        Image.fromarray((levels * 0.25).astype(np.uint8)).save(path)
    return data


@pytest.fixture(scope="module")
def learned(data, tmp_path_factory):
    run = tmp_path_factory.mktemp("learned") / "run"
    trained(data, run, epochs=8)
    return run


@pytest.fixture(scope="module")
def normed(tmp_path_factory):
    """A run of a network with batch norm."""
    folder = tmp_path_factory.mktemp("normed")
    trained(split_tree(folder / "data", size=32), folder / "run", epochs=8, model="smallnet_bn")
    return folder / "run"


def test_statistics_restore_accuracy_at_another_contrast(normed, tmp_path):
    measured = another_radar(tree(tmp_path / "measured", size=32, seed=5))
    adapt(normed, measured, tmp_path / "adapted", CPU)
    assert accuracy(normed, measured) < 0.6
    assert accuracy(tmp_path / "adapted", measured) > 0.8


def test_without_batch_norm_there_is_nothing_but_learning(learned, tmp_path):
    measured = tree(tmp_path / "measured", seed=5)
    with pytest.raises(ConfigError, match="epochs = 0: should be at least 1 for smallnet"):
        adapt(learned, measured, tmp_path / "adapted", CPU, AdaptOptions(epochs=0))


def test_defaults_learn_where_statistics_alone_would_change_nothing(
    learned, normed, data, tmp_path, monkeypatch
):
    monkeypatch.setattr(adaptation, "EPOCHS", 2)
    measured = tree(tmp_path / "measured", seed=5)
    for run, mix, epochs in ((learned, (), 2), (normed, (), 0), (normed, (data,), 2)):
        found = adapt(
            run, measured, tmp_path / "adapted", CPU, AdaptOptions(mix=mix, overwrite=True)
        )
        assert found.work["adapted_epochs"] == epochs


def test_statistics_alone_change_and_labels_do_not_matter(normed, tmp_path):
    learned = normed
    tree(tmp_path / "one", size=32, seed=5)
    (tmp_path / "one/walking").rename(tmp_path / "one/unknown")  # an unknown class
    metadata = adapt(learned, tmp_path / "one", tmp_path / "adapted", CPU)
    assert "adapted_to" in metadata.work
    (_, before), (_, after) = load_best(learned), load_best(tmp_path / "adapted")
    norms = {n for n, layer in before.named_modules() if isinstance(layer, nn.BatchNorm2d)}
    for name, tensor in before.state_dict().items():
        same = torch.equal(tensor, after.state_dict()[name])
        layer, _, part = name.rpartition(".")
        assert same != (layer in norms and part.startswith(("running", "num_batches"))), name


def information(run, data):
    """Mutual information of images and predictions: entropy of the mean less mean entropy, nats."""
    metadata, model = load_best(run)
    images = open_for_model(metadata, data, None)
    p = predict_classes(model, metadata, images, np.arange(len(images)), CPU, 32).probabilities
    entropy = -(p * np.log(p)).sum(1).mean()
    return float(-(p.mean(0) * np.log(p.mean(0))).sum() - entropy)


def test_epochs_raise_the_information_of_predictions_and_lose_no_accuracy(learned, tmp_path):
    measured = tree(tmp_path / "measured", seed=5)
    watched = Watched()
    adapt(learned, measured, tmp_path / "epochs", CPU, AdaptOptions(epochs=6), watched)
    assert len(watched.messages) == 6
    assert information(tmp_path / "epochs", measured) > information(learned, measured)
    assert accuracy(tmp_path / "epochs", measured) > 0.9


def test_epochs_leave_the_last_layer_and_do_not_look_at_labels(learned, tmp_path):
    one, other = (tree(tmp_path / name / "tree", seed=5) for name in ("one", "other"))
    for number, name in enumerate(("kicking", "punching", "walking")):  # the order stays
        (other / name).rename(other / f"class_{number}")
    for data in (one, other):
        adapt(learned, data, data.parent / "adapted", CPU, AdaptOptions(epochs=2))
    before, after, blind = (
        load_best(run)[1].state_dict()
        for run in (learned, tmp_path / "one/adapted", tmp_path / "other/adapted")
    )
    assert same(after, blind)
    for name, tensor in before.items():
        assert torch.equal(tensor, after[name]) == name.startswith("head"), name


def test_mixed_images_teach_their_labels(learned, tmp_path):
    measured, other = tree(tmp_path / "measured", seed=5), split_tree(tmp_path / "other", seed=6)
    for part in other.iterdir():  # two classes change names
        for old, new in (("kicking", "x"), ("punching", "kicking"), ("x", "punching")):
            (part / old).rename(part / new)
    loss, work = [], []
    for mix in ((), (other,)):
        metadata = adapt(
            learned,
            measured,
            tmp_path / "adapted",
            CPU,
            AdaptOptions(epochs=30, mix=mix, overwrite=True),
        )
        loss.append(cross_entropy(tmp_path / "adapted", other))
        work.append(metadata.work.get("adapted_with"))
    assert loss[1] < loss[0] / 2
    assert work[0] is None
    assert work[1] is not None


def test_mixed_sets_are_drawn_by_their_weights(learned, tmp_path):
    metadata, _ = load_best(learned)
    sets = [
        open_training_images(metadata, split_tree(tmp_path / name, classes=(name,)))
        for name in ("walking", "kicking")
    ]
    mixed = Mixed(joined(sets), (3.0, 1.0))
    drawn = torch.cat([labels for _, labels in mixed.batches(metadata, 1, 50)])
    shares = torch.bincount(drawn, minlength=3) / drawn.numel()
    wanted = [{"walking": 0.75, "kicking": 0.25}.get(name, 0.0) for name in metadata.classes]
    torch.testing.assert_close(shares, torch.tensor(wanted), atol=0.05, rtol=0)


@pytest.mark.parametrize(("epochs", "mix"), [(2, False), (2, True)])
def test_adaptation_is_reproducible(learned, data, tmp_path, epochs, mix):
    measured = tree(tmp_path / "measured", seed=5)
    for name in ("one", "two"):
        adapt(
            learned, measured, tmp_path / name, CPU, AdaptOptions(epochs=epochs, mix=(data,) * mix)
        )
    # Not the files' bytes: safetensors writes its metadata in any order.
    (about, one), (again, two) = (load_best(tmp_path / name) for name in ("one", "two"))
    assert about == again
    assert same(one.state_dict(), two.state_dict())


def test_another_adapted_run_is_not_replaced(learned, data, tmp_path):
    measured = tree(tmp_path / "measured", size=32, seed=5)
    for _ in range(2):  # the same once more is no other run
        adapt(learned, measured, tmp_path / "adapted", CPU, AdaptOptions(epochs=1))
    before = (tmp_path / "adapted/best.safetensors").read_bytes()
    with pytest.raises(RunError, match="adapted_epochs: 1 there, 2 here"):
        adapt(learned, measured, tmp_path / "adapted", CPU, AdaptOptions(epochs=2))
    assert (tmp_path / "adapted/best.safetensors").read_bytes() == before
    adapt(learned, measured, tmp_path / "adapted", CPU, AdaptOptions(epochs=2, overwrite=True))


def test_what_cannot_be_adapted_is_refused(learned, data, tmp_path):
    few = tree(tmp_path / "few", classes=("walking",))
    with pytest.raises(ConfigError, match="has 8 images; should have at least 16"):
        adapt(learned, few, tmp_path / "no", CPU, AdaptOptions(epochs=1))
    with pytest.raises(RunError, match="is the run itself"):
        adapt(learned, data, learned, CPU)
