"""What a body does by itself: it sways, breathes, has a pulse, and fidgets.

All of it are functions of the recording's time, whatever activity is under way.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.physique import Physique

CENTRE_OF_MASS = 0.56  # height over stature
SWAY_HZ = tuple(np.linspace(0.05, 0.9, 8).tolist())
GOLDEN = (5**0.5 - 1) / 2


def spread_phases(count: int, first: float = 0.0) -> tuple[float, ...]:
    """Phases (rad) that are spread evenly, for scenes in which nothing is drawn."""
    return tuple(2 * np.pi * ((first + k * GOLDEN) % 1) for k in range(count))


@dataclass(frozen=True)
class Waves:
    """A sum of cosines: sum_k a_k cos(2 pi f_k t + phi_k), frequencies in Hz, phases in rad."""

    amplitudes: tuple[float, ...] = ()
    frequencies: tuple[float, ...] = ()
    phases: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not len(self.amplitudes) == len(self.frequencies) == len(self.phases):
            raise ValueError("waves have as many amplitudes as frequencies and phases")

    @classmethod
    def low_pass(
        cls,
        deviation: float,
        phases: Sequence[float],
        frequencies: Sequence[float] = SWAY_HZ,
        corner: float = 0.25,
    ) -> "Waves":
        """Waves of a standard deviation whose amplitudes fall as 1/sqrt(1 + (f/corner)^4)."""
        f = np.asarray(frequencies, dtype=float)
        a = 1 / np.sqrt(1 + (f / corner) ** 4)
        a *= deviation / np.sqrt((a * a).sum() / 2)
        return cls(tuple(a.tolist()), tuple(f.tolist()), tuple(phases))

    def __call__(self, t: Float) -> Float:
        """Values [M] at times t [M] (s)."""
        f, phi = np.array(self.frequencies)[:, None], np.array(self.phases)[:, None]
        waves: Float = np.array(self.amplitudes) @ np.cos(2 * np.pi * f * t + phi)
        return waves

    def integral(self, t: Float) -> Float:
        """sum_k a_k/(2 pi f_k) sin(2 pi f_k t + phi_k), whose rate the waves are [M]."""
        omega = 2 * np.pi * np.array(self.frequencies)
        phi = np.array(self.phases)[:, None]
        waves: Float = (np.array(self.amplitudes) / omega) @ np.sin(omega[:, None] * t + phi)
        return waves


@dataclass(frozen=True)
class Sway:
    """Displacement of the centre of mass, ahead and to the left, m.

    An inverted pendulum over the ankles (Winter et al., J. Neurophysiology 80 (1998) 1211);
    4 mm ahead and 2.5 mm aside are usual standard deviations.
    """

    ahead: Waves = field(default_factory=lambda: Waves.low_pass(0.004, spread_phases(8)))
    aside: Waves = field(default_factory=lambda: Waves.low_pass(0.0025, spread_phases(8, 0.3)))


@dataclass(frozen=True)
class Breath:
    """Breathing and pulse: how far the chest is ahead of its place, m, Hz, rad."""

    chest: float = 0.004
    breathing: float = 0.25
    breathing_phase: float = 0.0
    heart: float = 0.00025
    pulse: float = 1.15
    pulse_phase: float = 0.0

    def __call__(self, t: Float) -> Float:
        """Displacement [M], m, at times t [M] (s)."""
        breath = self.chest * np.sin(2 * np.pi * self.breathing * t + self.breathing_phase)
        beat = self.heart * np.sin(2 * np.pi * self.pulse * t + self.pulse_phase)
        d: Float = breath + beat
        return d


class Fidget(NamedTuple):
    """A small movement at rest: a channel goes to a value within `length` s from `at` on.

    Channels: "shift" of weight to the left, m; "lean" of the whole body ahead; "pitch", "yaw" of
    the trunk; "right_shoulder", "left_shoulder", "right_elbow", "left_elbow", further flexion, rad.
    """

    channel: str
    to: float
    at: float
    length: float


FIDGETS = (
    "shift",
    "lean",
    "pitch",
    "yaw",
    "right_shoulder",
    "left_shoulder",
    "right_elbow",
    "left_elbow",
)


@dataclass(frozen=True)
class IdleState:
    """The body's own movements at some times t [M] (s), worked out as they are asked for."""

    idle: "Idle"
    t: Float

    @cached_property
    def _fidgets(self) -> dict[str, Float]:
        course = self.idle.course
        return dict(zip(course.channels, course(self.t), strict=True))

    @cached_property
    def lean(self) -> Float:
        """Of legs and trunk ahead [M], rad."""
        height = CENTRE_OF_MASS * self.idle.person.stature
        lean: Float = np.arcsin(self.idle.sway.ahead(self.t) / height) + self._fidgets["lean"]
        return lean

    @cached_property
    def roll(self) -> Float:
        """Of legs and trunk to the left [M], rad."""
        person = self.idle.person
        height = CENTRE_OF_MASS * person.stature - person.ankle
        roll: Float = np.arcsin(self.idle.sway.aside(self.t) / height)
        return roll

    @cached_property
    def legs_roll(self) -> Float:
        """Of the legs to the left [M], rad: sway and shifted weight."""
        person = self.idle.person
        shift = np.arcsin(self._fidgets["shift"] / (person.rest_height - person.ankle))
        roll: Float = self.roll + shift
        return roll

    @property
    def pitch(self) -> Float:
        """Of the trunk ahead, beyond the lean [M], rad."""
        return self.lean + self._fidgets["pitch"]

    @property
    def yaw(self) -> Float:
        """Of the trunk to the left [M], rad."""
        return self._fidgets["yaw"]

    @property
    def shoulders(self) -> Float:
        """Further flexion, right and left [2, M], rad."""
        return np.array([self._fidgets["right_shoulder"], self._fidgets["left_shoulder"]])

    @property
    def elbows(self) -> Float:
        """Further flexion, right and left [2, M], rad."""
        return np.array([self._fidgets["right_elbow"], self._fidgets["left_elbow"]])

    @property
    def breath(self) -> Float:
        """Of the torso ahead [M], m."""
        return self.idle.breath(self.t)


@dataclass(frozen=True)
class Idle:
    """A body's own movements: sway, breath and pulse, fidgets."""

    person: Physique
    sway: Sway = field(default_factory=Sway)
    breath: Breath = field(default_factory=Breath)
    fidgets: tuple[Fidget, ...] = ()

    @cached_property
    def course(self) -> Course:
        """Fidgets one after the other: each goes on from where the last of its channel ended."""
        now = dict.fromkeys(FIDGETS, 0.0)
        steps = []
        for channel, to, at, length in sorted(self.fidgets, key=lambda fidget: fidget.at):
            if channel not in now:
                raise ValueError(f"people do not fidget with {channel!r}, but with {FIDGETS}")
            if channel.endswith("elbow") and to < -self.person.elbow:
                raise ValueError(f"no elbow bends backwards, by {-to:g} rad from its rest")
            steps.append(Step(channel, to - now[channel], at, length))
            now[channel] = to
        return Course.of(dict.fromkeys(FIDGETS, 0.0), steps)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return self.course.breakpoints

    def __call__(self, t: Float) -> IdleState:
        """The state at times t [M] (s)."""
        return IdleState(self, t)
