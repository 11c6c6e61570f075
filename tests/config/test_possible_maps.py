"""Each radar is asked for maps that it cannot make: one line says why, and which it makes."""

import json
from typing import Any

import pytest
from helpers.boards import CFG

from radhar_cli.config.data_set import Config
from radhar_cli.config.maps import KNOWN_MAPS, without_cadences
from radhar_cli.config.offered_maps import possible_maps
from radhar_cli.config.reading import load_config
from radhar_cli.errors import ConfigError
from radhar_cli.scene.single.simulate import simulate

GATED = {"processing": {"range_sum": "gated"}}
IMPULSE = {
    "waveform": "impulse",
    "carrier_hz": 7e9,
    "profile_m": [0, 9],
    "profile_samples": 1500,
}
RADARS: dict[str, dict[str, Any]] = {
    "fmcw": {},
    "fmcw, gated": GATED,
    "sfcw": {"radar": {"waveform": "sfcw", "steps": 64, "dwell_s": 1e-6, "prf_hz": 5e3}},
    "cw": {"radar": {"waveform": "cw", "prf_hz": 500}},
    "cw, real": {"radar": {"waveform": "cw", "output": "real", "prf_hz": 500}},
    "impulse": {"radar": IMPULSE, "maps": ["rtm"]},
    "impulse, gated": {"radar": IMPULSE} | GATED,
    "impulse, iq": {"radar": {**IMPULSE, "output": "iq", "profile_samples": 200}},
    "board": {"radar": {"device": "IWR1443BOOST", "cfg": CFG}},
    "board, coherent": {
        "radar": {"device": "IWR1443BOOST", "cfg": CFG},
        "processing": {"range_sum": "coherent"},
    },
}
# Of maps that a radar cannot make, the key that is at fault.
AT_FAULT = {
    ("cw", "rtm"): "radar.waveform: cw has no range",
    ("cw, real", "stft_compensated"): "radar.output: real has no sign",
    ("impulse", "stft"): "stft needs processing.range_sum: gated",
    ("impulse, gated", "fsst"): "radar.waveform: impulse takes real samples",
    ("fmcw, gated", "fsst"): "processing.range_sum: gated adds up powers",
    ("board", "fsst"): "processing.range_sum: gated, the default of boards, adds up powers",
    ("sfcw", "range_doppler"): "range_doppler is of the frames of a board (radar.cfg",
}


@pytest.mark.parametrize("name", RADARS)
def test_a_map_is_made_or_refused_in_a_line_that_lists_those_there_are(name: str) -> None:
    made = possible_maps(Config.model_validate(RADARS[name]))
    for asked in KNOWN_MAPS:
        document = RADARS[name] | {"maps": [asked]}
        if asked in made:
            assert Config.model_validate(document).maps == (asked,)
            continue
        with pytest.raises(ValueError, match="should be some of") as caught:
            Config.model_validate(document)
        line = str(caught.value)
        listed = line.partition("should be some of ")[2].partition(":")[0].split(", ")
        assert listed == without_cadences([one for one in made if one != "cube"])
        assert AT_FAULT.get((name, asked), "") in line


@pytest.mark.parametrize(("name", "asked"), AT_FAULT)
def test_simulate_says_the_same(name: str, asked: str) -> None:
    config = Config.model_validate(RADARS[name])
    with pytest.raises(ConfigError) as caught:
        simulate(config, "walking", maps=(asked,))
    assert str(caught.value).startswith(f"maps = {json.dumps([asked])}: should be some of ")
    assert AT_FAULT[name, asked] in str(caught.value)


def test_a_config_names_its_line(tmp_path: Any) -> None:
    path = tmp_path / "cw.yaml"
    path.write_text("radar: {waveform: cw, prf_hz: 500}\nmaps: [rtm]\n")
    with pytest.raises(ConfigError) as caught:
        load_config(path)
    assert str(caught.value).startswith(f'{path}:2: maps = ["rtm"]: should be some of stft, ')
    assert "gated" not in str(caught.value)
