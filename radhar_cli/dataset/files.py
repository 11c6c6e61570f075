"""Writing files so that a name never stands for half a file."""

import os
import uuid
from pathlib import Path

from radhar_cli.dataset.layout import WORK


def write_whole(folder: Path, path: Path, data: bytes) -> None:
    """Write a file of an output folder under a name of its own, then rename it into place.

    Args:
        folder: the output folder; the unfinished file lies in its work folder.
        path: of the finished file, inside `folder`.
        data: the content.
    """
    unfinished = unfinished_path(folder)
    unfinished.parent.mkdir(parents=True, exist_ok=True)
    try:
        unfinished.write_bytes(data)
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished.replace(path)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise


def unfinished_path(folder: Path) -> Path:
    """A name that no other process uses, on the same file system as the output."""
    return folder / WORK / "unfinished" / f"{os.getpid()}-{uuid.uuid4().hex}"
