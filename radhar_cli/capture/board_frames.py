"""Frames of a recording of a board: cube, frame maps and points, by the chain of simulations."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from radhar_cli.capture.chain import even_columns, part_of
from radhar_cli.capture.content import (
    Beat,
    SlowTime,
    describe_difference,
    describe_other_chirps,
)
from radhar_cli.capture.recording import Recording
from radhar_cli.config.data_set import AnyConfig, Config
from radhar_cli.config.maps import ANGLE_TIME_MAPS, FRAME_MAPS
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.errors import CaptureError
from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.power_map import PowerMap
from radhar_cli.radar.board import Board
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.scene.products.board import products_of_frames
from radhar_cli.scene.products.images import level_scale_of, scale_of
from radhar_cli.scene.products.plan import plan
from radhar_cli.scene.products.run import run
from radhar_cli.scene.products.table import products
from radhar_cli.scene.radar import board_of
from radhar_cli.scene.scene import fixed_radar

# {map of a board: products of its recording that are behind it}
OF_FRAMES = {name: (name,) for name in (*ANGLE_TIME_MAPS, *FRAME_MAPS, "cube")} | {
    "points": ("cloud",)
}


def frames_of_recording(
    recording: Recording,
    config: AnyConfig,
    names: Sequence[str],
    start: float | None = None,
    stop: float | None = None,
) -> tuple[dict[str, Any], Board]:
    """Make the products of a board's frames in a recording.

    Args:
        config: config with the radar of the frames; that of a data set of recordings has no cloud.
        names: products of a cube, such as range_doppler or cloud.
        start: begin of the part of the recording that is used, s; None is the start.
        stop: end of that part, s; None is the end. Frames that are whole within it are used.

    Returns:
        {product: result}, and the board with the number of these frames.

    Raises:
        CaptureError: the config is not that of the board, or there is no whole frame.
    """
    board = _board(recording, config)
    part = part_of(recording, start, stop)
    starts = _starts_of_frames(part.segments, board.loops, config.radar.frames_apart)
    if not starts:
        raise CaptureError(f"{recording.path}: holds no whole frame of {board.loops} loops there")
    board = replace(board, frames=len(starts))
    _require_kind_of_samples(recording, board)
    shape = board.frames, board.loops, board.channels, board.samples
    cube = np.empty(shape, np.float32 if board.is_real else np.complex64)
    for frame, start in enumerate(starts):
        pulse = part.first + start
        beat = recording.beat(pulse, pulse + board.loops).transpose(2, 0, 1)
        cube[frame] = beat.real if board.is_real else beat
    scales = {"image_scale": scale_of(config), "level_scale": level_scale_of(config)}
    inputs = {"cube": cube, "board": board, **scales}
    table = products(config) if isinstance(config, Config) else products_of_frames(config)
    outputs = run(plan(table, names, inputs), inputs).products
    middles = part.segments.times(np.array(starts)) + board.loops * board.loop_s / 2
    results = {
        name: _at_times(product, middles) if isinstance(product, PowerMap) else product
        for name, product in outputs.items()
    }
    return results, board


def _at_times(power_map: PowerMap, times: Float) -> PowerMap:
    """Give a map of frames the times of the recording, where frames may be missing."""
    return even_columns(replace(power_map, columns=replace(power_map.columns, values=times)))


def _starts_of_frames(segments: PulseTimes, loops: int, frames_apart: bool) -> list[int]:
    """Numbers of the first pulses of whole frames.

    Args:
        segments: stretches of pulses, each a frame if there are pauses between frames.
        loops: number of pulses of a frame.
        frames_apart: whether the radar pauses between frames.
    """
    if frames_apart:
        starts: list[int] = segments.first[segments.lengths == loops].tolist()
        return starts
    return [
        start
        for pulses in segments.slices
        for start in range(pulses.start, pulses.stop - loops + 1, loops)
    ]


def _board(recording: Recording, config: AnyConfig) -> Board:
    """Board of a config, which must be that of the recording.

    Raises:
        CaptureError: the config has no board, or another.
    """
    radar = fixed_radar(config)
    if not isinstance(radar, ArrayRadar):
        raise CaptureError(
            f"{recording.path}: frames need a radar that has them: radar.cfg or radar.frame"
        )
    board, info = board_of(radar), recording.info
    difference = _describe_difference(recording, board)
    if info.receivers != board.channels:
        difference = f"receivers = {info.receivers}: should be {board.channels}"
    if difference is not None:
        raise CaptureError(f"{recording.path}: {difference}, as {radar.named} has it")
    return board


def _describe_difference(recording: Recording, board: Board) -> str | None:
    """Describe the difference of a recording's content from that of a board; None without one."""
    content = recording.info.content
    if board.samples == 1:
        return describe_difference(content, SlowTime(board.carrier_hz, board.prf_hz))
    return describe_other_chirps(content, Beat.of_frames(board))


def _require_kind_of_samples(recording: Recording, board: Board) -> None:
    """Raise CaptureError unless the samples are real, or complex, as those of the board."""
    kinds = "complex", "real"
    is_real = recording.samples.parts == 1
    if is_real != board.is_real:
        raise CaptureError(
            f"{recording.path}: samples are {kinds[is_real]}: should be {kinds[board.is_real]}, as "
            "radar.cfg has it"
        )
