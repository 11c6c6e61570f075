"""Data sets from Python: `radhar.generate`."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from radhar_cli.config.data_set import Config
from radhar_cli.config.reading import load_radars
from radhar_cli.dataset.build import build
from radhar_cli.dataset.estimate import jobs_that_pay
from radhar_cli.dataset.radar_folders import reserve_radars
from radhar_cli.dataset.reading import Dataset, open_dataset
from radhar_cli.processes.progress import NO_PROGRESS, Progress
from radhar_cli.processes.worker_process import prepare_process


def generate(
    config: Config | str | Path | Mapping[str, Any],
    folder: str | Path,
    *,
    jobs: int | None = None,
    overwrite: bool = False,
    progress: Progress = NO_PROGRESS,
) -> Dataset:
    """Build a data set, or resume it, as the command `radhar generate`, and open it.

    Args:
        config: a config, or what `load_config` reads it from.
        folder: folder of the data set. If `config` has several radars, each has a folder in it, and
            the data set of the first is opened.
        jobs: number of worker processes; None is as many as pay.
        overwrite: start over where the folder holds another data set.
        progress: is told of stages, samples and warnings.

    Raises:
        ConfigError: as `load_config`.
        FolderError: the folder holds other files or another data set, or another run writes there.
        UnfinishedError: the disk is full or cannot be written; the same call resumes.
    """
    configs = {"": config} if isinstance(config, Config) else load_radars(config)
    folder = Path(folder)
    folders = {"": folder} if [*configs] == [""] else reserve_radars(folder, configs)
    prepare_process()
    for name, of_radar in configs.items():
        build(of_radar, folders[name], jobs or jobs_that_pay(of_radar), progress, overwrite)
    return open_dataset(next(iter(folders.values())))
