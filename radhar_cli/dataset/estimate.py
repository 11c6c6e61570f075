"""Estimate of the bytes and the time of a build, from some samples made in memory by its processes.

Time of a build: a start (imports, the checks before it, the processes), a time for each sample, and
an end (assembly, card). The start and the samples are measured, whatever else the machine does.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import inf, prod, sqrt
from statistics import mean, stdev
from time import perf_counter, process_time
from typing import Any, NamedTuple

from radhar_cli.config.data_set import Config
from radhar_cli.dataset.batch import CHECKED_SCENES, check_scenes
from radhar_cli.dataset.build import choose_batch_size
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.layout import SPLITS, Rows, row_bytes
from radhar_cli.dataset.sample import SampleRow, synthesise
from radhar_cli.dataset.shards import encode_shard
from radhar_cli.dataset.split import split_rows
from radhar_cli.dataset.trial import DRAW, WRITE, Trial, TrialSample, try_samples
from radhar_cli.dataset.workers import cores
from radhar_cli.errors import RadharError
from radhar_cli.processes.progress import NO_PROGRESS, Progress
from radhar_cli.processes.time_limit import time_limit
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.products.table import plan_images

TRIED = 48  # samples at most
DRY_RUN_S = 30.0  # of a dry run, whatever a sample takes
CHECK_SHARE = 0.4  # of it, for the check of scenes
TRIAL_S = 3.0  # of a sample, to see whether it is worth a process
PAYS_S = 0.6  # of work, from which on a worker is worth its start
# Measured (docs/records/costs.md): processor time of a file, and of what follows the samples.
FILE_S = 0.0003
END_S, END_SAMPLE_S, END_BYTE_S = 0.2, 0.0003, 1e-8
PIXEL_S = 1e-6  # of a pixel of an image that smallnet is trained on, in an epoch
EPOCHS = 30  # of `radhar train`
START_END = "start and end"
# What stages are that are no products.
STAGES = {
    DRAW: "every scene, and again where it is outside the model",
    WRITE: "PNG files and HDF5",
    START_END: "imports, first checks, processes; assembly and card",
}
DOUBT, DOUBT_OF_ONE = 0.15, 0.5  # of a time that many samples tell, and one
BUSY = 0.9  # share of a core, below which a process is slowed down by others


@dataclass(frozen=True)
class Estimate:
    """Estimated cost of a whole build."""

    samples: int  # in the data set
    probes: int  # samples timed
    seconds_per_sample: float  # of one process
    hdf5_bytes: int
    png_bytes: int
    seconds: float  # wall time, the machine as busy as now
    seconds_range: tuple[float, float]  # in which it should lie
    seconds_alone: float  # wall time where nothing else runs
    processor_seconds: float  # of all processes
    core_share: float  # of a core that a process had; below 1 where others work, too
    shares: Mapping[str, float]  # of the processor time by stage, %


@dataclass(frozen=True)
class AtLeast:
    """Least cost of a build of which no sample was finished in time."""

    samples: int  # in the data set
    seconds_range: tuple[float, float]  # of the wall time: from some time on
    probes: int = 0  # samples timed


@dataclass(frozen=True)
class BuildPlan:
    """Result of a dry run."""

    jobs: int  # processes of the build
    checked: int  # scenes
    redrawn: int  # of them, drawn more than once
    warnings: list[dict[str, Any]]  # of the checked scenes and the config
    cost: Estimate | AtLeast
    waited: float  # for a sample, s
    cut_short: bool  # fewer scenes were checked than usual
    training_seconds: float  # of one core, for the default network on the images of a map


def plan_build(config: Config, jobs: int | None, progress: Progress, seconds: float) -> BuildPlan:
    """Check scenes and time samples; nothing is written.

    Args:
        config: that of the data set.
        jobs: number of processes of the build; None for as many as pay.
        progress: is told of every scene and sample.
        seconds: longest time for all of it, s.
    """
    start = perf_counter()
    if jobs is None:
        jobs = jobs_that_pay(config)
    before = process_time()  # since the program began
    scenes, warnings = check_scenes(config, CHECK_SHARE * seconds, progress)
    usual_scenes = min(CHECKED_SCENES, len(Rows.of(config)))
    before += (process_time() - before) * usual_scenes / max(1, len(scenes))
    seconds_for_samples = seconds - (perf_counter() - start)
    cost = estimate(config, jobs, seconds_for_samples, progress, before)
    return BuildPlan(
        jobs,
        len(scenes),
        sum(scene.attempt > 0 for scene in scenes),
        warnings,
        cost,
        seconds_for_samples,
        len(scenes) < usual_scenes,
        training_seconds(config),
    )


def jobs_that_pay(config: Config) -> int:
    """Number of processes for a build: one a core, but each with more work than its start."""
    rows, seconds = Rows.of(config), PAYS_S  # of a sample
    if cores() > 1 and len(rows) > 1:
        with suppress(RadharError), time_limit(TRIAL_S):  # errors, which the build will tell
            plan, place = plan_images(config), rows[len(rows) // 2]
            for _ in range(2):  # the first imports
                start = process_time()
                synthesise(draw_valid_scene(config, *place)[0], plan, config)
                seconds = process_time() - start
                if seconds > PAYS_S:
                    break
    return max(1, min(cores(), int(len(rows) * seconds / PAYS_S)))


def training_seconds(config: Config) -> float:
    """Time of one core that training on the images of a map takes by default, s."""
    images = int((split_rows(config) == SPLITS.index("train")).sum())
    return PIXEL_S * images * prod(config.image.size_px) * EPOCHS


def estimate(
    config: Config,
    jobs: int,
    seconds: float = inf,
    progress: Progress = NO_PROGRESS,
    before: float = 0.0,
) -> Estimate | AtLeast:
    """Time samples spread over the classes, and scale up to a build; nothing is written.

    Args:
        config: that of the data set.
        jobs: number of processes of the build.
        seconds: longest time, s.
        progress: is told of every sample.
        before: processor time of a build before its processes start, s.
    """
    rows = Rows.of(config)
    trial = try_samples(config, rows.spread_progressively(TRIED), jobs, seconds, progress)
    if not trial.samples:
        return AtLeast(len(rows), (seconds * len(rows) / jobs, inf))
    written = encode_samples(config, [sample.row for sample in trial.samples])
    return scale_up(config, trial, written, jobs, before)


class WrittenSamples(NamedTuple):
    """Size of samples in the HDF5 file, and the processor time to write them."""

    sample_bytes: float  # of each
    sample_seconds: float  # processor time of each, s
    shard_seconds: float  # of a shard without samples, s


def encode_samples(config: Config, rows: Sequence[SampleRow]) -> WrittenSamples:
    """Encode samples as a shard, and one alone, to tell the cost of samples and shards.

    Args:
        config: that of the data set.
    """
    owner = identity_hash(identity(config))

    def encode(part: Sequence[SampleRow]) -> tuple[int, float]:
        start = process_time()
        size = len(encode_shard(config, owner, 0, part))
        return size, process_time() - start

    encode(rows[:1])  # the first imports
    size, alone = encode(rows[:1])
    size_of_two, _ = encode([rows[0], rows[0]])
    several = rows if len(rows) > 1 else [rows[0], rows[0]]
    size_of_all, together = encode(several)
    each = max(0.0, together - alone) / (len(several) - 1)
    sample_bytes = (size_of_all - (2 * size - size_of_two)) / len(several)
    return WrittenSamples(sample_bytes, each, max(0.0, alone - each))


def scale_up(
    config: Config, trial: Trial, written: WrittenSamples, jobs: int, before: float
) -> Estimate:
    """Scale the time and the bytes of samples up to those of a build.

    Args:
        config: that of the data set.
        trial: samples of it, one at least.
        written: cost of writing them.
        jobs: number of processes.
        before: processor time of a build before its processes start, s.
    """
    count, samples = len(Rows.of(config)), trial.samples
    share = min(1.0, sum(s.processor for s in samples) / sum(s.wall for s in samples))
    batch = choose_batch_size(count, jobs, row_bytes(config))
    files = len(config.maps) if config.output.png else 0
    write = written.sample_seconds + written.shard_seconds / batch + FILE_S * files
    wall = mean(sample.wall for sample in samples) + write / share
    hdf5_bytes = int(count * written.sample_bytes)
    outside = before + END_S + count * END_SAMPLE_S + hdf5_bytes * END_BYTE_S
    in_turn = _samples_of_busiest(count, batch, jobs)
    seconds = outside / share + _start_seconds(trial) + in_turn * wall
    stages, start = _stages_of_build(samples, count), _start_processor_seconds(trial, jobs)
    stages[WRITE] += count * write
    alone = outside + start / jobs + sum(stages.values()) * in_turn / count
    stages[START_END] = outside + start
    total, doubt = sum(stages.values()), _doubt(samples)
    return Estimate(
        samples=count,
        probes=len(samples),
        seconds_per_sample=wall,
        hdf5_bytes=hdf5_bytes,
        png_bytes=int(count * mean(sample.png_bytes for sample in samples)),
        seconds=seconds,
        seconds_range=(seconds * (1 - doubt), seconds * (1 + doubt)),
        seconds_alone=min(alone, seconds),
        processor_seconds=total,
        core_share=share,
        shares={stage: 100 * spent / total for stage, spent in stages.items()},
    )


def _samples_of_busiest(count: int, batch: int, jobs: int) -> int:
    """Number of samples that the process makes one after the other that makes most of them."""
    batches, rest = divmod(count, batch)
    return batch * -(-batches // jobs) + (0 if batches % jobs else rest)


def _stages_of_build(samples: Sequence[TrialSample], count: int) -> dict[str, float]:
    """Processor time of all samples of a build by stage, s, in running order."""
    scale = count / len(samples)
    return {stage: scale * sum(s.stages[stage] for s in samples) for stage in samples[0].stages}


def _start_seconds(trial: Trial) -> float:
    """Time until every process has begun to work at its usual speed, s."""
    usual = mean(sample.wall for sample in trial.samples)
    return max(0.0, max(sample.ended for sample in trial.first) - trial.begun - usual)


def _start_processor_seconds(trial: Trial, jobs: int) -> float:
    """Processor time that processes take until they work at their usual speed, s."""
    usual = mean(sample.processor for sample in trial.samples)
    starts = [
        sample.processor - usual + (sample.processor_before if jobs > 1 else 0)
        for sample in trial.first
    ]
    return max(0.0, jobs * mean(starts))


def _doubt(samples: Sequence[TrialSample]) -> float:
    """Doubt about a time that some samples tell, relative to it."""
    if len(samples) == 1:
        return DOUBT_OF_ONE
    walls = [sample.wall for sample in samples]
    return min(DOUBT_OF_ONE, DOUBT + 2 * stdev(walls) / mean(walls) / sqrt(len(walls)))
