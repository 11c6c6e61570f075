"""What a build will take: bytes and time, from a few samples made in memory there and then."""

from contextlib import suppress
from dataclasses import dataclass
from time import perf_counter, process_time

import numpy as np

from radhar_cli.config.schema import Config
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.png import colour_table, encode_png
from radhar_cli.dataset.sample import synthesise
from radhar_cli.dataset.shards import encode_shard
from radhar_cli.dataset.workers import cores
from radhar_cli.errors import RadharError
from radhar_cli.pipeline.products import plan_images
from radhar_cli.pipeline.validity import FLAG_TYPE, draw_valid_scene
from radhar_cli.worker_process import prepare_process

PROBES = 24
PROBE_SECONDS = 8.0
PARALLEL_EFFICIENCY = 0.75
WORKER_START_S = 1.5
PAYS_S = 0.6  # of work, from which on a worker is worth its start
FIXED_S = 1.0
FILE_WRITE_S = 0.0002


@dataclass(frozen=True)
class Estimate:
    """An estimate of a whole build."""

    samples: int  # in the data set
    probes: int  # samples timed
    seconds_per_sample: float  # of one process
    hdf5_bytes: int
    png_bytes: int
    seconds: float  # wall time with the jobs asked for


def jobs_that_pay(config: Config) -> int:
    """Processes for a build: one a core, but each with more to do than its start takes."""
    rows, seconds = Rows.of(config), PAYS_S  # of a sample
    if cores() > 1:
        with suppress(RadharError):  # which the build will tell
            plan, place = plan_images(config), rows[len(rows) // 2]
            for _ in range(2):  # the first imports
                start = process_time()
                synthesise(draw_valid_scene(config, *place)[0], plan)
                seconds = process_time() - start
                if seconds > PAYS_S:
                    break
    return max(1, min(cores(), int(len(rows) * seconds / PAYS_S)))


def estimate(config: Config, jobs: int) -> Estimate:
    """Time samples spread over the classes and scale up; nothing is written."""
    prepare_process()
    rows, plan, columns = Rows.of(config), plan_images(config), scene_fields.fields(config)
    table = colour_table(config.image.colour_map) if config.output.png else None
    samples, values, png_bytes = [], [], 0
    # Imports, tables and caches are not part of a sample.
    synthesise(draw_valid_scene(config, *rows[0])[0], plan)
    start = perf_counter()
    for row in rows.spread(PROBES):
        scene, _ = draw_valid_scene(config, *rows[row])
        sample = synthesise(scene, plan)
        samples.append(sample)
        values.append(scene_fields.values(scene, columns, sample.error_db))
        if table is not None:
            level, images = config.output.png_level, sample.images.values()
            png_bytes += sum(len(encode_png(one.levels, table, level)) for one in images)
        if perf_counter() - start > PROBE_SECONDS:
            break
    done = len(samples)
    flags = np.zeros(done, FLAG_TYPE)
    shard = encode_shard(
        config, identity_hash(identity(config)), 0, samples, np.stack(values), flags
    )
    per_sample = (perf_counter() - start) / done
    if config.output.png:
        per_sample += FILE_WRITE_S * len(config.maps)
    workers = 1 if jobs == 1 else 1 + (jobs - 1) * PARALLEL_EFFICIENCY
    seconds = FIXED_S + per_sample * len(rows) / workers + (WORKER_START_S if jobs > 1 else 0)
    return Estimate(
        samples=len(rows),
        probes=done,
        seconds_per_sample=per_sample,
        hdf5_bytes=len(shard) * len(rows) // done,
        png_bytes=png_bytes * len(rows) // done,
        seconds=seconds,
    )
