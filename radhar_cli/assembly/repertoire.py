"""How a person of a scene makes each movement: a repertoire by the numbers of `motion`."""

from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property
from math import ceil, pi, radians
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from radhar_cli.assembly.floor import draw_floor_movements
from radhar_cli.assembly.gaits import jogging_gait, other_gaits, running_gait
from radhar_cli.assembly.gestures import draw_gestures
from radhar_cli.config.motion import FallName, Falls, MotionConfig
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
from radhar_cli.motion.human.getting_up import GetUp, TryToGetUp
from radhar_cli.motion.human.grabbing import Grab
from radhar_cli.motion.human.idle import Waves, spread_phases
from radhar_cli.motion.human.lane import Lane
from radhar_cli.motion.human.minimum_jerk import Lags
from radhar_cli.motion.human.part import Place
from radhar_cli.motion.human.planted import ELBOWS, LEGS_AND_TRUNK, SHOULDERS
from radhar_cli.motion.human.repertoire import AROUND, FloorMovements, Gestures, Repertoire
from radhar_cli.motion.human.running import RunningGait
from radhar_cli.motion.human.sitting import Rise, Seat, SitDown, StandUp
from radhar_cli.motion.human.stepping import STUMBLES, StepTo
from radhar_cli.motion.human.turning import Turn
from radhar_cli.motion.human.walking import Gait
from radhar_cli.motion.movements.striking import Kick, Punch
from radhar_cli.numerics.arrays import Float
from radhar_cli.scene import Person

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Fall = FallForward | FallBackward | FallSideways
M = TypeVar("M", bound="DataclassInstance")  # a movement with a duration

RAGGED_HZ = (0.1, 0.25, 0.4)
MOST_HZ = 5.0  # repetitions per second: claps
MIN_STRIDE_S = 0.5  # no stride is shorter


class DrawnRepertoire(Repertoire):
    """How a person of a scene moves; each movement is drawn where it is asked for.

    So what a person does not do costs nothing. Each draw has a name and depends on no other.
    """

    def __init__(self, person: Person, duration: float | None, place: int = 0) -> None:
        """Name what is to be drawn.

        Args:
            person: Person of the scene.
            duration: Duration of a movement that has one, s; None for the usual one.
            place: Place of the movement in its sequence, which names its random streams.
        """
        self._person = person
        self._duration = duration
        self._place = place

    @property
    def _motion(self) -> MotionConfig[float]:
        return self._person.motion

    @cached_property
    def gait(self) -> Gait:
        return _gait(self._person, self._place)

    @property
    def walk(self) -> float:
        stop = self._person.timing.walk_stop_s
        return self._person.seconds if stop is None else stop

    @cached_property
    def _repetitions(self) -> tuple[Float, Float]:
        count = ceil(MOST_HZ * self._person.seconds) + 8
        return _repetitions(self._person, count, self._place)

    @cached_property
    def _lags(self) -> tuple[Lags, Lags]:
        return _lags(self._person, self._place)

    @property
    def _seat(self) -> Seat:
        sitting = self._motion.sitting
        return Seat(
            height=sitting.seat_height,
            recline=radians(sitting.recline_deg),
            lap=sitting.hands_on_lap,
        )

    @property
    def _rise(self) -> Rise:
        return Rise(lean=radians(self._motion.sitting.lean_deg))

    @property
    def punch(self) -> Punch:
        striking, (paces, sizes) = self._motion.striking, self._repetitions
        return Punch(
            frequency=striking.strike_scale * striking.punch_hz,
            paces=_nonzero_tuple(striking.strike_scale * paces),
            sizes=_nonzero_tuple(np.minimum(sizes, 1.0)),  # an arm gets no longer
        )

    @property
    def kick(self) -> Kick:
        striking, (paces, sizes) = self._motion.striking, self._repetitions
        return Kick(
            frequency=striking.strike_scale * striking.kick_hz,
            paces=_nonzero_tuple(striking.strike_scale * paces),
            sizes=_nonzero_tuple(sizes),
        )

    @property
    def grab(self) -> Grab:
        duration = 2.5 if self._duration is None else self._duration
        grabbing, (lowering, rising) = self._motion.grabbing, self._lags
        return Grab(
            down=duration * 1.2 / 2.5,
            dwell=grabbing.dwell_s,
            up=duration * 1.3 / 2.5,
            thigh=radians(-62) * grabbing.bend_deg / 72,
            trunk=radians(grabbing.bend_deg),
            lowering=lowering,
            rising=rising,
        )

    @property
    def sit_down(self) -> SitDown:
        sitting = SitDown(seat=self._seat, rise=self._rise, lags=self._lags[0])
        return _with_duration(self._duration, sitting)

    @property
    def stand_up(self) -> StandUp:
        rising = StandUp(seat=self._seat, rise=self._rise, lags=self._lags[1])
        return _with_duration(self._duration, rising)

    @property
    def turn(self) -> Turn:
        rotating, (paces, sizes) = self._motion.rotating, self._repetitions
        return Turn(
            frequency=rotating.rotation_hz,
            angle=radians(rotating.turn_deg),
            paces=_nonzero_tuple(paces),
            sizes=_nonzero_tuple(sizes),
        )

    @property
    def run(self) -> RunningGait:
        return running_gait(self._person, self._place)

    @property
    def jog(self) -> RunningGait:
        return jogging_gait(self._person, self._place)

    @property
    def other_gaits(self) -> dict[str, Gait]:
        return other_gaits(self._person, self.gait, self._place)

    @property
    def fall(self) -> Fall:
        return _fall(self._person, self._duration)

    @property
    def fall_on_hands(self) -> Fall:
        return _fall(self._person, self._duration, caught=True)

    @property
    def fall_off_seat(self) -> FallFromSeat | FallSideways:
        duration = 1.0 if self._duration is None else self._duration
        return _fall_off_seat(self._seat, self._person, duration)

    @property
    def fall_on_rising(self) -> FallFromSeat | FallSideways:
        duration = 1.7 if self._duration is None else self._duration
        return _fall_off_seat(self._seat, self._person, duration, 0.5)

    @property
    def stumble(self) -> StepTo:
        return _with_duration(self._duration, _stumble(self._person))

    @property
    def trip(self) -> float:
        return radians(self._motion.falling.stumble_deg)

    @property
    def get_up(self) -> GetUp:
        return _with_duration(self._duration, GetUp())

    @property
    def try_to_get_up(self) -> TryToGetUp:
        return _with_duration(self._duration, TryToGetUp())

    @property
    def turn_around(self) -> StepTo:
        return _with_duration(self._duration, AROUND)

    @cached_property
    def floor(self) -> FloorMovements:
        return draw_floor_movements(self._person, self._duration, self._rise, self._place)

    @cached_property
    def gestures(self) -> Gestures:
        return draw_gestures(self._person, self._seat, *self._repetitions, self._place)

    @property
    def exercise_period(self) -> float:
        return self._motion.exercises.period

    @property
    def exercise_paces(self) -> tuple[float, ...]:
        return _nonzero_tuple(self._repetitions[0])

    @property
    def exercise_sizes(self) -> tuple[float, ...]:
        return _nonzero_tuple(self._motion.exercises.size * np.minimum(self._repetitions[1], 1.05))


def _with_duration(duration: float | None, movement: M) -> M:
    """Movement with another duration (s), unless that is None."""
    return movement if duration is None else replace(movement, duration=duration)


def _lags(person: Person, place: int) -> tuple[Lags, Lags]:
    """Lags of the joints in going down, and in coming up."""
    rng = person.stream(f"motion.joint_lag/{place}")
    share, channels = person.motion.transitions.joint_lag, (*LEGS_AND_TRUNK, *SHOULDERS, *ELBOWS)
    down, up = (
        Lags(share, dict(zip(channels, rng.random(len(channels)).tolist(), strict=True)))
        for _ in range(2)
    )
    return down, up


def _side(person: Person) -> float:
    """Side of a fall: 1 to the left, -1 to the right."""
    return 1.0 if person.stream("motion.fall/side").random() < 0.5 else -1.0


def _fall(person: Person, duration: float | None, caught: bool = False) -> Fall:
    """Fall from standing, broken by the hands or not."""
    motion = person.motion
    if _fall_direction(person) == "forward":
        prone, heels = OnFours() if caught else Prone(), radians(motion.falling.heels_deg)
        return _with_duration(duration, FallForward(prone=prone, heels=heels))
    if _fall_direction(person) == "backward":
        return _with_duration(duration, FallBackward(supine=Sitting() if caught else Supine()))
    aside = FallSideways(side=_side(person), caught=radians(36) if caught else 0.0)
    return _with_duration(duration, aside)


def _fall_off_seat(
    seat: Seat, person: Person, total_duration: float, rising_share: float = 0.0
) -> FallFromSeat | FallSideways:
    """Fall off a seat.

    Args:
        seat: Seat of the person.
        person: Person of the scene.
        total_duration: Duration with rising, s.
        rising_share: Share of it for which the person rises first.
    """
    rising, duration = rising_share * total_duration, (1 - 0.75 * rising_share) * total_duration
    if _fall_direction(person) == "sideways":
        return FallSideways(duration, _side(person), seat=seat, rising=rising)
    return FallFromSeat(duration, _fall_direction(person) == "forward", rising, seat)


def _fall_direction(person: Person) -> FallName:
    """Direction in which the person falls or stumbles."""
    direction = person.motion.falling.direction
    assert not isinstance(direction, Falls)  # drawn with the scene
    return direction


def _stumble(person: Person) -> StepTo:
    """Stumble in the direction in which the person would fall."""
    motion = person.motion
    stumble = STUMBLES[_fall_direction(person)].for_stature(person.subject.height_m)
    pitch = radians(motion.falling.stumble_deg)
    if _fall_direction(person) == "forward":
        return replace(stumble, pitch=pitch)
    if _fall_direction(person) == "backward":
        return replace(stumble, pitch=-0.4 * pitch)
    side = _side(person)
    return replace(stumble, place=Place(0.0, side * stumble.place.left), lean=side * 0.4 * pitch)


def _gait(person: Person, place: int) -> Gait:
    """Gait of a walk at some place in a sequence."""
    motion = person.motion
    strides = ceil(person.seconds / MIN_STRIDE_S) + 8
    rng = person.stream(f"motion.speed_variation/{place}")
    variation = motion.walking.speed_variation
    # The duration of a stride is the difference of two deviations.
    jitter, widths = (
        share * variation * rng.standard_normal(strides) for share in (8**-0.5, 1 / 3)
    )
    return Gait(
        speed=motion.walking.speed_mps,
        period_scale=motion.walking.period_scale,
        phase=motion.repeating.cycle_phase,
        arm_swing=motion.walking.arm_swing,
        trunk_pitch=radians(motion.walking.trunk_pitch_deg),
        half_width=motion.walking.step_width / 2,
        start=motion.walking.speed_up,
        ragged=low_pass_waves(motion, variation, RAGGED_HZ, 0.7),
        jitter=_nonzero_tuple(np.clip(jitter, -0.03, 0.03)),
        widths=_nonzero_tuple(np.clip(widths, -0.02, 0.03)),
        lane=_lane(person, place),
    )


def _lane(person: Person, place: int) -> Lane | None:
    """Lane of a walker who turns round, a part of which may lie behind them; or None."""
    motion = person.motion
    if not (length := motion.walking.lane_m):
        return None
    to_left = person.stream(f"motion.lane_m/side/{place}").random() < 0.5
    first = (1 - motion.walking.lane_start) * length
    return Lane(length, first, side=1.0 if to_left else -1.0)


def _nonzero_tuple(numbers: Float) -> tuple[float, ...]:
    """Numbers as a tuple, empty where all are 0."""
    return tuple(numbers.tolist()) if numbers.any() else ()


def _repetitions(person: Person, count: int, place: int) -> tuple[Float, Float]:
    """Pace and size of each repetition over the usual ones, each [count]."""
    motion = person.motion
    tempo = person.stream(f"motion.tempo_jitter/{place}").standard_normal(count)
    size = person.stream(f"motion.size_jitter/{place}").standard_normal(count)
    paces = np.clip(1 + motion.repeating.tempo_jitter * tempo, 0.7, 1.4)
    return paces, np.clip(1 + motion.repeating.size_jitter * size, 0.6, 1.15)


def low_pass_waves(
    motion: MotionConfig[float], deviation: float, rates: Iterable[float], first: float
) -> Waves:
    """Low-pass waves of a standard deviation that have been going on for `motion.idle.phase_s`."""
    f = tuple(rates)
    phases = np.array(spread_phases(len(f), first)) + 2 * pi * np.array(f) * motion.idle.phase_s
    return Waves.low_pass(deviation, tuple(phases % (2 * pi)), f) if deviation else Waves()
