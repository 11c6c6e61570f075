"""Samples made on trial, by the processes of a build, to see what a data set will cost."""

import os
from collections.abc import Iterator, Mapping, Sequence
from math import inf
from time import monotonic, process_time
from typing import NamedTuple

from radhar_cli.config.data_set import Config
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.png import colour_table, encode_png
from radhar_cli.dataset.sample import SampleRow, store
from radhar_cli.dataset.workers import run_within
from radhar_cli.processes.progress import Progress
from radhar_cli.processes.worker_process import prepare_process
from radhar_cli.products.run import run
from radhar_cli.products.table import plan_images
from radhar_cli.scene_checks.drawing import draw_valid_scene

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


def make_trial_sample(config: Config, row: int) -> TrialSample:
    """Make one sample of a data set, down to the bytes of its PNG files; nothing is written."""
    prepare_process()
    plan, started, before = plan_images(config), monotonic(), process_time()
    scene, _ = draw_valid_scene(config, *Rows.of(config)[row])
    stages = {DRAW: process_time() - before}
    recording = run(plan, {"scene": scene})
    stages |= recording.seconds
    start = process_time()
    sample = store(recording, scene, config)
    values = scene_fields.values(scene, scene_fields.fields(config), sample.error_db)
    png_bytes = 0
    if config.output.png:
        table, level = colour_table(config.image.colour_map), config.output.png_level
        png_bytes = sum(
            len(encode_png(image.levels, table, level)) for image in sample.images.values()
        )
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
        """Samples that tell what one takes: the further ones, or else the first."""
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
    begun, by_process, end = monotonic(), dict[int, list[TrialSample]](), inf

    def tasks() -> Iterator[tuple[Config, int]]:
        for row in [*places[:jobs], *places]:
            if monotonic() > end:
                return
            yield config, row

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
