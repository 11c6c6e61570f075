"""Training curves: accuracy and loss by epoch, of one run or of several."""

from collections.abc import Mapping, Sequence
from typing import Protocol

from matplotlib.ticker import FormatStrFormatter, LogLocator, MaxNLocator, NullFormatter

from radhar_cli.figures.page import page, png_bytes


class EpochRow(Protocol):
    """What is drawn of an epoch."""

    @property
    def epoch(self) -> int: ...
    @property
    def train_loss(self) -> float: ...
    @property
    def train_accuracy(self) -> float: ...
    @property
    def val_loss(self) -> float: ...
    @property
    def val_accuracy(self) -> float: ...


def curves_png(runs: Mapping[str, Sequence[EpochRow]], best: Mapping[str, int]) -> bytes:
    """Accuracy and loss by epoch, training dashed and validation solid, the kept epoch marked.

    Args:
        runs: name of each run and its epochs.
        best: kept epoch of a run, by name.
    """
    figure = page(10.5, 4.2)
    left, right = figure.subplots(1, 2)
    for number, (name, rows) in enumerate(runs.items()):
        colour, x = f"C{number % 10}", [row.epoch for row in rows]
        mark = "o" if len(rows) == 1 else None
        label = f"{name}, " if len(runs) > 1 else ""
        for axes, train, val in (
            (left, [100 * r.train_accuracy for r in rows], [100 * r.val_accuracy for r in rows]),
            (right, [r.train_loss for r in rows], [r.val_loss for r in rows]),
        ):
            axes.plot(
                x,
                train,
                "--",
                color=colour,
                marker=mark,
                linewidth=1,
                alpha=0.6,
                label=label + "training",
            )
            axes.plot(
                x, val, "-", color=colour, marker=mark, linewidth=1.8, label=label + "validation"
            )
            if name in best and best[name] in x:
                kept = x.index(best[name])
                axes.plot(x[kept], val[kept], "*", color=colour, markersize=11)
    for axes, what in ((left, "accuracy (%)"), (right, "loss (label-smoothed cross-entropy)")):
        axes.set_xlabel("epoch")
        axes.set_ylabel(what)
        axes.grid(alpha=0.3)
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    right.set_yscale("log")  # a spike leaves the rest of the curve its room
    right.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    right.yaxis.set_major_formatter(FormatStrFormatter("%g"))
    right.yaxis.set_minor_formatter(NullFormatter())
    left.legend(fontsize=8 if len(runs) < 4 else 6)
    figure.suptitle("star: the epoch that is kept", fontsize=9)
    return png_bytes(figure)
