"""Fit the simulation of a board to measured clouds without labels: its noise, and where people are.

A detector passes what stands out of the noise, so the number of moving points a frame falls as the
noise rises; points that stand still are the room's as well, and do not count. Scenes of a config
are simulated, their noise is scaled, and the noise figure is that at which they have as many points
as were measured. Clouds lie nearer than the people do, by what is measured on the same scenes.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from os.path import relpath
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.capture.point_recording import PointRecording, is_point_recording
from radhar_cli.config import load_config
from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.config.reading import with_overrides
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.errors import CaptureError, ConfigError, FolderError
from radhar_cli.figures.page import page, write_figure
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.processes.progress import NO_PROGRESS, Progress
from radhar_cli.processing.points import Cloud
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.products.run import record
from radhar_cli.schema.number import nominal

SCENES = 12  # that are simulated, of all activities in turn
FIGURES_DB = np.arange(0.0, 61.0, 3.0)  # noise figures that are tried
MOST_SAMPLES = 2000  # of a measured data set that are read, evenly over it
WINDOW_S = 2.0  # of a recording, as long as a sample
RESAMPLES = 400
ENDS = 5, 95  # percentiles of places between which people are drawn
POINTS = "points"


class MeasuredSample(NamedTuple):
    """Counts and place of a measured sample."""

    counts: Index  # moving points of each frame
    middle: Float  # median of their places (ahead, left, up), m; NaN of an empty sample


class SimulatedSample(NamedTuple):
    """Counts and places of a simulated sample, by noise figure."""

    counts: Index  # moving points [figure, frame]
    offset: Float  # median of the points less that of the joints, m [figure, (ahead, left, up)]


@dataclass(frozen=True)
class CloudFit:
    """Noise and places of measured clouds, for a config of their board and room."""

    config: Config
    base: str  # by which the config is named in the file that is written
    measured: Sequence[MeasuredSample]
    simulated: Sequence[SimulatedSample]
    overrides: Sequence[str]  # KEY=VALUE of the config

    @cached_property
    def measured_points(self) -> float:
        """Measured moving points a frame, mean over samples."""
        return float(np.mean([sample.counts.mean() for sample in self.measured]))

    @cached_property
    def simulated_points(self) -> Float:
        """Simulated moving points a frame at each noise figure, mean over samples."""
        counts = np.array([sample.counts.mean(axis=1) for sample in self.simulated])
        return np.asarray(counts.mean(axis=0))

    @cached_property
    def noise_figure_db(self) -> float:
        """Noise figure at which the simulation has as many moving points as were measured, dB."""
        return figure_of(self.simulated_points, self.measured_points)

    @cached_property
    def _nearest(self) -> int:
        """Number of the noise figure that was tried nearest to the one that is found."""
        return int(np.abs(FIGURES_DB - self.noise_figure_db).argmin())

    @cached_property
    def interval_db(self) -> tuple[float, float]:
        """95 % of noise figures of measured and simulated samples that are drawn again, dB."""
        rng = np.random.default_rng(0)
        measured = np.array([sample.counts.mean() for sample in self.measured])
        simulated = np.array([sample.counts.mean(axis=1) for sample in self.simulated])
        figures = [
            figure_of(
                rng.choice(simulated, len(simulated)).mean(axis=0),
                rng.choice(measured, len(measured)).mean(),
            )
            for _ in range(RESAMPLES)
        ]
        low, high = np.percentile(figures, (2.5, 97.5)).tolist()
        return low, high

    @property
    def document(self) -> dict[str, Any]:
        """Config of the estimates over its base, as plain values by key."""
        document: dict[str, Any] = {
            "base": self.base,
            "snr_db": None,
            "receiver": {"noise_figure_db": round(self.noise_figure_db, 1)},
        }
        if (place := self.place()) is not None:
            document["motion"] = {"place": place}
        return with_overrides(document, self.overrides)

    def place(self) -> dict[str, Any] | None:
        """Section `motion.place` of the people; None where the config does not place them so."""
        radar, motion = self.config.radar, self.config.motion
        assert isinstance(radar, ArrayRadar)
        turned = any(nominal(angle) for angle in (radar.yaw_deg, radar.tilt_deg, radar.roll_deg))
        elsewhere = motion.model != "human" or motion.range_m is not None or self.config.people
        if turned or elsewhere:
            return None
        middles = np.array([sample.middle for sample in self.measured])[:, :2]
        offsets = np.array([sample.offset[self._nearest] for sample in self.simulated])[:, :2]
        if np.isnan(middles).all() or np.isnan(offsets).all():
            return None
        radar_m = np.array([nominal(part) for part in radar.position_m])[:2]
        low, high = np.nanpercentile(middles, ENDS, axis=0) - np.nanmedian(offsets, axis=0)
        laws = [
            {"uniform": [a, b]} if b > a else a
            for a, b in zip(
                *(np.round(end + radar_m, 2).tolist() for end in (low, high)), strict=True
            )
        ]
        return dict(zip(("range_m", "cross_range_m"), laws, strict=True))

    @property
    def notes(self) -> list[str]:
        """Notes on what is not fitted."""
        if "motion" in self.document:
            return []
        return [
            "motion.place is not fitted: there are several people, the config places them "
            "otherwise, or the board is turned"
        ]

    @property
    def source(self) -> str:
        """Data that the config was fitted to, in words."""
        return f"{len(self.measured)} samples of clouds"

    def numbers(self) -> dict[str, float]:
        """Summary of the estimates; the noise figure has the ends of its 95 % interval."""
        low, high = self.interval_db
        return {
            "parts": len(self.measured),
            "moving_points": self.measured_points,
            "noise_figure_db": self.noise_figure_db,
            "noise_figure_db_from": low,
            "noise_figure_db_to": high,
        }

    def draw(self, path: Path) -> None:
        """Write a figure of points over noise figure, and of the points of frames on both sides."""
        figure = page(10.0, 3.5)
        curve, counts = figure.subplots(1, 2)
        curve.plot(FIGURES_DB, self.simulated_points, "o-", label="simulated")
        curve.axhline(self.measured_points, color="k", linestyle="--", label="measured")
        curve.axvspan(*self.interval_db, alpha=0.2, label="fitted, 95 %")
        curve.set(xlabel="noise figure (dB)", ylabel="moving points a frame")
        sides: Mapping[str, Index] = {
            "measured": np.concatenate([sample.counts for sample in self.measured]),
            f"simulated, {FIGURES_DB[self._nearest]:g} dB": np.concatenate(
                [sample.counts[self._nearest] for sample in self.simulated]
            ),
        }
        top = max(int(np.percentile(side, 99)) for side in sides.values()) + 1
        for name, side in sides.items():
            shares = np.bincount(side.clip(max=top), minlength=top + 1) / len(side)
            counts.step(np.arange(top + 1), 100 * shares, where="mid", label=name)
        counts.set(xlabel="moving points in a frame", ylabel="frames (%)")
        for axes in (curve, counts):
            axes.legend()
        write_figure(figure, path, 90)


def figure_of(points: Float, measured: float) -> float:
    """Noise figure at which a simulation has so many moving points, dB, within those tried.

    Args:
        points: points a frame at each of `FIGURES_DB`, which fall but for chance.
        measured: points a frame that it should have.
    """
    falling = np.minimum.accumulate(points)
    return float(np.interp(-measured, -falling, FIGURES_DB))


def ask_for_config(path: Path) -> None:
    """Ask for a config where a path holds clouds, which do not tell their board as signals do.

    Raises:
        FolderError: it is a data set or a recording of points.
    """
    is_data_set = (path / "dataset.h5").is_file() or path.name == "dataset.h5"
    if is_data_set or (path.is_file() and is_point_recording(path)):
        raise FolderError(
            f"{path}: holds clouds; --config should name a config of their board and room, such as "
            "--config boards/iwr1443"
        )


def fit_clouds(
    paths: Sequence[Path],
    config: Path,
    out: Path,
    overrides: Sequence[str] = (),
    progress: Progress = NO_PROGRESS,
) -> CloudFit:
    """Estimate noise and places of people from measured clouds of a board.

    Args:
        paths: data sets of clouds and recordings of points, all of one board and room.
        config: config of that board and room, or the name of one that radhar comes with.
        out: file for which the document is meant, in which a config is named from its folder.
        overrides: KEY=VALUE of the config.
        progress: is told of each scene that is simulated.

    Raises:
        CaptureError: no noise gives as many points, or as few, as were measured.
        ConfigError: the config has no clouds, or an override cannot be used.
        FolderError: a path holds no clouds.
    """
    base = relpath(config, out.parent) if config.is_file() else str(config)
    thermal = (*overrides, "snr_db=null", "receiver.noise_figure_db=0", "maps=[points]")
    loaded = load_config(config, thermal)
    if not isinstance(loaded.radar, ArrayRadar):
        raise ConfigError(
            f"{config}: radar: has no clouds; should be that of a board, such as boards/iwr1443"
        )
    measured = [sample for path in paths for sample in _read_samples(path)]
    fitted = CloudFit(loaded, base, measured, _simulate(loaded, progress), overrides)
    highest, lowest = fitted.simulated_points[[0, -1]].tolist()
    if not lowest <= fitted.measured_points <= highest:
        raise CaptureError(
            f"{paths[0]}: has {fitted.measured_points:.3g} moving points a frame; {config} has "
            f"{lowest:.3g} to {highest:.3g} with noise figures of {FIGURES_DB[-1]:g} to "
            f"{FIGURES_DB[0]:g} dB: the thresholds of radar.cfg (cfarCfg), cloud.chain or the "
            "movements differ"
        )
    return fitted


def _read_samples(path: Path) -> Iterator[MeasuredSample]:
    """Yield the samples of a data set, or windows of a recording of points."""
    if path.is_file() and is_point_recording(path):
        with PointRecording(path) as recording:
            for begin in np.arange(0.0, max(recording.duration - WINDOW_S, 0) + 1e-9, WINDOW_S):
                yield sample_of(recording.window(float(begin), WINDOW_S))
        return
    with open_dataset(path) as data:
        if POINTS not in data.products:
            raise FolderError(f"{path}: has no clouds; should have been made with maps: [points]")
        points, starts = data.products[POINTS], data.products[f"{POINTS}_start"]
        step = -(-len(points) // MOST_SAMPLES)
        for row in range(0, len(points), step):
            yield sample_of(Cloud(points[row], starts[row]))


def sample_of(cloud: Cloud) -> MeasuredSample:
    """Moving points of each frame of a cloud, and the median of their places."""
    moving = cloud.points[:, 3] != 0  # unknown Doppler, NaN, is taken for movement
    counts = np.diff(np.concatenate([[0], np.cumsum(moving)])[cloud.start])
    return MeasuredSample(counts, _median_place(cloud.points[moving, :3]))


def _median_place(places: Float) -> Float:
    """Median [3] of places [n, 3]; NaN of none."""
    return np.median(places, axis=0) if len(places) else np.full(3, np.nan)


def _simulate(config: Config, progress: Progress) -> list[SimulatedSample]:
    """Simulate scenes of all activities in turn, each at all noise figures.

    Args:
        config: config whose noise figure is 0 dB.
        progress: is told of each scene.
    """
    activities = config.chosen_activities
    progress.stage("scenes", SCENES, 0, "scene")
    samples = []
    for number in range(SCENES):
        index, place = divmod(number, len(activities))
        scene = draw_valid_scene(config, activities[place], index)[0]
        results = record(scene, ["echo", "cube", "skeletons"])
        echo, joints = results["echo"].cube, results["skeletons"].positions
        noise = results["cube"] - echo
        centre = _median_place(joints[np.isfinite(joints).all(axis=-1)])  # an absent one is NaN
        by_figure = [
            sample_of(record(scene, ["cloud"], cube=echo + 10 ** (figure / 20) * noise)["cloud"])
            for figure in FIGURES_DB
        ]
        samples.append(
            SimulatedSample(
                np.array([sample.counts for sample in by_figure]),
                np.array([sample.middle - centre for sample in by_figure]),
            )
        )
        progress.advance(1)
    return samples
