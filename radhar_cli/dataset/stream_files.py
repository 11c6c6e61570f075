"""Files of a data set of streams beside its images: a table of segments, and a labelled picture."""

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.layout import SEGMENTS, SEGMENTS_TABLE, SPLITS, Rows, row_axis
from radhar_cli.dataset.reading import Dataset
from radhar_cli.files.replacing import refuse_links
from radhar_cli.scene.products.segments import column_times

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from radhar_cli.figures.stream_page import LabelledMap

COLUMNS = ("index", "split", "person", "start_s", "stop_s", "label", "class")


def write_missing_segments(source: Path, folder: Path) -> None:
    """Write the table of the segments of all streams, unless it is there or there are none."""
    path = folder / SEGMENTS_TABLE
    with Dataset(source) as data:
        if not data.frame_classes or path.exists():
            return
        refuse_links(folder, path)
        write_whole(folder, path, segments_text(data).encode())


def segments_text(data: Dataset) -> str:
    """Text of segments.csv: a line for each segment of each person.

    For each map over time it has the first column of the segment and the one after its last, as far
    as the middles of columns lie in it.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    maps = [*data.frame_label]
    ends = [f"{name}_{end}" for name in maps for end in ("first_column", "past_column")]
    writer.writerow((*COLUMNS, *ends))
    rows, width = Rows.of(data.config), data.config.image.size_px[1]
    extents = {name: data.extents(name) for name in maps}
    for row in range(len(data)):
        times = [column_times(extents[name][row].tolist(), width) for name in maps]
        split = SPLITS[data.split[row]]
        for start, stop, label, person in data.products[SEGMENTS][row].tolist():
            columns = [int(np.searchsorted(t, end)) for t in times for end in (start, stop)]
            name = data.frame_classes[int(label)]
            cells = (rows[row][1], split, int(person), f"{start:.6f}", f"{stop:.6f}", int(label))
            writer.writerow((*cells, name, *columns))
    return text.getvalue()


def labelled_maps(data: Dataset, name: str, rows: list[int]) -> "Iterator[LabelledMap]":
    """Yield maps of streams with the labels of everybody in them."""
    from radhar_cli.figures.stream_page import LabelledMap  # Matplotlib is slow to import

    quantity = "{} ({})".format(*row_axis(name))
    samples, extents = Rows.of(data.config), data.extents(name)
    for row in rows:
        labels = data.frame_label[name][row : row + 1][0].astype(int)
        strips = {"class" if len(labels) == 1 else f"person {n}": x for n, x in enumerate(labels)}
        title = f"{samples[row][0].slug}/{samples.name(row)} ({SPLITS[data.split[row]]})"
        yield LabelledMap(title, data.maps[name][row], extents[row].tolist(), quantity, strips)


def draw_streams(data: Dataset, name: str, count: int) -> "Figure":
    """Draw the first streams of a data set with their labels, at most `count`."""
    from radhar_cli.figures.stream_page import draw_labelled_maps

    rows = list(range(min(count, len(data))))
    maps = list(labelled_maps(data, name, rows))
    return draw_labelled_maps(maps, data.frame_classes, data.config.image.colour_map)
