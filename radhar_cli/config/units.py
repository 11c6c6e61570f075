"""Units of keys: values with a unit, or under a key in another unit, converted into ours."""

import re
from collections.abc import Iterable
from math import floor, log10

# {last word of a key: (unit, {other spelling: factor to it})}; kHz, ms and the like: PREFIXES.
UNITS: dict[str, tuple[str, dict[str, float]]] = {
    "hz": ("Hz", {"hertz": 1.0, "rpm": 1 / 60}),
    "s": ("s", {"sec": 1.0, "second": 1.0, "seconds": 1.0, "min": 60.0, "h": 3600.0}),
    "m": (
        "m",
        {"metre": 1.0, "meter": 1.0, "metres": 1.0, "meters": 1.0, "in": 0.0254, "ft": 0.3048},
    ),
    "mps": ("m/s", {"mps": 1.0, "kmh": 1 / 3.6, "km/h": 1 / 3.6, "kph": 1 / 3.6, "mph": 0.44704}),
    "deg": ("deg", {"degree": 1.0, "degrees": 1.0, "°": 1.0, "rad": 57.29577951308232}),
    "kg": ("kg", {"g": 1e-3, "lb": 0.45359237, "lbs": 0.45359237}),
    "db": ("dB", {}),
    "dbi": ("dBi", {}),
    "dbm": ("dBm", {}),
    "dbsm": ("dBsm", {}),
    "px": ("px", {"pixel": 1.0, "pixels": 1.0}),
}
PREFIXES = {"T": 1e12, "G": 1e9, "M": 1e6, "k": 1e3, "K": 1e3, "d": 0.1, "c": 1e-2, "m": 1e-3}
PREFIXES |= {"u": 1e-6, "µ": 1e-6, "μ": 1e-6, "n": 1e-9}
PREFIXED = ("hz", "s", "m")  # units that come with prefixes
_VALUE = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\D{1,12}?)\s*")


def unit_of(key: str) -> str | None:
    """Unit that a dotted key ends with, "hz" for `radar.prf_hz`; None where it has none."""
    named = next((name for name in reversed(key.split(".")) if not name.isdecimal()), "")
    stem, _, last = named.rpartition("_")
    return last if stem and last in UNITS else None


def factor_of(written: str, unit: str) -> float | None:
    """Factor from a written unit to ours, 1e3 for "kHz" and "hz"; None for another quantity.

    Args:
        written: unit as a user wrote it.
        unit: key of UNITS.
    """
    name, others = UNITS[unit]
    spellings = {name.lower(): 1.0, **{other.lower(): value for other, value in others.items()}}
    if written.lower() in spellings:
        return spellings[written.lower()]
    prefix, base = written[:1], written[1:]
    if unit not in PREFIXED or base.lower() != name.lower():
        return None
    if unit == "hz" and prefix in "tgm":  # nobody has a radar of millihertz
        prefix = prefix.upper()
    return PREFIXES.get(prefix)


def value_with_unit(key: str, value: object) -> str | None:
    """Advice on a text such as `3.5 kHz` under `radar.prf_hz`; None for other values and keys."""
    unit = unit_of(key)
    match = _VALUE.fullmatch(value) if isinstance(value, str) else None
    if unit is None or match is None:
        return None
    factor = factor_of(match[2], unit)
    if factor is None:
        return None
    return f"should be {_number_text(float(match[1]) * factor)}, a number in {UNITS[unit][0]}"


def key_in_our_unit(name: str, value: object, known: Iterable[str]) -> str | None:
    """Advice on an unknown key that is a known one in another unit, such as `carrier_ghz`.

    Args:
        name: last name of the unknown key.
        value: value under it, which is converted if it is a number.
        known: names that could be meant, dotted or not.

    Returns:
        The advice, or None where no known name is meant.
    """
    stem, _, last = name.rpartition("_")
    for key in known:
        unit = unit_of(f".{key}")
        if not stem or unit is None or key.rpartition(".")[2].rpartition("_")[0] != stem:
            continue
        factor = factor_of(last, unit)
        if factor is None:
            continue
        our_unit = UNITS[unit][0]
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return f"should be {key}: {_number_text(value * factor)}, a number in {our_unit}"
        return f"should be {key}, {_number_text(factor)} times the value, in {our_unit}"
    return None


# {unit: other spellings in which people give numbers that lie beyond the range of a key}.
_USUAL: dict[str, tuple[str, ...]] = {
    "hz": ("GHz", "MHz", "kHz"),
    "s": ("ms", "us", "ns", "min"),
    "m": ("cm", "mm", "km"),
    "mps": ("km/h",),
    "deg": ("rad",),
    "kg": ("g",),
}


def number_in_another_unit(key: str, number: float, low: float, high: float) -> str | None:
    """Describe a number beyond its range in another unit that may be meant: "175 cm is 1.75".

    Args:
        key: dotted key.
        number: the number under it.
        low: least number that is right.
        high: largest number that is right.

    Returns:
        The words, or None where no other unit brings the number into its range.
    """
    unit = unit_of(key)
    if unit is None or low <= number <= high:
        return None
    others = _USUAL.get(unit, ())
    if unit == "hz" and not key.endswith("carrier_hz"):
        others = ("MHz", "kHz", "GHz")
    for other in others:
        factor = factor_of(other, unit)
        if factor is not None and low <= number * factor <= high:
            return f"{number:g} {other} is {_number_text(number * factor)}"
    return None


def _number_text(number: float) -> str:
    """Write a number, with a power of 1000 where it is large or small, as in 24e9."""
    if number == 0 or 1e-3 <= abs(number) < 1e6:
        return f"{number:.10g}"
    power = 3 * floor(log10(abs(number)) / 3)
    return f"{number / 10.0**power:.10g}e{power}"
