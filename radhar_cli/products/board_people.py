"""Skeletons of the people before a board, and whose each of its points is."""

from typing import NamedTuple

import numpy as np

from radhar_cli.assembly.room import ways_of
from radhar_cli.motion.protocol import Motion
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.processing.points import Cloud
from radhar_cli.radar.board import Board
from radhar_cli.radar.room import Leg
from radhar_cli.scene import Scene

VELOCITY_STEP_S = 1e-3
NEAR_M = 0.5  # of a point from a joint of the person whose it is


class Skeletons(NamedTuple):
    """Joints of everybody in the middle of each frame's chirps, as the radar sees them.

    Attributes:
        positions: positions [frame, person, joint, (ahead, left, up)], m; NaN of who is absent.
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
        kind: number of the legs by which the joint is seen [N], in `kinds_of` the config.
    """

    person: Index
    kind: Index


def locate_skeletons(scene: Scene, motions: tuple[Motion, ...], board: Board) -> Skeletons:
    """Locate the joints of everybody; NaN of who is absent, and of joints that one lacks.

    In an empty scene all are NaN.

    Args:
        scene: what is simulated.
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


def positions_of(skeletons: Skeletons) -> Float:
    """Positions of the joints [frame, person, joint, 3], m."""
    return skeletons.positions


def velocities_of(skeletons: Skeletons) -> Float:
    """Velocities of the joints [frame, person, joint, 3], m/s."""
    return skeletons.velocities


def assign_points(cloud: Cloud, skeletons: Skeletons, board: Board, scene: Scene) -> Owners:
    """Assign each point to the person with the nearest joint, and to the legs that it is seen by.

    Args:
        cloud: points of all frames.
        skeletons: joints in the middle of each frame.
        board: board that sees them.
        scene: scene, whose room has faces by way of which people are seen again.
    """
    frame = np.repeat(np.arange(len(cloud.start) - 1), np.diff(cloud.start))
    best = np.full(len(frame), np.inf)
    owners = Owners(*np.full((2, len(frame)), -1, np.int16))
    for kind, legs in enumerate([None, *ways_of(scene)]):
        joints = skeletons.positions if legs is None else _mirror_joints(skeletons, board, legs)
        offset = joints[frame] - cloud.points[:, None, None, :3]
        square = np.nan_to_num((offset**2).sum(axis=-1), nan=np.inf)
        distance = np.sqrt(square).min(axis=2, initial=np.inf)  # [N, person]
        nearest = distance.min(axis=1)
        nearer = (nearest < best) & (nearest <= NEAR_M)
        owners.person[nearer] = distance.argmin(axis=1)[nearer]
        owners.kind[nearer] = kind
        best = np.minimum(best, nearest)
    return owners


def persons_of(owners: Owners) -> Index:
    """Number of the person whose each point is [N]."""
    return owners.person


def kinds_of_points(owners: Owners) -> Index:
    """Number of the legs by which each point is seen [N]."""
    return owners.kind


def _mirror_joints(skeletons: Skeletons, board: Board, legs: tuple[Leg, Leg]) -> Float:
    """Place joints about where echoes by way of faces seem to come from, as skeletons have them.

    The range is half of both legs. TI's arrays have their receivers in a row and a raised
    transmitter: the azimuth is about that of the receiver's leg, the elevation the transmitter's.
    """
    radar_position, axes = np.array(board.position), np.array(board.aim.axes)
    p = (skeletons.positions @ np.array(board.upright.axes) + radar_position).T
    images = [leg.image(p).T - radar_position for leg in legs]
    lengths = [np.linalg.norm(image, axis=-1, keepdims=True) for image in images]
    tx, rx = (image / length @ axes.T for image, length in zip(images, lengths, strict=True))
    left, up = rx[..., 1], tx[..., 2]
    ahead = np.sqrt(np.maximum(1 - left**2 - up**2, 0))
    mirrored: Float = 0.5 * (lengths[0] + lengths[1]) * np.stack([ahead, left, up], axis=-1)
    return board.without_roll(mirrored)
