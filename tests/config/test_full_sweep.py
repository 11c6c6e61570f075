"""A radar that sweeps without a pause: a sweep is as long as the pulse interval."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from radhar_cli.config import Config
from radhar_cli.scene.radar import waveform_of
from radhar_cli.scene.scene import nominal_scene


def sweeping(prf_hz: float, chirp_s: float, adc_rate_hz: float = 128e3) -> Config:
    """Config of a 24 GHz radar."""
    radar: dict[str, Any] = {"carrier_hz": 24e9, "bandwidth_hz": 400e6, "prf_hz": prf_hz}
    radar |= {"adc_rate_hz": adc_rate_hz, "chirp_s": chirp_s}
    keys = {"radar": radar, "maps": ["stft"], "motion": {"range_m": 3}}
    return Config.model_validate(keys)


def test_all_128_samples_of_a_sweep_are_taken() -> None:
    config = sweeping(1000, 1e-3)
    assert waveform_of(nominal_scene(config, config.chosen_activities[0])).n_adc == 128


@given(st.integers(100, 5000), st.integers(16, 1024))
def test_a_sweep_may_be_as_long_as_the_interval(prf_hz: int, samples: int) -> None:
    config = sweeping(prf_hz, 1 / prf_hz, samples * prf_hz)
    assert waveform_of(nominal_scene(config, config.chosen_activities[0])).n_adc == samples


@pytest.mark.parametrize(
    ("chirp_s", "bound"), [(1.0000001e-3, "0.001"), (1.1e-3, "0.001"), (1 / 999, "0.001")]
)
def test_a_sweep_that_is_too_long_reads_otherwise_than_its_interval(
    chirp_s: float, bound: str
) -> None:
    with pytest.raises(ValidationError, match=rf"1/prf_hz = {bound} s"):
        sweeping(1000, chirp_s)


def test_an_interval_that_has_no_end_is_written_until_it_differs_from_the_sweep() -> None:
    with pytest.raises(ValidationError, match=r"1/prf_hz = 0\.0003335557 s"):
        sweeping(2998, 0.000333556, 3e6)
