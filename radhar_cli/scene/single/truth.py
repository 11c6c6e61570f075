"""True motion: positions, radial velocities, and the movement under way."""

from collections import Counter
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from radhar_cli.echo.bodies.motion_paths import point_delay
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.phases import phase_numbers
from radhar_cli.motion.protocol import Motion
from radhar_cli.motion.recorded.motion import FileMotion
from radhar_cli.numerics.arrays import Float, Index, Levels
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT, Waveform
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.room import Leg, names_of
from radhar_cli.radar.wall import Wall
from radhar_cli.scene.paths import OwnedPaths

RATE_STEP_S = 1e-5
WHOLE = "the whole activity"
BLOCK = 2**14  # pulses at once


@dataclass(frozen=True)
class Truth:
    """Kinematics of one person at every pulse, or at other times.

    Attributes:
        time: times t_m [M], s.
        positions: positions of the scatterers [M, I, 3], m; NaN in an empty scene, as are the
            other numbers.
        radial_velocity: half the rate of the two-way path [M, I], m/s, positive receding.
        doppler: -f0 dtau/dt [M, I], Hz, with the wall, before aliasing.
        phase_label: number in `phases` of the movement that is under way [M].
        phases: names of the movements within the activity.
        hip_joints: places where thighs begin, right and left [M, 2, 3], m; None at the hip.
        aspect: angle [M] (rad) from where the person faces to one of several radars, positive where
            it is to their left; None with a radar alone.
    """

    time: Float = field(repr=False)
    positions: Float = field(repr=False)
    radial_velocity: Float = field(repr=False)
    doppler: Float = field(repr=False)
    phase_label: Levels = field(repr=False)
    phases: tuple[str, ...]
    hip_joints: Float | None = field(default=None, repr=False)
    aspect: Float | None = field(default=None, repr=False)


class PathTruth(NamedTuple):
    """Every path of a scene: of everybody, straight and by way of the room.

    Attributes:
        time: times of the pulses that a range-time map shows [M], s.
        delay: two-way delays [I, M], s.
        amplitude: amplitudes [I, M], for unit transmit power.
        kind: faces that the transmitter's leg and the receiver's leg meet, as "floor/-" [I].
        person: number of the person [I]; -1 is the things in the room.
        scatterer: number of the scatterer among those of the person [I].
        bounces: number of faces that both legs meet [I].
    """

    time: Float
    delay: Float
    amplitude: Float
    kind: list[str]
    person: Index
    scatterer: Index
    bounces: Index


def evaluate_path_truth(sources: list[OwnedPaths], t: Float) -> PathTruth:
    """Evaluate the paths of all sources, I in all, at times t [M] (s)."""
    paths = [owned.source(t) for owned in sources]
    counts = [len(path.delay) for path in paths]
    next_scatterer = Counter[tuple[int, tuple[Leg, Leg]]]()  # of a person by these legs
    scatterers = []
    for owned, count in zip(sources, counts, strict=True):
        person_and_legs = owned[1:]
        first = next_scatterer[person_and_legs]
        scatterers.append(np.arange(first, first + count))
        next_scatterer[person_and_legs] += count
    bounces = [sum(len(leg.faces) for leg in owned.legs) for owned in sources]
    return PathTruth(
        t,
        np.concatenate([path.delay for path in paths]),
        np.concatenate([path.amplitude for path in paths]),
        np.repeat([names_of(owned.legs) for owned in sources], counts).tolist(),
        np.repeat([owned.person for owned in sources], counts),
        np.concatenate(scatterers),
        np.repeat(bounces, counts),
    )


def evaluate_truth(
    motion: Motion,
    antennas: Antennas,
    wall: Wall | None,
    waveform: Waveform,
    t: Float | None = None,
) -> Truth:
    """Evaluate the kinematics of all scatterers of a motion.

    Args:
        antennas: antennas that velocities and Dopplers are seen by.
        wall: wall that the Doppler includes, or None.
        waveform: waveform whose f0 scales the Doppler.
        t: times [M], s; None for every pulse of the waveform.
    """
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


def truth_of_nobody(truth: Truth, slug: str) -> Truth:
    """Truth of an empty scene: every number is NaN, and the one phase that of its class.

    Args:
        truth: truth of a person who would be there, of which times and shapes are kept.
        slug: name of the class.
    """
    return replace(
        truth,
        positions=np.full_like(truth.positions, np.nan),
        radial_velocity=np.full_like(truth.radial_velocity, np.nan),
        doppler=np.full_like(truth.doppler, np.nan),
        hip_joints=None if truth.hip_joints is None else np.full_like(truth.hip_joints, np.nan),
        phase_label=np.zeros_like(truth.phase_label),
        aspect=None if truth.aspect is None else np.full_like(truth.aspect, np.nan),
        phases=(slug,),
    )


def _rates(motion: Motion, antennas: Antennas, wall: Wall | None, t: Float) -> tuple[Float, Float]:
    """Rates d tau/dt [M, I] at times t [M] (s), a central difference, without and with the wall."""
    late, early = (motion.positions(t + step) for step in (RATE_STEP_S, -RATE_STEP_S))

    def rate(slab: Wall | None) -> Float:
        change = point_delay(late, antennas, slab) - point_delay(early, antennas, slab)
        return change.T / (2 * RATE_STEP_S)

    in_air = rate(None)
    return in_air, in_air if wall is None else rate(wall)
