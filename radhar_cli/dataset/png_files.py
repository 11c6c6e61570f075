"""The PNG files of a data set: find missing ones, and write them."""

from pathlib import Path

import numpy as np

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.dataset.batch import write_png_rows
from radhar_cli.dataset.image_tables import write_missing_tables
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.workers import parent_pid, run_tasks
from radhar_cli.numerics.arrays import Index, Levels
from radhar_cli.processes.progress import Progress

ROWS = 32  # rows per task


def write_missing_pngs(
    config: AnyConfig, folder: Path, split: Levels, source: Path, jobs: int, progress: Progress
) -> int:
    """Write the PNG files, and the tables beside them, that an output folder lacks.

    They were asked for later, deleted, or lost with a killed run.

    Args:
        config: that of the data set.
        folder: output folder.
        split: number of the split of each row [N].
        source: HDF5 file that holds the levels.
        jobs: number of processes.
        progress: is told of every row.

    Returns:
        Number of PNGs written; none where the config asks for none.
    """
    if not config.output.png:
        return 0
    write_missing_tables(config, folder, split)
    missing = rows_without_png(config, folder, split)
    if not missing.size:
        return 0
    progress.stage("png", missing.size, 0)
    where, table = (config, folder, source), colour_table(config.image.colour_map)
    pairs = list(zip(missing.tolist(), split[missing].tolist(), strict=True))
    batches = [pairs[first : first + ROWS] for first in range(0, len(pairs), ROWS)]
    tasks = ((*where, rows, table, parent_pid()) for rows in batches)
    for written in run_tasks(write_png_rows, tasks, min(jobs, len(batches))):
        progress.advance(written)
    return missing.size * len(config.maps)


def rows_without_png(config: AnyConfig, folder: Path, split: Levels) -> Index:
    """Rows of which a PNG file is missing."""
    rows = Rows.of(config)
    is_complete = (
        all((folder / rows.png_path(name, part, row)).exists() for name in config.maps)
        for row, part in enumerate(split.tolist())
    )
    return np.flatnonzero(~np.fromiter(is_complete, bool, len(rows)))
