"""Words that people use for movements, and our names of the same meaning."""

from collections.abc import Callable, Iterable

from radhar_cli.errors import did_you_mean
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.kind import MovementKind

# Share of letters from which a name is taken for a mistyped one: one letter of four is wrong, or
# of longer names one in six.
SHORT, SIMILAR_SHORT, SIMILAR = 5, 0.75, 0.8

FILLERS = frozenset(
    {"a", "an", "the", "my", "his", "her", "their", "one", "person", "people", "human", "someone"}
)


def _by_word(words: Callable[[MovementKind], str]) -> dict[str, tuple[str, ...]]:
    """{word: names of the movements that have it}."""
    names = dict[str, tuple[str, ...]]()
    for name, kind in MOVEMENTS.items():
        for word in words(kind).split():
            names[word] = (*names.get(word, ()), name)
    return names


# {word: our names of the same meaning, of which the first that is known counts}; a config may say
# the word instead. A movement of the word's own name comes before these.
MEANINGS = _by_word(lambda kind: kind.words)
# {our name: what may stand behind or before a word for it, and changes nothing}.
USUAL = {name: tuple(kind.manners.split()) for name, kind in MOVEMENTS.items() if kind.manners}
# {word: our names that come near it}: suggested, but not taken for the same.
NEARBY = _by_word(lambda kind: kind.nearby)
# {word: our name that it is, and the key that makes the difference}.
WITH_KEY = {
    word: (name, key)
    for name, kind in MOVEMENTS.items()
    for key, words in kind.with_key.items()
    for word in words.split()
}
# Movements that no model of ours makes, nor one that means the same.
_UNKNOWN_WORDS = """
    dancing climbing climbing_stairs stairs cycling throwing pushing pulling gesture
    gestures swimming skipping push_ups sit_ups typing pinching picking_nose licking talking
    falling_asleep sitting_up failing filling weaving knocking knock check_oxygen baking
    lacing going_upstairs going_downstairs walking_upstairs walking_downstairs upstairs
    downstairs walking_up_stairs climbing_up sit_up situps pushups pull_ups burpees plank
    stretching stretch yoga biking bicycling rowing swipe swipe_left swipe_right push pull
    circle walking_backward walking_backwards walk_backwards backward_walking tiptoe
    side_step sidestep shake_hands nodding talking_on_phone texting wash_dishes wash_hands
    vacuuming ironing open_door close_door opening_door catch hug cheering smoking
    brush_teeth comb_hair seizure cough sneezing vomiting put_on take_off throw_ball
    wheelchair timed_up_and_go hand_gesture walking_with_dog eating_meal eat_meal
    brushing_teeth dropping drop throw reading tearing_paper tear_up_paper put_on_jacket
    take_off_jacket pointing phone_call playing_with_phone taking_selfie check_time
    rub_two_hands nod_head shake_head wipe_face salute cross_hands sneeze headache
    put_on_a_shoe take_off_a_shoe put_on_glasses take_off_glasses shuffling put_on_a_hat
    reach_into_pocket play_with_phone type_on_a_keyboard mop point_to_something
    taking_a_selfie put_palms_together cross_hands_in_front sneeze_cough point_finger
    giving_object touch_pocket shaking_hands stretching_and_relaxing
    chest_expansion_horizontal chest_expansion_vertical throwing_toward_left
    throwing_toward_right body_extension_left tandem_walk body_extension_right
    limb_extension_both stairs_up stairs_down step_up climb_stairs toe_walking heel_walking
    walking_on_toes scissor_gait walking_with_both_toes freezing_of_gait tremor pushup situp
    burpee bicycle golf tennis vacuum iron cook arm_circles arm_swing walk_back walkback
    lateral_walk pet dog fan chest_pain back_pain neck_pain nausea fan_self pat_on_back
    hugging handshaking walking_apart push_pull sweep slide draw_circle draw_zigzag
    scissors_gait coughing sweeping mopping cooking
"""
UNKNOWN = frozenset(_UNKNOWN_WORDS.split())
_SEPARATORS = str.maketrans(" -/", "___")
FROM_FILES = "no model moves like this; motion files can (docs/guide/motion_files.md)"


def advice_on(name: str, known: Iterable[str], otherwise: str) -> str:
    """Advise on a name of a movement that is not known: what may be meant.

    Letters alone suggest a name only where a slip of the hand explains the difference: most of
    them are the same, the first one included.

    Args:
        name: as somebody wrote it.
        known: our names that would do.
        otherwise: text that is returned where nothing is meant.
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
