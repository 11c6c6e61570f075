"""A contact sheet of single images with a caption each."""

from collections.abc import Sequence

from radhar_cli.arrays import Levels
from radhar_cli.figures.page import page, png_bytes

COLUMNS = 4


def captioned_png(images: Sequence[Levels], captions: Sequence[str], title: str) -> bytes:
    """Draw RGB images [H, W, 3], four a row."""
    rows = -(-len(images) // COLUMNS)
    figure = page(2.4 * COLUMNS, 2.5 * rows + 0.4)
    panels = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    for panel in panels:
        panel.set_axis_off()
    for panel, image, caption in zip(panels, images, captions, strict=False):
        panel.imshow(image, interpolation="nearest", aspect="auto")
        panel.set_title(caption, fontsize=7)
    figure.suptitle(title, fontsize=10)
    return png_bytes(figure)
