"""Names by which I and Q, and times of pulses, are found among arrays or columns."""

import re
from collections.abc import Iterable

# In lower case, as whole names or after an underscore: in phase, and in quadrature.
PAIRS = (
    ("i", "q"),
    ("ich", "qch"),
    ("i_data", "q_data"),
    ("idata", "qdata"),
    ("real", "imag"),
    ("re", "im"),
    ("real", "imaginary"),
    ("inphase", "quadrature"),
    ("in_phase", "quadrature"),
)
SECONDS = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}  # of units of time
_UNIT = re.compile(r"\s*[\[(]([^\])]*)[\])]\s*$")
_TIMES = re.compile(r"(?:t|times?|timestamps?|seconds)(?:[ _]?(s|sec|ms|us|ns))?")


def find_pair(names: Iterable[str]) -> tuple[str, str] | None:
    """Names of I and of Q among names; None unless there is one such pair."""
    by_lower = {_without_unit(name): name for name in names}
    found_pairs = {
        (by_lower[lower], by_lower[stem + quadrature])
        for lower in by_lower
        for phase, quadrature in PAIRS
        for stem in _stems(lower, phase)
        if stem + quadrature in by_lower
    }
    return found_pairs.pop() if len(found_pairs) == 1 else None


def _stems(name: str, ending: str) -> list[str]:
    """What stands before an ending that is a word of its own in a name."""
    stem = name.removesuffix(ending)
    is_word = name.endswith(ending) and (not stem or stem[-1] in "_./ ")
    return [stem] if is_word else []


def find_times(names: Iterable[str]) -> str | None:
    """Name of the times among names; None without one."""
    return next((name for name in names if _TIMES.fullmatch(_without_unit(name))), None)


def seconds_of_unit(name: str) -> float:
    """Seconds of the unit in the name of times, such as `time_ms` or `Time [ms]`; 1 without."""
    bracket, suffix = _UNIT.search(name), _TIMES.fullmatch(_without_unit(name))
    unit = bracket[1].strip().lower() if bracket else suffix and suffix[1]
    return SECONDS.get(unit or "s", 1.0)


def _without_unit(name: str) -> str:
    """A name in lower case, without a unit in brackets at its end."""
    return _UNIT.sub("", name).strip().lower()
