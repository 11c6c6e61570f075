"""A radar that sweeps without a pause: a sweep is as long as the pulse interval."""

from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.assembly.radar import waveform_of
from radhar_cli.config import Config
from radhar_cli.scene import nominal_scene


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
