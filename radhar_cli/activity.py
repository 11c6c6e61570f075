"""The activities: label, slug, class number and the numbers each one depends on."""

import difflib
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from radhar_cli.motion.protocol import Motion

_GAIT = ("motion.gait_hz", "motion.thigh_deg", "motion.calf_deg", "motion.arm_deg")
_WALK = ("motion.speed_mps", *_GAIT)
_SEAT = ("timing.seat_start_s", "timing.seat_duration_s")
_RISE = ("timing.rise_start_s", "timing.rise_duration_s", "timing.walk_start_s", "timing.blend_s")


@dataclass(frozen=True)
class Activity:
    """One class of a data set.

    Attributes:
        number: 1 to 12, the paper's S number; 13 and more for classes of one's own.
        slug: name used in folders and on the command line.
        uses: dotted config keys of the motion and timing numbers this activity depends on,
            besides the position and the heading, which all of them use.
        motion: makes the motion of a Scene; None for the twelve, which `motion:` decides about.
    """

    number: int
    slug: str
    uses: tuple[str, ...]
    motion: "Callable[..., Motion] | None" = None

    @property
    def label(self) -> str:
        """The paper's name, ``S1`` to ``S12``, and so on."""
        return f"S{self.number}"

    @property
    def index(self) -> int:
        """Class number in a data set: 0 to 11 for the twelve."""
        return self.number - 1

    @property
    def walks(self) -> bool:
        """Whether the torso moves along the motion angle."""
        return "motion.speed_mps" in self.uses


ACTIVITIES: tuple[Activity, ...] = (
    Activity(1, "stationary", ()),
    Activity(2, "punching", ("motion.gait_hz", "motion.calf_deg", "motion.arm_deg")),
    Activity(3, "kicking", ("motion.gait_hz", "motion.thigh_deg", "motion.calf_deg")),
    Activity(4, "grabbing", ("motion.gait_hz",)),
    Activity(5, "sitting_down", _SEAT),
    Activity(6, "standing_up", _SEAT),
    Activity(7, "body_rotating", ("motion.gait_hz", "motion.turn_deg")),
    Activity(8, "walking", _WALK),
    Activity(9, "sitting_to_walking", (*_WALK, *_RISE)),
    Activity(
        10,
        "walking_to_sitting",
        (*_WALK, "timing.walk_stop_s", "timing.sit_duration_s", "timing.blend_s"),
    ),
    Activity(11, "falling_to_walking", (*_WALK, *_RISE)),
    Activity(
        12,
        "walking_to_falling",
        (*_WALK, "timing.walk_stop_s", "timing.fall_duration_s", "timing.blend_s"),
    ),
)

_BY_NAME = {name: a for a in ACTIVITIES for name in (a.slug, a.label.lower())}
_OWN: dict[str, Activity] = {}


def add_activity(
    slug: str, motion: "Callable[..., Motion]", uses: tuple[str, ...] = ()
) -> Activity:
    """Make a class beyond the twelve known, under a slug that configs may name from then on.

    Its label is 12 for the first such class in a config's `activities`, 13 for the next, and so on.

    Args:
        slug: lower-case letters, digits and underscores.
        motion: makes the motion of a Scene from the numbers of `Scene.config`. A data set built by
            several processes needs a function that can be pickled.
        uses: as of `Activity`; other numbers of `motion:` and `timing:` are not drawn.

    Raises:
        ValueError: the slug is taken or no slug.
    """
    if slug in _BY_NAME or not slug.isidentifier() or slug != slug.lower():
        raise ValueError(f"{slug!r} should be a new name of lower-case letters, digits and _")
    _OWN[slug] = Activity(len(ACTIVITIES) + 1, slug, uses, motion)
    return _OWN[slug]


def own_activities() -> tuple[Activity, ...]:
    """The classes that `add_activity` made known."""
    return tuple(_OWN.values())


def activity_named(name: str) -> Activity:
    """Find an activity by slug or label, whatever the case.

    Raises:
        ValueError: no such activity; the message suggests the nearest name.
    """
    known = _BY_NAME | _OWN
    found = known.get(name.strip().lower())
    if found is not None:
        return found
    near = difflib.get_close_matches(name.lower(), list(known), n=1)
    hint = (
        f"did you mean {near[0].upper() if near[0][1:].isdigit() else near[0]!r}?"
        if near
        else "the slugs are " + ", ".join(a.slug for a in (*ACTIVITIES, *_OWN.values()))
    )
    raise ValueError(f"{name!r} is no activity; {hint}")
