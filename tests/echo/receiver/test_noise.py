"""Receiver noise: its power, its colour, and that both engines have the same."""

from dataclasses import asdict
from itertools import combinations

import numpy as np
import pytest
from helpers import reference as ref
from scipy.stats import expon, ks_2samp, kstest

from radhar_cli.config.data_set import Config
from radhar_cli.config.maps import MAP_NAMES
from radhar_cli.echo.receiver.noise import (
    WhiteNoise,
    circular_gaussian,
    noise_variance,
    white_noise,
)
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.processing.look import (
    FastTime,
    Look,
    RangeBins,
    RangeSum,
    RawSamples,
)
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.products.run import Results, run
from radhar_cli.scene.products.run import record as record_scene
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.scene import Scene, draw_scene, scene_numbers

# 20 samples a chirp and 20 000 pulses: enough for statistics, little to compute.
RADAR = {"carrier_hz": 24e9, "bandwidth_hz": 1e9, "prf_hz": 5000, "adc_rate_hz": 5e5}
PULSES, SAMPLES = 20000, 20
SIGMAS = 5  # a mean of N numbers of variance v lies within 5 sqrt(v/N), but once in a million

engines = pytest.mark.parametrize("engine", ["cube", "direct"])


def scene_of(
    engine: str = "direct", slug: str = "walking", index: int = 0, **more: object
) -> Scene:
    document = {"radar": RADAR, "engine": {"kind": engine}, "duration_s": 4.0} | more
    windowless = {"range_window": "rectangular"}  # of windows: scene/products/test_range_window.py
    document["processing"] = windowless | dict(document.get("processing", {}))
    return draw_scene(Config.model_validate(document), activity_named(slug), index)


def record(engine: str, *products: str, **more: object) -> Results:
    return record_scene(scene_of(engine, **more), products)


def sigma_of(engine: str, **more: object) -> float:
    """Standard deviation of the noise of a raw sample."""
    return record(engine, "noise", **more)["noise"].sigma


def noise_of(product: str, engine: str, **more: object) -> tuple[np.ndarray, float]:
    """What noise adds to a product, and the standard deviation sigma of the raw noise."""
    noisy = record(engine, product, "noise", **more)
    clean = record(engine, product, **more | {"snr_db": None})
    noise = (noisy[product].x - clean[product].x)[0]
    return noise if product == "range_profiles" else noise[0], noisy["noise"].sigma


def alone(white: WhiteNoise, fast: FastTime, name: str = "any") -> np.ndarray:
    """What noise adds to an echo of zero, as all pulses show it [K, M]."""
    look = Look.of_all(name, fast)
    return white.apply(np.zeros((fast.rows, look.count), complex), look)


def correlation(x: np.ndarray, lag: int) -> complex:
    """Mean of x[m + lag] conj x[m] over that of |x|^2, along the last axis."""
    later, earlier = x[..., lag:], x[..., : x.shape[-1] - lag]
    return complex(np.mean(later * earlier.conj()) / np.mean(np.abs(x) ** 2))


def waveform() -> Waveform:
    return Waveform(**asdict(ref.Radar(adc_rate=5e5, duration=4.0)))


def gain() -> float:
    return float(np.sum(np.abs(ref.sample_weights(ref.Radar(adc_rate=5e5))) ** 2))


def free_space_power(scene: Scene) -> float:
    """Mean over the pulses of sum_i G^2 lambda^2 sigma_i/((4 pi)^3 R_tx^2 R_rx^2)."""
    motion, v = motion_of(scene.people[0]), scene_numbers(scene)
    t = np.arange(round(v["duration_s"] * v["radar.prf_hz"])) / v["radar.prf_hz"]
    p = motion.positions(t)
    legs2 = [
        sum((p[axis] - v[f"radar.{antenna}_m.{axis}"]) ** 2 for axis in range(3))
        for antenna in ("tx", "rx")
    ]
    gain = 10 ** (v["radar.antenna_gain_dbi"] / 10)
    wavelength = ref.C / v["radar.carrier_hz"]
    strength = gain**2 * wavelength**2 * motion.cross_sections(t) / (4 * np.pi) ** 3
    return float(np.mean(np.sum(strength / (legs2[0] * legs2[1]), axis=0)))


def test_unit_noise_is_circular_gaussian_and_white():
    v = circular_gaussian(np.random.default_rng(1), (400, 1000))
    assert v.shape == (400, 1000)
    error = SIGMAS / np.sqrt(v.size)  # of a mean of numbers of variance 1
    assert np.mean(np.abs(v) ** 2) == pytest.approx(1, abs=error)  # |v|^2 has variance 1
    assert abs(np.mean(v)) < error
    assert abs(np.mean(v**2)) < 2 * error  # v^2 has variance 2
    for part in (v.real, v.imag):
        assert kstest(part.ravel() * np.sqrt(2), "norm").pvalue > 1e-3
    assert abs(correlation(v, 1)) < error
    assert abs(correlation(v.T, 1)) < error


@pytest.mark.parametrize(
    ("snr_db", "variance"), [(0, 2.0), (10, 0.2), (30, 0.002), (-10, 20.0), (3, 1.002374)]
)
def test_the_variance_is_the_signal_power_over_the_snr(snr_db: float, variance: float) -> None:
    assert noise_variance(2.0, snr_db) == pytest.approx(variance, rel=1e-6)


class TestPower:
    """sigma_n^2 = P_s/10^(SNR/10) per raw sample."""

    @engines
    @pytest.mark.parametrize("snr_db", [30, -10])
    @pytest.mark.parametrize("wall", [None, {}], ids=["free space", "wall"])
    def test_free_space_reference(self, engine, snr_db, wall):
        """P_s leaves the wall out, so that a wall costs SNR."""
        more = {"snr_db": snr_db, "wall": wall, "duration_s": 1.0}
        right = free_space_power(scene_of(engine, **more)) / 10 ** (snr_db / 10)
        assert sigma_of(engine, **more) ** 2 == pytest.approx(right, rel=1e-6)

    @engines
    def test_received_reference(self, engine):
        more = {"snr_db": 10, "wall": {}, "duration_s": 1.0, "snr_reference": "received"}
        recording = record(engine, "noise", "paths", "waveform", **more)
        t = np.arange(recording["waveform"].n_pulses) / RADAR["prf_hz"]
        right = np.mean(np.sum(recording["paths"](t).amplitude ** 2, axis=0)) / 10
        assert recording["noise"].sigma ** 2 == pytest.approx(right, rel=1e-6)
        # The paper's wall takes 9.8 dB at 2 GHz and more at 24 GHz, of what is behind it.
        assert recording["noise"].sigma ** 2 < 0.5 * free_space_power(scene_of(**more)) / 10

    @engines
    def test_received_is_free_space_without_a_wall(self, engine):
        sigmas = [
            sigma_of(engine, snr_reference=reference, duration_s=0.5)
            for reference in ("received", "free_space")
        ]
        assert sigmas[0] == sigmas[1] > 0

    def test_raw_samples(self):
        """Per sample sigma^2; white in fast time and slow time, in blocks of any length."""

        def noise(length):
            white = WhiteNoise(0.7, lambda name: np.random.default_rng(7))
            waveform = Waveform(**asdict(ref.Radar(adc_rate=5e5, duration=1.0)))
            look, empty = Look.of_all("any", RawSamples(waveform)), np.zeros((SAMPLES, length))
            firsts = range(0, 5000, length)
            return np.hstack([white.apply(empty, look.part(at, at + length)) for at in firsts])

        whole = noise(5000)
        assert whole.shape == (SAMPLES, 5000)
        assert np.array_equal(noise(8), whole)
        error = SIGMAS / np.sqrt(whole.size)
        assert np.mean(np.abs(whole) ** 2) == pytest.approx(0.7**2, rel=error)
        assert np.mean(np.abs(whole) ** 2, axis=1) == pytest.approx(0.49, rel=SIGMAS / np.sqrt(5e3))
        assert abs(correlation(whole, 1)) < error
        assert abs(correlation(whole.T, 1)) < error


class TestSlowTime:
    """After the sum over bins: a linear map of white noise."""

    error = SIGMAS / np.sqrt(PULSES)

    @engines
    def test_before_mti(self, engine):
        v, sigma = noise_of("signal", engine, processing={"clutter": "none"})
        assert v.size == PULSES
        # |v|^2 is exponential: its standard deviation is its mean.
        assert np.mean(np.abs(v) ** 2) == pytest.approx(sigma**2 * gain(), rel=self.error)
        assert [abs(correlation(v, lag)) for lag in (1, 2, 3, 50)] == pytest.approx(
            [0] * 4, abs=self.error
        )
        assert abs(np.mean(v**2)) / np.mean(np.abs(v) ** 2) < self.error * np.sqrt(2)
        scaled = v / (sigma * np.sqrt(gain() / 2))
        assert kstest(scaled.real, "norm").pvalue > 1e-3
        assert kstest(scaled.imag, "norm").pvalue > 1e-3

    @pytest.mark.parametrize(
        "radar",
        [
            ref.Radar(adc_rate=5e5, duration=4.0, fft_length=256),
            ref.Radar(adc_rate=2.75e5, duration=4.0),
            ref.Radar(adc_rate=2.75e5, duration=4.0, fft_length=32, centred=False),
        ],
        ids=["zero-padded", "odd", "odd, zero-padded, start"],
    )
    def test_gain_of_compression_and_sum(self, radar):
        """sum |D[n]|^2, which is N_ADC N_FFT/2 only where N_FFT is N_ADC."""
        waveform = Waveform(**asdict(radar))
        white = WhiteNoise(1.0, lambda name: np.random.default_rng(8))
        v = alone(white, RangeSum(waveform))[0]
        right = np.sum(np.abs(ref.sample_weights(radar)) ** 2)
        assert abs(right / (radar.n_adc * radar.n_fft / 2) - 1) > 2 * self.error
        assert np.mean(np.abs(v) ** 2) == pytest.approx(right, rel=self.error)

    @engines
    def test_after_mti(self, engine):
        x, sigma = noise_of("signal", engine)
        assert x.size == PULSES - 1
        error = self.error * np.sqrt(2)  # neighbours are correlated
        assert np.mean(np.abs(x) ** 2) == pytest.approx(2 * sigma**2 * gain(), rel=error)
        found = [correlation(x, lag) for lag in (1, 2, 3, 50)]
        assert np.abs(np.array(found) - [-0.5, 0, 0, 0]).max() < error
        assert abs(np.mean(x**2)) / np.mean(np.abs(x) ** 2) < error * np.sqrt(2)

    @pytest.mark.parametrize("mti", [True, False])
    def test_engines_have_the_same_law(self, mti):
        """Every other sample: after MTI those are independent."""
        both = [
            noise_of("signal", engine, processing={"clutter": "difference" if mti else "none"})[0][
                ::2
            ]
            for engine in ("cube", "direct")
        ]
        for view in (np.real, np.imag, np.abs):
            assert ks_2samp(view(both[0]), view(both[1])).pvalue > 1e-3
        assert ks_2samp(abs(both[0]), 1.1 * abs(both[1])).pvalue < 1e-6  # it would see 1 dB


class TestRangeProfiles:
    """sigma^2 N_ADC in every range bin, twice that after MTI."""

    def noise(self, width: int, **more: object) -> tuple[np.ndarray, float]:
        return noise_of("range_profiles", "direct", image={"size_px": [16, width]}, **more)

    @pytest.mark.parametrize("mti", [True, False])
    def test_variance_and_whiteness_over_the_bins(self, mti):
        noise, sigma = self.noise(2000, processing={"clutter": "difference" if mti else "none"})
        assert noise.shape == (SAMPLES // 2, 2000)
        error = SIGMAS * np.sqrt(1.5 / noise.size)
        right = (1 + mti) * sigma**2 * SAMPLES
        assert np.mean(np.abs(noise) ** 2) == pytest.approx(right, rel=error)
        assert abs(correlation(noise.T, 1)) < error

    def test_zero_padded_bins_are_correlated_as_the_transform_makes_them(self):
        """Twice as many bins as samples: neighbours share |sum exp(j pi n/N)|/N = 2/pi."""
        more = {"processing": {"range_fft_length": 2 * SAMPLES}}
        noise, sigma = self.noise(2000, **more)
        assert noise.shape == (SAMPLES, 2000)
        error = 2 * SIGMAS * np.sqrt(2 / noise.size)
        assert np.mean(np.abs(noise) ** 2) == pytest.approx(2 * sigma**2 * SAMPLES, rel=error)
        assert abs(abs(correlation(noise.T, 1)) - 2 / np.pi) < 0.01 + error

    def test_pairs_that_share_a_pulse_are_correlated(self):
        """M - 1 <= W: every pair is shown, and the middle pulse is common to two of them."""
        noise, _ = self.noise(8192, duration_s=1.0)
        assert noise.shape == (SAMPLES // 2, 4999)
        error = SIGMAS * np.sqrt(2 / noise.size)
        found = [correlation(noise, lag) for lag in (1, 2, 3)]
        assert np.abs(np.array(found) - [-0.5, 0, 0]).max() < error

    @pytest.mark.parametrize("taps", [(1, -2, 1), (-1, 0, 1), (1, 1, 1, 1)])
    def test_outputs_of_any_canceller_that_share_pulses_are_correlated(self, taps):
        """By sum_k c[k] c[k + lag]/sum c^2; apart, they have its gain alone."""
        raw, rng = RawSamples(Waveform(**asdict(ref.Radar(adc_rate=5e5)))), np.random.default_rng(9)
        every, apart = (white_noise(Look("", raw, np.arange(5000) * k, taps), rng) for k in (1, 4))
        error = SIGMAS * np.sqrt(3 / every.size)
        power = np.sum(np.square(taps))
        right = np.append(np.correlate(taps, taps, "full")[len(taps) :], 0) / power
        found = [correlation(every, lag) for lag in range(1, len(taps) + 1)]
        assert found == pytest.approx(right, abs=error)
        assert abs(correlation(apart, 1)) < error
        for noise in (every, apart):
            assert np.mean(np.abs(noise) ** 2) == pytest.approx(power, rel=2 * error)

    def test_only_shared_pulses_are_correlated(self):
        """M - 1 = 3/2 W: the pairs shown are 1 and 2 pulses apart in turn."""
        noise, _ = self.noise(3000, duration_s=0.9002)
        assert noise.shape == (SAMPLES // 2, 3000)
        shown = (np.arange(3000) + 0.5) * 4500 / 3000 // 1
        products = noise[:, 1:] * noise[:, :-1].conj() / np.mean(np.abs(noise) ** 2)
        for apart, right in ((1, -0.5), (2, 0.0)):
            mean = np.mean(products[:, np.diff(shown) == apart])
            assert abs(mean - right) < SIGMAS * np.sqrt(2 / (noise.size / 2))

    def test_pairs_apart_are_independent(self):
        noise, _ = self.noise(4000)
        assert abs(correlation(noise, 1)) < SIGMAS / np.sqrt(noise.size)

    @engines
    def test_bins_of_the_range_time_map_are_exponential(self, engine):
        """At -100 dB the map is noise alone, of mean 2 sigma^2 N_ADC."""
        more = {"snr_db": -100, "image": {"size_px": [16, 1000]}}
        recording = record(engine, "rtm", "noise", **more)
        rtm = recording["rtm"].power
        assert rtm.shape == (SAMPLES // 2, 1000)
        scale = 2 * recording["noise"].sigma ** 2 * SAMPLES
        assert kstest(rtm.ravel(), expon(scale=scale).cdf).pvalue > 1e-3


class TestStreams:
    """One unit-variance stream a purpose, whatever else is asked for."""

    @pytest.mark.parametrize(
        ("engine", "product"),
        [("cube", "signal"), ("direct", "signal"), ("direct", "range_profiles")],
    )
    def test_snr_scales_the_same_noise(self, engine, product):
        loud, loud_sigma = noise_of(product, engine, snr_db=-20, duration_s=0.5)
        faint, faint_sigma = noise_of(product, engine, snr_db=0, duration_s=0.5)
        assert loud_sigma == pytest.approx(10 * faint_sigma, rel=1e-12)
        assert np.abs(loud - 10 * faint).max() < 1e-9 * np.abs(loud).max()

    def noise(self, slug: str = "walking", index: int = 0) -> WhiteNoise:
        return record("direct", "noise", slug=slug, index=index, duration_s=0.5)["noise"]

    def test_samples_and_classes_have_their_own(self):
        drawn = [
            alone(noise, RangeSum(waveform()))[0] / noise.sigma
            for noise in (self.noise(), self.noise(index=1), self.noise("punching"))
        ]
        for a, b in combinations(drawn, 2):
            assert abs(np.mean(a * b.conj())) < SIGMAS * gain() / np.sqrt(PULSES)

    def test_purposes_have_their_own(self):
        """The Doppler maps and the range-time map do not share their random numbers."""
        noise, w = self.noise(), waveform()
        drawn = [
            alone(noise, RangeSum(w), "slow_time")[0],
            alone(noise, RangeBins(w), "range_profiles").T.ravel()[:PULSES],
            alone(noise, RawSamples(w), "beat").T.ravel()[:PULSES],
        ]
        for one, other in combinations([v / np.std(v) for v in drawn], 2):
            assert abs(np.mean(one * other.conj())) < SIGMAS / np.sqrt(PULSES)

    @engines
    def test_adding_a_map_changes_no_byte_of_the_others(self, engine):
        document = {
            "radar": RADAR | {"prf_hz": 500},
            "duration_s": 1.0,
            "image": {"size_px": 32},
            "engine": {"kind": engine},
        }

        def images(names):
            config = Config.model_validate(document | {"maps": names})
            scene = draw_scene(config, activity_named("walking"), 3)
            return run(plan_images(config), {"scene": scene})

        together = images(MAP_NAMES)
        for name in MAP_NAMES:
            one, same = images([name])[f"image:{name}"], together[f"image:{name}"]
            assert np.array_equal(one.levels, same.levels)
            assert one.entropy == same.entropy
