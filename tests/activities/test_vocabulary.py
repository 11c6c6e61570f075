"""Names of movements are suggested by meaning, and by letters where these are nearly all right."""

import pytest

from radhar_cli.activities.activity import ACTIVITIES, MOVEMENTS, activity_named
from radhar_cli.activities.vocabulary import FROM_FILES, MEANINGS, UNKNOWN, advice_on
from radhar_cli.config import load_config
from radhar_cli.errors import ConfigError

SLUGS = [activity.slug for activity in ACTIVITIES]


def test_the_table_leads_to_movements_and_is_no_list_of_them() -> None:
    assert all(name in MOVEMENTS for names in MEANINGS.values() for name in names)
    assert not (MEANINGS.keys() | UNKNOWN) & {*MOVEMENTS, *SLUGS}
    assert not MEANINGS.keys() & UNKNOWN


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("picking_up", "did you mean 'grabbing'?"),
        ("Picking up", "did you mean 'grabbing'?"),
        ("boxing", "did you mean 'punching'?"),
        ("walking_towards", "did you mean 'walking'?"),
        ("sitting", "did you mean 'sitting_down'?"),
        ("running", FROM_FILES),
        ("clapping", FROM_FILES),
        ("lying", FROM_FILES),
        ("waking", "did you mean 'walking'?"),
        ("yodelling", "none like it"),
    ],
)
def test_advice_is_by_meaning(name: str, advice: str) -> None:
    assert advice_on(name, MOVEMENTS, "none like it") == advice


@pytest.mark.parametrize("name", ["falling", "Falling", "fall", "squats", "jumping"])
def test_a_movement_is_no_activity_but_makes_a_class(name: str) -> None:
    with pytest.raises(ValueError, match=r"is a movement, of which a class can be made") as refused:
        activity_named(name)
    assert "did you mean" not in str(refused.value)
    movement = str(refused.value).split("sequence: [")[1].split("]")[0]
    assert movement in MOVEMENTS


def test_unknown_words_in_configs_name_what_is_meant(tmp_path) -> None:
    path = tmp_path / "c.yaml"
    path.write_text("classes: {a: {sequence: [running]}, b: {sequence: [picking_up]}}\n")
    with pytest.raises(ConfigError) as refused:
        load_config(path)
    first, second = str(refused.value).splitlines()
    assert "'running' is not a movement; " + FROM_FILES in first
    assert "'picking_up' is not a movement; did you mean 'grabbing'?" in second
