"""Movements that a body makes by itself: it sways, breathes, has a pulse, and fidgets.

All are functions of the recording's time, whatever activity is under way.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.physique import Physique
from radhar_cli.numerics.arrays import Float

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
        """Waves whose amplitudes fall as 1/sqrt(1 + (f/corner)^4).

        Args:
            deviation: Standard deviation of the sum.
            phases: One of each frequency, rad.
            frequencies: Hz.
            corner: Hz.
        """
        f = np.asarray(frequencies, dtype=float)
        a = 1 / np.sqrt(1 + (f / corner) ** 4)
        a *= deviation / np.sqrt((a * a).sum() / 2)
        return cls(tuple(a.tolist()), tuple(f.tolist()), tuple(phases))

    def __call__(self, t: Float) -> Float:
        """Values of the sum [M] at times t [M] (s)."""
        f, phi = np.array(self.frequencies)[:, None], np.array(self.phases)[:, None]
        waves: Float = np.array(self.amplitudes) @ np.cos(2 * np.pi * f * t + phi)
        return waves

    def integral(self, t: Float) -> Float:
        """Integral of the sum over time [M]: sum_k a_k/(2 pi f_k) sin(2 pi f_k t + phi_k)."""
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
    """Breathing and pulse as a displacement of the chest; in m, Hz and rad."""

    chest: float = 0.004
    breathing: float = 0.25
    breathing_phase: float = 0.0
    heart: float = 0.00025
    pulse: float = 1.15
    pulse_phase: float = 0.0

    def __call__(self, t: Float) -> Float:
        """Displacement of the chest ahead [M] (m) at times t [M] (s)."""
        breath = self.chest * np.sin(2 * np.pi * self.breathing * t + self.breathing_phase)
        beat = self.heart * np.sin(2 * np.pi * self.pulse * t + self.pulse_phase)
        d: Float = breath + beat
        return d


NO_SWAY, NO_BREATH = Sway(Waves(), Waves()), Breath(chest=0.0, heart=0.0)


class Fidget(NamedTuple):
    """A small movement at rest: a channel goes to `target` within `length_s` from `start_s` on.

    Channels are "shift" of weight to the left, m; "lean" of the whole body ahead; "pitch", "yaw" of
    the trunk; "right_shoulder", "left_shoulder", "right_elbow", "left_elbow", further flexion, rad.
    """

    channel: str
    target: float
    start_s: float
    length_s: float


FIDGETS = (
    *("shift", "lean", "pitch", "yaw", "right_shoulder", "left_shoulder", "right_elbow"),
    "left_elbow",
)
# What `IdleState` has but for the breath.
SWAYING = ("lean", "roll", "legs_roll", "pitch", "yaw", "shoulders", "elbows")


@dataclass(frozen=True)
class IdleState:
    """The body's own movements at times t [M] (s), worked out as they are asked for."""

    idle: "Idle"
    t: Float

    @cached_property
    def _fidgets(self) -> dict[str, Float]:
        """Values of the fidgets [M] by channel."""
        course = self.idle.course
        return dict(zip(course.channels, course(self.t), strict=True))

    @cached_property
    def lean(self) -> Float:
        """Lean of legs and trunk ahead [M], rad."""
        height = CENTRE_OF_MASS * self.idle.person.stature
        lean: Float = np.arcsin(self.idle.sway.ahead(self.t) / height) + self._fidgets["lean"]
        return lean

    @cached_property
    def roll(self) -> Float:
        """Lean of legs and trunk to the left [M], rad."""
        person = self.idle.person
        height = CENTRE_OF_MASS * person.stature - person.ankle
        roll: Float = np.arcsin(self.idle.sway.aside(self.t) / height)
        return roll

    @cached_property
    def legs_roll(self) -> Float:
        """Lean of the legs to the left [M], rad: sway and shifted weight."""
        person = self.idle.person
        shift = np.arcsin(self._fidgets["shift"] / (person.rest_height - person.ankle))
        roll: Float = self.roll + shift
        return roll

    @cached_property
    def pitch(self) -> Float:
        """Pitch of the trunk ahead [M], rad: lean and fidgets."""
        return self.lean + self._fidgets["pitch"]

    @cached_property
    def yaw(self) -> Float:
        """Turn of the trunk to the left [M], rad."""
        return self._fidgets["yaw"]

    @cached_property
    def shoulders(self) -> Float:
        """Further flexion of the right and left shoulder [2, M], rad."""
        return np.array([self._fidgets["right_shoulder"], self._fidgets["left_shoulder"]])

    @cached_property
    def elbows(self) -> Float:
        """Further flexion of the right and left elbow [2, M], rad."""
        return np.array([self._fidgets["right_elbow"], self._fidgets["left_elbow"]])

    @property
    def breath(self) -> Float:
        """Displacement of the torso ahead [M], m."""
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
        """Course of the fidgets: each goes on from where the last of its channel ended.

        Raises:
            ValueError: A channel is unknown, or an elbow would bend backwards.
        """
        level = dict.fromkeys(FIDGETS, 0.0)
        steps = []
        for channel, target, start_s, length_s in sorted(
            self.fidgets, key=lambda fidget: fidget.start_s
        ):
            if channel not in level:
                raise ValueError(f"people do not fidget with {channel!r}, but with {FIDGETS}")
            if channel.endswith("elbow") and target < -self.person.elbow:
                raise ValueError(f"no elbow bends backwards, by {-target:g} rad from its rest")
            steps.append(Step(channel, target - level[channel], start_s, length_s))
            level[channel] = target
        return Course.of(dict.fromkeys(FIDGETS, 0.0), steps)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return self.course.breakpoints

    def __call__(self, t: Float) -> IdleState:
        """State of the body at times t [M] (s)."""
        return IdleState(self, t)


def motionless(person: Physique) -> Idle:
    """Movements of a body that neither sways nor breathes: none."""
    return Idle(person, NO_SWAY, NO_BREATH)
