"""Which numbers of a scene are the movement, and what to write where one tells the class."""

from types import SimpleNamespace

import numpy as np
import pytest

from radhar_cli.config import Config
from radhar_cli.dataset.scene_fields import ONSET
from radhar_cli.schema.annotations import annotations
from radhar_cli.study.audit.scene_numbers import (
    cure_of,
    is_instant,
    is_of_movement,
    one_law,
    sentences_on_cue,
)


@pytest.mark.parametrize(
    "key",
    [
        "motion.walking.speed_mps",
        "motion.striking.punch_hz",
        "motion.exercises.period",
        "motion.falling.direction",
        "timing.seat_duration_s",
        "timing.fall_duration_s",
        "motion.paper.gait_hz",
        "classes.mine.durations_s.0",
    ],
)
def test_speeds_rates_and_durations_are_the_movement(key):
    assert is_of_movement(key)


@pytest.mark.parametrize(
    "key",
    [
        *("motion.range_m", "motion.angle_deg", "motion.cross_range_m", "subject.height_m"),
        *("subject.weight_kg", "snr_db", "timing.seat_start_s", "timing.walk_stop_s"),
        *("wall.thickness_m", "room.faces.floor.permittivity", "radar.carrier_hz", "duration_s"),
        *("motion.idle.fidget_hz", "receiver.noise_figure_db", "image.cfar.p_fa"),
        "people.0.motion.walking.speed_mps",
    ],
)
def test_place_time_body_and_radar_are_not(key):
    assert not is_of_movement(key)


def test_instants_are_keys_of_timing():
    instants = {key for key in annotations(Config) if is_instant(key)}
    assert {"timing.seat_start_s", "timing.walk_begin_s", "timing.walk_stop_s"} <= instants
    assert not {key for key in instants if "duration" in key or not key.startswith("timing.")}


def test_what_to_write_instead():
    assert one_law(np.array([1.0, 2.0, np.nan])) == "{choice: [1, 2]}"
    assert one_law(np.arange(30.0)) == "{uniform: [0, 29]}"
    assert cure_of("snr_db", np.array([10.0, 30.0]), True) == "snr_db: {choice: [10, 30]}"
    ranges = np.linspace(2, 12, 50)
    assert cure_of("motion.range_m", ranges, False) == "motion.range_m: {uniform: [2, 12]}"
    place = "leave motion.range_m null, and write motion.place.range_m: {uniform: [2, 12]}"
    assert cure_of("motion.range_m", ranges, True) == place
    cure = cure_of("timing.seat_start_s timing.walk_stop_s", np.array([0.5, 2.0]), True)
    assert cure.startswith("leave timing.seat_start_s, timing.walk_stop_s null, and write")
    assert cure.endswith("timing.onset: {uniform: [0, 1]}")
    assert "timing.visible" in cure_of("movement_onset_s", ranges, True)


@pytest.mark.parametrize("count", [3, 9, 10, 40])
def test_few_samples_do_not_say_that_an_onset_is_on_cue(count):
    onset = np.concatenate([np.full(count, 1.5), np.linspace(0, 3, count), np.full(count, np.nan)])
    data = SimpleNamespace(
        fields=(ONSET,), scene={ONSET.name: onset}, classes=("falling", "walking", "sitting")
    )
    said = sentences_on_cue(data, np.repeat([0, 1, 2], count))
    if count < 10:
        assert said.on_cue == []
        assert said.too_few == [
            f"movement_onset_s: too few samples to tell whether it is on cue: falling ({count})"
        ]
    else:
        assert said.on_cue == ["movement_onset_s is on cue: falling 1.50 s (sd 0.00)"]
        assert said.too_few == []
