"""Outcomes of the check of scenes, stored with an unfinished build for a resumed one."""

import hashlib
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from radhar_cli.dataset.files import read_bytes, write_whole
from radhar_cli.dataset.layout import CHECKS, WORK
from radhar_cli.errors import FolderError

# Of each row: which draw is kept (`on_invalid: redraw`), and the Flags of its scene.
OUTCOME = np.dtype([("attempt", "<u2"), ("flags", "u1")])
Outcomes: TypeAlias = NDArray[Any]  # of OUTCOME


def store_checks(folder: Path, identity_hash: str, start: int, outcomes: Outcomes) -> None:
    """Keep the outcomes of the rows from `start` on, with a checksum."""
    data = outcomes.tobytes()
    write_whole(folder, _path(folder, start), _checksum(identity_hash, start, data) + data)


def stored_checks(folder: Path, identity_hash: str, start: int, count: int) -> Outcomes | None:
    """What is kept of `count` rows from `start` on, or None where it is not there whole."""
    try:
        kept = read_bytes(_path(folder, start))
    except (FolderError, FileNotFoundError):
        return None
    checksum, data = kept[:32], kept[32:]
    if checksum != _checksum(identity_hash, start, data) or len(data) != count * OUTCOME.itemsize:
        return None
    return np.frombuffer(data, dtype=OUTCOME)


def _path(folder: Path, start: int) -> Path:
    return folder / WORK / CHECKS / f"{start:09d}.bin"


def _checksum(identity_hash: str, start: int, data: bytes) -> bytes:
    return hashlib.sha256(f"{identity_hash} {start}\n".encode() + data).digest()
