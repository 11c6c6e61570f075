"""A person's motion: parts one after the other, in the room's frame."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import cos, inf, sin

import numpy as np

from radhar_cli.motion import skeleton
from radhar_cli.motion.human.idle import Idle
from radhar_cli.motion.human.part import (
    LYING,
    SEATED,
    STANDING,
    Movement,
    Part,
    Phase,
    Place,
    kind_of_rest,
    place_after,
)
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import Planted
from radhar_cli.motion.human.pose import Pose, feet
from radhar_cli.motion.movements.lying import Lying
from radhar_cli.motion.movements.transfer import Transfer
from radhar_cli.motion.movements.walking import Walking
from radhar_cli.motion.skeleton import JOINTS, PARENTS
from radhar_cli.numerics.arrays import Float, Index

HIPS, TOES = ("right_hip", "left_hip"), ("right_toes", "left_toes")
KNOWS_TOES = (Lying, Transfer)  # parts that say where the toes are
USUAL_HZ = 3.0  # frequency that a movement counts as which has no `fastest_hz`
BLOCK = 4096  # instants at once: what a block needs stays in the cache


@dataclass(frozen=True)
class HumanMotion:
    """A `Motion` of a person who makes one movement after another."""

    person: Physique
    # movements in their order; each begins when the one before has come to rest
    movements: tuple[Movement, ...]
    # x and y of the floor point between the ankles of the first stance, m
    start: tuple[float, float]
    # to where the person faces at first, rad from the x axis; 0 is away from the radar
    heading: float
    begin: float  # when the first movement begins, s
    horizon: float  # end of the recording, s; at least 2 strides of a walk are worked out beyond
    idle: Idle  # sway, breath and fidgets
    # time at rest before each movement, s; those that are not given are 0. Below 0 the movement
    # overlaps the one before: a walk and a movement on planted feet
    pauses: tuple[float, ...] = ()
    # when that begins which the class is named by, s: a movement, or a bout of what lasts; of two
    # movements the second
    onset: float | None = None

    names = JOINTS
    parents = PARENTS

    @cached_property
    def landmarks(self) -> tuple[str, ...]:
        """Names of joints and hip joints, and of the toes of a lying person."""
        toes = any(isinstance(part, KNOWS_TOES) for part, _ in self.parts)
        return (*JOINTS, *HIPS, *(TOES if toes else ()))

    @property
    def highest_frequency(self) -> float:
        """Frequency that the fastest movement counts as, Hz: highest for kicks, runs and hands."""
        return max(
            (getattr(one, "fastest_hz", USUAL_HZ) for one in self.movements), default=USUAL_HZ
        )

    @cached_property
    def parts(self) -> tuple[tuple[Part, Place], ...]:
        """Each part, and where it begins in the room.

        Raises:
            ValueError: A movement begins in another state than the one before it ends in.
        """
        begin, place = self.begin, Place(*self.start, self.heading)
        parts: list[tuple[Part, Place]] = []
        pauses = (*self.pauses, *[0.0] * len(self.movements))
        for movement, pause in zip(self.movements, pauses, strict=False):
            start = begin + pause
            if pause < 0:  # it begins with the last movement at the earliest
                start = max(start, parts[-1][0].begin)
            part = movement.part(self.person, start, self.horizon)
            if pause < 0:
                parts[-1], part = _join_overlapping(parts[-1], part)
            if parts and parts[-1][0].after != part.before:
                raise ValueError(
                    f"{type(movement).__name__} begins {part.before}, but the movement before "
                    f"ends {parts[-1][0].after}"
                )
            parts.append((part, place))
            if part.end == inf:
                break
            begin, place = part.end, place_after(place, part.place)
        return tuple(parts)

    def moved_to(self, start: tuple[float, float]) -> "HumanMotion":
        """Return this motion from another start (x and y, m), with the parts that it has."""
        ahead, left = (to - of for to, of in zip(start, self.start, strict=True))
        moved = replace(self, start=start)
        moved.__dict__["parts"] = tuple(
            (part, place._replace(ahead=place.ahead + ahead, left=place.left + left))
            for part, place in self.parts
        )
        return moved

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Instants (s) at which a position is not smooth, sorted."""
        ends = set(self.idle.breakpoints)
        for part, _ in self.parts:
            ends.update(part.breakpoints)
        return tuple(sorted(ends))

    @property
    def phases(self) -> tuple[Phase, ...]:
        """Names of what is under way, and from when on; first the state before any movement."""
        parts = [part for part, _ in self.parts]
        ends = [part.begin for part in parts[1:]] + [inf]
        state = kind_of_rest(parts[0].before)
        return (
            Phase(-inf, state if state in (STANDING, SEATED, LYING) else parts[0].phases[0].name),
            *(
                phase
                for part, end in zip(parts, ends, strict=True)
                for phase in part.phases
                if phase.start < end
            ),
        )

    def positions(self, t: Float) -> Float:
        """Positions [3, 13, M] (m) of the joints at times t [M] (s)."""
        return self._gather(t, len(JOINTS), lambda pose, p: pose.joints(self.person, p))

    def landmark_positions(self, t: Float) -> Float:
        """Positions [3, len(landmarks), M] (m) of the joints, then of hip joints and toes."""
        toes = self.landmarks[-len(TOES) :] == TOES

        def fill(pose: Pose, p: Float) -> None:
            pose.joints(self.person, p)
            p[:, len(JOINTS) : len(JOINTS) + len(HIPS)] = pose.hip_joints
            if toes:
                p[:, -len(TOES) :] = pose.ankles + self.person.toes * (
                    feet(self.person, pose) if pose.toes is None else pose.toes
                )

        return self._gather(t, len(self.landmarks), fill)

    def torso(self, t: Float) -> Float:
        """Positions [3, 1, M] (m) of the torso alone at times t [M] (s)."""
        return self._gather(t, 1, lambda pose, p: pose.torso(self.person, p[:, 0]))

    def cross_sections(self, t: Float) -> Float:
        """RCS of the joints [13, 1] (m^2): the same from everywhere, at all times."""
        height, weight = self.person.stature, self.person.weight
        weight = skeleton.default_weight(height) if weight is None else weight
        return skeleton.cross_sections(height, weight)[:, None]

    def hip_joints(self, t: Float) -> Float:
        """Positions [3, 2, M] (m) of the right and left hip joint, where the thighs begin."""
        return self._gather(t, 2, lambda pose, p: np.copyto(p, pose.hip_joints))

    def _gather(self, t: Float, count: int, fill: Callable[[Pose, Float], None]) -> Float:
        """Points [3, count, M] in the room, filled in by `fill(pose, points)` part by part."""
        p = np.empty((3, count, t.size))
        part_of = np.searchsorted(self._begins, t, side="right")
        for first in range(0, t.size, BLOCK):
            block = slice(first, first + BLOCK)
            part_numbers = part_of[block]
            for number in range(part_numbers.min(), part_numbers.max() + 1):
                is_under_way = part_numbers == number
                if is_under_way.all():
                    self._fill(self.parts[number], t[block], p[..., block], fill)
                elif is_under_way.any():
                    columns = np.flatnonzero(is_under_way)
                    points = np.empty((3, count, columns.size))
                    self._fill(self.parts[number], t[block][columns], points, fill)
                    _copy_into_columns(p[..., block], columns, points)
        return p

    @cached_property
    def _begins(self) -> list[float]:
        """Times at which parts but the first take over, s; a part planted by a walk, at its end."""
        pairs = pairwise(part for part, _ in self.parts)
        return [
            last.end if isinstance(last, Walking) and last.planted[-1:] == (part,) else part.begin
            for last, part in pairs
        ]

    def _fill(
        self, placed: tuple[Part, Place], t: Float, p: Float, fill: Callable[[Pose, Float], None]
    ) -> None:
        """Fill in the points p [3, ..., M] of one part, turned and moved to where it begins."""
        part, place = placed
        fill(part.pose(t, self.idle(t)), p)
        x, y = p[0], p[1]
        if place.turn:
            c, s = cos(place.turn), sin(place.turn)
            across = s * x
            x *= c
            x -= s * y
            y *= c
            y += across
        x += place.ahead
        y += place.left


def _copy_into_columns(p: Float, columns: Index, points: Float) -> None:
    """Copy points [3, I, N] into the rising columns [N] of p [3, I, M].

    Runs of adjacent columns are copied as slices, which takes less time than an index does.
    """
    gaps = np.flatnonzero(np.diff(columns) > 1) + 1
    for run in np.split(np.arange(columns.size), gaps):
        start = columns[run[0]]
        p[..., start : start + run.size] = points[..., run[0] : run[-1] + 1]


def _join_overlapping(before: tuple[Part, Place], part: Part) -> tuple[tuple[Part, Place], Part]:
    """Make a part and the one that begins before it ends aware of each other; one is a walk."""
    last, place = before
    if part.begin >= last.begin:
        if isinstance(part, Walking) and isinstance(last, Planted):
            return before, replace(part, planted=(last,))
        if isinstance(last, Walking) and isinstance(part, Planted):
            return (replace(last, planted=(*last.planted, part)), place), part
    raise ValueError(
        "only a walk and a movement on planted feet overlap, by less than the first lasts"
    )
