"""Build a data set: check scenes, run batches in parallel, write PNGs, assemble. Safe to kill.

Files are written under temporary names and renamed when they are complete. A run resumes from the
shards it finds; dataset.h5 comes last, so that a folder with one is complete.
"""

import errno
import uuid
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from radhar_cli.config.schema import AnyConfig, Config
from radhar_cli.dataset.assembly import assembled
from radhar_cli.dataset.batch import Batch, check_scenes, run_batch
from radhar_cli.dataset.card import write_card
from radhar_cli.dataset.folder import clean_up, folder_lock, reserve
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.layout import BUILT, DATASET, WORK, Rows, row_bytes
from radhar_cli.dataset.parts import DataSetPart, refuse_other_cuts
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.png_files import write_missing_pngs
from radhar_cli.dataset.sample import RowFactory
from radhar_cli.dataset.shards import (
    ForeignShardError,
    Runs,
    Shard,
    check_shards,
    listed_shards,
    missing_rows,
)
from radhar_cli.dataset.split import split_rows, split_warnings
from radhar_cli.dataset.untrusted_hdf5 import try_files
from radhar_cli.dataset.workers import parent_pid, run_tasks
from radhar_cli.errors import FolderError, UnfinishedError
from radhar_cli.progress import Progress

# Samples a batch: few at first; of many rows more, as each shard costs some ms of the assembly, but
# no more than 1/64 of a worker's share, as much as a kill may lose.
BATCH, MAX_BATCH, SHARE, BATCH_BYTES = 32, 1024, 64, 2**28


@dataclass(frozen=True)
class BuildOutcome:
    """What a build did."""

    folder: Path  # the output folder
    samples: int  # in the data set
    made: int  # of them, synthesised by this run
    pngs: int  # PNG files written by this run outside of batches
    warnings: list[dict[str, Any]] = field(default_factory=list)  # physical ones

    @property
    def already_complete(self) -> bool:
        """Whether nothing was missing."""
        return self.made == 0 and self.pngs == 0


def build(
    config: AnyConfig,
    folder: Path,
    jobs: int,
    progress: Progress,
    overwrite: bool = False,
    batch_size: int | None = None,
    factory: RowFactory | None = None,
    part: DataSetPart | None = None,
) -> BuildOutcome:
    """Build `config` into `folder`, or resume it; nothing to do where it is complete.

    Args:
        batch_size: samples a shard; it changes no byte of the result.
        factory: makes the rows of a data set that is not simulated.
        part: make these rows alone, in their folder below `folder`.
    """
    folder, count = folder.absolute(), len(Rows.of(config))
    if part is not None:
        if part.of > count:
            most = f"there are {count} samples; should be at most K/{count}"
            raise FolderError(f"--shard {part}: {most}")
        refuse_other_cuts(folder, part)
        folder = part.folder(folder)
    try:
        with folder_lock(folder):
            reserve(folder, config, overwrite, None if part is None else str(part))
            work = Build(config, folder, jobs, progress, factory)
            return work.whole(batch_size) if part is None else work.part(part, batch_size)
    except OSError as error:
        raise disk_error(folder, error) from error


@dataclass
class Build:
    """A build in a folder that was reserved for it."""

    config: AnyConfig
    folder: Path
    jobs: int
    progress: Progress
    factory: RowFactory | None = None

    def __post_init__(self) -> None:
        self.identity_hash = identity_hash(identity(self.config))
        self.split = split_rows(self.config)
        self.png = self.config.output.png

    def whole(self, batch_size: int | None) -> BuildOutcome:
        """Make what is missing of a data set."""
        if (self.folder / DATASET).exists():
            pngs = self._write_beside(self.folder / DATASET)
            clean_up(self.folder)
            return BuildOutcome(self.folder, len(self.split), 0, pngs)
        self.warn_of_split()
        shards, made, shown = self._shards(range(len(self.split)), batch_size)
        return self.assemble(shards, made, shown)

    def warn_of_split(self) -> None:
        """Say what is missing in parts of the split."""
        for message in split_warnings(self.config, self.split):
            self.progress.say(f"warning: {message}")

    def assemble(
        self,
        shards: list[Shard],
        made: int,
        shown: Sequence[dict[str, Any]] = (),
        remedy: Callable[[Runs], str] | None = None,
    ) -> BuildOutcome:
        """Make a data set of its shards, `made` rows of which are new.

        Args:
            shown: warnings that were given before.
            remedy: as of `assembled`.
        """
        self.progress.stage("assembling", len(self.split), 0)
        with assembled(self.config, self.folder, shards, self.progress, remedy) as (source, stored):
            self._say_warnings([warning for warning in stored if warning not in shown])
            pngs = self._write_beside(source)
        clean_up(self.folder)
        return BuildOutcome(self.folder, len(self.split), made, pngs, stored)

    def part(self, part: DataSetPart, batch_size: int | None) -> BuildOutcome:
        """Make the shards of a part; they stay, for others to put together and write the PNGs."""
        rows, self.png = part.rows(len(self.split)), False
        (self.folder / WORK / BUILT).unlink(missing_ok=True)
        _, made, shown = self._shards(rows, batch_size)
        (self.folder / WORK / BUILT).touch()
        return BuildOutcome(self.folder, len(rows), made, 0, shown)

    def _say_warnings(self, messages: Sequence[dict[str, Any]]) -> None:
        for warning in messages:
            self.progress.say(f"warning: {warning['message']}")

    def _write_beside(self, source: Path) -> int:
        """Write the missing files next to dataset.h5; return the number of PNGs among them."""
        pngs = write_missing_pngs(
            self.config, self.folder, self.split, source, self.jobs, self.progress
        )
        write_card(source, self.folder)
        return pngs

    def _shards(
        self, rows: range, batch_size: int | None
    ) -> tuple[list[Shard], int, list[dict[str, Any]]]:
        """Shards of the rows, number of rows that this run made, and warnings."""
        shards = self._sound_shards(rows)
        gaps = missing_rows(shards, rows.stop, rows.start)
        shown: list[dict[str, Any]] = []
        if not shards and isinstance(self.config, Config):
            _, shown = check_scenes(self.config)
        self._say_warnings(shown)
        made, left = self._batches(rows, gaps, batch_size)
        return shards + made, left, shown

    def _batches(self, rows: range, gaps: Runs, batch_size: int | None) -> tuple[list[Shard], int]:
        """Make the rows in the gaps; return their shards, and how many they are."""
        config = self.config
        left = sum(stop - start for start, stop in gaps)
        self.progress.stage("samples", len(rows), len(rows) - left)
        size = batch_size or _batch_size(left, self.jobs, row_bytes(config))
        table = colour_table(config.image.colour_map) if self.png else None
        cuts = [(a, min(a + size, stop)) for start, stop in gaps for a in range(start, stop, size)]

        def batches() -> Iterator[tuple[Batch]]:
            for start, stop in cuts:
                where = (config, self.identity_hash, self.folder, start, stop)
                split = self.split[start:stop]
                yield (Batch(*where, split, table, parent_pid(), self.factory),)

        for samples in run_tasks(run_batch, batches(), max(1, min(self.jobs, len(cuts)))):
            self.progress.advance(samples)
        return [Shard(*cut, self.folder) for cut in cuts], left

    def _sound_shards(self, rows: range) -> list[Shard]:
        """Usable shards of these rows.

        A damaged one is removed, as new batches may be cut differently; a foreign one put aside.
        """
        sound, unusable = check_shards(listed_shards(self.folder, rows), self.identity_hash)
        for shard, error in unusable:
            self.progress.say(f"{shard.path}: {error}; its rows are made again")
            if isinstance(error, ForeignShardError):
                shard.path.rename(shard.path.with_suffix(f".foreign-{uuid.uuid4().hex}"))
            else:
                shard.path.unlink(missing_ok=True)
        try_files([shard.path for shard in sound])
        return sound


def _batch_size(left: int, jobs: int, one: int) -> int:
    """Samples a batch, of `left` samples of `one` bytes each for `jobs` processes."""
    most = min(max(BATCH, left // (SHARE * jobs)), MAX_BATCH, BATCH_BYTES // one)
    return max(1, min(most, -(-left // (4 * jobs))))


def disk_error(folder: Path, error: OSError) -> UnfinishedError:
    """The error for a failed write or a full disk."""
    where = error.filename or folder
    if error.errno == errno.ENOSPC or "No space left" in str(error):
        why = "no space left on the disk"
    elif error.errno in (errno.EACCES, errno.EROFS, errno.EPERM):
        why = "no permission to write"
    else:
        why = error.strerror or str(error)
    return UnfinishedError(
        f"{where}: {why}; what was finished in {folder} is kept, and the same command resumes"
    )
