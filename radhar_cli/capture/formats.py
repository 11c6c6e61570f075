"""Formats of captures: what adds one is a file with a `CaptureFormat`, and its line here."""

from radhar_cli.capture import array_files, dca1000
from radhar_cli.capture.source import HEAD_BYTES, CaptureFiles, CaptureFormat, Source
from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import regular_size

# The first that recognises a file opens it; raw words, which have no mark, go by the name.
FORMATS: list[CaptureFormat] = [
    dca1000.FORMAT,
    array_files.NPY,
    array_files.NPZ,
    array_files.MAT,
    array_files.HDF5,
]


def open_capture(files: CaptureFiles) -> Source:
    """Open a capture of any format.

    Raises:
        CaptureError: the format is unknown, or the capture does not fit its header.
    """
    path = files.paths[0]
    try:
        regular_size(path)
        with path.open("rb") as file:
            head = file.read(HEAD_BYTES)
    except OSError as error:
        raise CaptureError(f"{path}: {error.strerror}") from None
    for form in FORMATS:
        if form.recognises(path, head):
            if len(files.paths) > 1 and not form.is_split:
                split = " and ".join(other.name for other in FORMATS if other.is_split)
                raise CaptureError(
                    f"{files.paths[1]}: only captures of {split} are split into several files"
                )
            return form.open(files)
    names = [form.name for form in FORMATS]
    raise CaptureError(f"{path}: unknown format; should be {', '.join(names[:-1])} or {names[-1]}")
