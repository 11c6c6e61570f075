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
BLOCK = 2**14  # pulses at once


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
    count, joints = t.size, len(motion.names)
    positions, velocity, doppler = np.empty((count, joints, 3)), *np.empty((2, count, joints))
    with_hips = motion if isinstance(motion, HumanMotion | FileMotion) else None
    hips = None if with_hips is None else np.empty((count, 2, 3))
    for first in range(0, count, BLOCK):  # each step below takes several times what it leaves
        block = slice(first, first + BLOCK)
        positions[block] = motion.positions(t[block]).transpose(2, 1, 0)
        rate, rate_with_wall = _rates(motion, antennas, wall, t[block])
        velocity[block] = SPEED_OF_LIGHT / 2 * rate
        doppler[block] = -waveform.f0 * rate_with_wall
        if hips is not None and with_hips is not None:
            hips[block] = with_hips.hip_joints(t[block]).transpose(2, 1, 0)
    phases = tuple(dict.fromkeys((WHOLE, *(name for _, name in motion.phases))))
    return Truth(
        time=t,
        positions=positions,
        radial_velocity=velocity,
        doppler=doppler,
        phase_label=phase_numbers(motion.phases, t, phases, other=0),
        phases=phases,
        hip_joints=hips,
    )


def _rates(motion: Motion, antennas: Antennas, wall: Wall | None, t: Float) -> tuple[Float, Float]:
    """d tau/dt [M, I] at times t [M] (s) by a central difference, without and with the wall."""
    late, early = (motion.positions(t + step) for step in (RATE_STEP_S, -RATE_STEP_S))

    def rate(slab: Wall | None) -> Float:
        change = point_delay(late, antennas, slab) - point_delay(early, antennas, slab)
        return change.T / (2 * RATE_STEP_S)

    in_air = rate(None)
    return in_air, in_air if wall is None else rate(wall)
