"""Checks of keys that do not go together in a config of streams."""

from collections.abc import Iterator
from typing import cast

from radhar_cli.config.first_level import Request
from radhar_cli.config.image import MAX_SIDE_PX
from radhar_cli.config.sequence import SequenceConfig
from radhar_cli.config.stream import MIN_ZONE_M, StreamConfig, linked
from radhar_cli.errors import did_you_mean
from radhar_cli.motion.activities.activity import STREAM
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.schema.number import Number, support
from radhar_cli.schema.section import Problem


def stream_problems(c: Request) -> Iterator[Problem]:
    """Find the problems of `stream` and its neighbours; nothing without it."""
    if c.stream is None:
        return
    if c.motion.model != "human":
        right = "should be human with stream: people who go from one activity to the next"
        yield Problem("motion.model", c.motion.model, right)
    section = c.classes.get(STREAM)
    if section is not None and not (isinstance(section, SequenceConfig) and section.labels):
        yield Problem(f"classes.{STREAM}", "...", "should have another name beside stream")
    yield from _problems_of_size(c, c.stream)
    yield from _problems_of_activities(c, c.stream)
    for strip in c.stream.zone.strips(1 + len(c.people)):
        sides = (strip.range_m, strip.cross_range_m)
        if min(high - low for low, high in sides) < MIN_ZONE_M - 1e-9:
            right = f"should have room for {1 + len(c.people)} strips of at least {MIN_ZONE_M} m"
            yield Problem("stream.zone", c.stream.zone.model_dump(), right)
            break


def _problems_of_size(c: Request, stream: StreamConfig) -> Iterator[Problem]:
    """Find images whose width is none, and durations that differ from stream to stream."""
    low, high = support(cast(Number, c.duration_s))
    if low != high:
        yield Problem("duration_s", c.duration_s, "should be one number with stream")
        return
    width, columns = c.image.size_px[1], stream.columns_of(low)
    if not 2 <= columns <= MAX_SIDE_PX:
        right = f"should make 2 to {MAX_SIDE_PX} columns of duration_s = {low:g}, not {columns}"
        yield Problem("stream.column_s", stream.column_s, right)
    elif width != columns:
        right = f"should be the height alone: duration_s / stream.column_s makes {columns} columns"
        yield Problem("image.size_px", list(c.image.size_px), right)


def _problems_of_activities(c: Request, stream: StreamConfig) -> Iterator[Problem]:
    """Find activities that a stream cannot have, and weights of none."""
    activities = c.stream_activities
    for activity in activities:
        if activity.is_nobody:
            yield Problem("activities", activity.slug, "should be left out of streams of people")
            return
        if activity.motion is not None or c.files_of(activity) is not None:
            right = "should be made of movements with stream, not of files or functions"
            yield Problem("activities", activity.slug, right)
            return
    slugs = [activity.slug for activity in activities]
    for name in stream.weights:
        if name not in slugs:
            hint = did_you_mean(name, slugs, f"activities are {', '.join(slugs)}")
            yield Problem(f"stream.weights.{name}", stream.weights[name], f"is no activity; {hint}")
    if not any(stream.weights.get(slug, 1.0) for slug in slugs):
        yield Problem("stream.weights", stream.weights, "should leave an activity above 0")
    ends = {slug: _ends(c, slug) for slug in slugs}
    for activity in activities:
        others = {state for slug, states in ends.items() for state in states}
        if all(linked(state, activity, c.classes) is None for state in others):
            right = (
                "begins in a state to which neither another activity nor a link leads; should be "
                "left out, or come with one that ends there"
            )
            yield Problem("activities", activity.slug, right)


def _ends(c: Request, slug: str) -> set[str]:
    """States of rest in which an activity may end."""
    section = c.classes.get(slug)
    if isinstance(section, SequenceConfig):
        return {end for name in section.written for end in MOVEMENTS[name].states.values()}
    activity = next(a for a in c.stream_activities if a.slug == slug)
    return {*MOVEMENTS[activity.movements[-1]].states.values()}
