"""Sequences whose order and parts are drawn."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.config import Config, resolved
from radhar_cli.config.reading import validated
from radhar_cli.config.sequence import SequenceConfig
from radhar_cli.errors import ConfigError
from radhar_cli.motion.activities.links import is_link, links_between
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.scene.people import human_motion
from radhar_cli.scene.scene import Scene, draw_scene, nominal_scene

PARTS = [
    ["walking"],
    {"choice": ["grabbing", ["sitting_down", "standing_up"]]},
    {"optional": "kicking", "share": 0.5},
    {"shuffled": ["punching", "turning_around", {"choice": ["squatting", "jumping"]}]},
]
DURATIONS = [2, None, None, None, 2, 2, None, 2, 2]
STATES = sorted(
    {state for one in MOVEMENTS.values() for state in (one.before, one.after)} - {"nowhere"}
)


def config_of(sequence: list[Any], **others: Any) -> Config:
    return Config(classes={"mine": {"sequence": sequence, **others}}, activities=("mine",))


def scene_of(config: Config, index: int) -> Scene:
    return draw_scene(config, config.chosen_activities[0], index)


def names_of(scene: Scene) -> list[str]:
    section = scene.people[0].own_class
    assert isinstance(section, SequenceConfig)
    return [step.name for step in section.steps()]


def test_every_draw_is_one_of_what_is_written_and_all_come_up() -> None:
    config = config_of(PARTS, durations_s=DURATIONS)
    drawn = [names_of(scene_of(config, index)) for index in range(60)]
    assert {names[0] for names in drawn} == {"walking"}
    assert {"kicking" in names for names in drawn} == {True, False}
    assert {"grabbing" in names for names in drawn} == {True, False}
    for names in drawn:
        assert ("sitting_down" in names) != ("grabbing" in names)
        assert ("squatting" in names) != ("jumping" in names)
    orders = {tuple(n for n in names if n in ("punching", "turning_around")) for names in drawn}
    assert len(orders) == 2


def test_a_scene_has_nothing_left_to_draw_and_can_be_read_again() -> None:
    config = config_of(PARTS, durations_s=DURATIONS)
    scene = scene_of(config, 3)
    again = validated(Config, resolved(scene.config), "scene", {})
    assert names_of(scene_of(again, 3)) == names_of(scene)
    assert names_of(scene_of(again, 4)) == names_of(scene)
    assert names_of(nominal_scene(config, config.chosen_activities[0]))
    human_motion(scene.people[0]).parts  # noqa: B018  which join


def test_a_choice_depends_on_no_other() -> None:
    config = config_of(PARTS, durations_s=DURATIONS)
    other = config_of([{"choice": ["walking", "kicking"]}, *PARTS[1:]], durations_s=[2, *DURATIONS])
    for index in range(10):
        assert names_of(scene_of(config, index))[1:] == names_of(scene_of(other, index))[1:]


@pytest.mark.parametrize(
    ("sequence", "right"),
    [
        (["sitting_down", {"choice": ["walking", "standing_up"]}], "links: true would put"),
        ([{"optional": "sitting_down"}, "walking"], "walking begins standing"),
        ([{"shuffled": ["sitting_down", "punching"]}, "walking"], "begins standing"),
        ([{"optional": "walking"}], "not optional"),
        ([{"choice": ["walking", "kicking"]}, "punching"], "should have a duration of walking"),
        ([{"choice": ["sitting_dwn"]}], "did you mean 'sitting_down'"),
    ],
)
def test_what_some_draw_would_not_join_is_refused(sequence: list[Any], right: str) -> None:
    with pytest.raises(ConfigError, match=right):
        validated(Config, {"classes": {"mine": {"sequence": sequence}}}, "f.yaml", {})


def test_links_are_put_in_where_states_differ() -> None:
    config = config_of(
        ["sitting_down", {"choice": ["walking", "falling"]}, "grabbing"],
        durations_s=[None, 2, None, None],
        links=True,
    )
    drawn = {tuple(names_of(scene_of(config, index))) for index in range(20)}
    assert drawn == {
        ("sitting_down", "standing_up", "walking", "grabbing"),
        ("sitting_down", "standing_up", "falling", "getting_up", "grabbing"),
    }
    for index in range(4):
        human_motion(scene_of(config, index).people[0]).parts  # noqa: B018


@given(st.sampled_from(STATES), st.sampled_from(STATES))
def test_links_lead_from_state_to_state_without_a_fall(before: str, after: str) -> None:
    state = before
    for name in links_between(before, after) or ():
        assert is_link(name)
        assert not name.startswith("falling")
        state = MOVEMENTS[name].states[state]
    assert state == after or links_between(before, after) is None


def test_people_can_stand_up_from_wherever_they_are() -> None:
    assert all(links_between(state, "standing") is not None for state in STATES)
