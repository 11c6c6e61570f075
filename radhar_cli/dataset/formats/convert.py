"""A data set in a format that other tools read; the new folder appears when it is whole."""

import os
import tempfile
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import TypeAlias

from radhar_cli.dataset.card import owner_licence
from radhar_cli.dataset.reading import Dataset, open_dataset
from radhar_cli.errors import FolderError, UnfinishedError
from radhar_cli.progress import Progress

FORMATS = ("webdataset", "parquet", "npy", "mat")
Writer: TypeAlias = Callable[[Dataset, Path, Progress], None]


def convert(path: Path, out: Path, to: str, progress: Progress) -> int:
    """Write a data set in another format; return its number of samples.

    Args:
        path: folder that `generate` wrote, or dataset.h5.
        out: folder to make.
        to: one of FORMATS.
        progress: receives progress.

    Raises:
        FolderError: the data set cannot be read or is damaged, or there is something at `out`.
        UnfinishedError: `out` cannot be written.
    """
    if out.exists() or out.is_symlink():
        raise FolderError(f"{out}: already exists; -o should name a new folder")
    write: Writer = import_module(f"radhar_cli.dataset.formats.{to}").write
    with open_dataset(path) as data:
        owner_licence(data.path.parent)  # refused before anything is written
        out.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{out.name}.", dir=out.parent) as scratch:
            unfinished = Path(scratch, "set")
            unfinished.mkdir()
            progress.stage(to, len(data), 0)
            try:
                write(data, unfinished, progress)
            except OSError as error:  # its name is one in the scratch folder, or none
                why = os.strerror(error.errno) if error.errno else error
                raise UnfinishedError(f"{out}: {why}; nothing was written") from None
            unfinished.rename(out)
        return len(data)
