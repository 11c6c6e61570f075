"""The sum that numba compiles, against that of NumPy and against double precision."""

from dataclasses import asdict

import numpy as np
import pytest
from helpers import reference as ref
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.echo import compiled, direct
from radhar_cli.echo.direct import DirectEcho, Settings
from radhar_cli.echo.half_band_sum import half_band_table
from radhar_cli.echo.interpolation import AFTER, BEFORE, NO_STENCIL, shifts
from radhar_cli.echo.knots import Spacing
from radhar_cli.echo.paths import Paths
from radhar_cli.numerics.accelerators import installed
from radhar_cli.processing.canceller import FIRST_DIFFERENCE, NO_CANCELLER
from radhar_cli.radar.fmcw import Waveform

needs_numba = pytest.mark.skipif(installed("numba") is None, reason="needs radhar[fast]")
OVERSAMPLING = 16


@st.composite
def scenes(draw) -> tuple[Waveform, Paths, np.ndarray, int]:
    """A radar, paths at knots, the shifts of the stencils beside some breakpoints, and the step."""
    step, segments = draw(st.integers(3, 90)), draw(st.integers(1, 12))
    fc = draw(st.sampled_from([1e9, 77e9, 140e9]))
    radar = ref.Radar(
        fc=fc,
        bandwidth=0.003 * fc,  # so that G turns slowly
        adc_rate=1e6,
        chirp=draw(st.sampled_from([4, 31, 40])) * 1e-6,
        residual_video_phase=draw(st.booleans()),
        centred=draw(st.booleans()),
    )
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    paths, knots = draw(st.integers(1, 40)), np.arange(-BEFORE, segments + AFTER)
    # Up to half a turn from pulse to pulse, a fortieth of one of curvature from knot to knot.
    speed, bend = rng.uniform(-0.5, 0.5, (paths, 1)), rng.uniform(-0.025, 0.025, (paths, 1))
    turns = rng.uniform(0.1, 3, (paths, 1))  # of G: several periods, some with another sign
    delay = turns * radar.n_adc / radar.bandwidth
    delay = delay + (speed * step * knots + bend * knots**2) / radar.f0
    strength = rng.uniform(0.5, 1.5, (paths, 1)) * (1 + 0.02 * np.sin(knots))
    breaks = np.sort(rng.uniform(-BEFORE, segments + AFTER, draw(st.integers(0, 3))))
    shift = shifts(knots.astype(float), tuple(breaks))
    return Waveform(**asdict(radar)), Paths(delay, strength), shift, step


def by_numpy(
    waveform: Waveform, paths: Paths, shift: np.ndarray, step: int, single: bool
) -> np.ndarray:
    chosen = Settings(Spacing(1, 1, 1), OVERSAMPLING, single, True)
    echo = DirectEcho(lambda t: paths, waveform, -80.0)
    terms = echo._terms(paths, np.arange(len(paths.delay)), 0.5, chosen)
    return direct._interpolated_sum(*terms, shift, step, True)


@needs_numba
class TestSum:
    @pytest.mark.parametrize("single", [True, False])
    @given(scene=scenes())
    @settings(max_examples=100)
    def test_is_that_of_numpy(self, scene, single):
        """Within 3e-5 of every path: a phasor that follows from another errs by 1e-7 n^2/2 after
        n = 20 pulses, and cubics of the envelope by as much."""
        waveform, paths, shift, step = scene
        table = half_band_table(waveform, OVERSAMPLING, single)
        every = np.arange(len(paths.delay))
        found = compiled.interpolated_sum(paths, every, 0.5, table, shift, step)
        exact = np.repeat(shift == NO_STENCIL, step)
        assert not found[exact].any()
        size = 2 * paths.amplitude.max() * np.abs(table.polynomials[0]).max() * len(paths.delay)
        gap = np.abs(found - by_numpy(*scene, single))[~exact]
        assert gap.max(initial=0) < 3e-5 * size

    @pytest.mark.parametrize(("single", "least", "most"), [(True, 5e-8, 3e-5), (False, 0, 3e-8)])
    def test_in_double_precision_errs_as_its_polynomials_for_sines_do(self, single, least, most):
        """Where cubics are exact."""
        waveform, knots = Waveform(77e9, 1e3, 40e-6, 1e6, 1e3, 1.0), np.arange(40.0)
        bend = np.array([0.021, -0.013, 0.02])[:, None]
        delay = 1e-8 + (np.array([4.3, -3.1, 0.2])[:, None] * knots + bend * knots**2) / 77e9
        paths, shift = Paths(delay, np.ones(delay.shape)), np.zeros(31, np.intp)
        table = half_band_table(waveform, OVERSAMPLING, single)
        found = compiled.interpolated_sum(paths, np.arange(3), 0.5, table, shift, 11)
        echo = DirectEcho(lambda t: paths, waveform, -80.0)
        chosen = Settings(Spacing(1, 1, 1), OVERSAMPLING, False, False)
        terms = echo._terms(paths, np.arange(3), 0.5, chosen)
        right = direct._interpolated_sum(*terms, shift, 11, False)
        assert least < np.abs(found - right).max() / (6 * np.abs(table.polynomials[0]).max()) < most

    def test_only_the_given_paths_are_summed(self):
        waveform = Waveform(77e9, 4e9, 40e-6, 1e6, 1e3, 1.0)
        delay = 1e-8 + 1e-12 * np.arange(4)[:, None] * np.arange(20)
        paths, shift = Paths(delay, np.ones((4, 20))), np.zeros(11, np.intp)
        table = half_band_table(waveform, OVERSAMPLING, True)
        found = compiled.interpolated_sum(paths, np.array([3, 1]), 1.0, table, shift, 7)
        alone = Paths(delay[[3, 1]], np.ones((2, 20)))
        right = compiled.interpolated_sum(alone, np.arange(2), 1.0, table, shift, 7)
        assert np.array_equal(found, right)

    @pytest.mark.parametrize(("duration", "speed"), [(0.1, 1.5), (1.0, 1.5), (1.0, 0.005)])
    def test_is_used_where_it_pays(self, monkeypatch, duration, speed):
        """For scenes of many paths and pulses; the signal changes by rounding alone."""
        source = ref.Points(lambda t: 2 + 0.01 * np.arange(250)[:, None] + speed * t)
        radar = Waveform(**asdict(ref.Radar(adc_rate=1e6, duration=duration)))
        canceller = NO_CANCELLER if speed > 1 else FIRST_DIFFERENCE
        echo = [DirectEcho(source, radar, -80.0, canceller=canceller) for _ in range(2)]
        found, accuracy = echo[0].slow_time()
        assert accuracy.single == (speed > 1)
        monkeypatch.setattr(compiled, "installed", lambda library: None)
        right, _ = echo[1].slow_time()
        assert np.array_equal(found, right) == (250 * radar.n_pulses < compiled.MIN_TERMS)
        assert ref.error_db(canceller(found), canceller(right)) < -100

    def test_nan_stays_nan_and_is_read_within_bounds(self):
        """And reads no memory but its own."""
        waveform = Waveform(77e9, 4e9, 40e-6, 1e6, 1e3, 1.0)
        paths = Paths(np.full((1, 20), np.nan), np.ones((1, 20)))
        table = half_band_table(waveform, OVERSAMPLING, True)
        total = compiled.interpolated_sum(paths, np.arange(1), 1.0, table, np.zeros(11, int), 7)
        assert np.isnan(total).all()


def test_sines_are_right_to_single_precision():
    r = np.linspace(-0.5, 0.5, 10001)
    sine = sum(float(c) * r ** (2 * k + 1) for k, c in enumerate(compiled.SINE))
    cosine = sum(float(c) * r ** (2 * k) for k, c in enumerate(compiled.COSINE))
    assert np.abs(sine - np.sin(2 * np.pi * r)).max() < 5e-7
    assert np.abs(cosine - np.cos(2 * np.pi * r)).max() < 5e-7
