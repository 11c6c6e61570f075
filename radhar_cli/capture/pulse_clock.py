"""Times of pulses as files have them: seconds, other units, time of an epoch, dates, clocks."""

import re
from datetime import datetime

import numpy as np

from radhar_cli.capture.named_parts import unit_of_times
from radhar_cli.errors import CaptureError
from radhar_cli.numerics.arrays import Float

SECONDS = {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9}
# Times since 1970 from about 1973 on, by their size: nanoseconds, microseconds, milliseconds.
EPOCHS = ((1e17, "ns"), (1e14, "us"), (1e11, "ms"))
_DATE = r"(?:(\d{4})[-/](\d\d?)[-/](\d\d?)|(\d\d?)\.(\d\d?)\.(\d{4}))"
# A comma before a fraction may as well stand between columns, unless something else does.
_CLOCK = r"(\d\d?):(\d\d):(\d\d)(?:[.:](\d{1,9})|,(\d{1,9})(?=\s*[;\t]))?"
_INSTANT = re.compile(rf"(?:{_DATE}[T ,;]?\s*)?{_CLOCK}\s*(Z|[-+]\d\d:?\d\d)?(?![\d:])")


def seconds_of(values: Float, name: str, where: str) -> tuple[Float, str | None]:
    """Times of pulses in s from the first, and what was assumed of them, in words.

    Args:
        values: times [pulse] as they are stored.
        name: name of their column or array, which may hold the unit, such as `time_ms`.
        where: file, for messages.

    Raises:
        CaptureError: nothing tells the unit, and steps of whole numbers are hardly seconds.
    """
    unit, note = unit_of_times(name), None
    largest = float(np.nanmax(np.abs(values))) if values.size else 0.0
    if unit is None:
        unit = next((name for size, name in EPOCHS if largest > size), None)
        note = None if unit is None else f"{name}: {unit} since 1970, by their size"
    steps = np.diff(values)
    if unit is None and values.size > 2 and (steps == np.round(steps)).all() and steps.any():
        raise CaptureError(
            f"{where}: {name} counts in whole numbers, without a unit: name it with one, such as "
            f"{name}_ms or '{name} [us]', or leave it out by --set times=none and give prf_hz"
        )
    return (values - values[0]) * SECONDS[unit or "s"], note


def replace_clocks(text: str) -> str:
    """Replace dates and times of day in a text by seconds since the first."""
    first: list[int] = []

    def seconds(match: re.Match[str]) -> str:
        year, month, day, day_2, month_2, year_2, hour, minute, second, *others = match.groups()
        fraction = others[0] or others[1]  # then the zone, the same in all lines
        date = datetime(int(year or year_2 or 1970), int(month or month_2 or 1), 1)
        days = date.toordinal() + int(day or day_2 or 1)
        part = float(f"0.{fraction}") if fraction else 0.0
        whole_seconds = ((days * 24 + int(hour)) * 60 + int(minute)) * 60 + int(second)
        if not first:
            first.append(whole_seconds)
        return f"{whole_seconds - first[0] + part:.9f}"

    try:
        return _INSTANT.sub(seconds, text)
    except ValueError:  # a month of more than 12
        return text
