"""What every task of `TASKS` promises, and the table of samples that targets are made of."""

import numpy as np
import pytest
import torch

from radhar_cli.errors import ConfigError
from radhar_cli.learning.batches import Normalisation
from radhar_cli.learning.images.sample_table import SampleTable, objects
from radhar_cli.learning.models.build import build_model
from radhar_cli.learning.models.outputs import OutputShape
from radhar_cli.learning.registry import TASKS
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.tasks.categories import Classifier, require_classifier
from radhar_cli.learning.tasks.task import create_task

BATCH, FRAMES = 5, 4


class Known:
    classes = ("walking", "punching", "kicking")
    joints = ("head", "neck")


# Frames have a network of their own, and tests: tests/learning/test_frames.py.
OF_SAMPLES = [name for name in TASKS if name != "frames"]


def task_and_model(target):
    sequences = TASKS[target].of_sequences
    task = create_task(TrainConfig(target=target, model="cloudnet" if sequences else "smallnet"))
    size = (FRAMES, 8) if sequences else (16, 16)
    return task, build_model(task.settings.model, task.outputs(Known()), size).eval()


def targets_of(target):
    generator = torch.Generator().manual_seed(0)
    if target == "skeleton":
        joints = torch.randn(BATCH, FRAMES, len(Known.joints), 3, generator=generator)
        joints[1, 2:] = torch.nan
        return joints
    if target == "labels":
        return torch.randint(2, (BATCH, len(Known.classes)), generator=generator)
    return torch.randint(len(Known.classes), (BATCH,), generator=generator)


@pytest.mark.parametrize("target", OF_SAMPLES)
def test_loss_and_score_are_of_each_input_alone(target):
    task, model = task_and_model(target)
    shape = (6, FRAMES, 8) if task.outputs(Known()).shape is OutputShape.PLACES else (3, 16, 16)
    with torch.no_grad():
        outputs = model(torch.randn(BATCH, *shape, generator=torch.Generator().manual_seed(1)))
    targets = targets_of(target)
    loss, score = task.loss(outputs, targets), task.score(outputs, targets)
    assert loss.shape == score.shape == (BATCH,)
    assert ((score >= 0) & (score <= 1)).all()
    assert loss.isfinite().all()
    assert len(task.predict(outputs)) == BATCH
    order = torch.tensor([3, 0, 4, 1, 2])
    torch.testing.assert_close(task.loss(outputs[order], targets[order]), loss[order])
    assert torch.equal(task.score(outputs[order], targets[order]), score[order])


@pytest.mark.parametrize("target", OF_SAMPLES)
def test_what_is_exactly_right_scores_one(target):
    task, targets = create_task_of(target), targets_of(target)
    if target == "skeleton":
        outputs = targets.nan_to_num()
    elif target == "labels":
        outputs = 20.0 * (2 * targets - 1)
    else:
        outputs = 20.0 * torch.nn.functional.one_hot(targets, len(Known.classes))
    assert task.score(outputs, targets).tolist() == [1.0] * BATCH
    if isinstance(task, Classifier):
        torch.testing.assert_close(task.predict(outputs).sum(1), torch.ones(BATCH))


def create_task_of(target):
    return task_and_model(target)[0]


@pytest.mark.parametrize("target", OF_SAMPLES)
def test_only_classifiers_can_be_adapted(target, tmp_path):
    task = create_task_of(target)
    if target in ("classes", "count", "person"):
        assert require_classifier(tmp_path, task) is task
    else:
        with pytest.raises(ConfigError, match="should be a run of classes"):
            require_classifier(tmp_path, task)


def test_rows_are_taken_of_every_column_or_of_none():
    table = SampleTable(
        label=np.array([2, 0, 1]),
        name=objects("abc"),
        source=np.array([0, 0, 1]),
        activities=objects([("walking", "kicking"), ("kicking",), ("punching", "walking")]),
    )
    taken = table.take(np.array([2, 2, 0]))
    assert taken.label.tolist() == [1, 1, 2]
    assert taken.name.tolist() == ["c", "c", "a"]
    assert taken.source.tolist() == [1, 1, 0]
    assert taken.activities.tolist() == [("punching", "walking")] * 2 + [("walking", "kicking")]
    assert taken.split is taken.scene is taken.person is None
    assert len(taken) == 3


def test_one_channel_is_repeated_for_a_network_of_three():
    levels = torch.arange(2 * 4 * 5, dtype=torch.uint8).view(2, 1, 4, 5)
    gray = Normalisation((0.4,), (0.2,), channels=3)(levels)
    rgb = Normalisation((0.4,) * 3, (0.2,) * 3, channels=3)(levels.repeat(1, 3, 1, 1))
    assert torch.equal(gray, rgb)
    assert Normalisation((0.4,), (0.2,), channels=1)(levels).shape == levels.shape
