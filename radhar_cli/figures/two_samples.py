"""Maps of two data sets beside each other."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from radhar_cli.figures.page import page_of_rows, png_bytes
from radhar_cli.numerics.arrays import Levels


@dataclass(frozen=True)
class Picture:
    """A map to draw: levels [H, W], edges (left, right, bottom, top), and a caption."""

    levels: Levels
    extent: tuple[float, float, float, float]
    words: str


def pictures_png(
    rows: Mapping[str, Sequence[Picture]], title: str, across: str, upwards: str
) -> bytes:
    """Draw rows of maps, each row beside its name.

    Args:
        rows: maps of each row, by name.
        title: line above.
        across: quantity and unit of the columns of a map.
        upwards: quantity and unit of its rows.

    Returns:
        The PNG file.
    """
    figure, panels = page_of_rows(rows, (2.0, 1.75), (1.2, 0.8))
    for panel, picture in panels:
        look: dict[str, Any] = {"cmap": "viridis", "vmin": 0, "vmax": 255, "aspect": "auto"}
        panel.imshow(picture.levels, extent=picture.extent, interpolation="nearest", **look)
        panel.set_title(picture.words)
        panel.locator_params(nbins=4)
        panel.tick_params(length=2)
        panel.label_outer()
    figure.supxlabel(across)
    figure.supylabel(upwards)
    figure.suptitle(title)
    return png_bytes(figure)
