"""A figure and its bytes, without a display and without a date in it."""

import io

from matplotlib import rcParams
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

DPI = 110
rcParams["text.parse_math"] = False  # a class may be called $a$


def page(width: float, height: float, apart: float = 0.04) -> Figure:
    """An empty figure of that size in inches, with panels `apart` inches from each other."""
    layout = ConstrainedLayoutEngine(w_pad=apart)
    figure = Figure(figsize=(width, height), layout=layout)
    FigureCanvasAgg(figure)
    return figure


def png_bytes(figure: Figure) -> bytes:
    """A figure as PNG, the same bytes for the same figure."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI, metadata={"Software": None})
    return buffer.getvalue()
