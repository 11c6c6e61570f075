"""Things in a room that are never quite still: furniture, a curtain, the mount of a fan."""

from dataclasses import dataclass

import numpy as np

from radhar_cli.numerics.arrays import Float

TONES = 8
SLOWEST = 0.1  # of a residual motion, over its highest frequency
# `highest_frequency` is that of a gait, which has some ten harmonics; these motions have none.
HARMONICS = 10.0


@dataclass(frozen=True, eq=False)
class Reflectors:
    """Static reflectors with a residual motion along the line of sight, for `MotionPaths`.

    Reflector i is at p_i + u_i d_i(t), u_i the direction to `towards`, d_i a sum of TONES sines of
    equal amplitude and standard deviation sd_i, at frequencies from SLOWEST f_i to f_i.
    """

    places: Float  # mean positions p [I, 3], m
    rcs: Float  # [I], m^2
    sd: Float  # standard deviations of d [I], m
    fastest: Float  # highest frequencies f [I], Hz
    # fractions, phases: frequency and phase of each tone [I, TONES], from 0 to 1 in its range and
    # its cycle
    fractions: Float
    phases: Float
    towards: Float  # point to which the reflectors move, such as the radar [3], m

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(f"reflector {i}" for i in range(len(self.rcs)))

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return ()

    @property
    def highest_frequency(self) -> float:
        moving = self.fastest[self.sd > 0]
        return float(moving.max(initial=0.0)) / HARMONICS

    def positions(self, t: Float) -> Float:
        """Positions [3, I, M] (m) at times t [M] (s): p_i + u_i d_i(t)."""
        direction = self.towards - self.places
        direction = direction / np.maximum(np.linalg.norm(direction, axis=1, keepdims=True), 1e-9)
        frequency = self.fastest[:, None] * (SLOWEST + (1 - SLOWEST) * self.fractions)
        displacement = np.zeros((len(self.rcs), t.size))
        for f, phase in zip(frequency.T, self.phases.T, strict=True):
            displacement += np.sin(2 * np.pi * (f[:, None] * t + phase[:, None]))
        displacement *= self.sd[:, None] * np.sqrt(2 / TONES)
        p: Float = self.places.T[:, :, None] + direction.T[:, :, None] * displacement
        return p

    def cross_sections(self, t: Float) -> Float:
        """RCS [I, 1] (m^2), the same at all times."""
        return self.rcs[:, None]
