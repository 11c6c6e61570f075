"""A figure and its bytes, without a display and without a date in it."""

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypeVar

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from radhar_cli.figures import style  # noqa: F401  (letters of every figure)
from radhar_cli.files.replacing import replacing

T = TypeVar("T")
DPI = 110


def page(width: float, height: float, apart: float = 0.04) -> Figure:
    """Make an empty figure of a size in inches, with panels `apart` inches from each other."""
    layout = ConstrainedLayoutEngine(w_pad=apart)
    figure = Figure(figsize=(width, height), layout=layout)
    FigureCanvasAgg(figure)
    return figure


def page_of_rows(
    rows: Mapping[str, Sequence[T]], size: tuple[float, float], margin: tuple[float, float]
) -> tuple[Figure, list[tuple[Axes, T]]]:
    """Make a figure with a row of panels beside each name.

    Args:
        rows: contents of the panels of each row, by name.
        size: width and height of a panel, inches.
        margin: space beside and above the panels, inches.

    Returns:
        The figure, and each panel with its content.
    """
    columns = max(map(len, rows.values()))
    figure = page(size[0] * columns + margin[0], size[1] * len(rows) + margin[1])
    panels = figure.subplots(len(rows), columns, squeeze=False)
    filled: list[tuple[Axes, T]] = []
    for row, (name, contents) in zip(panels, rows.items(), strict=True):
        for panel in row[len(contents) :]:
            panel.set_axis_off()
        row[0].set_ylabel(name)
        filled += zip(row, contents, strict=False)
    return figure, filled


def png_bytes(figure: Figure) -> bytes:
    """Encode a figure as PNG, the same bytes for the same figure."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI, metadata={"Software": None})
    return buffer.getvalue()


def write_figure(figure: Figure, path: Path, dpi: float) -> None:
    """Write a figure in the format of the suffix, else PNG; the file appears when complete."""
    kind = path.suffix[1:].lower()
    known = kind in figure.canvas.get_supported_filetypes()
    with replacing(path) as unfinished:
        figure.savefig(unfinished, format=kind if known else "png", dpi=dpi)
