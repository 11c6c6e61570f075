"""Velocities of every movement, as people of a scene make it, do not jump between breakpoints."""

import numpy as np
import pytest

from radhar_cli.config import Config
from radhar_cli.motion.activities.activity import ACTIVITIES, activity_named
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.standing import NOBODY
from radhar_cli.motion.protocol import Motion
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.scene import draw_scene

SECONDS = 6.0
NAMES = [*dict.fromkeys((*(a.slug for a in ACTIVITIES), *MOVEMENTS))]
STEPS = (25, 5, 1)  # of the search, from coarse to fine, in units of FINEST_S
FINEST_S = 1e-5
MOST = 0.02  # m/s
STATURES, MORE_STATURES = (1.0, 1.75, 2.1), (1.0, 1.2, 1.45, 1.6, 1.75, 1.9, 2.1)


def motion_drawn(name: str, stature: float, index: int) -> HumanMotion:
    config = Config.model_validate(
        {"activities": [name], "duration_s": SECONDS, "subject": {"height_m": stature}}
    )
    motion = motion_of(draw_scene(config, activity_named(name), index).people[0])
    assert isinstance(motion, HumanMotion)
    return motion


def jumps_of_velocity(motion: Motion, seconds: float) -> list[tuple[float, float]]:
    """Instants (s) and sizes (m/s) of jumps of a joint's velocity that no breakpoint tells.

    A jump changes the velocity by half of itself or more from one step to the next, of any length:
    where it changes by less, no closer look is needed.
    """
    places = np.arange(0, round(seconds / FINEST_S) + 1, STEPS[0])
    for step in STEPS:
        change = changes_of_velocity(motion, places, step)
        suspected = change > MOST / 2
        places, change = places[suspected], change[suspected]
        finer = np.arange(-step, step + 1, max(step // 5, 1))
        if step > 1:
            places = np.unique(places[:, None] + finer)
    apart = np.abs(places[:, None] * FINEST_S - np.asarray(motion.breakpoints))
    unknown = apart.min(axis=1, initial=np.inf) > 2 * FINEST_S
    instants = places * FINEST_S
    return list(zip(instants[unknown].tolist(), change[unknown].tolist(), strict=True))


def changes_of_velocity(motion: Motion, places: Index, step: int) -> Float:
    """Largest change of a joint's velocity (m/s) from the step before a place to that after it.

    Places [N] and the step are in units of FINEST_S.
    """
    if not places.size:
        return np.empty(0)
    needed = np.unique(places[:, None] + np.array([-step, 0, step]))
    p = motion.positions(needed * FINEST_S)
    at = np.searchsorted(needed, places)
    before, after = (np.searchsorted(needed, places + side) for side in (-step, step))
    second = p[..., before] - 2 * p[..., at] + p[..., after]
    change: Float = np.linalg.norm(second, axis=0).max(axis=0) / (step * FINEST_S)
    return change


class Knock:
    """A motion whose only joint gets a velocity at an instant that may be a breakpoint."""

    def __init__(self, jump: float, breakpoints: tuple[float, ...] = ()) -> None:
        self.jump, self.breakpoints = jump, breakpoints

    def positions(self, t: Float) -> Float:
        return np.array([[3.0 * np.sin(t) + self.jump * np.maximum(t - 1.2345678, 0.0)]])


def test_jumps_are_found() -> None:
    assert not jumps_of_velocity(Knock(0.0), 2.0)  # type: ignore[arg-type]
    found = jumps_of_velocity(Knock(0.02), 2.0)  # type: ignore[arg-type]
    assert found
    assert all(abs(t - 1.2345678) < 2e-5 for t, _ in found)
    assert not jumps_of_velocity(Knock(0.5, (1.2345678,)), 2.0)  # type: ignore[arg-type]


@pytest.mark.every(4)
@pytest.mark.parametrize("name", [name for name in NAMES if name != NOBODY])
def test_velocities_do_not_jump(name: str) -> None:
    for index, stature in enumerate(STATURES):
        found = jumps_of_velocity(motion_drawn(name, stature, index), SECONDS)
        assert not found, (stature, found[:5])


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in NAMES if name != NOBODY])
def test_velocities_of_many_do_not_jump(name: str) -> None:
    for stature in MORE_STATURES:
        for index in range(8):
            found = jumps_of_velocity(motion_drawn(name, stature, index), SECONDS)
            assert not found, (stature, index, found[:5])
