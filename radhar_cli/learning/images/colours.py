"""Pictures of one colour map drawn in another.

A network that learned from viridis knows nothing of the same map drawn in jet.
"""

from dataclasses import dataclass, replace

from radhar_cli.dataset.png import colour_table
from radhar_cli.learning.images.colour_maps import levels_behind
from radhar_cli.learning.images.h5 import H5Pixels
from radhar_cli.learning.images.image_set import ImageSet, Pixels, Resized
from radhar_cli.learning.images.windows import WindowPixels
from radhar_cli.numerics.arrays import Levels


@dataclass(frozen=True)
class Recoloured:
    """Pictures of one colour map drawn in another."""

    pixels: Pixels
    drawn: str  # colour map of the pictures
    colour_map: str  # colour map in which they are read

    def read(self, row: int) -> Levels:
        """RGB [H, W, 3] of a row."""
        recoloured: Levels = colour_table(self.colour_map)[
            levels_behind(self.pixels.read(row), self.drawn)
        ]
        return recoloured


def _recolour_pixels(pixels: Pixels, drawn: str, colour_map: str) -> Pixels:
    if isinstance(pixels, H5Pixels):
        return replace(pixels, table=colour_table(colour_map))
    if isinstance(pixels, WindowPixels):
        return replace(pixels, pixels=_recolour_pixels(pixels.pixels, drawn, colour_map))
    if isinstance(pixels, Resized):  # later: a mean of two colours is no colour of the map
        return replace(pixels, pixels=_recolour_pixels(pixels.pixels, drawn, colour_map))
    return Recoloured(pixels, drawn, colour_map)


def recolour(images: ImageSet, colour_map: str | None) -> ImageSet:
    """Pictures redrawn in the colour map that a network learned from, with a note that says so.

    Pictures of no known colour map stay as they are, with a warning; so do all others where it is
    not known what the network learned from.
    """
    if colour_map is None or images.colours == colour_map or images.kind != "rgb":
        return images
    if images.colours is None:
        note = (
            f"warning: {images.where}: its colours are of no known colour map, the network's are "
            f"{colour_map}; input: gray would learn from brightness alone"
        )
        return replace(images, notes=(*images.notes, note))
    recoloured = _recolour_pixels(images.pixels, images.colours, colour_map)
    note = f"{images.where}: drawn in {images.colours}, recoloured to {colour_map} as in training"
    return replace(
        images,
        colours=colour_map,
        pixels=recoloured,
        notes=(*images.notes, note),
    )
