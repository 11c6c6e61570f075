"""Assembly of a data set: shards become dataset.h5, scenes.csv and config.yaml.

The layout of dataset.h5 is a contract, described in docs/reference/files.md. Nothing here grows
with the rows but the list of shards: columns go into the file as shards are read.
"""

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from radhar_cli.config.data_set import AnyConfig, Config
from radhar_cli.config.identity import as_yaml
from radhar_cli.dataset import layout
from radhar_cli.dataset.column_writers import ColumnWriter, column_writers
from radhar_cli.dataset.file_description import (
    create_sample_columns,
    describe_columns,
    describe_file,
)
from radhar_cli.dataset.files import digest_of, unfinished_path, write_whole
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.shards import Runs, Shard, ShardError, check_shards, require_tiling
from radhar_cli.errors import UnfinishedError
from radhar_cli.files.new_hdf5 import new_hdf5
from radhar_cli.files.replacing import replacing
from radhar_cli.processes.progress import Progress
from radhar_cli.readers.untrusted_hdf5 import DIGESTS, UntrustedFile, attribute_digests, remember
from radhar_cli.scene.checks.flags import describe_flags
from radhar_cli.scene.checks.warnings import collect_warnings

SCENES_DIGEST = "scenes_sha256"
CONFIG_HEADING = "# The resolved config of this data set, every default filled in.\n"


@contextmanager
def assemble(
    config: AnyConfig,
    folder: Path,
    shards: Sequence[Shard],
    progress: Progress,
    remedy: Callable[[Runs], str] | None = None,
) -> Iterator[tuple[Path, list[dict[str, Any]]]]:
    """Assemble a data set; yield the path of the complete file and the warnings stored in it.

    On exit the file is renamed to dataset.h5.

    Args:
        config: that of the data set.
        folder: output folder.
        shards: shards that hold every row once.
        progress: is told of every row.
        remedy: advice on runs of missing rows, if not to run the same command again.

    Raises:
        UnfinishedError: rows are missing, or a shard is damaged.
    """
    count, shards = len(Rows.of(config)), sorted(shards)
    hash_of_identity = identity_hash(identity(config))
    require_tiling(folder, shards, count, remedy)
    unfinished_path(folder).parent.mkdir(parents=True, exist_ok=True)
    try:
        with (  # replaced from the last to the first: dataset.h5 comes when the others are there
            replacing(folder / layout.DATASET, unfinished_path(folder)) as unfinished,
            replacing(folder / layout.SCENES, unfinished_path(folder)) as table,
        ):
            with (
                new_hdf5(unfinished, folder / layout.DATASET) as (file, check),
                table.open("w", newline="", encoding="utf-8") as text,
            ):
                create_sample_columns(file, config)
                writers, flags = column_writers(file, check, config, text)
                digests = merge_shards(shards, hash_of_identity, writers, progress)
                file.attrs["columns_sha256"] = json.dumps(digests)
                describe_columns(file, config)
                text.flush()
                file.attrs[SCENES_DIGEST] = digest_of(table)
                messages = describe_flags(flags.counts, count)
                if isinstance(config, Config):
                    messages = collect_warnings(config, flags.counts, count)
                describe_file(file, config, messages)
                file.attrs[DIGESTS] = json.dumps(attribute_digests(file), sort_keys=True)
            remember(unfinished)
            yield unfinished, messages
            write_whole(folder, folder / layout.CONFIG, (CONFIG_HEADING + as_yaml(config)).encode())
    except ShardError as error:
        sound, unusable = check_shards(shards, hash_of_identity)
        require_tiling(folder, sound, count, remedy, unusable)
        raise UnfinishedError(f"{folder}: {error}; the same command resumes") from None


def merge_shards(
    shards: Sequence[Shard],
    identity_hash: str,
    writers: Sequence[ColumnWriter],
    progress: Progress,
) -> dict[str, str]:
    """Copy shards into a data set; each shard is read and checked once.

    Args:
        shards: shards that hold every row once, in row order.
        identity_hash: hash of the identity that each shard must carry.
        writers: writers of the columns, in the order in which they append.
        progress: is told of every row.

    Returns:
        Checksums of the columns {name in dataset.h5: SHA-256 in hex}.

    Raises:
        ShardError: a shard is damaged, or of another data set.
    """
    for shard in shards:
        with UntrustedFile(shard.path, shard.read(identity_hash)) as part:
            for writer in writers:
                writer.append(part, shard.rows)
        progress.advance(len(shard.rows))
    digests: dict[str, str] = {}
    for writer in reversed(writers):
        digests |= writer.close()
    return digests
