"""Words of everyday life and of data sets: answered by meaning, or by nothing but their letters."""

import pytest

from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.motion.activities.vocabulary import FROM_FILES, USUAL, advice_on, meaning_of
from radhar_cli.motion.movements.catalogue import MOVEMENTS

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


WITH_PLACES = {
    "sitting_down": "sit_down_on_chair sit_down_on_a_chair sit_on_the_sofa",
    "sitting": "sitting_on_chair sitting_on_a_bench person_sitting",
    "standing_up": "stand_up_from_chair get_up_from_sofa rise_from_the_seat",
    "getting_up": "get_up_from_floor getting_up_off_the_ground",
    "falling": "fall_on_the_floor falling_to_ground fall_over accidental_fall",
    "falling_off_seat": "fall_off_chair falling_from_a_stool",
    "crawling": "army_crawling crawl_on_floor crawling_on_all_fours baby_crawling",
    "lying": "lying_on_the_floor lie_on_bed lying_in_bed",
    "lying_down": "lie_down_on_bed lay_down_in_bed",
    "walking": "walking_around a_person_walking walk_normally free_walking",
    "grabbing": "picking_up_from_floor pick_up_an_object",
    "kneeling_down": "kneel_down kneel_down_on_the_floor",
    "jogging_in_place": "run_in_place jogging_on_the_spot",
}
OTHERWISE = "sitting_on_floor_up walk_on_chair fall_asleep fallen standing_on_head crawl_up"


@pytest.mark.parametrize(
    ("word", "slug"),
    [(word, slug) for slug, words in WITH_PLACES.items() for word in words.split()],
)
def test_places_and_manners_that_a_movement_has_anyway_do_not_matter(word: str, slug: str) -> None:
    assert meaning_of(word, KNOWN) == slug


@pytest.mark.parametrize("word", OTHERWISE.split())
def test_places_and_manners_of_other_movements_do(word: str) -> None:
    assert meaning_of(word, KNOWN) is None


def test_every_usual_place_or_manner_leads_to_its_movement_alone() -> None:
    for slug, phrases in USUAL.items():
        for phrase in phrases:
            assert meaning_of(f"{slug}_{phrase}", KNOWN) == slug


@pytest.mark.parametrize(("name", "known"), [("grabbing", "picking_up"), ("pick_up", "grab")])
def test_words_of_one_meaning_match_whichever_is_known(name: str, known: str) -> None:
    assert meaning_of(name, ["walk", known]) == known
    assert meaning_of(name, ["walk"]) is None
