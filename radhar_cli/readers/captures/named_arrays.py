"""Choice of arrays or columns by names: samples, Q where it is apart, times of the pulses."""

from collections.abc import Callable, Mapping
from math import prod
from pathlib import Path
from typing import NamedTuple

from radhar_cli.errors import CaptureError, did_you_mean
from radhar_cli.readers.captures.named_parts import find_pair, find_times
from radhar_cli.readers.captures.point_tables import refuse_names_of_points
from radhar_cli.readers.captures.settings import NO_TIMES, CaptureSettings

MOST_LISTED = 40  # arrays in a message


class ArrayNames(NamedTuple):
    """Names of arrays of a file.

    Attributes:
        samples: Name of the samples, or of I.
        imaginary: Name of Q; None where samples hold both, or are real.
        times: Name of the times of the pulses; None without.
        are_times_named: Whether the user has named the times.
    """

    samples: str
    imaginary: str | None
    times: str | None
    are_times_named: bool


def choose_arrays(
    path: Path,
    shapes: Mapping[str, tuple[int, ...]],
    settings: CaptureSettings,
    is_complex: Callable[[str], bool] = lambda name: False,
    advice: str = "",
) -> ArrayNames:
    """Choose the arrays that are read: named, or the only ones that it can be.

    Args:
        path: the file, for messages.
        shapes: {name: shape} of its arrays of numbers.
        settings: header of the capture.
        is_complex: tells whether an array holds complex numbers.
        advice: what else the message says if none can be chosen.

    Raises:
        CaptureError: a name is unknown, or several arrays could be meant; lists them.
    """
    if len({shape for shape in shapes.values() if prod(shape) > 1}) == 1:
        refuse_names_of_points(path, (name for name, shape in shapes.items() if prod(shape) > 1))
    named_times = None if settings.times == NO_TIMES else settings.times
    for name in filter(None, (settings.dataset, named_times, settings.imaginary)):
        if name not in shapes:
            listed = ", ".join([*shapes][:MOST_LISTED]) or "none"
            hint = did_you_mean(name, shapes, f"there are {listed}")
            raise CaptureError(f"{path}: {name}: no such array of numbers; {hint}{advice}")
    times = settings.times or find_times(n for n, shape in shapes.items() if prod(shape) > 1)
    times = None if times == NO_TIMES else times
    clock = times, named_times is not None
    if settings.dataset is not None:
        return ArrayNames(settings.dataset, settings.imaginary, *clock)
    others = {name: shape for name, shape in shapes.items() if name != times and prod(shape) > 1}
    pair = find_pair(others)
    if pair is not None and shapes[pair[0]] == shapes[pair[1]]:
        return ArrayNames(*pair, *clock)
    candidates = [name for name, shape in others.items() if prod(shape) > max(shape)]
    candidates = candidates or [*others]
    if len(candidates) > 1:
        candidates = [name for name in candidates if is_complex(name)] or candidates
    if len(candidates) != 1:
        shown_arrays = [*shapes.items()][:MOST_LISTED]
        arrays = ", ".join(f"{name} {[*shape]}" for name, shape in shown_arrays) or "none"
        raise CaptureError(
            f"{path}: --set dataset=NAME should name the samples, or dataset=NAME and "
            f"imaginary=NAME I and Q; there are {arrays}{advice}"
        )
    return ArrayNames(candidates[0], settings.imaginary, *clock)
