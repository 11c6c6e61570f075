"""Words that people use for movements, and our names of the same meaning."""

from collections.abc import Iterable

from radhar_cli.errors import did_you_mean
from radhar_cli.motion.movements.catalogue import MOVEMENTS

# Share of letters from which a name is taken for a mistyped one: one letter of four is wrong, or
# of longer names one in six.
SHORT, SIMILAR_SHORT, SIMILAR = 5, 0.75, 0.8

FILLERS = frozenset(
    {"a", "an", "the", "my", "his", "her", "their", "one", "person", "people", "human", "someone"}
)
_SEATS = "chair", "sofa", "couch", "stool", "bench", "seat", "armchair"
_ONTO = tuple(f"{where}_{seat}" for where in ("on", "in", "onto", "into", "to") for seat in _SEATS)
_OFF = tuple(f"{where}_{seat}" for where in ("from", "off", "out_of") for seat in _SEATS)
_GROUND = tuple(
    f"{where}_{ground}"
    for where in ("on", "onto", "to", "from", "off")
    for ground in ("floor", "ground", "carpet", "mat")
)

# {word: our names of the same meaning, of which the first that is known counts}; a config may say
# the word instead. A movement of the word's own name comes before these.
MEANINGS: dict[str, tuple[str, ...]] = {
    **{word: (kind.name,) for kind in MOVEMENTS.values() for word in kind.words},
    **dict.fromkeys(("picking_up", "pick_up", "picking", "picking_object"), ("grabbing",)),
    **dict.fromkeys(("picking_up_objects", "picking_up_object", "pick_up_object"), ("grabbing",)),
    **dict.fromkeys(("pick_up_an_object", "picking_up_things", "pick_up_things"), ("grabbing",)),
    **dict.fromkeys(("grasping", "grab"), ("grabbing",)),
    **dict.fromkeys(("standing", "still", "standing_still", "stand"), ("stationary",)),
    **dict.fromkeys(("idle", "static", "no_movement"), ("stationary",)),
    **dict.fromkeys(("sit", "sit_down"), ("sitting_down",)),
    **dict.fromkeys(("seated", "sitting_still"), ("sitting",)),
    **dict.fromkeys(("kneel", "on_knees"), ("kneeling",)),
    **dict.fromkeys(("kneel_down", "go_on_knees"), ("kneeling_down",)),
    **dict.fromkeys(("get_on_all_fours", "getting_on_all_fours"), ("getting_on_fours",)),
    **dict.fromkeys(("go_on_all_fours", "going_on_all_fours"), ("getting_on_fours",)),
    **dict.fromkeys(
        tuple(
            f"{verb}_{off}"
            for verb in ("get_up", "getting_up", "rise", "rising", "stand", "standing")
            for off in _OFF
        ),
        ("standing_up",),
    ),
    **dict.fromkeys(
        tuple(
            f"{verb}_{off}"
            for verb in ("fall", "falling", "fall_down", "falling_down")
            for off in _OFF
        ),
        ("falling_off_seat",),
    ),
    **dict.fromkeys(("crawl", "creeping"), ("crawling",)),
    **dict.fromkeys(("sleeping", "sleep", "lying_still", "laying", "resting"), ("lying",)),
    **dict.fromkeys(("lie_down", "going_to_bed", "go_to_bed", "laying_down"), ("lying_down",)),
    **dict.fromkeys(
        ("get_out_of_bed", "leaving_bed", "getting_out_of_bed"), ("getting_up_from_bed",)
    ),
    **dict.fromkeys(("turn_over", "rolling_over", "rolling", "roll_over"), ("turning_over",)),
    **dict.fromkeys(("stand_up", "rising"), ("standing_up",)),
    **dict.fromkeys(("stand_up_from_floor", "get_up", "rising_from_floor"), ("getting_up",)),
    **dict.fromkeys(("rotating", "twisting", "body_rotation"), ("body_rotating",)),
    **dict.fromkeys(("turn_around",), ("turning_around",)),
    **dict.fromkeys(("walk", "strolling", "pacing", "normal_walking"), ("walking",)),
    **dict.fromkeys(("fall", "fall_down", "falling_down", "collapsing"), ("falling",)),
    **dict.fromkeys(("squat", "squats"), ("squatting",)),
    **dict.fromkeys(("jump", "jumps", "jump_up", "jumping_up"), ("jumping",)),
    **dict.fromkeys(("jumping_jack", "star_jumps"), ("jumping_jacks",)),
    **dict.fromkeys(("run", "jogging", "jog", "sprinting", "sprint"), ("running",)),
    **dict.fromkeys(
        tuple(
            f"{verb}_{where}"
            for verb in ("run", "running", "jog", "jogging")
            for where in ("in_place", "on_the_spot", "on_spot")
            if (verb, where) != ("jogging", "in_place")
        ),
        ("jogging_in_place",),
    ),
    **dict.fromkeys(("raise_right_arm", "raising_right_hand"), ("raising_right_arm",)),
    **dict.fromkeys(("raise_left_arm", "raising_left_hand"), ("raising_left_arm",)),
    **dict.fromkeys(("stumble",), ("stumbling",)),
    **dict.fromkeys(("drinking_standing",), ("drinking",)),
    **dict.fromkeys(("drink", "drinking_water", "drink_water", "drinking_from_cup"), ("drinking",)),
    **dict.fromkeys(("write", "writing_on_board"), ("writing",)),
    **dict.fromkeys(("writing_at_table",), ("writing_seated",)),
    **dict.fromkeys(("wave", "hand_waving", "waving_hand"), ("waving",)),
    **dict.fromkeys(("clap", "clapping_hands", "hand_clapping", "applauding"), ("clapping",)),
    **dict.fromkeys(("empty", "empty_room", "no_one", "no_person", "absent"), ("nobody",)),
    **dict.fromkeys(("left_front_lunge",), ("left_lunge",)),
    **dict.fromkeys(("right_front_lunge",), ("right_lunge",)),
    **dict.fromkeys(("trip",), ("tripping",)),
    **dict.fromkeys(("limp", "antalgic_gait", "hobbling", "limping_leg"), ("limping",)),
    **dict.fromkeys(("walking_with_cane", "walking_with_crutch"), ("walking_with_stick",)),
    **dict.fromkeys(("carry", "carrying_box", "carrying_bag", "carry_box"), ("carrying",)),
    **dict.fromkeys(("getting_up_from_floor", "get_up_from_floor"), ("getting_up",)),
    **dict.fromkeys(("get_up_from_bed", "rise_from_bed"), ("getting_up_from_bed",)),
    **dict.fromkeys(("stand_up_from_chair", "sit_to_stand", "aufstehen"), ("standing_up",)),
    **dict.fromkeys(("stand_to_sit", "hinsetzen"), ("sitting_down",)),
    **dict.fromkeys(("lay_down", "hinlegen"), ("lying_down",)),
    **dict.fromkeys(("lie", "liegen"), ("lying",)),
    **dict.fromkeys(("no_activity", "breathing", "stehen"), ("stationary",)),
    **dict.fromkeys(("background", "leer"), ("nobody",)),
    **dict.fromkeys(("hand_wave", "wave_hello", "wave_hand", "winken"), ("waving",)),
    **dict.fromkeys(("clap_hands", "klatschen"), ("clapping",)),
    **dict.fromkeys(("squat_down",), ("squatting",)),
    **dict.fromkeys(("arms_up", "raising_both_arms"), ("raising_arms",)),
    **dict.fromkeys(("lunge_left",), ("left_lunge",)),
    **dict.fromkeys(("lunge_right",), ("right_lunge",)),
    **dict.fromkeys(("turn_over_in_bed", "rolling_in_bed"), ("turning_over",)),
    **dict.fromkeys(("gehen",), ("walking",)),
    **dict.fromkeys(("rennen",), ("running",)),
    **dict.fromkeys(("sitzen",), ("sitting",)),
    **dict.fromkeys(("sturz", "collapse", "fainting"), ("falling",)),
    **dict.fromkeys(("springen",), ("jumping",)),
    **dict.fromkeys(("trinken",), ("drinking",)),
    **dict.fromkeys(("schreiben",), ("writing",)),
    **dict.fromkeys(("kriechen",), ("crawling",)),
    **dict.fromkeys(("knien",), ("kneeling",)),
    **dict.fromkeys(("humpeln", "hinken"), ("limping",)),
    **dict.fromkeys(("stolpern",), ("stumbling",)),
    **dict.fromkeys(("pickup", "pickup_object", "pick_up_things_from_floor"), ("grabbing",)),
    **dict.fromkeys(("sitdown",), ("sitting_down",)),
    **dict.fromkeys(("standup",), ("standing_up",)),
    **dict.fromkeys(("liedown", "stand_to_lie"), ("lying_down",)),
    **dict.fromkeys(("star_jump", "jumping_jacks_exercise"), ("jumping_jacks",)),
    **dict.fromkeys(("raise_left_hand", "raising_hand_left"), ("raising_left_arm",)),
    **dict.fromkeys(("raise_right_hand", "raising_hand_right"), ("raising_right_arm",)),
    **dict.fromkeys(("both_hands_up", "hands_up"), ("raising_arms",)),
    **dict.fromkeys(("syncope",), ("falling",)),
    **dict.fromkeys(("absence", "nobody_there", "no_presence"), ("nobody",)),
    **dict.fromkeys(("lunge_toward_left_front",), ("left_lunge",)),
    **dict.fromkeys(("lunge_toward_right_front",), ("right_lunge",)),
    **dict.fromkeys(("lunge_toward_left_side",), ("left_side_lunge",)),
    **dict.fromkeys(("lunge_toward_right_side",), ("right_side_lunge",)),
    **dict.fromkeys(("waving_hand_left", "waving_hand_right", "single_hand_waving"), ("waving",)),
}
# {our name: what may stand behind or before a word for it, and changes nothing}.
USUAL: dict[str, tuple[str, ...]] = {
    **{kind.name: kind.manners for kind in MOVEMENTS.values() if kind.manners},
    "sitting_down": _ONTO,
    "sitting": (*_ONTO, "still", "quietly"),
    "standing_up": (*_OFF, "from_sitting"),
    "stationary": ("still", "quietly"),
    "walking": ("around", "about", "in_room", "indoors", "normally", "straight", "free", "regular"),
    "running": ("around", "straight"),
    "crawling": (*_GROUND, "on_hands_and_knees", "on_all_fours", "army", "baby"),
    "falling": (*_GROUND, "accidental", "sudden", "over"),
    "getting_up": (*_GROUND, "from_lying"),
    "grabbing": _GROUND,
    "lying": (*_GROUND, "on_bed", "in_bed", "still", "flat"),
    "lying_down": ("on_bed", "in_bed", "onto_bed", "to_bed"),
    "kneeling": (*_GROUND, "on_knees"),
    "kneeling_down": (*_GROUND, "on_knees"),
    "limping": ("leg", "gait"),
    "waving": ("hello", "goodbye"),
    "drinking": ("standing", "from_bottle", "from_glass", "from_cup"),
    "squatting": ("exercise",),
    "jumping": ("exercise", "up_and_down"),
    "jumping_jacks": ("exercise",),
}
# {word: our names that come near it}: suggested, but not taken for the same.
NEARBY: dict[str, tuple[str, ...]] = {
    **{word: (kind.name,) for kind in MOVEMENTS.values() for word in kind.nearby},
    **dict.fromkeys(("bending", "bending_down", "bend", "reaching", "lifting"), ("grabbing",)),
    **dict.fromkeys(("bowing", "bow", "stooping"), ("grabbing",)),
    **dict.fromkeys(("mark_time", "stepping_in_place"), ("jogging_in_place",)),
    **dict.fromkeys(("turning", "turn"), ("body_rotating",)),
    **dict.fromkeys(("marching", "short_steps", "walking_slowly", "walking_fast"), ("walking",)),
    **dict.fromkeys(("hopping", "hop", "leaping"), ("jumping",)),
    **dict.fromkeys(("jack", "jacks"), ("jumping_jacks",)),
    **dict.fromkeys(("lunge", "lunges", "lunging"), ("right_lunge",)),
    **dict.fromkeys(
        ("raise_arm", "arm_raise", "raise_hand", "raising_hand", "hand_raising"),
        ("raising_right_arm",),
    ),
    **dict.fromkeys(("bending_over", "lift_box", "tie_shoes"), ("grabbing",)),
    **dict.fromkeys(("crouch", "crouching"), ("squatting",)),
    **dict.fromkeys(("leap", "jump_rope", "rope_skipping"), ("jumping",)),
    **dict.fromkeys(("marching_in_place", "high_knees", "stepping"), ("jogging_in_place",)),
    **dict.fromkeys(("twist", "turn_left", "turn_right"), ("body_rotating",)),
    **dict.fromkeys(("eat",), ("drinking",)),
    **dict.fromkeys(("laufen",), ("walking",)),  # or running
    **dict.fromkeys(
        ("walking_slow", "slow_walking", "fast_walking", "brisk_walking", "march"), ("walking",)
    ),
    **dict.fromkeys(("fallen",), ("falling", "lying")),  # to fall in German, to lie in English
    **dict.fromkeys(
        ("fall_forward", "fall_backward", "falling_backwards", "fall_sideways", "slip", "slipping"),
        ("falling",),
    ),
    **dict.fromkeys(("eating", "sipping"), ("drinking",)),
    **dict.fromkeys(("drawing",), ("writing_seated",)),
    **dict.fromkeys(("staggering",), ("stumbling",)),
    **dict.fromkeys(("crutches", "walking_on_crutches"), ("walking_with_stick",)),
    **dict.fromkeys(("left_limb_extension",), ("raising_left_arm_and_leg",)),
    **dict.fromkeys(("right_limb_extension",), ("raising_right_arm_and_leg",)),
    **dict.fromkeys(("left_upper_limb_extension",), ("raising_left_arm",)),
    **dict.fromkeys(("right_upper_limb_extension",), ("raising_right_arm",)),
    **dict.fromkeys(("both_upper_limb_extension", "hand_up"), ("raising_arms",)),
    **dict.fromkeys(("walking_in_place", "marching_on_the_spot"), ("jogging_in_place",)),
    **dict.fromkeys(("limb_extension_left",), ("raising_left_arm_and_leg",)),
    **dict.fromkeys(("limb_extension_right",), ("raising_right_arm_and_leg",)),
    **dict.fromkeys(("twist_left", "twist_right", "spin", "rotate"), ("body_rotating",)),
    **dict.fromkeys(("roll",), ("turning_over",)),
    **dict.fromkeys(
        ("falling_forward", "falling_backward", "falling_left", "falling_right", "falling_aside"),
        ("falling",),
    ),
    **dict.fromkeys(("lie_to_stand",), ("getting_up",)),
    **dict.fromkeys(("lie_to_sit", "sitting_up_in_bed"), ("getting_up_from_bed",)),
    **dict.fromkeys(("sit_to_lie",), ("lying_down",)),
    **dict.fromkeys(("stoop", "body_extension"), ("grabbing",)),
    **dict.fromkeys(("skipping_rope",), ("jumping",)),
    **dict.fromkeys(("cane", "crutch"), ("walking_with_stick",)),
    **dict.fromkeys(("treadmill", "short_step", "ambulation", "back_and_forth"), ("walking",)),
}
# {word: our name that it is, and the key that makes the difference}.
WITH_KEY: dict[str, tuple[str, str]] = {
    **dict.fromkeys(
        ("walking_towards", "walk_towards", "towards_walk", "walking_towards_radar", "approaching"),
        ("walking", "motion.angle_deg: 180, towards the radar"),
    ),
    **dict.fromkeys(
        ("walking_away", "walk_away", "walking_away_from_radar", "departing"),
        ("walking", "motion.angle_deg: 0, away from the radar"),
    ),
    **dict.fromkeys(
        ("walking_sideways", "walking_across", "walking_tangentially"),
        ("walking", "motion.angle_deg: 90, across the line of sight"),
    ),
    **dict.fromkeys(
        (
            "walking_with_rollator",
            "rollator",
            "wheeled_walker",
            "rolling_walker",
            "walking_behind_rollator",
        ),
        ("walking_with_walker", "motion.aids.rollator: 1, one that is rolled"),
    ),
    **dict.fromkeys(
        ("walking_with_frame", "walking_frame", "zimmer_frame", "zimmer", "pickup_walker"),
        ("walking_with_walker", "motion.aids.rollator: 0, a frame that is lifted"),
    ),
}
# Movements that no model of ours makes, nor one that means the same.
UNKNOWN = frozenset(
    {
        *("dancing", "climbing"),
        *(
            "climbing_stairs",
            "stairs",
            "cycling",
            "throwing",
            "pushing",
            "pulling",
        ),
        *(
            "gesture",
            "gestures",
            "swimming",
            "skipping",
            "push_ups",
            "sit_ups",
            "typing",
        ),
        # of another meaning than the name of ours whose letters they nearly have
        *("pinching", "picking_nose", "licking", "talking", "falling_asleep", "sitting_up"),
        *("failing", "filling", "weaving", "knocking", "knock", "check_oxygen", "baking", "lacing"),
        *("going_upstairs", "going_downstairs", "walking_upstairs", "walking_downstairs"),
        *("upstairs", "downstairs", "walking_up_stairs", "climbing_up", "sit_up", "situps"),
        *("pushups", "pull_ups", "burpees", "plank", "stretching", "stretch", "yoga", "biking"),
        *("bicycling", "rowing", "swipe", "swipe_left", "swipe_right", "push", "pull", "circle"),
        *("walking_backward", "walking_backwards", "walk_backwards", "backward_walking"),
        *("tiptoe", "side_step", "sidestep", "shake_hands", "nodding", "talking_on_phone"),
        *("texting", "wash_dishes", "wash_hands", "vacuuming", "ironing", "open_door"),
        *("close_door", "opening_door", "catch", "hug", "cheering", "smoking", "brush_teeth"),
        *("comb_hair", "seizure", "cough", "sneezing", "vomiting", "put_on", "take_off"),
        *("throw_ball", "wheelchair", "timed_up_and_go", "hand_gesture", "walking_with_dog"),
        # classes of public data sets: NTU RGB+D, Widar, CI4R and others
        *("eating_meal", "eat_meal", "brushing_teeth", "dropping", "drop", "throw", "reading"),
        *("tearing_paper", "tear_up_paper", "put_on_jacket", "take_off_jacket", "pointing"),
        *("phone_call", "playing_with_phone", "taking_selfie", "check_time", "rub_two_hands"),
        *("nod_head", "shake_head", "wipe_face", "salute", "cross_hands", "sneeze", "headache"),
        *("put_on_a_shoe", "take_off_a_shoe", "put_on_glasses", "take_off_glasses", "shuffling"),
        *("put_on_a_hat", "reach_into_pocket", "play_with_phone", "type_on_a_keyboard", "mop"),
        *("point_to_something", "taking_a_selfie", "put_palms_together", "cross_hands_in_front"),
        *("sneeze_cough", "point_finger", "giving_object", "touch_pocket", "shaking_hands"),
        *("stretching_and_relaxing", "chest_expansion_horizontal", "chest_expansion_vertical"),
        *("throwing_toward_left", "throwing_toward_right", "body_extension_left", "tandem_walk"),
        *("body_extension_right", "limb_extension_both", "stairs_up", "stairs_down", "step_up"),
        *("climb_stairs", "toe_walking", "heel_walking", "walking_on_toes", "scissor_gait"),
        *("walking_with_both_toes", "freezing_of_gait", "tremor", "pushup", "situp", "burpee"),
        *("bicycle", "golf", "tennis", "vacuum", "iron", "cook", "arm_circles", "arm_swing"),
        *("walk_back", "walkback", "lateral_walk", "pet", "dog", "fan"),
        *("chest_pain", "back_pain", "neck_pain", "nausea", "fan_self", "pat_on_back", "hugging"),
        *("handshaking", "walking_apart", "push_pull", "sweep", "slide", "draw_circle"),
        *("draw_zigzag", "scissors_gait", "coughing", "sweeping", "mopping", "cooking"),
    }
)
_SEPARATORS = str.maketrans(" -/", "___")
FROM_FILES = "no model moves like this; motion files can (docs/guide/motion_files.md)"


def advice_on(name: str, known: Iterable[str], otherwise: str) -> str:
    """Advise on a name of a movement that is not known: what may be meant.

    Letters alone suggest a name only where a slip of the hand explains the difference: most of
    them are the same, the first one included.

    Args:
        name: as somebody wrote it.
        known: our names that would do.
        otherwise: what is returned where nothing is meant.
    """
    names, word = list(known), plain_word(name)
    meant = meaning_of(name, names)
    if meant is not None:
        return f"did you mean {meant!r}?"
    same, key = WITH_KEY.get(word, ("", ""))
    if same in names:
        return f"it is {same!r} with {key}"
    near = next((candidate for candidate in NEARBY.get(word, ()) if candidate in names), None)
    if near is not None:
        return f"{near!r} comes near it"
    if word in UNKNOWN:
        return FROM_FILES
    similar = SIMILAR_SHORT if len(word) <= SHORT else SIMILAR
    return did_you_mean(word, [one for one in names if one[:1] == word[:1]], otherwise, similar)


def meaning_of(name: str, known: Iterable[str]) -> str | None:
    """Find the known name that means the same, or differs in case, spaces and hyphens alone.

    Our own names come before other words of the same meaning.
    """
    names = dict.fromkeys(known)
    meanings = meanings_of(name)
    slugs = (candidate for candidate in meanings if candidate in names)
    words = (word for word in names if not set(meanings).isdisjoint(meanings_of(word)))
    return next(slugs, None) or next(words, None)


def meanings_of(name: str) -> tuple[str, ...]:
    """Names that a word may stand for: itself, and ours of the same meaning.

    Articles and people do not matter, nor does a place or a manner that a movement has anyway:
    `sit_down_on_a_chair` is `sit_down`, `army_crawling` is `crawling`.
    """
    word = plain_word(name)
    short = "_".join(part for part in word.split("_") if part not in FILLERS)
    direct = (word, *MEANINGS.get(word, ()), short, *MEANINGS.get(short, ()))
    usual = (
        slug
        for slug, phrases in USUAL.items()
        for phrase in phrases
        for rest in (short.removesuffix(f"_{phrase}"), short.removeprefix(f"{phrase}_"))
        if rest != short and slug in (rest, *MEANINGS.get(rest, ()))
    )
    return tuple(dict.fromkeys((*direct, *usual)))


def is_other_word(name: str, slug: str) -> bool:
    """Whether a name is another word for a slug, not the slug in another way of writing it."""
    return plain_word(name) != slug and slug in meanings_of(name)


def plain_word(name: str) -> str:
    """Name in lower case with underscores for spaces, hyphens and slashes."""
    return name.strip().lower().translate(_SEPARATORS)
