"""stickman.gif: the joints from three sides, beside a Doppler-time map with a moving cursor."""

from pathlib import Path

import numpy as np

from radhar_cli.figures.maps_panel import draw_map, of_simulation, title
from radhar_cli.figures.sides import Advance, Film, limbs
from radhar_cli.scene.single.simulate import Simulation
from radhar_cli.scene.single.truth import WHOLE

FRAMES_PER_SECOND = 20
SHOWN_BESIDE = ("stft", "fsst", "stft_compensated", "rtm")


def frame_count(simulation: Simulation) -> int:
    """Number of frames of the animation at true speed."""
    return max(2, round(simulation.waveform.duration * FRAMES_PER_SECOND))


def draw_stickman(simulation: Simulation, path: Path, advance: Advance) -> None:
    """Write the animation; it follows a person who is alone, and else shows everybody's places.

    Args:
        simulation: the scene.
        path: GIF file to write.
        advance: called with 1 after every frame.
    """
    truth = simulation.truth
    people = [] if simulation.scene.is_empty else [(truth, simulation.motion)]
    people += [(other.truth, other.motion) for other in simulation.others]
    alone = len(people) == 1
    middle = np.nan_to_num(truth.positions.mean(axis=1)) * (alone, alone, 0)
    tracks = [joint for person, _ in people for joint in person.positions.swapaxes(0, 1)]
    bounds = [((p - middle).min(axis=0), (p - middle).max(axis=0)) for p in tracks]
    bounds = bounds or [(np.zeros(3), np.zeros(3))]  # nobody is there
    low = np.min([least for least, _ in bounds], axis=0) - 0.1
    high = np.max([most for _, most in bounds], axis=0) + 0.1
    centre = np.round((low + high) / 2) * (1, 1, 0)
    low = np.minimum(low, centre - (1, 1, 0))
    high = np.maximum(high, np.add(centre, (1, 1, 2)))
    limits = np.stack([low, high], axis=1)
    fastest = max(float(np.nan_to_num(np.abs(truth.radial_velocity)).max()), 0.1)
    film = Film(title(simulation), limits, fastest, share=0.7)
    cursor = []
    map_names = [name for name in SHOWN_BESIDE if name in simulation.maps] or list(simulation.maps)
    if map_names:
        axes = film.figure.add_axes((0.76, 0.14, 0.18, 0.7))
        draw_map(axes, map_names[0], of_simulation(simulation, overlay=False))
        cursor.append(axes.axvline(0, color="white", linewidth=1))

    def show(frame: int) -> None:
        t = frame / FRAMES_PER_SECOND
        pulse = int(np.searchsorted(truth.time, t).clip(max=truth.time.size - 1))
        lines = []
        for person, motion in people:
            hips = None if person.hip_joints is None else person.hip_joints[pulse]
            lines.append(limbs(person.positions[pulse], motion.parents, hips))
        centre_now, phase = middle[pulse], truth.phases[truth.phase_label[pulse]]
        clock = f"t = {t:.2f} s"
        clock += f", at x = {centre_now[0]:.1f} m, y = {centre_now[1]:.1f} m" if alone else ""
        clock += "" if phase == WHOLE else f"   {phase}"
        joints = truth.positions[pulse] - centre_now
        ends = np.concatenate([np.empty((0, 2, 3)), *lines]) - centre_now
        film.show(joints, -truth.radial_velocity[pulse], ends, clock)
        for line in cursor:
            line.set_xdata([t, t])

    count, frame_ms = frame_count(simulation), 1000 // FRAMES_PER_SECOND
    film.write(path, show, count, frame_ms, advance, others=cursor)
