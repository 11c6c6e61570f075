"""Samples made on trial, by the processes of a build, to estimate the cost of a data set."""

import os
from collections.abc import Iterator, Mapping, Sequence
from math import inf
from time import monotonic, process_time
from typing import NamedTuple

from radhar_cli.config.data_set import Config
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.png import colour_table, encode_png
from radhar_cli.dataset.sample import SampleRow, store
from radhar_cli.dataset.workers import run_within
from radhar_cli.numerics.arrays import Levels
from radhar_cli.processes.progress import Progress
from radhar_cli.processes.worker_process import prepare_process
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.products.plan import Plan
from radhar_cli.scene.products.run import run
from radhar_cli.scene.products.table import plan_images

ENOUGH_S = 5.0  # of a trial, once each process has made its first sample
DRAW, WRITE = "draw and check", "write"  # stages of a sample before and after those of its plan


class TrialSample(NamedTuple):
    """One sample that was made on trial, and its time."""

    process: int  # number of the process that made it
    row: SampleRow
    png_bytes: int
    started: float  # by a clock that all processes of a machine share, s
    ended: float
    processor_before: float  # processor time of the process before, s
    stages: Mapping[str, float]  # processor time by stage, s, in running order

    @property
    def wall(self) -> float:
        """Time that passed, s."""
        return self.ended - self.started

    @property
    def processor(self) -> float:
        """Processor time, s."""
        return sum(self.stages.values())


class _Preparations(NamedTuple):
    """Objects that a process makes once for all samples of a batch."""

    config: Config
    plan: Plan
    rows: Rows
    columns: tuple[scene_fields.Field, ...]
    table: Levels | None


_PREPARED: dict[str, _Preparations] = {}  # by the identity of a data set, the latest alone


def _prepare(config: Config, data_set: str) -> _Preparations:
    """Prepare a process for samples of a data set; a copy of its config finds it prepared.

    Args:
        config: that of the data set.
        data_set: hash of its identity.
    """
    if data_set not in _PREPARED:
        prepare_process()
        table = colour_table(config.image.colour_map) if config.output.png else None
        plan, columns = plan_images(config), scene_fields.fields(config)
        _PREPARED.clear()
        _PREPARED[data_set] = _Preparations(config, plan, Rows.of(config), columns, table)
    return _PREPARED[data_set]


def make_trial_sample(config: Config, data_set: str, row: int) -> TrialSample:
    """Make one sample of a data set, down to the bytes of its PNG files; nothing is written.

    Args:
        config: that of the data set.
        data_set: hash of its identity.
    """
    config, plan, rows, columns, table = _prepare(config, data_set)
    started, before = monotonic(), process_time()
    scene, _ = draw_valid_scene(config, *rows[row])
    stages = {DRAW: process_time() - before}
    recording = run(plan, {"scene": scene})
    stages |= recording.seconds
    start = process_time()
    sample = store(recording, scene, config)
    values, png_bytes = scene_fields.values(scene, columns, sample.error_db), 0
    if table is not None:
        level, images = config.output.png_level, sample.images.values()
        png_bytes = sum(len(encode_png(image.levels, table, level)) for image in images)
    stages[WRITE] = process_time() - start
    made_row = SampleRow(sample, values)
    return TrialSample(os.getpid(), made_row, png_bytes, started, monotonic(), before, stages)


class Trial(NamedTuple):
    """Samples of a trial."""

    begun: float  # when processes began to start, by the clock of the samples, s
    first: tuple[TrialSample, ...]  # of each process: with its imports, tables and caches
    further: tuple[TrialSample, ...]

    @property
    def samples(self) -> tuple[TrialSample, ...]:
        """Samples that tell the time of one: the further ones, or else the first."""
        return self.further or self.first


def try_samples(
    config: Config, places: Sequence[int], jobs: int, seconds: float, progress: Progress
) -> Trial:
    """Make samples by as many processes as a build will have, for a while.

    Args:
        config: that of the data set.
        places: rows to make, in this order; the first ones are made twice.
        jobs: number of processes.
        seconds: longest time, s.
        progress: is told of every sample.
    """
    data_set = identity_hash(identity(config))
    begun, by_process, end = monotonic(), dict[int, list[TrialSample]](), inf

    def tasks() -> Iterator[tuple[Config, str, int]]:
        for row in [*places[:jobs], *places]:
            if monotonic() > end:
                return
            yield config, data_set, row

    def receive(sample: TrialSample) -> None:
        nonlocal end
        samples = by_process.setdefault(sample.process, [])
        samples.append(sample)
        progress.advance(int(len(samples) > 1))
        if end == inf and len(by_process) == jobs:
            end = monotonic() + ENOUGH_S

    progress.stage("timing samples", len(places), 0)
    run_within(make_trial_sample, tasks(), jobs, seconds, receive)
    first = tuple(samples[0] for samples in by_process.values())
    further = tuple(sample for samples in by_process.values() for sample in samples[1:])
    return Trial(begun, first, further)
