"""Which noise figure gives simulated boards the points a frame of measured ones.

    python scripts/studies/noise_figure_of_boards.py -o OUT
        [--pairs PAIRS.npz ... --cfg CFG] [--recordings FOLDER] [--walkers CFG1843] [--seeds 3]

PAIRS.npz are clouds beside joints, as `clouds_against_measured.py` reads them, CFG their board's;
FOLDER has the recordings that `radhar_classes.py` reads. Of the joints the board sees the very
movements that were measured; of the recordings it sees the movements of
configs/measured/radhar_1443.yaml, which are only of the same kind. Every echo is made once, and
noise of every figure is added to it. Half of the recordings choose: files of pairs whose name has
the word of `--choose`, and the first half of each recording of the folder. The figure whose points
a frame are nearest in the mean of |log2(simulated/measured)| over these is chosen; the other half
tells how near it comes. No recording of an IWR1843 is opened: of two walkers before it the points
are told by figure, to be compared with what is known of recordings. Writes OUT/noise_figure.md and
.json.
"""

import argparse
import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from clouds_against_measured import (
    CLOUD_LATE_S,
    OFFSET_M,
    RATE,
    Pairs,
    board_config,
    cropped,
    motion_of,
    read_pairs,
)
from numpy.typing import NDArray
from radhar_classes import CLASSES, CONFIG, FAR_M, HIGH_M, NEAR_M, SPEED_STEP, measured
from shared import commit, table

from radhar_cli.config.data_set import Config
from radhar_cli.config.reading import load_config, validated
from radhar_cli.products.run import record
from radhar_cli.scene import Scene, draw_scene

Float = NDArray[np.floating[Any]]
FIGURES_DB = (5, 10, 15, 20, 25, 30, 35)
SCENES, SCENE_S = 4, 4.05  # of each class of the recordings' movements


class Count(NamedTuple):
    """Points a frame of one recording, or of its simulation at one noise figure.

    Attributes:
        points: mean number of all points.
        moving: mean number of those that have a Doppler.
    """

    points: float
    moving: float


class Comparison(NamedTuple):
    """A recording beside its simulations.

    Attributes:
        name: of the recording.
        chooses: whether the figure is chosen by it.
        measured: points a frame of the recording.
        simulated: {figure (dB): points a frame, one for each seed}.
    """

    name: str
    chooses: bool
    measured: Count
    simulated: dict[int, list[Count]]

    def mean(self, figure: int) -> Count:
        """Mean over the seeds at a noise figure (dB)."""
        points, moving = np.mean(self.simulated[figure], axis=0).tolist()
        return Count(points, moving)

    def distance(self, figure: int) -> float:
        """|log2| of simulated over measured points a frame at a noise figure (dB)."""
        return float(abs(np.log2(self.mean(figure).points / self.measured.points)))


def with_figure(scene: Scene, figure_db: float) -> Scene:
    """Return a scene of the same draws with another noise figure (dB)."""
    config: Config = scene.config
    receiver = config.receiver.model_copy(update={"noise_figure_db": float(figure_db)})
    return replace(scene, config=config.model_copy(update={"receiver": receiver}))


def clouds_by_figure(scene: Scene, **inputs: Any) -> Iterator[tuple[int, Any]]:
    """Make the cloud of a scene at every noise figure, of one echo."""
    echo = record(scene, ["echo"], **inputs)["echo"]
    for figure in FIGURES_DB:
        yield figure, record(with_figure(scene, figure), ["cloud"], echo=echo)["cloud"]


def compare_pairs(
    path: Path, cfg: Path, chooses: bool, seeds: Sequence[int], every: int
) -> Comparison:
    """Count the points of clouds beside joints, and of what the board sees of these joints.

    Args:
        path: pairs of clouds and joints.
        cfg: file of the board.
        chooses: whether the figure is chosen by them.
        seeds: seeds of bodies and noise.
        every: how many of the stretches of frames one is taken of.
    """
    pairs = read_pairs(path)
    assert pairs.clouds is not None
    runs = list(enumerate(pairs.runs))[::every]
    clouds = [cloud for _, run in runs for cloud in pairs.clouds[run]]
    measured = count([cloud[:, 3] for cloud in clouds])
    simulated: dict[int, list[Count]] = {figure: [] for figure in FIGURES_DB}
    for seed in seeds:
        speeds: dict[int, list[Float]] = {figure: [] for figure in FIGURES_DB}
        for number, run in runs:
            for figure, frames in frames_of_run(pairs, run, cfg, seed, number):
                speeds[figure] += frames
        for figure, frames in speeds.items():
            simulated[figure].append(count(frames))
    return Comparison(path.stem, chooses, measured, simulated)


def frames_of_run(
    pairs: Pairs, run: slice, cfg: Path, seed: int, number: int
) -> Iterator[tuple[int, list[Float]]]:
    """Simulate a stretch of frames: Doppler (m/s) of each frame's points, by noise figure."""
    frames = pairs.number[run] - pairs.number[run][0]
    config = board_config(cfg, (int(frames[-1]) + 1) / RATE, seed)
    scene: Scene = draw_scene(config, config.chosen_activities[0], number)
    board = config.radar.header
    chirps = board.loops * len(board.order) * board.slot_s
    motion = motion_of(pairs, run, OFFSET_M, CLOUD_LATE_S + chirps / 2)
    for figure, cloud in clouds_by_figure(scene, motions=(motion,)):
        speeds = []
        for frame in frames:
            points = cloud.points[cloud.start[frame] : cloud.start[frame + 1]]
            right_ahead_up = np.stack([-points[:, 1], points[:, 0], points[:, 2]], axis=1)
            speeds.append(points[cropped(right_ahead_up), 3])
        yield figure, speeds


def count(speeds: Sequence[Float]) -> Count:
    """Count points a frame from the Doppler (m/s) of each frame's points."""
    return Count(
        float(np.mean([len(one) for one in speeds])),
        float(np.mean([np.count_nonzero(np.abs(one) > 1e-3) for one in speeds])),
    )


def compare_recordings(folder: Path, seeds: Sequence[int]) -> list[Comparison]:
    """Count the points of recordings' halves, and of simulated movements of the same kind."""
    clouds, labels = measured(folder)
    comparisons = []
    for name in CLASSES:
        simulated = simulate_class(name, seeds)
        for cloud in (c for c, label in zip(clouds, labels, strict=True) if CLASSES[label] == name):
            middle = int(cloud.frame.max() + 1) // 2
            for half, first in (("first", 0), ("second", middle)):
                seen = count(person_speeds(cloud.frame, cloud.points, first, first + middle))
                of_half = f"{name}, {half} half"
                comparisons.append(Comparison(of_half, half == "first", seen, simulated))
    return comparisons


def simulate_class(name: str, seeds: Sequence[int]) -> dict[int, list[Count]]:
    """Points a frame of a class of movements, by noise figure, one for each seed."""
    counts: dict[int, list[Count]] = {figure: [] for figure in FIGURES_DB}
    for seed in seeds:
        speeds: dict[int, list[Float]] = {figure: [] for figure in FIGURES_DB}
        config = load_config(CONFIG, [f"seed={seed}", f"duration_s={SCENE_S}"])
        activity = next(one for one in config.chosen_activities if one.slug == name)
        for number in range(SCENES):
            for figure, cloud in clouds_by_figure(draw_scene(config, activity, number)):
                frame = np.repeat(np.arange(len(cloud.start) - 1), np.diff(cloud.start))
                reach = np.linalg.norm(cloud.points[:, :3], axis=1)
                points = np.column_stack([cloud.points[:, :5], reach])
                speeds[figure] += person_speeds(frame, points, 0, len(cloud.start) - 1)
        for figure, frames in speeds.items():
            counts[figure].append(count(frames))
    return counts


def person_speeds(
    frame: NDArray[np.integer[Any]], points: Float, first: int, last: int
) -> list[Float]:
    """Doppler (m/s) of the points of a person, of each frame from the first to before the last.

    Args:
        frame: frame of each point [N].
        points: x, y, z (m), approaching speed (m/s), dB, range (m) [N, 6].
        first: first frame.
        last: frame after the last.
    """
    kept = (np.abs(points[:, 2]) < HIGH_M) & (points[:, 5] > NEAR_M) & (points[:, 5] < FAR_M)
    kept &= (frame >= first) & (frame < last)
    speeds = np.where(np.abs(points[kept, 3]) > SPEED_STEP / 2, points[kept, 3], 0)
    edges = np.searchsorted(frame[kept], np.arange(first, last + 1))
    return [speeds[a:b] for a, b in pairwise(edges)]


def describe_walkers(cfg: Path, seeds: Sequence[int]) -> Iterator[list[str]]:
    """Rows of a table, by noise figure: the points of two walkers before an IWR1843BOOST.

    Moving points of a frame that has any (lowest to highest of the scenes), share of such frames,
    points without a Doppler a frame, and 5, 50 and 95 % of the moving points' column SNR, dB.

    Args:
        cfg: file of the board.
        seeds: seeds of scenes.
    """
    clouds: dict[int, list[Any]] = {figure: [] for figure in FIGURES_DB}
    for seed in seeds:
        document = walkers_document(cfg.read_text(), seed)
        config = validated(Config, document, "config", {})
        for number in range(SCENES):
            scene = draw_scene(config, config.chosen_activities[0], number)
            for figure, cloud in clouds_by_figure(scene):
                clouds[figure].append(cloud)
    for figure, some in clouds.items():
        moving = [moving_points(cloud) for cloud in some]
        means = [counts[counts > 0].mean() for counts, _ in moving]
        frames = np.concatenate([counts for counts, _ in moving])
        still = np.sum([len(cloud.points) for cloud in some]) - frames.sum()
        levels = np.percentile(np.concatenate([snr for _, snr in moving]), [5, 50, 95])
        yield [
            f"{figure} dB",
            f"{np.mean(means):.1f} ({min(means):.1f} to {max(means):.1f})",
            f"{(frames > 0).mean():.0%}".replace("%", " %"),
            f"{still / len(frames):.1f}",
            "; ".join(f"{level:.0f}" for level in levels),
        ]


def walkers_document(cfg: str, seed: int) -> dict[str, Any]:
    """Document of a config of two people who walk before an IWR1843BOOST."""
    place = {"place": {"range_m": {"uniform": [1.5, 4]}}}
    return {
        "seed": seed,
        "radar": {"cfg": cfg, "device": "IWR1843BOOST", "position_m": [0, 0, 1]},
        "activities": ["walking"],
        "duration_s": 2 * SCENE_S,
        "body": {"scatterers": "surfaces"},
        "motion": place,
        "people": [{"activity": "walking", "motion": place}],
        "maps": ["points"],
        "on_invalid": "keep",
    }


def moving_points(cloud: Any) -> tuple[NDArray[np.intp], Float]:
    """Number of points with a Doppler in each frame [F], and their SNR (dB)."""
    moves = np.abs(cloud.points[:, 3]) > 1e-3
    before = np.concatenate([[0], np.cumsum(moves)])
    return np.diff(before[cloud.start]), cloud.points[moves, 5]


def choose(comparisons: Sequence[Comparison]) -> int:
    """Choose the noise figure (dB) of the least mean distance over those that choose."""
    some = [one for one in comparisons if one.chooses]
    return min(FIGURES_DB, key=lambda figure: float(np.mean([c.distance(figure) for c in some])))


def rows_of(comparisons: Sequence[Comparison]) -> Iterator[list[str]]:
    """Rows of a table: points a frame, and among them moving ones, measured and by figure."""
    for one in comparisons:
        seeds = (f"{c.points:.1f}; {c.moving:.1f}" for c in map(one.mean, FIGURES_DB))
        measured = f"{one.measured.points:.1f}; {one.measured.moving:.1f}"
        yield [one.name, "chooses" if one.chooses else "reports", measured, *seeds]


def describe_comparisons(comparisons: Sequence[Comparison]) -> list[str]:
    """Lines of two tables: points a frame by recording and figure, and the halves' distances."""
    figures = [f"{figure} dB" for figure in FIGURES_DB]
    halves = []
    for half, which in (("chooses", True), ("reports", False)):
        some = [one for one in comparisons if one.chooses == which]
        means = (np.mean([one.distance(figure) for one in some]) for figure in FIGURES_DB)
        halves.append([half, *(f"{mean:.2f}" for mean in means)])
    return [
        *table(("", "half", "measured", *figures), rows_of(comparisons)),
        "",
        *table(("mean of abs(log2)", *figures), halves),
        "",
    ]


def main() -> None:
    """Compare, choose, and write what came out."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--pairs", type=Path, nargs="*", default=[])
    parser.add_argument("--cfg", type=Path, help="the .cfg of the pairs' board")
    parser.add_argument("--recordings", type=Path)
    parser.add_argument("--walkers", type=Path, help=".cfg of an IWR1843 that sees two walkers")
    parser.add_argument("--choose", default="_test", help="word in the name of pairs that choose")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--every", type=int, default=1, help="take one of so many stretches")
    parser.add_argument("-o", "--out", type=Path, required=True)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    seeds = range(1, given.seeds + 1)
    comparisons = [
        compare_pairs(path, given.cfg, given.choose in path.stem, seeds, given.every)
        for path in given.pairs
    ]
    if given.recordings:
        comparisons += compare_recordings(given.recordings, seeds)
    lines = []
    if comparisons:
        lines += describe_comparisons(comparisons)
        lines += [f"chosen: {choose(comparisons)} dB", ""]
    if given.walkers:
        header = ("two walkers", "moving points", "frames", "without Doppler", "SNR")
        lines += table(header, describe_walkers(given.walkers, seeds))
    (given.out / "noise_figure.md").write_text("\n".join(lines) + "\n")
    report = {"commit": commit(), "comparisons": [one._asdict() for one in comparisons]}
    (given.out / "noise_figure.json").write_text(json.dumps(report, indent=1) + "\n")
    print("\n".join(lines))
    print(f"noise figures: {given.seeds} seeds, {commit()}")


if __name__ == "__main__":
    main()
