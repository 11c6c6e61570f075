"""Range bins of a gate by the direct engine: within the tolerance of the cube."""

from dataclasses import replace

import numpy as np
import pytest
from helpers import reference as ref
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config.data_set import Config
from radhar_cli.echo import gated
from radhar_cli.echo.accuracy import AccuracyError, Settings
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.direct import DirectEcho
from radhar_cli.echo.gated import GatedEcho, kernel
from radhar_cli.echo.knots import Spacing
from radhar_cli.echo.paths import Paths
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.processing.canceller import (
    FIRST_DIFFERENCE,
    NO_CANCELLER,
    Fir,
    HighPass,
    MeanRemoval,
)
from radhar_cli.processing.range_compression import range_compression
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import draw_scene

CANCELLERS = {"difference": FIRST_DIFFERENCE, "mean": MeanRemoval(), "none": NO_CANCELLER}


WALK = ref.Points(lambda t: np.stack([2 + 1.5 * t, 2.3 + 1.4 * t]))
RADAR = Waveform(77e9, 4e9, 40e-6, 5e6, 5000, 0.5)


def exact_bins(paths: Paths, w: Waveform) -> np.ndarray:
    """[N_FFT/2, M], referred to mid-chirp."""
    return range_compression(beat_matrix(*paths[:2], w), replace(w, centred=True))


@pytest.mark.parametrize(("single", "error_db"), [(True, -95), (False, -150)])
@pytest.mark.parametrize("samples", [2, 7, 40, 401, 2000])
@given(data=st.data())
@settings(max_examples=10, deadline=None)
def test_few_polynomials_of_range_give_every_bin(single, error_db, samples, data):
    """Any extent, any place, any padding: bins as of all samples, beside a scatterer's peak.

    T_p takes on rounding p^2 times at the ends of its range: 2000 samples and 1000 bins need -150.
    """
    seed = data.draw(st.integers(0, 2**32 - 1))
    rng = np.random.default_rng(seed)
    length = data.draw(st.sampled_from([None, 2 * samples, 4 * samples + 2]))
    w = Waveform(1e9, 1e9, 1e-5, samples * 1e5, 100, 1.0, length)
    extent, start = data.draw(st.floats(0, 0.6)), data.draw(st.floats(0, 0.6))
    u = start + extent * rng.random((5, 20))
    paths = Paths(u * w.adc_rate / w.slope, rng.uniform(0.1, 1, (5, 20)))
    first = data.draw(st.integers(0, w.n_bins - 1))
    count = data.draw(st.integers(1, w.n_bins - first))
    echo = GatedEcho(WALK, w, -80.0, bins=slice(first, first + count))
    k = np.arange(first, first + count)
    found = echo.at_pulses(Settings(Spacing(1, 1, 1), 1, single, single), paths, k, 1.0)
    right = exact_bins(paths, w)
    scale = samples * np.sqrt(np.mean((paths.amplitude**2).sum(axis=0)))
    error = np.sqrt(np.mean(np.abs(found - right[first : first + count]) ** 2))
    assert 20 * np.log10(error / scale + 1e-300) < error_db


@given(u=st.floats(-1.2, 1.2), k=st.integers(0, 30), samples=st.integers(1, 60))
def test_the_kernel_is_the_sum_of_the_samples(u, k, samples):
    """D = sum_n exp(j 2 pi x (n - (N - 1)/2)), x = k/N_FFT - u; N where x is a whole number."""
    for beat in (u, k / 64, k / 64 - 1):
        n = np.arange(samples) - (samples - 1) / 2
        right = np.exp(2j * np.pi * (k / 64 - beat) * n).sum()
        found = kernel(np.array(beat), np.array([k]), samples, 64)
        np.testing.assert_allclose(found, [right], atol=1e-6 * samples)


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def random_config(rng: np.random.Generator) -> dict:
    """Any radar from 1 to 140 GHz, both models of motion, a fifth before a wall, any gate."""
    carrier, prf = log_uniform(rng, 1e9, 140e9), log_uniform(rng, 64, 8000)
    bandwidth = carrier * log_uniform(rng, 3e-3, 0.3)
    chirp, samples = log_uniform(rng, min(1e-5, 0.4 / prf), 0.9 / prf), int(rng.integers(4, 200))
    duration = max(2.5, 100 / prf) if rng.random() < 0.2 else min(2.5, 2000 / prf)
    half_band = samples * ref.C / (4 * bandwidth)
    fixed = [float(f * half_band) for f in np.sort(rng.uniform(0, 0.95, 2))]
    clutter = str(rng.choice(["difference", "mean", "highpass", "none"]))
    fft = samples + samples % 2
    return {
        "seed": int(rng.integers(2**31)),
        "snr_db": None,
        "duration_s": duration,
        "radar": {
            "carrier_hz": carrier,
            "bandwidth_hz": bandwidth,
            "prf_hz": prf,
            "chirp_s": chirp,
            "adc_rate_hz": samples / chirp,
            "residual_video_phase": bool(rng.random() < 0.2),
            "antenna_isolation_db": 300,  # the echo of people alone, whatever the canceller
        },
        "processing": {
            "range_sum": "gated",
            "gate_m": fixed if rng.random() < 0.3 else float(rng.uniform(0.01, 0.45) * half_band),
            "clutter": clutter,
            "highpass": {
                "cutoff_hz": log_uniform(rng, 1e-3, 0.3) * prf / 2,
                "zero_phase": bool(rng.random() < 0.5),
                "remove_mean": bool(rng.random() < 0.7),
            },
            "range_reference": "centre" if rng.random() < 0.8 else "start",
            "range_fft_length": None if rng.random() < 0.7 else fft * int(rng.integers(1, 4)),
            "window_s": float(rng.uniform(0.1, 0.4)) * duration,
        },
        "motion": {
            "model": str(rng.choice(["paper", "human"])),
            "range_m": {"uniform": [0.8, 8]},
            "angle_deg": {"uniform": [-180, 180]},
        },
        "wall": {"center_m": [float(rng.uniform(0.8, 4)), 0, 1.25]}
        if rng.random() < 0.2 and clutter != "none"
        else None,
    }


@pytest.mark.parametrize("block", range(4))
def test_the_tolerance_is_kept(block):
    """24 random scenes, tolerances from -20 to -110 dB: of the bins that the frames show."""
    rng = np.random.default_rng(2000 + block)
    made = 0
    for number in range(24):
        drawn, tolerance_db = random_config(rng), float(rng.uniform(-110, -20))
        activity = ACTIVITIES[1:][number % 11]
        engine = {"kind": "direct", "tolerance_db": tolerance_db}
        cube = draw_scene(Config.model_validate(drawn | {"engine": {"kind": "cube"}}), activity, 0)
        direct = draw_scene(Config.model_validate(drawn | {"engine": engine}), activity, 0)
        asked = ["range_signals", "gate", "frames", "waveform", "canceller"]
        exact = record(cube, asked)
        found = record(direct, ["range_signals", "accuracy"])
        right, canceller, gate = exact["range_signals"].x[0], exact["canceller"], exact["gate"]
        k = np.arange(gate.bins.start, gate.bins.stop)[:, None]
        shown = np.ones(right.shape, bool)
        if isinstance(canceller, Fir):
            low, high = gate.needed(exact["frames"], right.shape[1], 0)
            shown = (low <= k) & (k < high)
        right, got = right[shown], found["range_signals"].x[0][shown]
        if not right.any():
            continue
        error_db = ref.error_db(got, right)
        said_db = max(found["accuracy"].error_db, error_db if error_db < -170 else -np.inf)
        assert error_db <= tolerance_db, (drawn, activity.slug, found["accuracy"])
        if isinstance(canceller, Fir):
            assert error_db <= said_db <= error_db + 17, (drawn, activity.slug)
        else:  # the reported error bounds it
            assert error_db <= said_db, (drawn, activity.slug)
        made += 1
    assert made >= 12


def echo(tolerance_db: float = -80.0, **more: object) -> GatedEcho:
    return GatedEcho(WALK, RADAR, tolerance_db, bins=slice(40, 80), **more)


@pytest.mark.parametrize("canceller", [FIRST_DIFFERENCE, Fir((1, -2, 1)), MeanRemoval()], ids=repr)
@pytest.mark.parametrize("tolerance_db", [-60.0, -110.0])
def test_after_any_canceller(canceller, tolerance_db):
    y, accuracy = echo(tolerance_db, canceller=canceller).rows()
    right = exact_bins(WALK(np.arange(2500) / 5000), RADAR)[40:80]
    error_db = ref.error_db(canceller(y), canceller(right))
    assert error_db < tolerance_db
    assert error_db <= accuracy.error_db


def test_a_high_pass_that_leaves_little_keeps_the_promise():
    """Of a slow sway hardly a tenth is left; the error before the filter is compared with that."""
    sway = ref.Points(lambda t: (2 + 1e-4 * np.sin(2 * np.pi * t))[None])
    canceller = HighPass(4, 0.02)
    y, accuracy = replace(echo(-60.0, canceller=canceller), source=sway).rows()
    right = exact_bins(sway(np.arange(2500) / 5000), RADAR)[40:80]
    assert np.linalg.norm(canceller(right)) < 0.1 * np.linalg.norm(MeanRemoval()(right))
    assert ref.error_db(canceller(y), canceller(right)) <= min(-60, accuracy.error_db)


def test_static_paths_are_left_out():
    both = ref.Points(lambda t: np.stack([2 + 1.5 * t, 2.5 + 0 * t]))
    alone = ref.Points(lambda t: (2 + 1.5 * t)[None])
    for canceller in (FIRST_DIFFERENCE, MeanRemoval(), HighPass(4, 0.01)):
        y, one = (replace(echo(canceller=canceller), source=s).rows()[0] for s in (both, alone))
        assert ref.error_db(y, one) < -100
    y, one = (replace(echo(canceller=NO_CANCELLER), source=s).rows()[0] for s in (both, alone))
    assert ref.error_db(y, one) > -10


def test_a_tolerance_that_float64_cannot_keep_is_refused():
    with pytest.raises(AccuracyError) as refusal:
        echo(-390.0).rows()
    assert -300 < refusal.value.limit_db < -120


def test_a_body_outside_the_gate_leaves_its_side_lobes():
    """The bins have no window: 20 m away there is still a bin's worth at 1/(pi 266)."""
    far = ref.Points(lambda t: (5 + 1.0 * t)[None])
    y, accuracy = replace(echo(), source=far, bins=slice(10, 20)).rows()
    right = exact_bins(far(np.arange(2500) / 5000), RADAR)[10:20]
    assert np.abs(right).max() > 0
    assert ref.error_db(np.diff(y), np.diff(right)) < -80
    assert accuracy.error_db < -80


@pytest.mark.parametrize("tolerance_db", [-60.0, -110.0])
def test_many_polynomials_are_left_as_they_are(monkeypatch, tolerance_db):
    """Looking for combinations of them takes the cube of their number."""
    combined = echo(tolerance_db).rows()[0]
    monkeypatch.setattr(gated, "MAX_POLYNOMIALS", 0)
    assert ref.error_db(echo(tolerance_db).rows()[0], combined) < tolerance_db - 10


@pytest.mark.parametrize("kind", [DirectEcho, GatedEcho])
def test_paths_that_are_all_but_gone_at_knots_do_not_overflow(kind):
    """An opaque wall leaves 1e-137; float32 holds no path between knots that passes beside it."""
    w = Waveform(1e9, 1e9, 1e-5, 64e5, 100, 1.0)
    more = {"bins": slice(0, w.n_bins)} if kind is GatedEcho else {}
    walk = ref.Points(lambda t: np.stack([2 + 1.5 * t, 2.3 + 1.4 * t]))
    faint, strong = (kind(replace(walk, strength=s), w, -80.0, **more) for s in (1e-137, 1.0))
    (_, accuracy), (_, usual) = faint.rows(), strong.rows()
    assert not accuracy.single
    assert accuracy.error_db < -80
    assert usual.error_db < -80
