"""Parts of the page of a scene besides maps: skeletons in motion, true Doppler, the radar."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.echo.bodies.motion_paths import point_delay
from radhar_cli.figures.sides import limbs
from radhar_cli.motion.protocol import Motion
from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import Scene
from radhar_cli.scene.single.truth import evaluate_truth

FRAMES_PER_SECOND, MAX_FRAMES = 25, 600
FINER = 4  # points of a Doppler curve a frame


class MovingBody(NamedTuple):
    """A person: name, names of joints, bones (x, y, z, approaching speed) [time, joint, 2, 4]."""

    name: str
    joints: Sequence[str]
    bones: Float


class SceneView(NamedTuple):
    """View of a scene besides its maps: bodies, true Doppler and the radar."""

    time: Float  # at which something is shown, s
    bodies: Sequence[MovingBody] = ()
    axes: Sequence[str] = ("x, range (m)", "y, cross-range (m)", "z, height (m)")
    radar: Any = ((0.0, 0.0, 0.0),)  # places of antennas, m
    curves: Mapping[str, Float] = {}  # true Doppler of joints, the torso's first, Hz
    prf: float = 1.0  # pulse repetition frequency, into which the curves are aliased, Hz
    hertz: float = 0.0  # Doppler of 1 m/s, 0 where it is not known
    farthest: float = np.inf  # range that maps show, m


def view_scene(scene: Scene, motions: Sequence[Motion]) -> SceneView:
    """Compute the view of a scene: everybody's skeleton and true Doppler, in order of `motions`.

    An empty scene has no skeletons; maps reach as far as with a person who would stand there.
    """
    results = record(scene, ("antennas", "wall", "waveform"), motions=tuple(motions))
    antennas, wall, waveform = results["antennas"], results["wall"], results["waveform"]
    last_pulse = np.array([waveform.n_pulses - 1.0])
    time = frame_times(0, float(waveform.times(last_pulse)[0]))
    fine = np.linspace(0, time[-1], FINER * (time.size - 1) + 1)
    bodies, curves, farthest = list[MovingBody](), dict[str, Float](), 0.0
    for person, motion in zip(scene.people, motions, strict=True):
        true = evaluate_truth(motion, antennas, wall, waveform, fine)
        delays = point_delay(true.positions.T, antennas, wall)
        farthest = max(farthest, delays.max() * SPEED_OF_LIGHT / 2)
        if scene.is_empty:
            break
        joints = np.concatenate([true.positions, -true.radial_velocity[..., None]], axis=2)
        bones = limbs(joints, motion.parents, true.hip_joints)[::FINER]
        name = f"{person.activity.label} {person.activity.slug}"
        bodies.append(MovingBody(name, motion.names, bones))
        prefix = f"{person.number} " if len(motions) > 1 else ""
        curves |= {prefix + joint: true.doppler[:, n] for n, joint in enumerate(motion.names)}
    return SceneView(
        time,
        bodies,
        radar=(antennas.tx, antennas.rx),
        curves=curves,
        prf=waveform.prf,
        hertz=2 * waveform.f0 / SPEED_OF_LIGHT,
        farthest=1.3 * farthest + 0.5,
    )


def frame_times(start: float, end: float) -> Float:
    """Times from `start` to `end` at which the page shows something, s."""
    return np.linspace(start, end, min(int((end - start) * FRAMES_PER_SECOND) + 2, MAX_FRAMES))
