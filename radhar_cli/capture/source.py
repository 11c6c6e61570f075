"""An open capture of any format, read in blocks of pulses."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.arrays import Float

Parts = NDArray[Any]
PIECE_BYTES = 2**24


@dataclass(frozen=True)
class Source:
    """An open capture.

    Attributes:
        files: its files.
        receivers: virtual receivers: transmitters times receivers.
        samples: of a chirp; None of slow time.
        pulses: of each virtual receiver.
        dtype: of the numbers.
        parts: 2 of complex samples, 1 of real ones.
        read: numbers [receiver, sample, stop - first, part] of pulses first .. stop - 1, one
            sample of slow time.
        times: of the pulses [pulses], s, if the capture contains them.
        step: pulses that are best read together.
        settings: fields of `CaptureSettings` that the capture itself contains.
        notes: findings on opening it, in words.
    """

    files: tuple[Path, ...]
    receivers: int
    samples: int | None
    pulses: int
    dtype: np.dtype[Any]
    parts: int
    read: Callable[[int, int], Parts]
    times: Float | None = None
    step: int = 1
    settings: dict[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """The first file, for messages."""
        return str(self.files[0])

    @property
    def pulse_bytes(self) -> int:
        """Bytes of one pulse."""
        return self.receivers * (self.samples or 1) * self.parts * self.dtype.itemsize

    def pieces(self) -> Iterator[tuple[int, int]]:
        """Consecutive (first, stop) of about PIECE_BYTES."""
        length = max(PIECE_BYTES // self.pulse_bytes, 1)
        if length > self.step or self.step * self.pulse_bytes <= 4 * PIECE_BYTES:
            length = max(length // self.step, 1) * self.step
        for first in range(0, self.pulses, length):
            yield first, min(first + length, self.pulses)
