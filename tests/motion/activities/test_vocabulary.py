"""Names of movements are suggested by meaning, and by letters where these are nearly all right."""

import pytest

from radhar_cli.config import load_config
from radhar_cli.errors import ConfigError
from radhar_cli.motion.activities.activity import ACTIVITIES, Activity, activity_named
from radhar_cli.motion.activities.vocabulary import (
    FROM_FILES,
    MEANINGS,
    NEARBY,
    UNKNOWN,
    WITH_KEY,
    advice_on,
)
from radhar_cli.motion.movements.catalogue import MOVEMENTS

SLUGS = [activity.slug for activity in ACTIVITIES]


def test_the_table_leads_to_movements_and_is_no_list_of_them() -> None:
    for table in (MEANINGS, NEARBY):
        assert all(name in MOVEMENTS for names in table.values() for name in names)
    assert not (NEARBY.keys() | UNKNOWN) & {*MOVEMENTS, *SLUGS}
    assert not MEANINGS.keys() & NEARBY.keys()
    assert not WITH_KEY.keys() & (MEANINGS.keys() | NEARBY.keys() | UNKNOWN | {*MOVEMENTS})
    assert all(name in MOVEMENTS for name, _ in WITH_KEY.values())
    assert not (MEANINGS.keys() | NEARBY.keys()) & UNKNOWN


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("picking_up", "did you mean 'grabbing'?"),
        ("Picking up", "did you mean 'grabbing'?"),
        ("boxing", "did you mean 'punching'?"),
        ("walking_towards", "it is 'walking' with motion.angle_deg: 180, towards the radar"),
        (
            "rollator",
            "it is 'walking_with_walker' with motion.aids.rollator: 1, one that is rolled",
        ),
        (
            "zimmer frame",
            "it is 'walking_with_walker' with motion.aids.rollator: 0, a frame that is lifted",
        ),
        ("walking away", "it is 'walking' with motion.angle_deg: 0, away from the radar"),
        ("left front lunge", "did you mean 'left_lunge'?"),
        ("left limb extension", "'raising_left_arm_and_leg' comes near it"),
        ("staggering", "'stumbling' comes near it"),
        ("throw", FROM_FILES),
        ("swimming", FROM_FILES),
        ("dancing", FROM_FILES),
        ("waking", "did you mean 'walking'?"),
        ("yodelling", "none like it"),
    ],
)
def test_advice_is_by_meaning(name: str, advice: str) -> None:
    assert advice_on(name, MOVEMENTS, "none like it") == advice


@pytest.mark.parametrize(
    ("name", "slug"),
    [
        ("falling", "falling"),
        ("Falling", "falling"),
        ("fall", "falling"),
        ("squats", "squatting"),
        ("jumping", "jumping"),
        ("picking up", "grabbing"),
        ("boxing", "punching"),
        ("standing", "stationary"),
        ("S5", "sitting_down"),
    ],
)
def test_movements_and_other_words_are_activities(name: str, slug: str) -> None:
    activity = activity_named(name)
    assert activity.slug == slug
    assert activity.movements[0] == slug


def test_a_class_of_its_own_comes_before_another_word() -> None:
    own = Activity(13, "boxing", ("kicking",))
    assert activity_named("boxing", {"boxing": own}) is own


def test_streams_of_movements_differ() -> None:
    indices = {activity_named(name).index for name in (*SLUGS, *MOVEMENTS)}
    assert len(indices) == len({*SLUGS, *MOVEMENTS})
    assert not indices & {*range(12, 300)}  # of classes of one's own


# Words of public data sets (NTU RGB+D and others) that mean none of our movements.
FOREIGN = (
    "pinching picking_nose licking talking brushing_teeth reading clapping tearing_up_paper "
    "putting_on_jacket wearing_shoes taking_off_glasses cheering phone_call texting "
    "taking_a_selfie checking_time rubbing_hands nodding shaking_head wiping_face saluting "
    "crossing_hands sneezing coughing nausea fanning pushing patting_back pointing "
    "hugging giving shaking_hands snapping_fingers juggling tossing_coin whispering yawning "
    "stretching blowing_nose sweeping mopping cooking typing washing swinging grinning weaving "
    "baking talking_on_phone knitting rowing skating skiing walling_off failing "
    "filling stalking sitting_up racing fishing"
)


@pytest.mark.parametrize("word", FOREIGN.split(" "))
def test_a_word_of_another_meaning_is_not_answered_by_its_letters(word: str) -> None:
    advice = advice_on(word, [*SLUGS, *MOVEMENTS], "none like it")
    assert advice in (FROM_FILES, "none like it") or word in MOVEMENTS


def test_unknown_words_in_configs_name_what_is_meant(tmp_path) -> None:
    path = tmp_path / "c.yaml"
    path.write_text("classes: {a: {sequence: [swimming]}, b: {sequence: [bending]}}\n")
    with pytest.raises(ConfigError) as refused:
        load_config(path)
    first, second = str(refused.value).splitlines()
    assert "'swimming' is not a movement; " + FROM_FILES in first
    assert "'bending' is not a movement; 'grabbing' comes near it" in second


# Classes of NTU RGB+D, MARS, RadHAR, Glasgow, Widar, CI4R: each by meaning, or by none.
CLASSES = (
    "running picking_up boxing lying walking_towards walking_away clapping limping box jump jack "
    "squats walk drink_water eat_meal brushing_teeth drop pick_up throw sit_down stand_up reading "
    "writing tear_up_paper put_on_jacket take_off_jacket hand_waving hopping jump_up phone_call "
    "typing pointing taking_selfie check_time nod_head shake_head wipe_face salute cross_hands "
    "sneeze staggering falling_down headache pushing hugging handshaking both_upper_limb_extension "
    "left_front_lunge right_side_lunge squat push_pull sweep clap slide draw_circle draw_zigzag "
    "towards_walk bending short_steps scissors_gait crutches crawling picking_object fall kneeling"
)


@pytest.mark.parametrize("word", CLASSES.split(" "))
def test_classes_of_public_data_sets_are_known_by_meaning(word: str) -> None:
    known = {*MOVEMENTS, *MEANINGS, *NEARBY, *WITH_KEY, *UNKNOWN}
    assert word in known
    advice = advice_on(word, MOVEMENTS, "none like it")
    named = [*MEANINGS.get(word, ()), *NEARBY.get(word, ()), *WITH_KEY.get(word, ())[:1], word]
    assert advice == FROM_FILES or any(repr(name) in advice for name in named)
