"""Recordings of XeThru's X4 radars, made by its ModuleConnector and Explorer (.dat).

Two layouts, words of 32 bits, little endian ("XeThru file formats", Novelda; as its example
`read_baseband_iq.m` reads them):

    xethru_baseband_iq: counter, number of bins n, length of a bin (m), sampling frequency (Hz),
        carrier (Hz), range of the first bin (m), n times I, n times Q; of baseband_ap amplitude
        and phase (rad) instead
    xethru_datafloat: kind, counter, number of floats n, n floats: a real profile of the chip, or,
        after down-conversion in it, n/2 times I, n/2 times Q
"""

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import regular_size
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.readers.captures.array_axes import as_source
from radhar_cli.readers.captures.settings import AxisName
from radhar_cli.readers.captures.source import (
    CaptureFiles,
    CaptureFormat,
    MissingKeysError,
    Parts,
    Source,
)
from radhar_cli.readers.captures.stored_arrays import StoredArray

CHIP_HZ = 23.328e9  # sampling frequency of the X4
DECIMATION = 8  # of its down-conversion
MOST_BINS = 2**14
WORD = 4  # bytes
BASEBAND = np.dtype(
    [("counter", "<u4"), ("bins", "<u4"), ("step", "<f4"), ("rate", "<f4"), ("carrier", "<f4"),
     ("first", "<f4")]
)  # fmt: skip
FLOATS = np.dtype([("kind", "<u4"), ("counter", "<u4"), ("count", "<u4")])
IQ: tuple[AxisName, ...] = ("pulse", "iq", "sample")
WAVES: tuple[AxisName, ...] = ("pulse", "sample")


def _is_xethru(path: Path, head: bytes) -> bool:
    """Whether a file begins as the recordings of an X4 do."""
    return path.suffix.lower() == ".dat" and (_is_baseband(head) or _is_floats(head))


def _is_baseband(head: bytes) -> bool:
    """Whether a header of baseband data begins a file, by numbers that an X4 has."""
    if len(head) < BASEBAND.itemsize:
        return False
    header = np.frombuffer(head, BASEBAND, 1)[0]
    is_step = 1e-3 < header["step"] < 1
    return bool(
        1 < header["bins"] <= MOST_BINS and is_step and 1e9 < header["carrier"] < 2e10
        and 1e9 < header["rate"] < 1e11 and -10 < header["first"] < 100
    )  # fmt: skip


def _is_floats(head: bytes) -> bool:
    """Whether a header of floats begins a file: small whole numbers, then numbers near 1."""
    if len(head) < FLOATS.itemsize + 8 * WORD:
        return False
    header = np.frombuffer(head, FLOATS, 1)[0]
    values = np.frombuffer(head, "<f4", 8, FLOATS.itemsize)
    sizes = np.abs(values[values != 0])
    return bool(
        16 <= header["count"] <= MOST_BINS and header["kind"] < 2**16 and sizes.size
        and np.isfinite(values).all() and (sizes > 1e-12).all() and (sizes < 1e6).all()
    )  # fmt: skip


def _open_xethru(capture: CaptureFiles) -> Source:
    """Open a recording of an X4 as range profiles.

    Raises:
        CaptureError: profiles differ in their length, or are cut off.
    """
    path = capture.paths[0]
    with path.open("rb") as file:
        head = file.read(BASEBAND.itemsize)
    is_baseband = _is_baseband(head)
    header = np.frombuffer(head, BASEBAND if is_baseband else FLOATS, 1)[0]
    count = 2 * int(header["bins"]) if is_baseband else int(header["count"])
    record = np.dtype([("header", header.dtype), ("values", "<f4", (count,))])
    pulses = regular_size(path) // record.itemsize
    if not pulses:
        raise CaptureError(f"{path}: holds no profile of {count} numbers; truncated?")
    records = np.memmap(path, record, "r", shape=(pulses,))
    name = "bins" if is_baseband else "count"
    if (records["header"][name] != header[name]).any():
        raise CaptureError(f"{path}: profiles differ in their length; should have {count} numbers")
    lost = int(np.count_nonzero(np.diff(records["header"]["counter"].astype(np.int64)) != 1))
    notes = [f"{lost} gaps in the counter of profiles, taken as uniform"] if lost else []
    settings: dict[str, Any] = {"holds": "profiles"}
    is_polar = is_baseband and "_ap_" in path.name
    is_iq = is_baseband or _is_iq(path, capture.settings.axes)
    if is_baseband:
        settings |= {"carrier_hz": float(header["carrier"]), "range_step_m": float(header["step"])}
        settings["first_range_m"] = max(float(header["first"]), 0.0)
    else:
        step = SPEED_OF_LIGHT / (2 * CHIP_HZ)
        settings["range_step_m"] = step * DECIMATION if is_iq else step
    kind = "amplitude and phase" if is_polar else "I, then Q" if is_iq else "waves of the pulse"
    notes.append(f"recording of an X4: {kind}, {count // (1 + is_iq)} bins a profile")
    load = partial(_load, path, record, pulses, is_iq)
    named = capture.settings.model_copy(update={"axes": IQ if is_iq else WAVES})
    source = as_source(path, StoredArray(str(path), load), named)
    read = partial(_read_polar, source) if is_polar else source.read
    return replace(source, read=read, settings=settings, notes=(*source.notes, *notes))


def _load(path: Path, record: np.dtype[Any], pulses: int, is_iq: bool) -> NDArray[np.float32]:
    """Map the values [pulse, sample], or [pulse, part, sample] of complex ones."""
    values = np.memmap(path, record, "r", shape=(pulses,))["values"]
    return values.reshape(pulses, 2, -1) if is_iq else values


def _read_polar(source: Source, first: int, stop: int) -> Parts:
    """Read pulses [receiver, sample, pulse, part] whose parts are amplitude and phase."""
    polar = source.read(first, stop)
    values = polar[..., 0] * np.exp(1j * polar[..., 1])
    return np.stack([values.real, values.imag], axis=-1).astype(np.float32)


def _is_iq(path: Path, axes: tuple[AxisName, ...] | None) -> bool:
    """Whether floats are I, then Q, of down-converted profiles, or waves of the pulse.

    Raises:
        MissingKeysError: no key says it, and no header does.
    """
    if axes not in (IQ, WAVES):
        raise MissingKeysError(
            f"{path}: does not say whether the chip converted its profiles down, to I and then Q "
            "(axes=[pulse,iq,sample]), or wrote waves of the pulse (axes=[pulse,sample])",
            {"axes": "[pulse,iq,sample]"},
        )
    return axes == IQ


XETHRU = CaptureFormat(".dat of XeThru's X4", _is_xethru, _open_xethru)
