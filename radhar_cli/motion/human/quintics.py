"""Curves through knots of given position, velocity and acceleration: quintics between them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from radhar_cli.numerics.arrays import Float


@dataclass(frozen=True)
class Quintics:
    """Channels that go from knot to knot, twice continuously differentiable; at rest beyond them.

    Between knots that one parabola joins the curve is that parabola.
    """

    times: Float  # of the knots [K], rising, s
    knots: Float  # value, velocity and acceleration at the knots [K, 3, C], in s

    @cached_property
    def _coefficients(self) -> Float:
        """Coefficients [K - 1, 6, C] of the share of time between two knots, lowest power first."""
        length = np.diff(self.times)[:, None]
        (y0, v0, a0), (y1, v1, a1) = (
            (part[:, 0], part[:, 1] * length, part[:, 2] * length**2)
            for part in (self.knots[:-1], self.knots[1:])
        )
        change = y1 - y0
        return np.stack(
            [
                y0,
                v0,
                a0 / 2,
                10 * change - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1,
                -15 * change + 8 * v0 + 7 * v1 + 1.5 * a0 - a1,
                6 * change - 3 * (v0 + v1) - 0.5 * (a0 - a1),
            ],
            axis=1,
        )

    def __call__(self, t: Float) -> Float:
        """Values of the channels [C, M] at times t [M] (s)."""
        last = self.times.size - 2
        piece = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, last)
        length = np.diff(self.times)[piece]
        x = ((t - self.times[piece]) / length).clip(0.0, 1.0)[:, None]
        c = self._coefficients[piece]
        values = c[:, 5]
        for power in range(4, -1, -1):
            values = values * x + c[:, power]
        return np.ascontiguousarray(values.T)

    def knot(self, t: float) -> Float:
        """Value, velocity and acceleration of the channels [3, C] at one time t (s)."""
        piece = int(np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, None))
        length = self.times[piece + 1] - self.times[piece]
        powers = ((t - self.times[piece]) / length) ** np.arange(6)
        slope = np.arange(1, 6)
        c = self._coefficients[piece]
        return np.array(
            [
                powers @ c,
                (slope * powers[:5]) @ c[1:] / length,
                (slope[1:] * slope[:4] * powers[:4]) @ c[2:] / length**2,
            ]
        )
