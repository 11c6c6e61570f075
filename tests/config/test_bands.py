"""Warnings of a band whose middle is written as its lower end."""

import pytest

from radhar_cli.config import Config
from radhar_cli.config.checks.doubts import band_warnings


def warnings_of(carrier_hz: float, output: str) -> list[str]:
    radar = {"waveform": "impulse", "output": output, "carrier_hz": carrier_hz}
    rest = {"bandwidth_hz": 1.5e9, "profile_m": [0.3, 6], "profile_samples": 900, "prf_hz": 400}
    return band_warnings(Config.model_validate({"radar": radar | rest, "maps": ["rtm"]}))


@pytest.mark.parametrize("middle_hz", [7.29e9, 8.748e9])
def test_the_middle_of_an_X4s_band_is_no_lower_end(middle_hz: float) -> None:
    (line,) = warnings_of(middle_hz, "iq")
    assert f"is taken as its lower end: the radar's middle is {middle_hz + 0.75e9:g}" in line
    assert f"should be {middle_hz - 0.75e9:g}" in line
    assert not warnings_of(middle_hz - 0.75e9, "iq")
    assert not warnings_of(middle_hz, "rf")
