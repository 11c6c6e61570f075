"""Cadence-velocity diagrams: closed forms, a swinging point, a walker's steps."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config.data_set import Config
from radhar_cli.dataset.layout import column_axis, row_axis
from radhar_cli.errors import ConfigError, RadharError
from radhar_cli.processing.cadence import MIN_CADENCE_WINDOWS, cadence_map
from radhar_cli.processing.doppler_power import compute_stft_power
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.power_map import Axis, PowerMap
from radhar_cli.processing.signal import Signal
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.scene.products.run import record
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.scene import nominal_scene
from radhar_cli.scene.single.request import map_names
from radhar_cli.scene.single.simulate import simulate

RATE = 40.0  # windows a second


def doppler_time(amplitude: Any, times: Any) -> PowerMap:
    """Doppler-time map of rows of amplitudes [row, window]."""
    rows = Axis("frequency", "Hz", np.arange(len(amplitude)) * 10.0)
    return PowerMap(np.array(amplitude) ** 2, rows, Axis("time", "s", times))


@settings(max_examples=30, deadline=None)
@given(
    cadence=st.floats(0.8, 7.5),
    swing=st.floats(0.01, 0.9),
    phase=st.floats(0, 6.28),
    seconds=st.floats(5, 12),
)
def test_an_amplitude_that_swings_reads_its_square_at_its_cadence(
    cadence: float, swing: float, phase: float, seconds: float
) -> None:
    t = np.arange(int(seconds * RATE)) / RATE + 3
    amplitude = 1 + swing * np.cos(2 * np.pi * cadence * t + phase)
    diagram = cadence_map(doppler_time([amplitude, np.ones(t.size)], t), 8.0)
    peak = diagram.power[0].argmax()
    assert diagram.columns.values[peak] == pytest.approx(cadence, abs=0.3 / seconds)
    assert diagram.power[0, peak] == pytest.approx(swing**2, rel=0.05)
    assert diagram.power[1].max() < 1e-24


def test_windows_that_are_missing_count_nothing() -> None:
    t = np.arange(400) / RATE
    swing = 1 + 0.5 * np.cos(2 * np.pi * 2 * t)
    present = np.abs(t - 4) > 1
    diagram = cadence_map(doppler_time(swing[None, present], t[present]), 8.0)
    peak = diagram.power[0].argmax()
    assert diagram.columns.values[peak] == pytest.approx(2, abs=0.1)
    assert diagram.power[0, peak] == pytest.approx(0.25, rel=0.05)


@pytest.mark.parametrize(("highest", "end"), [(8.0, 8.0), (1e3, RATE / 2), (1e-6, None)])
def test_the_diagram_ends_where_it_is_told_or_at_half_the_windows(
    highest: float, end: float | None
) -> None:
    t = np.arange(200) / RATE
    cadences = cadence_map(doppler_time(np.ones((3, t.size)), t), highest).columns.values
    assert cadences[0] == 0
    assert cadences[-1] == pytest.approx(1 / 20 if end is None else end, abs=1 / 20)


@pytest.mark.parametrize("count", [1, 2, MIN_CADENCE_WINDOWS - 1])
def test_too_few_windows_are_refused(count: int) -> None:
    with pytest.raises(
        RadharError, match=f"at least {MIN_CADENCE_WINDOWS} windows; it has {count}"
    ):
        cadence_map(doppler_time(np.ones((2, count)), np.arange(count) / RATE), 8.0)


def test_a_swinging_point_has_its_cadence_and_harmonics() -> None:
    prf, cadence, fastest = 1000.0, 1.3, 100.0
    t = np.arange(8000) / prf
    phase = fastest / cadence * np.sin(2 * np.pi * cadence * t)
    signal = Signal(np.exp(1j * phase)[None, None], PulseTimes.even(t.size, prf), 1e10)
    stft = compute_stft_power(signal, Frames(64, 16)).as_map()
    diagram = cadence_map(stft, 8.0)
    hertz, speeds = diagram.columns.values, diagram.rows.values

    def strongest(row: float) -> float:
        return float(hertz[diagram.power[np.abs(speeds - row).argmin()].argmax()])

    for turning in (fastest, -fastest):  # one side once a swing, the middle twice
        assert strongest(turning) == pytest.approx(cadence, abs=0.05)
    assert strongest(0) == pytest.approx(2 * cadence, abs=0.05)
    total = diagram.power.sum(axis=0)
    between = np.abs(hertz / cadence - np.rint(hertz / cadence)) > 0.3
    on = np.abs(hertz / cadence - np.rint(hertz / cadence)) < 0.05
    assert total[on & (hertz > 1)].min() > 30 * total[between & (hertz > 1)].max()


def config_of(**keys: Any) -> Config:
    document = {"activities": ["walking"], "duration_s": 6.0, "maps": ["stft", "stft_cadence"]}
    return Config.model_validate(document | keys)


def strides_a_second(simulation: Any) -> float:
    """Cadence of the true skeleton's right ankle about the torso, Hz."""
    names = [*simulation.motion.names]
    positions, time = simulation.truth.positions, simulation.truth.time
    ahead = positions[:, names.index("right_ankle"), 0] - positions[:, 0, 0]
    even = ahead - ahead.mean()
    spectrum = np.abs(np.fft.rfft(even * np.hanning(even.size), 16 * even.size))
    hertz = np.fft.rfftfreq(16 * even.size, time[1] - time[0])
    return float(hertz[spectrum.argmax()])


def test_a_walker_s_steps_are_found() -> None:
    config = config_of(
        motion={"range_m": 8.0, "cross_range_m": 0.0, "angle_deg": 180.0},
        snr_db=None,
        image={"doppler_limits_mps": [1.8, 6.0]},
    )
    simulation = simulate(config, nominal=True, maps=("stft_cadence",))
    diagram = simulation.maps["stft_cadence"]
    cadence = diagram.columns.values
    over_speeds = diagram.power.sum(axis=0) * (cadence > 1.0)  # of a leg that swings
    steps = 2 * strides_a_second(simulation)
    assert cadence[over_speeds.argmax()] == pytest.approx(steps, rel=0.1)


def test_an_image_of_a_map_is_the_same_beside_its_cadences() -> None:
    config = config_of(duration_s=3.0, radar={"prf_hz": 2000})
    scene = nominal_scene(config, config.chosen_activities[0])
    alone = scene.config.model_copy(update={"maps": ("stft",)})
    image, other = (
        record(replace(scene, config=one), ["image:stft"])["image:stft"]
        for one in (scene.config, alone)
    )
    assert (image.levels == other.levels).all()
    assert image.entropy == other.entropy


def test_both_images_are_made_of_one_transform() -> None:
    names = [product.name for product in plan_images(config_of()).products]
    assert names.count("power:stft") == 1
    assert "stft" not in names
    alone = {product.name: product for product in plan_images(config_of(maps=["stft"])).products}
    assert alone["power:stft"].does.endswith("when read")  # as one image alone reads it
    held = {product.name: product for product in plan_images(config_of()).products}
    assert held["power:stft"].does.endswith("held")


def test_axes_of_a_data_set_are_doppler_and_cadence() -> None:
    assert row_axis("fsst_denoised_cadence") == ("Doppler frequency", "Hz")
    assert column_axis("fsst_denoised_cadence") == ("cadence", "Hz")


@pytest.mark.parametrize(
    "radar",
    [
        {},
        {"waveform": "sfcw", "steps": 64, "dwell_s": 2e-6, "prf_hz": 1000},
        {"waveform": "cw", "prf_hz": 1000},
        {
            "waveform": "impulse",
            "output": "iq",
            "bandwidth_hz": 1.5e9,
            "carrier_hz": 7e9,
            "profile_m": [0.4, 9],
            "profile_samples": 160,
            "prf_hz": 200,
        },
    ],
    ids=["fmcw", "sfcw", "cw", "impulse"],
)
def test_every_radar_with_a_doppler_map_has_its_cadences(radar: dict[str, Any]) -> None:
    config = config_of(radar=radar, duration_s=2.0, maps=["stft_cadence", "fsst_denoised_cadence"])
    for power_map in simulate(config, nominal=True).maps.values():
        assert power_map.columns.name == "cadence"
        assert power_map.power.any()


def test_labels_of_columns_and_other_words_are_refused() -> None:
    with pytest.raises(ValueError, match="should be false with stft_cadence, whose columns"):
        config_of(output={"column_labels": True})
    with pytest.raises(ValueError, match="adds up powers of bins"):
        config_of(maps=["fsst_cadence"], processing={"range_sum": "gated"})
    with pytest.raises(ConfigError, match="is called stft_cadence"):
        map_names(["cvd"], config_of())
