"""stickman.gif: the joints from three sides, beside a Doppler-time map with a moving cursor."""

from pathlib import Path

import numpy as np

from radhar_cli.figures.maps_panel import draw_map, of_simulation, title
from radhar_cli.figures.sides import Advance, Film, StillView, limbs
from radhar_cli.figures.style import joint_colours
from radhar_cli.numerics.arrays import Float
from radhar_cli.scene.single.simulate import Simulation
from radhar_cli.scene.single.truth import WHOLE
from radhar_cli.schema.number import Number, nominal

FRAMES_PER_SECOND = 20
SHOWN_BESIDE = ("stft", "fsst", "stft_compensated", "rtm")
MARGIN_M = 0.15


def frame_count(simulation: Simulation) -> int:
    """Number of frames of the animation at true speed."""
    return max(2, round(simulation.waveform.duration * FRAMES_PER_SECOND))


def draw_stickman(simulation: Simulation, path: Path, advance: Advance) -> None:
    """Write the animation; near views follow a person who is alone, and else show everybody.

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
    tracks = [person.positions for person, _ in people] or [np.zeros((1, 1, 3))]
    around = still_view_of(simulation)
    wide = np.concatenate([_corners(p) for p in tracks])
    near = _corners(tracks[0] - middle[:, None]) if alone else wide
    fastest = max(float(np.nan_to_num(np.abs(truth.radial_velocity)).max()), 0.1)
    colours = joint_colours(simulation.motion.names)
    limits = near_limits(near), wide_limits(wide, around)
    film = Film(title(simulation), *limits, fastest, colours, around, share=0.7)
    cursor = []
    map_names = [name for name in SHOWN_BESIDE if name in simulation.maps] or list(simulation.maps)
    if map_names:
        axes = film.figure.add_axes((0.78, 0.16, 0.16, 0.7))
        draw_map(axes, map_names[0], of_simulation(simulation, overlay=False))
        cursor.append(axes.axvline(0, color="white", linewidth=1))

    def show(frame: int) -> None:
        t = frame / FRAMES_PER_SECOND
        pulse = int(np.searchsorted(truth.time, t).clip(max=truth.time.size - 1))
        lines = []
        for person, motion in people:
            hips = None if person.hip_joints is None else person.hip_joints[pulse]
            lines.append(limbs(person.positions[pulse], motion.parents, hips))
        phase = truth.phases[truth.phase_label[pulse]]
        clock = f"t = {t:.2f} s" + ("" if phase == WHOLE else f"   {phase}")
        ends = np.concatenate([np.empty((0, 2, 3)), *lines])
        speeds = -truth.radial_velocity[pulse]
        film.show(truth.positions[pulse], speeds, ends, clock, middle[pulse])
        for line in cursor:
            line.set_xdata([t, t])

    count, frame_ms = frame_count(simulation), 1000 // FRAMES_PER_SECOND
    film.write(path, show, count, frame_ms, advance, others=cursor)


def still_view_of(simulation: Simulation) -> StillView:
    """Radar, floor, wall and room of a scene."""
    antennas, wall = simulation.antennas, simulation.wall
    room = simulation.scene.config.room
    boxes = [] if wall is None else [wall.bounds[:2]]
    if room.faces is not None and room.box_m is not None:
        boxes.append((_numbers(room.box_m.x), _numbers(room.box_m.y)))
    corners = [
        np.array([(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1]), (x[0], y[0])])
        for x, y in boxes
    ]
    radar = np.mean([antennas.tx, antennas.rx], axis=0)
    return StillView(radar.tolist(), 0.0, corners)


def _numbers(ends: tuple[Number, Number]) -> tuple[float, float]:
    """Ends that a scene has drawn, as numbers."""
    return float(nominal(ends[0])), float(nominal(ends[1]))


def _corners(places: Float) -> Float:
    """Lowest and highest coordinates [2, 3] of places [..., 3]."""
    flat = places.reshape(-1, 3)
    return np.stack([np.nanmin(flat, axis=0), np.nanmax(flat, axis=0)])


def near_limits(places: Float) -> Float:
    """Limits [3, 2] (m) of places [n, 3]: a cube that stands where they are lowest."""
    low, high = np.nanmin(places, axis=0) - MARGIN_M, np.nanmax(places, axis=0) + MARGIN_M
    side = max(1.6, *(high - low))
    middle = (low + high) / 2
    start = np.array([*(middle[:2] - side / 2), low[2]])
    return np.stack([start, start + side], axis=1)


def wide_limits(places: Float, around: StillView) -> Float:
    """Limits [3, 2] (m) of places [n, 3], of the radar and of walls, as seen from above."""
    walls = [np.insert(outline, 2, 0.0, axis=1) for outline in around.outlines]
    places = np.concatenate([places, [around.radar], *walls])
    low, high = np.nanmin(places, axis=0) - 2 * MARGIN_M, np.nanmax(places, axis=0) + 2 * MARGIN_M
    half = max(1.0, *((high - low)[:2] / 2))
    centre = (low + high) / 2
    return np.stack([centre - half, centre + half], axis=1)
