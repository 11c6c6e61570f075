"""Training and evaluation on a GPU with CUDA, beside the CPU; skipped where there is none."""

import json

import numpy as np
import pytest
import torch
from helpers.command_line import ok
from learning.patterns import Watched, best_weights, same, same_run, trained, tree

import radhar_cli
from radhar_cli.learning import run_folder as run
from radhar_cli.learning.adaptation import AdaptOptions, adapt
from radhar_cli.learning.batches import Normalisation
from radhar_cli.learning.evaluation import (
    last_features,
    measure_speed,
    open_for_model,
    predict_classes,
)
from radhar_cli.learning.learner import Learner
from radhar_cli.learning.machine import choose_device, choose_precision, reading_workers
from radhar_cli.learning.models.build import build_model
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.tasks.task import create_task
from radhar_cli.learning.training import TrainingError

CPU, GPU = torch.device("cpu"), torch.device("cuda")
IMAGE_NETWORKS = ("smallnet", "smallnet_bn", "fftnet")

pytestmark = pytest.mark.skipif(not torch.cuda.is_available(), reason="needs a GPU")


class Known:
    classes = ("walking", "punching", "kicking")
    joints = ("head", "neck")
    frame_classes = ("walking", "punching", "none")


def inputs_of(model, generator):
    """Levels or clouds of a batch, and the size that the network is built for."""
    if model == "cloudnet":
        clouds = torch.randn(6, 6, 5, 8, generator=generator)
        clouds[:, -1] = (clouds[:, -1] > 0).float()
        return clouds * clouds[:, -1:], (5, 8)
    shape = {"framenet": (6, 5, 16, 24)}.get(model, (6, 3, 32, 32))
    return torch.randint(256, shape, generator=generator, dtype=torch.uint8), shape[-2:]


def first_steps(model, target, device, precision, count=3):
    """Losses of the first steps on a batch, and the weights after them."""
    generator = torch.Generator().manual_seed(1)
    levels, size = inputs_of(model, generator)
    task = create_task(TrainConfig.model_validate({"model": model, "target": target}))
    if target == "skeleton":
        targets = torch.randn(6, 5, len(Known.joints), 3, generator=generator)
        targets[1, 3:] = torch.nan
    else:
        targets = torch.randint(len(Known.classes), (6,), generator=generator)
    torch.manual_seed(1)
    network = build_model(model, task.outputs(Known()), size).train()
    normalise = (
        Normalisation((0.5,) * 3, (0.3,) * 3)
        if levels.shape[1] == 3
        else Normalisation((0.5,), (0.3,))
    )
    learner = Learner(network, task, normalise, device, precision)
    losses = [learner.train_step(levels, targets)[0] for _ in range(count)]
    return losses, {name: value.cpu() for name, value in network.state_dict().items()}


@pytest.mark.parametrize(
    ("model", "target"),
    [
        *((model, "classes") for model in IMAGE_NETWORKS),
        ("cloudnet", "classes"),
        ("cloudnet", "skeleton"),
        ("framenet", "skeleton"),
    ],
)
def test_a_step_in_float32_is_that_of_the_cpu(model, target):
    """The first loss to rounding; later ones as far as Adam, which scales gradients, allows."""
    choose_device("cuda")
    ours, _ = first_steps(model, target, GPU, torch.float32)
    theirs, _ = first_steps(model, target, CPU, torch.float32)
    assert ours[0] == pytest.approx(theirs[0], rel=1e-4)
    assert ours == pytest.approx(theirs, rel=0.03)
    assert ours[2] != ours[0]


@pytest.mark.parametrize("model", IMAGE_NETWORKS)
def test_bfloat16_keeps_weights_in_float32_and_is_near(model):
    ours, weights = first_steps(model, "classes", GPU, torch.bfloat16)
    theirs, _ = first_steps(model, "classes", GPU, torch.float32)
    assert ours[0] == pytest.approx(theirs[0], rel=0.03)
    assert ours[0] != theirs[0]
    assert all(w.dtype == torch.float32 for w in weights.values() if w.is_floating_point())


def test_auto_takes_the_gpu_and_bfloat16_where_it_computes_in_it():
    assert choose_device("auto") == GPU
    native = torch.cuda.get_device_capability() >= (8, 0)
    assert choose_precision("auto", GPU) == (torch.bfloat16 if native else torch.float32)
    assert reading_workers("auto", GPU) >= 1
    assert reading_workers(0, GPU) == 0


@pytest.mark.parametrize("precision", ["float32", "bfloat16"])
@pytest.mark.parametrize("model", IMAGE_NETWORKS)
def test_two_runs_on_one_card_are_the_same_bit_for_bit(data, tmp_path, model, precision):
    for name in ("one", "two"):
        trained(data, tmp_path / name, device="cuda", model=model, precision=precision)
    assert same_run(tmp_path / "one", tmp_path / "two")
    weights = best_weights(tmp_path / "one")
    trained(data, tmp_path / "other", device="cuda", model=model, precision=precision, seed=2)
    assert not same(weights, best_weights(tmp_path / "other"))


@pytest.mark.parametrize("model", ["smallnet", "fftnet"])
def test_a_run_learns_what_it_learns_on_the_cpu(data, tmp_path, model):
    histories = [
        trained(data, tmp_path / device, device=device, model=model).history
        for device in ("cpu", "cuda")
    ]
    for cpu, cuda in zip(*histories, strict=True):
        assert cuda.learning_rate == cpu.learning_rate
    assert histories[1][0].train_loss == pytest.approx(histories[0][0].train_loss, rel=0.02)
    assert histories[1][-1].train_loss < histories[1][0].train_loss
    metrics = json.loads((tmp_path / "cuda" / "metrics.json").read_text())
    assert (metrics["device"], metrics["precision"]) == ("cuda", "float32")


@pytest.mark.parametrize("model", ["smallnet", "fftnet", "tcn"])
def test_a_stopped_run_resumes_on_the_gpu_as_if_it_had_not(data, tmp_path, model):
    """tcn has dropout, whose random numbers are the GPU's own."""
    changes = {"device": "cuda", "model": model, "precision": "bfloat16", "average_last": 0.5}
    trained(data, tmp_path / "whole", **changes)
    with pytest.raises(KeyboardInterrupt):
        trained(data, tmp_path / "run", Watched(stop_after=2), **changes)
    assert trained(data, tmp_path / "run", **changes).resumed == 2
    assert same_run(tmp_path / "whole", tmp_path / "run")


def test_a_run_begun_on_the_gpu_goes_on_on_the_cpu_and_back(data, tmp_path):
    for first, second in (("cuda", "cpu"), ("cpu", "cuda")):
        out = tmp_path / first
        with pytest.raises(KeyboardInterrupt):
            trained(data, out, Watched(stop_after=1), device=first)
        done = trained(data, out, device=second)
        assert done.resumed == 1
        assert len(done.history) == 3
    a, b = (best_weights(tmp_path / name) for name in ("cuda", "cpu"))
    assert list(a) == list(b)


def test_reading_by_workers_into_pinned_memory_gives_the_same(data, tmp_path):
    trained(data, tmp_path / "none", device="cuda", workers=0)
    trained(data, tmp_path / "two", device="cuda", workers=2)
    assert same_run(tmp_path / "none", tmp_path / "two")


@pytest.mark.parametrize("model", IMAGE_NETWORKS)
def test_a_run_finds_the_same_on_either_device(data, tmp_path, model):
    trained(data, tmp_path / "run", device="cuda", model=model)
    metadata, network = run.load_best(tmp_path / "run")
    images = open_for_model(metadata, data, None)
    rows = images.rows("all")
    found, features = [], []
    for device in (CPU, choose_device("cuda")):
        network.to(device)
        found.append(predict_classes(network, metadata, images, rows, device, 4))
        features.append(last_features(network, metadata, images, rows, device))
    np.testing.assert_allclose(found[1].values, found[0].values, atol=1e-4)
    np.testing.assert_allclose(features[1], features[0], rtol=1e-3, atol=1e-3)
    by_device = [
        radhar_cli.load_run(tmp_path / "run", device=name).predict(data, split="all").probabilities
        for name in ("cpu", "cuda")
    ]
    np.testing.assert_allclose(by_device[1], by_device[0], atol=1e-4)


def test_commands_run_on_the_gpu(data, tmp_path):
    on_gpu = ("--set", "device=cuda", "--set", "epochs=2", "--set", "batch_size=6")
    ok("train", data, "-o", tmp_path / "run", "--model", "fftnet", *on_gpu)
    for device in ("cuda", "cpu"):
        options = ("--device", device, "--batch", "4", "--tsne")
        ok("eval", tmp_path / "run", data, "-o", tmp_path / device, *options)
    reports = [json.loads((tmp_path / d / "report.json").read_text()) for d in ("cuda", "cpu")]
    assert [report["device"] for report in reports] == ["cuda", "cpu"]
    results = [part for r in reports for part in r["runs"]["run"]["data"].values()]
    assert results[0]["confusion"] == results[1]["confusion"]
    lines = [
        ok("predict", tmp_path / "run", data, "--device", device).stdout.splitlines()
        for device in ("cuda", "cpu")
    ]
    assert len(lines[0]) == len(lines[1]) > 6


def test_speed_is_of_answers_that_have_arrived(data, run_dir):
    metadata, _ = run.load_best(run_dir)
    images = open_for_model(metadata, data, None)
    speed = measure_speed(run_dir, images, 0, GPU, 4)
    assert 0 < speed["image_s"] < speed["load_and_image_s"]
    assert speed["images_per_s"] > speed["images_per_s_with_loading"] > 0


@pytest.mark.parametrize(("model", "epochs"), [("smallnet", 2), ("smallnet_bn", 0)])
def test_adaptation_on_the_gpu_changes_weights_as_on_the_cpu(data, tmp_path, model, epochs):
    trained(data, tmp_path / "run", device="cuda", model=model, epochs=1)
    measured = tree(tmp_path / "measured", seed=5)
    options = AdaptOptions(epochs=epochs, mix=(data,) if epochs else ())
    for device in (CPU, choose_device("cuda")):
        adapt(tmp_path / "run", measured, tmp_path / device.type, device, options)
    start = best_weights(tmp_path / "run")
    cuda, cpu = (
        torch.cat([(weights[name] - start[name]).flatten() for name in start if "num" not in name])
        for weights in (best_weights(tmp_path / name) for name in ("cuda", "cpu"))
    )
    assert float(cpu.norm()) > 0
    assert float((cuda - cpu).norm() / cpu.norm()) < 0.2


def test_a_step_too_large_for_the_card_says_what_would_fit(data, tmp_path):
    torch.cuda.empty_cache()
    torch.cuda.set_per_process_memory_fraction(1e-4)
    try:
        with pytest.raises(TrainingError, match=r"out of memory on cuda.*--set batch_size=6"):
            trained(data, tmp_path / "run", device="cuda", model="fftnet", batch_size=12)
    finally:
        torch.cuda.set_per_process_memory_fraction(1.0)
