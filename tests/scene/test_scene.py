"""Scenes: every number drawn from its own stream, none depending on another."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import kstest

from radhar_cli.config import Config
from radhar_cli.motion.activities.activity import ACTIVITIES, activity_named
from radhar_cli.scene.scene import (
    PERSONAL,
    draw_scene,
    nominal_scene,
    numbers,
    scene_numbers,
    subject_of,
)
from radhar_cli.schema.number import is_fixed, nominal, support

WALKING = activity_named("walking")
FALLING = activity_named("S12")

# Nearly every number drawn.
DRAWN: dict[str, Any] = {
    "duration_s": {"uniform": [3, 4]},
    "radar": {
        "carrier_hz": {"uniform": [76e9, 77e9]},
        "bandwidth_hz": {"uniform": [1e9, 4e9]},
        "tx_m": [{"uniform": [0.3, 0.5]}, -0.1, {"uniform": [1, 2]}],
        "antenna_gain_dbi": {"normal": [6, 1]},
    },
    "subject": {"height_m": {"uniform": [1.5, 1.9]}, "weight_kg": {"normal": [80, 5]}},
    "motion": {
        "model": "paper",
        "range_m": {"uniform": [2, 3]},
        "cross_range_m": {"uniform": [-1, 1]},
        "angle_deg": {"uniform": [-30, 30]},
        "walking": {"speed_mps": {"uniform": [1, 2]}},
        "paper": {"gait_hz": {"vary": [1, 0.1]}},
    },
    "timing": {
        "walk_stop_s": {"uniform": [1, 2]},
        "fall_duration_s": {"choice": [0.7, 0.8, 0.9]},
        "blend_s": {"uniform": [0.2, 0.4]},
    },
    "wall": {"eps_r": {"uniform": [4, 8]}, "center_m": [{"uniform": [0.9, 1.1]}, 0, 1.25]},
    "snr_db": {"uniform": [-10, 30]},
}
PEOPLE = {"split": {"by": "subject", "subjects": 4}, "samples_per_class": 12}


def drawn(config: Config, label: str = "S12", index: int = 5, attempt: int = 0) -> dict[str, float]:
    return scene_numbers(draw_scene(config, activity_named(label), index, attempt))


def changed_keys(one: dict[str, float], other: dict[str, float]) -> set[str]:
    return {key for key in one.keys() | other.keys() if one.get(key) != other.get(key)}


def variable_keys(config: Config) -> set[str]:
    return {
        key
        for key, number in numbers(config)
        if config.depends_on(FALLING, key) and not is_fixed(number)
    }


def test_a_scene_is_the_same_in_whatever_order_it_is_drawn() -> None:
    config = Config(**DRAWN)
    wanted = [(activity, index) for activity in ACTIVITIES for index in range(4)]
    forth = {(a.slug, i): draw_scene(config, a, i) for a, i in wanted}
    back = {(a.slug, i): draw_scene(config, a, i) for a, i in reversed(wanted)}
    assert forth == back


@pytest.mark.parametrize(
    ("change", "touched"),
    [
        ({"snr_db": 0.0}, {"snr_db"}),
        ({"snr_db": None}, {"snr_db"}),
        ({"snr_reference": "received"}, set()),
        ({"wall": None}, {"wall."}),
        ({"wall": {"eps_r": 3}}, {"wall."}),
        ({"wall": {**DRAWN["wall"], "rays": "refracted", "fresnel": "parallel"}}, set()),
        ({"engine": {"kind": "cube", "precision": "double"}}, set()),
        ({"maps": ("rtm", "fsst_denoised")}, set()),
        ({"processing": {"clutter": "none", "range_fft_length": 512}}, set()),
        ({"image": {"size_px": 64}}, set()),
        ({"output": {"png": False}}, set()),
        ({"split": {"train": 0.5, "validation": 0.5}}, set()),
        ({"samples_per_class": 7}, set()),
        ({"activities": ("S12",)}, set()),
        ({"on_invalid": "redraw"}, set()),
        ({"duration_s": {"uniform": [2, 8]}}, {"duration_s"}),
        ({"subject": {"height_m": 1.8, "weight_kg": {"normal": [80, 5]}}}, {"subject.height_m"}),
        (
            {"motion": {**DRAWN["motion"], "range_m": {"normal": [2, 0.1]}}},
            {"motion.range_m"},
        ),
        (
            {
                "motion": {
                    **DRAWN["motion"],
                    "angle_deg": 0,
                    "paper": {**DRAWN["motion"]["paper"], "arm_deg": {"uniform": [0, 9]}},
                }
            },
            {"motion.angle_deg", "motion.paper.arm_deg"},
        ),
        (
            {"timing": {**DRAWN["timing"], "blend_s": {"choice": [0.15, 0.45]}}},
            {"timing.blend_s"},
        ),
    ],
    ids=lambda part: "+".join(sorted(part)),
)
def test_a_change_touches_its_own_draws_alone(change: dict[str, Any], touched: set[str]) -> None:
    before, after = drawn(Config(**DRAWN)), drawn(Config(**{**DRAWN, **change}))
    moved = changed_keys(before, after)
    assert all(key.startswith(tuple(touched)) for key in moved)
    assert len(moved) >= len(touched)


@pytest.mark.parametrize("other", [{"label": "S11"}, {"index": 6}])
def test_samples_and_classes_are_drawn_apart(other: dict[str, Any]) -> None:
    config = Config(**DRAWN)
    one, two = drawn(config), drawn(config, **other)
    common = variable_keys(config) & two.keys()
    assert common <= changed_keys(one, two) | {"timing.fall_duration_s"}


def test_another_seed_is_another_data_set() -> None:
    one, two = (drawn(Config(seed=seed, **DRAWN)) for seed in (1, 2))
    assert variable_keys(Config(**DRAWN)) - {"timing.fall_duration_s"} <= changed_keys(one, two)


@given(st.integers(0, 2**63 - 1), st.sampled_from(ACTIVITIES), st.integers(0, 1000))
@settings(deadline=None, max_examples=40)
def test_draws_lie_within_their_support(seed: int, activity: Any, index: int) -> None:
    config = Config(seed=seed, **DRAWN)
    scene = draw_scene(config, activity, index)
    drawn_numbers = dict(numbers(scene.config))
    for key, number in numbers(config):
        low, high = support(number)
        assert low <= drawn_numbers[key] <= high, key
        if is_fixed(number) or not config.depends_on(activity, key):
            assert drawn_numbers[key] == nominal(number), key


def test_draws_follow_their_distribution() -> None:
    config = Config(**DRAWN)
    scenes = [scene_numbers(draw_scene(config, WALKING, index)) for index in range(1000)]
    for key, low, high in [("motion.range_m", 2, 3), ("subject.height_m", 1.5, 1.9)]:
        shares = [(scene[key] - low) / (high - low) for scene in scenes]
        assert kstest(shares, "uniform").pvalue > 1e-3, key
    together = np.corrcoef(
        [scene["motion.range_m"] for scene in scenes],
        [scene["subject.height_m"] for scene in scenes],
    )
    assert abs(together[0, 1]) < 5 / np.sqrt(1000)


@pytest.mark.parametrize(
    ("slug", "paper", "human"),
    [
        ("stationary", set(), {"motion.idle.shuffle_hz"}),
        (
            "kicking",
            {"motion.paper.thigh_deg"},
            {"motion.striking.kick_hz", "motion.striking.strike_scale"},
        ),
        (
            "sitting_down",
            {"timing.seat_start_s"},
            {"motion.sitting.seat_height", "timing.onset"},
        ),
        ("walking_to_falling", {"timing.blend_s"}, {"timing.overlap_s"}),
    ],
)
def test_a_scene_holds_what_its_activity_uses(slug: str, paper: set[str], human: set[str]) -> None:
    for model, some, others in (("paper", paper, human - paper), ("human", human, paper - human)):
        config = Config(motion={"model": model}, wall={})
        keys = set(scene_numbers(draw_scene(config, activity_named(slug), 0)))
        place = "motion.range_m" if model == "paper" else "motion.place.range_m"
        assert some | {place, "motion.angle_deg", "wall.eps_r"} <= keys
        assert not others & keys
        assert (
            ("motion.idle.fidget_hz" in keys) == ("subject.pulse_hz" in keys) == (model == "human")
        )


def test_numbers_may_differ_by_activity() -> None:
    config = Config(motion={"range_m": {"per_activity": {"default": 2, "S8": 1}}})
    assert drawn(config, "S8")["motion.range_m"] == 1
    assert drawn(config, "S9")["motion.range_m"] == 2


@pytest.mark.parametrize("scene", [draw_scene, lambda c, a, i: nominal_scene(c, a)])
def test_weight_is_26_kg_per_square_metre_unless_given(scene: Any) -> None:
    values = scene_numbers(scene(Config(), WALKING, 3))
    height = values["subject.height_m"]
    assert values["subject.weight_kg"] == pytest.approx(26 * height**2, rel=1e-15)
    values = scene_numbers(scene(Config(subject={"weight_kg": 70}), WALKING, 3))
    assert values["subject.weight_kg"] == 70


def test_the_nominal_scene_is_the_middle_of_everything() -> None:
    values = scene_numbers(nominal_scene(Config(**DRAWN), FALLING))
    expected = {
        "subject.height_m": 1.7,
        "motion.range_m": 2.5,
        "motion.angle_deg": 0.0,
        "motion.paper.gait_hz": 1.0,
        "timing.fall_duration_s": 0.8,
        "snr_db": 10.0,
        "radar.tx_m.2": 1.5,
    }
    assert {key: values[key] for key in expected} == pytest.approx(expected)


def test_without_persons_every_sample_is_another_person() -> None:
    config = Config(**DRAWN)
    assert subject_of(config, 3) is None
    heights = {drawn(config, a.label, i)["subject.height_m"] for a in ACTIVITIES for i in range(4)}
    assert len(heights) == 12 * 4


def test_persons_are_shared_by_all_activities() -> None:
    config = Config(**{**DRAWN, **PEOPLE})
    people: dict[int | None, set[tuple[float, ...]]] = {}
    for activity in ACTIVITIES[7:]:
        for index in range(12):
            scene = draw_scene(config, activity, index)
            assert scene.subject == subject_of(config, index)
            own = scene_numbers(scene)
            traits = tuple(own[key] for key in PERSONAL if key in own)
            people.setdefault(scene.subject, set()).add(traits)
    assert people.keys() == {0, 1, 2, 3}
    assert all(len(traits) == 1 for traits in people.values())
    assert len(set.union(*people.values())) == 4


def test_a_person_has_a_body_and_a_gait_but_no_fixed_place() -> None:
    config = Config(**{**DRAWN, **PEOPLE})
    one, again = drawn(config, "S12", 1), drawn(config, "S12", 5)
    assert subject_of(config, 1) == subject_of(config, 5)
    same = variable_keys(config) - changed_keys(one, again) - {"timing.fall_duration_s"}
    assert same == {
        "subject.height_m",
        "subject.weight_kg",
        "motion.walking.speed_mps",
        "motion.paper.gait_hz",
        "motion.paper.thigh_deg",
        "motion.paper.calf_deg",
        "motion.paper.arm_deg",
    }


@given(st.integers(1, 50), st.integers(0, 200))
@settings(deadline=None, max_examples=30)
def test_every_person_performs_equally_often(subjects: int, more: int) -> None:
    count = subjects + more
    config = Config(
        samples_per_class=count, split={"by": "subject", "subjects": subjects}, maps=("rtm",)
    )
    shares = np.bincount([subject_of(config, index) or 0 for index in range(count)])
    assert shares.size == subjects
    assert shares.max() - shares.min() <= 1


@pytest.mark.parametrize("people", [{}, PEOPLE])
def test_a_redrawn_scene_moves_anew_but_keeps_the_person_and_the_radar(
    people: dict[str, Any],
) -> None:
    config = Config(**{**DRAWN, **people})
    first, again, third = (drawn(config, attempt=attempt) for attempt in (0, 1, 2))
    moved = {k for k in variable_keys(config) if k.startswith(("motion.", "timing."))}
    if people:
        moved -= set(PERSONAL)
    for one, other in ((first, again), (again, third), (first, third)):
        assert changed_keys(one, other) | {"timing.fall_duration_s"} == moved
    assert draw_scene(config, FALLING, 5, 2).attempt == 2
