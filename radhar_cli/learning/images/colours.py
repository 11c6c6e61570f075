"""Pictures of one colour map drawn in another.

A network that learned from viridis knows nothing of the same map drawn in jet.
"""

from dataclasses import dataclass, replace

from radhar_cli.arrays import Levels
from radhar_cli.dataset.png import colour_table
from radhar_cli.learning.images.colour_maps import levels_behind
from radhar_cli.learning.images.h5 import H5Pixels
from radhar_cli.learning.images.image_set import ImageSet, Pixels, Resized


@dataclass(frozen=True)
class Recoloured:
    """Pictures of one colour map drawn in another."""

    pixels: Pixels
    drawn: str
    wanted: str

    def read(self, row: int) -> Levels:
        """RGB [H, W, 3] of a row."""
        recoloured: Levels = colour_table(self.wanted)[
            levels_behind(self.pixels.read(row), self.drawn)
        ]
        return recoloured


def _recoloured(pixels: Pixels, drawn: str, wanted: str) -> Pixels:
    if isinstance(pixels, H5Pixels):
        return replace(pixels, table=colour_table(wanted))
    if isinstance(pixels, Resized):  # later: a mean of two colours is no colour of the map
        return replace(pixels, pixels=_recoloured(pixels.pixels, drawn, wanted))
    return Recoloured(pixels, drawn, wanted)


def in_colours(images: ImageSet, wanted: str | None) -> ImageSet:
    """The same pictures in the colour map that a network learned from, and a note that says so.

    Pictures of no known colour map stay as they are, with a warning; so do all others where it is
    not known what the network learned from.
    """
    if wanted is None or images.colours == wanted or images.kind != "rgb":
        return images
    if images.colours is None:
        note = (
            f"warning: {images.where}: its colours are of no known colour map, the network's are "
            f"{wanted}; input: gray would learn from brightness alone"
        )
        return replace(images, notes=(*images.notes, note))
    recoloured = _recoloured(images.pixels, images.colours, wanted)
    note = f"{images.where}: drawn in {images.colours}, recoloured to {wanted} as in training"
    return replace(
        images,
        colours=wanted,
        pixels=recoloured,
        notes=(*images.notes, note),
    )
