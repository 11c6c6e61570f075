"""Tables as CSV text."""

import csv
import io
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray


def csv_text(header: Sequence[object], rows: Iterable[Iterable[object]]) -> str:
    """A table as CSV; names are quoted where they need it."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue()


def confusion_csv(counts: NDArray[np.int64], names: Sequence[str]) -> str:
    """Counts [true class, predicted class], true classes down."""
    rows = ([name, *row] for name, row in zip(names, counts.tolist(), strict=True))
    return csv_text(["true \\ predicted", *names], rows)
