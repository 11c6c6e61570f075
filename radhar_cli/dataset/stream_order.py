"""The order of an endless stream of samples: every sample of every class once, classes mixed."""

from dataclasses import dataclass
from functools import cached_property
from math import gcd
from typing import Literal

import numpy as np

from radhar_cli.activity import Activity
from radhar_cli.arrays import Index
from radhar_cli.config.schema import Config
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.split import TRAIN, split_persons, split_rows
from radhar_cli.errors import ConfigError
from radhar_cli.randomness import ORDER, stream


@dataclass(frozen=True)
class StreamOrder:
    """Number n of a stream -> (activity, index within its class), for n = 0, 1, 2, ...

    A round has every class as often as the smallest whole numbers in the ratio of
    `samples_per_class` say, once each where they are equal, shuffled; the indices of a class are
    counted upwards. So the first N samples are the N of the config's data set, in another order,
    and those after them are new.

    Attributes:
        config: of the samples; its seed decides the order too.
        split: "train" leaves out what the data set's split gives to validation or test: those
            samples, or with named persons all samples of those persons.
        balanced: every class equally often, whatever `samples_per_class` says.
    """

    config: Config
    split: Literal["all", "train"] = "all"
    balanced: bool = False

    def __post_init__(self) -> None:
        if self.split == "train" and not self._persons.size:
            raise ConfigError("split.train: leaves no person to train with; should be larger")

    def __getitem__(self, number: int) -> tuple[Activity, int]:
        turn, place = divmod(number, int(self._shares.sum()))
        which, times = self._round(turn)
        label = int(which[place])
        nth = turn * int(self._shares[label]) + int(times[place])
        return self._rows.activities[label], self._index(label, nth)

    def number(self, activity: Activity, index: int) -> int | None:
        """Number of a sample in the stream; None where it is left out."""
        label = self._rows.activities.index(activity)
        nth = self._nth(label, index)
        if nth is None:
            return None
        turn, before = divmod(nth, int(self._shares[label]))
        which, times = self._round(turn)
        place = np.flatnonzero((which == label) & (times == before))[0]
        return turn * which.size + int(place)

    @property
    def activities(self) -> tuple[Activity, ...]:
        """The classes of the stream."""
        return self._rows.activities

    @cached_property
    def _rows(self) -> Rows:
        return Rows.of(self.config)

    @cached_property
    def _shares(self) -> Index:
        counts = [1] * len(self._rows.counts) if self.balanced else self._rows.counts
        return np.array(counts, dtype=np.intp) // gcd(*counts)

    def _round(self, turn: int) -> tuple[Index, Index]:
        """Of every place of a round: the class, and how many of that class come before it."""
        kept: dict[int, tuple[Index, Index]] = self.__dict__.setdefault("_kept", {})
        if turn not in kept:
            rng = stream(self.config.seed, ORDER, turn, name="stream")
            which = rng.permutation(np.repeat(np.arange(self._shares.size), self._shares))
            times = np.empty_like(which)
            by_class = np.argsort(which, kind="stable")
            times[by_class] = np.concatenate([np.arange(share) for share in self._shares])
            kept.clear()
            kept[turn] = which, times
        return kept[turn]

    def _index(self, label: int, nth: int) -> int:
        """Index within its class of the nth sample that a stream has of it."""
        if self.split == "all":
            return nth
        if self.config.split.subjects is not None:
            again, person = divmod(nth, self._persons.size)
            return again * self.config.split.subjects + int(self._persons[person])
        train = self._trained_with[label]
        beyond = nth - train.size
        return int(train[nth]) if beyond < 0 else self._rows.counts[label] + beyond

    def _nth(self, label: int, index: int) -> int | None:
        """The inverse of `_index`."""
        if self.split == "all":
            return index
        if self.config.split.subjects is not None:
            again, person = divmod(index, self.config.split.subjects)
            at = int(np.searchsorted(self._persons, person))
            there = at < self._persons.size and self._persons[at] == person
            return again * self._persons.size + at if there else None
        train, beyond = self._trained_with[label], index - self._rows.counts[label]
        if beyond >= 0:
            return train.size + beyond
        at = int(np.searchsorted(train, index))
        return at if at < train.size and train[at] == index else None

    @cached_property
    def _persons(self) -> Index:
        """Named persons to train with; one who is none without names."""
        if self.config.split.subjects is None:
            return np.zeros(1, np.intp)
        return np.flatnonzero(split_persons(self.config) == TRAIN)

    @cached_property
    def _trained_with(self) -> list[Index]:
        """Of each class, the indices that the split of the data set gives to training."""
        split = split_rows(self.config)
        return [np.flatnonzero(split[here] == TRAIN) for _, here in self._rows.classes()]
