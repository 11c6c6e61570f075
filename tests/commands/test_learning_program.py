"""`radhar train`, `eval`, `models`, `export` and `predict` as a user meets them."""

import importlib.util
import json
import re
import shutil
from pathlib import Path

import pytest
from helpers.command_line import ok, radhar
from helpers.documented import KEYS
from learning.patterns import BASE, split_tree, trained


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with a tree, a config and a finished run."""
    folder = tmp_path_factory.mktemp("place")
    split_tree(folder / "tree")
    (folder / "train.json").write_text(json.dumps({**BASE, "epochs": 1}))
    trained(folder / "tree", folder / "run", epochs=1)
    return folder


def test_train_reports_what_it_does_and_that_a_finished_run_is_complete(place):
    out = place / "mine"
    command = ("train", place / "tree", "-o", out, "--config", place / "train.json")
    first = ok(*command, "--set", "epochs=1")
    assert "best epoch 1: validation accuracy" in first.stdout
    assert "reading 18 images of 3 classes" in first.stderr
    assert "epoch 1/1" in first.stderr
    assert "it/s" not in first.stderr, "quiet when not a terminal"
    again = ok(*command)
    assert "is complete: 1 epochs; nothing to do" in again.stdout
    other = radhar(*command, "--set", "seed=5")
    assert other.returncode == 2
    assert "seed: 1 there, 5 here" in other.stderr
    assert "Traceback" not in other.stderr


def test_eval_writes_its_report_into_the_run_folder(place):
    done = ok("eval", place / "run", place / "tree", "--split", "train")
    assert (place / "run/eval/report.html").exists()
    assert str(place / "run/eval/report.html") in done.stdout
    assert json.loads((place / "run/eval/report.json").read_text())["split"] == "train"
    assert "12 of these 12 images" in done.stderr
    assert "were trained on" in (place / "run/eval/report.html").read_text()


def test_eval_replaces_the_report_of_other_data_only_if_it_is_told_to(place):
    """The same command again is the same report; another data set or split is not."""
    out, other = place / "report", place / "other"
    shutil.copytree(place / "tree", other)
    again = ("eval", place / "run", place / "tree", "-o", out)
    ok(*again)
    before = (out / "report.json").read_text()
    ok(*again)
    for more in ((place / "run", other), (place / "run", place / "tree", "--split", "train")):
        refused = radhar("eval", *more, "-o", out)
        assert refused.returncode == 2
        assert f"{out}: holds another report; --overwrite replaces it" in refused.stderr
        assert json.loads((out / "report.json").read_text())["of"] == json.loads(before)["of"]
    ok("eval", place / "run", other, "-o", out, "--overwrite")
    assert json.loads((out / "report.json").read_text())["of"][1] == str(other)
    assert not list(place.rglob("*unfinished*"))


def test_predict_prints_the_class_and_probabilities(place):
    image = place / "tree/val/walking/000.png"
    done = ok("predict", place / "run", image, "--top", 2)
    line = done.stdout.strip()
    assert line.startswith(f"{image}: ")
    assert line.count("%") == 2
    done = radhar("predict", place / "run", image, place / "tree", "--json", "--split", "val")
    rows = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(rows) == 7
    for row in rows:
        assert sum(row["probabilities"].values()) == pytest.approx(1, abs=1e-6)
        assert row["class"] == max(row["probabilities"], key=row["probabilities"].__getitem__)


def test_json_of_learning_commands(place):
    run, data, one = place / "run", place / "tree", place / "tree/val/walking/000.png"
    train = ("train", data, "-o", place / "told", "--config", place / "train.json")
    commands = {
        "train": train,
        "eval": ("eval", run, data, "-o", place / "told-eval"),
        "predict": ("predict", run, one),
        "adapt": ("adapt", run, data, "-o", place / "told-adapted", "--epochs", 1),
    }
    for name, command in commands.items():
        done = ok(*command, "--json")
        (line,) = done.stdout.splitlines()
        assert json.loads(line).keys() == KEYS[name]


@pytest.mark.parametrize(
    ("missing", "arguments", "package"),
    [
        ("torch", ["train", "x", "-o", "y"], "torch"),
        ("safetensors", ["eval", "x", "y"], "safetensors"),
        ("sklearn", ["predict", "x", "y"], "scikit-learn"),
        ("onnx", ["export", "x", "-o", "y"], "onnx"),
        ("plotly", ["view", "x"], "plotly"),
        ("plotly", ["simulate", "x", "-o", "y", "--html"], "plotly"),
        ("pyarrow", ["convert", "x", "--to", "parquet", "-o", "y"], "pyarrow"),
        ("skimage", ["tradeoff", "x", "-o", "y"], "scikit-image"),
    ],
)
def test_a_missing_package_is_named_with_what_installs_it(missing, arguments, package, monkeypatch):
    """From a clone as from a wheel: radhar itself is on no index."""
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *rest: None if name == missing else find(name)
    )
    done = radhar(*arguments)
    assert done.returncode == 2
    assert f"needs {missing}, which is not installed: " in done.stderr
    assert re.search(rf"python\S* -m pip install (--\S+ \S+ )?{package}\n", done.stderr)
    assert package in (Path(__file__).parents[2] / "pyproject.toml").read_text()
    assert "Traceback" not in done.stderr
