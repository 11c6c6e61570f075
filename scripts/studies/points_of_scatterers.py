"""What each chain of points makes of single scatterers and of noise: a table for boards.md.

python scripts/studies/points_of_scatterers.py [--draws 60] [--noises 20]

Scatterers of constant amplitude 0.2 at 1 to 6 m, within 60 degrees to both sides and 10 upwards and
downwards, at 0.2 to 0.4 m/s; noise of power 1 a sample; TI's profile of 3D people tracking, of
people_counting and sdk1 those of their boards. The error is that of the mean of a frame's points,
weighted by their SNR: median +- standard deviation. Then BPM against TDM: scatterers of amplitude
0.3 at 0.3 m/s, 48 loops of either.
"""

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.processing.best_points import best_points
from radhar_cli.processing.people_tracking.chain import PeopleTracker, track_people
from radhar_cli.processing.people_tracking.counting import count_people
from radhar_cli.processing.people_tracking.spectrum import decode_bpm, range_bins
from radhar_cli.processing.points import Cloud, board_points
from radhar_cli.radar.board import DEVICES, Board
from radhar_cli.readers.ti.ti_commands import split_lines
from radhar_cli.readers.ti.ti_detection import read_detection
from radhar_cli.readers.ti.ti_people import (
    last_lines,
    read_people_counting,
    read_people_tracking,
)

ISK = Board(
    array=DEVICES["IWR6843ISK"].array,
    start=60.75e9,
    fc=60.75e9 + 54.71e12 * 25e-6,
    slope=54.71e12,
    adc_rate=2.95e6,
    samples=96,
    slot=89.1e-6,
    order=(0, 1, 2),
    receivers=(0, 1, 2, 3),
    loops=96,
    frames=1,
    period=0.055,
)
BPM = replace(ISK, loops=48, bpm=(0, 2))
ODS = replace(ISK, array=DEVICES["IWR6843ISK-ODS"].array)
IWR1642 = Board(
    array=DEVICES["IWR1642BOOST"].array,
    start=77e9,
    fc=77e9 + 60e12 * 7e-6,
    slope=60e12,
    adc_rate=2.5e6,
    samples=128,
    slot=92e-6,
    order=(0, 1),
    receivers=(0, 1, 2, 3),
    loops=128,
    frames=1,
    period=0.05,
)
IWR1443 = replace(IWR1642, array=DEVICES["IWR1443BOOST"].array, order=(0, 2, 1), loops=96)
TRACKING = """
dynamicRACfarCfg -1 4 4 2 2 8 12 4 8 4.00 8.00 0.40 1 1
dynamicRangeAngleCfg -1 0.75 0.0010 1 0
dynamic2DAngleCfg -1 1.5 0.0300 1 0 1 0.30 0.85 8.00
"""
OF_ISK = """
antGeometry0 0 -1 -2 -3 -2 -3 -4 -5 -4 -5 -6 -7
antGeometry1 -1 -1 -1 -1 0 0 0 0 -1 -1 -1 -1
antPhaseRot 1 1 1 1 1 1 1 1 1 1 1 1
fovCfg -1 70.0 20.0
"""
OF_ODS = """
antGeometry0 0 0 -1 -1 -2 -2 -3 -3 -2 -2 -3 -3
antGeometry1 0 -1 -1 0 0 -1 -1 0 -2 -3 -3 -2
antPhaseRot 1 -1 -1 1 1 -1 -1 1 1 -1 -1 1
fovCfg -1 60.0 60.0
"""
OUT_OF_BOX = """
cfarCfg -1 0 2 8 4 3 0 15 1
cfarCfg -1 1 0 4 2 3 1 15 1
clutterRemoval -1 1
"""
COUNTING = """
cfarCfg 6 4 4 0 0 16 16 4 4 50 62 0
doaCfg 600 1875 30 1
"""
OF_SDK_1 = """
cfarCfg 0 2 8 4 3 0 1130
peakGrouping 1 1 1 1 127
clutterRemoval 1
"""
AMPLITUDE = 0.2
CODED_AMPLITUDE, CODED_SPEED = 0.3, 0.3
HEAD = (
    "| chain | points | missed | range, mm | azimuth, degree | elevation, degree | speed, m/s "
    "| false points a frame of noise |\n| --- | --- | --- | --- | --- | --- | --- | --- |"
)


@dataclass(frozen=True)
class Scatterer:
    """A scatterer that moves away from the radar.

    Attributes:
        direction: Unit vector to it [3].
        range: Range at 0 s, m.
        speed: Speed, receding positive, m/s.
    """

    direction: Float
    range: float
    speed: float


def draw_scatterer(rng: np.random.Generator) -> Scatterer:
    """Draw a scatterer of the table."""
    azimuth, elevation = np.radians([rng.uniform(-60, 60), rng.uniform(-10, 10)])
    level = np.cos(elevation)
    direction = np.array([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)])
    speed = rng.uniform(0.2, 0.4) * rng.choice([-1, 1])
    return Scatterer(direction, rng.uniform(1, 6), speed)


def sample(
    board: Board,
    scatterer: Scatterer | None,
    rng: np.random.Generator,
    amplitude: float = AMPLITUDE,
) -> Complex:
    """Samples [1, loop, virtual, sample] of a scatterer, or of none, with noise."""
    shape = 1, board.loops, board.channels, board.samples
    cube: Complex = (rng.standard_normal((*shape, 2)) * np.sqrt(0.5)).view(complex)[..., 0]
    if scatterer is None:
        return cube
    alone = amplitude * np.stack([_echo(board, scatterer, tx) for tx in range(len(board.order))])
    for k, chirp in enumerate(np.split(cube[0], len(board.order), axis=1)):
        if board.bpm is None or k not in board.bpm:
            chirp += alone[k, :, k]
            continue
        code = 1 if k == board.bpm[0] else -1
        chirp += alone[board.bpm[0], :, k] + code * alone[board.bpm[1], :, k]
    return cube


def _echo(board: Board, scatterer: Scatterer, transmitter: int) -> Complex:
    """Echo [loop, chirp, receiver, sample] of amplitude 1 of one transmitter in every chirp."""
    t = board.chirp_times()[0][..., None]
    places = scatterer.direction * (scatterer.range + scatterer.speed * t)
    n = np.arange(board.samples)
    tx = np.array(board.element(board.array.tx[board.order[transmitter]]))
    echoes = []
    for receiver in board.receivers:
        rx = np.array(board.element(board.array.rx[receiver]))
        path = np.linalg.norm(places - tx, axis=-1) + np.linalg.norm(places - rx, axis=-1)
        delay = (path / SPEED_OF_LIGHT)[..., None]
        turn = board.fc * delay + board.slope * delay * n / board.adc_rate
        echoes.append(board.array.rx_sign[receiver] * np.exp(-2j * np.pi * turn))
    return np.stack(echoes, axis=2)


def errors_of(cloud: Cloud, board: Board, scatterer: Scatterer) -> Float | None:
    """Errors of range (mm), azimuth, elevation (degree) and speed; None without a point near it."""
    points = cloud.points.astype(float)
    middle = scatterer.range + scatterer.speed * board.middles[0]
    distance = np.linalg.norm(points[:, :3] - middle * scatterer.direction, axis=1)
    points = points[distance < 0.3 * middle]
    if not len(points):
        return None
    weight = 10 ** (points[:, 5] / 10)
    x, y, z, speed = weight @ points[:, :4] / weight.sum()
    r = np.sqrt(points[:, 0] ** 2 + points[:, 1] ** 2 + points[:, 2] ** 2) @ weight / weight.sum()
    along, left, up = scatterer.direction
    azimuth = np.degrees(np.arctan2(y, x) - np.arctan2(left, along))
    elevation = np.degrees(np.arctan2(z, np.hypot(x, y)) - np.arcsin(up))
    return np.array([(r - middle) * 1e3, azimuth, elevation, speed + scatterer.speed])


def row_of(
    name: str, board: Board, find: Callable[[Complex, Board], Cloud], draws: int, noises: int
) -> str:
    """Write the row of a chain.

    Args:
        name: Its name.
        board: The board.
        find: Function that finds the points of a cube.
        draws: Number of scatterers.
        noises: Number of frames of noise.
    """
    rng, errors, counts = np.random.default_rng(1), list[Float](), list[int]()
    for _ in range(draws):
        scatterer = draw_scatterer(rng)
        cloud = find(sample(board, scatterer, rng), board)
        error = errors_of(cloud, board, scatterer)
        if error is not None:
            errors.append(error)
            counts.append(len(cloud.points))
    false = np.mean([len(find(sample(board, None, rng), board).points) for _ in range(noises)])
    middle, spread = np.median(errors, axis=0), np.std(errors, axis=0)
    cells = [
        f"{m:.{digits}f} +- {s:.{digits}f}"
        for m, s, digits in zip(middle, spread, (0, 2, 2, 3), strict=True)
    ]
    missed = f"{draws - len(errors)} of {draws}"
    return f"| {name} | {np.mean(counts):.1f} | {missed} | {' | '.join(cells)} | {false:.2f} |"


def chains() -> Mapping[str, tuple[Board, Callable[[Complex, Board], Cloud]]]:
    """The rows: {name: board and function}."""
    isk, ods = (
        read_people_tracking(last_lines(split_lines(TRACKING + elements, "table")), 12, ISK.n_fft)
        for elements in (OF_ISK, OF_ODS)
    )
    demo = read_detection(split_lines(OUT_OF_BOX, "table"), 12, ISK.n_fft)
    first_demo = read_detection(split_lines(OF_SDK_1, "table"), 12, IWR1443.n_fft)
    counting = read_people_counting(last_lines(split_lines(COUNTING, "table")), 8, IWR1642.n_fft)
    find_people = partial(count_people, settings=counting, remove_mean=True)
    return {
        "people_tracking, ISK": (ISK, partial(track_people, settings=isk)),
        "people_tracking, ISK with bpmCfg": (BPM, partial(track_people, settings=isk)),
        "people_tracking, ISK-ODS, method 1": (ODS, partial(track_people, settings=ods)),
        "people_counting, IWR1642BOOST": (IWR1642, find_people),
        "sdk1, IWR1443BOOST": (
            IWR1443,
            partial(board_points, detection=first_demo, quantise=True),
        ),
        "sdk3, ISK": (ISK, partial(board_points, detection=demo, quantise=True)),
        "best, ISK": (ISK, partial(best_points, remove_mean=True, pfa=1e-5)),
    }


def compare_bpm(draws: int) -> tuple[float, Float, Float]:
    """Compare people tracking of an ISK with bpmCfg and without, by the same scatterers.

    Args:
        draws: Number of scatterers.

    Returns:
        Noise of the map with it over that without, dB; peak over noise, with it and without, dB;
        points a frame, with it and without.
    """
    boards = BPM, replace(ISK, loops=BPM.loops)
    settings = read_people_tracking(
        last_lines(split_lines(TRACKING + OF_ISK, "table")), 12, ISK.n_fft
    )
    tracker, rng = PeopleTracker.of(settings), np.random.default_rng(2)
    near, far = settings.dynamic.skip_range
    peaks, counts, noises = (np.empty((draws, 2)) for _ in range(3))
    for n in range(draws):
        scatterer = replace(draw_scatterer(rng), speed=CODED_SPEED)
        for column, board in enumerate(boards):
            cube = sample(board, scatterer, rng, CODED_AMPLITUDE)
            points = track_people(cube, board, settings).points
            peaks[n, column] = points[:, 5].max() if len(points) else np.nan
            counts[n, column] = len(points)
            frame = decode_bpm(sample(board, None, rng)[0], board.sums, board.differences)
            bins = range_bins(frame, np.blackman(board.samples), tracker.turned)
            noises[n, column] = tracker.map_of(bins.moving)[1][:, near : ISK.n_fft - far].mean()
    with_it, without = 10 * np.log10(noises.mean(axis=0))
    return float(with_it - without), np.nanmean(peaks, axis=0), counts.mean(axis=0)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=60, help="scatterers a row")
    parser.add_argument("--noises", type=int, default=20, help="frames of noise a row")
    arguments = parser.parse_args()
    print(HEAD)
    for name, (board, find) in chains().items():
        print(row_of(name, board, find, arguments.draws, arguments.noises), flush=True)
    noise, peaks, counts = compare_bpm(arguments.draws)
    print(
        f"\nbpmCfg against none: noise of the map {noise:+.1f} dB, peak over noise "
        f"{peaks[0] - peaks[1]:+.2f} dB, {counts[0]:.1f} points a frame instead of {counts[1]:.1f}"
    )


if __name__ == "__main__":
    main()
