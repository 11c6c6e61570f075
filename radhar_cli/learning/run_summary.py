"""metrics.json and curves.png of a finished run."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import torch

from radhar_cli.dataset.files import write_whole
from radhar_cli.figures.evaluation import curves_png
from radhar_cli.learning import run_files
from radhar_cli.learning.run_folder import Epoch, RunMetadata, best_epoch


def write_run_summary(
    folder: Path,
    metadata: RunMetadata,
    history: Sequence[Epoch],
    validation: Mapping[str, Any],
    device: torch.device,
) -> None:
    """Write metrics.json and curves.png of a finished run.

    Args:
        folder: folder of the run.
        metadata: description of the run.
        history: all epochs.
        validation: score of the best epoch and its interval, by their keys.
    """
    best = best_epoch(history)
    series = {folder.name or str(folder): history}
    task = metadata.task
    cost = metadata.cost
    metrics = {
        "model": metadata.model,
        "best_epoch": best.epoch,
        "score": task.score_name,
        **validation,
        "epoch_chosen_by": "val",
        "val_loss": best.val_loss,
        "epochs": len(history),
        "parameters": cost.parameters,
        "multiply_adds": cost.multiply_adds,
        "seconds": round(sum(epoch.seconds for epoch in history), 1),
        "classes": list(metadata.classes),
        "size_px": list(metadata.size),
        "map": metadata.map,
        "data": metadata.data,
        "config": metadata.config,
        "versions": metadata.versions,
        "device": device.type,
        "precision": metadata.work["precision"],
        "threads": torch.get_num_threads(),
    }
    curves = curves_png(series, {folder.name: best.epoch}, task.score_name, task.loss_name)
    write_whole(folder, folder / run_files.CURVES, curves)
    # Last: it stands for a finished run.
    write_whole(folder, folder / run_files.METRICS, (json.dumps(metrics, indent=2) + "\n").encode())
