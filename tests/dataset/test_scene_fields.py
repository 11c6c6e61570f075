"""Drawn numbers as columns: one for every key, in SI units beside the units of the config."""

from math import pi

import numpy as np
import pytest

from radhar_cli.activity import ACTIVITIES, activity_named
from radhar_cli.config import Config
from radhar_cli.dataset.scene_fields import fields, values
from radhar_cli.scene import draw_scene, numbers, scene_numbers

EVERYTHING = Config(motion={"model": "paper"}, wall={})


@pytest.mark.parametrize(
    ("key", "name", "unit", "factor"),
    [
        ("radar.carrier_hz", "carrier", "Hz", 1),
        ("radar.rx_m.2", "rx_z", "m", 1),
        ("radar.antenna_gain_dbi", "antenna_gain", "dBi", 1),
        ("subject.height_m", "height", "m", 1),
        ("motion.angle_deg", "angle", "rad", pi / 180),
        ("motion.speed_mps", "speed", "m/s", 1),
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
    assert not any(key.startswith(("timing.", "wall.")) for key in keys)
    assert {"snr_db", "motion.speed_mps"}.isdisjoint(keys)
    assert {"subject.weight_kg", "motion.range_m"} <= keys


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
    speed = [field.key for field in columns].index("motion.speed_mps")
    assert np.isnan(table[0, speed])
    assert table[1, speed] == 1.5
