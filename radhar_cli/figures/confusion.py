"""A confusion matrix: counts and shares of each row."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.figures.page import page, png_bytes

MAX_NUMBERED = 32  # classes; with more, cells have no numbers


def confusion_png(counts: NDArray[np.int64], names: Sequence[str], title: str) -> bytes:
    """Draw counts [true class, predicted class]; colour and percentage are shares of a row."""
    shares = row_shares(counts)
    side = 2.6 + 0.62 * min(len(names), MAX_NUMBERED)
    figure = page(side + 1.0, side)
    axes = figure.subplots()
    drawn = axes.imshow(100 * shares, cmap="Blues", vmin=0, vmax=100)
    for (row, column), count in np.ndenumerate(counts):
        if count and len(names) <= MAX_NUMBERED:
            axes.text(
                column,
                row,
                f"{count}\n{100 * shares[row, column]:.1f} %",
                ha="center",
                va="center",
                fontsize=7,
                color="white" if shares[row, column] > 0.55 else "black",
            )
    _label(axes, names)
    figure.colorbar(drawn, ax=axes, shrink=0.75, label="share of the true class (%)")
    axes.set_title(title, fontsize=10)
    return png_bytes(figure)


def _label(axes: Any, names: Sequence[str]) -> None:
    shown = [name.replace("_", " ") for name in names]
    axes.set_xticks(range(len(names)), shown, rotation=40, ha="right", fontsize=8)
    axes.set_yticks(range(len(names)), shown, fontsize=8)
    axes.set_xlabel("predicted")
    axes.set_ylabel("true")


def row_shares(counts: NDArray[np.int64]) -> NDArray[np.float64]:
    """Counts as shares of their row, 0 in an empty row."""
    totals = counts.sum(1, keepdims=True)
    shares: NDArray[np.float64] = np.divide(
        counts, totals, out=np.zeros(counts.shape), where=totals > 0
    )
    return shares
