"""Two-dimensional embeddings side by side, coloured by class."""

from collections.abc import Mapping, Sequence

from radhar_cli.arrays import Float, Index
from radhar_cli.figures.page import page, png_bytes


def embeddings_png(
    panels: Mapping[str, Float], label: Index, names: Sequence[str], title: str
) -> bytes:
    """Draw each embedding [N, 2] under its name; `label` [N] numbers `names`."""
    figure = page(5.2 * len(panels) + 1.6, 4.8)
    drawn = figure.subplots(1, len(panels), squeeze=False)[0]
    from matplotlib import colormaps

    colours = colormaps["tab20"]
    for axes, (name, points) in zip(drawn, panels.items(), strict=True):
        for number, class_name in enumerate(names):
            mine = points[label == number]
            if len(mine):
                axes.scatter(
                    mine[:, 0],
                    mine[:, 1],
                    s=12,
                    color=colours(number % 20),
                    label=class_name.replace("_", " "),
                )
        axes.set_title(name, fontsize=10)
        axes.set_xticks([])
        axes.set_yticks([])
    figure.legend(*drawn[0].get_legend_handles_labels(), loc="outside right center", fontsize=7)
    figure.suptitle(title, fontsize=9)
    return png_bytes(figure)
