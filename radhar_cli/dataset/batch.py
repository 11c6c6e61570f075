"""What a worker does: synthesise consecutive rows, write their PNGs, then their shard."""

import os
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from radhar_cli.arrays import Levels
from radhar_cli.config.schema import Config
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.layout import Rows, png_path
from radhar_cli.dataset.png import encode_png
from radhar_cli.dataset.sample import synthesise
from radhar_cli.dataset.shards import encode_shard, write_shard
from radhar_cli.pipeline.products import plan_images
from radhar_cli.pipeline.validity import draw_valid_scene
from radhar_cli.process import prepare_process
from radhar_cli.scene import draw_scene


@dataclass(frozen=True)
class Batch:
    """Rows start .. stop - 1 and all that a worker needs to make them.

    Attributes:
        config: the data set's.
        folder: the output folder.
        start, stop: rows.
        attempts: which draw of each row is kept (`on_invalid: redraw`).
        split: split number of each row.
        table: colour table [256, 3], or None without PNGs.
        master: process that asked; a worker that outlives it stops.
    """

    config: Config
    folder: Path
    start: int
    stop: int
    attempts: tuple[int, ...]
    split: tuple[int, ...]
    table: Levels | None
    master: int


def leave_if_orphaned(master: int) -> None:
    """End a worker whose master was killed: nobody waits for it, and a new run may be at work."""
    if os.getpid() != master and os.getppid() != master and sys.platform != "win32":
        os._exit(1)


def run_batch(batch: Batch) -> int:
    """Make a batch; return its number of samples. The shard is renamed into place last."""
    try:
        return _run_batch(batch)
    except OSError:
        leave_if_orphaned(batch.master)
        raise


def _run_batch(batch: Batch) -> int:
    prepare_process()
    config, rows = batch.config, Rows.of(batch.config)
    plan = plan_images(config)
    scenes, samples = [], []
    for row, attempt, split in zip(
        range(batch.start, batch.stop), batch.attempts, batch.split, strict=True
    ):
        leave_if_orphaned(batch.master)
        activity, index = rows[row]
        scene = draw_scene(config, activity, index, attempt)
        sample = synthesise(scene, plan)
        if batch.table is not None:
            for name in config.maps:
                data = encode_png(sample[name].levels, batch.table, config.output.png_level)
                path = batch.folder / png_path(name, split, activity, index)
                write_whole(batch.folder, path, data)
        scenes.append(scene)
        samples.append(sample)
    values = scene_fields.values(scenes, scene_fields.fields(config))
    write_shard(batch.folder, batch.start, batch.stop, encode_shard(config, samples, values))
    return batch.stop - batch.start


def survey_rows(
    config: Config, start: int, stop: int, master: int
) -> tuple[int, list[tuple[int, int]]]:
    """Settle rows start .. stop - 1; return (start, outcome of each)."""
    prepare_process()
    leave_if_orphaned(master)
    rows = Rows.of(config)
    found = (draw_valid_scene(config, *rows[row]) for row in range(start, stop))
    return start, [(scene.attempt, int(flags)) for scene, flags in found]


def png_rows(
    config: Config,
    folder: Path,
    source: Path,
    first: int,
    rows: list[tuple[int, int]],
    table: Levels,
    master: int,
) -> int:
    """Write the PNGs of (row, split) pairs from an HDF5 file whose row 0 is row `first`."""
    import h5py

    order = Rows.of(config)
    with h5py.File(source, "r") as file:
        for row, split in rows:
            leave_if_orphaned(master)
            for name in config.maps:
                levels = np.asarray(file[f"maps/{name}"][row - first])
                path = folder / png_path(name, split, *order[row])
                write_whole(folder, path, encode_png(levels, table, config.output.png_level))
    return len(rows)
