"""metrics.json and curves.png of a finished run."""

import json
from collections.abc import Sequence
from pathlib import Path

import torch

from radhar_cli.dataset.files import write_whole
from radhar_cli.figures.evaluation import curves_png
from radhar_cli.learning import run_files
from radhar_cli.learning.metrics import wilson
from radhar_cli.learning.run_folder import Epoch, RunMetadata, best_epoch
from radhar_cli.learning.settings import Target
from radhar_cli.learning.targets import LOSSES, SCORES


def _score(
    target: Target, value: float, interval: tuple[float, float] | None
) -> dict[str, float | tuple[float, float] | None]:
    """Validation score under its name in metrics.json; only an accuracy has an interval."""
    match target:
        case "skeleton":
            return {"val_within_15_cm": value}
        case "labels":
            return {"val_exact_match": value}
    return {"val_accuracy": value, "val_accuracy_95": interval}


def write_run_summary(
    folder: Path, metadata: RunMetadata, history: Sequence[Epoch], device: torch.device
) -> None:
    """Write metrics.json and curves.png of a finished run."""
    best, count = best_epoch(history), int(metadata.data["val"])
    settings, series = metadata.settings, {folder.name or str(folder): history}
    score, cost = SCORES[settings.target], metadata.cost
    interval = wilson(round(best.val_accuracy * count), count) if score == "accuracy" else None
    metrics = {
        "model": metadata.model,
        "best_epoch": best.epoch,
        "score": score,
        **_score(settings.target, best.val_accuracy, interval),
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
    curves = curves_png(series, {folder.name: best.epoch}, score, LOSSES[settings.target])
    write_whole(folder, folder / run_files.CURVES, curves)
    # Last: it stands for a finished run.
    write_whole(folder, folder / run_files.METRICS, (json.dumps(metrics, indent=2) + "\n").encode())
