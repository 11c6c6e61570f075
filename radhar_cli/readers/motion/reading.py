"""The one place where motion files are opened: regular files of bounded size; their checksum."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from radhar_cli.errors import MotionFileError
from radhar_cli.files.untrusted import bytes_of, refuse_outside
from radhar_cli.motion.recorded.recording import MAX_BYTES, MotionRecording, motion_file_error
from radhar_cli.readers.motion.amc import MAX_SKELETON, read_amc
from radhar_cli.readers.motion.bvh import read_bvh
from radhar_cli.readers.motion.c3d import read_c3d
from radhar_cli.readers.motion.frame_folders import read_frame_folder
from radhar_cli.readers.motion.json_poses import read_json_poses
from radhar_cli.readers.motion.npz import read_npy, read_npz
from radhar_cli.readers.motion.ntu_skeleton import read_ntu_skeleton
from radhar_cli.readers.motion.text_tables import read_table, read_trc

# {suffix: reader of (bytes, name of the file in messages)}; an AMC needs its skeleton, too.
_READERS: dict[str, Callable[[bytes, str], MotionRecording]] = {
    ".bvh": read_bvh,
    ".npz": read_npz,
    ".npy": read_npy,
    ".csv": read_table,
    ".tsv": read_table,
    ".txt": read_table,
    ".json": read_json_poses,
    ".jsonl": read_json_poses,
    ".ndjson": read_json_poses,
    ".trc": read_trc,
    ".c3d": read_c3d,
    ".skeleton": read_ntu_skeleton,
}
SUFFIXES = (".bvh", ".amc", *[suffix for suffix in _READERS if suffix != ".bvh"])
# What to do with files of other kinds.
ADVICE = {
    ".asf": "name its .amc files",
    ".fbx": "Blender imports it and exports .bvh",
    ".glb": "Blender imports it and exports .bvh",
    ".pkl": "pickles run code when they are read: save positions [frames, J, 3] by np.savez",
    ".pickle": "pickles run code when they are read: save positions [frames, J, 3] by np.savez",
    ".pt": "save positions [frames, J, 3] by np.savez",
    ".mat": "save positions [frames, J, 3] by np.savez(OUT, **scipy.io.loadmat(FILE))",
    ".mp4": "a pose network makes joints of it, such as MediaPipe (docs/guide/poses.md)",
    ".avi": "a pose network makes joints of it, such as MediaPipe (docs/guide/poses.md)",
}
WRITE_NPZ = "np.savez('clip.npz', names=[...], positions=p, rate=30), p [frames, J, 3] in m"


def describe_unknown(path: Path) -> str:
    """Words for a file of a kind that is not read: the kinds that are, and the way there."""
    advice = ADVICE.get(path.suffix.lower(), f"others by three lines of NumPy: {WRITE_NPZ}")
    return f"should be paths of {', '.join(SUFFIXES)} files, or FOLDER/ of JSON; {advice}"


def may_be_motion(path: str) -> bool:
    """Whether a path is that of a motion file, or with a slash at its end of a folder of frames."""
    return path.lower().endswith((*SUFFIXES, "/"))


class MotionBytes(NamedTuple):
    """Bytes of a motion file as it was read; with an AMC its skeleton."""

    path: Path
    data: bytes
    skeleton: tuple[Path, bytes] | None  # path and bytes of the ASF

    @property
    def checksum(self) -> str:
        """SHA-256 of the bytes, with the skeleton's after them."""
        digest = hashlib.sha256(self.data)
        if self.skeleton:
            digest.update(self.skeleton[1])
        return digest.hexdigest()

    def recording(self, where: str | None = None) -> MotionRecording:
        """Read the joints and frames.

        Args:
            where: Name of the file in messages; its path where it is None.

        Raises:
            MotionFileError: Names file, line and what is missing or odd.
        """
        where = where or str(self.path)
        if self.skeleton:
            return read_amc(self.data, where, self.skeleton[1], str(self.skeleton[0]))
        reader = _READERS.get(self.path.suffix.lower(), read_json_poses)  # of a folder
        return reader(self.data, where)


def read_motion(path: Path, skeleton: Path | None = None) -> MotionBytes:
    """Read the bytes of a motion file.

    Args:
        path: The file, of one of SUFFIXES, or a folder of JSON files, each of a frame.
        skeleton: ASF of an AMC; None looks for it beside the file.

    Raises:
        MotionFileError: It cannot be read, is too large, or of no kind that we know.
        FolderError: The skeleton is a link that leads elsewhere.
    """
    suffix = path.suffix.lower()
    if path.is_dir():
        return MotionBytes(path, read_frame_folder(path), None)
    if suffix not in SUFFIXES:
        raise motion_file_error(str(path), describe_unknown(path))
    data = bytes_of(path, MAX_BYTES, MotionFileError)
    asf_bytes = None
    if suffix == ".amc":
        asf = skeleton or find_skeleton(path)
        if asf.suffix.lower() != ".asf":
            raise motion_file_error(str(asf), "should be an .asf file")
        asf_bytes = (asf, bytes_of(asf, MAX_SKELETON, MotionFileError))
    return MotionBytes(path, data, asf_bytes)


def find_skeleton(path: Path) -> Path:
    """Find the ASF of an AMC: of its name, CMU's `02.asf` of `02_01.amc`, or the folder's only one.

    Raises:
        MotionFileError: There is none.
        FolderError: It is a link that leads elsewhere.
    """
    names = [f"{path.stem}.asf"]
    if "_" in path.stem:
        names.append(path.stem.rpartition("_")[0] + ".asf")
    try:
        files_beside = sorted(
            file for file in path.parent.iterdir() if file.suffix.lower() == ".asf"
        )
    except OSError:
        files_beside = []
    matching = [
        file for name in names for file in files_beside if file.name.lower() == name.lower()
    ]
    for candidate in matching or (files_beside if len(files_beside) == 1 else []):
        refuse_outside(candidate, path.parent)
        return candidate
    expected = " or ".join(names)
    raise motion_file_error(
        str(path),
        f"needs its skeleton beside it, {expected}; or name it: "
        "skeleton: FILE.asf of its class (--skeleton FILE.asf)",
    )
