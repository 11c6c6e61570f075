"""Captures of the Glasgow set (University of Glasgow, doi 10.5525/gla.researchdata.848).

A text that begins with four numbers, one a line: carrier (Hz), sweep time (ms), samples of a sweep,
bandwidth (Hz); complex samples follow, sweep after sweep.
"""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from radhar_cli.errors import CaptureError
from radhar_cli.readers.captures.array_axes import as_source
from radhar_cli.readers.captures.source import CaptureFiles, CaptureFormat, Source
from radhar_cli.readers.captures.stored_arrays import StoredArray
from radhar_cli.readers.captures.text_files import (
    MAX_PULSES,
    capture_error,
    is_text,
    read_capture_lines,
)
from radhar_cli.readers.text_table import is_number, split_lines

HEADER = 4  # lines


def _is_of_glasgow(path: Path, head: bytes) -> bool:
    """Whether four real numbers are followed by a complex one, a number a line."""
    if not is_text(path, head):
        return False
    lines = [line.strip() for line in head.decode("latin-1").splitlines()[: HEADER + 1]]
    return len(lines) > HEADER and all(map(is_number, lines[:HEADER])) and lines[-1][-1:] in {*"ij"}


def _open_glasgow(capture: CaptureFiles) -> Source:
    """Open a file that says carrier, sweep time, samples and bandwidth itself.

    Raises:
        CaptureError: it has fewer samples than a sweep, or what are no numbers.
    """
    path = capture.paths[0]
    table = split_lines(read_capture_lines(path), str(path), capture_error)
    carrier, sweep_ms, count, bandwidth = map(float, table.lines[:HEADER])
    values = table.numbers(table.filled_rows(HEADER, 1), [0], 64 * MAX_PULSES, complex)[:, 0]
    samples = int(count) if 2 <= count <= len(values) and sweep_ms > 0 else 0
    if not samples:
        raise CaptureError(
            f"{path}: has {len(values)} samples; line 3 says {count:g} a sweep of {sweep_ms:g} ms"
        )
    sweeps = values[: len(values) // samples * samples].reshape(-1, samples)
    settings = capture.settings.model_copy(update={"axes": ("pulse", "sample")})
    array = StoredArray(str(path), partial(np.asarray, sweeps))
    prf = 1e3 / sweep_ms
    header = {
        "carrier_hz": carrier,
        "bandwidth_hz": bandwidth,
        "prf_hz": prf,
        "adc_rate_hz": samples * prf,
    }
    return replace(as_source(path, array, settings), settings=header)


GLASGOW = CaptureFormat("text of the Glasgow set", _is_of_glasgow, _open_glasgow)
