"""Onsets are those, and only those, that leave enough of a movement within the recording."""

from math import inf, isclose

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.motion.activities.onset import (
    WALKED_S,
    Onsets,
    Span,
    Stretch,
    limits_of,
    limits_of_movement,
    limits_of_rise,
    limits_of_sequence,
    limits_of_stop,
    seconds_seen,
)

RECORDINGS = st.floats(0.5, 60.0)
DURATIONS = st.floats(0.3, 90.0)
SHARES = st.floats(0.0, 1.0)
TINY = 1e-9


def overlap(begin: float, end: float, seconds: float) -> float:
    """Seconds of a stretch that lie within a recording."""
    return max(0.0, min(end, seconds) - max(begin, 0.0))


@given(DURATIONS, RECORDINGS, SHARES, SHARES)
def test_every_onset_leaves_enough_of_the_movement(
    duration: float, seconds: float, visible: float, share: float
) -> None:
    onset = limits_of_movement(duration, seconds, visible).at_share(share)
    seen = overlap(onset, onset + duration, seconds)
    assert seen >= visible * min(duration, seconds) - TINY


@given(DURATIONS, RECORDINGS, st.floats(0.05, 1.0))
def test_no_other_onset_does(duration: float, seconds: float, visible: float) -> None:
    earliest, latest = limits_of_movement(duration, seconds, visible)
    for onset in (earliest - 1e-3, latest + 1e-3):
        seen = overlap(onset, onset + duration, seconds)
        assert seen < visible * min(duration, seconds)


def test_a_bout_lies_about_the_recording_and_a_movement_anywhere_in_it() -> None:
    assert limits_of_movement(6.0, 6.0, 0.75) == Onsets(-1.5, 1.5)
    assert limits_of_movement(2.0, 6.0, 0.75) == Onsets(-0.5, 4.5)
    assert limits_of_movement(6.0, 6.0, 1.0).at_share(0.3) == 0.0


@given(st.floats(0.3, 3.0), RECORDINGS, SHARES, SHARES)
def test_of_two_parts_both_are_seen(
    duration: float, seconds: float, visible: float, share: float
) -> None:
    walked = min(WALKED_S, seconds / 4)
    needed = seconds_seen(duration, seconds, visible)
    rise, stop = (law(duration, seconds, visible) for law in (limits_of_rise, limits_of_stop))
    if needed + walked <= seconds:
        risen = rise.at_share(share)
        assert overlap(risen - duration, risen, seconds) >= needed - TINY
        assert seconds - risen >= walked - TINY
        falls = stop.at_share(share)
        assert overlap(falls, falls + duration, seconds) >= needed - TINY
        assert falls >= walked - TINY
    else:  # both miss by the same
        (risen, _), (falls, _) = rise, stop
        assert rise.earliest == rise.latest
        assert isclose(needed - risen, walked - (seconds - risen), abs_tol=1e-9)
        assert isclose(needed - (seconds - falls), walked - falls, abs_tol=1e-9)


PARTS = st.lists(st.tuples(st.floats(0.3, 12.0), st.booleans()), min_size=1, max_size=5)


@given(PARTS, RECORDINGS, st.floats(0.1, 1.0), SHARES)
def test_of_a_sequence_every_part_is_seen_or_a_share_of_the_whole(
    durations: list[tuple[float, bool]], seconds: float, visible: float, share: float
) -> None:
    ends = np.cumsum([duration for duration, _ in durations])
    parts = [
        Stretch(float(end - duration), float(end), lasts)
        for end, (duration, lasts) in zip(ends, durations, strict=True)
    ]
    onset = limits_of_sequence(parts, seconds, visible).at_share(share)
    whole = overlap(onset, onset + float(ends[-1]), seconds)
    assert whole >= visible * min(float(ends[-1]), seconds) - 1e-6
    short = [(a, b) for a, b, lasts, _ in parts if not lasts]
    fits = sum(duration for duration, _ in durations) <= seconds
    if fits:
        for begin, end in short:
            seen = overlap(onset + begin, onset + end, seconds)
            assert seen >= visible * (end - begin) - 1e-6


def test_a_sequence_that_goes_on_is_seen_from_its_first_movements_on() -> None:
    rising = Stretch(0.0, 2.0), Stretch(2.0, inf, lasts=True)
    assert limits_of_sequence(rising, 6.0, 0.75) == Onsets(-0.5, 2.5)
    bout = (Stretch(0.0, inf, lasts=True),)
    assert limits_of_sequence(bout, 6.0, 0.75) == Onsets(-1.5, 1.5)
    waiting = (Stretch(0.0, inf, lasts=True, counts=False),)
    assert limits_of_sequence(waiting, 6.0, 0.75) == Onsets(-1.5, 1.5)


@pytest.mark.parametrize("seen", [1.0, 3.0])
def test_what_cannot_all_be_seen_is_missed_alike(seen: float) -> None:
    spans = Span(-9.0, 0.0, seen), Span(0.0, 9.0, seen)
    earliest, latest = limits_of(spans, 4.0)
    assert (earliest, latest) == ((1.0, 3.0) if seen == 1.0 else (2.0, 2.0))
