"""Paths, and sources that yield them at any time: the input of echo engines."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from radhar_cli.numerics.arrays import Bool, Float, Index
from radhar_cli.radar.layers import Layers


class Through(NamedTuple):
    """Legs of paths through a layered wall, which acts on each frequency in its own way."""

    layers: Layers  # the wall
    cosine: Float  # of the angle of incidence of both legs [2, I, M]; nan of one beside the wall

    @classmethod
    def of(cls, layers: Layers | None, cosine: Float | None) -> "Through | None":
        """Legs through these layers at these cosines [2, I, M]; None where either is missing."""
        return None if layers is None or cosine is None else cls(layers, cosine)

    @classmethod
    def joined(cls, several: "Sequence[Through | None]") -> "Through | None":
        """Legs of several groups of paths together, which pass the same wall or none."""
        legs = [group for group in several if group is not None]
        if not legs:
            return None
        return cls(legs[0].layers, np.concatenate([group.cosine for group in legs], axis=1))


class Paths(NamedTuple):
    """Paths at some times."""

    delay: Float  # tau [I, M], s
    amplitude: Float  # A [I, M] for unit transmit power
    # the layered wall that they pass; delay and amplitude are then those without it
    through: Through | None = None

    def only(self, paths: Bool | Index | slice, times: Index | slice = slice(None)) -> "Paths":
        """Choose some of the paths, at some of the times."""
        through = self.through
        if through is not None:
            through = through._replace(cosine=through.cosine[:, paths][..., times])
        return Paths(self.delay[paths][:, times], self.amplitude[paths][:, times], through)

    def at_times(self, times: Index | slice) -> "Paths":
        """Choose all of the paths, at some of the times."""
        return self.only(slice(None), times)


class PathSource(Protocol):
    """Paths at any time, also a little before and after the recording."""

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Instants (s) at which a path is not smooth, in order."""
        ...

    @property
    def highest_frequency(self) -> float:
        """Fundamental of the fastest motion, Hz."""
        ...

    @property
    def smooth(self) -> bool:
        """Whether paths are smooth between the breakpoints; a wall's edges make them not so."""
        ...

    def __call__(self, t: Float) -> Paths:
        """Return the paths at times t [M] (s)."""
        ...
