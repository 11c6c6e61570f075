"""Classes of single images, or of data sets whose labels nobody need know."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import torch

from radhar_cli.arrays import Levels
from radhar_cli.errors import FolderError
from radhar_cli.learning.evaluation import open_sized
from radhar_cli.learning.folder_images import SUFFIXES, our_table, read_image
from radhar_cli.learning.run_folder import About, load_best

BATCH = 32


def predict(
    run: Path, paths: Sequence[Path], device: torch.device, map_name: str | None, split: str
) -> Iterator[tuple[str, dict[str, float]]]:
    """Yield (name, probability of every class) for every image.

    Raises:
        RunError: no such run.
        FolderError: an image that cannot be read, or of another size.
    """
    about, model = load_best(run)
    model.to(device)
    for path in paths:
        if not path.exists():
            raise FolderError(f"{path}: no such file or folder")
        for names, pixels in _batches(about, path, map_name, split):
            with torch.inference_mode():
                levels = torch.from_numpy(np.ascontiguousarray(pixels.transpose(0, 3, 1, 2)))
                logits = model(about.normalisation(levels.to(device)))
                chances = logits.softmax(1).cpu().tolist()
            for name, row in zip(names, chances, strict=True):
                yield name, dict(zip(about.classes, row, strict=True))


def _batches(
    about: About, path: Path, map_name: str | None, split: str
) -> Iterator[tuple[list[str], Levels]]:
    """Names and RGB [B, H, W, 3] of the images of one path."""
    if path.is_file() and path.suffix.lower() in SUFFIXES:
        table = our_table(path) if about.input == "gray" else None
        yield [str(path)], read_image(path, about.input, about.size, table)[None]
        return
    images = open_sized(about, path, map_name)
    rows = images.rows(split)
    for start in range(0, rows.size, BATCH):
        chosen = rows[start : start + BATCH]
        pixels = np.stack([images.pixels.read(int(row)) for row in chosen])
        yield [images.names[row] for row in chosen], pixels
