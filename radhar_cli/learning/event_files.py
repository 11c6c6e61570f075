"""A run's curves for TensorBoard: event files beside history.csv, which they follow."""

import time
from pathlib import Path

from torch.utils.tensorboard import SummaryWriter

from radhar_cli.learning.run_files import EVENTS
from radhar_cli.learning.run_folder import read_history, remove_events

SERIES = {
    "accuracy/training": "train_accuracy",
    "accuracy/validation": "val_accuracy",
    "loss/training": "train_loss",
    "loss/validation": "val_loss",
    "learning_rate": "learning_rate",
}


class EventFiles:
    """Event files in RUN/tensorboard; each process rewrites them from the first epoch on."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._writer: SummaryWriter | None = None
        self._written = 0

    def update(self) -> None:
        """Write the epochs that history.csv has and the event files have not.

        Raises:
            RunError: history.csv is damaged.
            FolderError: a symbolic link lies on the way.
        """
        rows = read_history(self._folder)
        if self._writer is None:
            remove_events(self._folder)
            # A running TensorBoard drops the points of deleted files.
            self._writer = SummaryWriter(self._folder / EVENTS, purge_step=0)
        at = time.time() - sum(row.seconds for row in rows[self._written :])
        for row in rows[self._written :]:
            at += row.seconds
            for name, column in SERIES.items():
                self._writer.add_scalar(name, getattr(row, column), row.epoch, walltime=at)
        self._writer.flush()
        self._written = len(rows)

    def close(self) -> None:
        """Close the file."""
        if self._writer is not None:
            self._writer.close()
