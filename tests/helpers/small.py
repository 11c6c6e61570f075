"""A data set that takes a second, and how to compare two of them."""

import errno
import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import pytest

SMALL = """
seed: 7
samples_per_class: 3
activities: [punching, walking, S12]
duration_s: 4.0
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}
motion: {model: paper}
snr_db: {choice: [30, 10]}
maps: [rtm, stft, fsst_compensated]
image: {size_px: 48}
split: {train: 0.67, validation: 0.33}
"""


def small_config(folder: Path, text: str = SMALL) -> Path:
    """Write the config into a folder; return its path."""
    path = folder / "small.yaml"
    path.write_text(text)
    return path


def fingerprint(folder: Path) -> dict[str, str]:
    """SHA-256 of every file of a data set, the work folder aside."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and ".radhar" not in path.parts
    }


@contextmanager
def full_disk_after(samples: int) -> Iterator[None]:
    """A build here finds its disk full after so many samples, and says so."""
    from radhar_cli.dataset import batch
    from radhar_cli.errors import UnfinishedError

    made, original = [], batch.synthesise

    def synthesise(*given: object) -> object:
        made.append(given)
        if len(made) > samples:
            raise OSError(errno.ENOSPC, "No space left on device", "shard")
        return original(*given)  # type: ignore[arg-type]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(batch, "synthesise", synthesise)
        with pytest.raises(UnfinishedError, match="no space left on the disk"):
            yield


@contextmanager
def edited(source, path):
    """A copy of an HDF5 file at a path, open to be changed."""
    path.write_bytes(source.read_bytes())
    with h5py.File(path, "r+") as file:
        yield file
