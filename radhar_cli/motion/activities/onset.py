"""Onset of a movement, drawn so that enough of it lies within the recording.

A recording is a window that is cut out of what a person does. Where it is cut is left to chance, as
long as what the class is named by can be seen: a movement of D seconds that begins at t is seen for
overlap([t, t + D], [0, T]) of the T seconds of the recording, and t is one of those at which that
is at least a share of D, or of T if it lasts longer.
"""

from collections.abc import Iterable, Sequence
from math import inf
from typing import NamedTuple

# Of a walk before or after another movement, so much is seen: two or three steps, or a quarter of
# a short recording.
WALKED_S, WALKED_SHARE = 1.5, 0.25


class Span(NamedTuple):
    """A stretch of what a person does, of which a part has to be seen.

    Attributes:
        begin: its beginning, s after the onset; -inf where it has none.
        end: its end, s after the onset; inf where it has none.
        needed: seconds of it that lie within the recording, at least.
    """

    begin: float
    end: float
    needed: float


class Onsets(NamedTuple):
    """Earliest and latest onset, s; the recording begins at 0."""

    earliest: float
    latest: float

    def at_share(self, share: float) -> float:
        """Onset at a share, 0 to 1, of the way from the earliest to the latest."""
        return self.earliest + share * (self.latest - self.earliest)


class Stretch(NamedTuple):
    """A movement of a sequence.

    Attributes:
        begin: its beginning, s after the onset of the sequence.
        end: its end; inf for what goes on.
        lasts: whether it is as long as it is asked for, as walks are, instead of having a beginning
            and an end that make it what it is.
        counts: whether it has to be seen; standing need not.
    """

    begin: float
    end: float
    lasts: bool = False
    counts: bool = True


def seconds_seen(duration: float, seconds: float, visible: float) -> float:
    """Seconds of a movement that are seen at least.

    Args:
        duration: its duration, s.
        seconds: duration of the recording, s.
        visible: share of the movement, or of the recording if that is shorter.
    """
    return visible * min(duration, seconds)


def seconds_walked(seconds: float, duration: float = inf) -> float:
    """Seconds that are seen of a walk of `duration` s before or after another movement."""
    return min(WALKED_S, WALKED_SHARE * seconds, duration)


def limits_of(spans: Iterable[Span], seconds: float) -> Onsets:
    """Onsets at which as much as is asked for is seen of every stretch.

    Where no onset leaves enough of all, it is the one that misses the earliest and the latest by
    the same time.

    Args:
        spans: the stretches.
        seconds: duration of the recording, s.
    """
    spans = tuple(spans)
    earliest = max(span.needed - span.end for span in spans)
    latest = min(seconds - span.needed - span.begin for span in spans)
    if earliest > latest:
        earliest = latest = (earliest + latest) / 2
    return Onsets(earliest, latest)


def limits_of_movement(duration: float, seconds: float, visible: float) -> Onsets:
    """Onsets of a single movement of `duration` s; of a bout of what lasts, that is `seconds`."""
    needed = seconds_seen(duration, seconds, visible)
    return limits_of([Span(0.0, duration, needed)], seconds)


def limits_of_rise(duration: float, seconds: float, visible: float) -> Onsets:
    """Instants at which a movement of `duration` s may end that a walk follows."""
    needed = seconds_seen(duration, seconds, visible)
    return limits_of([Span(-duration, 0, needed), Span(0, inf, seconds_walked(seconds))], seconds)


def limits_of_stop(duration: float, seconds: float, visible: float) -> Onsets:
    """Instants at which a movement of `duration` s may begin that comes after a walk."""
    needed = seconds_seen(duration, seconds, visible)
    return limits_of([Span(-inf, 0, seconds_walked(seconds)), Span(0, duration, needed)], seconds)


def limits_of_sequence(parts: Sequence[Stretch], seconds: float, visible: float) -> Onsets:
    """Onsets of a sequence of movements.

    Each movement is seen by its share, and walks and the like for some steps. A sequence too long
    for that is cut anywhere: then the share is one of the whole.

    Args:
        parts: movements in their order.
        seconds: duration of the recording, s.
        visible: share that is seen.
    """
    first, last = parts[0], parts[-1]
    if len(parts) == 1 and last.end == inf:  # a bout
        return limits_of_movement(seconds, seconds, visible)
    total = last.end - first.begin
    of_total = [Span(first.begin, last.end, seconds_seen(total, seconds, visible))]
    of_parts = [
        Span(part.begin, part.end, _seconds_of_part(part, len(parts), seconds, visible))
        for part in parts
        if part.counts
    ]
    if last.end == inf:
        return limits_of(of_parts, seconds) if of_parts else limits_of(of_total, seconds)
    limits = limits_of(of_total + of_parts, seconds)
    is_too_long = limits.earliest == limits.latest
    return limits_of(of_total, seconds) if is_too_long else limits


def _seconds_of_part(part: Stretch, count: int, seconds: float, visible: float) -> float:
    """Seconds of one of `count` movements that have to be within the recording."""
    duration = part.end - part.begin
    if part.lasts and count > 1:
        return seconds_walked(seconds, duration)
    return seconds_seen(duration, seconds, visible)
