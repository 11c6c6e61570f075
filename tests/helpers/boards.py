"""Boards and scatterers in straight motion, as tests of arrays, cubes and points need them."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from radhar_cli.echo.board_cube import combine_transmitters, exact_cube
from radhar_cli.echo.paths import Paths
from radhar_cli.echo.receiver.noise import circular_gaussian
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.radar.board import DEVICES, Board
from radhar_cli.radar.propagation import Antennas, bistatic_delay, leg

# 10 frames a second of 32 loops of three transmitters, 80 samples of 3.2 GHz: what is inferred of
# the recordings of MARS (An and Ogras, 2021).
MARS = Board(
    array=DEVICES["IWR1443BOOST"].array,
    start_hz=77e9,
    carrier_hz=77.7e9,
    slope_hz=100e12,
    adc_rate_hz=2.499e6,
    samples=80,
    slot_s=57e-6,
    masks=(1, 4, 2),
    receivers=(0, 1, 2, 3),
    loops=32,
    frames=2,
    period_s=0.1,
)
CFG = """
channelCfg 15 7 0
adcCfg 2 1
adcbufCfg 0 1 0 1
profileCfg 0 77 17 7 40 0 0 100 1 80 2499 0 0 30
chirpCfg 0 0 0 0 0 0 0 1
chirpCfg 1 1 0 0 0 0 0 4
chirpCfg 2 2 0 0 0 0 0 2
frameCfg 0 2 32 0 100 1 0
cfarCfg 0 2 8 4 3 0 1130
peakGrouping 1 0 0 1 114
multiObjBeamForming 1 0.5
clutterRemoval 1
"""


@dataclass(frozen=True)
class Straight:
    """Paths of scatterers at p + v t [3, I] whose amplitude is a/(R_t R_r)."""

    p: Float
    v: Float
    a: Float
    antennas: Antennas

    breakpoints = ()
    highest_frequency = 1.0
    smooth = True

    def __call__(self, t: Float) -> Paths:
        p = self.p[..., None] + self.v[..., None] * t
        r_tx, r_rx = leg(p, self.antennas.tx), leg(p, self.antennas.rx)
        return Paths(bistatic_delay(r_tx, r_rx), self.a[:, None] / (r_tx * r_rx))


def channels(board: Board, p: Any, v: Any, a: Any) -> list[Straight]:
    """Channels of scatterers at places p [I, 3] with speeds v [I, 3]."""
    places, speeds = np.array(p, float).reshape(-1, 3).T, np.array(v, float).reshape(-1, 3).T
    strengths = np.array(a, float).reshape(-1)
    return [Straight(places, speeds, strengths, board.antennas(k, r)) for k, r in board.pairs]


def cube_of(
    p: Any,
    v: Any,
    board: Board = MARS,
    snr_db: float | None = 20.0,
    seed: int = 0,
    a: float = 1.0,
    **changes: Any,
) -> tuple[Complex, Board]:
    """Samples of scatterers of amplitude a, and their board."""
    board = replace(board, **{"frames": 1, **changes})
    squares = a * (np.array(p, float).reshape(-1, 3) ** 2).sum(axis=1)
    sources = combine_transmitters(channels(board, p, v, squares), board)
    cube, power = exact_cube(sources, board)
    if snr_db is not None:
        noise = circular_gaussian(np.random.default_rng(seed), cube.shape)
        cube = cube + noise * np.sqrt(power / 10 ** (snr_db / 10))
    return cube, board


# A data set of points and frames, beside board.cfg.
CLOUDS = """
radar: {device: IWR1443BOOST, cfg: board.cfg, position_m: [0, 0, 1]}
activities: [punching, walking]
motion: {range_m: {per_activity: {default: 2.2, walking: 3}}}
duration_s: 0.5
samples_per_class: 5
split: {train: 0.6, validation: 0.4}
body: {scatterers: surfaces}
cloud: {chain: board}
maps: [range_doppler, points]
image: {size_px: 32}
"""
