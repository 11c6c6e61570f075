"""Mistakes that users make with runs and data: each is refused clearly, or works."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import torch
from helpers.listener import Listener
from learning.patterns import (
    Watched,
    best_weights,
    clear_line,
    last_weights,
    one_clear_line,
    same,
    same_run,
    settings,
    split_tree,
    trained,
    tree,
)

from radhar_cli.cli import program
from radhar_cli.errors import FolderError, ModelError, RadharError
from radhar_cli.learning import run_files
from radhar_cli.learning import run_folder as run
from radhar_cli.learning.batches import Reader, batches_in_order
from radhar_cli.learning.evaluation import open_for_model, rows_of
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.report import evaluate
from radhar_cli.learning.run_folder import RunError
from radhar_cli.learning.tasks.predictions import EvalOptions
from radhar_cli.learning.trained_run import load_run

CPU = torch.device("cpu")


def radhar(*arguments):
    """The error that a command ends with, in this process."""
    with pytest.raises(RadharError) as caught:
        program()([str(argument) for argument in arguments], standalone_mode=False)
    return caught.value


@pytest.fixture
def copy(run_dir, tmp_path):
    """A copy of a run, to be damaged."""
    return Path(shutil.copytree(run_dir, tmp_path / "copy"))


@pytest.mark.parametrize("command", ["train", "eval"])
@pytest.mark.parametrize("place", [".", "new", "train"])
def test_nothing_is_written_into_the_data(command, place, run_dir, tmp_path):
    root = split_tree(tmp_path / "t", 2, 1)
    before = sorted(root.rglob("*"))
    runs = [run_dir] if command == "eval" else []
    error = radhar(command, *runs, root, "-o", root / place)
    one_clear_line(error, root, "-o should name a folder of its own")
    assert sorted(root.rglob("*")) == before
    open_images(root, None, "rgb")


@pytest.mark.parametrize("command", ["train", "predict"])
def test_a_run_folder_is_not_read_as_data(command, run_dir, tmp_path):
    more = [run_dir, run_dir] if command == "predict" else [run_dir, "-o", tmp_path / "x"]
    error = radhar(command, *more)
    one_clear_line(error, run_dir, "is a training run", "asked for here")
    assert not (tmp_path / "x").exists()


def test_a_failed_start_leaves_the_folder_free(data, tmp_path):
    with pytest.raises(ModelError, match="did you mean 'fftnet'"):
        trained(data, tmp_path / "run", model="fftnett")
    with pytest.raises(KeyboardInterrupt):
        trained(data, tmp_path / "run", _Stop())
    assert len(trained(data, tmp_path / "run", epochs=1, seed=9).history) == 1


class _Stop(Watched):
    """Stops a run at its first step."""

    def step(self, loss, accuracy):
        raise KeyboardInterrupt


def test_a_checkpoint_of_another_run_is_refused(data, copy, tmp_path):
    trained(data, tmp_path / "other", epochs=3, seed=77)
    shutil.copy(tmp_path / "other" / run_files.LAST, copy / run_files.LAST)
    with clear_line(RunError, run_files.LAST, "is another run's", "seed: 77 there, 1 here"):
        trained(data, copy)


@pytest.mark.parametrize("best", [1, 3])
def test_missing_best_weights_are_reported_or_restored(best, data, copy):
    """They can be had again if they are those of the last epoch; which were best is planted."""
    last = run.read_last(copy)
    assert last is not None
    for row in last["history"]:
        row["val_accuracy"] = float(row["epoch"] == best)
    run.write_last(copy, last)
    (copy / run_files.BEST).write_bytes((copy / run_files.BEST).read_bytes()[:5000])
    if best == 3:
        trained(data, copy)
        best_and_last = best_weights(copy), last_weights(copy)
        assert same(*(dict(sorted(weights.items())) for weights in best_and_last))
    else:
        with clear_line(RunError, "cannot be recovered", "--overwrite"):
            trained(data, copy)


def test_derived_files_are_written_again(data, run_dir, copy):
    for name in (run_files.HISTORY, run_files.METRICS, run_files.CURVES):
        (copy / name).unlink()
    trained(data, copy)
    assert {p.name for p in copy.iterdir()} >= set(run_files.ALL)
    assert same_run(run_dir, copy)


def test_eval_reproduces_the_split_of_training(tmp_path):
    root = tree(tmp_path / "t", parts={"": 5})
    trained(root, tmp_path / "run", epochs=1)
    metadata = run.read_metadata(tmp_path / "run")
    images = open_for_model(metadata, root, None)
    rows, split = rows_of(images, "val")
    assert (split, rows.size) == ("val", metadata.data["val"])
    (root / "walking/000.png").unlink()
    rows, split = rows_of(open_for_model(metadata, root, None), "val")
    assert (split, rows.size) == ("all", 14), "another set: the split that was used is named"


def test_a_run_on_unnamed_images_needs_a_map(tmp_path):
    from radhar_cli.config import load_config
    from radhar_cli.dataset.build import build

    config = tmp_path / "two_maps.yaml"
    config.write_text(
        "{samples_per_class: 3, activities: [walking, punching], maps: [rtm, stft],"
        " radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}, image: {size_px: 32},"
        " split: {train: 0.67, validation: 0.33}}"
    )
    ours = tmp_path / "ours"
    build(load_config(config), ours, jobs=1, progress=Listener())
    trained(ours / "png/stft", tmp_path / "run", epochs=1)
    metadata = run.read_metadata(tmp_path / "run")
    assert metadata.map == "stft", "the folder's name says so"
    assert open_for_model(metadata, ours, None).map == "stft"
    foreign = shutil.copytree(ours / "png/stft", tmp_path / "foreign")
    trained(foreign, tmp_path / "other", epochs=1)
    with clear_line(FolderError, "rtm, stft", "--map"):
        open_for_model(run.read_metadata(tmp_path / "other"), ours, None)
    with pytest.raises(FolderError, match="has no map 'stft'"):
        open_images(foreign, "stft", "rgb")


def test_hidden_files_are_no_images(tmp_path):
    root = split_tree(tmp_path / "t", 2, 1)
    (root / "train/kicking/._0.png").write_bytes(b"what a file manager leaves")
    assert len(open_images(root, None, "rgb")) == 9


def test_a_class_without_validation_images_is_warned_of(tmp_path):
    from learning.patterns import Watched

    root = split_tree(tmp_path / "t", 2, 1)
    shutil.rmtree(root / "val/walking")
    progress = Watched()
    trained(root, tmp_path / "run", progress, epochs=1)
    assert any("'walking' has no validation image" in line for line in progress.messages)


def test_predict_takes_a_folder_of_images(run_dir, data):
    found = load_run(run_dir, "cpu").predict(data / "val/walking")
    assert [Path(name).name for name in found.samples] == ["000.png", "001.png"]


def test_a_broken_file_in_a_worker_is_one_line(tmp_path):
    root = split_tree(tmp_path / "t", 2, 1)
    images = open_images(root, None, "rgb")
    (root / "train/kicking/001.png").write_bytes(b"no more")
    with pytest.raises(FolderError) as caught:
        list(
            Reader(images.pixels, images.samples.label, workers=1)(
                batches_in_order(np.arange(len(images)), 4)
            )
        )
    one_clear_line(caught.value, "001.png: is not an image")
    assert "Traceback" not in str(caught.value)


def test_workers_leave_the_random_state_of_the_network_alone(data):
    images = open_images(data, None, "rgb")
    drawn = []
    for workers in (0, 1):
        torch.manual_seed(5)
        list(
            Reader(images.pixels, images.samples.label, workers=workers)(
                batches_in_order(np.arange(4), 2)
            )
        )
        drawn.append(float(torch.rand(1)))
    assert drawn[0] == drawn[1]


def test_names_with_commas_stay_in_their_column(tmp_path):
    import csv

    root = tree(tmp_path / "t", ("one, two", 'a "b"'), {"train": 2, "val": 1})
    trained(root, tmp_path / "run", epochs=1)
    report = evaluate([tmp_path / "run"], [root], EvalOptions(), CPU, Listener())
    report.write(tmp_path / "out")
    with (tmp_path / "out/confusion.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0][1:] == ['a "b"', "one, two"]
    assert [len(row) for row in rows] == [3, 3, 3]


def test_a_value_neither_auto_nor_a_number_gives_one_message():
    for key in ("workers", "threads", "batch_size"):
        with pytest.raises(ValueError, match="should be auto or a whole number") as caught:
            settings(**{key: "many"})
        assert caught.value.error_count() == 1


def test_an_output_that_cannot_be_made_is_one_line(data, tmp_path):
    (tmp_path / "file").write_text("x")
    one_clear_line(radhar("train", data, "-o", tmp_path / "file"), "is a file")
    one_clear_line(radhar("train", data, "-o", tmp_path / "file/sub"), "cannot be made")
