"""Instants of frames as text: dates with times, clocks, numbers."""

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.numerics.arrays import Float

_ZONE = re.compile(r"\s*(?:Z|UTC|GMT|[+-]\d\d:?\d\d)$")
_CLOCK = re.compile(
    r"^(?:(?P<hours>\d{1,2}):)?(?P<minutes>\d{1,2}):(?P<seconds>\d{1,2}(?:[.,]\d{1,9})?)$"
)
_DAY_FIRST = re.compile(r"^(\d{1,2})\.(\d{1,2})\.(\d{4})[ T]+")
_DAY_S = 86400.0


def dates_of(texts: NDArray[Any] | Sequence[str]) -> NDArray[Any]:
    """Dates and times of texts such as 2026-05-01T12:00:00.033 as NumPy's; the texts if not so."""
    words = [t.decode("ascii", "replace") if isinstance(t, bytes) else str(t) for t in texts]
    try:
        return np.array([_as_iso(word) for word in words], "datetime64[ns]")
    except ValueError:
        return np.asarray(words)


def _as_iso(word: str) -> str:
    """Date and time as NumPy reads them: no zone, hyphens, a point before the fraction."""
    plain = _ZONE.sub("", word.strip()).replace("/", "-").replace(",", ".")
    return _DAY_FIRST.sub(lambda m: f"{m[3]}-{int(m[2]):02d}-{int(m[1]):02d}T", plain)


def seconds_of_texts(texts: Sequence[str]) -> Float | None:
    """Seconds from the first of texts that are dates with times, or times of a clock.

    Args:
        texts: Such as 2026-05-01T12:00:00.033+02:00, 2026/05/01 12:00:00.033, 12:00:00.033.

    Returns:
        Seconds [N]; None where a text is neither. A clock may pass midnight.
    """
    clocks = [_CLOCK.match(text.strip()) for text in texts]
    if texts and all(clocks):
        seconds = np.array([_clock_seconds(clock) for clock in clocks if clock])
        days = np.concatenate([[0], np.cumsum(np.diff(seconds) < -_DAY_S / 2)])
        return np.asarray(seconds + _DAY_S * days - seconds[0])
    dates = dates_of(texts)
    if dates.dtype.kind != "M" or np.isnat(dates).any():
        return None
    nanoseconds = dates.astype("datetime64[ns]").astype(np.int64)
    return np.asarray((nanoseconds - nanoseconds[:1]) * 1e-9)


def _clock_seconds(clock: re.Match[str]) -> float:
    """Seconds of a time such as 12:00:00.033."""
    seconds = float(clock["seconds"].replace(",", "."))
    return 3600.0 * int(clock["hours"] or 0) + 60.0 * int(clock["minutes"]) + seconds
