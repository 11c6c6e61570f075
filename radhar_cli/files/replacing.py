"""A file that appears when it is whole: written under another name, then renamed."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from errno import EINVAL
from pathlib import Path
from uuid import uuid4

from radhar_cli.errors import FolderError

UNFINISHED = ".radhar-unfinished-"


@contextmanager
def replacing(
    path: Path, unfinished: Path | None = None, exclusive: bool = False
) -> Iterator[Path]:
    """Write a file under another name within the block, and rename it at the end if nothing failed.

    Args:
        path: file that is replaced at the end. Errors name it, also those of a full disk, which
            say no name.
        unfinished: name to write under, which no other process uses, on the same file system. If
            None, a new one beside `path`; what killed processes left there is removed then.
        exclusive: whether a file that another process made meanwhile stays.

    Yields:
        The name to write under.

    Raises:
        FileExistsError: there is a file of that name, with `exclusive`.
        OSError: `path` is a folder or a device, or it cannot be written.
    """
    if path.exists() and not path.is_file():
        raise OSError(EINVAL, "is not a regular file", str(path))
    temporary = unfinished or path.with_name(UNFINISHED + uuid4().hex)
    try:
        with nullcontext() if unfinished else temporary.open("xb") as lock_file:
            if lock_file:
                with suppress(OSError):  # a file system without locks
                    fcntl.flock(lock_file, fcntl.LOCK_EX)
                _remove_leftovers(path.parent)
            yield temporary
            if exclusive:
                path.hardlink_to(temporary)
            else:
                temporary.replace(path)
    except OSError as error:
        if error.filename in (None, str(temporary)):
            error.filename = str(path)
        raise
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def _remove_leftovers(folder: Path) -> None:
    """Remove unfinished files that nobody holds."""
    for leftover in folder.glob(f"{UNFINISHED}*"):
        with suppress(OSError), leftover.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            leftover.unlink()


def write_output(path: Path, content: bytes) -> None:
    """Write a file that a user asked for, and its folder; it appears when it is whole.

    Raises:
        FolderError: the file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as unfinished:
            unfinished.write_bytes(content)
    except OSError as error:
        raise FolderError(f"{path}: cannot be written ({error.strerror})") from None


def write_result(folder: Path, path: Path, data: bytes) -> None:
    """Write a file of a folder without a work folder, which no run holds, atomically."""
    refuse_links(folder, path.parent)
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as unfinished:
        unfinished.write_bytes(data)


def refuse_links(folder: Path, path: Path) -> None:
    """Refuse a path inside a folder if a part of it below the folder is a symbolic link.

    Raises:
        FolderError: a part is.
    """
    for part in (path, *path.parents):
        if part == folder:
            return
        if part.is_symlink():
            raise FolderError(f"{part}: is a symbolic link; radhar writes and deletes through none")


def write_text(path: Path, text: str) -> None:
    """Write a text file that appears when it is whole."""
    with replacing(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8")
