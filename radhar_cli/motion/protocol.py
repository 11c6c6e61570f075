"""What the echo needs to know of anything that moves."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

from radhar_cli.arrays import Float

T = TypeVar("T")
KEPT_TIMES = 8  # sets of times of a motion that is remembered: chirps of a board's transmitters
KEPT_INSTANTS = 2**16  # of all of them together, or of one that is longer


class Motion(Protocol):
    """Scatterers and where they are at any time, also a little before and after the recording.

    Attributes:
        names: of the I scatterers.
        parents: number of the scatterer that each one hangs on, None for a root; for drawings.
        breakpoints: instants (s) at which a position, or a derivative that matters, jumps.
        highest_frequency: fundamental of the fastest movement, Hz.
        phases: (start in s, name) of the movements within it, in their order; may be empty. Names
            of `motion.phases.PHASES` where they fit.
    """

    @property
    def names(self) -> tuple[str, ...]: ...
    @property
    def parents(self) -> tuple[int | None, ...]: ...
    @property
    def breakpoints(self) -> tuple[float, ...]: ...
    @property
    def highest_frequency(self) -> float: ...
    @property
    def phases(self) -> tuple[tuple[float, str], ...]: ...

    def positions(self, t: Float) -> Float:
        """Positions [3, I, M] (m) at times t [M] (s): x range, y cross-range, z height."""
        ...

    def cross_sections(self, t: Float) -> Float:
        """RCS (m^2) at times t [M]: [I, M], or [I, 1] where it does not change."""
        ...

    def torso(self, t: Float) -> Float:
        """Positions [3, 1, M] (m) of the point that bulk Doppler compensation follows."""
        ...


@dataclass(frozen=True)
class Only:
    """A motion with some of its scatterers alone."""

    motion: Motion  # the whole
    kept: tuple[int, ...]  # numbers of the scatterers that are kept

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.motion.names[i] for i in self.kept)

    @property
    def parents(self) -> tuple[int | None, ...]:
        return (None,) * len(self.kept)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return self.motion.breakpoints

    @property
    def highest_frequency(self) -> float:
        return self.motion.highest_frequency

    @property
    def phases(self) -> tuple[tuple[float, str], ...]:
        return self.motion.phases

    def positions(self, t: Float) -> Float:
        """Positions [3, len(kept), M] (m)."""
        return self.motion.positions(t)[:, list(self.kept)]

    def cross_sections(self, t: Float) -> Float:
        """RCS (m^2) [len(kept), M or 1]."""
        return self.motion.cross_sections(t)[list(self.kept)]

    def torso(self, t: Float) -> Float:
        """Of the whole motion: what is left out still moves."""
        return self.motion.torso(t)


def remembered(motion: Motion) -> Motion:
    """A motion that is asked for the same times again and again, such as by several channels.

    What it returns is not to be changed.
    """
    if isinstance(motion, Only):
        return Only(remembered(motion.motion), motion.kept)
    if isinstance(motion, _Remembered):
        return motion
    return _Remembered(motion)  # the rest of it comes by __getattr__


class _Remembered:
    def __init__(self, motion: Motion) -> None:
        self._motion = motion
        self._held: dict[tuple[object, bytes], Any] = {}
        self._instants = 0

    def __getattr__(self, name: str) -> Any:
        found = getattr(self._motion, name)
        if name != "landmark_positions":
            return found
        return lambda t: self.kept(name, t, lambda: found(t))

    def positions(self, t: Float) -> Float:
        """Positions [3, I, M] (m), of all landmarks where these are known and begin with them."""
        names: tuple[str, ...] = self._motion.names
        whole = self._held.get(("landmark_positions", t.tobytes()))
        if whole is not None and self.landmarks[: len(names)] == names:
            joints: Float = whole[:, : len(names)]
            return joints
        return self.kept("positions", t, lambda: self._motion.positions(t))

    def torso(self, t: Float) -> Float:
        """Positions [3, 1, M] (m), of all joints where these are known."""
        if "torso" in self._motion.names:
            place = self._motion.names.index("torso")
            for name in ("positions", "landmark_positions"):
                if (whole := self._held.get((name, t.tobytes()))) is not None:
                    torso: Float = whole[:, place : place + 1]
                    return torso
        return self.kept("torso", t, lambda: self._motion.torso(t))

    def kept(self, name: object, t: Float, make: Callable[[], T]) -> T:
        """What was made for these times, or is made now."""
        key = (name, t.tobytes())
        if key not in self._held:
            if len(self._held) >= KEPT_TIMES or self._instants + t.size > KEPT_INSTANTS:
                self._held.clear()
                self._instants = 0
            self._instants += t.size
            self._held[key] = make()
        found: T = self._held[key]
        return found


def recalled(motion: Motion, name: object, t: Float, make: Callable[[], T]) -> T:
    """What was made of a remembered motion for these times; of another it is made anew."""
    whole = motion.motion if isinstance(motion, Only) else motion
    return whole.kept(name, t, make) if isinstance(whole, _Remembered) else make()
