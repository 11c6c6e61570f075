"""Parts of the data card on the content of a data set: classes, arrays, people, streams."""

import numpy as np

from radhar_cli.config.data_set import Config, MeasuredConfig
from radhar_cli.config.maps import FRAME_MAPS
from radhar_cli.dataset.layout import SEGMENTS, SPLITS, Rows, column_axis, row_axis
from radhar_cli.dataset.reading import Dataset
from radhar_cli.files.table_text import markdown_table
from radhar_cli.motion.activities.meanings import meaning_of_class
from radhar_cli.processing.points import COLUMNS

POINT_COLUMNS = (
    "x ahead of the board, y to the left, z up (m), Doppler (m/s, approaching positive), "
    "intensity, SNR (dB), range bin, Doppler bin"
)
# {array of /products: what a row of it is}
ROWS = {
    "points": f"a point: {POINT_COLUMNS}",
    "points_start": "number, within the sample, of the first point of a frame; one more at the end",
    "points_person": "whose a point is: 0 the main person, 1 the first other, -1 nobody",
    "points_kind": "by way of which wall, floor or ceiling a point's echo came",
    "skeleton": "a frame: true places of joints [person, joint, x y z], m, axes as of points",
    "skeleton_velocity": "a frame: true velocities of joints [person, joint, x y z], m/s",
    SEGMENTS: "a segment: start and stop (s), label, person",
}


def describe_arrays(data: Dataset) -> str:
    """Write the section of arrays beside the maps; "" of a data set without any."""
    if not data.products:
        return ""
    lines = []
    for name, array in data.products.items():
        kind, _, subframe = name.partition("_sf")
        meaning = ROWS.get(kind, "a row of the product")
        if kind in FRAME_MAPS and kind != "points":
            (rows, row_unit), (columns, column_unit) = row_axis(kind), column_axis(kind)
            meaning = f"a frame: levels [{rows} ({row_unit}), {columns} ({column_unit})]"
        meaning += f"; of subframe {subframe}" if subframe else ""
        shape = " x ".join(map(str, array.shape[1:])) or "1"
        counts = array.counts
        each = f"{counts.min():,}" if counts.min() == counts.max() else _spread(counts)
        lines.append([f"`/products/{name}`", f"{array.shape[0]:,}", each, shape, meaning])
    head = ("array", "rows in all", "of a sample", "shape of a row", "a row is")
    notes = ["Rows of sample i begin at `/products/<name>_count[:i].sum()`."]
    if {"points", "points_start"} <= data.products.keys():
        notes.append(_describe_points(data))
    if "skeleton" in data.products:
        notes.append(
            "Skeletons are the truth of the simulation: what a network should find, never what it "
            "may see. The images of `points` show points alone."
        )
    if isinstance(data.config, MeasuredConfig):
        notes.append("Points are as a board sent them: NaN is what its messages do not say.")
    heading = "## Points, skeletons and other arrays"
    return f"{heading}\n\n{markdown_table(head, lines)}\n\n{' '.join(notes)}"


def _spread(counts: np.ndarray) -> str:
    return f"{counts.min():,} to {counts.max():,}, {counts.mean():,.1f} on average"


def _describe_points(data: Dataset) -> str:
    """Describe the numbers of frames a sample and points a frame, and the columns of a point."""
    frames = data.products["points_start"].counts - 1
    points = data.products["points"].counts
    a_frame = points / np.maximum(frames, 1)
    low, high = np.percentile(a_frame, [5, 95])
    total = points.sum() / max(int(frames.sum()), 1)
    count = f"{frames.min()}" if frames.min() == frames.max() else _spread(frames)
    return (
        f"A sample has {count} frames, a frame {total:.1f} points on average; nine samples in ten "
        f"have {low:.1f} to {high:.1f}. Columns of a point are `{'`, `'.join(COLUMNS)}`."
    )


def describe_people(data: Dataset) -> str:
    """Write how many people scenes have, by split; "" where all have one."""
    if data.person_label is None:
        return ""
    present = (data.person_label >= 0).sum(axis=1)
    splits = data.present_splits
    lines = [
        [count, *(int(((present == count) & (data.split == n)).sum()) for n in splits)]
        for count in range(int(present.min()), int(present.max()) + 1)
    ]
    table = markdown_table(("people in the scene", *splits.values()), lines)
    return (
        f"## People\n\n{table}\n\n`/person_label` has the class of each person, main one first, "
        "-1 of who is not there; `/labels` which classes anybody shows."
    )


def describe_streams(data: Dataset) -> str:
    """Write the table of the labels in time of streams; "" of other data sets."""
    if not data.frame_classes:
        return ""
    segments = data.products[SEGMENTS]
    rows = np.concatenate([segments[row] for row in range(len(data))])
    split = np.repeat(data.split, segments.counts)
    lines = []
    for label, name in enumerate(data.frame_classes):
        of_label = rows[:, 2] == label
        seconds = (rows[:, 1] - rows[:, 0])[of_label]
        counts = [int((of_label & (split == n)).sum()) for n in data.present_splits]
        lines.append([label, f"`{name}`", *counts, f"{seconds.sum():,.0f}"])
    table = markdown_table(("label", "in time", *data.present_splits.values(), "s in all"), lines)
    return (
        f"## Labels in time\n\n{table}\n\nCounts are segments. `/frame_label/<map>` has the label "
        "of every column of an image, `segments.csv` start and stop of every segment."
    )


def describe_classes(data: Dataset) -> str:
    """Write the table of classes: label, meaning, samples in each split."""
    present, lines = data.present_splits, []
    for label, (activity, rows) in enumerate(Rows.of(data.config).classes()):
        counts = np.bincount(data.split[rows], minlength=len(SPLITS))
        meaning = meaning_of_class(activity) if isinstance(data.config, Config) else ""
        lines.append([label, f"`{activity.slug}`", meaning, *(counts[n] for n in present)])
    note = ""
    if data.labels is not None:
        counts_of_slugs = zip(data.class_slugs, data.labels.sum(axis=0).tolist(), strict=True)
        occurrences = ", ".join(f"`{slug}` {count}" for slug, count in counts_of_slugs if count)
        note = (
            "\n\nThe class is what the sample's main person does. Others are there too: column "
            f"`labels` has what anybody does ({occurrences})."
        )
    return markdown_table(["label", "class", "who", *present.values()], lines) + note
