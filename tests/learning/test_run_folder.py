"""The files of a run: the best epoch, and damaged or malicious files."""

import contextlib
import os
import pickle
import shutil
import zipfile

import pytest
import torch
from learning.patterns import (
    Watched,
    best_weights,
    clear_line,
    last_weights,
    one_clear_line,
    same,
    trained,
)

from radhar_cli.learning import run_files
from radhar_cli.learning import run_folder as run
from radhar_cli.learning.run_folder import Epoch, RunError, best_epoch

EPOCH = Epoch(1, 1e-3, 0.5, 0.5, 0.5, 0.5, 1.0)


def epochs(*pairs):
    return [
        Epoch(number, 1e-3, 0.0, 1.0, loss, accuracy, 0.0)
        for number, (accuracy, loss) in enumerate(pairs, start=1)
    ]


@pytest.mark.parametrize(
    ("pairs", "best"),
    [
        ([(0.5, 1.0), (0.7, 2.0), (0.6, 0.1)], 2),
        ([(0.7, 2.0), (0.7, 1.0), (0.7, 1.5)], 2),
        ([(0.2, 3.0), (0.7, 1.0), (0.7, 1.0), (0.1, 0.0)], 2),
        ([(0.0, 9.0)], 1),
    ],
)
def test_best_is_highest_accuracy_then_lowest_loss_then_earliest(pairs, best):
    assert best_epoch(epochs(*pairs)).epoch == best


def test_history_round_trips(tmp_path):
    history = [EPOCH, Epoch(2, 0.1 + 0.2, 1 / 3, 0.5, 2 / 3, 1.0, 0.125)]
    run.write_history(tmp_path, history)
    assert run.read_history(tmp_path) == history


@pytest.fixture
def copy(run_dir, tmp_path):
    """A copy of a run, to be damaged."""
    shutil.copytree(run_dir, tmp_path / "run")
    return tmp_path / "run"


def test_best_weights_are_those_of_the_best_epoch(run_dir):
    from safetensors import safe_open

    with safe_open(run_dir / run_files.BEST, "pt") as file:
        assert file.metadata().keys() == {"radhar"}, "of several the order would be any"
    metadata, model = run.load_best(run_dir)
    assert metadata.epoch == best_epoch(run.read_history(run_dir)).epoch
    assert not model.training
    assert metadata.model_copy(update={"epoch": None}) == run.read_metadata(run_dir)


def test_weights_larger_than_memory_are_refused_in_a_line(copy, monkeypatch):
    """A sparse file costs its sender nothing."""

    def full(*_, **__):
        raise MemoryError("Cannot allocate memory (os error 12)")

    monkeypatch.setattr(run, "safe_open", full)
    with pytest.raises(RunError, match=r"best\.safetensors: is not a safetensors file.*allocate"):
        run.load_best(copy)


def test_weights_that_may_not_be_read_are_not_called_damaged(copy, monkeypatch):
    monkeypatch.setattr("os.access", lambda *_, **__: False)
    with pytest.raises(RunError, match=r"best\.safetensors: Permission denied$"):
        run.load_best(copy)


def test_a_weights_file_alone_can_be_loaded(run_dir, tmp_path):
    shutil.copy(run_dir / run_files.BEST, tmp_path / "model.safetensors")
    metadata, model = run.load_best(tmp_path / "model.safetensors")
    assert metadata.classes == ("kicking", "punching", "walking")
    assert same(
        dict(sorted(model.state_dict().items())), dict(sorted(best_weights(run_dir).items()))
    )


class Evil:
    """Makes a file when it is unpickled by a reader who trusts it."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return (os.system, (f"touch {self.path}",))


def evil_zip(path, mark):
    torch.save({"model": Evil(mark), "optimiser": {}, "history": [], "metadata": ""}, path)


def evil_pickle(path, mark):
    path.write_bytes(pickle.dumps(Evil(mark), protocol=2))


def evil_module(path, mark):
    torch.save(torch.nn.Linear(1, 1), path)


@pytest.mark.parametrize("write", [evil_zip, evil_pickle, evil_module], ids=lambda f: f.__name__)
def test_a_malicious_checkpoint_runs_no_code(data, copy, tmp_path, write):
    mark, best = tmp_path / "mark", (copy / run_files.BEST).read_bytes()
    write(copy / run_files.LAST, mark)
    with pytest.raises(RunError) as caught:
        trained(data, copy)
    one_clear_line(
        caught.value, copy / run_files.LAST, "best.safetensors is untouched", "--overwrite"
    )
    assert not mark.exists()
    assert (copy / run_files.BEST).read_bytes() == best
    if write is not evil_module:  # the file is as bad as it should be
        with contextlib.suppress(RuntimeError):
            torch.load(copy / run_files.LAST, weights_only=False)
        assert mark.exists()


def test_checkpoint_holds_tensors_and_plain_values_alone(run_dir):
    with zipfile.ZipFile(run_dir / run_files.LAST) as archive:
        name = next(n for n in archive.namelist() if n.endswith("data.pkl"))
        import pickletools

        calls = {
            str(arg) for op, arg, _ in pickletools.genops(archive.read(name)) if op.name == "GLOBAL"
        }
    assert all(c.startswith(("torch", "collections OrderedDict")) for c in calls), calls


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"seed": 2}, ["seed: 1 there, 2 here"]),
        ({"learning_rate": 0.01, "epochs": 4}, ["learning_rate: 0.001 there, 0.01", "epochs: 3"]),
        ({"schedule": {"kind": "cosine"}}, ["schedule", "cosine"]),
        ({"precision": "bfloat16"}, ["precision"]),
        ({"input": "gray"}, ["input", "gray"]),
    ],
)
def test_a_folder_with_another_run_is_refused_naming_the_key(data, run_dir, changes, named):
    before = {p.name: p.stat().st_mtime_ns for p in run_dir.iterdir() if p.is_file()}
    with clear_line(RunError, run_dir, "holds another run", "--overwrite", *named):
        trained(data, run_dir, **changes)
    assert before == {p.name: p.stat().st_mtime_ns for p in run_dir.iterdir() if p.is_file()}


def test_a_folder_with_a_run_on_other_data_is_refused(run_dir, tmp_path):
    from learning.patterns import split_tree

    with clear_line(RunError, "data:"):
        trained(split_tree(tmp_path / "t", seed=5), run_dir)
    with clear_line(RunError, 'classes: ["kicking", "punching", "walking"] there, ["a", "b"]'):
        trained(split_tree(tmp_path / "u", classes=("a", "b")), run_dir)


def test_device_settings_do_not_make_another_run(data, run_dir):
    done = trained(data, run_dir, threads=2, workers=1)
    assert done.resumed == 3


def test_a_folder_with_foreign_files_is_refused(data, tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work")
    with clear_line(RunError, tmp_path, "thesis.tex", "no training run"):
        trained(data, tmp_path)
    from learning.patterns import settings

    from radhar_cli.learning.training import TrainOptions, train

    with pytest.raises(RunError):
        train(settings(), data, tmp_path, Watched(), TrainOptions(overwrite=True))
    assert (tmp_path / "thesis.tex").read_text() == "years of work"


def test_overwrite_removes_only_files_of_a_run(data, copy):
    from learning.patterns import settings

    from radhar_cli.learning.training import TrainOptions, train

    (copy / "notes.txt").write_text("mine")
    (copy / "eval").mkdir()
    (copy / "eval/report.json").write_text("{}")
    with pytest.raises(KeyboardInterrupt):
        train(settings(seed=2), data, copy, Watched(stop_after=1), TrainOptions(overwrite=True))
    kept = {p.name for p in copy.iterdir()} - {".radhar"}
    assert kept == {
        *(
            "notes.txt",
            "eval",
            run_files.ABOUT,
            run_files.BEST,
            run_files.LAST,
            run_files.HISTORY,
            run_files.TRAINED_ON,
        )
    }, "the curves, metrics and summary of the old run are gone"
    assert (copy / "notes.txt").read_text() == "mine"
    assert len(run.read_history(copy)) == 1
    assert run.read_metadata(copy).config["seed"] == 2
    assert len(last_weights(copy)) == len(best_weights(copy))


def test_a_missing_run_is_named(tmp_path):
    for read in (run.load_best, run.read_metadata, run.read_history):
        with clear_line(RunError, tmp_path):
            read(tmp_path)


@pytest.mark.parametrize("content", ["epoch\nx\n", "epoch,val_loss\n1,2\n", "a,b\n1,2\n"])
def test_damaged_history_is_named(tmp_path, content):
    (tmp_path / run_files.HISTORY).write_text(content)
    with clear_line(RunError, tmp_path / run_files.HISTORY, "is damaged"):
        run.read_history(tmp_path)
