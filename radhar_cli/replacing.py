"""A file that appears when it is whole: written under another name, then renamed."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def replacing(path: Path, unfinished: str | None = None) -> Iterator[Path]:
    """Yield where to write what takes the place of `path` at the end, unless something fails.

    The name of the `unfinished` file beside it is path.unfinished if none is given. An error of the
    disk names `path`: a full one says no name.
    """
    other = path.with_name(unfinished or f"{path.name}.unfinished")
    other.unlink(missing_ok=True)  # a link would be written through
    try:
        yield other
        other.replace(path)
    except OSError as error:
        error.filename = error.filename or str(path)
        raise
    finally:
        with suppress(OSError):
            other.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write a text file that appears when it is whole."""
    with replacing(path) as unfinished:
        unfinished.write_text(text)
