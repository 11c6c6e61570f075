"""How a person of a scene runs, limps, walks with an aid or carries something."""

from dataclasses import replace
from math import ceil, radians

import numpy as np

from radhar_cli.motion.human.other_gaits import (
    carrying,
    largest_limp,
    limping,
    walking_with_stick,
    walking_with_walker,
)
from radhar_cli.motion.human.running import RunningGait
from radhar_cli.motion.human.walking import Gait
from radhar_cli.scene import Person

SHORTEST_STEP_S = 0.2
SLOWEST = 0.15  # speed of a walk, m/s
OTHER_HAND = 0.8  # share of people who hold a stick in the hand of the other side


def running_gait(person: Person, place: int) -> RunningGait:
    """Gait of a run at some place in a sequence."""
    return _running_gait(person, person.motion.running.speed_mps, place)


def jogging_gait(person: Person, place: int) -> RunningGait:
    """Gait of jogging on the spot at some place in a sequence."""
    return _running_gait(person, 0.0, place, radians(person.motion.running.knee_deg))


def other_gaits(person: Person, gait: Gait, place: int) -> dict[str, Gait]:
    """Gaits of a walk at some place in a sequence that differ from the person's usual one."""
    motion = person.motion
    limp, aids, load = motion.limping, motion.aids, motion.carrying
    painful, hand, bag = person.stream(f"motion.limping/sides/{place}").random(3)
    limper, with_stick = (
        limping(
            slowed,
            min(limp.asymmetry, largest_limp(slowed.speed, person.subject.height_m)),
            1.0 if painful < 0.5 else -1.0,
            radians(limp.lean_deg),
        )
        for slowed in (_slow_down(gait, limp.pace), _slow_down(gait, aids.stick_pace))
    )
    return {
        "limping": limper,
        "walking_with_stick": walking_with_stick(with_stick, bool(hand < OTHER_HAND)),
        "walking_with_walker": walking_with_walker(
            _slow_down(gait, aids.walker_pace),
            aids.rollator > 0.5,
            radians(aids.walker_pitch_deg),
            person.subject.height_m,
        ),
        "carrying": carrying(
            _slow_down(gait, load.pace), (int(bag < 0.5) if load.bag > 0.5 else None)
        ),
    }


def _slow_down(gait: Gait, pace: float) -> Gait:
    """Multiply the speed of a gait by `pace`; the slowest walk is one of SLOWEST."""
    return replace(gait, speed=max(pace * gait.speed, min(SLOWEST, gait.speed)))


def _running_gait(
    person: Person, speed: float, place: int, knee: float | None = None
) -> RunningGait:
    """Gait of a run, whose steps differ in time and speed.

    Args:
        person: Person of the scene.
        speed: m/s.
        place: Place of the run in its sequence, which names its random stream.
        knee: Largest flexion of the swinging knee, rad; None for the usual one.
    """
    running = person.motion.running
    count = ceil(person.seconds / SHORTEST_STEP_S) + 8
    rng = person.stream(f"motion.running.variation/{place}")
    paces, speeds = 1 + np.clip(running.variation * rng.standard_normal((2, count)), -0.08, 0.08)
    return RunningGait(
        speed=speed,
        cadence=running.cadence,
        arm_swing=running.arm_swing,
        trunk_pitch=radians(running.trunk_pitch_deg),
        elbow=radians(running.elbow_deg),
        knee=knee,
        paces=tuple(paces.tolist()) if running.variation else (),
        speeds=tuple(speeds.tolist()) if running.variation else (),
    )
