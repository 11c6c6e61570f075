"""Several processes: one network, one set of files, the gradient of the whole batch."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from learning.patterns import BASE, last_weights, trained, without_seconds

from radhar_cli.learning import run_files
from radhar_cli.learning import run_folder as run
from radhar_cli.learning.models.build import build_model
from radhar_cli.learning.run_folder import RunError

TESTS = Path(__file__).resolve().parents[1]

# Run by each of two processes: what a step leaves as the gradient, in several ways.
STEP = """
import copy, json, os, sys
from pathlib import Path
import numpy as np, torch, torch.distributed as dist
sys.path[:0] = [sys.argv[1], str(Path(sys.argv[1]).parent)]
from learning.patterns import Watched, settings
from radhar_cli.learning.batches import Reader
from radhar_cli.learning.machine import choose_execution_plan
from radhar_cli.learning.gradient_step import TrainStep
from radhar_cli.learning.process_group import Group, distributed, process_group
from radhar_cli.learning.training import Task, _Training, checked_images, train

data, out, answer = map(Path, sys.argv[2:])
torch.set_num_threads(1)
cpu, errors = torch.device("cpu"), {}

def gradients(model):
    return [p.grad.clone() for p in model.parameters()]

def worst(ours, theirs):
    return max(float((a - b).norm() / (b.norm() + 1e-7)) for a, b in zip(ours, theirs))

with process_group(cpu) as group:
    for name, micro_batch, count in (("whole", 8, 8), ("parts", 2, 8), ("uneven", 8, 7)):
        config = settings(batch_size=8, micro_batch=micro_batch, optimiser="sgd")
        place = out / name
        if group.is_main:
            place.mkdir(parents=True)
        dist.barrier()
        images = checked_images(config, data)
        plan = choose_execution_plan(config, cpu)
        work = _Training.prepared(Task(config, images, place), plan, group, Watched())
        rows = images.rows("train")[:count][::-1]
        levels = np.stack([images.pixels.read(int(r)).transpose(2, 0, 1) for r in rows])
        levels, labels = torch.from_numpy(levels), torch.from_numpy(images.label[rows].copy())
        mine = slice(group.rank, None, group.size)
        fresh = copy.deepcopy(work.model)
        network = distributed(work.model, cpu, group)
        alone = copy.copy(work)
        alone.group, alone.model = Group(), copy.deepcopy(fresh)
        alone.optimiser = torch.optim.SGD(alone.model.parameters(), 1e-3)
        work._train_step.step(network.eval(), work.optimiser, levels[mine], labels[mine], count)
        alone._train_step.step(alone.model.eval(), alone.optimiser, levels, labels, count)
        errors[f"{name} evaluation"] = worst(gradients(work.model), gradients(alone.model))
        if name == "whole":  # with batch norm at work: the average of the processes' own
            work.model.load_state_dict(fresh.state_dict())
            alone.model.load_state_dict(fresh.state_dict())
            step = work._train_step.step
            step(network.train(), work.optimiser, levels[mine], labels[mine], count)
            share = levels[mine], labels[mine], len(labels[mine])
            alone._train_step.step(alone.model.train(), alone.optimiser, *share)
            average = gradients(alone.model)
            for gradient in average:
                dist.all_reduce(gradient)
                gradient /= group.size
            errors["training"] = worst(gradients(work.model), average)
    seen = []
    def look(self, network, optimiser, levels, labels, whole):
        seen.append([whole, [hash(image.numpy().tobytes()) for image in levels]])
        return 0.0, 0
    TrainStep.step = look
    work._train_epoch(network, Reader(images.pixels, images.label, 0, False), 0)
    everyone = [None] * group.size
    dist.all_gather_object(everyone, seen)
    if group.is_main:
        answer.write_text(json.dumps({"errors": errors, "seen": everyone}))
    dist.barrier()
os._exit(0)  # threads of gloo may still run, which aborts an exit of the interpreter
"""


def torchrun(*arguments):
    command = [
        *(sys.executable, "-m", "torch.distributed.run", "--nproc-per-node", "2"),
        *("--standalone", "--local-addr", "127.0.0.1"),
        *map(str, arguments),
    ]
    return subprocess.run(
        command,
        capture_output=True,
        text=True,
        cwd=TESTS.parent,
        env={**os.environ, "PYTHONHASHSEED": "0"},
    )


def test_two_processes_have_the_gradient_of_one(data, tmp_path):
    script = tmp_path / "step.py"
    script.write_text(STEP)
    done = torchrun(script, TESTS, data, tmp_path / "runs", tmp_path / "answer.json")
    assert (tmp_path / "answer.json").exists(), done.stderr[-3000:]
    answer = json.loads((tmp_path / "answer.json").read_text())
    errors, (one, other) = answer["errors"], answer["seen"]
    assert set(errors) == {
        *("whole evaluation", "parts evaluation", "uneven evaluation", "training")
    }
    assert all(error < 1e-3 for error in errors.values()), errors
    for seen in (one, other):  # 12 images in batches of 8: each process half of every batch
        assert [(whole, len(images)) for whole, images in seen] == [(8, 4), (4, 2)]
    assert len({image for seen in (one, other) for _, images in seen for image in images}) == 12


@pytest.mark.slow
def test_two_processes_write_one_set_of_files_and_resume(data, run_dir, tmp_path):
    config, out = tmp_path / "train.json", tmp_path / "run"
    config.write_text(json.dumps(BASE))
    command = ("-m", "radhar_cli", "train", data, "-o", out, "--config", config)
    done = torchrun(*command)
    assert done.returncode == 0, done.stderr[-3000:]
    assert "2 processes" in done.stderr
    assert done.stdout.count("best epoch") == 1
    assert {p.name for p in out.iterdir()} - {".radhar"} == set(run_files.ALL)
    assert json.loads((out / run_files.METRICS).read_text())["processes"] == 2
    history = without_seconds(run.read_history(out))
    assert [row.epoch for row in history] == [1, 2, 3]
    for row in history:  # shared between the processes, and every image counted once
        assert 6 * row.val_accuracy == pytest.approx(round(6 * row.val_accuracy), abs=1e-9)
    assert run.load_best(out)[0].config == run.read_metadata(out).config
    assert list(last_weights(out)) == list(build_model("smallnet", 3, (32, 32)).state_dict())
    with pytest.raises(RunError) as caught:
        trained(data, out)
    assert "processes: 2 there, 1 here" in str(caught.value)
    again = torchrun(*command)
    assert again.returncode == 0, again.stderr[-3000:]
    assert "resuming: 3 of 3 epochs are done" in again.stderr
