"""What an echo engine is given: paths, and a source that yields them at any time."""

from typing import NamedTuple, Protocol

from radhar_cli.arrays import Float


class Paths(NamedTuple):
    """Paths at some times.

    Attributes:
        delay: tau [I, M], s.
        amplitude: A [I, M] for unit transmit power.
        power: incoherent power [M] that the SNR refers to, sum_i A_i^2.
    """

    delay: Float
    amplitude: Float
    power: Float


class PathSource(Protocol):
    """Paths at any time, also a little before and after the recording.

    Attributes:
        kinks: instants (s) at which a path is not smooth.
        highest_frequency: fundamental of the fastest motion, Hz.
        smooth: whether paths are smooth between the kinks; a wall's edges make them not so.
    """

    @property
    def kinks(self) -> tuple[float, ...]: ...
    @property
    def highest_frequency(self) -> float: ...
    @property
    def smooth(self) -> bool: ...

    def __call__(self, t: Float) -> Paths:
        """Return the paths at times t [M] (s)."""
        ...
