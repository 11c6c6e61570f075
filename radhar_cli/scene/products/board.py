"""Products of a board: channels, cube, frame maps, points, skeletons, and Doppler maps' signals."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from math import inf, sqrt
from operator import attrgetter, methodcaller
from typing import NamedTuple

import numpy as np

from radhar_cli.config.cloud import CloudConfig
from radhar_cli.config.data_set import AnyConfig, Config
from radhar_cli.config.maps import FRAME_MAPS
from radhar_cli.config.radar import ArrayRadar, BoardRadar
from radhar_cli.echo.accuracy import AccuracyError
from radhar_cli.echo.board_cube import (
    combine_transmitters,
    exact_cube,
    fast_cube,
    mean_power,
    still_samples,
)
from radhar_cli.echo.bodies.motion_paths import point_delay
from radhar_cli.echo.direct import Accuracy
from radhar_cli.echo.face_echoes import echoes_of_faces
from radhar_cli.echo.paths import PathSource
from radhar_cli.echo.receiver.noise import WhiteNoise
from radhar_cli.motion.protocol import Motion, cache_motion
from radhar_cli.motion.reflectors import Reflectors
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.numerics.randomness import NOISE, stream
from radhar_cli.processing.angle_time import ANGLE_TIME_KINDS, angle_time
from radhar_cli.processing.best_points import best_points
from radhar_cli.processing.canceller import NO_CANCELLER, Canceller
from radhar_cli.processing.cloud_limits import keep_in_box, keep_in_view
from radhar_cli.processing.frame_maps import FRAME_MAP_KINDS, FrameMapKind, FrameMaps
from radhar_cli.processing.frame_sheets import cloud_sheet, maps_sheet
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.gate import Gate
from radhar_cli.processing.people_tracking.chain import track_people
from radhar_cli.processing.people_tracking.counting import count_people
from radhar_cli.processing.points import Cloud, board_points
from radhar_cli.processing.range_compression import range_compression
from radhar_cli.processing.signal import Signal
from radhar_cli.processing.track import PulseTrack
from radhar_cli.radar.board import Board
from radhar_cli.radar.chirp_window import RECTANGULAR, ChirpWindow
from radhar_cli.radar.detection import Detection
from radhar_cli.radar.people_tracking import PeopleCounting, PeopleTracking
from radhar_cli.radar.wall import Wall
from radhar_cli.scene.paths import Link, make_path_sources, sum_of_paths
from radhar_cli.scene.products.board_people import (
    assign_points,
    locate_skeletons,
)
from radhar_cli.scene.products.fallback import EchoAccuracy, fall_back
from radhar_cli.scene.products.gated import gate_in_windows
from radhar_cli.scene.products.images import ImageForm, draw_map
from radhar_cli.scene.products.maps import WINDOWS, MakeFrames, image_name
from radhar_cli.scene.products.noise import noise_products
from radhar_cli.scene.products.plan import Product
from radhar_cli.scene.products.receiver import make_canceller
from radhar_cli.scene.products.signal_power import (
    PowerSource,
    make_snr_paths,
    needs_other_paths,
    power_product,
)
from radhar_cli.scene.radar import board_of, detection_of, waveform_of
from radhar_cli.scene.room import echo_ways_of
from radhar_cli.scene.scene import Scene


class BoardEcho(NamedTuple):
    """Noiseless echo of a board.

    Attributes:
        cube: samples [frame, loop, virtual, sample].
        power: P_s of a sample, mean over frames, loops and channels.
        accuracy: measured error of the fast sum, or why the exact one was made.
    """

    cube: Complex
    power: float
    accuracy: EchoAccuracy


def board_products(config: Config) -> Iterator[Product]:
    """Rows of the table of products that a config with `radar.cfg` has."""
    yield from _echo_rows(config)
    yield from _frame_map_rows(config)
    yield from _cloud_rows(config)
    yield from _angle_time_rows(config)
    yield from _people_rows()
    yield from _signal_rows(config)
    assert isinstance(config.radar, ArrayRadar)
    for end, number in config.radar.other_subframes.items():
        yield from _subframe_rows(config, end, number)


def _subframe_rows(config: Config, end: str, number: int) -> Iterator[Product]:
    """Rows of another subframe than the chosen one, whose names have an end.

    They are those of a config that has chosen it, but for images and Doppler-time maps.
    """
    chosen = choose_subframe(config, number)
    rows = [*_echo_rows(chosen), *_frame_map_rows(chosen), *_cloud_rows(chosen), *_people_rows()]
    images = {image_name(name) for name in FRAME_MAPS}
    names = {row.name for row in rows} | {"scene", "waveform"}
    choose = partial(scene_of_subframe, number=number)
    yield Product(f"scene{end}", ("scene",), choose, f"scene with subframe {number} chosen")
    yield Product(f"waveform{end}", (f"scene{end}",), waveform_of, "its chirps and pulses")
    for row in rows:
        if row.name not in images:
            needs = tuple(name + end if name in names else name for name in row.needs)
            yield replace(row, name=row.name + end, needs=needs)


def choose_subframe(config: Config, number: int) -> Config:
    """Return a config whose board shows a subframe of its .cfg."""
    radar = config.radar.model_copy(update={"subframe": number})
    return config.model_copy(update={"radar": radar})


def scene_of_subframe(scene: Scene, number: int) -> Scene:
    """Return a scene whose board shows a subframe of its .cfg."""
    return replace(scene, config=choose_subframe(scene.config, number))


def _echo_rows(config: Config) -> Iterator[Product]:
    """Rows of the board, its channels, and its cube with noise."""
    yield Product("board", ("scene",), make_board, "array and chirps")
    room = ("room",) if config.room.reflectors else ()
    needs: tuple[str, ...] = ("scene", "motions", "board", "wall", *room)
    yield Product("channels", needs, make_channels, "paths of every virtual channel")
    needs = ("channels", "board", "scene")
    if config.engine.kind == "direct":
        yield Product("echo", needs, compute_fast_echo, "raw samples, sums in matrix products")
    else:
        yield Product("echo", needs[:2], compute_exact_echo, "raw samples, exact sums")
    yield Product("accuracy", ("echo",), attrgetter("accuracy"), "its measured error")
    if needs_other_paths(config):
        needs = ("scene", "motions", "board", "wall")
        does = "paths of the own person in every channel, for the SNR"
        yield Product("snr_channels", needs, make_snr_channels, does)
    yield power_product(
        config,
        PowerSource(("echo",), attrgetter("power")),
        PowerSource(("snr_channels", "board"), mean_power),
    )
    yield from noise_products(config)
    needs, does = ("echo", "noise", "board", "scene"), "raw samples with noise and channel errors"
    if config.room.faces is not None and config.room.order > 0:
        still = "echoes of the room's faces themselves, the same in every loop"
        yield Product("faces_echo", ("scene", "board", "wall"), compute_faces_echo, still)
        needs = (*needs, "faces_echo")
    yield Product("cube", needs, receive_cube, does, is_array=True)


def products_of_frames(config: AnyConfig) -> dict[str, Product]:
    """Collect the maps of frames that a cube and its board suffice for, {name: product}."""
    rows = (*_frame_map_rows(config), *_angle_time_rows(config))
    return {row.name: row for row in rows}


def _frame_map_rows(config: AnyConfig) -> Iterator[Product]:
    """Rows of the maps of frames, and of their sheets."""
    image = config.image
    for kind in FRAME_MAP_KINDS.values():
        make = partial(
            make_frame_maps,
            kind=kind,
            remove_mean=config.processing.clutter == "mean",
            limits_m=image.range_limits_m,
        )
        does = f"{kind.title} maps of the frames"
        yield Product(kind.name, ("cube", "board"), make, does, is_array=True)
        sheet = partial(maps_sheet, size=image.size_px)
        yield Product(image_name(kind.name), (kind.name, "level_scale"), sheet, "sheet of frames")


def _cloud_rows(config: Config) -> Iterator[Product]:
    """Rows of the points of frames, and of their sheet."""
    radar, cloud = config.radar, config.cloud
    assert isinstance(radar, ArrayRadar)
    detection = detection_of(radar, config.processing)
    find = partial(find_points, radar=radar, settings=cloud, detection=detection)
    does = f"points of the frames, chain: {cloud.chain}"
    yield Product("cloud", ("cube", "board"), find, does)
    yield Product("points", ("cloud",), attrgetter("points"), "of all frames", is_array=True)
    starts, does = attrgetter("start"), "first of each frame"
    yield Product("points_start", ("cloud",), starts, does, is_array=True)
    sheet = partial(cloud_sheet, size=config.image.size_px)
    yield Product(image_name("points"), ("cloud",), sheet, "front views of frames")


def _angle_time_rows(config: AnyConfig) -> Iterator[Product]:
    """Rows of the maps of angles over time, and of their images."""
    draw = partial(draw_map, form=ImageForm.of(config))
    for kind in ANGLE_TIME_KINDS.values():
        make = partial(
            angle_time,
            axis=kind.array_axis,
            remove_mean=config.processing.clutter == "mean",
            limits_m=config.image.range_limits_m if config.radar.has_range else None,
        )
        does = f"{kind.title} map, powers summed over ranges and speeds"
        yield Product(kind.name, ("cube", "board"), make, does, is_array=True)
        yield Product(image_name(kind.name), (kind.name, "image_scale"), draw, "its image")


def _people_rows() -> Iterator[Product]:
    """Rows of skeletons, and of the people whose the points are."""
    needs = ("scene", "motions", "board")
    yield Product("skeletons", needs, locate_skeletons, "joints in each frame's middle")
    owner_needs = ("cloud", "skeletons", "board", "scene")
    yield Product("owners", owner_needs, assign_points, "nearest joint of each point, or its image")
    for name, need, part, does in (
        ("skeleton", "skeletons", "positions", "positions of joints"),
        ("skeleton_velocity", "skeletons", "velocities", "their velocities"),
        ("points_person", "owners", "person", "whose each point is"),
        ("points_kind", "owners", "kind", "by way of which faces"),
    ):
        yield Product(name, (need,), attrgetter(part), does, is_array=True)


def _signal_rows(config: Config) -> Iterator[Product]:
    """Rows of the signals that range-time and Doppler-time maps show, and of their windows."""
    yield Product("canceller", ("scene", "waveform"), make_canceller, "canceller of each frame")
    does = "range bins of every channel"
    window = config.processing.make_chirp_window()
    compress = partial(compute_range_bins, window=window)
    yield Product("board_bins", ("cube", "board"), compress, does, is_array=True)
    does = "sum over range, uncancelled"
    yield Product("slow_time", ("board_bins",), Signal.summed, does, is_array=True)
    needs: tuple[str, ...] = ("cube", "board", "canceller")
    does = "its range bins after the canceller"
    yield Product("range_signals", needs, compress, does, is_array=True)
    bins = ("range_signals",)
    yield Product("signal", bins, Signal.summed, "their coherent sum", is_array=True)
    choose = methodcaller("columns", config.image.size_px[1])
    yield Product("range_profiles", bins, choose, "some pulses", is_array=True)
    needs, does = ("motions", "board", "wall"), "delay of the torso"
    yield Product("torso_track", needs, track_torso_of_board, does, is_array=True)
    if config.processing.range_sum == "gated":
        make = partial(make_gate_of_board, gate_m=config.processing.gate_m)
        needs = ("range_signals", "frames", "torso_track")
        yield Product("gate", needs, make, "range bins of each window")
    for name, make_windows, _ in WINDOWS:
        windows = partial(make_board_windows, make=make_windows)
        yield Product(name, ("scene", "board"), windows, "windows, within frames")


def make_board(scene: Scene) -> Board:
    """Make the board of a scene, with its array and chirps."""
    assert isinstance(scene.radar, ArrayRadar)
    return board_of(scene.radar, scene.seconds)


def make_channels(
    scene: Scene,
    motions: tuple[Motion, ...],
    board: Board,
    wall: Wall | None,
    room: Reflectors | None = None,
) -> list[PathSource]:
    """Make the paths of every virtual channel; all are of the same motions, evaluated once.

    Of two transmitters that send together a channel has the paths of both.

    Returns:
        The paths of the virtual channels, in the order of `board.pairs`.
    """
    cached_motions = tuple(map(cache_motion, motions))
    first = board.antennas(*board.pairs[0])
    links = [Link(board.antennas(k, r), wall, board.path_waveform, first) for k, r in board.pairs]
    sources = [sum_of_paths(make_path_sources(scene, cached_motions, link, room)) for link in links]
    return combine_transmitters(sources, board)


def make_snr_channels(
    scene: Scene, motions: tuple[Motion, ...], board: Board, wall: Wall | None
) -> list[PathSource]:
    """Make the paths of every virtual channel whose power is P_s."""
    motion, first = (cache_motion(motions[0]),), board.antennas(*board.pairs[0])
    sources = [
        make_snr_paths(scene, motion, board.antennas(k, r), wall, board.path_waveform, first)
        for k, r in board.pairs
    ]
    return combine_transmitters(sources, board)


def compute_fast_echo(channels: Sequence[PathSource], board: Board, scene: Scene) -> BoardEcho:
    """Sum up the paths of all channels by matrix products, or exactly where those will not do.

    Args:
        channels: paths of every virtual channel.
        scene: scene whose engine says the largest error, and what happens where it is larger.

    Raises:
        SceneError: the tolerance cannot be kept, and such scenes are refused.
    """
    engine = scene.config.engine
    try:
        cube, power, error_db = fast_cube(channels, board, engine.tolerance_db)
    except AccuracyError as error:
        fallback = fall_back(engine, scene.name, error)
        return compute_exact_echo(channels, board)._replace(accuracy=fallback)
    return BoardEcho(cube, power, Accuracy(1, 1, cube.dtype == np.complex64, error_db))


def compute_exact_echo(channels: Sequence[PathSource], board: Board) -> BoardEcho:
    """Sum up the paths of all channels sample by sample."""
    cube, power = exact_cube(channels, board)
    return BoardEcho(cube, power, Accuracy(1, 1, False, -inf))


def compute_faces_echo(scene: Scene, board: Board, wall: Wall | None) -> Complex:
    """Compute samples [virtual, sample] of the echoes of the room's faces, which do not move.

    They are exact, and added to the others, so that no tolerance refers to them. Those of faces
    beyond the largest range are not there: the filter before the ADC takes them.

    Args:
        scene: scene that has the room.
        board: the board, which sees itself in every face by each pair of its antennas.
        wall: wall that the paths cross, or None.
    """
    ways, fc = echo_ways_of(scene), board.path_waveform.fc
    latest = 2 * board.range_step_m * board.n_bins / SPEED_OF_LIGHT
    pairs = [echoes_of_faces(board.antennas(k, r), ways, wall, fc, latest) for k, r in board.pairs]
    return still_samples(combine_transmitters(pairs, board), board)


def receive_cube(
    echo: BoardEcho,
    noise: WhiteNoise,
    board: Board,
    scene: Scene,
    faces_echo: Complex | None = None,
) -> Complex | Float:
    """Apply the errors of the channels to a cube, and add noise; keep what a real ADC keeps.

    Args:
        echo: echo of all that moves.
        noise: noise of the samples.
        scene: scene that draws the errors.
        faces_echo: samples [virtual, sample] of static echoes, the same in every loop, or None.
    """
    cube: Complex = echo.cube
    if faces_echo is not None:
        cube = cube + faces_echo.astype(cube.dtype)
    factors = draw_channel_errors(scene, board.channels)
    if factors is not None:
        cube = apply_channel_errors(cube, factors, board)
    name = f"cube_sf{board.subframe}" if board.subframe else "cube"
    cube = noise.added_to(cube, name) if noise.sigma > 0 else cube
    return np.ascontiguousarray(cube.real) if board.is_real else cube


def apply_channel_errors(cube: Complex, factors: Complex, board: Board) -> Complex:
    """Multiply the channels of a cube by factors.

    Of two transmitters that send together the errors act on sum and difference as if nothing moved
    between their two chirps.

    Args:
        cube: raw samples [frame, loop, virtual, sample].
        factors: factor of each pair of transmitter and receiver [virtual].
    """
    direct, crossed = factors.copy(), np.zeros_like(factors)
    if board.bpm is not None:
        lower, higher = factors[board.sums], factors[board.differences]
        direct[board.sums] = direct[board.differences] = (lower + higher) / 2
        crossed[board.sums] = crossed[board.differences] = (lower - higher) / 2
    changed = np.multiply(cube, direct[:, None], dtype=cube.dtype, casting="same_kind")
    if board.bpm is not None:
        mixed = cube * crossed[:, None].astype(cube.dtype)
        changed[:, :, board.sums] += mixed[:, :, board.differences]
        changed[:, :, board.differences] += mixed[:, :, board.sums]
    return changed


def draw_channel_errors(scene: Scene, channels: int) -> Complex | None:
    """Draw the factors [virtual] by which the channels of a board differ; None for no errors."""
    receiver = scene.receiver
    if receiver.channel_gain_db <= 0 and receiver.channel_phase_deg <= 0:
        return None
    name = "receiver.channel_errors"
    rng = scene.noise_stream(name)
    if receiver.channel_errors == "data_set":
        radar = scene.config.radar_name
        name = name if radar is None else f"{name} radar {radar}"
        rng = stream(scene.config.seed, NOISE, name=name)
    gain, phase = rng.standard_normal((2, channels))
    gain_db, phase_deg = gain * receiver.channel_gain_db, phase * receiver.channel_phase_deg
    factors: Complex = 10 ** (gain_db / 20) * np.exp(1j * np.radians(phase_deg))
    return factors


def make_frame_maps(
    cube: Complex,
    board: Board,
    kind: FrameMapKind,
    remove_mean: bool,
    limits_m: tuple[float, float] | None = None,
) -> FrameMaps:
    """Make the maps of a cube's frames, of all ranges.

    Args:
        cube: raw samples [frame, loop, virtual, sample].
        remove_mean: whether the mean over the loops of a frame is taken out.
        limits_m: nearest and farthest range that images show, m; None for all. Those of other
            quantities show all rows.
    """
    maps = kind.make(cube, board, remove_mean=remove_mean)
    return replace(maps, limits=limits_m if maps.rows.name == "range" else None)


def find_points(
    cube: Complex, board: Board, radar: ArrayRadar, settings: CloudConfig, detection: Detection
) -> Cloud:
    """Find the points of the frames of a cube, as well as the data allow or as firmware does.

    Points of a board that is rolled are turned to the axes before the roll.

    Args:
        cube: raw samples [frame, loop, virtual, sample].
        radar: radar of the board, whose .cfg may set firmware and a box of the room.
        settings: chain, and what of its points is kept.
        detection: settings of an out-of-box demo's .cfg.
    """
    carrier = board.start_hz if settings.doppler_carrier == "start" else None
    header = radar.header if isinstance(radar, BoardRadar) else None
    if header is None or settings.chain == "best" or radar.firmware is None:
        bias, removes_mean = detection.bias, detection.remove_mean
        cloud = best_points(cube, board, removes_mean, settings.pfa, carrier, bias)
        cloud = keep_in_view(cloud, detection)
    elif isinstance(header.people, PeopleTracking):
        cloud = track_people(cube, board, header.people, carrier)
    elif isinstance(header.people, PeopleCounting):
        cloud = count_people(cube, board, header.people, detection.remove_mean, carrier)
    else:
        cloud = board_points(cube, board, detection, settings.quantise, carrier)
    if board.roll != 0:
        upright = np.hstack([board.without_roll(cloud.points[:, :3]), cloud.points[:, 3:]])
        cloud = Cloud(upright, cloud.start)
    if header is None or header.box is None or not settings.boundary_box:
        return cloud
    return keep_in_box(cloud, header.box, board)


def compute_range_bins(
    cube: Complex,
    board: Board,
    canceller: Canceller = NO_CANCELLER,
    window: ChirpWindow = RECTANGULAR,
) -> Signal:
    """Compute the range bins of every virtual channel, pulse by pulse.

    Args:
        cube: raw samples [frame, loop, virtual, sample].
        canceller: canceller of every channel.
        window: window over the samples of a chirp.

    Returns:
        The bins [virtual, bin, pulse].

    Raw samples go through the canceller, not bins: nothing is left then of static echoes. Sum
    and difference of two transmitters that send together have the power of the two.
    """
    scale = board.signs.copy()
    scale[[*board.sums, *board.differences]] *= sqrt(0.5)
    w = replace(board.waveform, window=window)
    if board.loops == 1:  # of which the mean of a frame would leave nothing
        canceller = NO_CANCELLER
    shape = board.channels, w.n_bins, board.frames * board.loops
    x = np.empty(shape, np.result_type(cube.dtype, np.complex64))
    for v in range(board.channels):
        samples = cube[:, :, v].reshape(-1, board.samples).T * scale[v]
        s = Signal(samples[None], board.pulses, w.f0).cancelled(canceller).x[0]
        x[v] = range_compression(s, w)
    return Signal(x, board.pulses, w.f0, w.range_axis(), range_step=w.range_step)


def track_torso_of_board(motions: tuple[Motion, ...], board: Board, wall: Wall | None) -> Float:
    """Compute the delay of the first person's torso at every pulse of a channel [M], s."""
    t = board.pulses.times(np.arange(board.frames * board.loops))
    track: Float = point_delay(motions[0].torso(t), board.antennas(*board.pairs[0]), wall)[0]
    return track


def make_gate_of_board(
    bins: Signal, frames: Frames, torso_track: Float, gate_m: float | tuple[float, float]
) -> Gate:
    """Make the gate of every window of a board's range bins.

    Args:
        bins: range bins after the canceller.
        frames: windows.
        torso_track: delay of the torso at every pulse [M], s.
        gate_m: half width about the torso, or nearest and farthest range, m.
    """
    return gate_in_windows(bins, frames, PulseTrack(bins.t, torso_track), gate_m)


def make_board_windows(scene: Scene, board: Board, make: MakeFrames) -> Frames:
    """Make the windows of a Doppler-time map of a board, within its frames."""
    seconds = board.frames * board.period_s
    windows = make(scene.config.processing, seconds, 1 / board.loop_s, board.centre_hz)
    return windows.within(board.loops, are_apart=len(board.pulses) > 1)
