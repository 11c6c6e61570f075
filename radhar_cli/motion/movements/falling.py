"""Falls from standing, off a seat and on rising; `motion.human.falling*` have their courses."""

from dataclasses import replace
from math import radians
from typing import Annotated, ClassVar, Generic, Literal, TypeAlias

from radhar_cli.motion.human.falling import (
    FallBackward,
    FallForward,
    OnFours,
    Prone,
    Sitting,
    Supine,
)
from radhar_cli.motion.human.falling_from_seat import FallFromSeat
from radhar_cli.motion.human.falling_sideways import FallSideways
from radhar_cli.motion.human.part import LYING, SEATED, STANDING
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.sitting import SEAT, make_seat
from radhar_cli.motion.movements.words import OFF_SEATS, ON_FLOOR, join_words
from radhar_cli.schema.annotations import UNSTEADY, People
from radhar_cli.schema.number import ANGLE, Choice, Weighted, uniform
from radhar_cli.schema.section import B, ByActivity, Section, default_draw

FallName = Literal["forward", "backward", "sideways"]


FALLS: tuple[FallName, ...] = FallName.__args__  # type: ignore[attr-defined]


class Falls(Weighted, Section):
    """``{choice: [forward, sideways], weights: [2, 1]}``: one of the directions."""

    NUMBERS: ClassVar[tuple[str, ...]] = ()  # weights are not drawn

    choice: tuple[FallName, ...]

    def at_rank(self, u: float) -> FallName:
        """Direction below which a fraction u of the draws lie, in the order of FALLS."""
        places = tuple(float(FALLS.index(name)) for name in self.choice)
        return FALLS[int(Choice(choice=places, weights=self.weights).quantile(u))]


class FallingConfig(Section, Generic[B]):
    """How people fall, stumble and land."""

    direction: Annotated[FallName | Falls, People(None)] = "forward"
    """Direction of a fall or stumble: forward, backward, sideways, or drawn: {choice: [forward,
    sideways], weights: [2, 1]}."""
    heels_deg: Annotated[B, ByActivity(ANGLE), People("falling", 0, 90), UNSTEADY] = default_draw(
        0.0
    )
    """Angle by which the shanks swing up as people land on their knees in a forward fall."""
    stumble_deg: Annotated[B, ByActivity(ANGLE), People(None, 0, 45)] = default_draw(
        uniform(15.0, 40.0)
    )
    """Angle of the trunk ahead before a stumble is caught; backwards and sideways it is 0.4 of
    that."""


SECTION = FallingConfig
DIRECTION = "falling.direction"
Fall: TypeAlias = FallForward | FallBackward | FallSideways


def fall_direction(mover: Mover) -> FallName:
    """Direction in which a person falls or stumbles."""
    direction = mover.numbers(FallingConfig[float]).direction
    assert not isinstance(direction, Falls)  # drawn with the scene
    return direction


def draw_side(mover: Mover) -> float:
    """Draw the side of a fall: 1 to the left, -1 to the right."""
    return 1.0 if mover.stream("motion.fall/side").random() < 0.5 else -1.0


def make_fall(mover: Mover) -> Fall:
    """Make a person fall from standing."""
    match fall_direction(mover):
        case "forward":
            heels = radians(mover.numbers(FallingConfig[float]).heels_deg)
            return FallForward(mover.duration, Prone(), heels=heels)
        case "backward":
            return FallBackward(mover.duration, supine=Supine())
    return FallSideways(mover.duration, draw_side(mover))


def make_fall_on_hands(mover: Mover) -> Fall:
    """Make a person fall from standing who breaks the fall with the hands."""
    match make_fall(mover):
        case FallForward() as fall:
            return replace(fall, prone=OnFours())
        case FallBackward() as fall:
            return replace(fall, supine=Sitting())
        case fall:
            return replace(fall, caught=radians(36))


def _make_fall_off_seat(mover: Mover, rising_share: float) -> FallFromSeat | FallSideways:
    """Make a person fall off a seat who has risen for a share of the duration."""
    rising = rising_share * mover.duration
    duration, seat = (1 - 0.75 * rising_share) * mover.duration, make_seat(mover)
    if fall_direction(mover) == "sideways":
        return FallSideways(duration, draw_side(mover), seat=seat, rising=rising)
    return FallFromSeat(duration, fall_direction(mover) == "forward", rising, seat)


def make_fall_off_seat(mover: Mover) -> FallFromSeat | FallSideways:
    """Make a person fall off a seat."""
    return _make_fall_off_seat(mover, 0.0)


def make_fall_on_rising(mover: Mover) -> FallFromSeat | FallSideways:
    """Make a person fall who is about to stand up from a seat."""
    return _make_fall_off_seat(mover, 0.5)


MOVEMENTS = (
    MovementKind(
        "falling",
        "falls from standing",
        make_fall,
        STANDING,
        LYING,
        1.1,
        uses=(DIRECTION,),
        words="fall fall_down falling_down collapsing sturz collapse fainting syncope",
        manners=f"{ON_FLOOR} accidental sudden over",
        nearby="fallen fall_forward fall_backward falling_backwards fall_sideways slip slipping "
        "falling_forward falling_backward falling_left falling_right falling_aside",
    ),
    MovementKind(
        "falling_on_hands",
        "falls from standing, on the hands",
        make_fall_on_hands,
        STANDING,
        LYING,
        1.1,
        like="falling",
    ),
    MovementKind(
        "falling_off_seat",
        "falls off a chair",
        make_fall_off_seat,
        SEATED,
        LYING,
        1.0,
        uses=(DIRECTION, *SEAT),
        words=join_words("fall falling fall_down falling_down", OFF_SEATS),
    ),
    MovementKind(
        "falling_on_rising",
        "falls on standing up from a chair",
        make_fall_on_rising,
        SEATED,
        LYING,
        1.7,
        uses=(DIRECTION, *SEAT),
    ),
)
