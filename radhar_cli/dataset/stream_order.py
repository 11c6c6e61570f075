"""The order of an endless stream of samples: every sample of every class once, classes in turn."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from radhar_cli.activity import Activity
from radhar_cli.arrays import Index
from radhar_cli.config.schema import Config
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.split import TRAIN, split_persons
from radhar_cli.errors import ConfigError


@dataclass(frozen=True)
class StreamOrder:
    """Number n of a stream -> (activity, index within its class), for n = 0, 1, 2, ..."""

    config: Config  # of the samples
    # "train" leaves out what the config's data set holds back: with named persons those who
    # validate or test; else it begins where the data set ends
    split: Literal["all", "train"] = "all"

    def __post_init__(self) -> None:
        if self.split == "train" and not self._persons.size:
            raise ConfigError("split.train: leaves no person to train with; should be larger")

    def __getitem__(self, number: int) -> tuple[Activity, int]:
        turn, place = divmod(number, len(self.activities))
        if self.split == "all":
            return self.activities[place], turn
        if self.config.split.subjects is not None:
            again, person = divmod(turn, self._persons.size)
            index = again * self.config.split.subjects + int(self._persons[person])
            return self.activities[place], index
        return self.activities[place], self._rows.counts[place] + turn

    @property
    def activities(self) -> tuple[Activity, ...]:
        """The classes of the stream."""
        return self._rows.activities

    @cached_property
    def _rows(self) -> Rows:
        return Rows.of(self.config)

    @cached_property
    def _persons(self) -> Index:
        """Named persons to train with; one who is none without names."""
        if self.config.split.subjects is None:
            return np.zeros(1, np.intp)
        return np.flatnonzero(split_persons(self.config) == TRAIN)
