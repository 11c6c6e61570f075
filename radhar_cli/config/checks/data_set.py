"""Everything that is checked across the sections of a data set."""

from collections.abc import Iterator

from radhar_cli.config.checks.people import (
    class_problems,
    human_problems,
    people_problems,
    unknown_activities,
)
from radhar_cli.config.checks.radar import (
    profile_problems,
    radar_problems,
    waveform_problems,
)
from radhar_cli.config.checks.room import (
    back_wall_problems,
    room_problems,
    tone_problems,
    wall_problems,
)
from radhar_cli.config.checks.signal import processing_problems
from radhar_cli.config.checks.streams import stream_problems
from radhar_cli.config.first_level import MeasuredRequest, Request
from radhar_cli.config.maps import MAPS_OF_SAMPLES, without_cadences
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.schema.section import Problem


def problems_of_recordings(c: Request) -> Iterator[Problem]:
    """Find the problems of a request for recordings, whatever they are."""
    sections = MeasuredRequest.model_fields
    of_points = c.maps == ("points",)  # which a board has found, whatever `radar` is
    yield from (
        problem
        for problem in radar_problems(c)
        if problem.key.partition(".")[0] in sections and not (of_points and problem.key == "maps")
    )


def problems_of_processing(c: Request) -> Iterator[Problem]:
    """Find the problems of a request to process a recording.

    Windows are shortened, or refused, where its gaps are known.
    """
    lengths = ("duration_s", "processing.window_s", "processing.savgol.frame")
    mistakes = (*profile_problems(c), *processing_problems(c))
    yield from (problem for problem in mistakes if problem.key not in lengths)


def problems(c: Request) -> Iterator[Problem]:
    """Find the problems of a request with its defaults filled in."""
    if not c.chosen_activities:
        yield Problem("classes", {}, "should have files of each class with motion.model: file")
        return
    if mistakes := [*stream_problems(c)]:
        yield from mistakes
        return
    yield from unknown_activities(c)
    yield from _problems_of_several(c)
    yield from radar_problems(c)
    yield from processing_problems(c)
    yield from wall_problems(c)
    yield from back_wall_problems(c)
    yield from room_problems(c)
    yield from tone_problems(c)
    if c.motion.model == "human":
        yield from human_problems(c)
    yield from class_problems(c)
    yield from people_problems(c)
    if c.engine.motion_in_chirp and c.engine.kind == "direct":
        right = "should be false with engine.kind: direct, which freezes a chirp; cube can have it"
        yield Problem("engine.motion_in_chirp", True, right)
    split = c.split
    fewest = min(c.chosen_activities, key=c.samples_of)
    if split.subjects is not None and split.subjects > c.samples_of(fewest):
        of_class = "" if isinstance(c.samples_per_class, int) else f" of {fewest.slug}"
        limit = f"samples_per_class = {c.samples_of(fewest)}{of_class}"
        if c.stream is not None:
            limit = f"stream.count = {c.stream.count}"
        right = f"should be at most {limit}: every person performs every activity"
        yield Problem("split.subjects", split.subjects, right)


def _problems_of_several(c: Request) -> Iterator[Problem]:
    """Find the problems of the other radars of the same scenes."""
    if c.radars is not None:
        right = "should be read from a file, by load_radars, which makes a config of each radar"
        yield Problem("radars", [*c.radars], right)
    if c.radar_name is None and c.other_radars:
        right = "should have radar_name, which tells this one from the others"
        yield Problem("other_radars", [*c.other_radars], right)
    elif c.radar_name in c.other_radars:
        right = "should differ from the names in other_radars"
        yield Problem("radar_name", c.radar_name, right)
    for name in c.other_radars:
        other = c.of_other_radar(name)
        mistakes = [*radar_problems(other), *room_problems(other)]
        if not isinstance(other.radar, ArrayRadar):
            mistakes += waveform_problems(other)
        for key, value, right in mistakes:
            if key.startswith("radar."):
                yield Problem(f"other_radars.{name}.{key.removeprefix('radar.')}", value, right)


def measured_problems(c: MeasuredRequest) -> Iterator[Problem]:
    """Find the problems of a data set of recordings."""
    if not c.recordings.counts:
        right = "should be at most as long as the longest part of a recording"
        yield Problem("recordings.window_s", c.recordings.window_s, right)
    if c.recordings.frame_s is not None:
        yield from _problems_of_points(c)
        return
    if others := [name for name in c.maps if name not in MAPS_OF_SAMPLES]:
        listed = ", ".join(without_cadences(MAPS_OF_SAMPLES))
        right = f"should be some of {listed}; `radhar process` makes the points of a recording"
        yield Problem("maps", others, right)
    yield from _problems_of_any_recording(c)
    yield from profile_problems(c)
    yield from processing_problems(c)


def _problems_of_points(c: MeasuredRequest) -> Iterator[Problem]:
    """Find the problems of a data set of recordings of points."""
    if c.maps != ("points",):
        yield Problem("maps", list(c.maps), "should be [points], as the recordings hold points")
    if c.output.power is not None:
        yield Problem("output.power", c.output.power, "should be null: points have no power map")
    yield from _problems_of_any_recording(c)


def _problems_of_any_recording(c: MeasuredRequest) -> Iterator[Problem]:
    """Find the problems that do not depend on the content of the recordings."""
    for key in ("column_labels", "slow_time", "products"):
        if value := getattr(c.output, key):
            yield Problem(f"output.{key}", value, "should be left out: recordings have none")
    if len({part.split is None for part in c.recordings.parts}) > 1:
        right = "should stand in every row of the manifest, or in none"
        yield Problem("recordings.parts.split", None, right)
    named = {part.person for part in c.recordings.parts}
    if c.split.subjects is not None and (None in named or c.split.subjects != len(named)):
        right = f"should be the number of persons, {len(named - {None})}; every part names one"
        yield Problem("split.subjects", c.split.subjects, right)
