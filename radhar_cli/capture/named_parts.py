"""Names by which I and Q, and times of pulses, are found among arrays or columns."""

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
TIMES = ("t", "time", "times", "time_s", "t_s", "timestamp", "timestamp_s", "seconds")


def find_pair(names: Iterable[str]) -> tuple[str, str] | None:
    """Names of I and of Q among names; None unless there is one such pair."""
    by_lower = {name.lower(): name for name in names}
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
    return next((name for name in names if name.lower() in TIMES), None)
