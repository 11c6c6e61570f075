"""Numbers and keys in other units are told in ours, over all units that keys of the schema have."""

import pytest

from radhar_cli.config import Config, load_config
from radhar_cli.config.units import UNITS, factor_of, key_in_our_unit, unit_of, value_with_unit
from radhar_cli.errors import ConfigError
from radhar_cli.schema.annotations import annotations

KEYS = {unit_of(key): key for key in annotations(Config) if unit_of(key)}


def message(tmp_path, *sets: str) -> str:
    (tmp_path / "c.yaml").write_text("duration_s: 1\n")
    with pytest.raises(ConfigError) as refused:
        load_config(tmp_path / "c.yaml", sets)
    return str(refused.value)


def test_every_unit_of_the_schema_is_known() -> None:
    assert {*KEYS} == {*UNITS}


@pytest.mark.parametrize(
    ("key", "value", "right"),
    [
        ("radar.prf_hz", "3.5 kHz", "3500, a number in Hz"),
        ("radar.carrier_hz", "24GHz", "24e9, a number in Hz"),
        ("radar.carrier_hz", "77.5 ghz", "77.5e9, a number in Hz"),
        ("radar.bandwidth_hz", "250 MHz", "250e6, a number in Hz"),
        ("radar.chirp_s", "60 us", "60e-6, a number in s"),
        ("radar.chirp_s", "60 µs", "60e-6, a number in s"),
        ("duration_s", "4 s", "4, a number in s"),
        ("duration_s", "2 min", "120, a number in s"),
        ("motion.range_m", "250 cm", "2.5, a number in m"),
        ("motion.walking.speed_mps", "3.6 km/h", "1, a number in m/s"),
        ("motion.angle_deg", "180°", "180, a number in deg"),
        ("subject.weight_kg", "80 kg", "80, a number in kg"),
        ("snr_db", "20 dB", "20, a number in dB"),
        ("engine.tolerance_db", "-80dB", "-80, a number in dB"),
        ("radar.tx_m", "[40 cm, 0, 1]", "0.4, a number in m"),
    ],
)
def test_a_value_with_a_unit_is_told_in_ours(key: str, value: str, right: str, tmp_path) -> None:
    assert f"should be {right}" in message(tmp_path, f"{key}={value}")


@pytest.mark.parametrize(
    ("key", "value", "right"),
    [
        ("radar.carrier_ghz", 24, "carrier_hz: 24e9, a number in Hz"),
        ("radar.bandwidth_mhz", 250, "bandwidth_hz: 250e6, a number in Hz"),
        ("radar.chirp_us", 60, "chirp_s: 60e-6, a number in s"),
        ("duration_ms", 4000, "duration_s: 4, a number in s"),
        ("subject.height_cm", 175, "height_m: 1.75, a number in m"),
        ("motion.walking.speed_kmh", 3.6, "speed_mps: 1, a number in m/s"),
        ("motion.angle_rad", 3.141592653589793, "angle_deg: 180, a number in deg"),
        ("motion.range_cm", "{uniform: [100, 200]}", "range_m, 0.01 times the value, in m"),
    ],
)
def test_a_key_in_another_unit_is_told_in_ours(key: str, value, right: str, tmp_path) -> None:
    assert f"is an unknown key; should be {right}" in message(tmp_path, f"{key}={value}")


@pytest.mark.parametrize("unit", UNITS)
def test_every_key_is_found_by_its_other_units(unit: str) -> None:
    """Each other spelling of a unit leads to the key, and a value of it to the same number."""
    key = KEYS[unit]
    name = next(part for part in reversed(key.split(".")) if unit_of(f".{part}"))
    stem = name.rpartition("_")[0]
    others = [one for one in UNITS[unit][1] if one.isalpha()]
    others += [prefix + unit for prefix in "kmu"] if unit in ("hz", "s", "m") else []
    for other in others:
        factor = factor_of(other, unit)
        assert factor is not None
        advice = key_in_our_unit(f"{stem}_{other}", 3, [name, "other_key"])
        assert advice is not None
        assert advice.startswith(f"should be {name}: ")
        told = value_with_unit(key, f"3 {other}")
        assert told is not None
        assert float(told.split(",")[0].removeprefix("should be ")) == pytest.approx(3 * factor)
    assert value_with_unit(key, "3 parsecs") is None
    assert value_with_unit(key, "three") is None


def test_a_text_in_the_place_of_a_number_is_told_the_range(tmp_path) -> None:
    tolerance = message(tmp_path, "engine.tolerance_db=-8O")
    assert "should be a valid number, from -400 to -6" in tolerance
    assert ", from 1000 to 1e+12 Hz" in message(tmp_path, "radar.bandwidth_hz=wide")


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("radar.carrier_hz=24", "should be from 1e+06 to 1e+13 Hz; 24 GHz is 24e9"),
        ("radar.bandwidth_hz=250", "; 250 MHz is 250e6"),
        ("subject.height_m=175", "should be from 0.1 to 10 m; 175 cm is 1.75"),
        ("subject.height_m=1750", "; 1750 mm is 1.75"),
        ("subject.height_m={uniform: [160, 190]}", "; 160 cm is 1.6"),
        ("duration_s=6000", "; 6000 ms is 6"),
    ],
)
def test_a_number_beyond_its_range_is_told_in_the_unit_that_was_meant(
    override: str, words: str, tmp_path
) -> None:
    assert words in message(tmp_path, override)


@pytest.mark.parametrize("override", ["subject.height_m=11000", "radar.carrier_hz=-24"])
def test_a_number_that_no_unit_explains_is_not_explained(override: str, tmp_path) -> None:
    said = message(tmp_path, override)
    assert "should be" in said
    assert ";" not in said


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("carrier_ghz=24", "is an unknown key; should be radar.carrier_hz: 24e9, a number in Hz"),
        ("prf_khz=3.5", "should be radar.prf_hz: 3500, a number in Hz"),
        ("height_cm=175", "should be subject.height_m: 1.75, a number in m"),
        ("carrier=24e9", "did you mean 'radar.carrier_hz'?"),
        ("split.by=persons", "should be subject: split: {by: subject, subjects: 4}"),
        ("split.persons=4", "is called subjects: split: {by: subject, subjects: 4}"),
    ],
)
def test_a_key_of_a_section_is_named_once_with_its_path(
    override: str, words: str, tmp_path
) -> None:
    said = message(tmp_path, override)
    assert said.endswith(words)
    assert " or " not in said.replace("radar.carrier_hz'?", "")
