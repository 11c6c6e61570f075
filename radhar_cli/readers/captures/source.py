"""An open capture of any format, read in blocks of pulses, and what a format is."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from radhar_cli.errors import CaptureError
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.captures.settings import CaptureSettings

Parts = NDArray[Any]
PIECE_BYTES = 2**24
HEAD_BYTES = 512  # by which a format is recognised


@dataclass(frozen=True)
class Source:
    """An open capture."""

    files: tuple[Path, ...]  # its files
    receivers: int  # virtual receivers: transmitters times receivers
    samples: int | None  # of a chirp; None of slow time
    pulses: int  # of each virtual receiver
    dtype: np.dtype[Any]  # of the numbers
    parts: int  # 2 of complex samples, 1 of real ones
    # numbers [receiver, sample, stop - first, part] of pulses first .. stop - 1, one sample of slow
    # time
    read: Callable[[int, int], Parts]
    times: Float | None = None  # of the pulses [pulses], s, if the capture contains them
    step: int = 1  # pulses that are best read together
    is_part: bool = False  # whether its files hold pulses of other subframes, too
    # fields of `CaptureSettings` that the capture itself contains
    settings: dict[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()  # findings on opening it, in words
    # sign of the beat frequencies where the samples do not show it
    usual_beat: Literal["negative", "positive"] | None = None

    @property
    def name(self) -> str:
        """Name of the first file, for messages."""
        return str(self.files[0])

    @property
    def pulse_bytes(self) -> int:
        """Number of bytes of one pulse of all receivers."""
        return self.receivers * (self.samples or 1) * self.parts * self.dtype.itemsize

    def pieces(self) -> Iterator[tuple[int, int]]:
        """Yield (first pulse, past-last pulse) of consecutive pieces of about PIECE_BYTES."""
        length = max(PIECE_BYTES // self.pulse_bytes, 1)
        if length > self.step or self.step * self.pulse_bytes <= 4 * PIECE_BYTES:
            length = max(length // self.step, 1) * self.step
        for first in range(0, self.pulses, length):
            yield first, min(first + length, self.pulses)


class MissingKeysError(CaptureError):
    """A capture that cannot be opened without further keys.

    Attributes:
        examples: The keys, with values that they may have.
    """

    def __init__(self, message: str, examples: Mapping[str, str]) -> None:
        super().__init__(message)
        self.examples = examples


@dataclass(frozen=True)
class CaptureFiles:
    """The files of a capture that is to be opened, and what is known of them."""

    paths: Sequence[Path]  # its files, or the first of those that are numbered
    settings: CaptureSettings  # header of the capture
    header: str  # file of the header, for messages
    scratch: Path  # folder for unpacked arrays
    subframes: int = 1  # number of subframes of its frames, each of which is a recording


@dataclass(frozen=True)
class CaptureFormat:
    """A format of captures; `radhar_cli.readers.captures.formats` lists all."""

    name: str  # for messages, such as ".npy"
    recognises: Callable[[Path, bytes], bool]  # by the file's name and its first HEAD_BYTES
    # raises CaptureError where the capture is damaged, or does not fit its header
    open: Callable[[CaptureFiles], Source]
    is_split: bool = False  # whether one capture may be several files
    has_subframes: bool = False  # whether pulses of several subframes may follow each other
