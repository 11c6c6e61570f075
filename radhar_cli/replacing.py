"""A file that appears when it is whole: written under another name, then renamed."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from errno import EINVAL
from pathlib import Path


@contextmanager
def replacing(path: Path, unfinished: str | None = None) -> Iterator[Path]:
    """Yield where to write what takes the place of `path` at the end, unless something fails.

    The name of the `unfinished` file beside it is path.unfinished if none is given. Errors name
    `path`, also of a full disk, which says no name.

    Raises:
        OSError: `path` is a folder or a device, or it cannot be written.
    """
    if path.exists() and not path.is_file():
        raise OSError(EINVAL, "is not a regular file", str(path))
    other = path.with_name(unfinished or f"{path.name}.unfinished")
    try:
        other.unlink(missing_ok=True)  # a link would be written through
        yield other
        other.replace(path)
    except OSError as error:
        if error.filename in (None, str(other)):
            error.filename = str(path)
        raise
    finally:
        with suppress(OSError):
            other.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write a text file that appears when it is whole."""
    with replacing(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8")
