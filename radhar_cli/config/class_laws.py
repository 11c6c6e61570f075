"""Numbers that are drawn otherwise for one class than for another, though they are no movement.

A number belongs to the movement if its key says which movements use it (`People`, `Paper`): speeds,
rates, sizes, durations. Everything else belongs to the scene: the place, the heading, the body, the
SNR, walls and rooms, other people. When a movement begins or ends is no part of it either, though
its keys name movements: those are the keys of `timing` that name an instant. A law of these that
differs by class tells the class, whatever is drawn.
"""

import re
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from radhar_cli.config.data_set import Config
from radhar_cli.schema.annotations import Paper, People, annotations, value_text
from radhar_cli.schema.section import PerActivity, for_activity

# Names of keys of `timing` that say when, not how long; and when the movement began of each sample.
INSTANT = re.compile(r"timing\.(\w+_(start|begin|stop)_s|onset)$|movement_onset_s$")


def is_instant(key: str) -> bool:
    """Whether a dotted key says when something begins or ends."""
    return INSTANT.match(key) is not None


def is_of_movement(key: str) -> bool:
    """Whether the number of a dotted key is a part of the class's movement.

    Numbers of other people in the scene (`people.0.motion...`) are none.
    """
    if key.startswith("people.") or is_instant(key):
        return False
    if key.startswith("classes."):  # durations of parts, or which file is followed
        return True
    about = annotations(Config).get(key, ())
    return any(isinstance(mark, People | Paper) and mark.names != "" for mark in about)


def laws_by_class(config: Config) -> list[str]:
    """Warn of numbers beside the movement that some classes draw by a law of their own."""
    lines = []
    for key, number in _numbers_by_activity(config, ""):
        if is_of_movement(key):
            continue
        classes = dict[str, list[str]]()
        for activity in config.chosen_activities:
            if config.depends_on(activity, key):
                law = value_text(for_activity(number, activity))
                classes.setdefault(law, []).append(activity.slug)
        if len(classes) > 1:
            laws = "; ".join(f"{', '.join(names)} {law}" for law, names in classes.items())
            lines.append(f"{key} is drawn by another law for some classes, and tells them: {laws}")
    return lines


def _numbers_by_activity(section: BaseModel, prefix: str) -> Iterator[tuple[str, PerActivity[Any]]]:
    """Yield the dotted keys of a section, and of those within it, whose numbers go by activity."""
    for name in type(section).model_fields:
        value, key = getattr(section, name), f"{prefix}{name}"
        if isinstance(value, PerActivity):
            yield key, value
        elif isinstance(value, BaseModel):
            yield from _numbers_by_activity(value, f"{key}.")
