"""The same seed with another radar gives the same people, or it is said which scenes differ."""

from typing import Any

from radhar_cli.config import Config
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.checks.flags import Flags
from radhar_cli.scene.checks.warnings import collect_warnings

COUNT = 12


def config(bandwidth_hz: float, **motion: Any) -> Config:
    """Chirps whose half-band ends at 3.7 m per 1.6 GHz of bandwidth, less with more."""
    return Config.model_validate(
        {
            "seed": 3,
            "samples_per_class": COUNT,
            "duration_s": 3,
            "radar": {
                "carrier_hz": 77e9,
                "bandwidth_hz": bandwidth_hz,
                "prf_hz": 6400,
                "chirp_s": 40e-6,
                "adc_rate_hz": 4e6,
            },
            "maps": ["stft"],
            "motion": {"walking": {"speed_mps": 0.7, "lane_m": 2}, **motion},
            "activities": ["walking", "grabbing"],
        }
    )


FAR = {"range_m": {"uniform": [3, 9]}}


def draw_all(of: Config) -> list[tuple[float, bool]]:
    """Range of the person in every scene, m, and whether the radar had it drawn again."""
    drawn = [
        draw_valid_scene(of, activity, index)
        for activity in of.chosen_activities
        for index in range(COUNT)
    ]
    return [(scene.people[0].place[0], Flags.REDRAWN in flags) for scene, flags in drawn]


def test_scenes_that_differ_with_the_radar_are_those_that_are_said_to() -> None:
    near, fine = draw_all(config(1.6e9, **FAR)), draw_all(config(0.5e9, **FAR))
    differing = [n for n, (a, b) in enumerate(zip(near, fine, strict=True)) if a[0] != b[0]]
    told = [n for n, (a, b) in enumerate(zip(near, fine, strict=True)) if a[1] or b[1]]
    assert differing == told
    assert 0 < len(told) < 2 * COUNT


def test_near_places_give_all_radars_the_same_people() -> None:
    near, fine = (draw_all(config(f, range_m={"uniform": [2, 4]})) for f in (1.6e9, 0.5e9))
    assert near == fine
    assert not any(is_redrawn for _, is_redrawn in near)


def test_the_warning_counts_them_and_says_what_helps() -> None:
    (warning, *_) = collect_warnings(config(1.6e9, **FAR), {Flags.REDRAWN: 8}, 24)
    assert warning["recordings"] == 8
    assert warning["message"].startswith("8 of 24 recordings: drawn again, as somebody left")
    assert "motion.place" in warning["message"]
