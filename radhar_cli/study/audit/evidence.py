"""Parts of a data set from which the class is guessed: numbers, margins, noise."""

from dataclasses import dataclass
from enum import StrEnum

from radhar_cli.numerics.arrays import Float


class EvidencePart(StrEnum):
    """Kinds of evidence from which the class is guessed; the value is its name in tables."""

    NUMBERS = "numbers"  # of scenes
    RECORDINGS = "recordings"  # order, length, names of files, columns of a table
    MARGINS = "margins"  # of images
    NOISE = "noise"  # of images
    CLOUDS = "clouds"


@dataclass(frozen=True)
class Evidence:
    """Features from which the class is guessed, and what to do where that works.

    Attributes:
        part: kind of the features.
        name: name of the features, in words.
        values: [N, D]; NaN where a sample has none.
        key: config key, column of a table, or none.
        cure: advice on what to write, draw or record instead.
        may_be_movement: whether the movement itself shows there, so that it is no shortcut for
            sure.
        leaves_out_missing: whether samples without a value are left out, as of numbers that a
            movement does not have; else that one is missing may tell the class.
        tells_who: whether it tells the person, so that samples instead of persons are held out.
        ranks: [N, D/2] of places of images, by which those with marks are chosen (`marks`).
    """

    part: EvidencePart
    name: str
    values: Float
    key: str = ""
    cure: str = ""
    may_be_movement: bool = False
    leaves_out_missing: bool = False
    tells_who: bool = False
    ranks: Float | None = None
