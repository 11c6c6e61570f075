"""S1: people who stand; all that moves are they themselves (idle.py)."""

from dataclasses import dataclass
from math import inf

from radhar_cli.motion.human.minimum_jerk import Course
from radhar_cli.motion.human.part import Phase
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import Planted, resting_channels
from radhar_cli.motion.movements.kind import MovementKind, Mover


@dataclass(frozen=True)
class Stand:
    """Stands for `duration` s."""

    duration: float = inf

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        course = Course.of(resting_channels(person), ())
        return Planted(person, course, begin, begin + self.duration, (Phase(begin, "standing"),))


# The class of recordings in which nobody is. Its radar sees the room alone; who would stand there
# says how strong the noise of an `snr_db` is, and which ranges a gate follows.
NOBODY = "nobody"


def make_standing(mover: Mover) -> Stand:
    """Make a person stand still."""
    return Stand(mover.duration)


MOVEMENTS = (
    MovementKind(
        "stationary",
        "stands still, with the sway and the breath of people",
        make_standing,
        in_place=True,
        rests=True,
        words="standing still standing_still stand idle static no_movement no_activity breathing "
        "stehen",
        manners="still quietly",
    ),
    MovementKind(
        NOBODY,
        "nobody is there: noise, and what stands in the room",
        make_standing,
        "nowhere",
        "nowhere",
        like="stationary",
        in_place=True,
        words="empty empty_room no_one no_person absent background leer absence nobody_there "
        "no_presence",
    ),
)
