"""What `best` makes of two scatterers in one cell of range and Doppler: rows for boards.md.

python scripts/studies/two_in_a_cell.py [--draws 150] [--seed 11]

Two equal scatterers 1.5 to 3 m away, at one range and one radial speed, 20 dB a sample. A point is
a stray if it is more than 0.35 m from both but within 0.2 m of their range and 0.2 m/s of their
speed; those of other ranges or speeds are false alarms. Beside each other they are 20 to 80 degrees
apart, at one elevation within 8 degrees; above each other as far, at one azimuth within 30.
"""

import argparse
from dataclasses import replace

import numpy as np
from points_of_scatterers import ISK

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.processing.best_points import best_points
from radhar_cli.radar.board import DEVICES, Board

STRAY_M = 0.35
ALIKE = 0.2  # range (m) and speed (m/s) of a stray, beside those of the scatterers
SNR_DB = 20.0
HEAD = (
    "| board | apart in | frames with a stray | false alarms a frame | both found "
    "| azimuth, degree, rms | largest | elevation, degree, rms |\n"
    "| --- | --- | --- | --- | --- | --- | --- | --- |"
)


def board_of_device(name: str) -> Board:
    """Board of a device with the profile of 3D people tracking."""
    device = DEVICES[name]
    if not name.endswith("1443BOOST"):
        return replace(ISK, array=device.array)
    start = 77.0e9  # the chirps of an xWR14xx sweep its band
    return replace(ISK, array=device.array, start=start, fc=start + 1.4e9, order=(0, 2, 1))


def draw_directions(rng: np.random.Generator, axis: str) -> Float:
    """Unit vectors [2, 3] to two scatterers that are apart along an axis."""
    apart = rng.uniform(20, 80)
    middle = rng.uniform(-1, 1) * (50 - apart / 2)
    pair, same = middle + np.array([-0.5, 0.5]) * apart, rng.uniform(-1, 1)
    azimuth, elevation = (pair, same * 8) if axis == "azimuth" else (same * 30, pair)
    az, el = np.radians(np.broadcast_arrays(azimuth, elevation))
    return np.stack([np.cos(az) * np.cos(el), np.sin(az) * np.cos(el), np.sin(el)], axis=1)


def sample_two(board: Board, places: Float, velocities: Float, rng: np.random.Generator) -> Complex:
    """Samples [1, loop, virtual, sample] of scatterers of amplitude 1, with noise.

    Args:
        board: The board.
        places: Positions at 0 s [I, 3], m.
        velocities: Their velocities [I, 3], m/s.
        rng: Where the noise comes from.
    """
    t, n = board.chirp_times()[0], np.arange(board.samples)
    cube = np.zeros((1, board.loops, board.channels, board.samples), complex)
    for v, (k, r) in enumerate(board.pairs):
        antennas = board.antennas(k, r)
        for p, velocity in zip(places, velocities, strict=True):
            moved = p + velocity * t[:, k, None]
            way = np.linalg.norm(moved - antennas.tx, axis=1)
            way += np.linalg.norm(moved - antennas.rx, axis=1)
            delay = way[:, None] / SPEED_OF_LIGHT
            turn = board.fc * delay + board.slope * delay * n / board.adc_rate
            cube[0, :, v] += board.array.rx_sign[r] * np.exp(-2j * np.pi * turn)
    noise = rng.standard_normal((*cube.shape, 2)).view(complex)[..., 0]
    power = np.mean(np.abs(cube) ** 2)
    noisy: Complex = cube + noise * np.sqrt(power / 2 / 10 ** (SNR_DB / 10))
    return noisy


def row_of(name: str, axis: str, draws: int, seed: int) -> str:
    """Write the row of a board.

    Args:
        name: Its device.
        axis: azimuth or elevation, in which the scatterers are apart.
        draws: Number of frames.
        seed: Seed of the draws.
    """
    board, rng = board_of_device(name), np.random.default_rng(seed)
    strays, both, alarms, errors = 0, 0, 0, list[Float]()
    for _ in range(draws):
        ways, speed = draw_directions(rng, axis), rng.uniform(0.3, 1.5)
        p = ways * rng.uniform(1.5, 3) + ways * rng.uniform(0, 0.004, (2, 1))
        cube = sample_two(board, p, speed * ways, rng)
        points = best_points(cube, board, True, 1e-5).points.astype(float)
        p += speed * ways * board.middles[0]
        distance = np.linalg.norm(points[:, None, :3] - p, axis=2)
        is_far = distance.min(axis=1) > STRAY_M
        r = np.linalg.norm(points[:, :3], axis=1) - np.linalg.norm(p[0])
        is_elsewhere = (np.abs(r) > ALIKE) | (np.abs(points[:, 3] + speed) > ALIKE)
        strays += bool((is_far & ~is_elsewhere).any())
        alarms += int((is_far & is_elsewhere).sum())
        both += bool((distance < STRAY_M).any(axis=0).all())
        near, nearest = points[~is_far], p[distance.argmin(axis=1)[~is_far]]
        errors += list(_angles(near) - _angles(nearest))
    error = np.array(errors).reshape(-1, 2)
    rms, largest = np.sqrt(np.mean(error**2, axis=0)), np.abs(error[:, 0]).max()
    shares = f"{100 * strays / draws:.0f} % | {alarms / draws:.2f} | {100 * both / draws:.0f} %"
    return f"| {name} | {axis} | {shares} | {rms[0]:.2f} | {largest:.1f} | {rms[1]:.1f} |"


def _angles(p: Float) -> Float:
    """Azimuth and elevation [N, 2] of positions [N, 3], degrees."""
    x, y, z = p[:, :3].T
    return np.degrees(np.stack([np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))], axis=1))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=150, help="frames a row")
    parser.add_argument("--seed", type=int, default=11, help="seed of the draws")
    arguments = parser.parse_args()
    print(HEAD)
    for name in ("IWR1443BOOST", "IWR6843ISK", "IWR6843ISK-ODS", "IWR6843AOP"):
        for axis in ("azimuth", "elevation"):
            print(row_of(name, axis, arguments.draws, arguments.seed), flush=True)


if __name__ == "__main__":
    main()
