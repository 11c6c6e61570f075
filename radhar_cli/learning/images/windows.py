"""Windows of streams: images of some seconds, cut every so often, and the targets of each."""

from dataclasses import dataclass, replace

import numpy as np

from radhar_cli.errors import FolderError
from radhar_cli.learning.images.image_set import ImageSet, Pixels
from radhar_cli.learning.images.sample_table import objects
from radhar_cli.learning.settings import WindowConfig
from radhar_cli.numerics.arrays import Index, Levels


@dataclass(frozen=True)
class WindowPixels:
    """Windows of the columns of longer images."""

    pixels: Pixels
    rows: Index  # [N] row of the longer image
    starts: Index  # [N] its first column in the window
    width: int

    def read(self, row: int) -> Levels:
        """RGB [H, width, 3] or levels [H, width, 1] of a window."""
        start = int(self.starts[row])
        return self.pixels.read(int(self.rows[row]))[:, start : start + self.width]


def cut_windows(images: ImageSet, window: WindowConfig) -> ImageSet:
    """Cut streams into windows, each with the class of most of its columns, or of its middle one.

    Windows of one stream are in one part of the split, that of the stream. Classes are those that
    occur, pauses and transitions included.

    Raises:
        FolderError: the images are no streams, or shorter than a window.
    """
    labels, column_s = images.samples.frame_labels, images.column_s
    if labels is None or column_s is None:
        raise FolderError(f"{images.where}: has no labels in time, which window is of: no streams")
    width, hop = round(window.length_s / column_s), max(1, round(window.hop_s / column_s))
    if not 1 <= width <= images.size[1]:
        seconds = images.size[1] * column_s
        right = f"should be from {column_s:g} to {seconds:g} s, as long as a stream"
        raise FolderError(f"{images.where}: window.length_s = {window.length_s:g}: {right}")
    starts = np.arange(0, images.size[1] - width + 1, hop)
    rows = np.repeat(np.arange(len(images)), starts.size)
    first = np.tile(starts, len(images))
    columns = labels[rows[:, None], first[:, None] + np.arange(width)]  # [window, column]
    numbers = _label_windows(columns, len(images.frame_classes), window.label)
    known = np.flatnonzero(numbers >= 0)
    rows, first, columns, numbers = rows[known], first[known], columns[known], numbers[known]
    occurring, label = np.unique(numbers, return_inverse=True)
    streams = images.samples.take(rows)
    samples = replace(
        streams,
        label=label.reshape(-1),
        name=objects(
            f"{n} at {s * column_s:.2f} s" for n, s in zip(streams.name, first, strict=True)
        ),
        recording=streams.name,
        activities=None,
        frame_labels=columns,
        first_column=first,
    )
    return replace(
        images,
        classes=tuple(images.frame_classes[number] for number in occurring),
        samples=samples,
        size=(images.size[0], width),
        pixels=WindowPixels(images.pixels, rows, first, width),
    )


def _label_windows(columns: Index, classes: int, by: str) -> Index:
    """Label of each window of columns [window, column]; -1 where that is not known."""
    if by == "centre":
        middle: Index = columns[:, columns.shape[1] // 2]
        return middle
    counts = (columns[..., None] == np.arange(classes)).sum(1)  # [window, class]
    return np.where(counts.any(1), counts.argmax(1), -1)
