"""Identity of the person, whatever the activity: one class a person (`target: person`)."""

import hashlib
import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from radhar_cli.dataset.split import TEST, TRAIN, VALIDATION
from radhar_cli.errors import FolderError
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.images.sample_table import Objects, SampleTable
from radhar_cli.learning.intervals import Groups, interval_in_words
from radhar_cli.learning.tasks.categories import Classifier
from radhar_cli.learning.tasks.predictions import ClassPredictions
from radhar_cli.learning.tasks.task import Evaluation
from radhar_cli.numerics.arrays import Float, Index, Levels

RANKS = (1, 2, 3, 5, 10)  # of the table
NOTE = (
    "{where}: each person's recordings are split anew, {train} to learn from and {val} to validate "
    "with{test}, as the data set's own split {why}"
)


class Persons(Classifier):
    """The person who is seen, of those whom the network learned: identification by gait.

    A person has recordings in every part of the split, and no recording is in two. Where the data
    set is split otherwise (by person, or with windows of one recording in several parts) the
    recordings of each person are split anew: from their names alone, so that `eval` finds the parts
    of the training.
    """

    finds: ClassVar[str] = "persons"

    def relabel(self, images: ImageSet) -> ImageSet:
        """Images whose classes are the persons, each with recordings in every part of the split.

        Raises:
            FolderError: the set does not say who is seen.
        """
        person = _persons_of(images)
        classes = tuple(sorted(set(person), key=_natural_order))
        label = np.array([classes.index(name) for name in person], np.intp)
        samples = replace(images.samples, label=label, activities=None)
        return _with_split_by_recording(replace(images, classes=classes, samples=samples))

    def split_as_learned(self, images: ImageSet) -> ImageSet:
        """Images with the split of `relabel`; as they are where the set does not name persons."""
        with suppress(FolderError):
            relabelled = self.relabel(images)
            samples = replace(images.samples, split=relabelled.samples.split)
            return replace(images, samples=samples, notes=relabelled.notes)
        return images

    def check_training(self, images: ImageSet, path: str) -> None:
        """Make sure that there are two persons, with two recordings each."""
        recording = images.samples.recordings
        for number, name in enumerate(images.classes):
            if len(set(recording[images.samples.label == number])) < 2:
                raise FolderError(
                    f"{path}: {name} has one recording; should have two, one to learn from and one "
                    "to validate with"
                )
        super().check_training(images, path)

    def groups(self, images: ImageSet, rows: Index) -> Groups:
        """Recordings of some rows: other persons are none of the classes."""
        return images.samples.groups(rows, by_person=False)

    def report(self, evaluation: Evaluation) -> dict[str, Any]:
        """Numbers of a classifier, and how often the person is among the likeliest."""
        numbers = super().report(evaluation)
        predictions = ClassPredictions(**vars(evaluation.predictions))
        shares = rank_shares(predictions.truth, predictions.probabilities)
        count = len(predictions.names)
        ranks = {str(rank): float(shares[rank - 1]) for rank in RANKS if rank <= count}
        rows = ([rank, f"{100 * share:.2f}"] for rank, share in ranks.items())
        title = "Share of recordings whose person is among the likeliest"
        evaluation.table("ranks", ("rank", "share, %"), rows, title)
        return numbers | {"rank": ranks, "chance": 1 / count}

    def summarise(self, numbers: Mapping[str, Any]) -> str:
        """Rank-1 accuracy with its interval beside chance, and the higher ranks, in words."""
        interval = interval_in_words(numbers["accuracy_95"], numbers["interval_over"])
        higher = "".join(
            f", rank-{rank} {100 * share:.1f} %"
            for rank, share in numbers["rank"].items()
            if rank != "1"
        )
        return (
            f"rank-1 {100 * numbers['accuracy']:.2f} % {interval} of {numbers['images']}, chance "
            f"{100 * numbers['chance']:.1f} %{higher}"
        )


def _with_split_by_recording(images: ImageSet) -> ImageSet:
    """Images of persons, split by recording where they are split otherwise; a note says so."""
    samples = images.samples
    why = why_not_split_by_recording(samples, len(images.classes))
    if why is None:
        return images
    split = split_by_recording(samples, _activity_names(samples))
    counts = np.bincount(split, minlength=3).tolist()
    test = f", {counts[TEST]} to test" if counts[TEST] else ""
    note = NOTE.format(
        where=images.where, train=counts[TRAIN], val=counts[VALIDATION], test=test, why=why
    )
    return replace(images, samples=replace(samples, split=split), notes=(*images.notes, note))


def _persons_of(images: ImageSet) -> list[str]:
    """Name of the person in each row [N].

    Raises:
        FolderError: the set does not say who is seen.
    """
    person, recording = images.samples.person, images.samples.recording
    several = len(set(images.samples.source.tolist())) > 1
    if person is None or several:
        cure = (
            "persons of several data sets are not compared; should be one data set"
            if several
            else "should have `split: {by: subject, subjects: 6}`, or recordings of named persons; "
            "a tree whose class folders are persons is learned with target: classes"
        )
        raise FolderError(f"{images.where}: does not say who is seen; {cure}")
    names = list(map(str, person))
    if recording is not None:
        unnamed = [name for name, file in zip(names, recording, strict=True) if name == file]
        if unnamed:
            raise FolderError(
                f"{images.where}: {len(unnamed)} of {len(names)} windows do not say who is seen; "
                "should have a person for each recording of the manifest"
            )
    return names


def why_not_split_by_recording(samples: SampleTable, count: int) -> str | None:
    """Describe why a set's split is not one to learn persons with; None if it is.

    Args:
        samples: table whose labels are persons.
        count: number of persons.
    """
    if samples.split is None:
        return None
    trained = np.unique(samples.label[samples.split == TRAIN])
    if trained.size < count:
        return f"learns from {trained.size} of {count} persons"
    parts = dict[str, int]()
    for recording, part in zip(samples.recordings, samples.split.tolist(), strict=True):
        if parts.setdefault(recording, part) != part:
            return f"has windows of {recording} in two parts"
    return None


def split_by_recording(samples: SampleTable, activity: Objects) -> Levels:
    """Split the recordings of every person in the shares of the split that is there [N].

    What part a recording is in follows from its name, the person and the activity, and from the
    person's other recordings of that activity; with two or more recordings a person is validated.

    Args:
        samples: table whose labels are persons.
        activity: name of the activity of each row [N].
    """
    assert samples.split is not None
    shares = np.bincount(samples.split, minlength=3) / len(samples)
    split = np.full(len(samples), TRAIN, np.uint8)
    recording = samples.recordings
    for person in np.unique(samples.label):
        rows = np.flatnonzero(samples.label == person)
        places = dict(_places(recording[rows], activity[rows]))
        parts = {name: _part_at(place, shares) for name, place in places.items()}
        if len(places) > 1 and shares[VALIDATION] and VALIDATION not in parts.values():
            parts[max(places, key=lambda name: (places[name], name))] = VALIDATION
        if len(places) > 1 and TRAIN not in parts.values():
            parts[min(places, key=lambda name: (places[name], name))] = TRAIN
        split[rows] = [parts[name] for name in recording[rows]]
    return split


def _part_at(place: float, shares: Float) -> int:
    """Part of the split at a place from 0 to 1; the last recordings are tested."""
    if place < shares[TRAIN]:
        return TRAIN
    return VALIDATION if place < shares[TRAIN] + shares[VALIDATION] else TEST


def _places(recordings: Objects, activities: Objects) -> Iterator[tuple[str, float]]:
    """Place of each recording of a person, 0 to 1, evenly within each activity."""
    activity_of: dict[str, str] = {}
    for name, activity in zip(recordings, activities, strict=True):
        activity_of.setdefault(name, activity)
    for activity in sorted(set(activity_of.values())):
        names = [name for name, other in activity_of.items() if other == activity]
        names.sort(key=_hashed)
        offset = _hashed(f"{activity} {names[0]}")
        for number, name in enumerate(names):
            yield name, (number + offset) / len(names)


def _hashed(text: str) -> float:
    """Number from 0 to 1 that follows from a text alone."""
    digest = hashlib.blake2b(text.encode(), digest_size=8).digest()
    return int.from_bytes(digest, "big") / 2**64


def _activity_names(samples: SampleTable) -> Objects:
    """Activity in the name of each row [N], such as walking of walking/3."""
    return np.array([str(name).rpartition("/")[0] for name in samples.name], dtype=object)


def _natural_order(name: str) -> list[tuple[int, str]]:
    """Key that sorts person 2 before person 10."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", name)]


def rank_shares(truth: Index, probabilities: Float) -> Float:
    """Share of rows whose true class is among the likeliest 1, 2, ... [classes].

    Args:
        truth: numbers of the true classes [N].
        probabilities: probability of each class [N, classes].
    """
    true_probability = np.take_along_axis(probabilities, truth[:, None], 1)
    rank = (probabilities > true_probability).sum(1)
    counts = np.bincount(rank, minlength=probabilities.shape[1])
    return np.asarray(np.cumsum(counts) / truth.size)
