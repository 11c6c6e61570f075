"""Skeletons of the people before a board, and whose each of its points is."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from radhar_cli.motion.protocol import Motion
from radhar_cli.numerics.arrays import Bool, Complex, Float, Index
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.processing.points import Cloud
from radhar_cli.radar.board import Board, longest_rows
from radhar_cli.radar.room import DIRECT_LEG, Leg
from radhar_cli.scene.room import ways_of
from radhar_cli.scene.scene import Scene

VELOCITY_STEP_S = 1e-3
NEAR_M = 0.5  # of a point from a joint of the person whose it is
BEAMS = 65  # in which ghosts are looked for, from the right to the left
LOBES = 4  # of a ghost that count
LEAST_LOBE = 0.1  # power of a lobe over the strongest


class Skeletons(NamedTuple):
    """Joints of everybody in the middle of each frame's chirps, as the radar sees them.

    Attributes:
        positions: positions [frame, person, joint, (ahead, left, up)], m; NaN of an absent person.
        velocities: velocities of the same shape, m/s.
        names: names of the joints.
    """

    positions: Float
    velocities: Float
    names: tuple[str, ...]


class Owners(NamedTuple):
    """Person whose joint, or image of a joint, is nearest to each point; -1 beyond NEAR_M.

    Attributes:
        person: number of the person [N].
        kind: number of the legs by which the joint is seen [N], in `names_of_ways` of the scene.
    """

    person: Index
    kind: Index


def locate_skeletons(scene: Scene, motions: tuple[Motion, ...], board: Board) -> Skeletons:
    """Locate the joints of everybody; NaN of a person who is absent, and of joints that one lacks.

    In an empty scene all are NaN.

    Args:
        motions: motions of its people, or of parts of one; the first names the joints.
        board: board that sees them.
    """
    names, people = motions[0].names, scene.people
    one_motion_per_person = len(people) == len(motions)
    numbers = [person.number for person in people] if one_motion_per_person else range(len(motions))
    person_count = max(1 + len(scene.config.people), len(motions))
    shape = (board.frames, person_count, len(names), 3)
    positions, velocities = np.full((2, *shape), np.nan, np.float32)
    t = board.middles
    if scene.is_empty:
        return Skeletons(positions, velocities, names)
    for number, motion in zip(numbers, motions, strict=True):
        before, now, after = (
            board.upright.to_radar(motion.positions(t + step))
            for step in (-VELOCITY_STEP_S, 0.0, VELOCITY_STEP_S)
        )
        joints = slice(min(len(names), now.shape[1]))
        speeds = (after - before) / (2 * VELOCITY_STEP_S)
        positions[:, number, joints] = now[:, joints].T
        velocities[:, number, joints] = speeds[:, joints].T
    return Skeletons(positions, velocities, names)


def assign_points(cloud: Cloud, skeletons: Skeletons, board: Board, scene: Scene) -> Owners:
    """Assign each point to the person with the nearest joint, and to the legs that it is seen by.

    Args:
        cloud: points of all frames.
        skeletons: joints in the middle of each frame.
        board: board that sees them.
        scene: scene, whose room has faces by way of which people are seen again.
    """
    frame = np.repeat(np.arange(len(cloud.start) - 1), np.diff(cloud.start))
    best, n = np.full(len(frame), np.inf), np.arange(len(frame))
    owners = Owners(*np.full((2, len(frame)), -1, np.int16))
    ways: list[tuple[Leg, Leg]] = [(DIRECT_LEG, DIRECT_LEG), *ways_of(scene)]
    joints = _to_scene(skeletons.positions, board)
    in_board_axes = board.aim.to_radar(_to_scene(cloud.points[:, :3], board)).T
    for kind, legs in enumerate(ways):
        if legs[::-1] in ways[:kind]:  # the same echo the other way round
            continue
        if legs[0] == legs[1]:
            mirrored = board.upright.to_radar(legs[0].image(joints)).T
            image = mirrored if kind else skeletons.positions
            offset = image[frame] - cloud.points[:, None, None, :3]
            distance = np.sqrt((offset**2).sum(axis=-1))
            is_reversed = np.zeros(distance.shape, bool)
        else:
            places = ApparentPlaces.of(joints, board, legs)
            distance, is_reversed = places.distances(in_board_axes, frame)
        distance = np.nan_to_num(distance, nan=np.inf)
        flat = distance.reshape(len(frame), -1).argmin(axis=1) if len(frame) else n
        person, joint = np.unravel_index(flat, distance.shape[1:])
        nearest = distance[n, person, joint]
        nearer = (nearest < best) & (nearest <= NEAR_M)
        other_kind = ways.index(legs[::-1])
        kinds = np.where(is_reversed[n, person, joint], other_kind, kind)
        owners.person[nearer], owners.kind[nearer] = person[nearer], kinds[nearer]
        best = np.minimum(best, nearest)
    return owners


@dataclass(frozen=True)
class ApparentPlaces:
    """Apparent places of joints that transmitter and receiver see in two directions.

    The echo by legs a, b and that by b, a have the same range and Doppler, and superpose. Neither
    is a plane wave to the virtual array, whose phases are those of the transmitters by one
    direction and of the receivers by the other: it has several lobes along azimuth, most of them in
    none of the two directions. Elevations are arbitrary.

    Attributes:
        range: half of both legs [frame, person, joint], m.
        left: direction sines to the left of the lobes [frame, person, joint, LOBES]; NaN of none.
        is_reversed: whether a lobe is rather of the legs b, a [frame, person, joint, LOBES].
    """

    range: Float
    left: Float
    is_reversed: Bool

    @classmethod
    def of(cls, joints: Float, board: Board, legs: tuple[Leg, Leg]) -> "ApparentPlaces":
        """Compute what the longest row of a board sees of joints.

        Args:
            joints: positions [3, joint, person, frame] in the scene, m.
            legs: legs a of the transmitter, b of the receiver.
        """
        images = [leg.image(joints).T for leg in legs]  # [frame, person, joint, 3]
        row, sines = longest_rows(board.places, 0)[0], np.linspace(-1, 1, BEAMS)
        beams = np.exp(-1j * np.pi * np.outer(board.places[row, 0], sines))
        forward, backward = (
            _echo_of_row(tx, rx, board, row) @ beams for tx, rx in (images, images[::-1])
        )
        power = np.abs(forward + backward) ** 2
        beside = np.pad(power, [(0, 0)] * 3 + [(1, 1)])
        is_lobe = (power >= beside[..., :-2]) & (power >= beside[..., 2:])
        is_lobe &= power > LEAST_LOBE * power.max(axis=-1, keepdims=True)
        bins = np.argsort(np.where(is_lobe, -power, 0), axis=-1)[..., :LOBES]
        left = np.where(np.take_along_axis(is_lobe, bins, axis=-1), sines[bins], np.nan)
        is_reversed = np.take_along_axis(np.abs(backward) > np.abs(forward), bins, axis=-1)
        lengths = [np.linalg.norm(image - np.array(board.position), axis=-1) for image in images]
        return cls((lengths[0] + lengths[1]) / 2, left, is_reversed)

    def distances(self, points: Float, frame: Index) -> tuple[Float, Bool]:
        """Distances of points from the nearest lobe of joints, along range and azimuth.

        Args:
            points: ahead, left and up of the board [N, 3], m.
            frame: frame of each point [N].

        Returns:
            Distances [N, person, joint], m, NaN without a lobe, and `is_reversed` of those lobes.
        """
        ranges = np.linalg.norm(points, axis=1)
        sines = points[:, 1] / np.maximum(ranges, np.finfo(float).tiny)
        aside = np.abs(self.left[frame] - sines[:, None, None, None])
        lobe = np.nan_to_num(aside, nan=np.inf).argmin(axis=-1)[..., None]
        aside = np.take_along_axis(aside, lobe, axis=-1)[..., 0] * ranges[:, None, None]
        along = self.range[frame] - ranges[:, None, None]
        is_reversed = np.take_along_axis(self.is_reversed[frame], lobe, axis=-1)[..., 0]
        return np.hypot(along, aside), is_reversed


def _echo_of_row(tx_images: Float, rx_images: Float, board: Board, row: list[int]) -> Complex:
    """Echo [frame, person, joint, element] of joints that a row of elements sees.

    Args:
        tx_images: places where the transmitters see joints [frame, person, joint, 3], m.
        rx_images: places where the receivers see them.
        row: numbers of its virtual elements.
    """
    echoes = []
    for k, r in (board.pairs[v] for v in row):
        antennas = board.antennas(k, r)
        length = np.linalg.norm(tx_images - antennas.tx, axis=-1)
        length += np.linalg.norm(rx_images - antennas.rx, axis=-1)
        echoes.append(np.exp(-2j * np.pi * board.centre_hz / SPEED_OF_LIGHT * length))
    return np.stack(echoes, axis=-1)


def _to_scene(positions: Float, board: Board) -> Float:
    """Positions [3, ...] in the scene of those [..., 3] of points and skeletons, m."""
    in_scene: Float = (positions @ np.array(board.upright.axes) + np.array(board.position)).T
    return in_scene
