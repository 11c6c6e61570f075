"""A person of a stream: one activity after the other, within a zone of the floor.

Where people walk and whither they turn is planned bout by bout: of headings in a random order, and
walks with and without half turns, the first is taken in which the torso stays in the zone.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import cos, inf, pi, radians, sin
from typing import NamedTuple

import numpy as np

from radhar_cli.config.sequence import SequenceConfig, SequenceStep
from radhar_cli.config.stream import LEAD_S, TRANSITION, TURN, ZoneConfig
from radhar_cli.motion.human.idle import NO_SWAY, Idle
from radhar_cli.motion.human.lane import Lane
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.human.part import STANDING, Movement, Place, place_after
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.turning_around import make_turn
from radhar_cli.motion.movements.walking import Gait
from radhar_cli.scene.people import idle_of_stream, movement_of
from radhar_cli.scene.scene import Person

HEADINGS = 16  # that are tried for a bout
SMALLEST_TURN = radians(20)
CHECK_S = 0.25  # time between instants at which the torso is looked at
ARC = 1.3  # way ahead that a half turn takes, over its radius
LEAST_STRAIGHT_M = 0.3
SHORTER, SHORTENINGS = 0.6, 6  # factor of a bout that does not fit, and how often it is applied
LEAST_BOUT_S, LEAST_TURN_S = 1.0, 0.8


@dataclass(frozen=True)
class StreamMotion(HumanMotion):
    """A person of a stream; each movement has the label of its bout, or TRANSITION."""

    labels: tuple[str, ...] = ()


class Situation(NamedTuple):
    """Place and time at which a bout may begin."""

    place: Place
    time: float  # s


class PlannedBout(NamedTuple):
    """A turn and movements after it, and what comes of them."""

    turn: float  # rad; 0 for none
    movements: tuple[Movement, ...]
    end: Situation
    outside: float  # how far the torso leaves the zone, m


def stream_motion(person: Person) -> StreamMotion:
    """Motion of a person of a stream."""
    motion = person.motion
    physique = Physique(person.subject.height_m, weight=person.subject.weight_kg)
    place = Place(motion.range_m, motion.cross_range_m, radians(motion.angle_deg))
    begin = -LEAD_S * float(person.stream("stream/lead").random())
    planner = _Planner(person, physique, zone_of(person))
    movements, pauses, labels = planner.plan(Situation(place, begin))
    return StreamMotion(
        person=physique,
        movements=movements,
        start=(motion.range_m, motion.cross_range_m),
        heading=place.turn,
        begin=begin,
        horizon=person.seconds,
        idle=idle_of_stream(person, physique, movements),
        pauses=pauses,
        labels=labels,
    )


def zone_of(person: Person) -> ZoneConfig:
    """Zone of a person: a strip of the stream's, where there are several."""
    stream = person.config.stream
    assert stream is not None
    return stream.zone.strips(1 + len(person.config.people))[0]


@dataclass
class _Planner:
    """Plans the movements of a person one bout after the other."""

    person: Person
    physique: Physique
    zone: ZoneConfig

    def plan(
        self, situation: Situation
    ) -> tuple[tuple[Movement, ...], tuple[float, ...], tuple[str, ...]]:
        """Movements, the pause before each (s), and their labels."""
        section = self.person.own_class
        assert isinstance(section, SequenceConfig)
        movements, pauses, labels = list[Movement](), list[float](), list[str]()
        turns, pause = False, 0.0
        for steps in _bouts(section):
            if situation.time > self.person.seconds + 2:
                break
            pause += steps[0].pause
            if steps[0].name == TURN and steps[0].label == TRANSITION:
                turns = True
                continue
            situation = situation._replace(time=situation.time + pause)
            bout = self._plan_bout(steps, situation, turns, movements)
            if bout.turn:
                movements.append(make_turn(bout.turn))
                pauses.append(pause)
                labels.append(TRANSITION)
                pause = 0.0
            movements += bout.movements
            pauses += [pause, *(step.pause for step in steps[1:])]
            labels += [step.label for step in steps]
            situation, turns, pause = bout.end, False, 0.0
        return tuple(movements), tuple(pauses), tuple(labels)

    def _plan_bout(
        self,
        steps: list[SequenceStep],
        situation: Situation,
        turns: bool,
        previous: list[Movement],
    ) -> PlannedBout:
        """Choose heading and lanes of a bout, so that the torso stays in the zone if it can."""
        movements = list[Movement]()
        for step in steps:
            movements.append(movement_of(self.person, step, [*previous, *movements]))
        best: PlannedBout | None = None
        for shortening in range(SHORTENINGS):
            if shortening:
                movements = [_shorten(movement) for movement in movements]
            for turn, side in self._options(steps[0], turns):
                bout = self._try(tuple(movements), steps, situation, turn, side)
                if best is None or bout.outside < best.outside:
                    best = bout
                if best.outside <= 0:
                    return best
        assert best is not None
        return best

    def _options(self, first: SequenceStep, turns: bool) -> Iterator[tuple[float, float]]:
        """Turns, rad, and sides of half turns, in the order in which they are tried."""
        rng = self.person.stream(f"stream/heading/{first.place}")
        angles = rng.uniform(SMALLEST_TURN, 2 * pi - SMALLEST_TURN, HEADINGS)
        angles = np.where(angles > pi, angles - 2 * pi, angles)
        sides = (1.0, -1.0) if rng.random() < 0.5 else (-1.0, 1.0)
        can_turn = MOVEMENTS[first.name].before == STANDING and first.label != TRANSITION
        as_is = () if turns and can_turn else (0.0,)
        for angle in (*as_is, *(angles.tolist() if can_turn else ())):
            for side in sides:
                yield angle, side

    def _try(
        self,
        movements: tuple[Movement, ...],
        steps: list[SequenceStep],
        situation: Situation,
        turn: float,
        side: float,
    ) -> PlannedBout:
        """Find out where a bout leads."""
        place, time = situation
        if turn:
            place = place._replace(turn=place.turn + turn)
            time += make_turn(turn).part(self.physique, time, time).end - time
        placed, end_place, end = list[Movement](), place, time
        for movement, step in zip(movements, steps, strict=True):
            end += step.pause if placed else 0.0
            placed.append(self._with_lane(movement, end_place, side))
            part = placed[-1].part(self.physique, end, self.person.seconds)
            end_place, end = place_after(end_place, part.place), part.end
        motion = HumanMotion(
            person=self.physique,
            movements=tuple(placed),
            start=(place.ahead, place.left),
            heading=place.turn,
            begin=time,
            horizon=self.person.seconds,
            idle=Idle(self.physique, NO_SWAY),
            pauses=(0.0, *(step.pause for step in steps[1:])),
        )
        outside = self._outside(motion, time, end)
        return PlannedBout(turn, tuple(placed), Situation(end_place, end), outside)

    def _outside(self, motion: HumanMotion, begin: float, end: float) -> float:
        """Compute the torso's distance out of the zone from `begin` to `end` (s), m; 0 inside."""
        end = max(begin, min(end, self.person.seconds)) if end == inf else end
        t = np.append(np.arange(begin, end, CHECK_S), end)
        x, y = motion.torso(t)[:2, 0]
        (near, far), (right, left) = self.zone.range_m, self.zone.cross_range_m
        return float(
            max(0.0, (near - x).max(), (x - far).max(), (right - y).max(), (y - left).max())
        )

    def _with_lane(self, movement: Movement, place: Place, side: float) -> Movement:
        """Walk with half turns before the edges of the zone; other movements as they are."""
        gait = getattr(movement, "gait", None)
        if not isinstance(gait, Gait):
            return movement
        ahead, behind = self._room(place)
        arc = ARC * Lane(1.0).radius * max(1.0, gait.speed / 1.4)
        duration = getattr(movement, "duration", inf)
        if gait.speed * (duration + 1.0) < ahead:
            return _with_gait(movement, replace(gait, lane=None))
        first = max(LEAST_STRAIGHT_M, ahead - arc)
        length = max(LEAST_STRAIGHT_M, ahead + behind - 2 * arc)
        return _with_gait(movement, replace(gait, lane=Lane(length, first, side=side)))

    def _room(self, place: Place) -> tuple[float, float]:
        """Way from a place to the edge of the zone ahead, and behind, m."""
        (near, far), (right, left) = self.zone.range_m, self.zone.cross_range_m
        ahead, behind = inf, inf
        for start, step, low, high in (
            (place.ahead, cos(place.turn), near, far),
            (place.left, sin(place.turn), right, left),
        ):
            if abs(step) > 1e-9:
                reach = sorted(((low - start) / step, (high - start) / step))
                ahead, behind = min(ahead, reach[1]), min(behind, -reach[0])
        return max(0.0, ahead), max(0.0, behind)


def _with_gait(movement: Movement, gait: Gait) -> Movement:
    """Walk with another gait."""
    walk: Movement = replace(movement, gait=gait)  # type: ignore[type-var]
    return walk


def _shorten(movement: Movement) -> Movement:
    """Shorten a movement that may end earlier, such as a run that would leave the zone."""
    duration = getattr(movement, "duration", None)
    if not isinstance(duration, float) or not LEAST_BOUT_S < SHORTER * duration < inf:
        return movement
    shortened: Movement = replace(movement, duration=SHORTER * duration)  # type: ignore[type-var]
    return shortened


def _bouts(section: SequenceConfig[float]) -> Iterator[list[SequenceStep]]:
    """Steps of a stream, those of a bout together: of one class, without a pause."""
    bout = list[SequenceStep]()
    for step in section.steps():
        label = bout[0].label if bout else TRANSITION
        if bout and (step.label != label or label == TRANSITION or step.pause):
            yield bout
            bout = []
        bout.append(step)
    if bout:
        yield bout
