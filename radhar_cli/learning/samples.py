"""A data set for PyTorch whose samples are synthesised, in the workers of a DataLoader."""

from pathlib import Path
from typing import Any

import numpy as np
from torch.utils.data import Dataset, get_worker_info

from radhar_cli.config.data_set import Config
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.layout import SPLITS, Rows
from radhar_cli.dataset.on_demand import Recipe
from radhar_cli.dataset.split import split_rows
from radhar_cli.errors import ConfigError
from radhar_cli.learning.images.image_set import SPLIT_NAMES, check_split_name
from radhar_cli.numerics.arrays import Index
from radhar_cli.processes.worker_process import prepare_process


class Samples(Dataset[dict[str, Any]]):
    """Rows of a data set without building it: each is synthesised when it is indexed.

    Row i is row i of the dataset.h5 that `radhar generate` would write, bit for bit, whichever
    process makes it; a DataLoader may shuffle them or share them out with DistributedSampler.

    Attributes:
        config: config of the data set.
        label: [N] place in `classes`, as in the dataset.h5.
        classes: name of every label, in the order of the config's `activities`.
        identity: hash of everything that determines the samples: config, seed, versions.
    """

    def __init__(
        self, config: Config | str | Path, seed: int | None = None, *, split: str = "all"
    ) -> None:
        """Prepare the samples of a config.

        Args:
            config: config of the data set, or its path.
            seed: seed instead of the config's.
            split: train, val or test; all takes every row.

        Raises:
            ConfigError: a config of measured data, or a split without samples.
        """
        self._recipe = Recipe.of(config, seed)
        self.config = self._recipe.config
        self._rows = Rows.of(self.config)
        numbers = np.arange(len(self._rows))
        if check_split_name(split) != "all":
            numbers = np.flatnonzero(split_rows(self.config) == SPLIT_NAMES[split])
        if not numbers.size:
            key = f"split.{SPLITS[SPLIT_NAMES[split]]}"
            raise ConfigError(f"{key}: leaves no sample for it; should be larger")
        self._numbers = numbers
        self.label: Index = self._rows.label[numbers]
        self.classes = self._rows.names
        self.identity = identity_hash(identity(self.config))

    def __len__(self) -> int:
        return len(self._numbers)

    def __repr__(self) -> str:
        maps, seed = ", ".join(self.config.maps), self.config.seed
        classes = ", ".join(self.classes[n] for n in np.unique(self.label))
        return f"<Samples: {len(self)} of {classes}, synthesised from seed {seed}; maps {maps}>"

    def __getitem__(self, row: int) -> dict[str, Any]:
        if get_worker_info() is not None:
            prepare_process()
        return self._recipe(*self._rows[int(self._numbers[row])])
