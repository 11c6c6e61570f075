"""The table of products of a board: channels, cube, frame maps, points, skeletons, signals."""

from collections.abc import Callable, Iterator
from functools import partial
from math import inf
from typing import NamedTuple

import numpy as np

from radhar_cli.assembly.bodies import sources_of, sum_of_paths
from radhar_cli.assembly.physics import (
    board_of,
    detection_of,
    frames_of,
    fsst_frames_of,
    gate_in_windows,
    noise_stream,
    ways_of,
)
from radhar_cli.bodies.motion_paths import point_delay
from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import BoardRadar
from radhar_cli.echo.accuracy import AccuracyError
from radhar_cli.echo.board_cube import exact_cube, fast_cube, mean_power
from radhar_cli.echo.direct import Accuracy
from radhar_cli.echo.paths import PathSource
from radhar_cli.motion.protocol import Motion, cache_motion
from radhar_cli.motion.reflectors import Reflectors
from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.numerics.randomness import NOISE, stream
from radhar_cli.processing.best_points import best_points
from radhar_cli.processing.canceller import NO_CANCELLER, Canceller, MeanRemoval
from radhar_cli.processing.frame_maps import range_angle, range_doppler
from radhar_cli.processing.frame_sheets import cloud_sheet, maps_sheet
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.points import Cloud, board_points
from radhar_cli.processing.range_compression import range_compression
from radhar_cli.processing.signal import Signal
from radhar_cli.processing.track import PulseTrack
from radhar_cli.products.fallback import EchoAccuracy, fall_back
from radhar_cli.products.noise import noise_products, snr_of_other_paths, snr_paths
from radhar_cli.products.plan import Product
from radhar_cli.radar.board import Board
from radhar_cli.radar.room import Leg
from radhar_cli.radar.wall import Wall
from radhar_cli.receiver.noise import WhiteNoise
from radhar_cli.scene import Scene

VELOCITY_STEP_S = 1e-3
NEAR_M = 0.5  # of a point from a joint of the person whose it is


class Echo(NamedTuple):
    """Noiseless echo of a board.

    Attributes:
        cube: samples [frame, loop, virtual, sample].
        power: P_s of a sample, mean over frames, loops and channels.
        accuracy: measured error of the fast sum, or why the exact one was made.
    """

    cube: Complex
    power: float
    accuracy: EchoAccuracy


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


def board_products(c: Config) -> Iterator[Product]:
    """Rows of the table of products that a config with `radar.cfg` has."""
    seen = ("scene", "motions", "board", "wall", *(("room",) if c.room.reflectors else ()))
    still = c.processing.clutter == "mean"
    does = "canceller of each frame"
    yield Product("board", ("scene",), _board_of_scene, "array and chirps")
    yield Product("channels", seen, channels, "paths of every virtual channel")
    made = "sums in matrix products" if c.engine.kind == "direct" else "exact sums"
    inputs: tuple[str, ...] = ("channels", "board", "scene")
    yield Product("echo", inputs, partial(_echo, c), f"raw samples, {made}")
    yield Product("accuracy", ("echo",), lambda echo: echo.accuracy, "its measured error")
    if snr_of_other_paths(c):
        inputs = ("scene", "motions", "board", "wall")
        does = "paths of the own person in every channel, for the SNR"
        yield Product("snr_channels", inputs, partial(_snr_channels, c), does)
        yield Product("signal_power", ("snr_channels", "board"), mean_power, "P_s, for snr_db")
    else:
        yield Product("signal_power", ("echo",), lambda echo: echo.power, "P_s, for snr_db")
    yield from noise_products(c)
    needs = ("echo", "noise", "board", "scene")
    yield Product(
        "cube", needs, _add_impairments, "raw samples with noise and channel errors", is_array=True
    )
    make = partial(range_doppler, remove_mean=still)
    yield Product(
        "range_doppler", ("cube", "board"), make, "range-Doppler maps of the frames", is_array=True
    )
    for axis, name in enumerate(("range_azimuth", "range_elevation")):
        make = partial(range_angle, remove_mean=still, axis=axis)
        yield Product(
            name,
            ("cube", "board"),
            make,
            f"{name.replace('_', '-')} maps of the frames",
            is_array=True,
        )
    chain = f"points of the frames, chain: {c.cloud.chain}"
    yield Product("cloud", ("cube", "board"), partial(_cloud, c), chain)
    yield Product("points", ("cloud",), lambda cloud: cloud.points, "of all frames", is_array=True)
    yield Product(
        "points_start", ("cloud",), lambda cloud: cloud.start, "first of each frame", is_array=True
    )
    yield Product(
        "skeletons", ("scene", "motions", "board"), skeletons_of, "joints in each frame's middle"
    )
    yield Product(
        "skeleton", ("skeletons",), lambda s: s.positions, "positions of joints", is_array=True
    )
    yield Product(
        "skeleton_velocity",
        ("skeletons",),
        lambda s: s.velocities,
        "their velocities",
        is_array=True,
    )
    whose = ("cloud", "skeletons", "board", "scene")
    yield Product("owners", whose, owners_of, "nearest joint of each point, or its image")
    yield Product(
        "points_person", ("owners",), lambda o: o.person, "whose each point is", is_array=True
    )
    yield Product(
        "points_kind", ("owners",), lambda o: o.kind, "by way of which faces", is_array=True
    )
    yield Product("canceller", (), lambda: MeanRemoval() if still else NO_CANCELLER, does)
    yield Product(
        "slow_time",
        ("board_bins",),
        lambda x: x.summed(),
        "sum over range, uncancelled",
        is_array=True,
    )
    yield Product(
        "board_bins", ("cube", "board"), range_bins, "range bins of every channel", is_array=True
    )
    yield Product(
        "range_signals",
        ("cube", "board", "canceller"),
        range_bins,
        "its range bins after the canceller",
        is_array=True,
    )
    yield Product(
        "signal", ("range_signals",), lambda x: x.summed(), "their coherent sum", is_array=True
    )
    width = c.image.size_px[1]
    yield Product(
        "range_profiles",
        ("range_signals",),
        lambda x: x.columns(width),
        "some pulses",
        is_array=True,
    )
    yield Product(
        "torso_track",
        ("motions", "board", "wall"),
        torso_track,
        "delay of the torso",
        is_array=True,
    )
    if c.processing.range_sum == "gated":
        of_gate = ("range_signals", "frames", "torso_track")
        yield Product(
            "gate",
            of_gate,
            lambda after, frames, track: gate_in_windows(
                c, after, frames, PulseTrack(after.t, track)
            ),
            "range bins of each window",
        )
    for name in ("range_doppler", "range_azimuth", "range_elevation"):
        sheet = partial(
            maps_sheet,
            size=c.image.size_px,
            dynamic_range_db=c.image.dynamic_range_db,
        )
        yield Product(f"image:{name}", (name,), sheet, "sheet of frames")
    sheet = partial(cloud_sheet, size=c.image.size_px)
    yield Product("image:points", ("cloud",), sheet, "front views of frames")
    for name, of in (("frames", frames_of), ("fsst_frames", fsst_frames_of)):
        yield Product(name, ("board",), partial(_windows, c, of), "windows, within frames")


def channels(
    scene: Scene,
    motions: tuple[Motion, ...],
    board: Board,
    wall: Wall | None,
    room: Reflectors | None = None,
) -> list[PathSource]:
    """Make the paths of every virtual channel; all are of the same motions, evaluated once.

    Args:
        scene: what is simulated.
        motions: motions of its people, or of parts of one.
        board: the board.
        wall: wall that the paths cross, or None.
        room: what stands in the room.

    Returns:
        The paths of the virtual channels, in the order of `board.pairs`.
    """
    cached_motions = tuple(cache_motion(motion) for motion in motions)
    make = partial(sources_of, scene, cached_motions, first=board.antennas(*board.pairs[0]))
    return [
        sum_of_paths(make(board.antennas(k, r), wall, board.path_waveform, room))
        for k, r in board.pairs
    ]


def _snr_channels(
    c: Config, scene: Scene, motions: tuple[Motion, ...], board: Board, wall: Wall | None
) -> list[PathSource]:
    """Make the paths of every virtual channel whose power is P_s."""
    make = partial(snr_paths, c, scene, (cache_motion(motions[0]),))
    first = board.antennas(*board.pairs[0])
    return [make(board.antennas(k, r), wall, board.path_waveform, first) for k, r in board.pairs]


def _echo(c: Config, sources: list[PathSource], board: Board, scene: Scene) -> Echo:
    """Sum up the paths of all channels: fast within the tolerance, or exactly."""
    accuracy: EchoAccuracy = Accuracy(1, 1, False, -inf)
    if c.engine.kind == "direct":
        try:
            cube, power, error_db = fast_cube(sources, board, c.engine.tolerance_db)
            return Echo(cube, power, Accuracy(1, 1, cube.dtype == np.complex64, error_db))
        except AccuracyError as error:
            accuracy = fall_back(c, scene, error)
    cube, power = exact_cube(sources, board)
    return Echo(cube, power, accuracy)


def _add_impairments(echo: Echo, noise: WhiteNoise, board: Board, scene: Scene) -> Complex:
    """Apply the errors of the channels to a cube, and add noise."""
    receiver = scene.receiver
    cube: Complex = echo.cube
    if receiver.channel_gain_db > 0 or receiver.channel_phase_deg > 0:
        name = "receiver.channel_errors"
        of_data_set = receiver.channel_errors == "data_set"
        rng = (
            stream(scene.config.seed, NOISE, name=name)
            if of_data_set
            else noise_stream(scene, name)
        )
        gain_db, phase = rng.standard_normal((2, board.channels))
        gain_db, phase = gain_db * receiver.channel_gain_db, phase * receiver.channel_phase_deg
        errors = 10 ** (gain_db / 20) * np.exp(1j * np.radians(phase))
        cube = np.multiply(cube, errors[:, None], dtype=cube.dtype, casting="same_kind")
    return noise.added_to(cube, "cube") if noise.sigma > 0 else cube


def _board_of_scene(scene: Scene) -> Board:
    assert isinstance(scene.radar, BoardRadar)
    return board_of(scene.radar, scene.seconds)


def _cloud(c: Config, cube: Complex, board: Board) -> Cloud:
    assert isinstance(c.radar, BoardRadar)
    cloud, detection = c.cloud, detection_of(c.radar, c.processing)
    carrier = board.start if cloud.doppler_carrier == "start" else None
    if cloud.chain == "board":
        return board_points(cube, board, detection, cloud.quantise, carrier)
    still = c.processing.clutter == "mean"
    return best_points(cube, board, still, cloud.pfa, carrier, detection.bias)


def skeletons_of(scene: Scene, motions: tuple[Motion, ...], board: Board) -> Skeletons:
    """Find the joints of everybody; NaN for who is absent, and where one has fewer than another."""
    names, people = motions[0].names, scene.people
    numbers = [one.number for one in people] if len(people) == len(motions) else range(len(motions))
    person_count = max(1 + len(scene.config.people), len(motions))
    shape = (board.frames, person_count, len(names), 3)
    found = np.full((2, *shape), np.nan, np.float32)
    t = board.middles
    for person, motion in zip(numbers, motions, strict=True):
        before, at, after = (
            board.aim.to_radar(motion.positions(t + step))
            for step in (-VELOCITY_STEP_S, 0.0, VELOCITY_STEP_S)
        )
        joints = slice(min(len(names), at.shape[1]))
        found[0, :, person, joints] = at[:, joints].T
        found[1, :, person, joints] = ((after - before) / (2 * VELOCITY_STEP_S))[:, joints].T
    return Skeletons(found[0], found[1], names)


class Owners(NamedTuple):
    """Person whose joint, or image of a joint, is nearest to each point; -1 beyond NEAR_M.

    Attributes:
        person: number of the person [N].
        kind: number of the way by which the joint is seen [N], in `kinds_of` the config.
    """

    person: Index
    kind: Index


def owners_of(cloud: Cloud, skeletons: Skeletons, board: Board, scene: Scene) -> Owners:
    """Find the person and the way by which each point is seen."""
    frame = np.repeat(np.arange(len(cloud.start) - 1), np.diff(cloud.start))
    best = np.full(len(frame), np.inf)
    owners = Owners(*np.full((2, len(frame)), -1, np.int16))
    for kind, legs in enumerate([None, *ways_of(scene)]):
        joints = skeletons.positions if legs is None else _apparent(skeletons, board, legs)
        apart = joints[frame] - cloud.points[:, None, None, :3]
        square = np.nan_to_num((apart**2).sum(axis=-1), nan=np.inf)
        distance = np.sqrt(square).min(axis=2, initial=np.inf)  # [N, person]
        nearest = distance.min(axis=1)
        nearer = (nearest < best) & (nearest <= NEAR_M)
        owners.person[nearer], owners.kind[nearer] = distance.argmin(axis=1)[nearer], kind
        best = np.minimum(best, nearest)
    return owners


def _apparent(skeletons: Skeletons, board: Board, legs: tuple[Leg, Leg]) -> Float:
    """Joints as skeletons have them, about where echoes by way of faces seem to come from.

    The range is half of both legs. TI's arrays have their receivers in a row and a raised
    transmitter: the azimuth is about that of the receiver's leg, the elevation the transmitter's.
    """
    radar_position, axes = np.array(board.position), np.array(board.aim.axes)
    p = (skeletons.positions @ axes + radar_position).T
    images = [way.image(p).T - radar_position for way in legs]
    lengths = [np.linalg.norm(one, axis=-1, keepdims=True) for one in images]
    tx, rx = (one / length @ axes.T for one, length in zip(images, lengths, strict=True))
    left, up = rx[..., 1], tx[..., 2]
    ahead = np.sqrt(np.maximum(1 - left**2 - up**2, 0))
    apparent: Float = 0.5 * (lengths[0] + lengths[1]) * np.stack([ahead, left, up], axis=-1)
    return apparent


def range_bins(cube: Complex, board: Board, canceller: Canceller = NO_CANCELLER) -> Signal:
    """Compute the range bins of every virtual channel, pulse by pulse.

    Args:
        cube: raw samples [frame, loop, virtual, sample].
        board: board of the cube.
        canceller: canceller of every channel.

    Returns:
        The bins [virtual, bin, pulse].

    Raw samples go through the canceller, not bins: nothing is left then of what stands still.
    """
    w = board.waveform
    x = np.empty((board.channels, w.n_bins, board.frames * board.loops), cube.dtype)
    for v in range(board.channels):
        samples = cube[:, :, v].reshape(-1, board.samples).T * board.signs[v]
        s = Signal(samples[None], board.pulses, w.f0).cancelled(canceller).x[0]
        x[v] = range_compression(s, w)
    return Signal(x, board.pulses, w.f0, w.range_axis(), range_step=w.range_step)


def torso_track(motions: tuple[Motion, ...], board: Board, wall: Wall | None) -> Float:
    """Compute the delay of the first person's torso at every pulse of a channel [M], s."""
    t = board.pulses.times(np.arange(board.frames * board.loops))
    track: Float = point_delay(motions[0].torso(t), board.antennas(*board.pairs[0]), wall)[0]
    return track


def _windows(c: Config, of: Callable[..., Frames], board: Board) -> Frames:
    """Windows of the Doppler maps: within frames, one of each where frames have gaps between."""
    ungapped = of(c, board.frames * board.period, 1 / board.loop, board.centre)
    length = min(ungapped.length, board.loops)
    gaps = len(board.pulses) > 1
    return Frames(length, board.loops if gaps else min(ungapped.hop, length))
