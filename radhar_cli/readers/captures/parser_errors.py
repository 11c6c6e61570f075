"""Errors of the parsers that read captures, as errors of the capture."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from radhar_cli.errors import CaptureError, FolderError


@contextmanager
def parser_errors_as_capture_errors(source: str) -> Iterator[None]:
    """Turn errors of the parsers of NumPy, SciPy and zipfile into a CaptureError.

    Args:
        source: file, or file and array, for the message.
    """
    try:
        with np.errstate(over="raise"):
            yield
    except (CaptureError, FolderError):
        raise
    except Exception as error:  # they raise whatever they meet
        reason = getattr(error, "strerror", None) or str(error).partition("\n")[0]
        raise CaptureError(f"{source}: cannot be read ({reason or type(error).__name__})") from None
