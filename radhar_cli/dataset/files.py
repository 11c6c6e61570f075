"""Bounded reading of untrusted files; atomic writing inside an output folder."""

import hashlib
import os
import uuid
from pathlib import Path

from radhar_cli.dataset.layout import WORK
from radhar_cli.errors import FolderError
from radhar_cli.files.replacing import refuse_links, replacing
from radhar_cli.files.untrusted import regular_size

MAX_TEXT = 2**20


def write_whole(folder: Path, path: Path, data: bytes) -> None:
    """Write a file of an output folder atomically: in its work folder first, then renamed.

    Raises:
        FolderError: a folder on the way is a symbolic link.
        OSError: it cannot be written.
    """
    unfinished = unfinished_path(folder)
    for parent in (unfinished.parent, path.parent):
        refuse_links(folder, parent)
        parent.mkdir(parents=True, exist_ok=True)
    with replacing(path, unfinished):
        unfinished.write_bytes(data)


def unfinished_path(folder: Path) -> Path:
    """Make a path that no other process uses, on the same file system as the output."""
    return folder / WORK / "unfinished" / f"{os.getpid()}-{uuid.uuid4().hex}"


def refuse_foreign_work(folder: Path) -> None:
    """Refuse a work folder with anything in it but files and folders, links above all."""
    refuse_links(folder, folder / WORK)
    for place, folders, files in os.walk(folder / WORK):
        for name in (*folders, *files):
            path = Path(place, name)
            if path.is_symlink() or not (path.is_file() or path.is_dir()):
                raise FolderError(
                    f"{path}: should be a file or a folder, no link, pipe or device; radhar made "
                    "no such thing"
                )


def digest_of(path: Path) -> str:
    """SHA-256 of a regular file, in hex.

    Raises:
        OSError: the path is no regular file, or cannot be read.
    """
    regular_size(path)
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def read_bytes(path: Path, max_bytes: int = MAX_TEXT) -> bytes:
    """Read a regular file of at most `max_bytes` bytes.

    Raises:
        FolderError: the path is no regular file, too large, or cannot be read.
        FileNotFoundError: there is no such file.
    """
    try:
        size = regular_size(path)
        if size > max_bytes:
            raise FolderError(f"{path}: is {size} bytes; should be at most {max_bytes}")
        with path.open("rb") as file:
            return file.read(max_bytes)
    except FileNotFoundError:
        raise
    except OSError as error:
        raise FolderError(f"{path}: cannot be read: {error.strerror}") from None
