"""What a class shows, in a line for people who see it for the first time."""

from radhar_cli.activities.activity import MOVEMENTS, NOBODY, Activity
from radhar_cli.motion.movements import catalogue

MEANINGS = {
    **{name: kind.meaning for name, kind in catalogue.MOVEMENTS.items()},
    "stationary": "stands still, with the sway and the breath of people",
    "grabbing": "bends down, picks something up and stands again",
    "sitting_down": "sits down on a chair",
    "standing_up": "stands up from a chair",
    "body_rotating": "stands and turns the trunk to and fro",
    "walking": "walks",
    "sitting_to_walking": "stands up from a chair and walks off",
    "walking_to_sitting": "walks and sits down on a chair",
    "falling_to_walking": "gets up from the floor and walks off",
    "walking_to_falling": "walks and falls",
    "falling": "falls from standing",
    "falling_on_hands": "falls from standing, on the hands",
    "falling_off_seat": "falls off a chair",
    "falling_on_rising": "falls on standing up from a chair",
    "stumbling": "stumbles and does not fall",
    "tripping": "trips on the way",
    "trying_to_get_up": "lies and tries in vain to get up",
    "getting_up": "gets up from the floor",
    "turning_around": "turns to face the other way",
    "running": "runs, with a flight in each step",
    "jogging_in_place": "jogs on the spot",
    "sitting": "sits still",
    "kneeling": "kneels still",
    "kneeling_down": "kneels down",
    "getting_on_fours": "gets on hands and knees",
    "lying": "lies still",
    "turning_over": "lies and turns over",
    "lying_down": "goes to bed: sits down on it and lies down",
    "getting_up_from_bed": "gets up from a bed",
    "squatting": "squats, again and again",
    "jumping": "jumps, again and again",
    "jumping_jacks": "jumps with arms and legs apart, and together again",
    "raising_arms": "raises both arms to the sides, again and again",
    "raising_arms_ahead": "raises both arms ahead, again and again",
    "crawling": "crawls on hands and knees",
    "carrying": "walks and carries something",
    "limping": "walks with a limp",
    "walking_with_stick": "walks with a stick",
    "walking_with_walker": "walks with a walker",
    "drinking": "stands and drinks",
    "drinking_seated": "sits and drinks",
    "writing": "stands and writes on a board",
    "writing_seated": "sits and writes at a table",
    "waving": "stands and waves",
    "clapping": "stands and claps",
    "nobody": "nobody is there: noise, and what stands in the room",
}
# How sentences of movements with a side begin.
SIDED = {
    "{}_side_lunge": "lunges to the {}, again and again",
    "{}_lunge": "lunges forward with the {} leg, again and again",
    "raising_{}_arm_and_leg": "raises the {} arm and leg, again and again",
    "raising_{}_arm": "raises the {} arm, again and again",
    "raising_{}_leg": "raises the {} leg, again and again",
}


def meaning_of_class(activity: Activity) -> str:
    """Meaning of a class: of its name, else of its movements one after the other.

    A class of motion files, or one that somebody else has added, has none: "".
    """
    if activity.slug in MEANINGS and (activity.slug == NOBODY or not _is_other_class(activity)):
        return MEANINGS[activity.slug]
    return ", then ".join(_meaning_of_movement(name) for name in activity.movements)


def _is_other_class(activity: Activity) -> bool:
    """Whether a class is called as a movement but consists of others."""
    return activity.slug in MOVEMENTS and activity.movements != (activity.slug,)


def _meaning_of_movement(name: str) -> str:
    """Meaning of a movement, or its name in words where there is none."""
    for pattern, meaning in SIDED.items():
        for side in ("right", "left"):
            if name == pattern.format(side):
                return meaning.format(side)
    return MEANINGS.get(name, name.replace("_", " "))
