"""Build a data set: check scenes, run batches in parallel, write PNGs, assemble. Safe to kill.

Files are written under temporary names and renamed when they are complete. A run resumes from the
shards it finds; dataset.h5 comes last, so that a folder with one is complete.
"""

import errno
import uuid
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from radhar_cli.config.data_set import AnyConfig, Config
from radhar_cli.dataset.assembly import assemble
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
    list_shards,
    missing_rows,
)
from radhar_cli.dataset.split import split_rows, split_warnings
from radhar_cli.dataset.stream_files import write_missing_segments
from radhar_cli.dataset.workers import parent_pid, run_tasks
from radhar_cli.errors import FolderError, UnfinishedError
from radhar_cli.processes.progress import Progress
from radhar_cli.readers.untrusted_hdf5 import try_files
from radhar_cli.scene.products.table import plan_images

# Samples a batch: few at first; of many rows more, as each shard costs some ms of the assembly, but
# no more than 1/64 of a worker's share, as much as a kill may lose.
BATCH, MAX_BATCH, SHARE, BATCH_BYTES = 32, 1024, 64, 2**28


@dataclass(frozen=True)
class BuildOutcome:
    """Result of a build."""

    folder: Path  # the output folder
    samples: int  # in the data set
    new_samples: int  # of them, synthesised by this run
    pngs: int  # PNG files written by this run outside of batches
    warnings: list[dict[str, Any]] = field(default_factory=list)  # physical ones

    @property
    def already_complete(self) -> bool:
        """Whether nothing was missing."""
        return self.new_samples == 0 and self.pngs == 0


def build(
    config: AnyConfig,
    folder: Path,
    jobs: int,
    progress: Progress,
    overwrite: bool = False,
    batch_size: int | None = None,
    factory: RowFactory | None = None,
) -> BuildOutcome:
    """Build the data set of `config` in `folder`, or resume it; do nothing where it is complete.

    Args:
        config: that of the data set.
        folder: output folder.
        jobs: number of worker processes.
        progress: is told of every sample and warning.
        overwrite: start over where the folder holds another data set of radhar.
        batch_size: number of samples of a shard; it changes no byte of the result.
        factory: makes the rows of a data set that is not simulated.

    Raises:
        ConfigError: `output.products` names what the radar does not make, or no array.
        FolderError: the folder holds other files or another data set, or another run writes there.
        UnfinishedError: the disk is full or cannot be written; the same command resumes.
    """
    _refuse_unknown_products(config)
    folder = folder.absolute()
    with _held_folder(folder, config, overwrite):
        return Build(config, folder, jobs, progress, factory).build_all(batch_size)


def build_part(
    config: AnyConfig,
    folder: Path,
    part: DataSetPart,
    jobs: int,
    progress: Progress,
    overwrite: bool = False,
    batch_size: int | None = None,
) -> BuildOutcome:
    """Make the rows of one part of a data set, in its folder below `folder`, or resume it.

    Args:
        config: that of the data set.
        folder: output folder of the data set.
        jobs: number of worker processes.
        progress: is told of every sample and warning.
        overwrite: start over where the folder holds another data set of radhar.
        batch_size: number of samples of a shard; it changes no byte of the result.

    Raises:
        ConfigError: `output.products` names what the radar does not make, or no array.
        FolderError: there are fewer samples than parts, or parts of another N; else as `build`.
        UnfinishedError: the disk is full or cannot be written; the same command resumes.
    """
    _refuse_unknown_products(config)
    folder, count = folder.absolute(), len(Rows.of(config))
    if part.of > count:
        raise FolderError(f"--shard {part}: there are {count} samples; should be at most K/{count}")
    refuse_other_cuts(folder, part)
    folder = part.folder(folder)
    with _held_folder(folder, config, overwrite, part):
        return Build(config, folder, jobs, progress).build_part(part, batch_size)


def _refuse_unknown_products(config: AnyConfig) -> None:
    """Refuse products that the radar does not make, before scenes are checked."""
    if isinstance(config, Config):
        plan_images(config)


@contextmanager
def _held_folder(
    folder: Path, config: AnyConfig, overwrite: bool, part: DataSetPart | None = None
) -> Iterator[None]:
    """Hold a folder that is taken for a data set, or a part of it, as `reserve`.

    Raises:
        FolderError: the folder holds other files or another data set, or another run writes there.
        UnfinishedError: the disk is full or cannot be written.
    """
    try:
        with folder_lock(folder):
            reserve(folder, config, overwrite, None if part is None else str(part))
            yield
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

    def build_all(self, batch_size: int | None) -> BuildOutcome:
        """Make the missing samples and files of the data set."""
        if (self.folder / DATASET).exists():
            pngs = self._write_missing_files(self.folder / DATASET)
            clean_up(self.folder)
            return BuildOutcome(self.folder, len(self.split), 0, pngs)
        self.warn_of_split()
        shards, new_samples, warnings = self._complete_shards(range(len(self.split)), batch_size)
        return self.assemble(shards, new_samples, warnings)

    def warn_of_split(self) -> None:
        """Warn of parts of the split that lack samples."""
        for message in split_warnings(self.config, self.split):
            self.progress.say(f"warning: {message}")

    def assemble(
        self,
        shards: list[Shard],
        new_samples: int,
        given_warnings: Sequence[dict[str, Any]] = (),
        remedy: Callable[[Runs], str] | None = None,
    ) -> BuildOutcome:
        """Make the data set of its shards.

        Args:
            shards: shards that hold every row once.
            new_samples: number of rows that this run has made.
            given_warnings: warnings that were given before.
            remedy: advice on runs of missing rows, if not to run the same command again.

        Raises:
            UnfinishedError: rows are missing.
        """
        self.progress.stage("assembling", len(self.split), 0)
        with assemble(self.config, self.folder, shards, self.progress, remedy) as (source, stored):
            self._say_warnings([warning for warning in stored if warning not in given_warnings])
            pngs = self._write_missing_files(source)
        clean_up(self.folder)
        return BuildOutcome(self.folder, len(self.split), new_samples, pngs, stored)

    def build_part(self, part: DataSetPart, batch_size: int | None) -> BuildOutcome:
        """Make the shards of a part; `radhar merge` puts them together and writes the PNGs."""
        rows, self.png = part.rows(len(self.split)), False
        (self.folder / WORK / BUILT).unlink(missing_ok=True)
        _, new_samples, warnings = self._complete_shards(rows, batch_size)
        (self.folder / WORK / BUILT).touch()
        return BuildOutcome(self.folder, len(rows), new_samples, 0, warnings)

    def _say_warnings(self, messages: Sequence[dict[str, Any]]) -> None:
        for warning in messages:
            self.progress.say(f"warning: {warning['message']}")

    def _write_missing_files(self, source: Path) -> int:
        """Write the missing files next to dataset.h5; return the number of PNGs among them."""
        pngs = write_missing_pngs(
            self.config, self.folder, self.split, source, self.jobs, self.progress
        )
        write_missing_segments(source, self.folder)
        write_card(source, self.folder)
        return pngs

    def _complete_shards(
        self, rows: range, batch_size: int | None
    ) -> tuple[list[Shard], int, list[dict[str, Any]]]:
        """Make the missing shards of rows.

        Returns:
            All their shards, the number of rows that this run made, and warnings.
        """
        shards = self._sound_shards(rows)
        gaps = missing_rows(shards, rows.stop, rows.start)
        warnings: list[dict[str, Any]] = []
        if not shards and isinstance(self.config, Config):
            _, warnings = check_scenes(self.config)
        self._say_warnings(warnings)
        new_shards, missing = self._run_batches(rows, gaps, batch_size)
        return shards + new_shards, missing, warnings

    def _run_batches(
        self, rows: range, gaps: Runs, batch_size: int | None
    ) -> tuple[list[Shard], int]:
        """Make the rows in the gaps; return their shards, and the number of these rows."""
        config = self.config
        missing = sum(stop - start for start, stop in gaps)
        self.progress.stage("samples", len(rows), len(rows) - missing)
        size = batch_size or choose_batch_size(missing, self.jobs, row_bytes(config))
        table = colour_table(config.image.colour_map) if self.png else None
        cuts = [(a, min(a + size, stop)) for start, stop in gaps for a in range(start, stop, size)]

        def batches() -> Iterator[tuple[Batch]]:
            for start, stop in cuts:
                where = (config, self.identity_hash, self.folder, start, stop)
                split = self.split[start:stop]
                yield (Batch(*where, split, table, parent_pid(), self.factory),)

        for samples in run_tasks(run_batch, batches(), max(1, min(self.jobs, len(cuts)))):
            self.progress.advance(samples)
        return [Shard(*cut, self.folder) for cut in cuts], missing

    def _sound_shards(self, rows: range) -> list[Shard]:
        """List the usable shards of these rows.

        A damaged shard is removed, as new batches may be cut differently; a foreign one is put
        aside.
        """
        sound, unusable = check_shards(list_shards(self.folder, rows), self.identity_hash)
        for shard, error in unusable:
            self.progress.say(f"{shard.path}: {error}; its rows are made again")
            if isinstance(error, ForeignShardError):
                shard.path.rename(shard.path.with_suffix(f".foreign-{uuid.uuid4().hex}"))
            else:
                shard.path.unlink(missing_ok=True)
        try_files([shard.path for shard in sound])
        return sound


def choose_batch_size(samples: int, jobs: int, sample_bytes: int) -> int:
    """Choose the number of samples of a batch.

    Args:
        samples: number of samples to make.
        jobs: number of processes.
        sample_bytes: size of a sample.
    """
    largest = min(max(BATCH, samples // (SHARE * jobs)), MAX_BATCH, BATCH_BYTES // sample_bytes)
    return max(1, min(largest, -(-samples // (4 * jobs))))


def disk_error(folder: Path, error: OSError) -> UnfinishedError:
    """Make the error that tells of a failed write or a full disk.

    Args:
        folder: output folder, whose finished work is kept.
        error: the error of the operating system.
    """
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
