"""Lying, kneeling and beds of people in a scene: how each begins where the movement before ends."""

from collections.abc import Sequence
from dataclasses import replace
from math import radians

import numpy as np

from radhar_cli.activities.activity import first_states
from radhar_cli.config.sequence import SequenceConfig
from radhar_cli.motion.human.crawling import Crawl
from radhar_cli.motion.human.falling_sideways import FallingSideways, RiseFromSide
from radhar_cli.motion.human.getting_up import GetUp, TryToGetUp
from radhar_cli.motion.human.kneeling import GetDown, Kneel, RiseFromKnees
from radhar_cli.motion.human.lying import Lie, Rest, TurnOver
from radhar_cli.motion.human.motion import Movement
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.repertoire import FloorMovements
from radhar_cli.motion.human.sitting import Rise
from radhar_cli.motion.human.transfer import GoToBed, LeaveBed, LieStill, RiseFromRest, Settle
from radhar_cli.scene import Person

IN_BED = "in_bed"
Lies = Lie | TurnOver | GoToBed
MISSES = 397  # how many footholds of who crawls are drawn, before they come again
SOMEBODY = Physique(1.7)  # states and rolls are the same of every stature


def draw_floor_movements(
    person: Person, duration: float | None, rise: Rise, place: int
) -> FloorMovements:
    """How this person kneels, lies, and goes to bed.

    Args:
        person: Person of the scene.
        duration: Duration of a movement that has one, s; None for the usual one.
        rise: How the person stands up.
        place: Place of the movement in its sequence, which names its random streams.
    """
    lying = person.motion.lying
    in_bed = Rest(radians(lying.roll_deg), lying.bed_height, lying.hands, bed=True)
    rest = in_bed if _begins_in_bed(person) else replace(in_bed, surface=0.0, bed=False)
    side = 1.0 if person.stream("motion.lying/side").random() < 0.5 else -1.0
    times = {} if duration is None else {"duration": duration}
    head, kneel = radians(lying.head_deg), Kneel(person.motion.kneeling.sit_back)
    return FloorMovements(
        _crawl(person, place),
        kneel,
        GetDown(kneel, **times),
        GetDown(None, **times),
        Lie(rest, head=head),
        TurnOver(rest, radians(lying.turn_deg), head=head, **times),
        GoToBed(in_bed, side, rise=rise, **times),
        LeaveBed(in_bed, side, rise=rise, **times),
    )


def _crawl(person: Person, place: int) -> Crawl:
    """How this person crawls at some place in a sequence."""
    crawling = person.motion.crawling
    misses = person.stream(f"motion.crawling.variation/{place}").standard_normal(MISSES)
    misses = crawling.variation * np.clip(misses, -1.6, 1.6)
    return Crawl(
        crawling.speed_mps,
        stride=crawling.stride,
        misses=tuple(misses.tolist()) if crawling.variation else (),
    )


def _begins_in_bed(person: Person) -> bool:
    """Whether who lies at first lies in bed: as the config has it, unless the sequence needs it."""
    section = person.config.classes.get(person.activity.slug)
    if isinstance(section, SequenceConfig):
        firsts = first_states([step.name for step in section.steps()])
        if len(firsts) == 1:
            return firsts == (IN_BED,)
    return bool(person.motion.lying.bed > 0.5)


def join_on_floor(before: Sequence[Movement], movement: Movement) -> Movement:
    """Movement that begins as the last one before it ends, where that is on the floor or in bed."""
    if not before:
        return movement
    last = before[-1]
    if isinstance(movement, GetUp) and isinstance(last, Kneel | GetDown | Crawl):
        kneel = last.kneel if isinstance(last, GetDown) else last
        kneel = kneel if isinstance(kneel, Kneel) else None
        return RiseFromKnees(kneel, movement.duration)
    if isinstance(last, Lies):
        return _after_lying(last, movement)
    if isinstance(last, Settle):
        return _after_lying(Lie(last.rest(SOMEBODY)), movement)
    fall: Movement = last.fall if isinstance(last, LieStill) else last
    if isinstance(movement, Lie):
        return LieStill(fall, movement.duration)
    if isinstance(movement, TurnOver):
        return Settle(fall, movement.by, movement.rest.hands, movement.duration)
    if isinstance(movement, GetUp | TryToGetUp):
        part = fall.part(SOMEBODY, 0.0, 0.0)
        if isinstance(part, FallingSideways):
            tries = isinstance(movement, TryToGetUp)
            return RiseFromSide(part.fall, movement.duration, tries)
        return replace(movement, before=part.after)
    return movement


def _after_lying(last: Lies, movement: Movement) -> Movement:
    """Movement of who lies as at the end of the last one."""
    rest = last.after if isinstance(last, TurnOver) else last.rest
    if isinstance(movement, Lie | TurnOver):
        return replace(movement, rest=rest, head=0.0)
    if isinstance(movement, LeaveBed):
        return replace(movement, rest=rest)
    if isinstance(movement, GetUp | TryToGetUp):
        return RiseFromRest(rest, movement)
    return movement
