"""The files of a run: the best epoch, and damaged or malicious files."""

import contextlib
import json
import os
import pickle
import random
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import torch
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st
from learning.patterns import (
    Watched,
    best_weights,
    last_weights,
    one_clear_line,
    same,
    trained,
)
from safetensors.torch import load_file, save_file

from radhar_cli.learning import run_files
from radhar_cli.learning import run_folder as run
from radhar_cli.learning.run_folder import Epoch, RunError, best_epoch

EPOCH = Epoch(1, 1e-3, 0.5, 0.5, 0.5, 0.5, 1.0)


def epochs(*pairs: tuple[float, float]) -> list[Epoch]:
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
def test_best_is_highest_accuracy_then_lowest_loss_then_earliest(
    pairs: list[tuple[float, float]], best: int
) -> None:
    assert best_epoch(epochs(*pairs)).epoch == best


@examples(max_examples=100)
@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 3)), min_size=1, max_size=12))
def test_the_best_epoch_is_that_of_a_sort(pairs: list[tuple[int, int]]) -> None:
    history = epochs(*pairs)
    ranked = sorted(history, key=lambda e: (-e.val_accuracy, e.val_loss, e.epoch))
    assert best_epoch(history) is ranked[0]


def test_history_round_trips(tmp_path: Path) -> None:
    history = [EPOCH, Epoch(2, 0.1 + 0.2, 1 / 3, 0.5, 2 / 3, 1.0, 0.125)]
    run.write_history(tmp_path, history)
    assert run.read_history(tmp_path) == history


@pytest.fixture
def copy(run_dir: Path, tmp_path: Path) -> Path:
    """A copy of a run, to be damaged."""
    shutil.copytree(run_dir, tmp_path / "run")
    return tmp_path / "run"


def test_best_weights_are_those_of_the_best_epoch(run_dir: Path) -> None:
    from safetensors import safe_open

    with safe_open(run_dir / run_files.BEST, "pt") as file:
        assert file.metadata().keys() == {"radhar"}, "of several the order would be any"
    metadata, model = run.load_best(run_dir)
    assert metadata.epoch == best_epoch(run.read_history(run_dir)).epoch
    assert not model.training
    assert metadata.model_copy(update={"epoch": None}) == run.read_metadata(run_dir)


def test_weights_larger_than_memory_are_refused_in_a_line(
    copy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A sparse file costs its sender nothing."""

    def full(*_: object, **__: object) -> None:
        raise MemoryError("Cannot allocate memory (os error 12)")

    monkeypatch.setattr(run, "safe_open", full)
    with pytest.raises(RunError, match=r"best\.safetensors: is not a safetensors file.*allocate"):
        run.load_best(copy)


def test_weights_that_may_not_be_read_are_not_called_damaged(
    copy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("os.access", lambda *_, **__: False)
    with pytest.raises(RunError, match=r"best\.safetensors: Permission denied$"):
        run.load_best(copy)


def test_a_weights_file_alone_can_be_loaded(run_dir: Path, tmp_path: Path) -> None:
    shutil.copy(run_dir / run_files.BEST, tmp_path / "model.safetensors")
    metadata, model = run.load_best(tmp_path / "model.safetensors")
    assert metadata.classes == ("punching", "kicking", "walking")
    assert same(
        dict(sorted(model.state_dict().items())),
        dict(sorted(best_weights(run_dir).items())),
    )


def test_truncated_weights_are_refused_wherever_they_end(copy: Path) -> None:
    path = copy / run_files.BEST
    whole = path.read_bytes()
    for length in [0, 4, 8, 100, 5000, len(whole) // 2, len(whole) - 1]:
        path.write_bytes(whole[:length])
        with pytest.raises(RunError) as caught:
            run.load_best(copy)
        one_clear_line(caught.value, path, "truncated")


def foreign(path: Path) -> None:
    save_file({"a": torch.zeros(3)}, path)


def _rewrite(path: Path, change: Callable[[dict[str, Any], dict[str, Any]], None]) -> None:
    from safetensors import safe_open

    with safe_open(path, "pt") as file:
        metadata = dict(file.metadata())
    weights, found = load_file(path), json.loads(metadata["radhar"])
    change(weights, found)
    save_file(weights, path, {**metadata, "radhar": json.dumps(found)})


def wrong_shape(path: Path) -> None:
    _rewrite(path, lambda w, a: w.update({"head.bias": torch.zeros(7)}))


def missing_weight(path: Path) -> None:
    _rewrite(path, lambda w, a: w.pop("head.bias") is None)


def extra_weight(path: Path) -> None:
    _rewrite(path, lambda w, a: w.update({"evil": torch.zeros(7)}))


def fewer_classes(path: Path) -> None:
    _rewrite(path, lambda w, a: a.update({"classes": ["a", "b"]}))


def wrong_size(path: Path) -> None:
    _rewrite(path, lambda w, a: a.update({"size": [15, 32]}))


def text_size(path: Path) -> None:
    _rewrite(path, lambda w, a: a.update({"size": "big"}))


@pytest.mark.parametrize(
    ("damage", "expected"),
    [
        (foreign, "not written by `radhar train`"),
        (wrong_shape, "do not fit its description"),
        (missing_weight, "do not fit its description"),
        (extra_weight, "do not fit its description"),
        (fewer_classes, "do not fit its description"),
        (wrong_size, "at least 16"),
        (text_size, "description is damaged (size"),
    ],
    ids=lambda x: getattr(x, "__name__", ""),
)
def test_weights_that_do_not_fit_are_refused_in_one_line(
    copy: Path, damage: Callable[[Path], None], expected: str
) -> None:
    damage(copy / run_files.BEST)
    with pytest.raises(RunError) as caught:
        run.load_best(copy)
    one_clear_line(caught.value, copy / run_files.BEST, expected)
    assert "\n" not in str(caught.value)


class Evil:
    """Makes a file when it is unpickled by a reader who trusts it."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> tuple[Any, ...]:
        return (os.system, (f"touch {self.path}",))


def evil_zip(path: Path, mark: Path) -> None:
    torch.save(
        {"model": Evil(mark), "optimiser": {}, "history": [], "random": 0, "metadata": ""}, path
    )


def evil_pickle(path: Path, mark: Path) -> None:
    path.write_bytes(pickle.dumps(Evil(mark), protocol=2))


def evil_module(path: Path, mark: Path) -> None:
    torch.save(torch.nn.Linear(1, 1), path)


@pytest.mark.parametrize("write", [evil_zip, evil_pickle, evil_module], ids=lambda f: f.__name__)
def test_a_malicious_checkpoint_runs_no_code(
    data: Path, copy: Path, tmp_path: Path, write: Callable[[Path, Path], None]
) -> None:
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


def test_truncated_checkpoints_are_refused_wherever_they_end(copy: Path) -> None:
    path = copy / run_files.LAST
    whole = path.read_bytes()
    chance = random.Random(2)
    for length in [0, 1, 4, 100, *(chance.randrange(len(whole)) for _ in range(4)), len(whole) - 1]:
        path.write_bytes(whole[:length])
        with pytest.raises(RunError) as caught:
            run.read_last(copy)
        one_clear_line(caught.value, path, "is damaged", "--overwrite")
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "content", [b"hello\n", b"\x80\x02.", b"\x80\x04N.", b"PK\x03\x04", b"\0" * 99]
)
def test_files_that_are_no_checkpoints_are_refused(copy: Path, content: bytes) -> None:
    (copy / run_files.LAST).write_bytes(content)
    with pytest.raises(RunError) as caught:
        run.read_last(copy)
    one_clear_line(caught.value, run_files.LAST, "is damaged, or not a checkpoint")


@pytest.mark.parametrize("value", [[1, 2], {"model": {}}, torch.zeros(2)])
def test_checkpoints_of_something_else_are_refused(copy: Path, value: Any) -> None:
    torch.save(value, copy / run_files.LAST)
    with pytest.raises(RunError) as caught:
        run.read_last(copy)
    one_clear_line(caught.value, run_files.LAST, "is damaged, or not a checkpoint")


def test_a_checkpoint_of_another_network_does_not_fit(data: Path, copy: Path) -> None:
    found = torch.load(copy / run_files.LAST, weights_only=True)
    found["model"]["head.bias"] = torch.zeros(9)
    torch.save(found, copy / run_files.LAST)
    with pytest.raises(RunError) as caught:
        trained(data, copy)
    one_clear_line(caught.value, copy / run_files.LAST, "does not fit this run")


def test_checkpoint_holds_tensors_and_plain_values_alone(run_dir: Path) -> None:
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
def test_a_folder_with_another_run_is_refused_naming_the_key(
    data: Path, run_dir: Path, changes: dict[str, Any], named: list[str]
) -> None:
    before = {p.name: p.stat().st_mtime_ns for p in run_dir.iterdir() if p.is_file()}
    with pytest.raises(RunError) as caught:
        trained(data, run_dir, **changes)
    one_clear_line(caught.value, run_dir, "holds another run", "--overwrite", *named)
    assert before == {p.name: p.stat().st_mtime_ns for p in run_dir.iterdir() if p.is_file()}


def test_a_folder_with_a_run_on_other_data_is_refused(run_dir: Path, tmp_path: Path) -> None:
    from learning.patterns import split_tree

    with pytest.raises(RunError) as caught:
        trained(split_tree(tmp_path / "t", seed=5), run_dir)
    one_clear_line(caught.value, "data:")
    with pytest.raises(RunError) as caught:
        trained(split_tree(tmp_path / "u", classes=("a", "b")), run_dir)
    one_clear_line(caught.value, 'classes: ["punching", "kicking", "walking"] there, ["a", "b"]')


def test_device_settings_do_not_make_another_run(data: Path, run_dir: Path) -> None:
    done = trained(data, run_dir, threads=2, workers=1)
    assert done.resumed == 3


def test_a_folder_with_foreign_files_is_refused(data: Path, tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(RunError) as caught:
        trained(data, tmp_path)
    one_clear_line(caught.value, tmp_path, "thesis.tex", "no training run")
    from learning.patterns import settings

    from radhar_cli.learning.training import train

    with pytest.raises(RunError):
        train(settings(), data, tmp_path, Watched(), overwrite=True)
    assert (tmp_path / "thesis.tex").read_text() == "years of work"


def test_overwrite_removes_only_files_of_a_run(data: Path, copy: Path) -> None:
    from learning.patterns import settings

    from radhar_cli.learning.training import train

    (copy / "notes.txt").write_text("mine")
    (copy / "eval").mkdir()
    (copy / "eval/report.json").write_text("{}")
    with pytest.raises(KeyboardInterrupt):
        train(settings(seed=2), data, copy, Watched(stop_after=1), overwrite=True)
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


def test_a_missing_run_is_named(tmp_path: Path) -> None:
    for read in (run.load_best, run.read_metadata, run.read_history):
        with pytest.raises(RunError) as caught:
            read(tmp_path)
        one_clear_line(caught.value, tmp_path)


@pytest.mark.parametrize("content", ["", "nonsense", "{}", '{"model": 3}'])
def test_damaged_run_json_is_named(data: Path, copy: Path, content: str) -> None:
    (copy / run_files.ABOUT).write_text(content)
    with pytest.raises(RunError) as caught:
        trained(data, copy)
    one_clear_line(caught.value, copy / run_files.ABOUT, "is damaged")


@pytest.mark.parametrize("content", ["epoch\nx\n", "epoch,val_loss\n1,2\n", "a,b\n1,2\n"])
def test_damaged_history_is_named(tmp_path: Path, content: str) -> None:
    (tmp_path / run_files.HISTORY).write_text(content)
    with pytest.raises(RunError) as caught:
        run.read_history(tmp_path)
    one_clear_line(caught.value, tmp_path / run_files.HISTORY, "is damaged")
