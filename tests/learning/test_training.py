"""Training: what a step does; config and data alone determine the weights."""

import json
import math
import subprocess
import sys
import time

import numpy as np
import pytest
import torch
from helpers.slow import slow
from learning.patterns import (
    BASE,
    Watched,
    best_weights,
    clear_line,
    last_weights,
    one_clear_line,
    same,
    same_run,
    settings,
    trained,
    tree,
    without_seconds,
)
from torch import nn

from radhar_cli.learning import run_files, training
from radhar_cli.learning import run_folder as run
from radhar_cli.learning.batches import Normalisation
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.images.scan import scan
from radhar_cli.learning.intervals import wilson
from radhar_cli.learning.learner import Learner, Totals
from radhar_cli.learning.models.build import build_model
from radhar_cli.learning.optimiser import optimiser_for
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.tasks import categories
from radhar_cli.learning.tasks.task import create_task
from radhar_cli.learning.training import TrainingError, _Training
from radhar_cli.learning.training_set import open_training_set


def learner_of(data, **changes):
    """What `train` makes of some settings before its first step."""
    config = settings(**changes)
    images = open_training_set(config, data)
    task, found = create_task(config), scan(images, images.rows("train"))
    torch.manual_seed(config.seed)
    model = build_model(config.model, task.outputs(images), images.size)
    normalise = Normalisation(found.mean, found.sd)
    return Learner(model, task, normalise, torch.device("cpu"), torch.float32)


def first_batch(data, count=6):
    images = open_training_set(settings(), data)
    rows = images.rows("train")[::2][:count]
    levels = np.stack([images.pixels.read(int(row)).transpose(2, 0, 1) for row in rows])
    return torch.from_numpy(levels), torch.from_numpy(images.samples.label[rows])


def gradients(model):
    return [p.grad.clone() for p in model.parameters() if p.grad is not None]


def test_files_of_a_run(run_dir, data):
    assert {p.name for p in run_dir.iterdir()} - {".radhar", "eval"} == set(run_files.ALL)
    metrics = json.loads((run_dir / run_files.METRICS).read_text())
    history = run.read_history(run_dir)
    best = run.best_epoch(history)
    assert [row.epoch for row in history] == [1, 2, 3]
    assert metrics["best_epoch"] == best.epoch
    assert metrics["val_accuracy"] == best.val_accuracy
    assert (metrics["device"], metrics["precision"]) == ("cpu", "float32")
    assert metrics["classes"] == ["kicking", "punching", "walking"]
    assert (metrics["data"]["train"], metrics["data"]["val"]) == (12, 6)
    assert metrics["data"]["path"] == str(data)
    assert (run_dir / run_files.CURVES).read_bytes().startswith(b"\x89PNG")
    lines = (run_dir / run_files.TRAINED_ON).read_text().splitlines()
    assert len(lines) == 1 + 12 + 6
    assert lines[1].startswith("kicking/000,")
    assert [line.rpartition(",")[2] for line in lines[1:]] == ["train"] * 12 + ["val"] * 6
    right = round(6 * best.val_accuracy)
    assert metrics["val_accuracy_95"] == pytest.approx(list(wilson(right, 6)))
    assert metrics["interval_over"] == {"kind": "sample", "count": 6}
    assert metrics["epoch_chosen_by"] == "val"


def test_normalisation_is_of_the_training_images_alone(run_dir, data):
    images, metadata = open_images(data, None, "rgb"), run.read_metadata(run_dir)
    found = scan(images, images.rows("train"))
    assert metadata.mean == found.mean
    assert metadata.sd == found.sd
    assert metadata.mean != scan(images, images.rows("all")).mean


def test_same_seed_same_weights_another_seed_others(data, run_dir, tmp_path):
    trained(data, tmp_path / "again")
    assert same_run(run_dir, tmp_path / "again")
    trained(data, tmp_path / "other", seed=2, epochs=1)
    assert not same(best_weights(run_dir), best_weights(tmp_path / "other"))


def test_reading_by_workers_gives_the_same(data, run_dir, tmp_path):
    trained(data, tmp_path / "run", workers=2)
    assert same_run(run_dir, tmp_path / "run")


@pytest.mark.parametrize("epoch", [1, 2])
def test_resumed_after_an_epoch_gives_the_same_run(data, run_dir, tmp_path, epoch):
    out = tmp_path / "run"
    with pytest.raises(KeyboardInterrupt):
        trained(data, out, Watched(stop_after=epoch))
    assert len(run.read_history(out)) == epoch
    progress = Watched()
    done = trained(data, out, progress)
    assert done.resumed == epoch
    assert len(progress.best) == 3 - epoch
    assert any("resuming" in line for line in progress.messages)
    assert same_run(run_dir, out)


def test_dropout_resumes_its_random_state(data, tmp_path, monkeypatch):
    def with_dropout(name, outputs, size):
        return nn.Sequential(
            nn.Conv2d(3, 4, 3, 4),
            nn.Flatten(),
            nn.Dropout(0.5),
            nn.Linear(4 * 8 * 8, outputs.count),
        )

    for module in (training, run):
        monkeypatch.setattr(module, "build_model", with_dropout)
    trained(data, tmp_path / "whole")
    with pytest.raises(KeyboardInterrupt):
        trained(data, tmp_path / "stopped", Watched(stop_after=2))
    trained(data, tmp_path / "stopped")
    assert same_run(tmp_path / "whole", tmp_path / "stopped")


def test_stopped_between_the_files_of_the_last_epoch_loses_nothing(
    data, run_dir, tmp_path, monkeypatch
):
    """last.ckpt has the last epoch, history.csv not yet."""
    out, write = tmp_path / "run", run.write_history

    def stops(folder, history):
        if len(history) == 3:
            raise KeyboardInterrupt
        write(folder, history)

    monkeypatch.setattr(run, "write_history", stops)
    with pytest.raises(KeyboardInterrupt):
        trained(data, out)
    monkeypatch.undo()
    trained(data, out)
    assert same_run(run_dir, out)


def test_only_a_better_epoch_replaces_the_best(data, tmp_path, monkeypatch):
    seen = iter([(1.0, 0.5), (2.0, 0.75), (1.5, 0.75), (9.0, 0.5)])
    monkeypatch.setattr(_Training, "_validate", lambda *_: Totals(*next(seen), 1))
    kept = {}

    class Keeps(Watched):
        def epoch_done(self, row, best):
            super().epoch_done(row, best)
            kept[row.epoch] = last_weights(tmp_path / "run")

    progress = Keeps()
    done = trained(data, tmp_path / "run", progress, epochs=4)
    assert progress.best == [True, True, True, False]
    assert done.best.epoch == 3
    assert same(dict(sorted(best_weights(tmp_path / "run").items())), dict(sorted(kept[3].items())))


class KeepsLast(Watched):
    """Remembers the weights, not averaged, after each epoch."""

    def __init__(self, out):
        super().__init__()
        self.out, self.weights = out, list[dict[str, torch.Tensor]]()

    def epoch_done(self, row, best):
        super().epoch_done(row, best)
        self.weights.append(last_weights(self.out))


def test_weights_of_the_last_steps_are_averaged(data, tmp_path, monkeypatch):
    losses = iter([4.0, 3.0, 2.0, 1.0])
    monkeypatch.setattr(_Training, "_validate", lambda *_: Totals(next(losses), 0.5, 1))
    progress = KeepsLast(tmp_path / "run")
    trained(data, tmp_path / "run", progress, epochs=4, batch_size=12, average_last=0.5)
    assert len(progress.losses) == 4  # one step an epoch
    third, fourth = progress.weights[2:]
    for name, weights in best_weights(tmp_path / "run").items():
        if weights.is_floating_point() and "running" not in name:
            torch.testing.assert_close(weights, (third[name] + fourth[name]) / 2)


def test_statistics_of_averaged_weights_are_those_of_stored_images(data, tmp_path):
    """Not of the augmented ones, nor of other weights: what eval shows the network is clean."""
    changes = {"augment": {"noise": 1.0, "contrast": 0.9}, "input": "gray", "batch_size": 12}
    changes |= {"model": "smallnet_bn"}
    trained(data, tmp_path / "run", average_last=0.5, **changes)
    metadata, model = run.load_best(tmp_path / "run")
    images = open_images(data, None, "gray")
    levels = np.stack([images.pixels.read(int(row)) for row in images.rows("train")])
    assert len(levels) % 12 == 0, "batches of one size weigh the same"
    x = metadata.normalisation(torch.tensor(levels).permute(0, 3, 1, 2))
    convolution, norm = next(iter(model.layers))[:2]
    with torch.no_grad():
        features = convolution(x)
    mean, variance = features.mean((0, 2, 3)), features.var((0, 2, 3))
    torch.testing.assert_close(norm.running_mean, mean, rtol=1e-3, atol=1e-4)
    torch.testing.assert_close(norm.running_var, variance, rtol=0.1, atol=1e-3)


@pytest.mark.parametrize(("images", "size"), [(8, 4), (60, 4), (192, 8), (2000, 64), (10**5, 128)])
def test_the_batch_follows_from_the_number_of_images(images, size):
    assert TrainConfig().with_batch_size_for(images).images_a_step == size
    assert TrainConfig(batch_size=32).with_batch_size_for(images).images_a_step == 32


@pytest.mark.parametrize(("size", "warned"), [(12, True), (2, False)])
def test_few_steps_an_epoch_are_warned_of(tmp_path, size, warned):
    progress = Watched()
    images = tree(tmp_path / "tree", parts={"train": 10, "val": 1})
    trained(images, tmp_path / "run", progress, epochs=1, batch_size=size)
    said = [line for line in progress.messages if "steps an epoch" in line]
    assert bool(said) == warned
    if warned:
        assert "batch_size = 12: 30 images make 3 steps" in said[0]


def test_averages_go_on_as_if_they_had_never_stopped(data, tmp_path):
    trained(data, tmp_path / "whole", average_last=0.6)
    with pytest.raises(KeyboardInterrupt):
        trained(data, tmp_path / "stopped", Watched(stop_after=2), average_last=0.6)
    trained(data, tmp_path / "stopped", average_last=0.6)
    assert same_run(tmp_path / "whole", tmp_path / "stopped")
    trained(data, tmp_path / "plain")
    assert same(last_weights(tmp_path / "plain"), last_weights(tmp_path / "whole"))
    assert not same(best_weights(tmp_path / "plain"), best_weights(tmp_path / "whole"))


def test_validation_is_that_of_the_stored_weights(data, run_dir):
    """Loss with label smoothing and accuracy of the last epoch, worked out anew."""
    metadata, model = run.load_best(run_dir)
    model.load_state_dict(last_weights(run_dir))
    images = open_images(data, None, "rgb")
    rows = images.rows("val")
    levels = np.stack([images.pixels.read(int(row)) for row in rows]) / 255
    x = ((levels - metadata.mean) / metadata.sd).transpose(0, 3, 1, 2)
    with torch.no_grad():
        logits = model(torch.tensor(x, dtype=torch.float32)).double()
    truth = torch.from_numpy(images.samples.label[rows])
    wanted = nn.functional.one_hot(truth, 3) * (1 - 0.1) + 0.1 / 3
    loss = -(wanted * logits.log_softmax(1)).sum(1).mean()
    last = run.read_history(run_dir)[-1]
    assert last.val_loss == pytest.approx(float(loss), rel=1e-5)
    assert last.val_accuracy == float((logits.argmax(1) == truth).double().mean())


def test_a_step_starts_from_zero_gradient(data):
    work = learner_of(data, learning_rate=1e-12, optimiser="sgd")
    levels, labels = first_batch(data)
    work.model.eval()
    work.train_step(levels, labels)
    once = gradients(work.model)
    work.train_step(levels, labels)
    for one, other in zip(once, gradients(work.model), strict=True):
        torch.testing.assert_close(one, other, rtol=1e-4, atol=1e-7)


def test_out_of_memory_names_a_smaller_batch(data, tmp_path, monkeypatch):
    """An allocation of 2**60 bytes, which PyTorch refuses at once."""
    monkeypatch.setattr(categories, "cross_entropy", lambda *_, **__: torch.empty(2**58))
    with pytest.raises(TrainingError, match=r"out of memory on cpu in .* 6 images .*batch_size=3"):
        trained(data, tmp_path / "run", batch_size=6)


def test_clipping_limits_the_gradient(data):
    free = learner_of(data, optimiser="sgd", weight_decay=0.0)
    held = learner_of(data, optimiser="sgd", weight_decay=0.0, gradient_clip_norm=0.01)
    levels, labels = first_batch(data)
    moved = []
    for work in (free, held):
        before = [p.detach().clone() for p in work.model.parameters()]
        work.model.train()
        work.train_step(levels, labels)
        steps = [p.detach() - b for p, b in zip(work.model.parameters(), before, strict=True)]
        moved.append(float(torch.linalg.vector_norm(torch.cat([s.flatten() for s in steps]))))
    assert moved[0] > 2e-5
    assert moved[1] == pytest.approx(1e-3 * 0.01, rel=0.05)


def test_weight_decay_spares_biases_and_norms(data):
    work = learner_of(data, weight_decay=0.5)
    for name in ("adam", "adamw", "sgd"):
        optimiser = optimiser_for(settings(weight_decay=0.5, optimiser=name), work.model)
        decayed = {
            id(p) for g in optimiser.param_groups if g["weight_decay"] == 0.5 for p in g["params"]
        }
        spared = {
            id(p) for g in optimiser.param_groups if g["weight_decay"] == 0.0 for p in g["params"]
        }
        for layer in work.model.modules():
            for key, parameter in layer.named_parameters(recurse=False):
                free = key == "bias" or isinstance(layer, nn.GroupNorm)
                assert id(parameter) in (spared if free else decayed), (layer, key)
        assert len(decayed | spared) == len(list(work.model.parameters()))
    assert isinstance(optimiser_for(settings(), work.model), torch.optim.Adam)


def test_rates_of_the_schedule_reach_the_optimiser(data, tmp_path, monkeypatch):
    used, step = [], torch.optim.Adam.step

    def watched(self, *rest):
        used.append([g["lr"] for g in self.param_groups])
        return step(self, *rest)

    monkeypatch.setattr(torch.optim.Adam, "step", watched)
    schedule = {"kind": "step", "every_epochs": 2, "factor": 0.5}
    trained(data, tmp_path / "run", schedule=schedule, warmup_epochs=1.0)
    # Two steps an epoch: half and the whole of the warm-up, then the schedule.
    np.testing.assert_allclose(used, [[5e-4] * 2] + [[1e-3] * 2] * 3 + [[5e-4] * 2] * 2)
    assert run.read_history(tmp_path / "run")[2].learning_rate == 5e-4


@pytest.mark.parametrize("model_step", [1, 4])
def test_a_non_finite_loss_is_one_clear_line(data, tmp_path, monkeypatch, model_step):
    """Two steps an epoch: the first is of the first epoch, the fourth the last of the second."""
    out, calls = tmp_path / "run", []
    loss = categories.cross_entropy

    def sometimes(logits, *rest, **more):
        calls.append(torch.is_grad_enabled())
        found = loss(logits, *rest, **more)
        return found * math.nan if sum(calls) == model_step else found

    monkeypatch.setattr(categories, "cross_entropy", sometimes)
    with pytest.raises(TrainingError) as caught:
        trained(data, out)
    monkeypatch.undo()
    if model_step == 1:
        one_clear_line(caught.value, "epoch 1, step 1", "nan", "no epoch was finished")
        assert not (out / run_files.BEST).exists()
    else:
        one_clear_line(caught.value, "epoch 2, step 2", "hold the epochs up to 1", "0.001")
        assert len(run.read_history(out)) == 1
        run.load_best(out)
        assert trained(data, out).resumed == 1


def test_a_non_finite_validation_loss_is_one_clear_line(data, tmp_path, monkeypatch):
    loss = categories.cross_entropy

    def only_training(logits, *rest, **more):
        found = loss(logits, *rest, **more)
        return found if torch.is_grad_enabled() else found * math.inf

    monkeypatch.setattr(categories, "cross_entropy", only_training)
    with clear_line(TrainingError, "validation of epoch 1", "inf"):
        trained(data, tmp_path / "run")


def test_a_batch_of_one_image_is_refused():
    with pytest.raises(ValueError, match=r"(?s)batch_size.*2"):
        settings(batch_size=1)


def test_gray_and_bfloat16_train(data, tmp_path):
    trained(data, tmp_path / "run", epochs=1, input="gray", precision="bfloat16")
    metadata = run.read_metadata(tmp_path / "run")
    assert metadata.input == "gray"
    assert metadata.channels == len(metadata.mean) == len(metadata.sd) == 1
    assert all(w.dtype != torch.bfloat16 for w in best_weights(tmp_path / "run").values())


def command(data, out):
    config = out.parent / "train.json"
    config.write_text(json.dumps(BASE))
    return [
        *(sys.executable, "-m", "radhar_cli", "train", str(data), "-o", str(out)),
        *("--config", str(config)),
    ]


def started(data, out, until, *more):
    """Start a run, and wait until a file of it is there: the program is well under way."""
    process = subprocess.Popen(
        [*command(data, out), *more],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    while process.poll() is None and not (out / until).exists():
        time.sleep(0.01)
    return process


LATER = (run_files.BEST, run_files.LAST, run_files.HISTORY, run_files.CURVES)


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
@pytest.mark.parametrize("sign", [run_files.ABOUT, *slow(LATER)])
def test_killed_and_resumed_gives_the_same_run(data, run_dir, tmp_path, sign):
    """As soon as a file of the run is there, or some moments later."""
    out = tmp_path / "run"
    process = started(data, out, sign)
    process.kill()
    process.communicate()
    done = trained(data, out)
    assert len(done.history) == 3
    assert same_run(run_dir, out)
    assert without_seconds(done.history) == without_seconds(run.read_history(run_dir))
