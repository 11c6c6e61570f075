"""Learning who it is: persons as classes, split by recording."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from helpers.command_line import radhar

from radhar_cli.dataset.split import TRAIN, VALIDATION
from radhar_cli.errors import FolderError
from radhar_cli.learning.images.h5 import open_h5_images
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.images.joined import joined
from radhar_cli.learning.images.sample_table import SampleTable, objects
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.tasks.person import (
    Persons,
    rank_shares,
    split_by_recording,
    why_not_split_by_recording,
)
from radhar_cli.learning.tasks.task import create_task

YAML = """
radar: {carrier_hz: 24e9, bandwidth_hz: 1e9, prf_hz: 1000}
activities: [walking, punching]
samples_per_class: 12
duration_s: 1
motion: {range_m: 5}
image: {size_px: 32}
maps: [stft]
split: {by: subject, subjects: 3, train: 0.7, validation: 0.3}
output: {png: false}
"""
QUICK = ("--set", "device=cpu", "--set", "precision=float32", "--set", "threads=1")


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("persons")
    (folder / "c.yaml").write_text(YAML)
    sample_split = "split={by: sample, train: 0.7, validation: 0.3}"
    sets = {"three": (), "others": ("--set", "seed=2"), "unnamed": ("--set", sample_split)}
    for name, more in sets.items():
        made = radhar("generate", folder / "c.yaml", "-o", folder / name, "-j", "1", *more)
        assert made.returncode == 0, made.stderr
    return folder


@pytest.fixture(scope="module")
def run(place: Path) -> Path:
    folder = place / "run"
    command = ("train", place / "three", "-o", folder, "--target", "person")
    made = radhar(*command, "--set", "epochs=2", *QUICK)
    assert made.returncode == 0, made.stderr
    assert "split anew" in made.stdout + made.stderr
    return folder


def _persons(images: ImageSet) -> ImageSet:
    return create_task(TrainConfig(target="person")).relabel(images)


def test_persons_are_classes_that_every_part_has(place: Path) -> None:
    stored = open_h5_images(place / "three", None, "gray")
    images = _persons(stored)
    assert images.classes == tuple(f"person {n} (seed 1)" for n in range(3))
    np.testing.assert_array_equal(images.samples.label, np.arange(24) % 3)  # of 12 walks, punches
    assert images.samples.split is not None
    for part in (TRAIN, VALIDATION):
        assert set(images.samples.label[images.samples.split == part]) == {0, 1, 2}
    assert "learns from 2 of 3 persons" in images.notes[-1]
    again = _persons(stored)
    np.testing.assert_array_equal(again.samples.split, images.samples.split)


def test_the_part_of_a_recording_does_not_depend_on_other_activities(place: Path) -> None:
    stored = open_h5_images(place / "three", None, "gray")
    walks = _persons(stored.renamed({"punching": None}))
    everything = _persons(stored)
    assert walks.samples.split is not None
    assert everything.samples.split is not None
    np.testing.assert_array_equal(walks.samples.split, everything.samples.split[:12])


def test_it_is_learned_evaluated_and_predicted(place: Path, run: Path) -> None:
    made = radhar("eval", run, place / "three")
    assert made.returncode == 0, made.stderr
    for words in ("rank-1", "chance 33.3 %", "rank-2", "rank-3 100.0 %"):
        assert words in made.stderr  # where progress goes
    numbers = json.loads((run / "eval" / "report.json").read_text())
    (result,) = next(iter(numbers["runs"].values()))["data"].values()
    assert result["rank"]["1"] == result["accuracy"]
    assert result["rank"]["3"] == 1
    assert result["seen_in_training"]["images"] == 0
    with (run / "eval" / "predictions.csv").open() as file:
        evaluated = {row["image"] for row in csv.DictReader(file)}
    made = radhar("predict", run, place / "three", "--split", "val", "--json")
    assert made.returncode == 0, made.stderr
    assert "person 1 (seed 1)" in made.stdout
    assert all(name in made.stdout for name in evaluated)  # the same recordings as in eval


def test_other_persons_of_the_same_number_are_refused(place: Path, run: Path) -> None:
    made = radhar("eval", run, place / "others", "-o", place / "eval_of_others")
    assert made.returncode == 2
    assert "class 'person 0 (seed 2)' is unknown to the model" in made.stderr


def test_a_set_that_names_nobody_is_refused(place: Path) -> None:
    made = radhar("train", place / "unnamed", "-o", place / "no", "--target", "person", *QUICK)
    assert made.returncode == 2
    assert "does not say who is seen; should have `split: {by: subject" in made.stderr
    both = joined([open_h5_images(place / name, None, "gray") for name in ("three", "others")])
    with pytest.raises(FolderError, match="persons of several data sets are not compared"):
        _persons(both)


def _table(person: list[str], recording: list[str], split: list[int]) -> SampleTable:
    label = np.unique(person, return_inverse=True)[1]
    return SampleTable(
        label=label,
        name=objects(f"walking/{n}" for n in range(len(person))),
        source=np.zeros(len(person), np.intp),
        split=np.array(split, np.uint8),
        person=objects(person),
        recording=objects(recording),
    )


def test_windows_of_a_recording_stay_together() -> None:
    files = [f"file {n // 4}.npy" for n in range(64)]
    person = ["ann" if n < 32 else "bob" for n in range(64)]
    table = _table(person, files, [0, 0, 0, 1] * 16)
    assert why_not_split_by_recording(table, 2) == "has windows of file 0.npy in two parts"
    split = split_by_recording(table, objects(["walking"] * 64))
    table = replace(table, split=split)
    assert why_not_split_by_recording(table, 2) is None
    assert abs((split == VALIDATION).mean() - 0.25) < 0.13
    for label in (0, 1):
        assert set(split[table.label == label]) == {TRAIN, VALIDATION}


def test_a_split_by_recording_stays() -> None:
    table = _table(["ann", "ann", "bob", "bob"], ["a", "b", "c", "d"], [0, 1, 0, 1])
    assert why_not_split_by_recording(table, 2) is None


def test_unnamed_and_single_recordings_are_refused(place: Path) -> None:
    images = open_h5_images(place / "three", None, "gray")
    table = _table(["ann", "file b"], ["file a", "file b"], [0, 1])
    with pytest.raises(FolderError, match="1 of 2 windows do not say who is seen"):
        _persons(replace(images, samples=table))
    table = _table(["ann", "ann", "bob"], ["file a", "file b", "file c"], [0, 1, 0])
    persons = _persons(replace(images, samples=table))
    task = Persons(TrainConfig(target="person"))
    with pytest.raises(FolderError, match="bob has one recording; should have two"):
        task.check_training(persons, "set")


def test_rank_shares() -> None:
    probabilities = np.array([[0.5, 0.3, 0.2], [0.2, 0.5, 0.3], [0.1, 0.2, 0.7]])
    shares = rank_shares(np.array([0, 2, 0]), probabilities)
    np.testing.assert_allclose(shares, [1 / 3, 2 / 3, 1])
