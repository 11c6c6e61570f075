"""The activities: label, slug, class number and the numbers each one depends on."""

import difflib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from radhar_cli.motion.protocol import Motion

_GAIT = ("motion.gait_hz", "motion.thigh_deg", "motion.calf_deg", "motion.arm_deg")
_WALK = ("motion.speed_mps", *_GAIT)
_SEAT = ("timing.seat_start_s", "timing.seat_duration_s")
_RISE = ("timing.rise_start_s", "timing.rise_duration_s", "timing.walk_start_s")
_STOP = ("timing.walk_stop_s", "timing.overlap_s")

# What each movement of people depends on, besides body, place and fidgets.
_UNEVEN = ("motion.tempo_jitter", "motion.size_jitter")
_STRIKE = ("motion.cycle_phase", "motion.strike_scale", *_UNEVEN)
_SIT = (
    "motion.seat_height",
    "motion.lean_deg",
    "motion.recline_deg",
    "motion.lap",
    "motion.stagger",
)
_FALL = ("motion.fall", "motion.kneel_s", "motion.heels_deg")
_GRAB = (
    "motion.bend_deg",
    "motion.dwell_s",
    "motion.haste",
    "motion.squat",
    "motion.reach_deg",
    "motion.free_arm",
    "motion.stagger",
)
_STRIDE = (
    "motion.speed_mps",
    "motion.period_scale",
    "motion.cycle_phase",
    "motion.arm_swing",
    "motion.trunk_pitch_deg",
    "motion.step_width",
    "motion.step_asymmetry",
    "motion.surge",
    "motion.surge_asymmetry",
    "motion.ragged_speed",
    "motion.stride_jitter",
    "motion.width_jitter_m",
    "motion.lane_m",
    "motion.lane_start",
    "motion.speed_up",
)


class Movement(NamedTuple):
    """A movement of people: states it begins and ends in, its usual duration (s), its numbers."""

    before: str
    after: str
    seconds: float | None  # None: as long as it is asked for
    uses: tuple[str, ...] = ()


# What sequences are made of (`classes:`).
MOVEMENTS = {
    "stationary": Movement("standing", "standing", None),
    "punching": Movement("standing", "standing", None, ("motion.punch_hz", *_STRIKE)),
    "kicking": Movement("standing", "standing", None, ("motion.kick_hz", *_STRIKE)),
    "grabbing": Movement("standing", "standing", 2.5, _GRAB),
    "sitting_down": Movement("standing", "seated", 2.0, (*_SIT, "motion.recline_from")),
    "standing_up": Movement("seated", "standing", 1.8, _SIT),
    "body_rotating": Movement(
        "standing",
        "standing",
        None,
        ("motion.rotation_hz", "motion.turn_deg", "motion.cycle_phase", *_UNEVEN),
    ),
    "walking": Movement("standing", "standing", None, _STRIDE),
    "falling": Movement("standing", "lying", 1.1, _FALL),
    "getting_up": Movement("lying", "standing", 3.0),
    "turning_around": Movement("standing", "standing", 1.8),
}


@dataclass(frozen=True)
class Activity:
    """One class of a data set.

    Attributes:
        number: 1 to 12, the paper's S number; 13 and more for user-defined classes.
        slug: name used in folders and on the command line.
        paper: dotted config keys of the motion and timing numbers this activity depends on,
            besides the position and the heading, which all of them use; of the paper's model.
        human: the same of the human model.
        motion: makes the motion of a `scene.Person`; None for what `motion:` decides about.
    """

    number: int
    slug: str
    paper: tuple[str, ...] = ()
    human: tuple[str, ...] = ()
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
        return "motion.speed_mps" in self.paper

    def uses(self, model: str) -> tuple[str, ...]:
        """The keys that the activity depends on under a model of motion."""
        return self.human if model == "human" else self.paper


def sequence_uses(names: Iterable[str]) -> tuple[str, ...]:
    """The keys that a sequence of movements depends on."""
    return tuple(dict.fromkeys(key for name in names for key in MOVEMENTS[name].uses))


def _activity(number: int, slug: str, paper: tuple[str, ...], *more: str) -> Activity:
    """One of the twelve: `more` are movements of S9 to S12, or keys beside the movement's own."""
    keys = tuple(key for key in more if "." in key)
    human = sequence_uses([name for name in more if "." not in name] or [slug])
    return Activity(number, slug, paper, (*human, *(key for key in keys if key not in human)))


_AROUND = ("motion.step_m", "motion.settle_size")
_SITTING = (*_SIT, *_SEAT, *_AROUND)
ACTIVITIES: tuple[Activity, ...] = (
    _activity(1, "stationary", (), "stationary", "motion.shuffle_hz"),
    _activity(2, "punching", ("motion.gait_hz", "motion.calf_deg", "motion.arm_deg")),
    _activity(3, "kicking", ("motion.gait_hz", "motion.thigh_deg", "motion.calf_deg")),
    _activity(
        4,
        "grabbing",
        ("motion.gait_hz",),
        *("grabbing", "timing.grab_start_s", "timing.grab_duration_s", "motion.shuffle_hz"),
        *_AROUND,
    ),
    Activity(5, "sitting_down", _SEAT, (*_SITTING, "motion.recline_from", "motion.look_deg")),
    Activity(6, "standing_up", _SEAT, _SITTING),
    _activity(7, "body_rotating", ("motion.gait_hz", "motion.turn_deg")),
    _activity(8, "walking", _WALK, "walking", "timing.walk_begin_s"),
    _activity(
        9,
        "sitting_to_walking",
        (*_WALK, *_RISE, "timing.blend_s"),
        *("standing_up", "walking", *_RISE, "timing.overlap_s"),
    ),
    _activity(
        10,
        "walking_to_sitting",
        (*_WALK, "timing.walk_stop_s", "timing.sit_duration_s", "timing.blend_s"),
        *("walking", "sitting_down", *_STOP, "timing.sit_duration_s"),
    ),
    _activity(
        11,
        "falling_to_walking",
        (*_WALK, *_RISE, "timing.blend_s"),
        *("getting_up", "walking", *_RISE, "timing.overlap_s"),
    ),
    _activity(
        12,
        "walking_to_falling",
        (*_WALK, "timing.walk_stop_s", "timing.fall_duration_s", "timing.blend_s"),
        *("walking", "falling", *_STOP, "timing.fall_duration_s"),
    ),
)

DEFAULT = "default"  # in `per_activity`: what holds for activities that it does not name
SURE = 0.75  # similarity from which on a misspelt name is guessed


def _by_name(activities: Iterable[Activity]) -> dict[str, Activity]:
    return {name: a for a in activities for name in (a.slug, a.label.lower())}


_BY_NAME = _by_name(ACTIVITIES)
TWELVE = {name: a.slug for name, a in _BY_NAME.items()}  # slug of each slug and label
_OWN: dict[str, Activity] = {}


def add_activity(
    slug: str, motion: "Callable[..., Motion]", uses: tuple[str, ...] = ()
) -> Activity:
    """Make a class beyond the twelve known, under a slug that configs may name from then on.

    Its label is 12 for the first such class in a config's `activities`, 13 for the next, and so on.

    Args:
        slug: lower-case letters, digits and underscores.
        motion: makes the motion of a `scene.Person` from their numbers. A data set built by
            several processes needs a function that can be pickled.
        uses: keys of `motion:` and `timing:` beside the place; other numbers are not drawn.

    Raises:
        ValueError: the slug is taken or no slug.
    """
    if not is_new_slug(slug):
        raise ValueError(f"{slug!r} should be a new name of lower-case letters, digits and _")
    _OWN[slug] = Activity(len(ACTIVITIES) + 1, slug, uses, uses, motion)
    return _OWN[slug]


def own_activities() -> tuple[Activity, ...]:
    """The classes that `add_activity` made known."""
    return tuple(_OWN.values())


def know_activities(own: Iterable[Activity]) -> None:
    """Register the user-defined classes of another process."""
    for activity in own:
        if activity.motion is not None and activity not in own_activities():
            add_activity(activity.slug, activity.motion, activity.paper)


def is_new_slug(slug: str) -> bool:
    """Whether a user-defined class may have this name: not one of the twelve, fit for a folder."""
    taken = slug in _BY_NAME or slug == DEFAULT
    return not taken and slug.isascii() and slug.isidentifier() and slug == slug.lower()


def activity_named(name: str, classes: Mapping[str, Activity] | None = None) -> Activity:
    """Find an activity by slug or label, whatever the case.

    Args:
        name: of the activity.
        classes: {slug: activity} of a config's own classes.

    Raises:
        ValueError: no such activity; the message suggests the nearest name, or lists them all.
    """
    known = _BY_NAME | _OWN | _by_name((classes or {}).values())
    wanted = name.strip().lower()
    if wanted in known:
        return known[wanted]
    slugs = list(dict.fromkeys(a.slug for a in known.values()))
    longer = [slug for slug in slugs if len(wanted) > 2 and slug.startswith(wanted)]
    near = longer[:1] or difflib.get_close_matches(wanted, known, n=1, cutoff=SURE)
    hint = (
        f"did you mean {near[0].upper() if near[0] not in slugs else near[0]!r}?"
        if near
        else "the slugs are " + ", ".join(slugs)
    )
    raise ValueError(f"{name!r} is not an activity; {hint}")
