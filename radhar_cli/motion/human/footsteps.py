"""Feet of a walker: planted, rolling over the ball, swinging to the next foothold.

Between heel-off and toe-off the foot turns about the ball of the foot by beta = B tau^3, from
toe-off to touch-down it follows quintics that begin with the position, velocity and acceleration
of that moment and end at rest, with a lift on top: everything is twice continuously differentiable.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.interpolate import PPoly

from radhar_cli.arrays import Float
from radhar_cli.motion.human.person import Person

DEGREE = 8
LIFT_SHAPE = np.array([0, 0, 0, 1, -5, 10, -10, 5, -1]) / (0.375**3 * 0.625**5)  # peak 1 at 3/8
MINIMUM_JERK = np.array([0.0, 0, 0, 10, -15, 6])


class Footfalls(NamedTuple):
    """Swings of one foot [N], and the footholds before and after each; s and m.

    Attributes:
        off, toe, down: heel-off, toe-off and touch-down, s.
        before, after: x of the footholds.
        from_side, to_side: y of the footholds.
        size: length of the step over the walker's usual one, at most 1.
    """

    off: Float
    toe: Float
    down: Float
    before: Float
    after: Float
    from_side: Float
    to_side: Float
    size: Float


@dataclass(frozen=True)
class FootTrack:
    """Where an ankle is, at any time.

    Attributes:
        person: whose foot.
        falls: the swings.
        roll: angle at toe-off, rad.
        lift: height added to the swing, m.
    """

    person: Person
    falls: Footfalls
    roll: float
    lift: float

    @property
    def breakpoints(self) -> Float:
        """Every heel-off, toe-off and touch-down, s."""
        return np.concatenate([self.falls.off, self.falls.toe, self.falls.down])

    def __call__(self, t: Float) -> Float:
        """Ankle [3, M] at times t [M] (s)."""
        x, y, z, beta = self._polynomials(t).T
        cos, sin = np.cos(beta), np.sin(beta)
        ball, high = self.person.toes, self.person.ankle
        return np.stack([x + ball * (1 - cos) + high * sin, y, z + ball * sin + high * cos])

    @cached_property
    def _polynomials(self) -> PPoly:
        """x, y and z - z_a of an unrolled foot, and beta [M, 4], in seconds from each event."""
        f, n = self.falls, self.falls.off.size
        c = np.zeros((DEGREE + 1, 3 * n + 1, 4))  # lowest power first
        planted, rolling, swinging = c[:, 0::3], c[:, 1::3], c[:, 2::3]
        planted[0, :, 0] = np.append(f.before[:1], f.after)
        planted[0, :, 1] = np.append(f.from_side[:1], f.to_side)
        rolling[0, :, 0], rolling[0, :, 1] = f.before, f.from_side
        rolling[3, :, 3] = self.roll * f.size / (f.toe - f.off) ** 3
        length = f.down - f.toe
        for axis, toe_off in ((0, self._toe_off()[0]), (2, self._toe_off()[1])):
            target = f.after if axis == 0 else np.zeros(n)
            swinging[:6, :, axis] = to_rest(*toe_off, target, length)
        swinging[:6, :, 1] = np.outer(MINIMUM_JERK, f.to_side - f.from_side)
        swinging[0, :, 1] = f.from_side
        swinging[:, :, 2] += np.outer(LIFT_SHAPE, self.lift * f.size)
        swinging /= (length ** np.arange(DEGREE + 1)[:, None])[..., None]
        events = np.stack([f.off, f.toe, f.down], axis=1).ravel()
        ends = np.concatenate([events[:1] - 1, events, events[-1:] + 1])
        return PPoly.construct_fast(np.ascontiguousarray(c[::-1]), ends)

    def _toe_off(self) -> tuple[tuple[Float, Float, Float], tuple[Float, Float, Float]]:
        """Position, velocity and acceleration at toe-off, of x and of z - z_a."""
        f, ball, high = self.falls, self.person.toes, self.person.ankle
        beta = self.roll * f.size
        rate = 3 * beta / (f.toe - f.off)
        growth = 2 * rate / (f.toe - f.off)
        cos, sin = np.cos(beta), np.sin(beta)
        forth, up = ball * sin + high * cos, ball * cos - high * sin  # d/dbeta of x and z
        x = f.before + ball * (1 - cos) + high * sin
        z = ball * sin + high * (cos - 1)
        return (
            (x, forth * rate, up * rate**2 + forth * growth),
            (z, up * rate, -forth * rate**2 + up * growth),
        )


def to_rest(
    position: Float, velocity: Float, acceleration: Float, end: Float, length: Float
) -> Float:
    """Coefficients [6, N] of a quintic that ends at rest, lowest power of (t - t0)/length first."""
    v, a = velocity * length, acceleration * length**2
    way = end - position
    return np.stack(
        [
            position,
            v,
            a / 2,
            10 * way - 6 * v - 1.5 * a,
            -15 * way + 8 * v + 1.5 * a,
            6 * way - 3 * v - 0.5 * a,
        ]
    )
