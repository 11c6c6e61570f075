"""metrics.json, summary.txt and curves.png: a finished run for programs and for readers."""

import json
from collections.abc import Sequence
from pathlib import Path

import torch
from torch import nn

from radhar_cli.dataset.files import write_whole
from radhar_cli.figures.evaluation import curves_png
from radhar_cli.learning import run_files
from radhar_cli.learning.metrics import wilson
from radhar_cli.learning.run_folder import Epoch, RunMetadata, best_epoch
from radhar_cli.learning.targets import LOSSES, SCORES


def write_run_summary(
    folder: Path,
    metadata: RunMetadata,
    history: Sequence[Epoch],
    model: nn.Module,
    device: torch.device,
) -> None:
    """Write metrics.json, summary.txt and curves.png of a finished run."""
    best, count = best_epoch(history), int(metadata.data["val"])
    settings, series = metadata.settings, {folder.name or str(folder): history}
    interval, score = None, SCORES[settings.target]
    found = f"{score} {100 * best.val_accuracy:.2f} %"
    if score == "accuracy":
        interval = wilson(round(best.val_accuracy * count), count)
        found += f" (95 % interval {100 * interval[0]:.2f} to {100 * interval[1]:.2f} %)"
    price = metadata.cost
    metrics = {
        "model": metadata.model,
        "best_epoch": best.epoch,
        "score": score,
        "val_accuracy": best.val_accuracy,
        "val_accuracy_95": interval,
        "val_loss": best.val_loss,
        "epochs": len(history),
        "parameters": price.parameters,
        "multiply_adds": price.multiply_adds,
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
    lines = [
        f"{metadata.model} on {metadata.data['path']}"
        + (f", map {metadata.map}" if metadata.map else "")
        + f", {metadata.shape}, {len(metadata.classes)} classes",
        f"{metadata.data['train']} training and {count} validation images",
        f"best epoch {best.epoch} of {len(history)}: validation {found}, loss {best.val_loss:.4f}",
        f"{price.parameters:,} parameters, {price.multiply_adds / 1e9:.3f} G multiply-adds",
        f"{metrics['seconds']} s on {metrics['device']}, {metrics['precision']}, "
        f"{metrics['threads']} threads, batch {settings.images_a_step}",
        "",
        *_layer_table(model),
    ]
    write_whole(folder, folder / run_files.SUMMARY, ("\n".join(lines) + "\n").encode())
    # Last: it stands for a finished run.
    write_whole(folder, folder / run_files.METRICS, (json.dumps(metrics, indent=2) + "\n").encode())


def _layer_table(model: nn.Module) -> list[str]:
    """Every layer with parameters of its own: name, kind, shapes, number."""
    rows = [("layer", "kind", "parameters", "shapes")]
    for name, layer in model.named_modules():
        own = list(layer.parameters(recurse=False))
        if own:
            shapes = " ".join("x".join(map(str, p.shape)) for p in own)
            rows.append((name, type(layer).__name__, f"{sum(p.numel() for p in own):,}", shapes))
    widths = [max(len(row[column]) for row in rows) for column in range(3)]
    return [
        f"{a:<{widths[0]}}  {b:<{widths[1]}}  {c:>{widths[2]}}  {shapes}"
        for a, b, c, shapes in rows
    ]
