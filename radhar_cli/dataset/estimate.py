"""Estimate of the bytes and the time of a build, from a few samples made in memory."""

from contextlib import suppress
from dataclasses import dataclass, replace
from math import inf
from time import perf_counter, process_time
from typing import Any, NamedTuple

from radhar_cli.config.data_set import Config
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.batch import CHECKED_SCENES, check_scenes
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.png import colour_table, encode_png
from radhar_cli.dataset.sample import SampleRow, synthesise
from radhar_cli.dataset.shards import encode_shard
from radhar_cli.dataset.workers import cores
from radhar_cli.errors import RadharError
from radhar_cli.processes.progress import NO_PROGRESS, Progress
from radhar_cli.processes.time_limit import time_limit
from radhar_cli.processes.worker_process import prepare_process
from radhar_cli.products.table import plan_images
from radhar_cli.scene_checks.drawing import draw_valid_scene

PROBES = 24
PROBE_SECONDS = 8.0
DRY_RUN_S = 10.0  # of a dry run, whatever a sample takes
CHECK_SHARE = 0.4  # of it, for the check of scenes
TRIAL_S = 3.0  # of a sample, to see whether it is worth a process
PARALLEL_EFFICIENCY = 0.75
WORKER_START_S = 1.5
PAYS_S = 0.6  # of work, from which on a worker is worth its start
FIXED_S = 1.0
FILE_WRITE_S = 0.0002


@dataclass(frozen=True)
class Estimate:
    """Estimated cost of a whole build; None where no sample was finished."""

    samples: int  # in the data set
    probes: int  # samples timed
    seconds_per_sample: float | None  # of one process
    hdf5_bytes: int | None
    png_bytes: int | None
    seconds: float | None  # wall time with the jobs asked for


@dataclass(frozen=True)
class BuildPlan:
    """Result of a dry run."""

    jobs: int  # processes of the build
    checked: int  # scenes
    redrawn: int  # of them, drawn more than once
    warnings: list[dict[str, Any]]  # of the checked scenes and the config
    cost: Estimate
    waited: float  # for a sample, s
    cut_short: bool  # fewer scenes were checked than usual


def plan_build(config: Config, jobs: int | None, progress: Progress, seconds: float) -> BuildPlan:
    """Check scenes and time samples; nothing is written.

    Args:
        config: that of the data set.
        jobs: number of processes of the build; None for as many as pay.
        progress: is told of every scene and sample.
        seconds: longest time for all of it, s.
    """
    start = perf_counter()
    scenes, warnings = check_scenes(config, CHECK_SHARE * seconds, progress)
    seconds_for_samples = seconds - (perf_counter() - start)
    cost = estimate(config, jobs or 1, seconds_for_samples, progress)
    if jobs is None:
        jobs = _paid_jobs(len(Rows.of(config)), cost.seconds_per_sample or PAYS_S)
        cost = replace(cost, seconds=_build_seconds(cost, jobs))
    return BuildPlan(
        jobs,
        len(scenes),
        sum(scene.attempt > 0 for scene in scenes),
        warnings,
        cost,
        seconds_for_samples,
        len(scenes) < min(CHECKED_SCENES, cost.samples),
    )


def jobs_that_pay(config: Config) -> int:
    """Number of processes for a build: one a core, but each with more work than its start."""
    rows, seconds = Rows.of(config), PAYS_S  # of a sample
    if cores() > 1:
        with suppress(RadharError), time_limit(TRIAL_S):  # errors, which the build will tell
            plan, place = plan_images(config), rows[len(rows) // 2]
            for _ in range(2):  # the first imports
                start = process_time()
                synthesise(draw_valid_scene(config, *place)[0], plan, config)
                seconds = process_time() - start
                if seconds > PAYS_S:
                    break
    return _paid_jobs(len(rows), seconds)


def _paid_jobs(samples: int, seconds: float) -> int:
    """Number of processes that pay for samples of so many seconds each."""
    return max(1, min(cores(), int(samples * seconds / PAYS_S)))


class _Probe(NamedTuple):
    """Sample that was made to be timed."""

    row: SampleRow
    png_bytes: int
    seconds: float


def estimate(
    config: Config, jobs: int, seconds: float = inf, progress: Progress = NO_PROGRESS
) -> Estimate:
    """Time samples spread over the classes, and scale up to a build; nothing is written.

    Args:
        config: that of the data set.
        jobs: number of processes of the build.
        seconds: no more samples are made when that time is over.
        progress: is told of every sample.
    """
    prepare_process()
    rows, plan, columns = Rows.of(config), plan_images(config), scene_fields.fields(config)
    table = colour_table(config.image.colour_map) if config.output.png else None
    places, probes = rows.spread_progressively(PROBES), list[_Probe]()
    progress.stage("timing samples", len(places), 0)
    with time_limit(seconds):
        # Imports, tables and caches are not part of a sample: the first counts if it is the only.
        for number, place in enumerate([places[0], *places]):
            start = perf_counter()
            scene, _ = draw_valid_scene(config, *rows[place])
            sample, png_bytes = synthesise(scene, plan, config), 0
            values = scene_fields.values(scene, columns, sample.error_db)
            if table is not None:
                level, images = config.output.png_level, sample.images.values()
                png_bytes = sum(len(encode_png(image.levels, table, level)) for image in images)
            probes.append(_Probe(SampleRow(sample, values), png_bytes, perf_counter() - start))
            progress.advance(int(number > 0))
            if sum(probe.seconds for probe in probes[1:]) > PROBE_SECONDS:
                break
    probes = probes[1:] or probes
    probe_count = len(probes)
    if not probes:
        return Estimate(len(rows), 0, None, None, None, None)
    start = perf_counter()
    hash_of_identity = identity_hash(identity(config))
    shard = encode_shard(config, hash_of_identity, 0, [probe.row for probe in probes])
    per_sample = (sum(probe.seconds for probe in probes) + perf_counter() - start) / probe_count
    if config.output.png:
        per_sample += FILE_WRITE_S * len(config.maps)
    cost = Estimate(
        samples=len(rows),
        probes=probe_count,
        seconds_per_sample=per_sample,
        hdf5_bytes=len(shard) * len(rows) // probe_count,
        png_bytes=sum(probe.png_bytes for probe in probes) * len(rows) // probe_count,
        seconds=None,
    )
    return replace(cost, seconds=_build_seconds(cost, jobs))


def _build_seconds(cost: Estimate, jobs: int) -> float | None:
    """Wall time of a build by so many processes, s; None where no sample was timed."""
    if cost.seconds_per_sample is None:
        return None
    workers = 1 if jobs == 1 else 1 + (jobs - 1) * PARALLEL_EFFICIENCY
    work = cost.seconds_per_sample * cost.samples / workers
    return FIXED_S + work + (WORKER_START_S if jobs > 1 else 0)
