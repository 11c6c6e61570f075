"""The figures of `radhar train` and `radhar eval`: curves, confusions, images, points."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.ticker import FormatStrFormatter, LogLocator, MaxNLocator, NullFormatter
from numpy.typing import NDArray

from radhar_cli.figures.page import page, png_bytes
from radhar_cli.figures.style import SMALL
from radhar_cli.numerics.arrays import Float, Index, Levels

ACROSS = 4  # pictures in a row
MAX_NUMBERED = 32  # classes; with more, cells of a confusion matrix have no numbers


def curves_png(
    runs: Mapping[str, Sequence[Any]], best: Mapping[str, int], score: str, loss: str
) -> bytes:
    """Draw score and loss over the epoch, training dashed, validation solid, the kept epoch marked.

    Args:
        runs: rows of metrics of each epoch, by name of the run.
        best: kept epoch, by name of the run.
        score: name of the score, for its axis.
        loss: name of the loss, for its axis.

    Returns:
        The PNG file.
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
            style: dict[str, Any] = {"color": colour, "marker": mark}
            axes.plot(x, train, "--", **style, lw=1, alpha=0.6, label=label + "training")
            axes.plot(x, val, "-", **style, lw=1.8, label=label + "validation")
            if name in best and best[name] in x:
                place = x.index(best[name])
                axes.plot(x[place], val[place], "*", color=colour, markersize=11)
    for axes, quantity in ((left, f"{score} (%)"), (right, f"loss ({loss})")):
        axes.set(xlabel="epoch", ylabel=quantity)
        axes.grid(alpha=0.3)
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    right.set_yscale("log")  # a spike leaves the rest of the curve its room
    right.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    right.yaxis.set_major_formatter(FormatStrFormatter("%g"))
    right.yaxis.set_minor_formatter(NullFormatter())
    left.legend(loc="lower right")
    figure.suptitle("star: the epoch that is kept")
    return png_bytes(figure)


def confusion_png(counts: NDArray[np.int64], names: Sequence[str], title: str) -> bytes:
    """Draw a confusion matrix; colour and percentage are shares of a row.

    Args:
        counts: counts [true class, predicted class].
        names: names of the classes.
        title: line above.

    Returns:
        The PNG file.
    """
    totals = counts.sum(1, keepdims=True)
    labels = [name.replace("_", " ") for name in names]
    shares = np.divide(counts, totals, out=np.zeros(counts.shape), where=totals > 0)
    side = 2.6 + 0.62 * min(len(names), MAX_NUMBERED)
    figure = page(side + 1.0, side)
    axes = figure.subplots()
    drawn = axes.imshow(100 * shares, cmap="Blues", vmin=0, vmax=100)
    for (row, column), count in np.ndenumerate(counts):
        if count and len(names) <= MAX_NUMBERED:
            share = shares[row, column]
            look: dict[str, Any] = {"color": "white" if share > 0.55 else "black", "fontsize": 7}
            text = f"{count}\n{100 * share:.1f} %"
            axes.text(column, row, text, ha="center", va="center", **look)
    axes.set_xticks(range(len(names)), labels, rotation=40, ha="right")
    axes.set_yticks(range(len(names)), labels)
    axes.set(xlabel="predicted", ylabel="true")
    figure.colorbar(drawn, ax=axes, shrink=0.75, label="share of the true class (%)")
    axes.set_title(title)
    return png_bytes(figure)


def reliability_png(confidence: Float, accuracy: Float, count: Index, title: str) -> bytes:
    """Draw the accuracy over the probability of the predicted class, and the counts.

    Args:
        confidence: mean probability of the predictions in each bin [bin], NaN in an empty one.
        accuracy: share of them that is right [bin], NaN in an empty one.
        count: number of predictions in each bin [bin].
        title: line above.

    Returns:
        The PNG file.
    """
    figure = page(4.6, 4.8)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[3.2, 1])
    above.plot([0, 1], [0, 1], ":", color="0.5", linewidth=1, label="calibrated")
    has_predictions = count > 0
    above.plot(
        confidence[has_predictions],
        accuracy[has_predictions],
        "o-",
        color="C0",
        markersize=5,
        label="measured",
    )
    above.vlines(
        confidence[has_predictions],
        confidence[has_predictions],
        accuracy[has_predictions],
        color="C3",
        linewidth=1,
    )
    above.set(ylabel="share that is right", ylim=(-0.02, 1.04))
    above.legend(loc="upper left")
    edges = np.linspace(0, 1, len(count) + 1)
    below.bar(edges[:-1], count, width=np.diff(edges), align="edge", color="0.7", edgecolor="white")
    below.set(xlabel="probability of the predicted class", ylabel="images", xlim=(0, 1))
    below.yaxis.set_major_locator(MaxNLocator(3, integer=True))
    for axes in (above, below):
        axes.grid(alpha=0.3)
    figure.suptitle(title)
    return png_bytes(figure)


def captioned_png(images: Sequence[Levels], captions: Sequence[str], title: str) -> bytes:
    """Draw images, RGB [H, W, 3] or gray [H, W, 1], with captions; return the PNG file."""
    rows, columns = -(-len(images) // ACROSS), ACROSS  # the title needs the width of four
    figure = page(2.5 * columns, 3.1 * rows + 0.4)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for panel in panels:
        panel.set_axis_off()
    for panel, image, caption in zip(panels, images, captions, strict=False):
        rgb = np.broadcast_to(image, (*image.shape[:2], 3))
        panel.imshow(rgb, interpolation="nearest", aspect="auto")
        panel.set_title(caption, loc="left")
    figure.suptitle(title)
    return png_bytes(figure)


def embeddings_png(
    panels: Mapping[str, Float], label: Index, names: Sequence[str], title: str
) -> bytes:
    """Draw embeddings side by side, each under its name, with a colour for each class.

    Args:
        panels: points [N, 2] of each embedding, by name.
        label: number of the class of each point [N].
        names: names of the classes.
        title: line above.

    Returns:
        The PNG file.
    """
    figure = page(5.2 * len(panels) + 1.6, 4.8)
    drawn = figure.subplots(1, len(panels), squeeze=False)[0]
    colours = colormaps["tab20"]
    for axes, (space, points) in zip(drawn, panels.items(), strict=True):
        for number, class_name in enumerate(names):
            of_class = points[label == number]
            if len(of_class):
                name = class_name.replace("_", " ")
                axes.scatter(*of_class.T, s=12, color=colours(number % 20), label=name)
        axes.set_title(space)
        axes.set(xticks=[], yticks=[])
    figure.legend(*drawn[0].get_legend_handles_labels(), loc="outside right center")
    figure.suptitle(title)
    return png_bytes(figure)


def filters_png(runs: Mapping[str, Sequence[Float]]) -> bytes:
    """Draw heat maps of global filters, a row for every run and a column for every layer.

    Colours go from 0 to the largest value of each panel, which stands above it: layers and runs
    differ by orders of magnitude, and it is the pattern that is compared.

    Args:
        runs: filters by name of the run, each [H, W]: magnitude of the effective weight in FFT
            order, mean over channels; rows are the Doppler axis of the map, columns its time axis.
    """
    columns = max(len(filters) for filters in runs.values())
    figure = page(1.9 * columns + 1.5, 1.95 * len(runs) + 0.9)
    panels = figure.subplots(len(runs), columns, squeeze=False)
    for number, (row, (name, filters)) in enumerate(zip(panels, runs.items(), strict=True)):
        row[0].set_ylabel(name)
        for panel in row[len(filters) :]:
            panel.set_axis_off()
        for layer, (panel, weight) in enumerate(zip(row, filters, strict=False), start=1):
            height, width = weight.shape
            # Pixel centres are whole frequencies: -N/2 to N/2 - 1.
            edges = (-width / 2 - 0.5, width / 2 - 0.5, -height / 2 - 0.5, height / 2 - 0.5)
            image = panel.imshow(
                np.fft.fftshift(weight) / max(weight.max(), 1e-30),
                extent=edges,
                origin="lower",
                cmap="viridis",
                vmin=0,
                vmax=1,
            )
            over = f"Global Filter {layer}\n" if number == 0 else ""
            panel.set_title(f"{over}{height} x {width}, largest {weight.max():.2g}")
            panel.locator_params(nbins=5)
    bar = figure.colorbar(image, ax=panels, shrink=0.7, pad=0.01, aspect=40)
    bar.set_label("mean |weight|, over the largest")
    figure.supxlabel("time axis: frequency in cycles an image")
    figure.supylabel("Doppler axis: frequency in cycles an image")
    return png_bytes(figure)


@dataclass(frozen=True)
class Point:
    """Accuracy on one data set and its interval, as shares; no `snr_db` if it has several."""

    data: str
    snr_db: float | None
    accuracy: float
    low: float
    high: float


def robustness_png(lines: Mapping[str, Sequence[Point]]) -> bytes:
    """Draw the accuracy of each run over the SNR, or over the names of the data sets.

    Args:
        lines: points by name of the run.

    Returns:
        The PNG file.
    """
    figure = page(7.5, 4.6)
    axes = figure.subplots()
    by_snr = all(point.snr_db is not None for points in lines.values() for point in points)
    snrs = {p.snr_db for points in lines.values() for p in points}
    names = list(dict.fromkeys(p.data for points in lines.values() for p in points))
    for number, (name, points) in enumerate(lines.items()):
        if by_snr:
            untested = snrs - {p.snr_db for p in points}  # where the line is interrupted
            points = [*points, *(Point("", snr, nan, nan, nan) for snr in untested)]
            points.sort(key=lambda p: p.snr_db or 0.0)
            x = [p.snr_db or 0.0 for p in points]
        else:
            x = [names.index(p.data) + 0.08 * (number - (len(lines) - 1) / 2) for p in points]
        y = [100 * p.accuracy for p in points]
        ends = ([p.accuracy - p.low for p in points], [p.high - p.accuracy for p in points])
        spread = [[100 * max(0.0, length) for length in one] for one in ends]
        look: dict[str, Any] = {"fmt": "o-" if by_snr else "o", "color": f"C{number % 10}"}
        axes.errorbar(x, y, spread, capsize=3, label=name, **look)
    if by_snr:
        axes.set_xlabel("SNR of the data (dB)")
    else:
        axes.set_xticks(range(len(names)), names, rotation=25, ha="right")
    axes.set(ylabel="accuracy (%), 95 % interval", ylim=(0, 102))
    axes.grid(alpha=0.3)
    figure.legend(loc="outside right center")
    return png_bytes(figure)


@dataclass(frozen=True)
class AlarmPoint:
    """Share of the events that are found at a threshold, and false alarms an hour."""

    threshold: float
    recall: float
    false_alarms_an_hour: float


def alarms_png(
    points: Sequence[AlarmPoint],
    chosen: AlarmPoint,
    recall_95: Sequence[float] | None,
    false_alarms_95: Sequence[float] | None,
    title: str,
) -> bytes:
    """Draw the share of events found over false alarms an hour, threshold by threshold.

    Args:
        points: one a threshold, by rising threshold.
        chosen: the threshold that is reported.
        recall_95: interval of its recall; None of too few groups.
        false_alarms_95: interval of its false alarms; None of too few groups.
        title: line above.

    Returns:
        The PNG file.
    """
    figure = page(7.0, 4.4)
    axes = figure.subplots()
    x, y = [p.false_alarms_an_hour for p in points], [100 * p.recall for p in points]
    axes.plot(x, y, "o-", color="C0", markersize=4)
    for point, alarms, recall in zip(points, x, y, strict=True):
        look: dict[str, Any] = {"textcoords": "offset points", "fontsize": SMALL}
        axes.annotate(f"{point.threshold:g}", (alarms, recall), xytext=(4, -9), **look)
    middle = chosen.false_alarms_an_hour, 100 * chosen.recall
    ends = (false_alarms_95, recall_95 and [100 * end for end in recall_95])
    spread = [
        None if pair is None else [[max(0.0, at - pair[0])], [max(0.0, pair[1] - at)]]
        for at, pair in zip(middle, ends, strict=True)
    ]
    label = f"threshold {chosen.threshold:g}, 95 % intervals"
    axes.errorbar(*middle, spread[1], spread[0], fmt="o", color="C3", capsize=3, label=label)
    axes.set_xscale("symlog", linthresh=1)
    axes.set(xlabel="false alarms an hour", ylabel="events found (%)", ylim=(-2, 104))
    axes.set_xlim(left=-0.1)
    axes.xaxis.set_major_formatter(FormatStrFormatter("%g"))
    axes.grid(alpha=0.3)
    axes.legend(loc="lower center")
    axes.set_title(title)
    return png_bytes(figure)


def bars_png(names: Sequence[str], values: Sequence[float], quantity: str, title: str) -> bytes:
    """Draw a bar for every name, whose values are of one quantity; return the PNG file."""
    figure = page(6.0, 0.8 + 0.26 * len(names))
    axes = figure.subplots()
    places = range(len(names))
    axes.barh(places, values, color="C0")
    axes.set_yticks(places, [name.replace("_", " ") for name in names])
    axes.invert_yaxis()
    axes.set_xlabel(quantity)
    axes.grid(axis="x", alpha=0.3)
    axes.set_title(title)
    return png_bytes(figure)
