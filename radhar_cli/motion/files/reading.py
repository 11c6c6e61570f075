"""The one place where motion files are opened: regular files of bounded size; their checksum."""

import hashlib
from pathlib import Path
from typing import NamedTuple

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.files.bvh import read_bvh
from radhar_cli.motion.files.npz import read_npz
from radhar_cli.motion.files.recording import MAX_BYTES, MotionRecording, wrong
from radhar_cli.untrusted import regular_size

SUFFIXES = (".bvh", ".npz")


class MotionBytes(NamedTuple):
    """A motion file as it was read."""

    path: Path
    data: bytes

    @property
    def checksum(self) -> str:
        """SHA-256 of the bytes."""
        return hashlib.sha256(self.data).hexdigest()

    def recording(self, where: str | None = None) -> MotionRecording:
        """What is in it.

        Raises:
            MotionFileError: names file, line and what is missing or odd.
        """
        read = read_bvh if self.path.suffix.lower() == ".bvh" else read_npz
        return read(self.data, where or str(self.path))


def read_motion(path: Path) -> MotionBytes:
    """Read a motion file.

    Raises:
        MotionFileError: it cannot be read, is too large, or of no kind that we know.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise wrong(str(path), f"should be one of {', '.join(SUFFIXES)}")
    try:
        size = regular_size(path)
        if size > MAX_BYTES:
            raise wrong(str(path), f"is {size} bytes; should be at most {MAX_BYTES}")
        with path.open("rb") as file:
            return MotionBytes(path, file.read(MAX_BYTES))
    except OSError as error:
        raise MotionFileError(f"{path}: cannot be read ({error.strerror})") from None
