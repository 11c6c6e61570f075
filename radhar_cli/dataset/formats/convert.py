"""A data set in a format that other tools read; the new folder appears when it is whole."""

import os
import shutil
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import TypeAlias

from radhar_cli.dataset.folder import folder_lock
from radhar_cli.dataset.reading import Dataset, open_dataset
from radhar_cli.errors import FolderError, UnfinishedError
from radhar_cli.files.replacing import refuse_links
from radhar_cli.processes.progress import Progress

# Module and function of each format; the function refuses what a data set of it must have.
FORMATS = {
    "parquet": ("parquet", "write"),
    "webdataset": ("webdataset", "write"),
    "mars": ("clouds", "write_mars"),
    "ros": ("clouds", "write_ros"),
    "ti": ("clouds", "write_ti"),
}
Writer: TypeAlias = Callable[[Dataset, Path, Progress], None]


def convert(path: Path, out: Path, to: str, progress: Progress) -> int:
    """Write a data set in another format; return its number of samples.

    Args:
        path: data set, its folder or dataset.h5.
        out: new folder, which appears when it is complete.
        to: the format, one of FORMATS.
        progress: is told of every sample.

    Raises:
        FolderError: there is no data set, it lacks points, or `out` exists.
        UnfinishedError: the disk is full or cannot be written.
    """
    if out.exists() or out.is_symlink():
        raise FolderError(f"{out}: already exists; -o should name a new folder")
    module, function = FORMATS[to]
    write: Writer = getattr(import_module(f"radhar_cli.dataset.formats.{module}"), function)
    with open_dataset(path) as data:
        scratch = out.absolute().with_name(f".{out.name}.unfinished")
        refuse_links(scratch.parent, scratch)
        unfinished = scratch / "set"
        with folder_lock(scratch):
            shutil.rmtree(unfinished, ignore_errors=True)  # of a run that was killed
            try:
                unfinished.mkdir()
                progress.stage(to, len(data), 0)
                write(data, unfinished, progress)
                unfinished.rename(out)
            except OSError as error:  # its name is one in the scratch folder, or none
                why = os.strerror(error.errno) if error.errno else error
                raise UnfinishedError(f"{out}: {why}; nothing was written") from None
            finally:
                shutil.rmtree(scratch, ignore_errors=True)
        return len(data)
