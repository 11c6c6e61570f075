"""What a person can do: the twelve activities S1 to S12, and sequences of any of them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf, pi, radians
from typing import NamedTuple

from radhar_cli.motion.human.crawling import Crawl
from radhar_cli.motion.human.exercises import EXERCISES, Exercise
from radhar_cli.motion.human.falling import FallBackward, FallForward, OnFours
from radhar_cli.motion.human.falling_from_seat import FallFromSeat
from radhar_cli.motion.human.falling_sideways import FallSideways
from radhar_cli.motion.human.gesturing import AT_TABLE, Clap, Drink, Wave, Write
from radhar_cli.motion.human.getting_up import GetUp, TryToGetUp
from radhar_cli.motion.human.grabbing import Grab
from radhar_cli.motion.human.kneeling import GetDown, Kneel
from radhar_cli.motion.human.lying import Lie, TurnOver
from radhar_cli.motion.human.other_gaits import OTHER_GAITS, usual_gaits
from radhar_cli.motion.human.part import Movement, Place
from radhar_cli.motion.human.running import GoRunning, RunningGait
from radhar_cli.motion.human.sitting import Seat, Sit, SitDown, StandUp
from radhar_cli.motion.human.standing import Stand
from radhar_cli.motion.human.stepping import STUMBLES, StepTo
from radhar_cli.motion.human.transfer import GoToBed, LeaveBed
from radhar_cli.motion.human.turning import Turn
from radhar_cli.motion.human.walking import Gait, Walk
from radhar_cli.motion.movements.striking import Kick, Punch

ON_HANDS = FallForward(prone=OnFours())
ON_RISING = FallFromSeat(rising=0.9)
RUNNING, ON_THE_SPOT = RunningGait(3.3), RunningGait(0.0)
AROUND = StepTo(1.8, Place(turn=pi), steps=5, name="turning around")


class FloorMovements(NamedTuple):
    """How a person moves on the floor and in bed."""

    crawl: Crawl = Crawl()
    kneel: Kneel = Kneel()
    kneel_down: GetDown = GetDown(Kneel())
    get_on_fours: GetDown = GetDown()
    lie: Lie = Lie()
    turn_over: TurnOver = TurnOver()
    go_to_bed: GoToBed = GoToBed()
    leave_bed: LeaveBed = LeaveBed()


class Gestures(NamedTuple):
    """How a person moves the arms, standing or seated."""

    drink: Drink = Drink()
    drink_seated: Drink = Drink(seat=Seat())
    write: Write = Write()
    write_seated: Write = AT_TABLE
    wave: Wave = Wave()
    clap: Clap = Clap()


@dataclass(frozen=True)
class Repertoire:
    """How a person makes each movement."""

    gait: Gait  # gait of every walk
    walk: float = 2.0  # how long the walk of S10 and S12 lasts before its last steps, s
    punch: Punch = field(default_factory=Punch)
    kick: Kick = field(default_factory=Kick)
    grab: Grab = field(default_factory=Grab)
    sit_down: SitDown = field(default_factory=SitDown)
    stand_up: StandUp = field(default_factory=StandUp)
    turn: Turn = field(default_factory=Turn)
    run: RunningGait = RUNNING
    jog: RunningGait = ON_THE_SPOT
    other_gaits: Mapping[str, Gait] = field(default_factory=usual_gaits)
    # in which direction people fall, and how
    fall: FallForward | FallBackward | FallSideways = field(default_factory=FallForward)
    fall_on_hands: FallForward | FallBackward | FallSideways = ON_HANDS
    fall_off_seat: FallFromSeat | FallSideways = field(default_factory=FallFromSeat)
    fall_on_rising: FallFromSeat | FallSideways = ON_RISING
    stumble: StepTo = STUMBLES["forward"]
    trip: float = radians(30)  # by how much the trunk pitches in a trip, rad
    get_up: GetUp = field(default_factory=GetUp)
    try_to_get_up: TryToGetUp = field(default_factory=TryToGetUp)
    turn_around: StepTo = AROUND
    floor: FloorMovements = field(default_factory=FloorMovements)
    gestures: Gestures = field(default_factory=Gestures)
    # period of every exercise over the usual one; time and size of each repetition over the usual
    exercise_period: float = 1.0
    exercise_paces: tuple[float, ...] = ()
    exercise_sizes: tuple[float, ...] = ()

    def activity(self, number: int) -> tuple[Movement, ...]:
        """Movements of the activity S`number`; what repeats does so from the first instant on."""
        return ACTIVITIES[number](self)

    def bout(self, name: str, duration: float, from_rest: bool) -> Movement:
        """Punching, kicking, rotating or walking for `duration` s, steadily or from rest."""
        return replace(BOUTS[name](self), duration=duration, from_rest=from_rest)

    def sequence(self, names: Sequence[str], durations: Sequence[float]) -> tuple[Movement, ...]:
        """Movements of `activity.MOVEMENTS` by name, one after the other, each from rest.

        Args:
            names: Movements.
            durations: Duration of each, s, used by walking, tripping, punching, kicking, rotating,
                standing and exercises; infinity goes on.

        Raises:
            ValueError: A name is not a movement of a sequence.
        """
        return tuple(
            self._movement(name, duration) for name, duration in zip(names, durations, strict=True)
        )

    def _movement(self, name: str, duration: float) -> Movement:
        if name not in MOVEMENTS:
            known = ", ".join(MOVEMENTS)
            raise ValueError(f"{name!r} is not a movement of a sequence; these are: {known}")
        return MOVEMENTS[name](self, duration)

    def exercise(self, name: str, duration: float) -> Exercise:
        """Exercise of a name for `duration` s, as this person does it."""
        usual = EXERCISES[name]
        return replace(
            usual,
            duration=duration,
            period=self.exercise_period * usual.period,
            paces=self.exercise_paces,
            sizes=self.exercise_sizes,
        )


# How a person makes each bout, and the movements of S1 to S12, from a repertoire. Entries are
# functions, so that a repertoire works out only the movements that are asked for.
BOUTS: dict[str, Callable[[Repertoire], Walk | Punch | Kick | Turn]] = {
    "punching": lambda person: person.punch,
    "kicking": lambda person: person.kick,
    "body_rotating": lambda person: person.turn,
    "walking": lambda person: Walk(person.gait),
}
ACTIVITIES: dict[int, Callable[[Repertoire], tuple[Movement, ...]]] = {
    1: lambda person: (Stand(),),
    2: lambda person: (person.bout("punching", inf, from_rest=False),),
    3: lambda person: (person.bout("kicking", inf, from_rest=False),),
    4: lambda person: (person.grab,),
    5: lambda person: (person.sit_down,),
    6: lambda person: (person.stand_up,),
    7: lambda person: (person.bout("body_rotating", inf, from_rest=False),),
    8: lambda person: (person.bout("walking", inf, from_rest=False),),
    9: lambda person: (person.stand_up, Walk(person.gait)),
    10: lambda person: (Walk(person.gait, person.walk, from_rest=False), person.sit_down),
    11: lambda person: (person.get_up, Walk(person.gait)),
    12: lambda person: (Walk(person.gait, person.walk, from_rest=False), person.fall),
}
# How a person makes each movement of a sequence, from a repertoire and a duration, s.
# `activities.activity.MOVEMENTS` has the states that it begins and ends in.
MOVEMENTS: dict[str, Callable[[Repertoire, float], Movement]] = {
    "nobody": lambda person, duration: Stand(duration),  # who would be there; makes no echo
    "stationary": lambda person, duration: Stand(duration),
    "punching": lambda person, duration: replace(person.punch, duration=duration, from_rest=True),
    "kicking": lambda person, duration: replace(person.kick, duration=duration, from_rest=True),
    "grabbing": lambda person, duration: person.grab,
    "sitting_down": lambda person, duration: person.sit_down,
    "standing_up": lambda person, duration: person.stand_up,
    "body_rotating": lambda person, duration: replace(
        person.turn, duration=duration, from_rest=True
    ),
    "walking": lambda person, duration: Walk(person.gait, duration),
    "running": lambda person, duration: GoRunning(person.run, duration),
    "jogging_in_place": lambda person, duration: GoRunning(person.jog, duration),
    "falling": lambda person, duration: person.fall,
    "falling_on_hands": lambda person, duration: person.fall_on_hands,
    "falling_off_seat": lambda person, duration: person.fall_off_seat,
    "falling_on_rising": lambda person, duration: person.fall_on_rising,
    "stumbling": lambda person, duration: person.stumble,
    "tripping": lambda person, duration: Walk(replace(person.gait, trip=person.trip), duration),
    **{
        name: lambda person, duration, name=name: Walk(person.other_gaits[name], duration)  # type: ignore[misc]
        for name in OTHER_GAITS
    },
    "getting_up": lambda person, duration: person.get_up,
    "trying_to_get_up": lambda person, duration: person.try_to_get_up,
    "turning_around": lambda person, duration: person.turn_around,
    "sitting": lambda person, duration: Sit(duration, person.sit_down.seat),
    "kneeling": lambda person, duration: replace(person.floor.kneel, duration=duration),
    "kneeling_down": lambda person, duration: person.floor.kneel_down,
    "getting_on_fours": lambda person, duration: person.floor.get_on_fours,
    "crawling": lambda person, duration: replace(person.floor.crawl, duration=duration),
    "lying": lambda person, duration: replace(person.floor.lie, duration=duration),
    "turning_over": lambda person, duration: person.floor.turn_over,
    "lying_down": lambda person, duration: person.floor.go_to_bed,
    "getting_up_from_bed": lambda person, duration: person.floor.leave_bed,
    "drinking": lambda person, duration: replace(person.gestures.drink, duration=duration),
    "drinking_seated": lambda person, duration: replace(
        person.gestures.drink_seated, duration=duration
    ),
    "writing": lambda person, duration: replace(person.gestures.write, duration=duration),
    "writing_seated": lambda person, duration: replace(
        person.gestures.write_seated, duration=duration
    ),
    "waving": lambda person, duration: replace(person.gestures.wave, duration=duration),
    "clapping": lambda person, duration: replace(person.gestures.clap, duration=duration),
    **{
        name: lambda person, duration, name=name: person.exercise(name, duration)  # type: ignore[misc]
        for name in EXERCISES
    },
}
