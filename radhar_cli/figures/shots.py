"""Accuracy over the number of labelled images of each class, with intervals."""

from collections.abc import Mapping, Sequence

from radhar_cli.figures.page import page, png_bytes


def shots_png(
    lines: Mapping[str, Sequence[tuple[int, float, float, float]]], title: str, chance: float
) -> bytes:
    """Draw a line for each way of learning; points are (labelled a class, share, low, high).

    Args:
        lines: {way of learning: points}.
        title: of the figure.
        chance: accuracy of guessing.
    """
    figure = page(7.0, 4.6)
    axes = figure.subplots()
    for number, (name, points) in enumerate(lines.items()):
        x, share, low, high = zip(*points, strict=True)
        middle, below, above = (
            [100 * value for value in values]
            for values in (
                share,
                [max(0.0, s - v) for s, v in zip(share, low, strict=True)],
                [max(0.0, v - s) for s, v in zip(share, high, strict=True)],
            )
        )
        axes.errorbar(
            x, middle, [below, above], fmt="o-", capsize=3, color=f"C{number}", label=name
        )
    axes.axhline(100 * chance, color="k", linestyle=":", linewidth=1, label="chance")
    ticks = sorted({point[0] for points in lines.values() for point in points})
    axes.set_xscale("symlog", linthresh=1)
    axes.set_xticks(ticks, list(map(str, ticks)), minor=False)
    axes.set_xticks([], minor=True)
    axes.set_xlim(-0.3, 1.5 * max(1, ticks[-1]))
    axes.set_ylim(0, 102)
    axes.set_xlabel("labelled images of each class")
    axes.set_ylabel("accuracy (%), 95 % interval")
    axes.set_title(title, fontsize=10)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, loc="lower right")
    return png_bytes(figure)
