"""Movements of the arms alone, again and again: drinking, writing, waving, clapping.

People stand, or sit on a seat; feet and pelvis stay. Hands go by minimum-jerk steps between places
that are given from their shoulder, in the trunk's axes, in m for 1.75 m of stature.

Drinking from a glass has five phases: reaching, transport to the mouth, drinking, transport back
and returning. Their shares and the 5.9 s of all are the medians of 8 healthy people (de los
Reyes-Guzman et al., J. NeuroEngineering and Rehabilitation 7:41, 2010), whose hands peaked at 0.63
to 0.72 m/s; phases after Alt Murphy et al., JNER 3:18, 2006. Handwriting keeps a rhythm of some 5
Hz (Schomaker et al., taxonomy of multimodal interaction, ESPRIT MIAMI, 1995). Claps come 2 (in
step) to 4 times a second (Neda et al., Nature 403, 2000), in shorter ways at a higher tempo (van
Welbergen and Ruttkay, Gesture Workshop 2007). Places, rates of waving and writing at a board, and
all angles are guesses.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf, isinf, pi, radians
from typing import Annotated, ClassVar, Generic, TypeVar

import numpy as np

from radhar_cli.motion.human.arms import (
    OUTWARDS,
    arm_directions,
    arm_directions_to_hands,
    hanging_hands,
)
from radhar_cli.motion.human.idle import IdleState, Waves
from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import SEATED, STANDING, Movement
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import Planted, resting_channels, scale_steps
from radhar_cli.motion.human.pose import SIDES, Axes, Pose
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.repeating import (
    EACH,
    Repeated,
    Repeating,
    Repetition,
    draw_repetitions,
)
from radhar_cli.motion.movements.sitting import SEAT, Seat, make_seat
from radhar_cli.numerics.arrays import Float
from radhar_cli.schema.annotations import PERSONAL, People
from radhar_cli.schema.number import (
    ANGLE,
    FREQUENCY,
    NOT_NEGATIVE,
    RATIO,
    SECONDS,
    Choice,
    normal,
    uniform,
)
from radhar_cli.schema.section import B, ByActivity, Section, default_draw


class GesturesConfig(Section, Generic[B]):
    """Movements of the arms: drinking, writing, waving, clapping."""

    left_handed: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, RATIO),
        People("drinking drinking_seated writing writing_seated waving clapping", 0, 1),
        PERSONAL,
    ] = default_draw(Choice(choice=(0, 1), weights=(9, 1)))
    """Hand that is used: 1 is the left one, 0 the right one."""
    drink_s: Annotated[
        B, ByActivity(NOT_NEGATIVE, SECONDS), People("drinking drinking_seated", 3, 60)
    ] = default_draw(normal(5.9, 1.2, 3.5, 9.0))
    """Duration of a drink at a table, from reaching for the cup to returning; the next one follows.
    A standing person has the cup in the hand, and takes 0.65 of that."""
    cup_held: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("drinking", 0, 1)] = (
        default_draw(Choice(choice=(0, 1)))
    )
    """Place of a standing person's cup between drinks: 1 ahead, 0 at the hanging arm."""
    strokes_hz: Annotated[
        B, ByActivity(NOT_NEGATIVE, FREQUENCY), People("writing writing_seated", 1, 6)
    ] = default_draw(normal(4.0, 0.8, 2.5, 5.5))
    """Strokes up and down of handwriting per second; at a board there are 0.7 of that."""
    waving_hz: Annotated[B, ByActivity(NOT_NEGATIVE, FREQUENCY), People("waving", 0.5, 2.5)] = (
        default_draw(normal(1.5, 0.3, 0.9, 2.2))
    )
    """Swings of a waving forearm, to both sides, per second."""
    raise_deg: Annotated[B, ByActivity(ANGLE), People("waving", 30, 100)] = default_draw(
        normal(60.0, 12.0, 38.0, 85.0)
    )
    """Angle of a waving upper arm ahead of the vertical."""
    both_hands: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("waving", 0, 1)] = (
        default_draw(Choice(choice=(0, 1), weights=(3, 1)))
    )
    """Whether both arms wave: 1 for both, 0 for one."""
    clapping_hz: Annotated[B, ByActivity(NOT_NEGATIVE, FREQUENCY), People("clapping", 1, 5)] = (
        default_draw(normal(3.0, 0.6, 1.8, 4.5))
    )
    """Claps per second."""
    size: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, RATIO),
        People("writing writing_seated waving clapping", 0.4, 1.3),
    ] = default_draw(uniform(0.6, 1.15))
    """Extent of waves, claps and letters, relative to the usual one."""


SECTION = GesturesConfig


REFERENCE_STATURE = 1.75  # of the places below
SIDE = ("right", "left")
PALM_M = 0.015  # from the point of a hand to that of the other where palms meet, half of it
AROUND_BODY_M = 0.10  # by which a hand goes ahead of the straight way, past belly and chest

Point = tuple[float, float, float]  # ahead, inwards and up from the shoulder, m


@dataclass(frozen=True)
class Gesture(Repeated):
    """A movement of the arms, while the person stands or sits."""

    period: float = 1.0  # duration of a repetition, s
    entry: float = 1.0  # time to raise the arms, and to lower them, s
    seat: Seat | None = None  # seat of the person; None stands
    left: bool = False  # whether the left hand makes it, or more of it

    fastest_hz = 4.0


G = TypeVar("G", bound=Gesture)


@dataclass(frozen=True)
class Gesturing(Repeating[G]):
    """The `part.Part` of a person who moves the arms; subclasses have the steps and the arms."""

    channels: ClassVar[tuple[str, ...]]  # channels of `steps`, beside that of the trunk

    @property
    def before(self) -> str:
        return STANDING if self.movement.seat is None else SEATED

    @property
    def after(self) -> str:
        return self.before

    @cached_property
    def _repetitions(self) -> list[Repetition]:
        """Repetitions within the duration and the recording, at least one."""
        gesture, start = self.movement, self.begin + self.movement.entry
        work_s = gesture.duration - 2 * gesture.entry - 0.5 * gesture.period
        return self.repeat(start, gesture.period, start + work_s)

    @cached_property
    def _last_s(self) -> float:
        """Time at which the last repetition has ended, s."""
        start, pace, _ = self._repetitions[-1]
        return start + pace * self.movement.period

    @property
    def end(self) -> float:
        return inf if isinf(self.movement.duration) else self._last_s + self.movement.entry

    def _entry_steps(self, channel: str, change: float) -> list[Step]:
        """Steps that raise the arms, and lower them at the end."""
        entry, steps = self.movement.entry, [Step(channel, change, self.begin, self.movement.entry)]
        if not isinf(self.movement.duration):
            steps.append(Step(channel, -change, self._last_s, entry))
        return steps

    def steps(self) -> list[Step]:
        """Steps of the channels of the arms, and of "trunk", the pitch ahead, rad."""
        raise NotImplementedError

    @cached_property
    def _posture(self) -> dict[str, float]:
        """Channels of the posture in which the person stands or sits."""
        seat = self.movement.seat
        return resting_channels(self.person) if seat is None else seat.posture(self.person)

    @cached_property
    def _steps(self) -> list[Step]:
        return self.steps()

    @cached_property
    def course(self) -> Course:
        """Course of the channels of the arms."""
        arms = [step for step in self._steps if step.channel != "trunk"]
        return Course.of(dict.fromkeys(self.channels, 0.0), arms)

    @cached_property
    def _body(self) -> Planted:
        """Legs and trunk, with the arms at rest."""
        trunk = [step for step in self._steps if step.channel == "trunk"]
        course = Course.of(self._posture, trunk)
        end, state = self.end, self.before
        return Planted(self.person, course, self.begin, end, self.phases, state, state)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return (*self.course.breakpoints, *self._body.breakpoints)

    def pose(self, t: Float, idle: IdleState) -> Pose:
        pose = self._body.pose(t, idle)
        names = ("right_shoulder", "left_shoulder", "right_elbow", "left_elbow")
        right, left, *elbows = (self._posture[name] for name in names)
        shoulder = np.array([[right], [left]]) + idle.shoulders
        elbow = np.array(elbows)[:, None] + idle.elbows
        values = dict(zip(self.channels, self.course(t), strict=True))
        upper, fore = self.arms(t, pose.trunk, (shoulder, elbow), values)
        return replace(pose, upper_arms=upper, forearms=fore)

    def arms(
        self, t: Float, trunk: Axes, rest: tuple[Float, Float], values: dict[str, Float]
    ) -> tuple[Float, Float]:
        """Unit vectors of upper arms and forearms [3, 2, M].

        Args:
            t: Times [M], s.
            rest: Flexion of shoulders and of elbows at rest, each [2, M], rad.
            values: Values of the channels, each [M].
        """
        raise NotImplementedError

    @property
    def scale(self) -> float:
        """Stature over that of the places."""
        return self.person.stature / REFERENCE_STATURE

    def _from_shoulder(self, point: Point) -> Float:
        """A place of both hands from their shoulders in the trunk's axes [3, 2, 1], m."""
        ahead, inwards, up = point
        return self.scale * np.array([ahead + 0 * SIDES, -inwards * SIDES, up + 0 * SIDES])

    def _arms_to(
        self,
        trunk: Axes,
        rest: tuple[Float, Float],
        raised: Float,
        hands: Float,
        poles: Float = OUTWARDS[:, :, None],
    ) -> tuple[Float, Float]:
        """Unit vectors of arms [3, 2, M] between hanging and hands where they are at work.

        Args:
            rest: Flexion of shoulders and of elbows at rest, each [2, M], rad.
            raised: Share of the way of the hands to their work [2, M], 0 to 1.
            hands: Places of their work, from their shoulders, in the trunk's axes [3, 2, M], m.
            poles: Directions in which the elbows then bend, in the trunk's axes [3, 2, M].
        """
        places, directions = hanging_hands(self.person, *rest)
        places += raised * (hands - places)
        places[0] += 4 * AROUND_BODY_M * self.scale * raised * (1 - raised)
        directions += raised * (poles - directions)
        return arm_directions_to_hands(trunk, places, directions, self.person.arm)


def both(values: dict[str, Float], channel: str) -> Float:
    """A channel of the right and of the left side [2, M]."""
    return np.array([values[f"{side}_{channel}"] for side in SIDE])


@dataclass(frozen=True)
class Drink(Gesture):
    """Drinks from a cup: standing, from where the cup hangs or is held; seated, from a table."""

    period: float = 5.9
    held: bool = False  # whether the cup is held ahead between drinks; else the arm is lowered
    cup: Point = (0.34, 0.07, -0.26)  # place of the hand where the cup is held or stands
    mouth: Point = (0.20, 0.165, 0.05)
    # by how much the hand goes up, and towards the mouth, as the cup is tilted
    tilt: tuple[float, float] = (0.045, 0.03)
    # lean, back: pitch of the trunk towards the cup, and back as it is emptied, rad
    lean: float = radians(6)
    back: float = radians(8)
    entry: float = 0.1  # time of rest before and after

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Drinking":
        return Drinking(person, self, begin, horizon)


class Drinking(Gesturing[Drink]):
    """The `part.Part` of a person who drinks."""

    name = "drinking"
    channels = ("raised", "lifted", "tilted")
    # From and to, shares of a repetition: the hand is raised to the cup, or lowered; goes to the
    # mouth; tilts the cup. Who stands takes the cup to the mouth on the way up.
    TABLE = ((0.0, 0.17), (0.17, 0.33), (0.30, 0.44), (0.48, 0.61), (0.57, 0.80), (0.80, 1.0))
    HANGING = ((0.0, 0.24), (0.04, 0.31), (0.26, 0.42), (0.46, 0.61), (0.56, 0.85), (0.62, 0.95))

    def steps(self) -> list[Step]:
        drink, steps = self.movement, list[Step]()
        is_lowered = drink.seat is not None or not drink.held
        spans = self.HANGING if drink.seat is None and not drink.held else self.TABLE
        last = len(self._repetitions) - 1
        for number, (start, pace, size) in enumerate(self._repetitions):
            length = pace * drink.period
            changes = [
                ("raised", 1.0 if is_lowered or number == 0 else 0.0),
                ("lifted", 1.0),
                ("tilted", size),
                ("tilted", -size),
                ("lifted", -1.0),
                ("raised", -1.0 if is_lowered or (number == last and not isinf(self.end)) else 0.0),
            ]
            for (channel, change), (since, until) in zip(changes, spans, strict=True):
                times = start + length * since, length * (until - since)
                if change:
                    steps.append(Step(channel, change, *times))
                if channel == "lifted":
                    steps.append(Step("trunk", change * drink.lean, *times))
                if channel == "tilted":
                    steps.append(Step("trunk", -change * (drink.lean + drink.back), *times))
        return steps

    def arms(
        self, t: Float, trunk: Axes, rest: tuple[Float, Float], values: dict[str, Float]
    ) -> tuple[Float, Float]:
        drink, hand = self.movement, np.array([[not self.movement.left], [self.movement.left]])
        cup, mouth = self._from_shoulder(drink.cup), self._from_shoulder(drink.mouth)
        hands = cup + values["lifted"] * (mouth - cup)
        hands[2] += drink.tilt[0] * self.scale * values["tilted"]
        hands[0] -= drink.tilt[1] * self.scale * values["tilted"]
        poles = OUTWARDS[:, :, None] + 0 * hands
        poles[1] += 0.35 * SIDES * values["tilted"]
        poles[2] += 0.2 * values["tilted"]
        return self._arms_to(trunk, rest, hand * values["raised"], hands, poles)


@dataclass(frozen=True)
class Write(Gesture):
    """Writes word by word, line by line, from left to right: at a board, or seated at a table."""

    period: float = 1.8  # duration of a word with the way to the next, s
    start: Point = (0.42, 0.15, 0.06)  # place of the hand where the first line begins
    other: Point | None = None  # place of the other hand; None hangs
    word: float = 0.09  # width of a word
    words: int = 3  # words of a line
    line: float = 0.08  # distance of lines
    lines: int = 3  # lines until the hand goes back to the first
    stroke: float = 0.011  # standard deviation of strokes up and across
    off: float = 0.02  # distance of the pen from the paper between words
    upright: bool = True  # whether lines are below each other, else nearer and nearer on a table
    pitch: float = radians(3)  # of the trunk ahead, rad
    # up, across: rhythm of the strokes
    up: Waves = field(default_factory=Waves)
    across: Waves = field(default_factory=Waves)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Writing":
        return Writing(person, self, begin, horizon)


AT_TABLE = Write(
    period=1.5,
    seat=Seat(),
    start=(0.30, 0.16, -0.25),
    other=(0.28, 0.06, -0.26),
    word=0.03,
    words=4,
    line=0.009,
    lines=4,
    stroke=0.003,
    off=0.012,
    upright=False,
    pitch=radians(10),
)


class Writing(Gesturing[Write]):
    """The `part.Part` of a person who writes."""

    name = "writing"
    channels = ("raised", "pen", "along", "down")

    def steps(self) -> list[Step]:
        write = self.movement
        steps = [*self._entry_steps("raised", 1.0), *self._entry_steps("trunk", write.pitch)]
        along = down = 0.0
        for number, (start, pace, size) in enumerate(self._repetitions):
            length, width = pace * write.period, min(size, 1.1) * write.word

            changes = [
                Step("pen", size, 0.0, 0.10),
                Step("pen", -size, 0.68, 0.10),
                Step("along", width, 0.0, 0.72),
            ]
            along += width
            if (number + 1) % write.words == 0:
                lower = write.line if (number + 1) % (write.words * write.lines) else -down
                changes += [Step("along", -along, 0.72, 0.28), Step("down", lower, 0.72, 0.28)]
                along, down = 0.0, down + lower
            steps += scale_steps(changes, start, length)
        return steps

    def arms(
        self, t: Float, trunk: Axes, rest: tuple[Float, Float], values: dict[str, Float]
    ) -> tuple[Float, Float]:
        write, pen = self.movement, values["pen"]
        writes = np.array([[not write.left], [write.left]])
        hands = self._from_shoulder(write.start) + np.zeros((3, 2, t.size))
        left_handed = 0.5 * write.words * write.word if write.left else 0.0  # begins farther out
        stroke = self.scale * write.stroke * pen
        hands[1] += stroke * write.across(t) - self.scale * (values["along"] - left_handed)
        up, ahead = (2, 0) if write.upright else (0, 2)
        hands[up] += stroke * write.up(t) - self.scale * values["down"]
        hands[ahead] += (-1 if write.upright else 1) * self.scale * write.off * (1 - pen)
        raised = writes * values["raised"]
        if write.other is not None:
            hands = np.where(writes, hands, self._from_shoulder(write.other))
            raised = np.ones((2, 1)) * values["raised"]
        return self._arms_to(trunk, rest, raised, hands)


@dataclass(frozen=True)
class Clap(Gesture):
    """Claps ahead of the chest."""

    period: float = 0.33
    meet: Point = (0.30, 0.0, -0.09)  # where palms meet, from the shoulders; inwards counts not
    opening: float = 0.20  # way of a hand at one clap a second; it is shorter at more
    lead: float = 0.25  # by which the way of one hand is longer, and that of the other shorter

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Clapping":
        return Clapping(person, self, begin, horizon)


class Clapping(Gesturing[Clap]):
    """The `part.Part` of a person who claps."""

    name = "clapping"
    channels = ("raised", "apart")

    def steps(self) -> list[Step]:
        clap, steps = self.movement, self._entry_steps("raised", 1.0)
        usual = clap.opening * clap.period
        apart = usual * self._repetitions[0].size
        steps.append(Step("apart", apart, self.begin, clap.entry))
        sizes = [size for _, _, size in self._repetitions[1:]]
        for (start, pace, _), size in zip(self._repetitions, [*sizes, 0.0], strict=True):
            length = pace * clap.period
            steps.append(Step("apart", -apart, start, 0.48 * length))
            apart = usual * pace * size
            if apart:
                steps.append(Step("apart", apart, start + 0.5 * length, 0.5 * length))
        return steps

    def arms(
        self, t: Float, trunk: Axes, rest: tuple[Float, Float], values: dict[str, Float]
    ) -> tuple[Float, Float]:
        clap, ways = self.movement, np.array([[1.0], [1.0]])
        ways[int(clap.left)] += clap.lead
        ways[1 - int(clap.left)] -= clap.lead
        hands = self._from_shoulder(clap.meet) + np.zeros((3, 2, t.size))
        beside = PALM_M + self.scale * ways * values["apart"]  # of the middle [2, M]
        hands[1] = SIDES * (beside - self.person.shoulder)
        return self._arms_to(trunk, rest, np.ones((2, 1)) * values["raised"], hands)


@dataclass(frozen=True)
class Wave(Gesture):
    """Waves: an arm is raised, its forearm swings from side to side; angles in rad."""

    period: float = 0.65
    both: bool = False  # whether both arms are raised
    flexion: float = radians(60)  # of the upper arm, ahead
    outwards: float = radians(38)  # of the upper arm
    forearm: float = radians(170)  # from hanging, ahead: 180 is upright
    swing: float = radians(60)  # from one side to the other
    bend: float = radians(9)  # flexion of the elbow that comes with a swing
    entry: float = 1.1

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Waving":
        return Waving(person, self, begin, horizon)


class Waving(Gesturing[Wave]):
    """The `part.Part` of a person who waves."""

    name = "waving"
    channels = ("raised", "swung")

    def steps(self) -> list[Step]:
        wave, steps = self.movement, self._entry_steps("raised", 1.0)
        steps += self._entry_steps("swung", -0.5)
        for start, pace, size in self._repetitions:
            half = 0.5 * pace * wave.period
            steps.append(Step("swung", size, start, 1.15 * half))
            steps.append(Step("swung", -size, start + half, 1.15 * half))
        return steps

    def arms(
        self, t: Float, trunk: Axes, rest: tuple[Float, Float], values: dict[str, Float]
    ) -> tuple[Float, Float]:
        wave, (shoulder, elbow) = self.movement, rest
        waves = np.array([[wave.both or not wave.left], [wave.both or wave.left]])
        raised, swung = waves * values["raised"], waves * values["swung"]
        shoulder = shoulder + raised * (wave.flexion - shoulder)
        bent = wave.forearm - wave.flexion
        elbow = elbow + raised * (bent - elbow) - wave.bend * (swung + 0.5 * raised)
        upper, fore = arm_directions(trunk, shoulder, elbow)
        beside = SIDES * trunk.left[:, None]
        out, aside = raised * wave.outwards, wave.swing * swung
        return (
            np.cos(out) * upper + np.sin(out) * beside,
            np.cos(aside) * fore + np.sin(aside) * beside,
        )


# Rates of strokes up and across over the usual one, of no common measure; letters are no sines.
STROKES_UP, STROKES_ACROSS = (0.53, 1.0, 1.27), (0.41, 0.79, 1.11)
# Duration of a drink from a cup in the hand over that from one on a table: without reaching for the
# cup and returning, medians of de los Reyes-Guzman et al. (2010).
CUP_IN_HAND = 0.65
ON_BOARD = 0.7  # rate of strokes at a board, where letters are larger, over that on paper


def _draw(mover: Mover, usual: G) -> tuple[GesturesConfig[float], G]:
    """Numbers of a person's gestures, and a usual one with the hand and the repetitions drawn."""
    numbers, (paces, sizes) = mover.numbers(GesturesConfig[float]), draw_repetitions(mover)
    return numbers, replace(
        usual,
        duration=mover.duration,
        left=numbers.left_handed >= 0.5,
        paces=tuple(paces.tolist()),
        sizes=tuple(sizes.tolist()),
    )


def make_drinks(mover: Mover) -> Drink:
    """Make a person who stands drink, again and again."""
    numbers, drink = _draw(mover, Drink())
    return replace(drink, period=CUP_IN_HAND * numbers.drink_s, held=numbers.cup_held >= 0.5)


def make_seated_drinks(mover: Mover) -> Drink:
    """Make a person who sits drink, again and again."""
    period = mover.numbers(GesturesConfig[float]).drink_s
    return replace(make_drinks(mover), seat=make_seat(mover), period=period)


def _make_writing(mover: Mover, usual: Write, rate: float) -> Write:
    """Make a person write as usual, by `rate` times the usual strokes a second."""
    numbers, write = _draw(mover, usual)
    rng = mover.stream(f"motion.gestures.strokes/{mover.place}")
    up, across = (2 * pi * rng.random((2, len(STROKES_UP)))).tolist()
    return replace(
        write,
        stroke=numbers.size * usual.stroke,
        word=numbers.size * usual.word,
        up=_strokes(rate * numbers.strokes_hz, STROKES_UP, up),
        across=_strokes(rate * numbers.strokes_hz, STROKES_ACROSS, across),
    )


def make_writing(mover: Mover) -> Write:
    """Make a person write on a board."""
    return _make_writing(mover, Write(), ON_BOARD)


def make_seated_writing(mover: Mover) -> Write:
    """Make a person write at a table."""
    return replace(_make_writing(mover, AT_TABLE, 1.0), seat=make_seat(mover))


def make_waves(mover: Mover) -> Wave:
    """Make a person wave."""
    numbers, wave = _draw(mover, Wave())
    return replace(
        wave,
        period=1 / numbers.waving_hz,
        both=numbers.both_hands >= 0.5,
        flexion=radians(numbers.raise_deg),
        swing=numbers.size * wave.swing,
        bend=numbers.size * wave.bend,
    )


def make_claps(mover: Mover) -> Clap:
    """Make a person clap."""
    numbers, clap = _draw(mover, Clap())
    return replace(clap, period=1 / numbers.clapping_hz, opening=numbers.size * clap.opening)


def _strokes(rate: float, rates: tuple[float, ...], phases: list[float]) -> Waves:
    """Strokes of standard deviation 1, about `rate` a second, with phases in rad."""
    amplitude = (2 / len(rates)) ** 0.5
    return Waves((amplitude,) * len(rates), tuple((rate * np.array(rates)).tolist()), tuple(phases))


def _kind(
    name: str,
    meaning: str,
    make: Callable[[Mover], Movement],
    words: str = "",
    manners: str = "",
    nearby: str = "",
) -> MovementKind:
    """Describe a gesture to configs."""
    is_seated = name.endswith("_seated")
    state = SEATED if is_seated else STANDING
    return MovementKind(
        name,
        meaning,
        make,
        state,
        state,
        in_place=True,
        uses=(*EACH, *SEAT) if is_seated else EACH,
        words=words,
        manners=manners,
        nearby=nearby,
    )


MOVEMENTS = (
    _kind(
        "drinking",
        "stands and drinks",
        make_drinks,
        "drinking_standing drink drinking_water drink_water drinking_from_cup trinken",
        manners="standing from_bottle from_glass from_cup",
        nearby="eat eating sipping",
    ),
    _kind(
        "writing", "stands and writes on a board", make_writing, "write writing_on_board schreiben"
    ),
    _kind(
        "waving",
        "stands and waves",
        make_waves,
        "wave hand_waving waving_hand hand_wave wave_hello wave_hand winken waving_hand_left "
        "waving_hand_right single_hand_waving",
        manners="hello goodbye",
    ),
    _kind(
        "clapping",
        "stands and claps",
        make_claps,
        "clap clapping_hands hand_clapping applauding clap_hands klatschen",
    ),
    _kind("drinking_seated", "sits and drinks", make_seated_drinks),
    _kind(
        "writing_seated",
        "sits and writes at a table",
        make_seated_writing,
        "writing_at_table",
        nearby="drawing",
    ),
)
