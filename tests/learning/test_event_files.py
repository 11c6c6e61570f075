"""Event files for TensorBoard: read by its own reader, every epoch once, whatever happened."""

import json

import pytest
from command_line import radhar
from learning.patterns import BASE, split_tree, trained
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from radhar_cli.learning import event_files
from radhar_cli.learning.event_files import SERIES, EventFiles
from radhar_cli.learning.run_folder import read_history


@pytest.fixture
def place(tmp_path):
    split_tree(tmp_path / "tree")
    (tmp_path / "train.json").write_text(json.dumps(BASE))
    return tmp_path


def learn(place, *more):
    command = ("train", place / "tree", "-o", place / "run", "--config", place / "train.json")
    return radhar(*command, *more)


def check(run):
    """TensorBoard finds what history.csv says, each epoch once."""
    found = EventAccumulator(str(run / "tensorboard")).Reload()
    history = read_history(run)
    assert sorted(found.Tags()["scalars"]) == sorted(SERIES)
    for name, column in SERIES.items():
        points = found.Scalars(name)
        assert [point.step for point in points] == [row.epoch for row in history], name
        values = [getattr(row, column) for row in history]
        assert [point.value for point in points] == pytest.approx(values, rel=1e-6)
        assert [p.wall_time for p in points] == sorted(p.wall_time for p in points)


@pytest.mark.parametrize("written", [True, False], ids=["after the event", "before the event"])
def test_an_interrupted_run_has_every_epoch_once(place, monkeypatch, written):
    update = EventFiles.update

    def interrupted(events):
        if written:
            update(events)
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(EventFiles, "update", interrupted)
        assert learn(place, "--tensorboard").returncode == 130
    done = learn(place, "--tensorboard")
    assert "resuming: 1 of 3" in done.stderr
    check(place / "run")
    assert len(list((place / "run/tensorboard").iterdir())) == 1


def test_event_files_are_added_later_and_removed_by_overwrite(place):
    trained(place / "tree", place / "run")
    assert not (place / "run/tensorboard").exists()
    for _ in range(2):
        assert learn(place, "--tensorboard").returncode == 0
        check(place / "run")
    (place / "run/tensorboard/notes.txt").touch()
    assert learn(place, "--overwrite").returncode == 0
    assert [path.name for path in (place / "run/tensorboard").iterdir()] == ["notes.txt"]


def test_a_link_in_the_place_of_their_folder_is_refused(place):
    trained(place / "tree", place / "run")
    (place / "elsewhere").mkdir()
    theirs = place / "elsewhere/events.out.tfevents.1"
    theirs.touch()
    (place / "run/tensorboard").symlink_to(place / "elsewhere")
    done = learn(place, "--tensorboard")
    assert done.returncode == 2
    assert "is a symbolic link" in done.stderr
    assert [path.name for path in (place / "elsewhere").iterdir()] == [theirs.name]


def test_without_tensorboard_the_extra_is_named(place, monkeypatch):
    def find(name):
        return None if name == "tensorboard" else event_files

    monkeypatch.setattr("importlib.util.find_spec", find)
    done = learn(place, "--tensorboard")
    assert done.returncode == 2
    assert "pip install 'radhar[tensorboard]'" in done.stderr
