"""Samples that are windows of recordings, in the order of a data set's rows."""

from functools import lru_cache
from typing import NamedTuple

from radhar_cli.config.data_set import MeasuredConfig
from radhar_cli.config.recordings import RecordedPart
from radhar_cli.scene.scene import ByIdentity


class RecordedWindow(NamedTuple):
    """Window of a recording that makes one sample."""

    number: int  # of its part in the manifest
    part: RecordedPart
    start: float  # s, from the start of the recording


def windows(config: MeasuredConfig) -> list[RecordedWindow]:
    """List the windows of a data set of recordings by class, each in the manifest's order."""
    return _windows(ByIdentity(config))


@lru_cache(maxsize=2)
def _windows(same: ByIdentity) -> list[RecordedWindow]:
    recorded = same.config.recordings
    return [
        RecordedWindow(number, part, start)
        for activity in same.config.chosen_activities
        for number, part in enumerate(recorded.parts)
        if part.label == activity.slug
        for start in recorded.starts(part)
    ]
