"""Words of everyday life and of data sets: answered by meaning, or by nothing but their letters."""

import pytest

from radhar_cli.activities.activity import ACTIVITIES, MOVEMENTS
from radhar_cli.activities.vocabulary import FROM_FILES, advice_on

KNOWN = sorted({activity.slug for activity in ACTIVITIES} | set(MOVEMENTS) | {"nobody"})
NONE = "no such word"
MEANT = {
    "walking": "walkng waking walk strolling pacing gehen",
    "running": "jogging jog sprint runing rennen",
    "grabbing": "pick_up pick_up_object picking_up pickup",
    "drinking": "drink_water drinkng trinken",
    "waving": "waving_hand hand_wave wave_hello wavign winken",
    "clapping": "clap_hands clappin klatschen applauding",
    "punching": "boxing puching boxen",
    "kicking": "kickng front_kick",
    "squatting": "squats squat_down",
    "jumping": "jumpping jump_up springen",
    "falling": "fall fallling falling_down collapse sturz",
    "standing_up": "stand_up stand_up_from_chair sit_to_stand standing_upp aufstehen",
    "sitting_down": "sit_down siting_down stand_to_sit hinsetzen",
    "sitting": "seated sitzen",
    "lying_down": "lie_down lay_down",
    "lying": "laying sleep lie liegen",
    "getting_up": "get_up getting_up_from_floor",
    "getting_up_from_bed": "get_up_from_bed leaving_bed",
    "crawling": "crawl kriechen croling",
    "kneeling": "kneel knien",
    "limping": "limp humpeln",
    "stumbling": "stumble stolpern",
    "stationary": "standing no_activity breathing stehen",
    "nobody": "empty_room background no_person",
    "turning_around": "turn_around",
    "raising_arms": "arms_up",
    "left_lunge": "lunge_left lunge_toward_left-front",
    "raising_left_arm": "raise_left_hand raising_hand_left",
}
NEAR = {
    "jumping": "hopping leap jump_rope",
    "right_lunge": "lunges",
    "drinking": "eating eat",
    "jogging_in_place": "marching_in_place high_knees",
    "falling": "fall_backward fall_sideways slipping falling_forward falling_left",
    "walking": "brisk_walking slow_walking march laufen",
    "squatting": "crouching",
    "punching": "uppercut jab",
}
NO_MODEL = (
    "check_oxygen going_upstairs walking_upstairs downstairs knocking knock push pull swipe_left "
    "throwing throw_ball pushups push_ups situps sit_up burpees yoga stretching biking cycling "
    "rowing dancing climbing swimming walking_backwards tiptoe sidestep shake_hands nodding "
    "texting wash_hands vacuuming mopping ironing opening_door hug smoking brush_teeth seizure "
    "sneezing cough vomiting typing reading cooking baking weaving failing filling licking talking"
)
ANY_LETTERS = "nothing_like_it table zzz blinken marcher caminar tug duck rest wandering hook"


@pytest.mark.parametrize(
    ("word", "slug"), [(word, slug) for slug, words in MEANT.items() for word in words.split()]
)
def test_words_of_the_same_meaning(word: str, slug: str) -> None:
    for written in (word, word.replace("_", " "), word.title().replace("_", "-")):
        assert advice_on(written, KNOWN, NONE) == f"did you mean {slug!r}?"


@pytest.mark.parametrize(
    ("word", "slug"), [(word, slug) for slug, words in NEAR.items() for word in words.split()]
)
def test_words_that_come_near(word: str, slug: str) -> None:
    assert advice_on(word, KNOWN, NONE) == f"{slug!r} comes near it"


@pytest.mark.parametrize("word", NO_MODEL.split())
def test_movements_that_no_model_makes(word: str) -> None:
    assert advice_on(word, KNOWN, NONE) == FROM_FILES


@pytest.mark.parametrize("word", ANY_LETTERS.split())
def test_other_words_are_not_answered_by_their_letters(word: str) -> None:
    assert advice_on(word, KNOWN, NONE) == NONE
