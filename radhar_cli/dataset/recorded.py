"""Samples that are windows of recordings, in the order of a data set's rows."""

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

from radhar_cli.config.schema import Config, RecordedPart
from radhar_cli.scene import ByIdentity


class RecordedWindow(NamedTuple):
    """One sample."""

    number: int  # of its part in the manifest
    part: RecordedPart
    start: float  # s, from the start of the recording


def windows(config: Config) -> list[RecordedWindow]:
    """The windows of a data set of recordings: class by class, each in the manifest's order."""
    return _windows(ByIdentity(config))


@lru_cache(maxsize=2)
def _windows(same: ByIdentity) -> list[RecordedWindow]:
    config = same.config
    return [one for a in config.chosen_activities for one in _of_class(config, a.slug)]


def _of_class(config: Config, slug: str) -> Iterator[RecordedWindow]:
    recorded = config.recorded
    assert recorded is not None
    for number, part in enumerate(recorded.parts):
        if part.label == slug:
            for start in recorded.starts(part):
                yield RecordedWindow(number, part, start)


def persons(config: Config) -> list[int]:
    """Number of the person in every row, as `recordings.persons` has them; -1 without a name."""
    recorded = config.recorded
    assert recorded is not None
    named = {name: number for number, name in enumerate(recorded.persons)}
    return [-1 if w.part.person is None else named[w.part.person] for w in windows(config)]
