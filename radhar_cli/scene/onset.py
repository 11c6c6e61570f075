"""Onset of the movements of a person (`timing.onset`), and times that follow from it."""

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

from radhar_cli.config.sequence import SequenceStep
from radhar_cli.motion.activities.onset import (
    Onsets,
    Stretch,
    limits_of_movement,
    limits_of_rise,
    limits_of_sequence,
    limits_of_stop,
)
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.scene.scene import Person

TRIP_S = 1.5  # duration of a trip within its walk
LONGEST_S = 5.0  # of a walk, half way of which people trip


class Bout(NamedTuple):
    """Time during which a lasting movement is under way.

    Attributes:
        begin: its beginning, s; 0 where it is under way at 0 s.
        end: its end, s; inf where it goes on after the recording.
        from_rest: whether people rest before.
    """

    begin: float
    end: float
    from_rest: bool


def onset_at(person: Person, limits: Onsets) -> float:
    """Onset (s) within some limits that `timing.onset` chooses."""
    return limits.at_share(person.timing.onset)


def bout_onset(person: Person) -> float:
    """Compute the onset of a bout as long as the recording, s; below 0, the bout ends within it."""
    seconds = person.seconds
    return onset_at(person, limits_of_movement(seconds, seconds, person.timing.visible))


def bout_of(person: Person) -> Bout:
    """Return the bout of an activity without an end, steady where it is under way at 0 s."""
    onset = bout_onset(person)
    if onset > 0:
        return Bout(onset, inf, True)
    return Bout(0.0, inf if onset == 0 else person.seconds + onset, False)


def movement_onset(person: Person, duration: float) -> float:
    """Compute the onset of a single movement of `duration` s, s."""
    return onset_at(person, limits_of_movement(duration, person.seconds, person.timing.visible))


def rise_onset(person: Person, duration: float) -> float:
    """Compute the beginning of a rise of `duration` s before a walk, s."""
    if person.timing.walk_start_s is not None:
        return float(person.timing.walk_start_s - duration)
    limits = limits_of_rise(duration, person.seconds, person.timing.visible)
    return onset_at(person, limits) - duration


def stop_onset(person: Person, duration: float) -> float:
    """Compute the beginning of a movement of `duration` s after a walk, s."""
    return onset_at(person, limits_of_stop(duration, person.seconds, person.timing.visible))


def sequence_onset(person: Person, steps: Sequence[SequenceStep], motion: HumanMotion) -> float:
    """Compute the onset of the sequence of a person's class, s."""
    parts = list[Stretch]()
    for step, (part, _) in zip(steps, motion.parts, strict=False):
        kind = MOVEMENTS[step.name]
        parts.append(Stretch(part.begin, part.end, kind.seconds is None, not kind.rests))
        if step.name == "tripping":
            trips = part.begin + min(part.end - part.begin, LONGEST_S) / 2
            parts.append(Stretch(trips, trips + TRIP_S))
    return onset_at(person, limits_of_sequence(parts, person.seconds, person.timing.visible))
