"""What really moved: positions, radial velocities, and which movement is under way."""

from collections import Counter
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from radhar_cli.arrays import Float, Index, Levels
from radhar_cli.motion.files.motion import FileMotion
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.phases import phase_numbers
from radhar_cli.motion.protocol import Motion
from radhar_cli.pipeline.bodies import Whose
from radhar_cli.pipeline.motion_paths import point_delay
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.room import Way, names_of
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import SPEED_OF_LIGHT, Waveform

RATE_STEP_S = 1e-5
WHOLE = "the whole activity"


@dataclass(frozen=True)
class Truth:
    """Kinematics at every pulse, or at other times."""

    time: Float = field(repr=False)  # t_m [M], s
    positions: Float = field(repr=False)  # [M, I, 3], m
    # half the rate of the two-way path [M, I], m/s, positive receding
    radial_velocity: Float = field(repr=False)
    doppler: Float = field(repr=False)  # -f0 dtau/dt [M, I], Hz, with the wall, before aliasing
    phase_label: Levels = field(repr=False)  # number in `phases` of what is under way [M]
    phases: tuple[str, ...]  # names of the movements within the activity
    # where thighs begin, right and left [M, 2, 3], m; None where it is the hip
    hip_joints: Float | None = field(default=None, repr=False)


class PathTruth(NamedTuple):
    """Every path of a scene: of everybody, straight and by way of the room."""

    time: Float  # of the pulses that a range-time map shows [M], s
    delay: Float  # [I, M], s
    amplitude: Float  # [I, M], for unit transmit power
    kind: list[str]  # faces of the leg of the transmitter/of the receiver [I]
    person: Index  # number [I]; -1 is what stands in the room
    scatterer: Index  # number [I]
    bounces: Index  # of both legs [I]


def path_truth(sources: list[Whose], t: Float) -> PathTruth:
    """Evaluate all paths at times t [M] (s)."""
    paths = [one.source(t) for one in sources]
    counts = [len(one.delay) for one in paths]
    first = Counter[tuple[int, tuple[Way, Way]]]()  # scatterer of a person by these legs
    scatterers = []
    for one, count in zip(sources, counts, strict=True):
        begin = first[one[1:]]
        scatterers.append(np.arange(begin, begin + count))
        first[one[1:]] += count
    bounces = [sum(len(way.faces) for way in one.legs) for one in sources]
    return PathTruth(
        t,
        np.concatenate([one.delay for one in paths]),
        np.concatenate([one.amplitude for one in paths]),
        np.repeat([names_of(one.legs) for one in sources], counts).tolist(),
        np.repeat([one.person for one in sources], counts),
        np.concatenate(scatterers),
        np.repeat(bounces, counts),
    )


def truth(
    motion: Motion,
    antennas: Antennas,
    wall: Wall | None,
    waveform: Waveform,
    t: Float | None = None,
) -> Truth:
    """Evaluate the kinematics of all scatterers at times t [M] (s), at every pulse if None."""
    if t is None:
        t = waveform.times(np.arange(waveform.n_pulses, dtype=float))

    def rate(slab: Wall | None) -> Float:
        """d tau/dt [M, I] by a central difference."""
        early, late = (
            point_delay(motion.positions(t + step), antennas, slab)
            for step in (-RATE_STEP_S, RATE_STEP_S)
        )
        return (late - early).T / (2 * RATE_STEP_S)

    phases = tuple(dict.fromkeys((WHOLE, *(name for _, name in motion.phases))))
    with_hip_joints = (HumanMotion, FileMotion)
    return Truth(
        time=t,
        positions=_by_pulse(motion.positions(t)),
        radial_velocity=SPEED_OF_LIGHT / 2 * rate(None),
        doppler=-waveform.f0 * rate(wall),
        phase_label=phase_numbers(motion.phases, t, phases, other=0),
        phases=phases,
        hip_joints=_by_pulse(motion.hip_joints(t)) if isinstance(motion, with_hip_joints) else None,
    )


def _by_pulse(p: Float) -> Float:
    """[3, I, M] as [M, I, 3]."""
    return np.ascontiguousarray(p.transpose(2, 1, 0))
