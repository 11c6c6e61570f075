"""Clutter and gate through the whole chain: against the definition, between engines, with noise."""

from dataclasses import replace

import numpy as np
import pytest
from helpers import reference as ref
from helpers.signals import signal
from scipy.signal import butter, sosfilt

from radhar_cli.config.data_set import Config
from radhar_cli.echo.receiver.noise import white_noise
from radhar_cli.errors import ConfigError, RadharError
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.processing.look import Look, RangeBins
from radhar_cli.processing.track import PulseTrack
from radhar_cli.scene.products.run import Results, process
from radhar_cli.scene.products.run import record as record_scene
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.scene import Scene, draw_scene
from radhar_cli.scene.single.request import map_names
from radhar_cli.scene.single.simulate import simulate

RADAR = {"carrier_hz": 24e9, "bandwidth_hz": 1e9, "prf_hz": 500, "adc_rate_hz": 2e6}
RADAR["antenna_isolation_db"] = 300  # the sums below have no leakage
BASE = {
    "radar": RADAR,
    "duration_s": 1.0,
    "snr_db": None,
    "image": {"size_px": 32},
    "motion": {"model": "paper", "range_m": 2.0, "angle_deg": 20.0},
}
engines = pytest.mark.parametrize("engine", ["cube", "direct"])
CLUTTER = ("difference", "mean", "highpass", "none")
clutters = pytest.mark.parametrize("clutter", CLUTTER)


def scene_of(engine: str = "cube", slug: str = "walking", **more: object) -> Scene:
    processing = {"range_sum": "gated"} | dict(more.pop("processing", {}))
    document = BASE | {"engine": {"kind": engine}, "processing": processing} | more
    return draw_scene(Config.model_validate(document), activity_named(slug), 0)


def record(engine: str, *products: str, slug: str = "walking", **more: object) -> Results:
    return record_scene(scene_of(engine, slug, **more), products)


def cancelled(s: np.ndarray, clutter: str) -> np.ndarray:
    """The definitions, along the last axis."""
    if clutter == "difference":
        return np.diff(s)
    s = s if clutter == "none" else s - s.mean(axis=-1, keepdims=True)
    return sosfilt(butter(4, 0.0075, "high", output="sos"), s) if clutter == "highpass" else s


def beat_of(scene: Scene) -> np.ndarray:
    """The beat matrix by its formula."""
    found = record_scene(scene, ["paths", "waveform"])
    paths = found["paths"](np.arange(found["waveform"].n_pulses) / 500)
    radar = ref.Radar(24e9, 1e9, 40e-6, 2e6, 500, 1.0)
    return ref.beat_matrix(paths.delay, paths.amplitude, radar)


def compressed(beat: np.ndarray, length: int) -> np.ndarray:
    return np.fft.ifft(beat, length, axis=0, norm="forward")[: length // 2]


@clutters
@pytest.mark.parametrize("length", [None, 200])
@pytest.mark.parametrize("gate_m", [0.5, [0.6, 3.1]], ids=["around", "interval"])
def test_a_gated_map_is_the_sum_of_the_stfts_of_its_bins(clutter, length, gate_m):
    processing = {"clutter": clutter, "range_fft_length": length, "gate_m": gate_m}
    scene = scene_of(processing=processing)
    found = record_scene(scene, ["stft", "waveform", "torso_track", "frames"])
    w = found["waveform"]
    bins = cancelled(compressed(beat_of(scene), w.n_fft), clutter)
    step = ref.C / 2e9 * 80 / w.n_fft
    columns, size, hop = [], found["frames"].length, found["frames"].hop
    window = np.sin(np.pi * (np.arange(size) + 0.5) / size) ** 2
    late = 0.5 if clutter == "difference" else 0.0
    for start in range(0, bins.shape[1] - size + 1, hop):
        if isinstance(gate_m, list):
            low, high = (round(at / step) for at in gate_m)
        else:
            middle = int(np.rint(start + (size - 1) / 2 + late))
            centre = round(found["torso_track"][middle] * ref.C / 2 / step)
            low, high = centre - int(gate_m / step), centre + int(gate_m / step)
            low, high = (low, high) if low > 0 else (0, high - low)
        x = np.fft.fft(bins[low : high + 1, start : start + size] * window, axis=1)
        columns.append(np.fft.fftshift((np.abs(x) ** 2).sum(axis=0)))
    right = np.array(columns).T
    assert found["stft"].power == pytest.approx(right, rel=1e-6, abs=1e-9 * right.max())


@clutters
def test_engines_show_the_same_range_time_map(clutter):
    one, two = (
        record(e, "rtm", processing={"clutter": clutter})["rtm"] for e in ("cube", "direct")
    )
    assert one.power == pytest.approx(two.power, abs=1e-10 * one.power.max())


@engines
@pytest.mark.parametrize("clutter", ["difference", "mean", "highpass"])
def test_a_motionless_scene_is_black(engine, clutter):
    maps = ("stft", "rtm", "signal", "range_signals", "image:stft_compensated")
    found = record(engine, *maps, slug="stationary", processing={"clutter": clutter})
    assert not found["stft"].power.any()
    assert not found["rtm"].power.any()
    assert not found["signal"].x.any()
    assert not found["range_signals"].x.any()
    assert not found["image:stft_compensated"].levels.any()


@engines
def test_compensation_and_denoising_are_those_of_every_bin(engine):
    names = ("", "_denoised", "_compensated", "_compensated_denoised")
    asked = [f"{kind}{name}" for kind in ("range_signals", "stft") for name in names]
    found = record(engine, *asked, "torso_track", "waveform")
    x, w = found["range_signals"].x, found["waveform"]
    turn = np.exp(2j * np.pi * w.f0 * (found["torso_track"][1:] - found["torso_track"][0]))
    assert found["range_signals_compensated"].x == pytest.approx(x * turn, abs=1e-9 * abs(x).max())
    for name in names:
        assert found[f"stft{name}"].power.any()
    spread = [
        (p := found[f"stft{n}"].power.sum(axis=1)) @ found["stft"].rows.values ** 2 / p.sum()
        for n in ("", "_compensated")
    ]
    assert spread[1] < 0.6 * spread[0]


class TestRecording:
    """Recorded range bins go through the same chain."""

    @clutters
    def test_gives_the_same_map(self, clutter):
        processing = {"clutter": clutter}
        scene = scene_of(processing=processing)
        found = record_scene(scene, ["stft", "image:stft", "signal", "torso_track", "waveform"])
        w = found["waveform"]
        bins = compressed(beat_of(scene), w.n_fft)
        signals = signal(bins, w.prf, w.f0, w.range_step)
        track = PulseTrack(signals.t, found["torso_track"])
        again = process(signals, scene.config, ["stft", "image:stft"], torso_track=track)
        right = found["stft"].power
        assert again["stft"].power == pytest.approx(right, rel=1e-6, abs=1e-9 * right.max())
        assert np.array_equal(again["stft"].columns.values, found["stft"].columns.values)
        levels = [r["image:stft"].levels.astype(int) for r in (found, again)]
        assert np.abs(levels[0] - levels[1]).max() <= 1

    def test_a_fixed_gate_needs_no_track(self):
        x = np.random.default_rng(0).standard_normal((64, 500, 2)).view(complex)[..., 0]
        signals = signal(x, 500.0, 5.8e9, 0.375)
        wide = {"radar": RADAR | {"bandwidth_hz": 4e8}}
        gate = {"gate_m": [3.75, 11.25], "gate_sum": "magnitude"}
        config = scene_of(processing=gate, **wide).config
        assert process(signals, config, ["stft"])["stft"].power.any()
        around = scene_of(processing={"gate_m": 1.0}).config
        with pytest.raises(RadharError):
            process(signals, around, ["stft"])


class TestNoise:
    """One receiver for all maps: sigma^2 per raw sample, whatever is shown."""

    @pytest.mark.parametrize("length", [None, 120, 400], ids=["unpadded", "1.5", "5 times"])
    def test_bins_have_the_covariance_of_one_fft(self, length):
        more = {"duration_s": 8.0, "snr_db": 3.0, "processing": {"gate_m": [0.0, 2.9]}}
        more["processing"] |= {"range_fft_length": length, "clutter": "none"}
        for engine in ("cube", "direct"):
            noisy = record(engine, "range_signals", "noise", "waveform", **more)
            clean = record(engine, "range_signals", **more | {"snr_db": None})
            v = (noisy["range_signals"].x - clean["range_signals"].x)[0]
            sigma, w = noisy["noise"].sigma, noisy["waveform"]
            k, n = np.arange(len(v)), np.arange(w.n_adc) - w.n_adc / 2
            f = np.exp(2j * np.pi * np.outer(k, n) / w.n_fft)
            right = sigma**2 * f @ f.conj().T
            found = v @ v.conj().T / v.shape[1]
            assert np.abs(found - right).max() < 6 * right[0, 0].real / np.sqrt(v.shape[1])
            for lag in (1, 2, 7):
                later = (v[:, lag:] * v[:, :-lag].conj()).mean(axis=1)
                assert np.abs(later).max() < 6 * right[0, 0].real / np.sqrt(v.shape[1])

    def test_padding_far_beyond_the_samples_stays_exact(self):
        """64 times as many bins as samples: the covariance has the rank of the samples."""
        w = record("direct", "waveform", processing={"range_fft_length": 640})["waveform"]
        w = replace(w, adc_rate=2.5e5)
        look = Look("", RangeBins(w, slice(0, 320)), np.arange(4000), spans=[slice(0, 4000)] * 320)
        v = white_noise(look, np.random.default_rng(3))
        assert np.mean(np.abs(v) ** 2) == pytest.approx(10, rel=0.03)
        assert np.linalg.matrix_rank(v, tol=1e-6) <= 10

    def test_the_floor_of_a_map_is_that_of_its_bins(self):
        """At -60 dB there is noise alone: 2 sigma^2 N_ADC sum g^2 a bin after MTI, on average."""
        for engine in ("cube", "direct"):
            found = record(engine, "stft", "noise", "gate", "frames", "waveform", snr_db=-60)
            sigma, w = found["noise"].sigma, found["waveform"]
            mean = sigma**2 * w.n_adc * found["gate"].count * np.sum(found["frames"].window ** 2)
            assert found["stft"].power.mean() == pytest.approx(2 * mean, rel=0.05)

    @pytest.mark.parametrize("clutter", ["difference", "none"])
    def test_exactly_the_bins_shown_get_noise(self, clutter):
        asked = ("range_signals", "gate", "gate_needed", "noise", "waveform")
        more = {"processing": {"gate_m": 0.3, "clutter": clutter}, "snr_db": -60}
        found = record("direct", *asked, **more)
        x, gate = found["range_signals"].x[0], found["gate"]
        lost = int(clutter == "difference")
        low, high = (each[: x.shape[1]] for each in found["gate_needed"])
        k = np.arange(gate.bins.start, gate.bins.stop)[:, None]
        shown = (low <= k) & (k < high)
        spans = gate.spans(found["gate_needed"])
        assert sum(span.stop - span.start for span in spans) < 0.7 * x.size
        for row, span, counts in zip(x, spans, shown, strict=True):
            assert span.start == counts.argmax()
            assert not row[: span.start].any()
            assert not row[span.stop :].any()
            inside = row[span.start : span.stop - lost]
            assert (inside != 0).all()
        variance = (1 + lost) * found["noise"].sigma ** 2 * found["waveform"].n_adc
        inside = np.concatenate([r[s.start : s.stop - lost] for r, s in zip(x, spans, strict=True)])
        assert np.mean(np.abs(inside) ** 2) == pytest.approx(variance, rel=0.1)
        assert abs(np.mean(inside**2)) < 0.1 * variance


class TestPlan:
    def names(self, maps: list[str], **more: object) -> set[str]:
        config = scene_of(maps=maps, **more).config
        return {product.name for product in plan_images(config).products}

    @engines
    def test_gated_maps_alone_take_no_half_band_sum(self, engine):
        names = self.names(["stft", "stft_compensated"], engine=engine)
        assert not {"echo", "slow_time", "signal", "beat_cube"} & names
        assert {"gate", "range_signals", "range_signals_compensated"} <= names

    def test_a_fixed_interval_takes_no_torso(self):
        assert "torso_track" not in self.names(["stft"], processing={"gate_m": [1, 3]})
        assert "torso_track" in self.names(["stft"])

    def test_without_a_gate_no_gated_product_is_made(self):
        names = self.names(["stft", "fsst"], processing={"range_sum": "coherent"})
        assert not {"gate", "range_signals", "range_axis"} & names


def test_a_scene_has_the_half_band_sum_beside_gated_maps():
    scene = scene_of("direct")
    found = simulate(scene.config, "walking", maps="all")
    assert set(found.maps) == {"rtm", *(n for n in found.maps if n.startswith("stft"))}
    assert len(found.maps) == 9
    right = record("direct", "signal", processing={"range_sum": "coherent"})["signal"].x
    assert np.array_equal(found.signals["raw"].x, right)
    with pytest.raises(ConfigError, match=r"fsst.*processing\.range_sum: gated adds up powers"):
        simulate(scene.config, "walking", maps=map_names(["fsst"], scene.config))
