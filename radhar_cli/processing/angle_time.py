"""Angle-time maps: the power of a board's beams, a column a frame."""

from dataclasses import dataclass

import numpy as np

from radhar_cli.numerics.arrays import Complex
from radhar_cli.processing.frame_maps import (
    ANGLES,
    RANGE,
    angles_of_beams,
    beams_of_rows,
    hann,
    level_of_sum,
    powers_of_beams,
    spectra,
    without_turns,
)
from radhar_cli.processing.power_map import Axis, PowerMap
from radhar_cli.radar.board import Board


@dataclass(frozen=True)
class AngleTimeKind:
    """Kind of an angle-time map, a line of ANGLE_TIME_KINDS.

    Attributes:
        name: its name in `maps:` and in files.
        title: its name in figures.
        array_axis: direction in which it needs the array to extend, 0 across, 1 upwards.
    """

    name: str
    title: str
    array_axis: int


# {name: kind} of every angle-time map, in the order of data sets.
ANGLE_TIME_KINDS = {
    kind.name: kind
    for kind in (
        AngleTimeKind("azimuth_time", "azimuth-time", 0),
        AngleTimeKind("elevation_time", "elevation-time", 1),
    )
}


def angle_time(
    cube: Complex,
    board: Board,
    axis: int,
    remove_mean: bool,
    limits_m: tuple[float, float] | None = None,
) -> PowerMap:
    """Make the angle-time map [angle, frame] of a cube: beams of every frame, over all speeds.

    P[theta, f] = sum_k sum_d |w^H(theta) x_f[d, k]|^2 over range bins k and Doppler bins d, with
    the beams of `range_angle`, is divided by what a steady echo in the middle of a bin leaves in
    all of them, so that it reads its power at its angle.

    Args:
        cube: Samples [frame, loop, virtual, sample].
        board: The board that took them.
        axis: 0 for azimuth, positive left, 1 for elevation, positive up.
        remove_mean: Whether the mean over the loops of a frame is taken out.
        limits_m: Nearest and farthest range whose powers are summed, m; None for all.
    """
    beams = beams_of_rows(board, axis)
    bins = slice(None) if limits_m is None else RANGE.of(board).cells_within(limits_m)
    level = level_of_sum(hann(board.loops), board.n_doppler)
    level *= level_of_sum(hann(board.samples), board.n_fft)
    power = np.zeros((len(cube), angles_of_beams(board).size))
    for frames, x in spectra(cube, board, remove_mean):
        x = without_turns(x, board)[..., bins]
        for row, pairs in beams:
            elements = x[:, :, row].transpose(0, 2, 1, 3)
            cells = elements.reshape(*elements.shape[:2], -1)
            power[frames] += powers_of_beams(cells[:, None], pairs)[:, 0]
    np.maximum(power, 0, out=power)  # of rounding
    power /= level * len(beams)
    time = Axis("time", "s", board.middles, board.period_s)
    return PowerMap(power.T, ANGLES[axis].of(board), time)
