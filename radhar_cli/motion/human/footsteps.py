"""Feet of a walker: planted, rolling over the ball, swinging to the next foothold.

Between heel-off and toe-off the foot turns about the ball of the foot by beta = B tau^3, from
toe-off to touch-down it follows quintics that begin with the position, velocity and acceleration
of that moment and end at rest, with a lift on top, and behind by a lag: people's feet are fastest
late in a swing. Everything is twice continuously differentiable.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.motion.human.physique import Physique

DEGREE = 8
LIFT_SHAPE = np.array([0, 0, 0, 1, -5, 10, -10, 5, -1]) / (0.375**3 * 0.625**5)  # peak 1 at 3/8
LAG_SHAPE = np.array([0, 0, 0, 1, -3, 3, -1, 0, 0]) * 64  # t^3 (1 - t)^3, peak 1 at 1/2


class Footfalls(NamedTuple):
    """Swings of one foot [N], and the footholds before and after each; s and m."""

    # off, toe, down: heel-off, toe-off and touch-down, s
    off: Float
    toe: Float
    down: Float
    # before, after: x and y of the footholds [2, N]
    before: Float
    after: Float
    heading: Float  # to where the foot points before the swing, rad from the x axis
    size: Float  # length of the step over the walker's usual one, at most 1


@dataclass(frozen=True)
class FootTrack:
    """Where an ankle is, at any time."""

    person: Physique  # whose foot
    falls: Footfalls  # the swings
    roll: float  # angle at toe-off, rad
    lift: float  # height added to the swing, m
    lag: float  # how far the foot is behind in mid-swing, over the length of the step

    @property
    def breakpoints(self) -> Float:
        """Every heel-off, toe-off and touch-down, s."""
        return np.concatenate([self.falls.off, self.falls.toe, self.falls.down])

    def __call__(self, t: Float) -> Float:
        """Ankle [3, M] at times t [M] (s)."""
        events, polynomials = self._polynomials
        piece = np.searchsorted(events, t, "right")
        since = t - np.concatenate([events[:1], events])[piece]
        powers = np.vander(since, DEGREE + 1, increasing=True)
        x, y, z, beta, heading = np.einsum("mak,mk->am", polynomials[piece], powers)
        cos, sin = np.cos(beta), np.sin(beta)
        ball, high = self.person.toes, self.person.ankle
        ahead = ball * (1 - cos) + high * sin
        if self.falls.heading.any():
            x, y = x + np.cos(heading) * ahead, y + np.sin(heading) * ahead
        else:
            x = x + ahead
        return np.array([x, y, z + ball * sin + high * cos])

    @cached_property
    def _polynomials(self) -> tuple[Float, Float]:
        """When events are, s; before and after each [3 N + 1, 5, power of s since then] x, y,
        z - z_a of an unrolled foot, beta, heading.
        """
        f, n = self.falls, self.falls.off.size
        c = np.zeros((DEGREE + 1, 3 * n + 1, 5))  # lowest power first
        planted, rolling, swinging = c[:, 0::3], c[:, 1::3], c[:, 2::3]
        planted[0, :, :2] = np.concatenate([f.before[:, :1], f.after], axis=1).T
        rolling[0, :, :2] = f.before.T
        rolling[0, :, 4] = f.heading
        rolling[3, :, 3] = self.roll * f.size / (f.toe - f.off) ** 3
        length = f.down - f.toe
        ahead, up = self._toe_off()
        for axis, share in enumerate((np.cos(f.heading), np.sin(f.heading))):
            gone, velocity, acceleration = (share * value for value in ahead)
            gone = gone + f.before[axis]
            swinging[:6, :, axis] = to_rest(gone, velocity, acceleration, f.after[axis], length)
            way = f.after[axis] - f.before[axis]
            swinging[:, :, axis] -= np.outer(LAG_SHAPE, self.lag * way)
        swinging[:6, :, 2] = to_rest(*up, np.zeros(n), length)
        swinging[:, :, 2] += np.outer(LIFT_SHAPE, self.lift * f.size)
        swinging /= (length ** np.arange(DEGREE + 1)[:, None])[..., None]
        events = np.stack([f.off, f.toe, f.down], axis=1).ravel()
        return events, np.ascontiguousarray(c.transpose(1, 2, 0))

    def _toe_off(self) -> tuple[tuple[Float, Float, Float], tuple[Float, Float, Float]]:
        """Way, velocity and acceleration at toe-off, ahead and of z - z_a."""
        f, ball, high = self.falls, self.person.toes, self.person.ankle
        beta = self.roll * f.size
        rate = 3 * beta / (f.toe - f.off)
        growth = 2 * rate / (f.toe - f.off)
        cos, sin = np.cos(beta), np.sin(beta)
        forth, up = ball * sin + high * cos, ball * cos - high * sin  # d/dbeta of x and z
        x = ball * (1 - cos) + high * sin
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
    return np.array(
        [
            position,
            v,
            a / 2,
            10 * way - 6 * v - 1.5 * a,
            -15 * way + 8 * v + 1.5 * a,
            6 * way - 3 * v - 0.5 * a,
        ]
    )
