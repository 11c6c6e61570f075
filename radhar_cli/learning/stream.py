"""Data sets for PyTorch that synthesise their samples, in the workers of a DataLoader."""

import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Literal

import numpy as np
from torch.utils.data import Dataset, IterableDataset, get_worker_info

from radhar_cli.activity import Activity
from radhar_cli.arrays import Index
from radhar_cli.config.schema import Config
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.on_demand import Recipe, whole
from radhar_cli.dataset.split import TRAIN, split_persons, split_rows
from radhar_cli.errors import ConfigError
from radhar_cli.learning.images.image_set import SPLIT_NAMES, split_named
from radhar_cli.worker_process import prepare_process


class Samples(Dataset[dict[str, Any]]):
    """The rows of a data set without building it: each is synthesised when it is indexed.

    Row i is row i of the dataset.h5 that `radhar generate` would write, bit for bit, whichever
    process makes it; a DataLoader may shuffle them or share them out with DistributedSampler.

    Attributes:
        config: of the data set.
        label: [N] place in `class_slugs`.
        class_slugs: slug of every label.
        identity: hash of all that decides the samples: config, seed, versions.
    """

    def __init__(
        self,
        config: Config | str | Path,
        seed: int | None = None,
        *,
        fields: Iterable[str] | None = None,
        split: str = "all",
    ) -> None:
        """The samples of a config.

        Args:
            config: of the data set, or its path.
            seed: instead of the config's.
            fields: names in dataset.h5 of what an item has (`radhar_cli.sample`).
            split: train, val or test, for those rows alone.

        Raises:
            ConfigError: an unknown field, a config of measured data, a split without samples.
        """
        self._recipe = Recipe.of(config, fields, seed)
        self.config = self._recipe.config
        self._rows = Rows.of(self.config)
        numbers = np.arange(len(self._rows))
        if split_named(split) != "all":
            numbers = np.flatnonzero(split_rows(self.config) == SPLIT_NAMES[split])
        if not numbers.size:
            raise ConfigError(f"split.{split}: leaves no sample for it; should be larger")
        self._numbers = numbers
        labels = [activity.index for activity in self._rows.activities]
        self.label: Index = np.repeat(labels, self._rows.counts)[numbers]
        self.class_slugs = self._recipe.class_slugs
        self.identity = identity_hash(identity(self.config))

    def __len__(self) -> int:
        return len(self._numbers)

    def __getitem__(self, row: int) -> dict[str, Any]:
        prepare_worker()
        return self._recipe(*self._rows[int(self._numbers[row])])


class Stream(IterableDataset[dict[str, Any]]):
    """Samples without end, for a DataLoader: each (seed, class, index) once, classes in turn.

    Workers and ranks take batches in turn. With `batch_size` the DataLoader's, the batches of a
    rank are the same for any number of workers; samples are the same in any case. A stream is
    iterated over once; to go on with it later, `start` counts what was seen: batches * batch_size
    * ranks.

    A scene outside the model is kept, drawn again or ends the stream, as `on_invalid` says.

    Attributes:
        config: of the samples, with the seed of the stream.
        class_slugs: slug of every label.
        identity: hash of all that decides the samples: config, seed, versions.
        start: number of the first sample, over all ranks.
    """

    def __init__(
        self,
        config: Config | str | Path,
        seed: int | None = None,
        *,
        fields: Iterable[str] | None = None,
        split: Literal["all", "train"] = "all",
        batch_size: int = 1,
        start: int = 0,
        shard: tuple[int, int] | None = None,
    ) -> None:
        """A stream of a config.

        Args:
            config: of the samples, or its path.
            seed: instead of the config's.
            fields: names in dataset.h5 of what an item has (`radhar_cli.sample`).
            split: "train" leaves out what the data set's split holds back.
            batch_size: the DataLoader's.
            start: number of the first sample.
            shard: (rank, ranks), if not those of torch.distributed or torchrun.

        Raises:
            ConfigError: an unknown field, a config of measured data, numbers out of range.
        """
        self._recipe = Recipe.of(config, fields, seed)
        self.config = self._recipe.config
        if split not in ("all", "train"):
            raise ConfigError(
                f"split = {split!r}: should be all or train; the other splits are finite"
            )
        rows, subjects = Rows.of(self.config), self.config.split.subjects
        self._activities, self._first = rows.activities, (0,) * len(rows.activities)
        self._people, self._shown = 1, np.zeros(1, np.intp)  # persons in turn; those of the stream
        if split == "train" and subjects is None:
            self._first = rows.counts  # where the config's data set ends
        elif subjects is not None and split == "train":
            trained = split_persons(self.config) == TRAIN
            self._people, self._shown = subjects, np.flatnonzero(trained)
            if not self._shown.size:
                raise ConfigError("split.train: leaves no person to train with; should be larger")
        self._batch_size, self.start = whole("batch_size", batch_size, 1), whole("start", start)
        self._shard = None if shard is None else _checked_shard(shard)
        self.class_slugs = self._recipe.class_slugs
        self.identity = identity_hash(identity(self.config))

    def __iter__(self) -> Iterator[dict[str, Any]]:
        prepare_worker()
        worker = get_worker_info()
        rank, ranks = self._shard or _rank()
        batch, step = (worker.id, worker.num_workers) if worker is not None else (0, 1)
        while True:
            first = self.start + (batch * ranks + rank) * self._batch_size
            for number in range(first, first + self._batch_size):
                yield self._recipe(*self._key(number))
            batch += step

    def _key(self, number: int) -> tuple[Activity, int]:
        """Class and index of a sample: classes in turn, indices upwards."""
        turn, place = divmod(number, len(self._activities))
        again, person = divmod(turn, self._shown.size)
        index = again * self._people + int(self._shown[person])
        return self._activities[place], self._first[place] + index

    def __getstate__(self) -> dict[str, Any]:
        # A spawned worker belongs to no process group.
        return {**self.__dict__, "_shard": self._shard or _rank()}


def _checked_shard(shard: tuple[int, int]) -> tuple[int, int]:
    try:
        rank, ranks = (whole("shard", number) for number in shard)
    except (TypeError, ValueError, ConfigError):
        rank = ranks = 0
    if rank >= ranks:
        raise ConfigError(
            f"shard = {shard!r}: should be (rank, ranks) with rank from 0 to ranks - 1"
        )
    return rank, ranks


def _rank() -> tuple[int, int]:
    """(rank, ranks) of this process, (0, 1) where it is alone."""
    import torch.distributed as dist

    if dist.is_available() and dist.is_initialized():
        return dist.get_rank(), dist.get_world_size()
    return int(os.environ.get("RANK", 0)), int(os.environ.get("WORLD_SIZE", 1))


def prepare_worker() -> None:
    """Prepare this process for synthesis if it is a worker of a DataLoader; else leave it."""
    if get_worker_info() is not None:
        prepare_process()
