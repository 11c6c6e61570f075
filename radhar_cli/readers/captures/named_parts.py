"""Names by which I and Q, amplitude and phase, and times of pulses are found among others."""

import re
from collections.abc import Iterable, Sequence

from radhar_cli.files.clocks import TIME_WORDS

# In lower case and without words that say nothing: in phase, and in quadrature.
PAIRS = (
    ("i", "q"),
    ("ich", "qch"),
    ("idata", "qdata"),
    ("real", "imag"),
    ("re", "im"),
    ("real", "imaginary"),
    ("inphase", "quadrature"),
    ("in_phase", "quadrature"),
)
POLAR = (
    ("amplitude", "phase"),
    ("amp", "phase"),
    ("magnitude", "phase"),
    ("mag", "phase"),
    ("abs", "angle"),
    ("abs", "phase"),
)
FILLERS = {"part", "channel", "value", "values", "data", "signal", "component", "adc", "raw"}
NUMBERED = ("ch", "chan", "rx", "ant", "antenna", "receiver")  # words before a receiver's number
ANGLES = {"deg": "deg", "degree": "deg", "degrees": "deg", "°": "deg", "rad": "rad"}
_UNIT = re.compile(r"\s*[\[(]([^\])]*)[\])]\s*$")
_TIMES = re.compile(
    r"(?:t|(?:date ?|unix ?|epoch ?)?times?(?: ?stamps?)?|timestamps?|date|seconds)"
    r"(?: (s|sec|ms|us|µs|ns|utc))?"
)
_WORDS = re.compile(r"[_\s-]+")


def find_pairs(
    names: Iterable[str], kinds: Sequence[tuple[str, str]] = PAIRS
) -> list[tuple[str, str]]:
    """Names of I and of Q among names, of each pair that there is.

    Args:
        names: names of columns or arrays.
        kinds: endings of names that pair.
    """
    by_words = {_plain(name): name for name in names}
    pairs = dict[tuple[str, str], None]()
    for plain in by_words:
        for phase, quadrature in kinds:
            for stem, number in _stems(plain, phase):
                other = f"{stem}{quadrature}{number}"
                if other in by_words:
                    pairs[by_words[plain], by_words[other]] = None
    return [*pairs]


def find_pair(
    names: Iterable[str], kinds: Sequence[tuple[str, str]] = PAIRS
) -> tuple[str, str] | None:
    """Names of I and of Q among names; None unless there is one such pair."""
    pairs = find_pairs(names, kinds)
    return pairs[0] if len(pairs) == 1 else None


def find_receivers(names: Iterable[str]) -> list[tuple[str, str]]:
    """Names of I and Q of each of several receivers, whose names differ in a number alone."""
    pairs = find_pairs(names)
    stems = {re.sub(r"\d+", "", _plain(name)) for name, _ in pairs}
    return pairs if len(pairs) > 1 and len(stems) == 1 else []


def is_quadrature_first(names: Sequence[str]) -> bool:
    """Whether the first of two names is that of Q."""
    return find_pair(names) == (names[1], names[0])


def _stems(name: str, ending: str) -> list[tuple[str, str]]:
    """Stem before an ending that is a word of its own in a name, and the number after it.

    A number may have a word before it, as in `I_ch1` and `I_rx1`.
    """
    number = rf"_?\d*|_?(?:{'|'.join(NUMBERED)})_?\d+"
    match = re.fullmatch(rf"(|.*[_./ ]){re.escape(ending)}({number})", name)
    return [(match[1], match[2])] if match else []


def find_times(names: Iterable[str]) -> str | None:
    """Name of the times among names; None without one."""
    return next((name for name in names if _TIMES.fullmatch(_spoken(name))), None)


def unit_of_times(name: str) -> str | None:
    """Unit in the name of times, such as `time_ms` or `Time [ms]`; None of ticks, or without."""
    return _known_unit(name, {w: unit for w, unit in TIME_WORDS.items() if unit != "ticks"})


def unit_of_angle(name: str) -> str | None:
    """Unit in the name of a phase: deg or rad; None without."""
    return _known_unit(name, ANGLES)


def _known_unit(name: str, units: dict[str, str]) -> str | None:
    """Unit in brackets, or as the last word, of a name."""
    bracket = _UNIT.search(name)
    last = bracket[1].strip().lower() if bracket else _WORDS.split(name.strip().lower())[-1]
    return units.get(last)


def _without_unit(name: str) -> str:
    """A name in lower case, without a unit in brackets at its end."""
    return _UNIT.sub("", name).strip().lower()


def _spoken(name: str) -> str:
    """Words of a name with a blank between."""
    return _WORDS.sub(" ", _without_unit(name)).strip()


def _plain(name: str) -> str:
    """Words of a name that tell something, with _ between; dots and what is before them stay."""
    words = [word for word in _WORDS.split(_without_unit(name)) if word]
    useful = [word for word in words if word not in FILLERS and word not in ANGLES]
    return "_".join(useful or words)
