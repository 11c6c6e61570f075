"""Movements on the floor and in bed, which begin as the movement before them ends."""

from collections.abc import Sequence
from dataclasses import replace

from radhar_cli.motion.human.part import Movement
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.movements.crawling import Crawl
from radhar_cli.motion.movements.falling_sideways import FallingSideways, RiseFromSide
from radhar_cli.motion.movements.getting_up import GetUp, TryToGetUp
from radhar_cli.motion.movements.kneeling import GetDown, Kneel, RiseFromKnees
from radhar_cli.motion.movements.lying import Lie, TurnOver
from radhar_cli.motion.movements.transfer import GoToBed, LeaveBed, LieStill, RiseFromRest, Settle

Lies = Lie | TurnOver | GoToBed
SOMEBODY = Physique(1.7)  # states and rolls are the same of every stature


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
    """Movement of a person who lies as at the end of the last one."""
    rest = last.after if isinstance(last, TurnOver) else last.rest
    if isinstance(movement, Lie | TurnOver):
        return replace(movement, rest=rest, head=0.0)
    if isinstance(movement, LeaveBed):
        return replace(movement, rest=rest)
    if isinstance(movement, GetUp | TryToGetUp):
        return RiseFromRest(rest, movement)
    return movement
