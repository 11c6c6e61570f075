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

from radhar_cli.motion.human.physique import Physique
from radhar_cli.numerics.arrays import Float

DEGREE = 8
LIFT_SHAPE = np.array([0, 0, 0, 1, -5, 10, -10, 5, -1]) / (0.375**3 * 0.625**5)  # peak 1 at 3/8
LAG_SHAPE = np.array([0, 0, 0, 1, -3, 3, -1, 0, 0]) * 64  # t^3 (1 - t)^3, peak 1 at 1/2


class Footfalls(NamedTuple):
    """The N swings of one foot, and the footholds before and after each."""

    # off, toe, down: heel-off, toe-off and touch-down [N], s
    off: Float
    toe: Float
    down: Float
    # before, after: x and y of the footholds [2, N], m
    before: Float
    after: Float
    heading: Float  # direction of the foot before the swing [N], rad from the x axis
    size: Float  # length of the step over the walker's usual one [N], at most 1


@dataclass(frozen=True)
class FootTrack:
    """The course of an ankle from foothold to foothold."""

    person: Physique
    falls: Footfalls
    roll: float  # angle at toe-off, rad
    lift: float  # height added to the swing, m
    lag: float  # how far the foot is behind in mid-swing, over the length of the step

    @property
    def breakpoints(self) -> Float:
        """Instants of every heel-off, toe-off and touch-down, s."""
        return np.concatenate([self.falls.off, self.falls.toe, self.falls.down])

    def __call__(self, t: Float) -> Float:
        """Position of the ankle [3, M] (m) at times t [M] (s)."""
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
        """Polynomials of the foot between its 3 N events.

        Returns:
            Instants of the events [3 N] (s), and coefficients [3 N + 1, 5, power] of the time since
            the event before: of x, y, z - z_a of an unrolled foot, beta and heading.
        """
        falls = self.falls
        count = falls.off.size
        coefficients = np.zeros((DEGREE + 1, 3 * count + 1, 5))  # lowest power first
        planted, rolling, swinging = (
            coefficients[:, 0::3],
            coefficients[:, 1::3],
            coefficients[:, 2::3],
        )
        planted[0, :, :2] = np.concatenate([falls.before[:, :1], falls.after], axis=1).T
        rolling[0, :, :2] = falls.before.T
        rolling[0, :, 4] = falls.heading
        rolling[3, :, 3] = self.roll * falls.size / (falls.toe - falls.off) ** 3
        length = falls.down - falls.toe
        ahead, up = self._toe_off()
        for axis, share in enumerate((np.cos(falls.heading), np.sin(falls.heading))):
            position, velocity, acceleration = (share * value for value in ahead)
            position = position + falls.before[axis]
            swinging[:6, :, axis] = coefficients_to_rest(
                position, velocity, acceleration, falls.after[axis], length
            )
            distance = falls.after[axis] - falls.before[axis]
            swinging[:, :, axis] -= np.outer(LAG_SHAPE, self.lag * distance)
        swinging[:6, :, 2] = coefficients_to_rest(*up, np.zeros(count), length)
        swinging[:, :, 2] += np.outer(LIFT_SHAPE, self.lift * falls.size)
        swinging /= (length ** np.arange(DEGREE + 1)[:, None])[..., None]
        events = np.stack([falls.off, falls.toe, falls.down], axis=1).ravel()
        return events, np.ascontiguousarray(coefficients.transpose(1, 2, 0))

    def _toe_off(self) -> tuple[tuple[Float, Float, Float], tuple[Float, Float, Float]]:
        """Displacement, velocity and acceleration [N] at toe-off: first ahead, then of z - z_a."""
        falls = self.falls
        ball, high = self.person.toes, self.person.ankle
        beta = self.roll * falls.size
        rate = 3 * beta / (falls.toe - falls.off)
        growth = 2 * rate / (falls.toe - falls.off)
        cos, sin = np.cos(beta), np.sin(beta)
        forth, up = ball * sin + high * cos, ball * cos - high * sin  # d/dbeta of x and z
        x = ball * (1 - cos) + high * sin
        z = ball * sin + high * (cos - 1)
        return (
            (x, forth * rate, up * rate**2 + forth * growth),
            (z, up * rate, -forth * rate**2 + up * growth),
        )


def coefficients_to_rest(
    position: Float, velocity: Float, acceleration: Float, end: Float, length: Float
) -> Float:
    """Coefficients [6, N] of quintics that end at rest, lowest power of (t - t0)/length first.

    Args:
        position: At t0 [N], m; likewise velocity and acceleration.
        velocity: m/s.
        acceleration: m/s^2.
        end: Position at t0 + length, m.
        length: Duration, s.
    """
    v, a = velocity * length, acceleration * length**2
    distance = end - position
    return np.array(
        [
            position,
            v,
            a / 2,
            10 * distance - 6 * v - 1.5 * a,
            -15 * distance + 8 * v + 1.5 * a,
            6 * distance - 3 * v - 0.5 * a,
        ]
    )
