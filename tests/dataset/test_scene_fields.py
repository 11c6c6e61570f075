"""Drawn numbers as columns: one for every key, in SI units beside the units of the config."""

from math import pi

import numpy as np
import pytest
from helpers import boards
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config import Config
from radhar_cli.config.paths import numbers
from radhar_cli.dataset.scene_fields import TAKEN, fields, values
from radhar_cli.motion.activities.activity import ACTIVITIES, activity_named
from radhar_cli.scene.scene import draw_scene, scene_numbers

EVERYTHING = Config(motion={"model": "paper"}, wall={})


@pytest.mark.parametrize(
    ("key", "name", "unit", "factor"),
    [
        ("radar.carrier_hz", "carrier", "Hz", 1),
        ("radar.rx_m.2", "rx_z", "m", 1),
        ("radar.antenna_gain_dbi", "antenna_gain", "dBi", 1),
        ("subject.height_m", "height", "m", 1),
        ("motion.angle_deg", "angle", "rad", pi / 180),
        ("motion.walking.speed_mps", "speed", "m/s", 1),
        ("wall.center_m.1", "wall_center_y", "m", 1),
        ("wall.eps_r", "wall_eps_r", "1", 1),
        ("snr_db", "snr", "dB", 1),
    ],
)
def test_name_unit_and_factor(key, name, unit, factor):
    (field,) = [field for field in fields(EVERYTHING) if field.key == key]
    assert (field.name, field.unit) == (name, unit)
    assert field.factor == pytest.approx(factor, rel=1e-15)


def test_every_number_of_every_activity_has_one_column():
    columns = fields(EVERYTHING)
    keys = {
        key
        for key, _ in numbers(EVERYTHING)
        if any(EVERYTHING.depends_on(activity, key) for activity in ACTIVITIES)
    }
    assert {field.key for field in columns} == keys | {"subject.weight_kg", "error_db"}
    assert len({field.name for field in columns}) == len(columns)


def test_only_the_chosen_activities_and_parts_have_columns():
    keys = {field.key for field in fields(Config(activities=("S1",), snr_db=None))}
    assert not any(key.startswith("wall.") for key in keys)
    of_timing = {key for key in keys if key.startswith("timing.")}
    assert of_timing == {"timing.onset", "timing.visible"}
    assert {"snr_db", "motion.walking.speed_mps"}.isdisjoint(keys)
    assert {"subject.weight_kg", "motion.place.range_m", "movement_onset_s"} <= keys


@pytest.mark.parametrize(
    ("engine", "maps", "there"),
    [("direct", ("rtm", "stft"), True), ("direct", ("rtm",), False), ("cube", ("stft",), False)],
)
def test_the_measured_error_has_a_column_where_the_direct_engine_sums(engine, maps, there):
    columns = fields(Config(engine={"kind": engine}, maps=maps))
    assert ("error_db" in {field.name for field in columns}) == there


def test_degrees_are_the_only_unit_that_is_not_si():
    for field in fields(EVERYTHING):
        in_degrees = field.key.endswith("_deg")
        assert (field.unit == "rad") == in_degrees
        assert (field.factor == 1.0) == (not in_degrees)


def test_the_table_is_in_config_units_with_nan_where_a_number_does_not_apply():
    config = Config(activities=("S1", "S8"), motion={"model": "paper"})
    columns = fields(config)
    scenes = [draw_scene(config, activity_named(slug), 3) for slug in ("S1", "S8")]
    table = np.array([values(scene, columns, -100.5) for scene in scenes])
    assert table.shape == (2, len(columns))
    for row, scene in zip(table, scenes, strict=True):
        known = scene_numbers(scene) | {"error_db": -100.5}
        for value, field in zip(row, columns, strict=True):
            if field.key in known:
                assert value == known[field.key]
            else:
                assert np.isnan(value)
    speed = [field.key for field in columns].index("motion.walking.speed_mps")
    assert np.isnan(table[0, speed])
    assert table[1, speed] == 1.5


# What may be chosen of every section, and with it other numbers. Slugs of classes are the
# beginnings of names that keys have.
ARRAY = {"tx": [[0, 0], [2, 0], [4, 1]], "rx": [[0, 0], [1, 0], [2, 0], [3, 0]]}
WAVEFORMS = (
    {},
    {"waveform": "sfcw", "steps": 20, "dwell_s": 2e-6},
    {"waveform": "cw"},
    {"waveform": "impulse", "profile_m": [0.3, 6], "profile_samples": 512, "carrier_hz": 2e9},
    {"beam": {}},
    {"cfg": boards.CFG, "device": "IWR1443BOOST", "half_power_deg": [30, 20]},
    {"cfg": boards.CFG, "array": ARRAY},
)
SLUGS = ("grab", "seat", "rise", "walk", "lane", "timing_grab", "people_1", "layer_0", "radar")
SLUGS += ("array_tx_0", "motion", "subject", "error", "x_duration", "x")
CLASS = (
    {"sequence": ["squatting"] * 2, "durations_s": [2, 2]},
    ["one.bvh"],
    {"files": ["a.npz", "b.npz"]},
)
FACES = {"floor": "concrete", "left": {"eps_r": 4}, "back": {"eps_r": 5, "loss_tangent": 0.1}}
ROOMS = (
    {},
    {"reflectors": [{}, {"residual_m": 0.001}]},
    {"back_wall_m": 40},
    {"faces": FACES, "box_m": {"x": [-1, 40], "y": [-20, 20]}},
)
WALLS = (None, {}, {"echoes": "exact", "layers": [{"eps_r": 4}, {"material": "brick"}]})


@st.composite
def documents(draw):
    """Configs that cross what other numbers come with."""
    radar, wall = draw(st.sampled_from(WAVEFORMS)), draw(st.sampled_from(WALLS))
    board, impulse = "cfg" in radar, radar.get("waveform") == "impulse"
    exact = bool(wall) and not board
    tones = [] if board or impulse else draw(st.sampled_from(([], [{"doppler_hz": 9}] * 2)))
    processing = {"range_sum": "gated"} if board or impulse else {}
    people = st.sampled_from(({"activity": "grabbing"}, {"activity": {"choice": ["S8", "S9"]}}, {}))
    return {
        "classes": draw(st.dictionaries(st.sampled_from(SLUGS), st.sampled_from(CLASS))),
        "radar": radar,
        "people": draw(st.lists(people, max_size=3)),
        "wall": None if board and wall else wall,
        "room": {} if wall is not None else draw(st.sampled_from(ROOMS)),
        "receiver": {"tones": tones, "noise_corner_hz": 9.0 if tones else 0.0},
        "snr_db": None if board else 30.0,
        "engine": {"kind": "cube" if exact and not impulse else "direct"},
        "maps": draw(st.sampled_from((["rtm"], ["stft"]))) if "waveform" not in radar else ["stft"],
        "processing": processing,
        "image": {"kind": draw(st.sampled_from(("decibel", "cfar")))},
        "split": {"by": "subject", "subjects": 5} if draw(st.booleans()) else {},
    }


@settings(max_examples=60)
@given(documents())
def test_names_differ_whatever_is_chosen(document):
    columns = fields(Config.model_validate(document))
    names = [field.name for field in columns]
    assert len(set(names)) == len(names)
    assert len({field.key for field in columns}) == len(names)
    assert TAKEN.isdisjoint(names)


SFCW = {"waveform": "sfcw", "steps": 20, "dwell_s": 2e-6}


def keys_of(**document):
    return {field.name: field.key for field in fields(Config.model_validate(document))}


def test_names_that_two_keys_share_have_the_section_before_them():
    alone = keys_of(activities=["walking"], radar=SFCW)
    assert alone["dwell"] == "radar.dwell_s"
    assert keys_of(activities=["grabbing"])["dwell"] == "motion.grabbing.dwell_s"
    both = keys_of(activities=["walking", "grabbing"], radar=SFCW)
    assert "dwell" not in both
    assert (both["radar_dwell"], both["motion_dwell"]) == (
        "radar.dwell_s",
        "motion.grabbing.dwell_s",
    )


def test_a_class_called_grab_shares_no_name_with_the_grabbing_of_the_twelve():
    timing = {"grab_start_s": 0.5}
    named = keys_of(classes={"grab": ["a.bvh"]}, activities=["grabbing", "grab"], timing=timing)
    assert "grab_start" not in named
    assert named["timing_grab_start"] == "timing.grab_start_s"
    assert named["classes_grab_start"] == "classes.grab.start"
    assert named["grab_mirror"] == "classes.grab.mirror"


def test_elements_of_an_array_are_named_after_their_row_and_axis():
    named = keys_of(radar={"cfg": boards.CFG, "array": ARRAY}, duration_s=0.5)
    assert named["array_tx_2_up"] == "radar.array.tx.2.1"
    assert named["array_rx_3_left"] == "radar.array.rx.3.0"
