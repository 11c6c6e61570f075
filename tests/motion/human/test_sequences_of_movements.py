"""The twelve activities and sequences of movements."""

from collections.abc import Sequence
from math import inf

import numpy as np
import pytest
from helpers.movers import usual_movement

from radhar_cli.motion.human.idle import Idle
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.human.part import Movement
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.falling import FallBackward
from radhar_cli.motion.movements.getting_up import GetUp
from radhar_cli.motion.movements.walking import Gait, Walk
from radhar_cli.motion.skeleton import JOINTS, PARENTS
from radhar_cli.schema.twelve import MOVEMENTS_OF_TWELVE

PERSON = Physique(1.7)
ACTIVITIES = dict(enumerate(MOVEMENTS_OF_TWELVE.values(), 1))


def sequence(names: Sequence[str], durations: Sequence[float]) -> tuple[Movement, ...]:
    """Movements one after the other, walks at 1.1 m/s; infinity is the usual duration."""
    return tuple(
        Walk(Gait(1.1), duration)
        if name == "walking"
        else usual_movement(name, None if MOVEMENTS[name].seconds else duration)
        for name, duration in zip(names, durations, strict=True)
    )


def activity(number: int) -> tuple[Movement, ...]:
    """Movements of one of the twelve; a walk before another movement lasts 2 s."""
    names = ACTIVITIES[number]
    return sequence(names, [2.0] * (len(names) - 1) + [inf])


def motion(movements: tuple, pauses: tuple[float, ...] = ()) -> HumanMotion:  # type: ignore[type-arg]
    return HumanMotion(PERSON, movements, (2.0, 0.0), 0.0, 0.5, 6.0, Idle(PERSON), pauses)


@pytest.mark.parametrize("number", range(1, 13))
def test_every_activity_moves_as_a_motion_does(number: int) -> None:
    body = motion(activity(number))
    p = body.positions(np.linspace(-0.5, 6.5, 701))
    assert p.shape == (3, 13, 701)
    assert p.dtype == float
    assert np.isfinite(p).all()
    assert body.names == JOINTS
    assert body.parents == PARENTS
    assert body.highest_frequency == (4.0 if number == 3 else 3.0)
    assert list(body.breakpoints) == sorted(body.breakpoints)
    speed = np.linalg.norm(np.diff(p, axis=2), axis=0).max() / 0.01
    assert 0.005 < speed < 9


def test_activities_of_two_parts_end_as_they_should() -> None:
    ends = {n: motion(activity(n)).phases[-1].name for n in (9, 10, 11, 12)}
    assert ends == {9: "walking", 10: "seated", 11: "walking", 12: "lying"}


def test_a_sequence_waits_at_rest() -> None:
    names = ("walking", "sitting_down", "standing_up", "kicking", "walking", "falling")
    movements = sequence(names, (1.0, inf, inf, 1.0, 0.8, inf))
    body = motion(movements, (0.0, 0.4, 1.5))
    parts = [part for part, _ in body.parts]
    assert parts[1].begin - parts[0].end == pytest.approx(0.4)
    assert parts[2].begin - parts[1].end == pytest.approx(1.5)
    assert parts[3].begin == parts[2].end
    seated = np.linspace(parts[1].end, parts[2].begin, 50)
    assert np.ptp(body.positions(seated)[:, JOINTS.index("hip")], axis=1).max() < 1e-9


def test_getting_up_from_a_backward_fall_is_refused() -> None:
    movements = FallBackward(), GetUp()
    with pytest.raises(ValueError, match=r"begins lying prone, but .* ends lying on the back"):
        motion(movements).positions(np.zeros(1))


def test_a_turn_carries_over_to_the_next_movement() -> None:
    """Who walks ahead, turns around and walks as far again is back, facing the other way."""
    body = motion(sequence(("walking", "turning_around", "walking"), (1.0, inf, 1.0)))
    end = body.parts[-1][0].end
    first, last = body.positions(np.array([0.0, end + 0.1])).transpose(2, 0, 1)
    feet = [JOINTS.index("right_ankle"), JOINTS.index("left_ankle")]
    np.testing.assert_allclose(last[:, feet], first[:, feet[::-1]], atol=1e-9)
