"""Number and shape of the outputs of networks."""

from dataclasses import dataclass
from enum import Enum


class OutputShape(Enum):
    """Shape of the outputs for B inputs, of sequences of T frames each."""

    INPUT = "[B, count]"
    FRAMES = "[B, T, count]"  # of every frame
    PLACES = "[B, T, count/3, 3]"  # of every frame, in m, in the radar's axes


@dataclass(frozen=True)
class Outputs:
    """Outputs of a network."""

    count: int  # numbers of the last layer, for an input or for each of its frames
    shape: OutputShape = OutputShape.INPUT

    @property
    def per_frame(self) -> bool:
        """Whether every frame of a sequence has outputs of its own."""
        return self.shape is not OutputShape.INPUT
