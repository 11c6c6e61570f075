"""Files of the Glasgow set: four numbers, then complex samples as text, a number a line.

University of Glasgow, doi 10.5525/gla.researchdata.848. The numbers are carrier (Hz), sweep time
(ms), samples of a sweep, bandwidth (Hz); samples follow sweep after sweep, `-1.5+2i`.
"""

import re
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import bytes_of
from radhar_cli.numerics.arrays import Complex
from radhar_cli.readers.captures.array_axes import as_source
from radhar_cli.readers.captures.source import CaptureFiles, CaptureFormat, Source
from radhar_cli.readers.captures.stored_arrays import StoredArray
from radhar_cli.readers.captures.text_files import is_text

MAX_BYTES = 2**28
_NUMBER = rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_HEADER = re.compile(
    rb"\s*" + rb"\s+".join([b"(" + _NUMBER + b")"] * 4) + rb"[ \t\r]*\n"
    rb"\s*(?=(?:" + _NUMBER + rb"[-+](?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?[ij]\s+){2})"
)
_TO_SPACES = bytes.maketrans(b"ijE", b"  e")


def _is_of_glasgow(path: Path, head: bytes) -> bool:
    """Whether a file begins with four real numbers and complex ones, a number a line."""
    return is_text(path, head) and _HEADER.match(head) is not None


def _open_glasgow(capture: CaptureFiles) -> Source:
    """Open a file of the Glasgow set, which says carrier, sweep, samples and bandwidth itself.

    An incomplete last sweep is left out.

    Raises:
        CaptureError: the file is too large, or is not numbers throughout.
    """
    path = capture.paths[0]
    text = bytes_of(path, MAX_BYTES, CaptureError)
    header = _HEADER.match(text)
    assert header is not None  # as `_is_of_glasgow` found
    carrier, sweep_ms, count, bandwidth = map(float, header.groups())
    values = _parse_samples(text[header.end() :], path)
    samples = int(count) if 2 <= count <= len(values) and sweep_ms > 0 else 0
    if not samples:
        raise CaptureError(
            f"{path}: has {len(values)} samples; line 3 says {count:g} a sweep of {sweep_ms:g} ms"
        )
    sweeps = values[: len(values) // samples * samples].reshape(-1, samples)
    array = StoredArray(str(path), partial(np.asarray, sweeps))
    prf = 1e3 / sweep_ms
    said = {
        "carrier_hz": carrier,
        "bandwidth_hz": bandwidth,
        "prf_hz": prf,
        "adc_rate_hz": samples * prf,
    }
    axes = capture.settings.model_copy(update={"axes": ("pulse", "sample")})
    return replace(as_source(path, array, axes), settings=said)


def _parse_samples(text: bytes, path: Path) -> Complex:
    """Parse complex numbers [n] of lines; a last one that is cut is left out.

    Both parts become numbers of their own, which NumPy reads ten times as fast as complex ones.

    Raises:
        CaptureError: a line is no complex number.
    """
    end = max(text.rfind(b"i"), text.rfind(b"j")) + 1
    text, cut = text[:end], text[end:]
    lines = text.count(b"i") + text.count(b"j")
    spaced = text.translate(_TO_SPACES).replace(b"-", b" -").replace(b"+", b" +")
    spaced = spaced.replace(b"e -", b"e-").replace(b"e +", b"e+")
    try:
        numbers = np.fromstring(spaced, sep=" ")
    except ValueError:
        numbers = np.empty(0)
    if len(numbers) != 2 * lines or b"\n" in cut.strip() or text.count(b"\n") + 1 < lines:
        raise CaptureError(f"{path}: after line 4: should be a complex number a line, as -1.5+2i")
    return numbers.view(np.complex128)


GLASGOW = CaptureFormat("text of the Glasgow set", _is_of_glasgow, _open_glasgow)
