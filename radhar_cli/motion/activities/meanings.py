"""Meanings of classes, each in a line for people who see it for the first time."""

from radhar_cli.motion.activities.activity import Activity
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.standing import NOBODY

MEANINGS = {name: kind.meaning for name, kind in MOVEMENTS.items()} | {
    "sitting_to_walking": "stands up from a chair and walks off",
    "walking_to_sitting": "walks and sits down on a chair",
    "falling_to_walking": "gets up from the floor and walks off",
    "walking_to_falling": "walks and falls",
}


def meaning_of_class(activity: Activity) -> str:
    """Meaning of a class: of its name, else of its movements one after the other.

    A class of motion files, or one that somebody else has added, has none: "".
    """
    if activity.slug in MEANINGS and (activity.slug == NOBODY or not _is_other_class(activity)):
        return MEANINGS[activity.slug]
    return ", then ".join(MEANINGS[name] for name in activity.movements)


def _is_other_class(activity: Activity) -> bool:
    """Whether a class is called as a movement but consists of others."""
    return activity.slug in MOVEMENTS and activity.movements != (activity.slug,)
