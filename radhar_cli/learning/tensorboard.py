"""Curves of a training run for TensorBoard (`radhar train --tensorboard`)."""

import json
from collections.abc import Sequence
from pathlib import Path

from torch.utils.tensorboard import SummaryWriter

from radhar_cli.learning.run_files import EVENTS, TENSORBOARD
from radhar_cli.learning.run_folder import Epoch, RunMetadata


class TensorBoardCurves:
    """Event file of a run: its settings, and the epochs as they are done.

    A run that resumes writes the epochs before anew, so that none is there twice.
    """

    def __init__(self, folder: Path, metadata: RunMetadata, score: str) -> None:
        """Begin the event file in place of earlier ones.

        Args:
            folder: folder of the run.
            metadata: description of the run.
            score: name of its score.
        """
        self.score = score
        remove_events(folder)
        self._writer = SummaryWriter(folder / TENSORBOARD)
        settings = json.dumps(metadata.config, indent=2)
        text = f"{metadata.model} on {metadata.data['path']}\n\n```json\n{settings}\n```\n"
        self._writer.add_text("settings", text)

    def write(self, rows: Sequence[Epoch]) -> None:
        """Write epochs that are done."""
        for row in rows:
            for name, value in (
                ("loss/training", row.train_loss),
                ("loss/validation", row.val_loss),
                (f"{self.score}/training", row.train_accuracy),
                (f"{self.score}/validation", row.val_accuracy),
                ("learning rate", row.learning_rate),
                ("seconds an epoch", row.seconds),
            ):
                self._writer.add_scalar(name, value, row.epoch)
        self._writer.flush()

    def close(self) -> None:
        """Close the event file."""
        self._writer.close()


def remove_events(folder: Path) -> None:
    """Remove the event files of an earlier run in a folder."""
    for path in (folder / TENSORBOARD).glob(EVENTS):
        path.unlink()
