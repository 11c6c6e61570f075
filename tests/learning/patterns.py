"""Trees of images that a network learns in seconds, and training runs of a second."""

import dataclasses
import math
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
import torch
from PIL import Image
from safetensors.torch import load_file

from radhar_cli.learning import run_files
from radhar_cli.learning import run_folder as run
from radhar_cli.learning.evaluation import last_features, open_for_model, predict_classes
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.training import train

SIZE = 32
CLASSES = ("kicking", "punching", "walking")  # by the alphabet, as trees are; S3, S2 and S8
BASE = {
    "model": "smallnet",
    "epochs": 3,
    "batch_size": 6,
    "optimiser": "adam",
    "learning_rate": 1e-3,
    "weight_decay": 1e-4,
    "schedule": {"kind": "step"},
    "warmup_epochs": 0.0,
    "device": "cpu",
    "precision": "float32",
    "threads": 1,
    "workers": 0,
}


def stripes(kind, rng, size=SIZE):
    """An image [H, W, 3] whose stripes lie in a direction of their class."""
    height, width = (size, size) if isinstance(size, int) else size
    y, x = np.mgrid[:height, :width]
    turn = math.pi * kind / 4
    wave = np.sin(2 * math.pi * (x * math.cos(turn) + y * math.sin(turn)) / 8 + rng.uniform(0, 6))
    levels = 128 + 80 * wave[..., None] * [1.0, 0.7, 0.4] + rng.normal(0, 20, (height, width, 3))
    return np.clip(levels, 0, 255).astype(np.uint8)


def tree(root, classes=CLASSES, parts=None, size=SIZE, seed=0):
    """Write <part>/<class>/<number>.png; without parts <class>/<number>.png, eight a class.

    The pattern belongs to the name, wherever it stands in the list.
    """
    rng = np.random.default_rng(seed)
    for part, count in (parts if parts is not None else {"": 8}).items():
        for name in classes:
            folder = root / part / name
            folder.mkdir(parents=True)
            for number in range(count):
                kind = CLASSES.index(name) if name in CLASSES else sum(name.encode()) % 4
                Image.fromarray(stripes(kind, rng, size)).save(folder / f"{number:03d}.png")
    return root


def split_tree(root, train=4, val=2, **more):
    """The tree that most tests learn from."""
    return tree(root, parts={"train": train, "val": val}, **more)


def settings(**changes):
    return TrainConfig.model_validate({**BASE, **changes})


class Watched:
    """A progress that remembers, and raises after an epoch if asked to."""

    def __init__(self, stop_after=0, error=KeyboardInterrupt):
        self.messages: list[str] = []
        self.losses: list[float] = []
        self.best: list[bool] = []
        self.steps: list[int] = []
        self.stop_after, self.error = stop_after, error

    def say(self, message):
        self.messages.append(message)

    def epoch(self, number, epochs, steps):
        self.steps.append(steps)

    def step(self, loss, accuracy):
        self.losses.append(loss)

    def epoch_done(self, row, best):
        self.best.append(best)
        if row.epoch == self.stop_after:
            raise self.error


def trained(data, out, progress=None, **changes):
    """Train with the tiny settings."""
    return train(settings(**changes), data, out, progress or Watched())


def plant(out, data, margin=5.0):
    """Give a run a last layer that is right about every image of a set, by a margin of its logits.

    logits = W (f - mean f), W by least squares: whatever the layers before it have learned, they
    tell a few images apart.
    """
    metadata, model = run.load_best(out)
    images = open_for_model(metadata, data, None)
    found = predict_classes(model, metadata, images, images.rows("all"), torch.device("cpu"), 8)
    features = last_features(model, metadata, images, found.rows, torch.device("cpu"))
    middle = features.mean(axis=0)
    wanted = margin * (np.eye(len(metadata.classes))[found.truth] - 1 / len(metadata.classes))
    weight = (np.linalg.pinv(features - middle) @ wanted).T
    head: Any = model.head
    head.weight.data = torch.tensor(weight, dtype=torch.float32)
    head.bias.data = torch.tensor(-weight @ middle, dtype=torch.float32)
    run.write_best(out, metadata, run.best_epoch(run.read_history(out)), model.state_dict())


def best_weights(out):
    return load_file(out / run_files.BEST)


def last_weights(out):
    found: dict[str, torch.Tensor] = torch.load(out / run_files.LAST, weights_only=True)["model"]
    return found


def same(one, other):
    return list(one) == list(other) and all(torch.equal(one[k], other[k]) for k in one)


def without_seconds(history):
    return [dataclasses.replace(row, seconds=0.0) for row in history]


def same_run(one, other):
    """Whether two folders hold the same weights and history, but for the time they took."""
    histories = [without_seconds(run.read_history(folder)) for folder in (one, other)]
    return (
        same(best_weights(one), best_weights(other))
        and same(last_weights(one), last_weights(other))
        and histories[0] == histories[1]
    )


@contextmanager
def clear_line(kind, *words):
    """What ends the program with status 2, by an error of a kind that names what matters."""
    with pytest.raises(kind) as caught:
        yield
    one_clear_line(caught.value, *words)


def one_clear_line(error, *words):
    """An error that the program ends with status 2 on, which names what matters."""
    assert error.status == 2
    for word in words:
        assert str(word) in str(error), str(error)
