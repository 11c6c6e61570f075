"""Protocol of anything that moves and echoes."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

from radhar_cli.numerics.arrays import Float

T = TypeVar("T")
CACHED_SETS = 512  # results that a cache holds: of the ways by the faces of a room, and their legs
CACHED_INSTANTS = 2**16  # instants of all sets together, or of one that is longer


class Motion(Protocol):
    """Scatterers and their positions at any time, also a little before and after the recording.

    Attributes:
        names: Names of the I scatterers.
        parents: Number of the scatterer that each one hangs on, None for a root; for drawings.
        breakpoints: Instants (s) at which a position, or a derivative that matters, jumps.
        highest_frequency: Fundamental of the fastest movement, Hz.
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
class ScattererSubset:
    """A motion of which only some scatterers are seen, such as one joint of a person."""

    motion: Motion
    numbers: tuple[int, ...]  # places of the scatterers in `motion.names`

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.motion.names[i] for i in self.numbers)

    @property
    def parents(self) -> tuple[int | None, ...]:
        return (None,) * len(self.numbers)

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
        """Positions of the chosen scatterers [3, len(numbers), M] (m) at times t [M] (s)."""
        return self.motion.positions(t)[:, list(self.numbers)]

    def cross_sections(self, t: Float) -> Float:
        """RCS of the chosen scatterers [len(numbers), M or 1], m^2."""
        return self.motion.cross_sections(t)[list(self.numbers)]

    def torso(self, t: Float) -> Float:
        """Torso of the complete motion [3, 1, M], m: scatterers that are left out move on."""
        return self.motion.torso(t)


def cache_motion(motion: Motion) -> Motion:
    """Wrap a motion that is asked for the same times again and again, such as by several channels.

    Callers must not change the arrays that it returns.
    """
    if isinstance(motion, ScattererSubset):
        return ScattererSubset(cache_motion(motion.motion), motion.numbers)
    if isinstance(motion, _CachedMotion):
        return motion
    return _CachedMotion(motion)


class _CachedMotion:
    """A motion whose positions are computed once for each set of times; all else passes through."""

    def __init__(self, motion: Motion) -> None:
        self._motion = motion
        self._results: dict[tuple[object, bytes], Any] = {}
        self._instants = 0

    def __getattr__(self, name: str) -> Any:
        value = getattr(self._motion, name)
        if name != "landmark_positions":
            return value
        return lambda t: self.result(name, t, lambda: value(t))

    def positions(self, t: Float) -> Float:
        """Positions [3, I, M] (m), those of all landmarks where these begin with them."""
        names: tuple[str, ...] = self._motion.names
        landmarks = self._results.get(("landmark_positions", t.tobytes()))
        if landmarks is not None and self.landmarks[: len(names)] == names:
            joints: Float = landmarks[:, : len(names)]
            return joints
        return self.result("positions", t, lambda: self._motion.positions(t))

    def torso(self, t: Float) -> Float:
        """Torso [3, 1, M] (m), from the positions of all joints where these are known."""
        if "torso" in self._motion.names:
            place = self._motion.names.index("torso")
            for name in ("positions", "landmark_positions"):
                if (positions := self._results.get((name, t.tobytes()))) is not None:
                    torso: Float = positions[:, place : place + 1]
                    return torso
        return self.result("torso", t, lambda: self._motion.torso(t))

    def result(self, name: object, t: Float, compute: Callable[[], T]) -> T:
        """Return a result of the times t [M] from the cache, or compute it and keep it there.

        Args:
            name: Tells results of the same times apart; hashable.
            t: Times, s.
            compute: Makes the result; called only where it is not in the cache.
        """
        key = (name, t.tobytes())
        if key not in self._results:
            if len(self._results) >= CACHED_SETS or self._instants + t.size > CACHED_INSTANTS:
                self._results.clear()
                self._instants = 0
            self._instants += t.size
            self._results[key] = compute()
        result: T = self._results[key]
        return result


def cached_result(motion: Motion, name: object, t: Float, compute: Callable[[], T]) -> T:
    """Compute something of a motion at times t [M] (s), once for each set of times if it caches.

    Args:
        motion: What `compute` looks at; the result is kept with it where it comes from
            `cache_motion`, and is computed anew otherwise.
        name: Tells results of the same times apart; hashable.
        t: Times, s.
        compute: Makes the result.
    """
    source = motion.motion if isinstance(motion, ScattererSubset) else motion
    return source.result(name, t, compute) if isinstance(source, _CachedMotion) else compute()
