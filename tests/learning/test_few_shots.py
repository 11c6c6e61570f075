"""Accuracy after learning from a few labelled images of each class (few_shots.py)."""

import json
import math
from dataclasses import replace

import few_shots as module
import numpy as np
import pytest
import torch
from few_shots import drawn, few_shots, interval_of_repeats, learned_from, missing
from learning.patterns import CLASSES, tree

from radhar_cli.learning.evaluated_run import EvalSet
from radhar_cli.learning.evaluation import open_for_model, open_training_images, predict_classes
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
        draw = drawn(some, k, seed=1, repeat=0)
        assert np.bincount(some.images.samples.label[draw.labelled]).tolist() == [k] * len(CLASSES)
        assert sorted([*draw.labelled, *draw.tested]) == list(range(24))
    larger, other = drawn(some, 5, 1, 0), drawn(some, 5, 1, 1)
    assert set(draw.labelled) < set(larger.labelled), "more labels are the fewer ones and others"
    assert set(other.labelled) != set(larger.labelled), "every repeat draws anew"
    assert drawn(some, 0, 1, 0).tested.tolist() == list(range(24))


def test_a_class_that_has_too_few_is_named(measured):
    some = opened(measured)
    assert missing(some, drawn(some, 7, 1, 0), 7) is None
    assert missing(some, drawn(some, 8, 1, 0), 8) == "kicking"
    assert missing(some, drawn(some, 9, 1, 0), 9) == "kicking"


def test_labelled_images_come_from_other_persons_than_tested_ones(measured):
    persons = tuple("abcd"[row % 4] for row in range(24))
    some = opened(measured, persons)

    def who(rows):
        return {persons[row] for row in rows}

    for repeat in range(6):
        one, more = (drawn(some, k, 1, repeat) for k in (1, 4))
        assert who(one.tested) == who(more.tested), "tested on the same persons, whatever k"
        assert len(who(more.labelled)) == len(who(more.tested)) == 2
        assert not who(more.labelled) & who(more.tested)
        assert np.bincount(some.images.samples.label[more.labelled]).tolist() == [4, 4, 4]
        assert sorted([*more.labelled, *more.tested]) == list(range(24))
    assert missing(some, more, 4) is None
    assert missing(some, drawn(some, 5, 1, 0), 5) == "kicking"


def test_mixed_images_are_shown_as_often_as_labelled_ones_unless_these_are_few(
    run_dir, data, measured
):
    metadata, _ = load_best(run_dir)
    few = open_for_model(metadata, measured, None).take(np.array([0, 8, 16]))
    mixed = open_training_images(metadata, data)
    for most, of_few in ((100, 24), (2, 6)):
        images, weights = learned_from(metadata, few, [mixed], most)
        rows = images.rows("train")
        source = images.samples.source
        shown = np.bincount(source[rows], np.array(weights)[source[rows]])
        assert shown == pytest.approx([of_few, 24])
        assert images.rows("val").size == 3
        assert (source[images.rows("val")] == 0).all(), "the mixed ones choose no epoch"
        assert images.classes == metadata.classes


def test_the_curve_of_a_run(run_dir, data, measured, tmp_path, capsys):
    """Every way for every number; what a class cannot give is left out; again is the same."""

    def curve():
        return few_shots(run_dir, measured, tmp_path, (0, 2, 8), 2, (data,), 1, QUICK)

    found = curve()
    assert [(p["shots"], p["learned"]) for p in found] == [
        *((0, way) for way in ("as trained", "adapted")),
        *((2, way) for way in ("fine-tuned", "adapted", "from scratch")),
    ]
    assert "8 a class: left out; kicking has too few" in capsys.readouterr().out
    metadata, as_trained = load_best(run_dir)
    every = predict_classes(as_trained, metadata, opened(measured).images, np.arange(24), CPU, 8)
    assert found[0]["accuracies"] == [(every.predicted == every.truth).mean()]
    assert json.loads((tmp_path / "shots.json").read_text()) == found
    assert curve() == found
