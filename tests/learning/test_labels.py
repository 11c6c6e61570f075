"""Learning what everybody in a scene does, and how many there are."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from helpers.command_line import radhar

from radhar_cli.learning.images.h5 import open_h5_images
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.images.joined import joined
from radhar_cli.learning.images.sample_table import objects
from radhar_cli.learning.images.scan import content_hash
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.tasks.task import Task, create_task

YAML = """
radar: {carrier_hz: 24e9, bandwidth_hz: 1e9, prf_hz: 500}
activities: [walking, punching]
samples_per_class: 10
duration_s: 1
motion: {range_m: {per_activity: {default: 2.5, walking: 5}}}
image: {size_px: 32}
people: [{activity: {choice: [walking, sitting_down]}, share: 0.6, motion: {range_m: 4}}]
maps: [stft]
split: {train: 0.6, validation: 0.4}
"""
QUICK = ("--set", "device=cpu", "--set", "precision=float32", "--set", "threads=1")


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("labels")
    (folder / "several.yaml").write_text(YAML)
    for name, more in (("several", ()), ("alone", ("--set", "people=[]"))):
        made = radhar("generate", folder / "several.yaml", "-o", folder / name, "-j", "1", *more)
        assert made.returncode == 0, made.stderr
    return folder


def trained(place: Path, target: str) -> Path:
    run = place / target
    if not run.exists():
        made = radhar(
            "train", place / "several", "-o", run, "--target", target, "--set", "epochs=4", *QUICK
        )
        assert made.returncode == 0, made.stderr
    return run


def task_of(target: str) -> Task:
    return create_task(TrainConfig(target=target))


def images(place: Path, name: str = "several") -> ImageSet:
    return open_h5_images(place / name, None, "gray")


def test_what_is_shown_and_counted(place: Path) -> None:
    stored = images(place)
    assert stored.samples.activities is not None
    labels, count = (task_of(name).relabel(stored) for name in ("labels", "count"))
    assert labels.classes == ("walking", "punching", "sitting_down")
    assert count.classes == ("1 person", "2 people")
    shown = labels.multi_hot(labels.classes)
    for row, names in enumerate(stored.samples.activities):
        assert names[0] == stored.classes[stored.samples.label[row]]
        assert names[0] == labels.classes[labels.samples.label[row]]
        assert {labels.classes[n] for n in np.flatnonzero(shown[row])} == set(names)
        assert count.classes[count.samples.label[row]].split()[0] == str(len(names))
    assert task_of("classes").relabel(stored) is stored


def test_of_one_person_it_is_what_that_person_does(place: Path) -> None:
    alone = images(place, "alone")
    assert alone.samples.activities is None
    shown = task_of("labels").relabel(alone).multi_hot(alone.classes)
    np.testing.assert_array_equal(shown.argmax(axis=1), alone.samples.label)
    assert (shown.sum(axis=1) == 1).all()
    assert task_of("count").relabel(alone).classes == ("1 person",)


def test_rows_names_and_joined_sets_keep_everybody(place: Path) -> None:
    stored, alone = images(place), images(place, "alone")
    assert stored.samples.activities is not None
    some = stored.take(np.array([3, 15]))
    everybody = stored.samples.activities.tolist()
    assert some.samples.activities.tolist() == [everybody[3], everybody[15]]
    seated = stored.renamed({"sitting_down": "seated", "walking": None})
    assert seated.samples.activities is not None
    assert len(seated) == 10
    assert {name for names in seated.samples.activities for name in names} == {"punching", "seated"}
    both = joined([alone, stored])
    assert both.samples.activities is not None
    assert both.samples.activities[20:].tolist() == everybody
    assert all(len(names) == 1 for names in both.samples.activities[:20])
    rows = np.arange(len(stored))
    alone = objects(names[:1] for names in everybody)
    others = replace(stored, samples=replace(stored.samples, activities=alone))
    assert content_hash(stored, rows) != content_hash(others, rows)


def test_loss_of_labels() -> None:
    logits = torch.tensor([[3.0, -2.0], [0.5, 0.5]])
    shown = torch.tensor([[1, 0], [1, 0]], dtype=torch.uint8)
    task = task_of("labels")
    p = 1 / (1 + np.exp(-logits.numpy()))
    expected = -np.log(np.where(shown.numpy() > 0, p, 1 - p)).mean(axis=1)
    np.testing.assert_allclose(task.loss(logits, shown), expected, rtol=1e-6)
    assert task.score(logits, shown).tolist() == [1, 0]
    np.testing.assert_allclose(task.predict(logits), p, rtol=1e-6)


def test_a_network_of_labels_is_evaluated_by_label_and_by_number_of_people(place: Path) -> None:
    run = trained(place, "labels")
    for data in ("several", "alone"):
        done = radhar("eval", run, place / data, "-o", place / f"eval_{data}", "--json")
        assert done.returncode == 0, done.stderr
        assert "mean_average_precision" in json.loads(done.stdout)
        report = json.loads((place / f"eval_{data}/report.json").read_text())
        found = report["runs"]["labels"]["data"][data]
        assert 0 <= found["exact_match"] <= 1
        mean = np.mean([one["average_precision"] for one in found["classes"].values()])
        assert found["mean_average_precision"] == pytest.approx(mean)
        assert set(found["people"]) == ({"1", "2"} if data == "several" else {"1"})
        assert (place / f"eval_{data}/labels.png").exists()
        lines = (place / f"eval_{data}/predictions.csv").read_text().splitlines()
        assert lines[0] == "image,true,found"
        assert len(lines) == 1 + found["images"]


def test_a_network_counts_people(place: Path) -> None:
    run = trained(place, "count")
    done = radhar("eval", run, place / "several", "--json")
    assert done.returncode == 0, done.stderr
    assert 0 <= json.loads(done.stdout)["accuracy"]["count"]["several"] <= 1
    report = json.loads((run / "eval/report.json").read_text())
    assert set(report["runs"]["count"]["data"]["several"]["classes"]) == {"1 person", "2 people"}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("adapt", "RUN", "DATA", "-o", "NEW"), "finds several labels at a time"),
        (("train", "ALONE", "-o", "NEW", "--target", "count"), "has the class '1 person' alone"),
    ],
)
def test_what_cannot_be_is_said(place: Path, words: tuple[str, ...], message: str) -> None:
    places = {
        "RUN": trained(place, "labels"),
        "DATA": place / "several",
        "ALONE": place / "alone",
        "NEW": place / "new",
    }
    done = radhar(*(places.get(word, word) for word in words))
    assert done.returncode == 2
    assert message in done.stderr
