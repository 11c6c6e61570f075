"""Instants: dates with times and times of a clock as seconds from the first; units of numbers."""

import re
from collections.abc import Sequence
from datetime import date

import numpy as np

from radhar_cli.numerics.arrays import Float

DAY_S, HOUR_S = 86400, 3600
# Seconds of the units in which instants are written; ticks are of 100 ns, as the Kinect's.
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ticks": 1e-7, "ns": 1e-9}
# {other words for them: the unit}
TIME_WORDS = {unit: unit for unit in TIME_UNITS} | {
    **dict.fromkeys(("sec", "secs", "seconds"), "s"),
    **dict.fromkeys(("msec", "milliseconds"), "ms"),
    **dict.fromkeys(("µs", "usec", "microseconds"), "us"),
    **dict.fromkeys(("nsec", "nanoseconds"), "ns"),
}
READ_CLOCKS = "2026-05-01 12:00:00.033, 27/10/2026 12:00:00.033, 12:00:00.033 and 03:12.5"
_DATE = r"(?:(\d{4})[-/.](\d\d?)[-/.](\d\d?)|(\d\d?)([-/.])(\d\d?)[-/.](\d{4}))"
_HALF = r"(?:\s*([AaPp])\.?[Mm]\b\.?)?"
_ZONE = r"(?:\s*(?:Z|UTC|GMT|([-+]\d\d):?(\d\d)))?"
_HEAD, _TAIL = rf"(?:{_DATE}[T ,;]?\s*)?", rf"{_HALF}{_ZONE}"
_WHOLE = re.compile(
    rf"\s*{_HEAD}(?:(\d\d?):)?(\d\d?):(\d\d?)(?:[.:,](\d{{1,9}}))?{_TAIL}\s*", re.ASCII
)


def seconds_of_texts(texts: Sequence[str]) -> Float | None:
    """Seconds from the first of texts that are dates with times, or times of a clock.

    Args:
        texts: Such as 2026-05-01T12:00:00.033+02:00, 27/10/2026 12:00:00,033, 12:00:00.033,
            03:12.5.

    Returns:
        Seconds [N]; None where a text is no such. A clock may pass midnight, minutes the hour.
    """
    matches = [match for text in texts if (match := _WHOLE.fullmatch(text))]
    if not texts or len(matches) < len(texts):
        return None
    try:
        return np.array(_read_column(matches))
    except ValueError:  # a month of more than 12
        return None


def _read_column(matches: Sequence[re.Match[str]]) -> list[float]:
    """Seconds of instants from the first; days of a date that may be read both ways are close.

    Raises:
        ValueError: There is no such date.
    """
    readings = list[list[float]]()
    for is_day_first in (True, False):
        try:
            readings.append(_read_instants(matches, is_day_first))
        except ValueError:
            continue
    if not readings:
        raise ValueError("no such date")
    return min(readings, key=lambda seconds: max(seconds) - min(seconds))


def _read_instants(matches: Sequence[re.Match[str]], is_day_first: bool) -> list[float]:
    """Seconds of instants from the first.

    Times without a date may pass midnight, those without hours the hour.

    Args:
        matches: Instants, of the patterns of this file.
        is_day_first: Whether 05/06/2026 is of June; 05.06.2026 always is.

    Raises:
        ValueError: There is no such date.
    """
    instants = list[tuple[int, float]]()
    begin_s, last = 0, 0  # of the day, or of the hour
    for match in matches:
        year, month, number, first, mark, second, other_year, hours, minutes, seconds, *others = (
            match.groups()
        )
        *fractions, half, zone_hours, zone_minutes = others
        time = 3600 * int(hours or 0) + 60 * int(minutes) + int(seconds)
        if half:  # of the day, which begins with 12
            time = time % (DAY_S // 2) + (half in "Pp") * DAY_S // 2
        if year:
            begin_s = DAY_S * date(int(year), int(month), int(number)).toordinal()
        elif other_year:
            parts = (first, second) if is_day_first or mark == "." else (second, first)
            begin_s = DAY_S * date(int(other_year), int(parts[1]), int(parts[0])).toordinal()
        elif time < last - (DAY_S if hours else HOUR_S) / 2:
            begin_s += DAY_S if hours else HOUR_S
        last = time
        zone = 60 * int(zone_minutes or 0) + 3600 * abs(int(zone_hours or 0))
        zone = -zone if (zone_hours or "").startswith("-") else zone
        fraction = next(filter(None, fractions), "")
        instants.append((begin_s + time - zone, float(f"0.{fraction}") if fraction else 0.0))
    begin, part = instants[0]
    return [whole - begin + (fraction - part) for whole, fraction in instants]
