"""Figures that are laid out but not drawn, where a test is not about how they look.

Drawing takes half of the time of a report. A test that reads a picture is marked `drawn`.
"""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import pytest
from matplotlib.figure import Figure
from PIL import Image

_BUFFER = io.BytesIO()
Image.new("RGB", (8, 8)).save(_BUFFER, "PNG")
BLANK = _BUFFER.getvalue()


def write_blank(figure: Figure, target: Path | IO[bytes], **_: Any) -> None:
    """Write a black picture in place of a figure."""
    if isinstance(target, Path):
        target.write_bytes(BLANK)
    else:
        target.write(BLANK)


@contextmanager
def blank_figures() -> Iterator[None]:
    """Write no figure within the block."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "savefig", write_blank)
        yield
