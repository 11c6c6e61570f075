"""How a person of a scene runs, limps, walks with an aid or carries something."""

from math import ceil, radians

import numpy as np

from radhar_cli.motion.human.running import RunningGait
from radhar_cli.scene import Person

SHORTEST_STEP_S = 0.2


def running_gait(person: Person, place: int) -> RunningGait:
    """Gait of a run at some place in a sequence."""
    return _running_gait(person, person.motion.running.speed_mps, place)


def jogging_gait(person: Person, place: int) -> RunningGait:
    """Gait of jogging on the spot at some place in a sequence."""
    return _running_gait(person, 0.0, place, radians(person.motion.running.knee_deg))


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
