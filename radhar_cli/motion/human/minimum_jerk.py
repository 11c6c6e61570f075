"""Minimum-jerk steps: the way of a limb from one posture to another.

Flash and Hogan, J. Neuroscience 5 (1985) 1688: S(x) = 10 x^3 - 15 x^4 + 6 x^5, x in 0..1, has the
least jerk from rest to rest; twice continuously differentiable, peak slope 1.875.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from radhar_cli.numerics.arrays import Bool, Float, Index

FEW_STEPS = 64  # of which all are evaluated at all times, by one matrix product


def minimum_jerk(x: Float) -> Float:
    """Minimum-jerk step S(x) of x [...], 0 before 0 and 1 after 1."""
    x = x.clip(0.0, 1.0)
    s: Float = x * x * x * (10 + x * (6 * x - 15))
    return s


def minimum_jerk_integral(x: Float) -> Float:
    """Integral of S from minus infinity to x [...]: x^4 (2.5 - 3 x + x^2), x - 1/2 beyond 1."""
    inside = x.clip(0.0, 1.0)
    square = inside * inside
    beyond = np.maximum(x - 1.0, 0.0)
    s: Float = square * square * (2.5 + inside * (inside - 3)) + beyond
    return s


class Step(NamedTuple):
    """A channel changes by `change` within `length` s from `start` on.

    `late` steps are S((t - start)^2/length^2): a slow start and a hard end, as in a fall; peak
    slope 2.725 at 0.745 of the length.
    """

    channel: str
    change: float
    start: float
    length: float
    late: bool = False


class StepsInOrder(NamedTuple):
    """Steps in the order in which they begin, so that few of many are evaluated at a time."""

    order: Index  # numbers of the steps [K]
    starts: Float  # rising [K], s
    # how many before the last that has begun, with it, hold all that may be under way
    at_once: int

    @classmethod
    def of(cls, starts: Float, lengths: Float) -> "StepsInOrder":
        """Sort steps that begin at `starts` and take `lengths` [K], s."""
        order = np.argsort(starts, kind="stable")
        starts_in_order = starts[order]
        all_ended = np.maximum.accumulate(
            starts_in_order + lengths[order]
        )  # the first k have all ended then
        ended_count = np.searchsorted(all_ended, starts_in_order, side="right")
        return cls(
            order,
            starts_in_order,
            int((np.arange(1, ended_count.size + 1) - ended_count).max(initial=0)),
        )

    def earliest(self, t: Float) -> Index:
        """Place in the order of the first step that may be under way at times t [M] (s).

        Those before it have ended, and those from `at_once` places later on have not begun.
        """
        begun_count = np.searchsorted(self.starts, t, side="right")
        return np.maximum(begun_count - self.at_once, 0)


@dataclass(frozen=True)
class Course:
    """Channels that go from value to value: y_c(t) = y_c0 + sum_k w_ck S((t - t_k)/T_k)."""

    channels: tuple[str, ...]  # their names, C
    initial: Float  # [C, 1]
    weights: Float  # [C, K]
    # starts, lengths: [K, 1], s
    starts: Float
    lengths: Float
    late: Bool  # which steps are late [K]

    @classmethod
    def of(cls, initial: Mapping[str, float], steps: Iterable[Step]) -> "Course":
        """Collect steps of channels.

        Args:
            initial: {channel: value before all steps}.
            steps: Changes of these channels, in any order.

        Raises:
            ValueError: A step takes no time.
        """
        channels = tuple(initial)
        columns: dict[tuple[float, float, bool], Float] = {}
        for step in steps:
            if not step.length > 0:
                raise ValueError(f"a movement takes longer than 0 s, not {step.length:g} s")
            key = (step.start, step.length, step.late)
            column = columns.setdefault(key, np.zeros(len(channels)))
            column[channels.index(step.channel)] += step.change
        return cls(
            channels,
            np.array(list(initial.values()), dtype=float)[:, None],
            np.array(list(columns.values()), dtype=float).reshape(-1, len(channels)).T,
            np.array([[start] for start, _, _ in columns], dtype=float).reshape(-1, 1),
            np.array([[length] for _, length, _ in columns], dtype=float).reshape(-1, 1),
            np.array([late for _, _, late in columns], dtype=bool),
        )

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Instants (s) at which the jerk jumps: both ends of every step."""
        ends = np.concatenate([self.starts, self.starts + self.lengths])
        return tuple(float(end) for end in ends[:, 0])

    def __call__(self, t: Float) -> Float:
        """Values of the channels [C, M] at times t [M] (s)."""
        if not self.starts.size:
            return np.broadcast_to(self.initial, (len(self.channels), t.size))
        if self.starts.size > FEW_STEPS:
            return self._values_from_few_steps(t)
        x: Float = ((t - self.starts) / self.lengths).clip(0.0, 1.0)
        if self.late.any():
            x[self.late] **= 2
        return self.initial + self.weights @ (x * x * x * (10 + x * (6 * x - 15)))

    @cached_property
    def _in_order(self) -> tuple[StepsInOrder, Float]:
        """The steps in order, and the values [C, K + 1] after the first k of them."""
        steps = StepsInOrder.of(self.starts[:, 0], self.lengths[:, 0])
        after = np.cumsum(self.weights[:, steps.order], axis=1)
        return steps, self.initial + np.pad(after, ((0, 0), (1, 0)))

    def _values_from_few_steps(self, t: Float) -> Float:
        """Values [C, M] at times t [M] (s), from the few steps that may be under way."""
        steps, after = self._in_order
        earliest = steps.earliest(t)
        values = after[:, earliest]
        for later in range(steps.at_once):
            k = steps.order[earliest + later]
            x = ((t - self.starts[k, 0]) / self.lengths[k, 0]).clip(0.0, 1.0)
            if self.late.any():
                x = np.where(self.late[k], x * x, x)
            values += self.weights[:, k] * minimum_jerk(x)
        return values

    def at(self, t: float) -> dict[str, float]:
        """Values of all channels at one time t (s), by channel."""
        return dict(zip(self.channels, self(np.array([t]))[:, 0].tolist(), strict=True))


@dataclass(frozen=True)
class Lags:
    """Leads and lags of joints: each channel moves in its own part of a step's time."""

    # by which share of its length each step is shorter; 0 moves all joints at the same time
    share: float = 0.0
    # place of each channel's part in the step, from 0 (the beginning) to 1 (the end)
    places: Mapping[str, float] = field(default_factory=dict)

    def __call__(self, steps: Iterable[Step]) -> list[Step]:
        """Shorten and shift steps so that their channels lead and lag."""
        return [
            step._replace(
                start=step.start + self.share * self.places.get(step.channel, 0.0) * step.length,
                length=(1 - self.share) * step.length,
            )
            for step in steps
        ]


def mirrored(steps: Iterable[Step], length: float) -> list[Step]:
    """Steps backwards in time, from `length` to 0."""
    return [s._replace(change=-s.change, start=length - s.start - s.length) for s in steps]
