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

from radhar_cli.arrays import Levels
from radhar_cli.config.experiment import Config
from radhar_cli.dataset.assembly import assembled
from radhar_cli.dataset.batch import Batch, png_rows, run_batch, survey_rows
from radhar_cli.dataset.folder import claim, locked, mark_built, tidy
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.layout import DATASET, MANIFEST, WORK, Rows, png_path
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.settled import settled_rows, store_settled
from radhar_cli.dataset.shards import (
    ForeignShardError,
    Shard,
    check_shards,
    listed_shards,
    missing_and_repeated,
    shard_of,
)
from radhar_cli.dataset.split import split_rows
from radhar_cli.dataset.workers import run_tasks
from radhar_cli.errors import UnfinishedError
from radhar_cli.pipeline.survey import Drawn, warnings

LARGEST_BATCH = 32
SURVEY_BATCH = 64


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
        SceneError: a scene outside the model; nothing was computed.
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
        split = tuple(int(part) for part in split_rows(config))
        if (self.folder / DATASET).exists():
            pngs = self._missing_pngs(split, self.folder / DATASET)
            tidy(self.folder)
            return Outcome(self.folder, count, 0, pngs)
        drawn = self._survey(count)
        said = warnings(config, drawn)
        for warning in said:
            self.progress.say(f"warning: {warning['message']}")
        shards, made = self._batches(drawn, split, batch_size)
        self.progress.stage("assembling", count, 0)
        with assembled(config, self.folder, shards, said) as (unfinished, stored):
            for warning in stored[len(said) :]:
                self.progress.say(f"warning: {warning['message']}")
            self.progress.advance(count)
            pngs = self._missing_pngs(split, unfinished)
        mark_built(self.folder)
        tidy(self.folder)
        return Outcome(self.folder, count, made, pngs, stored)

    def _survey(self, count: int) -> list[Drawn]:
        """Settle every scene; what a run that was stopped had settled is not done again."""
        every = range(0, count, SURVEY_BATCH)
        outcomes = settled_rows(self.folder, self.identity_hash, every)
        starts = [start for start in every if start not in outcomes]
        left = sum(min(SURVEY_BATCH, count - start) for start in starts)
        self.progress.stage("checking scenes", count, count - left)
        tasks = [(self.config, s, min(s + SURVEY_BATCH, count), os.getpid()) for s in starts]
        jobs = self.jobs if len(tasks) > 2 * self.jobs else 1
        for start, found in run_tasks(survey_rows, tasks, jobs):
            store_settled(self.folder, self.identity_hash, start, found)
            outcomes[start] = found
            self.progress.advance(len(found))
        return [outcome for start in sorted(outcomes) for outcome in outcomes[start]]

    def _batches(
        self, drawn: list[Drawn], split: tuple[int, ...], batch_size: int | None
    ) -> tuple[list[Shard], int]:
        """Make the rows that no sound shard holds; return the shards of all rows, and how many."""
        kept = self._sound_shards()
        gaps, _ = missing_and_repeated(kept, len(drawn))
        left = sum(stop - start for start, stop in gaps)
        self.progress.stage("samples", len(drawn), len(drawn) - left)
        size = batch_size or max(1, min(LARGEST_BATCH, -(-left // (4 * self.jobs))))
        cuts = [
            (start, min(start + size, gap_stop))
            for gap_start, gap_stop in gaps
            for start in range(gap_start, gap_stop, size)
        ]

        def batches() -> Iterator[tuple[Batch]]:
            for start, stop in cuts:
                attempts = tuple(outcome.attempt for outcome in drawn[start:stop])
                yield (
                    Batch(
                        self.config,
                        self.folder,
                        start,
                        stop,
                        attempts,
                        split[start:stop],
                        self.table,
                        os.getpid(),
                    ),
                )

        for samples in run_tasks(run_batch, batches(), self.jobs if left > size else 1):
            self.progress.advance(samples)
        return kept + [shard_of(self.folder, start, stop) for start, stop in cuts], left

    def _sound_shards(self) -> list[Shard]:
        """Shards to go on from. A damaged one is made again, a foreign one moved out of the way."""
        (self.folder / WORK / MANIFEST).unlink(missing_ok=True)
        sound, unusable = check_shards(listed_shards(self.folder), self.identity_hash)
        for shard, error in unusable:
            self.progress.say(f"{shard.path}: {error}; its rows are made again")
            if isinstance(error, ForeignShardError):
                shard.path.rename(shard.path.with_suffix(f".foreign-{uuid.uuid4().hex}"))
        return sound

    def _missing_pngs(self, split: tuple[int, ...], source: Path) -> int:
        """Write PNGs that are not there: asked for later, deleted, or lost with a killed run."""
        if self.table is None:
            return 0
        missing = [(row, split[row]) for row in self._rows_without_png(split)]
        if not missing:
            return 0
        self.progress.stage("png", len(missing), 0)
        tasks = (
            (
                self.config,
                self.folder,
                source,
                missing[first : first + LARGEST_BATCH],
                self.table,
                os.getpid(),
            )
            for first in range(0, len(missing), LARGEST_BATCH)
        )
        jobs = self.jobs if len(missing) > LARGEST_BATCH else 1
        for written in run_tasks(png_rows, tasks, jobs):
            self.progress.advance(written)
        return len(missing) * len(self.config.maps)

    def _rows_without_png(self, split: tuple[int, ...]) -> list[int]:
        rows = Rows.of(self.config)
        listed: dict[Path, set[str]] = {}

        def there(path: Path) -> bool:
            if path.parent not in listed:
                parent = self.folder / path.parent
                listed[path.parent] = (
                    {found.name for found in parent.iterdir()} if parent.is_dir() else set()
                )
            return path.name in listed[path.parent]

        return [
            row
            for row in range(len(rows))
            if not all(there(png_path(name, split[row], *rows[row])) for name in self.config.maps)
        ]


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
