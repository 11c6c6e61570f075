"""`processing.range_window`: the window before range compression, of both engines and of noise."""

from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

from radhar_cli.config.data_set import Config
from radhar_cli.config.reading import load_config
from radhar_cli.echo.gated import kernel, windowed_kernel
from radhar_cli.echo.receiver.noise import WhiteNoise, white_noise
from radhar_cli.errors import ConfigError
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.processing.canceller import MeanRemoval
from radhar_cli.processing.look import Look, RangeBins, RangeSum, noise_gain
from radhar_cli.radar.chirp_window import ChirpWindow, WindowName
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.scene.checks.visibility import cell_gain_db
from radhar_cli.scene.products.run import Results, record
from radhar_cli.scene.scene import draw_scene

NAMES = get_args(WindowName)
RADAR = {"carrier_hz": 24e9, "bandwidth_hz": 1e9, "prf_hz": 1000, "adc_rate_hz": 2.55e6}
WAVEFORM = Waveform(24e9, 1e9, 40e-6, 2.55e6, 1000, 1.0)  # 102 samples


def config(processing: dict[str, Any], **more: Any) -> Config:
    document = {
        "radar": RADAR,
        "duration_s": 2.0,
        "snr_db": None,
        "motion": {"range_m": 4.0},
        "processing": processing,
    }
    return Config.model_validate(document | more)


def made(chosen: Config, *names: str, activity: str = "walking") -> Results:
    return record(draw_scene(chosen, activity_named(activity), 0), names)


@pytest.mark.every(4)
@pytest.mark.parametrize("range_sum", ["coherent", "gated"])
@pytest.mark.parametrize("length", [None, 256])
@pytest.mark.parametrize("name", NAMES)
def test_engines_agree_whatever_the_window(name, length, range_sum):
    processing = {"range_window": name, "range_fft_length": length, "range_sum": range_sum}
    fast = made(config(processing), "stft", "rtm", "accuracy")
    exact = made(config(processing, engine={"kind": "cube"}), "stft", "rtm")
    assert fast["accuracy"].error_db < -80
    for key in ("stft", "rtm"):
        difference = np.sqrt(fast[key].power) - np.sqrt(exact[key].power)
        assert np.sum(difference**2) < 1e-8 * np.sum(exact[key].power)


@pytest.mark.parametrize("name", NAMES)
def test_the_kernel_of_a_window_is_the_sum_over_the_samples(name):
    window, u, k = ChirpWindow(name), np.linspace(-0.2, 0.3, 7), np.arange(11, 19)
    found = windowed_kernel(u, k, window.weights(102), 128)
    n = np.arange(102) - 101 / 2
    phase = 2 * np.pi * (k / 128 - u[:, None])
    exact = (window.weights(102) * np.cos(phase[..., None] * n)).sum(axis=-1)
    assert found == pytest.approx(exact, abs=1e-10)
    if name == "rectangular":
        assert found == pytest.approx(kernel(u, k, 102, 128), abs=1e-9)


@pytest.mark.every(3)
@pytest.mark.parametrize("fft_length", [None, 160])
@pytest.mark.parametrize("bins", [None, slice(5, 12)])
@pytest.mark.parametrize("name", ["rectangular", "hann", "taylor"])
def test_noise_has_the_covariance_of_the_window_and_the_power_of_none(name, bins, fft_length):
    """W W^H, whose diagonal is N whatever the window."""
    w = replace(WAVEFORM, window=ChirpWindow(name), fft_length=fft_length)
    look = Look("noise", RangeBins(w, bins), np.arange(0, 60000, 2))
    x = white_noise(look, np.random.default_rng(1))
    found = x @ x.conj().T / x.shape[1]
    compression = RangeBins(w, bins)(np.eye(w.n_adc, dtype=complex))
    exact = compression @ compression.conj().T
    assert np.diag(exact).real == pytest.approx(w.n_adc, rel=1e-12)
    assert np.abs(found - exact).max() < 6 * w.n_adc / np.sqrt(x.shape[1])


@pytest.mark.parametrize("fft_length", [None, 512])
@pytest.mark.parametrize("name", ["hann", "chebyshev"])
def test_noise_in_the_bins_that_count_has_the_covariance_of_the_window(name, fft_length):
    """Wherever these bins are, and in whatever stretches of the pulses."""
    w = replace(WAVEFORM, window=ChirpWindow(name), fft_length=fft_length)
    compression = RangeBins(w, slice(3, 9))(np.eye(w.n_adc, dtype=complex))
    exact = compression @ compression.conj().T
    spans = [slice(0, 0), *[slice(0, 30000)] * 2, slice(20000, 60000), slice(30000, 60000)]
    look = Look("noise", RangeBins(w, slice(3, 9)), range(60000), spans=[*spans, slice(0, 60000)])
    x = white_noise(look, np.random.default_rng(1))
    for pulses in (slice(0, 20000), slice(20000, 30000), slice(30000, 60000)):
        rows = [k for k, span in enumerate(look.spans) if span.start <= pulses.start < span.stop]
        some = x[rows, pulses]
        found = some @ some.conj().T / some.shape[1]
        assert np.abs(found - exact[np.ix_(rows, rows)]).max() < 6 * w.n_adc / np.sqrt(
            some.shape[1]
        )
        later = some[:, 1:] @ some[:, :-1].conj().T / some.shape[1]
        assert np.abs(later).max() < 6 * w.n_adc / np.sqrt(some.shape[1])


@pytest.mark.parametrize("name", ["rectangular", "hann"])
def test_pulses_that_count_by_their_sum_alone_get_the_noise_of_all(name):
    """After the mean is taken out, the pulses shown have the covariance I - 1/M."""
    w = replace(WAVEFORM, window=ChirpWindow(name), duration=12e-3)
    shown, total = np.array([1, 4, 8]), np.zeros((3, 3), complex)
    for seed in range(400):
        look = replace(Look.of_all("noise", RangeBins(w)), columns=shown)
        white = WhiteNoise(0.5, lambda _, seed=seed: np.random.default_rng(seed))
        x = white.apply(np.zeros((w.n_bins, w.n_pulses), complex), look)
        assert np.count_nonzero(x.any(axis=0)) == shown.size + 1
        y = MeanRemoval()(x)[:, shown]
        total += y.T @ y.conj() / (400 * w.n_bins * w.n_adc * 0.25)
    assert w.n_pulses == 12
    assert np.abs(total - (np.eye(3) - 1 / 12)).max() < 6 * 2 / np.sqrt(400 * w.n_bins)


@pytest.mark.parametrize("name", NAMES)
def test_noise_of_the_coherent_sum_is_that_of_its_bins_summed(name):
    w = replace(WAVEFORM, window=ChirpWindow(name))
    summed = RangeBins(w)(np.eye(w.n_adc, dtype=complex)).sum(axis=0)
    assert noise_gain(w) == pytest.approx(float(np.sum(np.abs(summed) ** 2)), rel=1e-12)
    assert RangeSum(w)(np.eye(w.n_adc, dtype=complex))[0] == pytest.approx(summed, abs=1e-9)


def test_doppler_maps_keep_their_snr_and_range_maps_pay_for_the_window():
    gains = {
        name: {
            (key, how): cell_gain_db(
                draw_scene(
                    config({"range_window": name, "range_sum": how}), activity_named("walking"), 0
                ),
                key,
            )
            for key, how in (("stft", "coherent"), ("stft", "gated"), ("rtm", "coherent"))
        }
        for name in ("rectangular", "hann")
    }
    change = {key: gains["hann"][key] - gains["rectangular"][key] for key in gains["hann"]}
    assert change["stft", "coherent"] == pytest.approx(0, abs=0.1)
    assert change["stft", "gated"] == pytest.approx(-1.8, abs=0.05)
    assert change["rtm", "coherent"] == pytest.approx(-1.8, abs=0.05)


def test_the_stripes_of_a_strong_close_person_are_gone():
    """Far from a person, the map is below 1e-6 of its peak in every column; it was at 1e-4."""
    share = {}
    for name in ("rectangular", "hann"):
        rtm = made(
            config({"range_window": name}, image={"range_limits_m": [0, 15]}),
            "rtm",
            activity="punching",
        )["rtm"]
        far = rtm.power[rtm.rows.values > 6.5]
        share[name] = far.max() / rtm.power.max()
    assert share["hann"] < 1e-6 < 1e-5 < share["rectangular"]


def test_a_gate_keeps_out_who_is_not_in_it():
    def power(name: str, at: float) -> float:
        processing = {"range_window": name, "range_sum": "gated", "gate_m": [3, 5]}
        chosen = config(processing, motion={"range_m": at})
        return float(made(chosen, "stft", activity="punching")["stft"].power.sum())

    leak = {name: power(name, 7.0) / power(name, 4.0) for name in ("rectangular", "hann")}
    assert leak["hann"] < 1e-6 < 1e-5 < leak["rectangular"]


def test_defaults_are_hann_of_people_and_none_of_the_paper():
    assert config({}).processing.range_window == "hann"
    assert config({}, motion={"model": "paper"}).processing.range_window == "rectangular"
    start = config({"range_reference": "start"})
    assert start.processing.range_window == "rectangular"
    both = {"range_reference": "start", "range_window": "hann", "range_sum": "gated"}
    assert config(both).processing.range_window == "hann"


@pytest.mark.parametrize(
    ("processing", "words"),
    [
        ({"range_reference": "start", "range_window": "hann"}, "reads the ends of a chirp"),
        ({"range_window": "hanning"}, "'hann'"),
        ({"range_window": "taylor", "range_sidelobes_db": 5}, "range_sidelobes_db"),
    ],
    ids=str,
)
def test_windows_that_leave_nothing_or_are_none_are_refused(processing, words, tmp_path: Path):
    import yaml

    path = tmp_path / "wrong.yaml"
    path.write_text(yaml.safe_dump({"radar": RADAR, "processing": processing}))
    with pytest.raises(ConfigError, match=words):
        load_config(path)


def test_a_board_has_the_window_in_its_range_time_map_and_not_in_its_frames():
    import radhar_cli.config

    cfg = (Path(radhar_cli.config.__file__).parent / "radars" / "iwr1443boost.cfg").read_text()
    document = {
        "radar": {"cfg": cfg, "device": "IWR1443BOOST"},
        "duration_s": 0.5,
        "motion": {"range_m": 2.5},
        "receiver": {"noise_figure_db": None},
        "maps": ["rtm", "range_doppler"],
    }
    results = {
        name: made(
            Config.model_validate(document | {"processing": {"range_window": name}}),
            "rtm",
            "range_doppler",
            activity="punching",
        )
        for name in ("rectangular", "hann")
    }
    share = {}
    for name, found in results.items():
        rtm = found["rtm"]
        share[name] = rtm.power[-1].max() / rtm.power.max()
    assert share["hann"] < 0.1 * share["rectangular"]
    frames = [found["range_doppler"].power for found in results.values()]
    assert np.array_equal(*frames)
