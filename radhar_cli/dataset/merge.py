"""Merge parts of a data set that were built separately."""

import os
from collections.abc import Iterable, Sequence
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.dataset.build import Build, BuildOutcome, disk_error
from radhar_cli.dataset.files import refuse_foreign_work
from radhar_cli.dataset.folder import folder_lock, reserve, stored_identity
from radhar_cli.dataset.identity import differences, identity
from radhar_cli.dataset.layout import PARTS, Rows
from radhar_cli.dataset.parts import DataSetPart, rows_by_part
from radhar_cli.dataset.reading import stored_config
from radhar_cli.dataset.shards import Runs, Shard, list_shards, require_tiling
from radhar_cli.errors import FolderError
from radhar_cli.processes.progress import Progress
from radhar_cli.readers.untrusted_hdf5 import try_files


class _Place(NamedTuple):
    """A part of a data set, and where it lies."""

    part: DataSetPart
    folder: Path
    identity: dict[str, Any]


def merge(
    out: Path, folders: Sequence[Path], jobs: int, progress: Progress
) -> tuple[AnyConfig, BuildOutcome]:
    """Make a data set of its parts, which are only read.

    Args:
        out: output folder.
        folders: folders of parts, or that hold parts, in addition to those below `out`.
        jobs: number of processes that write PNG files.
        progress: is told of every row.

    Returns:
        The config of the data set, and the result of the build.

    Raises:
        FolderError: there are no parts, or parts of different data sets.
        UnfinishedError: rows are missing.
    """
    out = out.absolute()
    with_parts = [out] if (out / PARTS).is_dir() else []
    places = _find_parts([*with_parts, *folders] or [out])
    config = _common_config(places)
    count, of = len(Rows.of(config)), places[0].part.of

    def run_again(runs: Runs) -> str:
        options = ", ".join(f"--shard {part}" for part in rows_by_part(runs, of, count))
        return f"make them with `radhar generate` and {options}, then merge again"

    shards = _list_shards(places, count)
    require_tiling(out, shards, count, run_again)
    try_files([shard.path for shard in shards])
    work = Build(config, out, jobs, progress)
    work.warn_of_split()
    try:
        with folder_lock(out):
            reserve(out, config, overwrite=False, allowed=(PARTS,))
            return config, work.assemble(shards, count, remedy=run_again)
    except OSError as error:
        raise disk_error(out, error) from error


def _find_parts(folders: Iterable[Path]) -> list[_Place]:
    """Find the parts in folders; return each once, in order."""
    places = {}
    for folder in folders:
        folder = Path(os.path.abspath(folder))  # noqa: PTH100 - without ..; links stay
        inner = folder / PARTS
        for part in sorted(inner.iterdir()) if inner.is_dir() else [folder]:
            refuse_foreign_work(part)
            named = stored_identity(part)
            if named is not None and isinstance(named.get("part"), str):
                number = DataSetPart.parse(named["part"], f"{part}: part")
                places[part] = _Place(number, part, named)
            elif not inner.is_dir():
                reason = "is not a part that `radhar generate --shard` made"
                raise FolderError(f"{part}: {reason if part.is_dir() else 'no such folder'}")
    if not places:
        raise FolderError(
            f"{', '.join(map(str, folders))}: no part of a data set; "
            "`radhar generate CONFIG -o OUT --shard K/N` makes one"
        )
    return sorted(places.values(), key=lambda place: place.part)


def _common_config(places: Sequence[_Place]) -> AnyConfig:
    """Check that all parts have the same identity; return their config."""
    first = places[0]
    for place in places[1:]:
        differing = differences(first.identity, place.identity)
        if place.part.of != first.part.of:
            differing = [f"parts: {first.part.of} there, {place.part.of} here"]
        if differing:
            raise FolderError(
                f"{place.folder}: is not of the same data set as {first.folder}; it differs in\n  "
                + "\n  ".join(differing)
            )
    config = stored_config(first.identity.get("config"), str(first.folder))
    differing = differences(first.identity, identity(config))
    if differing:
        raise FolderError(
            f"{first.folder}: merge with the radhar version that built the parts; it differs "
            "in\n  " + "\n  ".join(differing)
        )
    return config


def _list_shards(places: Sequence[_Place], count: int) -> list[Shard]:
    """List the shards of all parts in row order; of those that share rows, the first."""
    listed = (list_shards(place.folder, place.part.rows(count)) for place in places)
    shards: list[Shard] = []
    for shard in sorted(chain.from_iterable(listed)):
        if not shards or shard.start >= shards[-1].stop:
            shards.append(shard)
    return shards
