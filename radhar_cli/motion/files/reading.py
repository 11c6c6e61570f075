"""The one place where motion files are opened: regular files of bounded size; their checksum."""

import hashlib
from pathlib import Path
from typing import NamedTuple

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.files.amc import MAX_SKELETON, read_amc
from radhar_cli.motion.files.bvh import read_bvh
from radhar_cli.motion.files.npz import read_npz
from radhar_cli.motion.files.recording import MAX_BYTES, MotionRecording, wrong
from radhar_cli.untrusted import refuse_outside, regular_size

SUFFIXES = (".bvh", ".amc", ".npz")


class MotionBytes(NamedTuple):
    """A motion file as it was read: an AMC with its skeleton."""

    path: Path  # of it
    data: bytes  # its bytes
    skeleton: tuple[Path, bytes] | None  # (path, bytes) of the ASF

    @property
    def checksum(self) -> str:
        """SHA-256 of the bytes, the skeleton's after them."""
        digest = hashlib.sha256(self.data)
        if self.skeleton:
            digest.update(self.skeleton[1])
        return digest.hexdigest()

    def recording(self, where: str | None = None) -> MotionRecording:
        """What is in it.

        Raises:
            MotionFileError: names file, line and what is missing or odd.
        """
        where = where or str(self.path)
        if self.skeleton:
            return read_amc(self.data, where, self.skeleton[1], str(self.skeleton[0]))
        read = read_bvh if self.path.suffix.lower() == ".bvh" else read_npz
        return read(self.data, where)


def read_motion(path: Path, skeleton: Path | None = None) -> MotionBytes:
    """Read a motion file; the skeleton of an AMC is found beside it.

    Raises:
        MotionFileError: it cannot be read, is too large, or of no kind that we know.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        hint = "; name its .amc files" if suffix == ".asf" else ""
        raise wrong(str(path), f"should be one of {', '.join(SUFFIXES)}{hint}")
    data, found = _bytes(path, MAX_BYTES), None
    if suffix == ".amc":
        asf = skeleton or skeleton_of(path)
        if asf.suffix.lower() != ".asf":
            raise wrong(str(asf), "should be an .asf file")
        found = (asf, _bytes(asf, MAX_SKELETON))
    return MotionBytes(path, data, found)


def skeleton_of(path: Path) -> Path:
    """The ASF of an AMC: of the same name, CMU's `02.asf` of `02_01.amc`, or the folder's only one.

    Raises:
        MotionFileError: there is none.
        FolderError: it is a link that leads elsewhere.
    """
    names = [f"{path.stem}.asf"]
    if "_" in path.stem:
        names.append(path.stem.rpartition("_")[0] + ".asf")
    try:
        beside = sorted(one for one in path.parent.iterdir() if one.suffix.lower() == ".asf")
    except OSError:
        beside = []
    named = [one for name in names for one in beside if one.name.lower() == name.lower()]
    for candidate in named or (beside if len(beside) == 1 else []):
        refuse_outside(candidate, path.parent)
        return candidate
    wanted = " or ".join(names)
    raise wrong(
        str(path),
        f"needs its skeleton beside it, {wanted}; or name it: "
        "skeleton: FILE.asf of its class (--skeleton FILE.asf)",
    )


def _bytes(path: Path, most: int) -> bytes:
    try:
        size = regular_size(path)
        if size > most:
            raise wrong(str(path), f"is {size} bytes; should be at most {most}")
        with path.open("rb") as file:
            return file.read(most)
    except OSError as error:
        raise MotionFileError(f"{path}: cannot be read ({error.strerror})") from None
