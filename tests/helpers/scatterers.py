"""Cubes of scatterers by formula, with noise that any program can repeat."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.radar.board import DEVICES, Board

ISK = Board(  # TI's profile of 3D people tracking, whose three transmitters take turns
    array=DEVICES["IWR6843ISK"].array,
    start_hz=60.75e9,
    carrier_hz=60.75e9 + 54.71e12 * 25e-6,
    slope_hz=54.71e12,
    adc_rate_hz=2.95e6,
    samples=96,
    slot_s=89.1e-6,
    masks=(1, 2, 4),
    receivers=(0, 1, 2, 3),
    loops=96,
    frames=1,
    period_s=0.055,
)
ISK_CFG = """
channelCfg 15 7 0
adcCfg 2 1
profileCfg 0 60.75 30.00 25.00 59.10 0 0 54.71 1 96 2950.00 2 1 36
chirpCfg 0 0 0 0 0 0 0 1
chirpCfg 1 1 0 0 0 0 0 2
chirpCfg 2 2 0 0 0 0 0 4
frameCfg 0 2 96 0 55.00 1 0
dynamicRACfarCfg -1 4 4 2 2 8 12 4 8 4.00 8.00 0.40 1 1
staticRACfarCfg -1 6 2 2 2 8 8 6 4 5.00 15.00 0.30 0 0
dynamicRangeAngleCfg -1 0.75 0.0010 1 0
dynamic2DAngleCfg -1 1.5 0.0300 1 0 1 0.30 0.85 8.00
staticRangeAngleCfg -1 0 8 8
fineMotionCfg -1 0
antGeometry0 0 -1 -2 -3 -2 -3 -4 -5 -4 -5 -6 -7
antGeometry1 -1 -1 -1 -1 0 0 0 0 -1 -1 -1 -1
antPhaseRot 1 1 1 1 1 1 1 1 1 1 1 1
fovCfg -1 70.0 20.0
sensorPosition 1 0 0
"""
ODS = replace(ISK, array=DEVICES["IWR6843ISK-ODS"].array)
ODS_GEOMETRY = """
antGeometry0 0 0 -1 -1 -2 -2 -3 -3 -2 -2 -3 -3
antGeometry1 0 -1 -1 0 0 -1 -1 0 -2 -3 -3 -2
antPhaseRot 1 -1 -1 1 1 -1 -1 1 1 -1 -1 1
fovCfg -1 60.0 60.0
"""


def uniform(number: Index) -> Float:
    """Numbers from 0 to 1 of whole numbers, by splitmix64."""
    z = (number.astype(np.uint64) + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return (z >> np.uint64(11)).astype(float) * 2.0**-53


def repeatable_noise(shape: Sequence[int], power: float, seed: int) -> Complex:
    """Circular noise of a power that follows from a seed alone."""
    number = np.arange(int(np.prod(shape)))
    level = np.sqrt(-power * np.log(1 - uniform(2 * number + seed)))
    noise: Complex = level * np.exp(2j * np.pi * uniform(2 * number + 1 + seed))
    return noise.reshape(shape)


def echo_of(
    board: Board,
    scatterers: Sequence[Mapping[str, Any]],
    masks: Sequence[int] = (1, 2, 4),
    bpm: tuple[int, int] | None = None,
    frame: int = 0,
) -> Complex:
    """Samples [loop, virtual, sample] of a frame of scatterers of constant amplitude.

    Args:
        board: The board.
        scatterers: `position_m` at 0 s, `velocity_mps` and `amplitude` of each.
        masks: Transmitters of the chirps of a loop.
        bpm: Places of the chirps in which two send together, the higher one turned in the later.
        frame: Number of the frame.
    """
    n, array, receivers = np.arange(board.samples), board.array, len(board.array.rx)
    cube = np.zeros((board.loops, len(masks), receivers, board.samples), complex)
    loop = np.arange(board.loops)
    for k, mask in enumerate(masks):
        t = frame * board.period_s + (loop * len(masks) + k) * board.slot_s
        for tx in (number for number in range(len(array.tx)) if mask >> number & 1):
            is_higher = mask >> (tx + 1) == 0
            code = -1.0 if bpm is not None and k == bpm[1] and is_higher else 1.0
            for r, (rx, sign) in enumerate(zip(array.rx, array.rx_sign, strict=True)):
                for one in scatterers:
                    p = np.array(one["position_m"], float) + np.multiply.outer(
                        t, np.array(one["velocity_mps"], float)
                    )
                    ends = board.element(array.tx[tx]), board.element(rx)
                    path = sum(np.linalg.norm(p - np.array(end), axis=1) for end in ends)
                    tau = (path / SPEED_OF_LIGHT)[:, None]
                    turn = board.carrier_hz * tau + board.slope_hz * tau * n / board.adc_rate_hz
                    cube[:, k, r] += code * sign * one["amplitude"] * np.exp(-2j * np.pi * turn)
    return cube.reshape(board.loops, -1, board.samples)
