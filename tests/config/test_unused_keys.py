"""Numbers of people that nobody in a data set uses are said, with what would use them."""

from typing import Any

import pytest

from radhar_cli.config.checks.unused_keys import unused_keys
from radhar_cli.config.data_set import Config

PUNCHING: dict[str, Any] = {"activities": ["punching"]}


@pytest.mark.parametrize(
    ("document", "said"),
    [
        (
            PUNCHING | {"motion": {"walking": {"speed_mps": 2}}},
            [
                "motion.walking.speed_mps has no effect with activities: [punching]; "
                "it needs walking"
            ],
        ),
        (
            PUNCHING | {"motion": {"grabbing": {"dwell_s": 2}, "walking": {"lane_m": 2}}},
            [
                "motion.walking.lane_m has no effect with activities: [punching]; it needs walking",
                "motion.grabbing.dwell_s has no effect with activities: [punching]; "
                "it needs grabbing",
            ],
        ),
        (
            PUNCHING | {"timing": {"walk_start_s": 1}},
            [
                "timing.walk_start_s has no effect with activities: [punching]; it needs "
                "sitting_to_walking or falling_to_walking"
            ],
        ),
        (
            {"motion": {"falling": {"stumble_deg": 20}}},
            [
                "motion.falling.stumble_deg has no effect with activities: all; "
                "it needs stumbling or tripping"
            ],
        ),
        (
            PUNCHING | {"motion": {"exercises": {"size": 0.6}}},
            ["motion.exercises.size has no effect with activities: [punching]; it needs exercises"],
        ),
        (
            PUNCHING
            | {"motion": {"model": "paper", "walking": {"lane_m": 2}, "paper": {"thigh_deg": 20}}},
            [
                "motion.paper.thigh_deg has no effect with activities: [punching]; "
                "it needs kicking, "
                "walking, sitting_to_walking, walking_to_sitting, falling_to_walking or "
                "walking_to_falling",
                "motion.walking.lane_m has no effect with motion.model: paper",
            ],
        ),
        ({"activities": ["walking"], "motion": {"walking": {"speed_mps": 2, "lane_m": 2}}}, []),
        ({"motion": {"walking": {"speed_mps": 2}, "grabbing": {"dwell_s": 2}}}, []),
        (
            {
                "activities": ["staggering"],
                "classes": {"staggering": {"sequence": ["stumbling"]}},
                "motion": {"falling": {"stumble_deg": 20}},
            },
            [],
        ),
    ],
)
def test_numbers_that_no_activity_uses_are_said(document: Any, said: list[str]) -> None:
    found = unused_keys(Config.model_validate(document))
    assert sorted(found) == sorted(said)


@pytest.mark.parametrize(
    ("entries", "idle"),
    [
        ({"walking": 1, "punching": 2}, "punching"),
        ({"walking": 1, "S9": 2}, "sitting_to_walking"),
        ({"walking": 1, "S9": 2, "punching": 1}, "{sitting_to_walking, punching}"),
        ({"walking": 1, "default": 2}, None),
        ({"walking": 1}, None),
        ({"default": 2}, None),
    ],
)
def test_entries_of_activities_that_do_not_use_them_are_said_once(
    entries: Any, idle: str | None
) -> None:
    motion = {"walking": {"speed_mps": {"per_activity": entries}}}
    document = {"activities": ["walking", "punching"], "motion": motion}
    found = unused_keys(Config.model_validate(document))
    expected = (
        f"motion.walking.speed_mps.per_activity.{idle} has no effect with activities: "
        "[walking, punching]: nobody uses it"
    )
    assert found == [expected] * (idle is not None)


def test_of_other_people_too() -> None:
    other = {
        "activity": "punching",
        "motion": {"range_m": 5, "walking": {"speed_mps": 2, "lane_start": 0.3}},
    }
    document = {
        "activities": ["walking"],
        "motion": {"walking": {"speed_mps": 2}},
        "people": [other],
    }
    assert unused_keys(Config.model_validate(document)) == [
        "people.0.motion.walking.speed_mps has no effect with activities: [punching]; "
        "it needs walking",
        "people.0.motion.walking.lane_start has no effect with motion.walking.lane_m: 0.0; "
        "it needs motion.walking.lane_m above 0",
    ]
