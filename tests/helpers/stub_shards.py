"""Shards of a build without the synthesis: each a copy of one but for its rows."""

import numpy as np

from radhar_cli.dataset import scene_fields, shards
from radhar_cli.dataset.batch import Batch
from radhar_cli.dataset.sample import SampleRow, StoredSample
from radhar_cli.processing.power_map import MapImage
from radhar_cli.scene.checks.flags import Flags


def stub_shard(batch: Batch, size: int, made: dict[int, bytes]) -> int:
    """Write the shard of a batch as `run_batch` would; return its number of samples.

    Args:
        batch: of a config whose only map is `stft`.
        size: of the image, px.
        made: shards by their number of samples, to copy; is filled.
    """
    count = batch.stop - batch.start
    if count not in made:
        image = MapImage(np.zeros((size, size), np.uint8), 0.0, (0.0, 1.0, -1.0, 1.0))
        sample = StoredSample({"stft": image}, -100.0)
        values = np.zeros(len(scene_fields.fields(batch.config)))
        rows = [SampleRow(sample, values, Flags.ALIASING)] * count
        made[count] = shards.encode_shard(batch.config, "0" * 64, 0, rows)
    content = made[count][shards.USER_BLOCK :]
    whose, start, stop = batch.identity_hash, batch.start, batch.stop
    checksum = shards._checksum(whose, start, stop, memoryview(content))
    header = f"radhar shard of {whose}\nrows {start} {stop}\nsha256 {checksum}\n".encode()
    data = header.ljust(shards.USER_BLOCK, b"\0") + content
    shards.write_shard(batch.folder, start, stop, data)
    return count
