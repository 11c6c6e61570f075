"""Build a data set: survey, batches in parallel, missing PNGs, assembly. Safe to kill anywhere.

Whatever is finished has its final name; whatever has a final name is finished. A run that finds
shards goes on from them; dataset.h5 comes last and stands for a complete folder.
"""

import errno
import os
import uuid
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from radhar_cli.activity import Activity
from radhar_cli.arrays import Bool, Index, Levels
from radhar_cli.config.schema import Config
from radhar_cli.dataset.assembly import assembled
from radhar_cli.dataset.batch import Batch, check_rows, png_rows, run_batch
from radhar_cli.dataset.check_cache import OUTCOME, Outcomes, store_checks, stored_checks
from radhar_cli.dataset.folder import claim, clean_up, locked, mark_built
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.layout import DATASET, MANIFEST, WORK, Rows, png_path
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.shards import (
    ForeignShardError,
    Shard,
    check_shards,
    listed_shards,
    missing_and_repeated,
)
from radhar_cli.dataset.split import split_rows
from radhar_cli.dataset.workers import run_tasks
from radhar_cli.errors import UnfinishedError
from radhar_cli.pipeline.validity import Flags, warnings

MAX_BATCH = 32
CHECK_BATCH = 64
MAX_CHECKED_FIRST = 100_000  # rows; of more, every worker checks its own


class Progress(Protocol):
    """Who is told how far a build is."""

    def stage(self, name: str, total: int, done: int) -> None:
        """A part of the work begins."""

    def advance(self, samples: int) -> None:
        """Some samples of it are finished."""

    def say(self, message: str) -> None:
        """Something the user should read."""


@dataclass(frozen=True)
class Outcome:
    """What a build did.

    Attributes:
        folder: the output folder.
        samples: in the data set.
        made: samples synthesised by this run.
        pngs: PNG files written by this run outside of batches.
        warnings: physical warnings.
        already_complete: nothing was missing.
    """

    folder: Path
    samples: int
    made: int
    pngs: int
    warnings: list[dict[str, Any]] = field(default_factory=list)

    @property
    def already_complete(self) -> bool:
        return self.made == 0 and self.pngs == 0


def build(
    config: Config,
    folder: Path,
    jobs: int,
    progress: Progress,
    overwrite: bool = False,
    batch_size: int | None = None,
) -> Outcome:
    """Build `config` into `folder`, or go on with it, or find it complete.

    Args:
        config: the data set.
        folder: created if need be.
        jobs: processes.
        progress: who is told.
        overwrite: start again.
        batch_size: samples a shard; it changes no byte of the result.

    Raises:
        FolderError: the folder is in use or holds something else.
        UnfinishedError: it cannot be written, or a worker was killed; finished samples are kept.
        SceneError: a scene outside the model; nothing was computed of a data set of at most
            MAX_CHECKED_FIRST rows.
    """
    table = colour_table(config.image.colour_map) if config.output.png else None
    folder = folder.absolute()
    whose = identity_hash(identity(config))
    try:
        with locked(folder):
            claim(folder, config, overwrite)
            return _Build(config, whose, folder, jobs, progress, table).run(batch_size)
    except OSError as error:
        raise _disk_error(folder, error) from error


@dataclass
class _Build:
    config: Config
    identity_hash: str
    folder: Path
    jobs: int
    progress: Progress
    table: Levels | None

    def run(self, batch_size: int | None) -> Outcome:
        config, count = self.config, len(Rows.of(self.config))
        split = split_rows(config)
        if (self.folder / DATASET).exists():
            pngs = self._missing_pngs(split, self.folder / DATASET)
            clean_up(self.folder)
            return Outcome(self.folder, count, 0, pngs)
        checked = self._check_scenes(count) if count <= MAX_CHECKED_FIRST else None
        said = [] if checked is None else warnings(config, _counts(checked["flags"]))
        self._say(said)
        shards, made = self._batches(count, checked, split, batch_size)
        self.progress.stage("assembling", count, 0)
        with assembled(config, self.folder, shards) as (unfinished, stored):
            self._say([warning for warning in stored if warning not in said])
            self.progress.advance(count)
            pngs = self._missing_pngs(split, unfinished)
        mark_built(self.folder)
        clean_up(self.folder)
        return Outcome(self.folder, count, made, pngs, stored)

    def _say(self, found: list[dict[str, Any]]) -> None:
        for warning in found:
            self.progress.say(f"warning: {warning['message']}")

    def _check_scenes(self, count: int) -> Outcomes:
        """Check every scene, but for those that an earlier run checked: outcomes [count]."""
        outcomes = np.empty(count, dtype=OUTCOME)
        starts = []
        for start in range(0, count, CHECK_BATCH):
            part = outcomes[start : start + CHECK_BATCH]
            kept = stored_checks(self.folder, self.identity_hash, start, part.size)
            if kept is None:
                starts.append(start)
            else:
                part[:] = kept
        left = sum(min(CHECK_BATCH, count - start) for start in starts)
        self.progress.stage("checking scenes", count, count - left)
        tasks = [(self.config, s, min(s + CHECK_BATCH, count), os.getpid()) for s in starts]
        jobs = self.jobs if len(tasks) > 2 * self.jobs else 1
        for start, found in run_tasks(check_rows, tasks, jobs):
            store_checks(self.folder, self.identity_hash, start, found)
            outcomes[start : start + found.size] = found
            self.progress.advance(found.size)
        return outcomes

    def _batches(
        self, count: int, checked: Outcomes | None, split: Levels, batch_size: int | None
    ) -> tuple[list[Shard], int]:
        """Make the rows that no sound shard holds; return the shards of all rows, and how many."""
        shards = self._sound_shards()
        gaps, _ = missing_and_repeated(shards, count)
        left = sum(stop - start for start, stop in gaps)
        self.progress.stage("samples", count, count - left)
        size = batch_size or max(1, min(MAX_BATCH, -(-left // (4 * self.jobs))))

        def batches() -> Iterator[tuple[Batch]]:
            for gap_start, gap_stop in gaps:
                for start in range(gap_start, gap_stop, size):
                    stop = min(start + size, gap_stop)
                    shards.append(Shard(start, stop, self.folder))
                    yield (
                        Batch(
                            self.config,
                            self.identity_hash,
                            self.folder,
                            start,
                            stop,
                            None if checked is None else checked[start:stop],
                            split[start:stop],
                            self.table,
                            os.getpid(),
                        ),
                    )

        for samples in run_tasks(run_batch, batches(), self.jobs if left > size else 1):
            self.progress.advance(samples)
        return shards, left

    def _sound_shards(self) -> list[Shard]:
        """Shards to go on from. A damaged one is made again, a foreign one moved out of the way."""
        (self.folder / WORK / MANIFEST).unlink(missing_ok=True)
        sound, unusable = check_shards(listed_shards(self.folder), self.identity_hash)
        for shard, error in unusable:
            self.progress.say(f"{shard.path}: {error}; its rows are made again")
            if isinstance(error, ForeignShardError):
                shard.path.rename(shard.path.with_suffix(f".foreign-{uuid.uuid4().hex}"))
        return sound

    def _missing_pngs(self, split: Levels, source: Path) -> int:
        """Write PNGs that are not there: asked for later, deleted, or lost with a killed run."""
        if self.table is None:
            return 0
        missing = self._rows_without_png(split)
        if not missing.size:
            return 0
        self.progress.stage("png", missing.size, 0)
        tasks = (
            (
                self.config,
                self.folder,
                source,
                [(row, int(split[row])) for row in missing[first : first + MAX_BATCH].tolist()],
                self.table,
                os.getpid(),
            )
            for first in range(0, missing.size, MAX_BATCH)
        )
        jobs = self.jobs if missing.size > MAX_BATCH else 1
        for written in run_tasks(png_rows, tasks, jobs):
            self.progress.advance(written)
        return missing.size * len(self.config.maps)

    def _rows_without_png(self, split: Levels) -> Index:
        """Rows of which an image is missing."""
        rows = Rows.of(self.config)
        missing = np.zeros(len(rows), dtype=bool)
        for first in range(0, len(rows), rows.per_class):
            activity, one_class = rows[first][0], slice(first, first + rows.per_class)
            for name in self.config.maps:
                missing[one_class] |= ~self._stored_pngs(name, activity, split[one_class])
        return np.flatnonzero(missing)

    def _stored_pngs(self, name: str, activity: Activity, split: Levels) -> Bool:
        """Whether there is a PNG of each sample [per_class] of a class, of one map."""
        there = np.zeros(split.size, dtype=bool)
        for number in np.unique(split).tolist():
            folder = self.folder / png_path(name, number, activity, 0).parent
            for found in os.scandir(folder) if folder.is_dir() else ():
                stem = found.name.removesuffix(".png")
                index = int(stem) if stem.isdecimal() else split.size
                path = png_path(name, number, activity, index)
                if index < split.size and split[index] == number and path.name == found.name:
                    there[index] = True
        return there


def _counts(flags: Levels) -> dict[Flags, int]:
    return {flag: int(np.count_nonzero(flags & flag)) for flag in Flags}


def _disk_error(folder: Path, error: OSError) -> UnfinishedError:
    where = error.filename or folder
    if error.errno == errno.ENOSPC or "No space left" in str(error):
        why = "no space left on the disk"
    elif error.errno in (errno.EACCES, errno.EROFS, errno.EPERM):
        why = "no permission to write"
    else:
        why = error.strerror or str(error)
    return UnfinishedError(
        f"{where}: {why}; what was finished in {folder} is kept, and the same command goes on"
    )
