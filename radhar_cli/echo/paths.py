"""What an echo engine is given: paths, and a source that yields them at any time."""

from typing import NamedTuple, Protocol

from radhar_cli.arrays import Float


class Paths(NamedTuple):
    """Paths at some times.

    Attributes:
        delay: tau [I, M], s.
        amplitude: A [I, M] for unit transmit power.
    """

    delay: Float
    amplitude: Float


class PathSource(Protocol):
    """Paths at any time, also a little before and after the recording.

    Attributes:
        breakpoints: instants (s) at which a path is not smooth, in order.
        highest_frequency: fundamental of the fastest motion, Hz.
        smooth: whether paths are smooth between the breakpoints; a wall's edges make them not so.
    """

    @property
    def breakpoints(self) -> tuple[float, ...]: ...
    @property
    def highest_frequency(self) -> float: ...
    @property
    def smooth(self) -> bool: ...

    def __call__(self, t: Float) -> Paths:
        """Return the paths at times t [M] (s)."""
        ...
