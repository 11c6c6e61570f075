"""A network and a task of the user's: a file, and a line each."""

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import torch
from helpers.command_line import radhar
from learning.patterns import split_tree

import radhar_cli
from radhar_cli import extensions
from radhar_cli.learning.registry import NETWORKS, TASKS

QUICK = (
    *("device=cpu", "precision=float32", "threads=1", "input=gray", "epochs=20"),
    *("learning_rate=0.03", "augment={contrast: 0.1}"),
)


@pytest.fixture
def added(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.delitem(sys.modules, "extending.brightness", raising=False)
    monkeypatch.setenv("RADHAR_EXTENSIONS", "extending.brightness")
    extensions.load_extensions.cache_clear()
    extensions.load_extensions()
    yield
    del NETWORKS["pooling"], TASKS["brightness"]
    extensions.load_extensions.cache_clear()


@pytest.mark.usefixtures("added")
def test_a_network_and_a_task_go_through_every_command(tmp_path: Path) -> None:
    data, run = split_tree(tmp_path / "tree", train=6, val=3), tmp_path / "run"
    settings = [word for setting in QUICK for word in ("--set", setting)]
    options = ("--model", "pooling", "--target", "brightness", *settings)
    done = radhar("train", data, "-o", run, *options)
    assert done.returncode == 0, done.stderr
    assert "validation brightness within 0.05" in done.stdout
    metrics = json.loads((run / "metrics.json").read_text())
    assert metrics["score"] == "brightness within 0.05"
    assert metrics["parameters"] == 17
    done = radhar("eval", run, data, "-o", tmp_path / "report", "--json")
    assert done.returncode == 0, done.stderr
    assert "run: pooling, 1 quantities" in done.stderr
    error = json.loads(done.stdout)["rms_error"]["run"]["tree"]
    assert error < 0.2, "a half, which it starts from, is farther off"
    loaded = radhar_cli.load_run(run, device="cpu")
    levels = torch.zeros(2, 1, 32, 32, dtype=torch.uint8)
    assert loaded(levels).shape == (2,)
    assert loaded(levels).isfinite().all()
    done = radhar("predict", run, data, "--split", "val")
    assert done.stdout.splitlines()[0].startswith(f"{data}: kicking/000: brightness 0.")
    done = radhar("predict", run, data, "-o", tmp_path / "found.csv")
    assert (tmp_path / "found.csv").read_text().startswith("sample,brightness\n")
    refused = radhar("adapt", run, data, "-o", tmp_path / "adapted")
    assert refused.returncode == 2
    assert "finds brightness" in refused.stderr
    assert refused.stderr.count("\n") == 1
    refused = radhar("eval", run, data, "--tsne", "-o", tmp_path / "tsne")
    assert "run finds brightness; that figure is of classes" in refused.stderr


@pytest.mark.usefixtures("added")
def test_a_network_alone_learns_classes(tmp_path: Path) -> None:
    data, run = split_tree(tmp_path / "tree", train=2, val=1), tmp_path / "run"
    settings = [word for setting in QUICK for word in ("--set", setting)]
    extensions.load_extensions.cache_clear()
    done = radhar("train", data, "-o", run, "--model", "pooling", *settings, "--set", "epochs=1")
    assert done.returncode == 0, done.stderr
    assert json.loads((run / "metrics.json").read_text())["parameters"] == 16 * 3 + 3
    done = radhar("predict", run, data)
    assert done.stdout.count("walking") >= 9


def test_what_was_not_added_is_refused_with_what_there_is(tmp_path: Path) -> None:
    data = split_tree(tmp_path / "tree")
    done = radhar("train", data, "-o", tmp_path / "run", "--target", "brightness")
    assert done.returncode == 2
    assert "'person', 'frames' or 'skeleton'" in done.stderr
