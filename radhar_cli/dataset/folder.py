"""The output folder: one run at a time, only its own data set, and its finished parts."""

import json
import os
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.dataset import layout
from radhar_cli.dataset.files import refuse_foreign_work, unfinished_path, write_whole
from radhar_cli.dataset.identity import differences, identity
from radhar_cli.dataset.layout import WORK
from radhar_cli.errors import FolderError, RadharError
from radhar_cli.files.replacing import UNFINISHED, refuse_links
from radhar_cli.files.untrusted import read_json


def refuse_file(folder: Path) -> None:
    """Refuse an output folder that is a file."""
    if folder.exists() and not folder.is_dir():
        raise FolderError(f"{folder}: is a file; -o should name a folder")


@contextmanager
def folder_lock(folder: Path) -> Iterator[None]:
    """Hold an output folder; a second run on it is refused. A dead run's lock is free at once.

    On exit unfinished files are removed, also those of runs that were killed before.

    Raises:
        FolderError: another run holds it, or it cannot be made.
    """
    refuse_file(folder)
    refuse_links(folder, folder / WORK)
    try:
        (folder / WORK).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FolderError(f"{folder}: cannot be made ({error.strerror})") from None
    refuse_foreign_work(folder)
    lock = FileLock(folder / WORK / "lock")
    try:
        with lock.acquire(timeout=0):
            try:
                yield
            finally:
                remove_unfinished(folder)
    except Timeout:
        raise FolderError(
            f"{folder}: another run is writing here; wait for it or stop it"
        ) from None


def reserve(
    folder: Path,
    config: AnyConfig,
    overwrite: bool,
    part: str | None = None,
    allowed: tuple[str, ...] = (),
) -> None:
    """Take a locked folder for the data set of a config.

    Args:
        folder: output folder.
        config: that of the data set.
        overwrite: remove an earlier build of radhar.
        part: the part of the data set that is built, K/N; None for all of it.
        allowed: names that a folder without a data set may hold already.

    Raises:
        FolderError: the folder holds other files, or another data set.
    """
    new = identity(config) | ({} if part is None else {"part": part})
    if overwrite:
        _remove_old_build(folder, new)
    old = stored_identity(folder)
    if old is None:
        if layout.PARTS not in allowed and (folder / layout.PARTS).exists():
            raise FolderError(
                f"{folder}: holds parts of a data set; `radhar merge {folder}` puts them together, "
                "--shard K/N makes one"
            )
        refuse_foreign_files(folder, "radhar data set", (WORK, layout.RECORDINGS, *allowed))
        _write_identity(folder, new)
    elif holds_samples(folder):
        refuse_differences(folder, "data set", differences(old, new))
    else:
        _write_identity(folder, new)
    remove_unfinished(folder)


def remove_unfinished(folder: Path) -> None:
    """Remove files that were not finished, in a folder that this process holds."""
    shutil.rmtree(unfinished_path(folder).parent, ignore_errors=True)


def refuse_foreign_files(
    folder: Path,
    content: str,
    allowed: Sequence[str] = (WORK,),
    error: type[RadharError] = FolderError,
) -> None:
    """Refuse a folder that holds other files than those that radhar leaves there.

    Args:
        content: content that it lacks, for the message: "radhar data set".
        allowed: names that it may hold.
        error: type of the error.

    Raises:
        RadharError: it holds others.
    """
    held = sorted(path.name for path in folder.iterdir()) if folder.is_dir() else []
    names = [name for name in held if name not in allowed and not name.startswith(UNFINISHED)]
    if names:
        raise error(
            f"{folder}: holds {', '.join(names[:5])} but no {content}; choose an empty folder"
        )


def refuse_differences(
    folder: Path, content: str, differing: list[str], error: type[RadharError] = FolderError
) -> None:
    """Refuse a folder that holds another data set, or another run.

    Args:
        content: content that it holds, for the message: "data set".
        differing: a line for each difference; none of them is no reason to refuse.
        error: type of the error.

    Raises:
        RadharError: there are differences.
    """
    if differing:
        raise error(
            f"{folder}: holds another {content}; it differs in\n  "
            + "\n  ".join(differing)
            + "\nchoose another folder, or --overwrite to start this one over"
        )


def _write_identity(folder: Path, named: dict[str, Any]) -> None:
    """Write the identity of the data set that a folder is taken for."""
    # In the order of the config, which `merge` writes into dataset.h5.
    write_whole(folder, folder / WORK / layout.IDENTITY, json.dumps(named).encode())


def stored_identity(folder: Path) -> dict[str, Any] | None:
    """Read the identity of the data set in a folder, finished or not; None without one.

    Raises:
        FolderError: dataset.h5, or the identity, is damaged or not of radhar.
    """
    path = folder / layout.DATASET
    if path.exists():
        from radhar_cli.readers.untrusted_hdf5 import UntrustedFile

        try:
            with UntrustedFile(path) as file:
                return checked_identity(file.json("identity"), path)
        except FolderError as error:
            raise FolderError(
                f"{error}; this is not a data set of radhar, or is damaged; choose another "
                "folder, or --overwrite if radhar built it"
            ) from None
    path = folder / WORK / layout.IDENTITY
    return checked_identity(read_json(path), path) if path.exists() else None


def checked_identity(value: Any, path: Path) -> dict[str, Any]:
    """Check the form of an identity that was read from a file at `path`, and return it."""
    parts = ("keys", "versions")
    if not isinstance(value, dict) or not all(isinstance(value.get(p), dict) for p in parts):
        raise FolderError(f"{path}: is damaged: its identity should have keys and versions")
    return value


def holds_samples(folder: Path) -> bool:
    """Whether a folder that a build has taken holds samples: a data set, PNG files or shards."""
    shards = folder / WORK / "shards"
    outputs = (folder / name for name in (layout.DATASET, layout.PNG))
    return any(map(Path.exists, outputs)) or (shards.is_dir() and any(shards.iterdir()))


def clean_up(folder: Path) -> None:
    """Mark a folder as built (dataset.h5 may be damaged later); remove files of the build."""
    (folder / WORK / layout.BUILT).touch()
    _remove_batches(folder)
    remove_unfinished(folder)
    (folder / WORK / layout.IDENTITY).unlink(missing_ok=True)


def _remove_batches(folder: Path) -> None:
    """Remove shards; foreign files next to them stay."""
    place = folder / WORK / "shards"
    with suppress(OSError):
        for name in os.listdir(place):  # noqa: PTH208 - names take less memory than paths
            if fnmatch(name, "rows-*-*.h5"):
                (place / name).unlink(missing_ok=True)
        place.rmdir()


def _remove_old_build(folder: Path, new: dict[str, Any]) -> None:
    """Remove the files of an old build, and nothing else; name the folder after the new one.

    The new identity comes first and the old dataset.h5 last, but for the PNGs that were put aside,
    so that a kill in between leaves a folder that either run can go on with.
    """
    is_from_radhar = layout.is_incomplete(folder) or (folder / WORK / layout.BUILT).exists()
    with suppress(FolderError):  # of radhar, or damaged
        is_from_radhar = is_from_radhar or stored_identity(folder) is not None
    if not is_from_radhar:
        return
    if (folder / layout.PNG).exists():
        put_aside = unfinished_path(folder)
        put_aside.parent.mkdir(parents=True, exist_ok=True)
        (folder / layout.PNG).rename(put_aside)
    for name in (layout.SCENES, layout.SEGMENTS_TABLE, layout.CONFIG, layout.CARD, layout.GALLERY):
        (folder / name).unlink(missing_ok=True)
    _remove_batches(folder)
    _write_identity(folder, new)
    (folder / layout.DATASET).unlink(missing_ok=True)
