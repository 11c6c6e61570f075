"""A file that appears when it is whole: written under another name, then renamed."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from errno import EINVAL
from pathlib import Path
from uuid import uuid4

UNFINISHED = ".radhar-unfinished-"


@contextmanager
def replacing(
    path: Path, unfinished: Path | None = None, exclusive: bool = False
) -> Iterator[Path]:
    """Yield where to write what takes the place of `path` at the end, unless something fails.

    That is `unfinished`, a name that no other process uses, on the same file system; if none is
    given, a new one beside it, where what killed processes left goes. Errors name `path`, also of a
    full disk, which says no name. With `exclusive` a file that another process made stays.

    Raises:
        FileExistsError: there is one, with `exclusive`.
        OSError: `path` is a folder or a device, or it cannot be written.
    """
    if path.exists() and not path.is_file():
        raise OSError(EINVAL, "is not a regular file", str(path))
    other = unfinished or path.with_name(UNFINISHED + uuid4().hex)
    try:
        with nullcontext() if unfinished else other.open("xb") as held:
            if held:
                with suppress(OSError):  # a file system without locks
                    fcntl.flock(held, fcntl.LOCK_EX)
                _remove_leftovers(path.parent)
            yield other
            if exclusive:
                path.hardlink_to(other)
            else:
                other.replace(path)
    except OSError as error:
        if error.filename in (None, str(other)):
            error.filename = str(path)
        raise
    finally:
        with suppress(OSError):
            other.unlink(missing_ok=True)


def _remove_leftovers(folder: Path) -> None:
    """Remove unfinished files that nobody holds."""
    for left in folder.glob(f"{UNFINISHED}*"):
        with suppress(OSError), left.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            left.unlink()


def write_text(path: Path, text: str) -> None:
    """Write a text file that appears when it is whole."""
    with replacing(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8")
