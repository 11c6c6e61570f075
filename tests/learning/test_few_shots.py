"""Accuracy after learning from a few labelled images of each class (`train --shots`)."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
import torch
from helpers.command_line import radhar
from learning.patterns import CLASSES, tree

from radhar_cli.learning import few_shots as module
from radhar_cli.learning.evaluated_run import EvalSet
from radhar_cli.learning.evaluation import open_for_model, open_training_images, predict_classes
from radhar_cli.learning.few_shots import (
    ShotOptions,
    draw_shots,
    find_short_class,
    interval_of_repeats,
    join_labelled,
    measure_few_shots,
)
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.images.sample_table import objects
from radhar_cli.learning.intervals import wilson
from radhar_cli.learning.run_folder import load_best

CPU = torch.device("cpu")
QUICK = ("epochs=2", "batch_size=12", "threads=1", "workers=0")


@pytest.fixture(autouse=True)
def few_shown(monkeypatch):
    """Short epochs."""
    monkeypatch.setattr(module, "SHOWN", 24)


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """Eight images of each class, without splits."""
    return tree(tmp_path_factory.mktemp("measured") / "tree", seed=9)


def opened(path, persons=None):
    images = open_images(path, None, "rgb")
    column = None if persons is None else objects(persons)
    images = replace(images, samples=replace(images.samples, person=column))
    return EvalSet(images, np.arange(len(images)), "all")


def test_interval_of_repeats_holds_images_and_draws():
    for share, repeats in ((0.8, 3), (1.0, 2), (0.0, 2), (0.8, 1)):
        alike = interval_of_repeats([share] * repeats, 50)
        assert alike == pytest.approx(wilson(50 * share, 50))
    low, high = interval_of_repeats([0.7, 0.8, 0.9], 10**9)
    known = 1.96 * 0.1 / math.sqrt(3)  # of the mean of three with a standard deviation of 0.1
    assert (low, high) == pytest.approx((0.8 - known, 0.8 + known), abs=0.03)


def test_draws_are_k_of_each_class_and_all_others_are_tested(measured):
    some = opened(measured)
    for k in (1, 3):
        draw = draw_shots(some, k, seed=1, repeat=0)
        assert np.bincount(some.images.samples.label[draw.labelled]).tolist() == [k] * len(CLASSES)
        assert sorted([*draw.labelled, *draw.tested]) == list(range(24))
    larger, other = draw_shots(some, 5, 1, 0), draw_shots(some, 5, 1, 1)
    assert set(draw.labelled) < set(larger.labelled), "more labels are the fewer ones and others"
    assert set(other.labelled) != set(larger.labelled), "every repeat draws anew"
    assert draw_shots(some, 0, 1, 0).tested.tolist() == list(range(24))


def test_a_class_that_has_too_few_is_named(measured):
    some = opened(measured)
    assert find_short_class(some, draw_shots(some, 7, 1, 0), 7) is None
    assert find_short_class(some, draw_shots(some, 8, 1, 0), 8) == "kicking"
    assert find_short_class(some, draw_shots(some, 9, 1, 0), 9) == "kicking"


def test_labelled_images_come_from_other_persons_than_tested_ones(measured):
    persons = tuple("abcd"[row % 4] for row in range(24))
    some = opened(measured, persons)

    def who(rows):
        return {persons[row] for row in rows}

    for repeat in range(6):
        one, more = (draw_shots(some, k, 1, repeat) for k in (1, 4))
        assert who(one.tested) == who(more.tested), "tested on the same persons, whatever k"
        assert len(who(more.labelled)) == len(who(more.tested)) == 2
        assert not who(more.labelled) & who(more.tested)
        assert np.bincount(some.images.samples.label[more.labelled]).tolist() == [4, 4, 4]
        assert sorted([*more.labelled, *more.tested]) == list(range(24))
    assert find_short_class(some, more, 4) is None
    assert find_short_class(some, draw_shots(some, 5, 1, 0), 5) == "kicking"


def test_mixed_images_are_shown_as_often_as_labelled_ones_unless_these_are_few(
    run_dir, data, measured
):
    metadata, _ = load_best(run_dir)
    few = open_for_model(metadata, measured, None).take(np.array([0, 8, 16]))
    mixed = open_training_images(metadata, data)
    for most, of_few in ((100, 24), (2, 6)):
        images, weights = join_labelled(metadata, few, [mixed], most)
        rows = images.rows("train")
        source = images.samples.source
        shown = np.bincount(source[rows], np.array(weights)[source[rows]])
        assert shown == pytest.approx([of_few, 24])
        assert images.rows("val").size == 3
        assert (source[images.rows("val")] == 0).all(), "the mixed ones choose no epoch"
        assert images.classes == metadata.classes


class Told:
    """Receiver of messages."""

    def __init__(self) -> None:
        self.messages: list[str] = []

    def say(self, message: str) -> None:
        self.messages.append(message)


def test_the_curve_of_a_run(run_dir, data, measured, tmp_path):
    """Every way for every number; what a class cannot give is left out; again is the same."""
    told = Told()

    def curve():
        options = ShotOptions((0, 2, 8), 2, (data,), 1, QUICK)
        return measure_few_shots(run_dir, measured, tmp_path, options, told)

    found = curve()
    assert [(p.shots, p.learned) for p in found] == [
        *((0, way) for way in ("as trained", "adapted")),
        *((2, way) for way in ("fine-tuned", "adapted", "from scratch")),
    ]
    assert "8 a class: left out; kicking has too few" in told.messages
    metadata, as_trained = load_best(run_dir)
    every = predict_classes(as_trained, metadata, opened(measured).images, np.arange(24), CPU, 8)
    assert found[0].accuracies == [(every.predicted == every.truth).mean()]
    stored = json.loads((tmp_path / "shots.json").read_text())
    assert [row["accuracies"] for row in stored] == [p.accuracies for p in found]
    assert curve() == found


def test_the_command_prints_and_writes_the_table(run_dir, data, measured, tmp_path):
    settings = [word for setting in QUICK for word in ("--set", setting)]
    shots = ("--init", run_dir, "--shots", "2,0", "--repeats", 1, *settings)
    done = radhar("train", measured, "-o", tmp_path / "shots", *shots)
    assert done.returncode == 0, done.stderr
    assert "0 a class, as trained" in done.stdout
    rows = (tmp_path / "shots/shots.csv").read_text().splitlines()
    assert rows[0] == "shots,learned,accuracy,low_95,high_95,repeats"
    assert [row.split(",")[:2] for row in rows[1:]] == [
        ["0", "as trained"],
        ["2", "fine-tuned"],
        ["2", "from scratch"],
    ]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--shots", "5"), "--shots: needs --init"),
        (("--shots", "few", "--init", "RUN"), "--shots few: should be numbers such as 0,1,5,20"),
        (("--shots", "5", "--init", "RUN", "--model", "fftnet"), "--model: has no effect"),
        (("--shots", "9", "--init", "RUN"), "has too few images of kicking for any of --shots"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_a_line(run_dir, measured, tmp_path, words, said):
    done = radhar(
        "train", measured, "-o", tmp_path, *(w.replace("RUN", str(run_dir)) for w in words)
    )
    assert done.returncode == 2
    assert said in done.stderr


def test_runs_are_not_written_into_the_data_that_they_learn_from(run_dir, measured):
    shots = ("--init", run_dir, "--shots", "2")
    done = radhar("train", measured, "-o", measured / "shots", *shots)
    assert done.returncode == 2
    assert not (measured / "shots").exists()
