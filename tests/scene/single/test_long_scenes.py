"""What a scene of minutes takes beyond the arrays that it is."""

import tracemalloc
from dataclasses import fields

import numpy as np

from radhar_cli.config.data_set import Config
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.radar import antennas_of, waveform_of
from radhar_cli.scene.scene import draw_scene
from radhar_cli.scene.single.truth import Truth, evaluate_truth


def spare_bytes(seconds: float) -> tuple[int, Truth]:
    """Most memory in use while the truth of a walk is worked out, beyond the truth itself."""
    config = Config.model_validate(
        {
            "duration_s": seconds,
            "radar": {"prf_hz": 1000.0},
            "motion": {"model": "human", "walking": {"lane_m": 4.0}},
            "activities": ["walking"],
        }
    )
    scene = draw_scene(config, config.chosen_activities[0], 0)
    motion = motion_of(scene.people[0])
    motion.positions(np.zeros(1))  # what is worked out once
    tracemalloc.start()
    try:
        made = evaluate_truth(motion, antennas_of(scene), None, waveform_of(scene))
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    arrays = [getattr(made, field.name) for field in fields(Truth)]
    return peak - sum(a.nbytes for a in arrays if isinstance(a, np.ndarray)), made


def test_the_truth_of_a_long_scene_needs_no_more_room_than_its_arrays() -> None:
    """Four times the recording, as much beside the arrays."""
    (little, _), (much, made) = (spare_bytes(seconds) for seconds in (15.0, 60.0))
    assert made.positions.shape == (60_000, 13, 3)
    assert much < 1.2 * little
