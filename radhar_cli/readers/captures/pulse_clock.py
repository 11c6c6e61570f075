"""Times of pulses as files have them: seconds, other units, or time of an epoch."""

import numpy as np

from radhar_cli.errors import CaptureError
from radhar_cli.files.clocks import TIME_UNITS
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.captures.named_parts import unit_of_times

# Times since 1970 from about 1973 on, by their size: nanoseconds, microseconds, milliseconds.
EPOCHS = ((1e17, "ns"), (1e14, "us"), (1e11, "ms"))


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
    return (values - values[0]) * TIME_UNITS[unit or "s"], note
