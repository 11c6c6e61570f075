"""Folders of poses with a file a frame, as OpenPose writes them: one recording of their JSON."""

import re
from collections import Counter
from itertools import pairwise
from pathlib import Path

from radhar_cli.errors import MotionFileError
from radhar_cli.files.untrusted import bytes_of, refuse_outside
from radhar_cli.motion.recorded.recording import MAX_FRAMES, motion_file_error
from radhar_cli.readers.motion.json_poses import MAX_JSON

_NUMBER = re.compile(r"(\d+)\D*$")
_PIXELS = frozenset({".png", ".jpg", ".jpeg", ".bmp"})


def read_frame_folder(folder: Path) -> bytes:
    """Read the JSON files of a folder as one list, in the order of the numbers in their names.

    A number that is left out is a lost frame.

    Args:
        folder: Folder of `*.json`, each of one frame.

    Returns:
        Text of a JSON list with a frame a file, null where one is left out.

    Raises:
        MotionFileError: There are no such files, too many, or one cannot be read.
        FolderError: A file is a link that leads out of the folder.
    """
    try:
        names = sorted(path.name for path in folder.iterdir())
    except OSError as error:
        raise MotionFileError(f"{folder}: cannot be read ({error.strerror})") from None
    files = [name for name in names if name.lower().endswith(".json")]
    if not files:
        raise motion_file_error(str(folder), _describe_folder(names))
    if len(names) > MAX_FRAMES:
        raise motion_file_error(str(folder), f"has more than {MAX_FRAMES} files")
    numbers = [_NUMBER.search(name.removesuffix("_keypoints.json")) for name in files]
    ordered = sorted(
        (int(match[1][-15:]) if match else 0, name)
        for match, name in zip(numbers, files, strict=True)
    )
    texts, size = list[bytes](), 0
    step = _step([number for number, _ in ordered])
    for place, (number, name) in enumerate(ordered):
        if place:
            missing = (number - ordered[place - 1][0]) // step - 1
            texts += [b"null"] * min(max(missing, 0), MAX_FRAMES)
        text = _read_file(folder / name, folder)
        texts.append(text.strip() or b"null")
        size += len(text)
        if size > MAX_JSON or len(texts) > MAX_FRAMES:
            raise motion_file_error(
                str(folder), f"has more than {MAX_JSON} bytes of JSON, or {MAX_FRAMES} frames"
            )
    return b"[" + b",\n".join(texts) + b"]"


def _step(numbers: list[int]) -> int:
    """Smallest step from one number to the next one, 1 or more."""
    steps = [after - before for before, after in pairwise(numbers)]
    return max(1, min((step for step in steps if step > 0), default=1))


def _read_file(path: Path, folder: Path) -> bytes:
    """Bytes of a regular file of a folder."""
    refuse_outside(path, folder)
    return bytes_of(path, MAX_JSON, MotionFileError).removeprefix(b"\xef\xbb\xbf")


def _describe_folder(names: list[str]) -> str:
    """Words for a folder without JSON: the kind of its files, and the way on."""
    counts = Counter(Path(name).suffix.lower() for name in names if not name.startswith("."))
    suffix = counts.most_common(1)[0][0] if counts else ""
    if suffix in _PIXELS:
        return (
            f"is a folder of {suffix} images; a pose network makes joints of them, such as "
            "MediaPipe (docs/guide/poses.md)"
        )
    if suffix in (".npy", ".csv", ".txt"):
        load = "np.load(f)" if suffix == ".npy" else "np.loadtxt(f, delimiter=',')"
        return (
            f"is a folder of {suffix} files; if each is a frame, make one of all: p = np.stack(["
            f"{load} for f in sorted(glob.glob('FOLDER/*{suffix}'))]); np.savez('clip.npz', "
            "names=[...], positions=p, rate=30), p [frames, J, 3] in m"
        )
    if suffix:
        return (
            f"is a folder of {suffix} files; name one of them, or all in a class, files: "
            f"[FOLDER/*{suffix}]; only JSON is read as a folder of frames"
        )
    return "is a folder without files; should be a motion file, or a folder of JSON, one a frame"
