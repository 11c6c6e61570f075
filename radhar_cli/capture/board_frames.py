"""Frames of a recording of a board: cube, frame maps and points, by the chain of simulations."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from radhar_cli.assembly.radar import board_of
from radhar_cli.capture.chain import pulses_between
from radhar_cli.capture.recording import Recording
from radhar_cli.config.data_set import Config
from radhar_cli.config.maps import FRAME_MAPS
from radhar_cli.config.radar import BoardRadar
from radhar_cli.errors import CaptureError
from radhar_cli.products.plan import plan
from radhar_cli.products.run import run
from radhar_cli.products.table import products
from radhar_cli.radar.board import Board
from radhar_cli.scene import fixed_radar

# {map of a board: products of its recording that are behind it}
OF_FRAMES = {name: (name,) for name in (*FRAME_MAPS, "cube")} | {"points": ("cloud",)}
SAME = 1e-6  # relative difference of frequencies and times that are the same


def frames_of_recording(
    recording: Recording,
    config: Config,
    asked: Sequence[str],
    start: float | None = None,
    stop: float | None = None,
) -> tuple[dict[str, Any], Board]:
    """Make the products of a board's frames in a recording.

    Args:
        recording: recording of the board.
        config: config with the board's `radar.cfg`.
        asked: products of a cube, such as range_doppler or cloud.
        start: begin of the part of the recording that is used, s; None is the start.
        stop: end of that part, s; None is the end. Frames that are whole within it are used.

    Returns:
        {product: result}, and the board with the number of these frames.

    Raises:
        CaptureError: the config is not that of the board, or there is no whole frame.
    """
    board = _board(recording, config)
    first, _, segments = pulses_between(recording, start, stop)
    is_whole = segments.lengths == board.loops
    if not is_whole.any():
        raise CaptureError(f"{recording.path}: holds no whole frame of {board.loops} loops there")
    board = replace(board, frames=int(is_whole.sum()))
    cube = np.empty((board.frames, board.loops, board.channels, board.samples), np.complex64)
    starts = first + segments.first[is_whole]
    for frame, pulse in enumerate(starts.tolist()):
        cube[frame] = recording.beat(pulse, pulse + board.loops).transpose(2, 0, 1)
    inputs = {"cube": cube, "board": board}
    return run(plan(products(config), asked, inputs), inputs).products, board


def _board(recording: Recording, config: Config) -> Board:
    """Board of a config, which must be that of the recording.

    Raises:
        CaptureError: the config has no board, or another.
    """
    radar = fixed_radar(config)
    if not isinstance(radar, BoardRadar):
        raise CaptureError(f"{recording.path}: frames need the board's .cfg: radar.cfg")
    board, info = board_of(radar), recording.info
    expected = {
        "receivers": board.channels,
        "samples": board.samples,
        "carrier_hz": board.fc,
        "bandwidth_hz": board.slope * board.samples / board.adc_rate,
        "adc_rate_hz": board.adc_rate,
        "prf_hz": 1 / board.loop,
    }
    for key, value in expected.items():
        recorded = getattr(info, key)
        if recorded is None or abs(recorded - value) > SAME * abs(value):
            raise CaptureError(
                f"{recording.path}: {key} = {recorded}: should be {value:.10g}, as radar.cfg has it"
            )
    return board
