"""Access to files from elsewhere: regular files alone, bounded JSON, safe text."""

import errno
import json
import os
import stat
from abc import ABC, abstractmethod
from pathlib import Path
from typing import Any, Self

from radhar_cli.errors import FolderError, RadharError

DEEPEST = 32
MAX_JSON = 2**20  # characters


class Closing(ABC):
    """A file that `with` closes."""

    @abstractmethod
    def close(self) -> None:
        """Close the file."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def regular_size(path: str | os.PathLike[str]) -> int:
    """Size in bytes of a regular file; links are followed.

    Raises:
        OSError: the file is missing, may not be read, or is a folder, a FIFO, a socket or a device,
            which can block.
    """
    try:
        status = Path(path).stat()
    except FileNotFoundError as error:
        raise FileNotFoundError(error.errno, "no such file", str(path)) from None
    if not stat.S_ISREG(status.st_mode):
        kind = "a folder" if stat.S_ISDIR(status.st_mode) else "a FIFO, a socket or a device"
        raise OSError(errno.EINVAL, f"is {kind}; should be a regular file", str(path))
    if not os.access(path, os.R_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
    return status.st_size


def refuse_outside(path: Path, folder: Path) -> None:
    """Refuse a path, named by a file in a folder or found there, that links lead out of the folder.

    Raises:
        FolderError: names the link and where it leads.
    """
    target = os.path.realpath(path)
    if not Path(target).is_relative_to(os.path.realpath(folder)):
        raise FolderError(f"{path}: is a link to {target}, which lies outside of {folder}")


def read_text(path: Path, max_bytes: int) -> str:
    """Read the text of a regular file of at most `max_bytes` bytes in UTF-8.

    Raises:
        OSError: the file cannot be read, is larger, or is not a regular file.
        UnicodeDecodeError: the file is not UTF-8.
    """
    regular_size(path)
    with path.open("rb") as file:
        data = file.read(max_bytes + 1)
    if len(data) > max_bytes:
        raise OSError(errno.EFBIG, f"holds more than {max_bytes} bytes", str(path))
    return data.decode()


def bytes_of(path: Path, max_bytes: int, refused: type[RadharError]) -> bytes:
    """Read a regular file of at most `max_bytes` bytes.

    Args:
        path: the file.
        max_bytes: largest size, bytes.
        refused: class of the error that says why the file cannot be read.
    """
    try:
        size = regular_size(path)
        if size > max_bytes:
            raise refused(f"{path}: has {size} bytes; should have at most {max_bytes}")
        with path.open("rb") as file:
            return file.read(max_bytes)
    except OSError as error:
        raise refused(f"{path}: cannot be read ({error.strerror})") from None


def text_of(path: Path, max_bytes: int, refused: type[RadharError]) -> str:
    """Read the text of a file that a user named (`read_text`).

    Args:
        path: regular file in UTF-8.
        max_bytes: largest size, bytes.
        refused: class of the error that says why the file cannot be read.
    """
    try:
        return read_text(path, max_bytes)
    except FileNotFoundError:
        raise refused(f"{path}: no such file") from None
    except (OSError, ValueError) as error:  # no UTF-8; no name of a file
        reason = getattr(error, "strerror", None) or error
        raise refused(f"{path}: cannot be read as text ({reason})") from None


def read_json(path: Path) -> Any:
    """Read a JSON file of bounded length and depth.

    Raises:
        FolderError: the file cannot be read, or is not JSON.
    """
    try:
        return parse_json(read_text(path, MAX_JSON))
    except OSError as error:
        raise FolderError(f"{path}: {error.strerror}") from None
    except ValueError as error:
        raise FolderError(f"{path}: is damaged, or is not JSON ({error})") from None


def parse_json(text: str) -> Any:
    """Parse JSON of at most MAX_JSON characters and DEEPEST levels.

    Raises:
        ValueError: the text is not JSON, too long, or nested too deeply.
    """
    if len(text) > MAX_JSON:
        raise ValueError(f"it has {len(text)} characters; should have at most {MAX_JSON}")
    try:
        value = json.loads(text)
        deep = _depth(value) > DEEPEST
    except RecursionError:
        deep = True
    if deep:
        raise ValueError(f"it is nested deeper than {DEEPEST} levels")
    return value


def _depth(value: Any) -> int:
    if not isinstance(value, (dict, list)):
        return 0
    inner = value.values() if isinstance(value, dict) else value
    return 1 + max(map(_depth, inner), default=0)


def escaped(text: object) -> str:
    r"""Escape whatever in a text could steer a terminal, line breaks aside.

    ``\x1b[2J`` becomes ``\\x1b[2J``; so do bidirectional marks and bytes that are not UTF-8.
    """
    return "".join(
        c if c.isprintable() or c == "\n" else c.encode("unicode_escape").decode()
        for c in str(text)
    )
