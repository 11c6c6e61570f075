"""The PNG files of a data set: find missing ones, and write them."""

from pathlib import Path

import numpy as np

from radhar_cli.arrays import Index, Levels
from radhar_cli.config.schema import AnyConfig
from radhar_cli.dataset.batch import png_rows
from radhar_cli.dataset.image_tables import write_missing_tables
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.workers import parent_pid, run_tasks
from radhar_cli.progress import Progress

ROWS = 32  # rows per task


def write_missing_pngs(
    config: AnyConfig, folder: Path, split: Levels, source: Path, jobs: int, progress: Progress
) -> int:
    """Write PNGs, and the tables beside them, that are not there.

    They were asked for later, deleted, or lost with a killed run.

    Args:
        source: HDF5 file to make them from.

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
    some = [pairs[first : first + ROWS] for first in range(0, len(pairs), ROWS)]
    tasks = ((*where, rows, table, parent_pid()) for rows in some)
    for written in run_tasks(png_rows, tasks, min(jobs, len(some))):
        progress.advance(written)
    return missing.size * len(config.maps)


def rows_without_png(config: AnyConfig, folder: Path, split: Levels) -> Index:
    """Rows of which an image is missing."""
    rows = Rows.of(config)
    whole = (
        all((folder / rows.png_path(name, part, row)).exists() for name in config.maps)
        for row, part in enumerate(split.tolist())
    )
    return np.flatnonzero(~np.fromiter(whole, bool, len(rows)))
