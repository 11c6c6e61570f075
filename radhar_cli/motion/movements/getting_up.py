"""Movements after a fall: getting up, as in the first half of S11, or trying to.

From prone or hands and knees over the knees; from the back or the buttocks by sitting up, drawing
the feet in and rising from a squat, as young people do most often (VanSant, Phys. Ther. 68 (1988)
185). Young people take 3 to 4 s, those of 50 to 90 years 4.1 +- 1.1 s (Bohannon and Lusardi, 2004);
of 66 people over 90 who fell 80 % could not get up at least once (Fleming and Brayne, BMJ 337
(2008) a2227).
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import radians, sin

from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import LYING, STANDING, Phase
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import (
    ELBOWS,
    SHOULDERS,
    Planted,
    resting_channels,
    scale_steps,
    steps_of_both_sides,
)
from radhar_cli.motion.movements.falling import (
    AGAINST_SEAT,
    ON_FLOOR,
    ON_FOURS,
    PRONE,
    PROPPED,
    SUPINE,
    OnFours,
    Prone,
    Sitting,
    Supine,
)
from radhar_cli.motion.movements.kind import MovementKind
from radhar_cli.motion.movements.words import ON_FLOOR as FLOOR

LYING_POSTURES: dict[str, Callable[[Physique], dict[str, float]]] = {
    PRONE: Prone().posture,
    ON_FOURS: OnFours().posture,
    SUPINE: Supine().posture,
    ON_FLOOR: AGAINST_SEAT.posture,
    PROPPED: Sitting().posture,
}
ON_BELLY = (PRONE, ON_FOURS)
DRAWN_IN = 0.32  # share of getting up in which the hands of who lies on the belly come to the chest


def hands_beside_chest(
    person: Physique, lying: dict[str, float], place: tuple[float, float]
) -> tuple[float, float]:
    """Distances of hands ahead of the ankles and beside the middle, m, before they push.

    Args:
        person: Person on the belly.
        lying: Channels of `planted.posture` of that.
        place: Place of the hands behind and outside the shoulders, over the stature.
    """
    shoulders = person.leg * (sin(lying["shank"]) + sin(lying["thigh"]))
    shoulders += (person.trunk + person.shoulder) * sin(lying["trunk"])
    behind, outside = (distance * person.stature for distance in place)
    return shoulders - behind, person.shoulder + outside


def _lying_posture(person: Physique, before: str) -> dict[str, float]:
    """Channels of people who lie or sit on the floor, seen from where their feet are."""
    if before not in LYING_POSTURES:
        raise ValueError(f"getting up begins {' or '.join(LYING_POSTURES)}, not {before}")
    lying = LYING_POSTURES[before](person)
    lying["hands_ahead"] -= lying["feet"]
    return lying | {"feet": 0.0}


@dataclass(frozen=True)
class GetUp:
    """Gets up from the floor to standing within `duration` s; angles in rad."""

    duration: float = 3.0
    before: str = PRONE  # state in which the person lies
    # where the hands push, fractions of the stature: of who is on hands and knees, ahead of the
    # ankles; of who lies on the belly, behind and outside the shoulders; in the crouch that follows
    hands: float = 0.57
    beside_chest: tuple[float, float] = (0.14, 0.05)
    crouched: float = 0.45
    on_knees: float = radians(84)  # pitch of the trunk on hands and knees
    # shank, thigh, trunk: angles in that crouch
    shank: float = radians(38)
    thigh: float = radians(-70)
    trunk: float = radians(50)
    # angles of shank, thigh and trunk sitting, feet drawn in; of the thigh in the squat after it
    sitting: tuple[float, float, float] = (radians(4), radians(-155), radians(12))
    squat: float = radians(-112)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        lying = _lying_posture(person, self.before)
        rest = resting_channels(person)
        steps_of = self.over_knees if self.before in ON_BELLY else self._over_squat
        steps = [*steps_of(person, lying, rest), *standing_up_steps(lying)]
        course = Course.of(lying, scale_steps(steps, begin, self.duration))
        end = begin + self.duration
        phases = (Phase(begin, "getting up"), Phase(end, "standing"))
        return Planted(person, course, begin, end, phases, self.before, STANDING)

    def over_knees(
        self, person: Physique, lying: dict[str, float], rest: dict[str, float]
    ) -> list[Step]:
        """Steps from lying on the belly, over hands and knees, to standing."""
        ahead, beside = self.hands * person.stature, person.shoulder
        if lying["splayed"]:
            ahead, beside = hands_beside_chest(person, lying, self.beside_chest)
        return [
            Step("shank", self.shank - lying["shank"], 0.28, 0.34),
            Step("shank", rest["shank"] - self.shank, 0.56, 0.44),
            Step("thigh", self.thigh - lying["thigh"], 0.10, 0.52),
            Step("thigh", rest["thigh"] - self.thigh, 0.55, 0.45),
            Step("trunk", self.on_knees - lying["trunk"], 0.10, 0.30),
            Step("trunk", self.trunk - self.on_knees, 0.34, 0.28),
            Step("trunk", rest["trunk"] - self.trunk, 0.56, 0.44),
            Step("hands_ahead", ahead - lying["hands_ahead"], 0.0, DRAWN_IN),
            Step("hands_beside", beside - lying["hands_beside"], 0.0, DRAWN_IN),
            Step("splayed", -lying["splayed"], 0.0, DRAWN_IN),
            Step("hands_ahead", self.crouched * person.stature - ahead, 0.38, 0.30),
            Step("hands", -1.0, 0.48, 0.42),
        ]

    def _over_squat(
        self, person: Physique, lying: dict[str, float], rest: dict[str, float]
    ) -> list[Step]:
        """Steps from lying on the back or sitting, over a squat, to standing."""
        shank, thigh, trunk = self.sitting
        ahead = sin(lying["shank"]) + sin(lying["thigh"]) - sin(shank) - sin(thigh)
        steps = [
            Step("feet", person.leg * ahead, 0.10, 0.34),
            Step("shank", shank - lying["shank"], 0.10, 0.34),
            Step("shank", self.shank - shank, 0.40, 0.28),
            Step("shank", rest["shank"] - self.shank, 0.58, 0.42),
            Step("thigh", thigh - lying["thigh"], 0.10, 0.34),
            Step("thigh", self.squat - thigh, 0.42, 0.24),
            Step("thigh", rest["thigh"] - self.squat, 0.58, 0.42),
            Step("trunk", trunk - lying["trunk"], 0.0, 0.42),
            Step("trunk", self.trunk - trunk, 0.34, 0.28),
            Step("trunk", rest["trunk"] - self.trunk, 0.60, 0.40),
            *steps_of_both_sides(SHOULDERS, radians(90), 0.05, 0.4),
            *steps_of_both_sides(
                SHOULDERS, rest["right_shoulder"] - lying["right_shoulder"], 0.5, 0.45
            ),
            *steps_of_both_sides(SHOULDERS, -radians(90), 0.58, 0.42),
            *steps_of_both_sides(ELBOWS, rest["right_elbow"] - lying["right_elbow"], 0.3, 0.5),
        ]
        if lying["hands"]:
            steps.append(Step("hands", -1.0, 0.05, 0.50))
        return steps


def standing_up_steps(lying: dict[str, float]) -> list[Step]:
    """Steps in which the body begins to sway as it stands up, in units of the duration."""
    return [Step("standing", 1.0, 0.5, 0.5), Step("upright", 1.0 - lying["upright"], 0.2, 0.8)]


# How far people get who try to get up, by state: {channel: rad}.
TRIES = {
    PRONE: {"trunk": radians(-22), "thigh": radians(-38)},
    ON_FOURS: {"trunk": radians(-16), "thigh": radians(-22)},
    SUPINE: {"trunk": radians(46), "right_shoulder": radians(25), "left_shoulder": radians(25)},
    ON_FLOOR: {"trunk": radians(42), "thigh": radians(12), "shank": radians(6)},
    PROPPED: {"trunk": radians(50), "thigh": radians(10), "shank": radians(6)},
}


@dataclass(frozen=True)
class TryToGetUp:
    """Gets part of the way up within `duration` s, and sinks back."""

    duration: float = 3.0
    before: str = PRONE  # state in which the person lies
    dwell: float = 0.12  # dwell at the highest point, share of the duration

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        lying = _lying_posture(person, self.before)
        up = 0.55 - self.dwell / 2
        steps = []
        for number, (channel, angle) in enumerate(TRIES[self.before].items()):
            delay = 0.06 * number
            steps.append(Step(channel, angle, delay, up - delay))
            steps.append(Step(channel, -angle, up + self.dwell, 1 - up - self.dwell))
        if self.before == PRONE:
            ahead, beside = hands_beside_chest(person, lying, GetUp.beside_chest)
            drawn = {"hands_ahead": ahead, "hands_beside": beside, "splayed": 0.0}
            for channel, place in drawn.items():
                by = place - lying[channel]
                steps.append(Step(channel, by, 0.0, DRAWN_IN))
                steps.append(Step(channel, -by, 1 - DRAWN_IN, DRAWN_IN))
        course = Course.of(lying, scale_steps(steps, begin, self.duration))
        end = begin + self.duration
        phases = (Phase(begin, "getting up"), Phase(end, "lying"))
        return Planted(person, course, begin, end, phases, self.before, self.before)


MOVEMENTS = (
    MovementKind(
        "trying_to_get_up",
        "lies and tries in vain to get up",
        lambda mover: TryToGetUp(mover.duration),
        LYING,
        LYING,
        3.0,
    ),
    MovementKind(
        "getting_up",
        "gets up from the floor",
        lambda mover: GetUp(duration=mover.duration),
        LYING,
        STANDING,
        3.0,
        also=(("kneeling", STANDING), ("on_fours", STANDING)),
        words="stand_up_from_floor get_up rising_from_floor getting_up_from_floor "
        "get_up_from_floor",
        manners=f"{FLOOR} from_lying",
        nearby="lie_to_stand",
    ),
)
