"""Batches of a worker: synthesis of consecutive rows, their PNGs, then their shard."""

import os
import platform
from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.config.data_set import AnyConfig, Config, MeasuredConfig
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.identity import identity, identity_hash, versions
from radhar_cli.dataset.layout import IDENTITY, WORK, Rows
from radhar_cli.dataset.png import encode_png
from radhar_cli.dataset.sample import RowFactory, SampleRow, StoredSample, synthesise
from radhar_cli.dataset.shards import encode_shard, write_shard
from radhar_cli.dataset.workers import NO_PARENT
from radhar_cli.errors import MachineError
from radhar_cli.numerics.arrays import Levels
from radhar_cli.processes.progress import NO_PROGRESS, Progress
from radhar_cli.processes.time_limit import time_limit
from radhar_cli.processes.worker_process import prepare_process
from radhar_cli.readers.untrusted_hdf5 import UntrustedFile
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.checks.flags import Flags
from radhar_cli.scene.checks.warnings import collect_warnings
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.scene import Scene

CHECKED_SCENES = 24  # before a build; each is checked as it is made


@dataclass(frozen=True)
class Batch:
    """Rows start .. stop - 1 of a data set, and all that a worker needs to make them."""

    config: AnyConfig
    identity_hash: str
    folder: Path  # the output folder, absolute: a worker may have another working directory
    start: int
    stop: int
    split: Levels
    table: Levels | None  # colour table [256, 3], or None without PNGs
    parent_pid: int  # process that asked; a worker that outlives it stops. NO_PARENT: on a cluster
    factory: RowFactory | None = None


def check_scenes(
    config: Config, seconds: float = inf, progress: Progress = NO_PROGRESS
) -> tuple[list[Scene], list[dict[str, Any]]]:
    """Draw CHECKED_SCENES scenes, spread over the classes, and check them.

    Args:
        config: that of the data set.
        seconds: no more scenes are drawn when that time is over; the first ones are of all classes.
        progress: is told of every scene.

    Returns:
        The scenes, and their warnings.
    """
    rows, drawn = Rows.of(config), list[tuple[Scene, Flags]]()
    places = rows.spread_progressively(CHECKED_SCENES)
    progress.stage("checking scenes", len(places), 0, "scene")
    with time_limit(seconds):
        for row in places:
            drawn.append(draw_valid_scene(config, *rows[row]))
            progress.advance(1)
    counts = {flag: sum(flag in flags for _, flags in drawn) for flag in Flags}
    # Without the motions that they hold.
    return [replace(scene) for scene, _ in drawn], collect_warnings(config, counts, len(drawn))


def leave_if_orphaned(parent_pid: int) -> None:
    """End this worker if its parent was killed: a new run may be at work."""
    if parent_pid == NO_PARENT:
        return
    if os.getpid() != parent_pid and os.getppid() != parent_pid:
        os._exit(1)


def run_batch(batch: Batch) -> int:
    """Make a batch: its PNG files, then its shard; return the number of samples.

    Raises:
        MachineError: this worker of a cluster has other versions, or does not see the folder.
    """
    prepare_process()
    if batch.parent_pid == NO_PARENT:
        _check_machine(batch)
    try:
        return _write_batch(batch)
    except OSError:
        leave_if_orphaned(batch.parent_pid)
        raise


def _write_batch(batch: Batch) -> int:
    """Write the PNG files of a batch, then its shard; return the number of samples."""
    config, rows = batch.config, Rows.of(batch.config)
    made_rows = []
    for number, row in enumerate(_make_rows(batch)):
        if batch.table is not None:
            for name, image in row.sample.images.items():
                data = encode_png(image.levels, batch.table, config.output.png_level)
                path = rows.png_path(name, int(batch.split[number]), batch.start + number)
                write_whole(batch.folder, batch.folder / path, data)
        activity, _ = rows[batch.start + number]
        flags = _flags_of_sample(row.sample)
        if activity.is_nobody:  # whose maps without noise are black
            flags &= ~Flags.BLACK
        made_rows.append(row._replace(flags=row.flags | flags))
    data = encode_shard(config, batch.identity_hash, batch.start, made_rows)
    write_shard(batch.folder, batch.start, batch.stop, data)
    return batch.stop - batch.start


def _flags_of_sample(sample: StoredSample) -> Flags:
    """Flags that are known of a sample once it is made: by the cube, with a map of one level."""
    flags = Flags(0)
    if sample.fell_back:
        flags |= Flags.FALLBACK
    if not all(image.levels.any() for image in sample.images.values()):
        flags |= Flags.BLACK
    if any(image.levels.min() == 255 for image in sample.images.values()):
        flags |= Flags.WHITE
    return flags


def _check_machine(batch: Batch) -> None:
    """Refuse a machine that would make other bytes, or make them elsewhere."""
    if identity_hash(identity(batch.config)) != batch.identity_hash:
        own_versions = ", ".join(f"{library} {version}" for library, version in versions().items())
        raise MachineError(
            f"the worker on {platform.node()} has other versions, {own_versions}; should "
            "have those of `radhar --version` here"
        )
    if not (batch.folder / WORK / IDENTITY).exists():
        raise MachineError(f"the worker on {platform.node()} does not see {batch.folder}")


def _make_rows(batch: Batch) -> Iterator[SampleRow]:
    """Make each row of a batch; its flags are those of its scene."""
    config, rows = batch.config, Rows.of(batch.config)
    if isinstance(config, Config):
        plan, columns = plan_images(config), scene_fields.fields(config)
    for row in range(batch.start, batch.stop):
        leave_if_orphaned(batch.parent_pid)
        if isinstance(config, MeasuredConfig):
            assert batch.factory is not None
            yield batch.factory(config, row)
            continue
        scene, flags = draw_valid_scene(config, *rows[row])
        sample = synthesise(scene, plan, config)
        values = scene_fields.values(scene, columns, sample.error_db)
        yield SampleRow(sample, values, flags)


def write_png_rows(
    config: AnyConfig,
    folder: Path,
    source: Path,
    rows: list[tuple[int, int]],
    table: Levels,
    parent_pid: int,
) -> int:
    """Write the PNG files of some rows, from the levels in a data set's HDF5 file.

    Args:
        config: that of the data set.
        folder: output folder.
        source: the HDF5 file.
        rows: (row, number of its split) of each sample.
        table: colour table [256, 3].
        parent_pid: process without which this one should stop.

    Returns:
        Number of rows.
    """
    order = Rows.of(config)
    shape = (len(order), *config.image.size_px)
    with UntrustedFile(source) as file:
        images = {name: file.chunks(f"maps/{name}", np.uint8, shape) for name in config.maps}
        for row, split in rows:
            leave_if_orphaned(parent_pid)
            for name in config.maps:
                data = encode_png(images[name][row], table, config.output.png_level)
                write_whole(folder, folder / order.png_path(name, split, row), data)
    return len(rows)
