"""Where knots are placed."""

import numpy as np
import pytest

from radhar_cli.echo.accuracy import choose_probes
from radhar_cli.echo.knots import Roughness, Spacing, resolve
from radhar_cli.echo.paths import Paths
from radhar_cli.echo.phase_recurrence import run_length
from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.fmcw import Waveform

RADAR = Waveform(77e9, 4e9, 40e-6, 1e6, prf=5000.0, duration=0.5)
SPACING = Spacing(200.0, 0.1, 0.5)


class Fading:
    """Paths at 2 m whose amplitudes fade at different rates (1/s); the last have none."""

    breakpoints = ()
    highest_frequency, smooth = 1.0, True

    def __init__(self, rates: list[float], silent: int = 0) -> None:
        self.rates, self.silent = rates, silent

    def __call__(self, t: Float) -> Paths:
        fading = [np.exp(-rate * t) for rate in self.rates] + [0 * t] * self.silent
        return Paths(np.full((len(fading), t.size), 1.3e-8), np.array(fading))


def step(*rates: float, silent: int = 0) -> int:
    return resolve(Fading(list(rates), silent), RADAR, SPACING).step


def test_the_path_that_changes_most_decides():
    """By a tenth of itself from knot to knot."""
    assert step(0.0) == step(10.0) == 25
    assert step(0.0, 40.0, 1.0) == int(0.1 / 40 * 5000) + 1  # 1 - exp(-x) < x


def test_a_path_of_amplitude_0_needs_no_knots():
    assert step(10.0, silent=2) == 25


def test_moving_paths_are_told_from_static_ones():
    """Also where the change lies between the times that are compared first."""

    class Blink(Fading):
        def __call__(self, t: Float) -> Paths:
            paths = super().__call__(t)
            paths.delay[1] += 1e-15 * np.exp(-(((t - 0.2345) / 0.004) ** 2))
            return paths

    found = resolve(Blink([0.0, 0.0, 0.0]), RADAR, SPACING)
    assert found.moving.tolist() == [False, True, False]


class Passing(Fading):
    """A path of constant amplitude, and one that passes zero smoothly, as at Brewster's angle."""

    def __call__(self, t: Float) -> Paths:
        once, again = (np.sin(2 * np.pi * (t - zero)) for zero in (0.2003, 0.22))
        return Paths(np.full((3, t.size), 1.3e-8), np.stack([np.ones(t.size), once, once * again]))


def test_an_amplitude_that_passes_zero_smoothly_is_no_edge() -> None:
    """Its change counts relative to its usual size; relative to itself it is any number."""
    assert resolve(Passing([]), RADAR, SPACING).step >= 5


def test_probes_lie_where_interpolation_errs() -> None:
    """A short bend that few pulses show: the segments around it are the rough ones, and of the
    probes so many lie there that the error is found."""

    class Bent(Fading):
        def __call__(self, t: Float) -> Paths:
            x = (t - 0.25) / 0.01
            return Paths((1.3e-8 + 1e-13 * np.tanh(x))[None], np.ones((1, t.size)))

    found = resolve(Bent([]), RADAR, SPACING)
    rough = found.roughness.squares
    t = RADAR.times(found.step * (np.arange(rough.size) + 0.5))
    near = np.abs(t - 0.25) < 0.05
    assert rough[near].sum() > 0.99 * rough.sum()
    probes = choose_probes(np.full(rough.size, float(found.step)), RADAR.n_pulses, found.roughness)
    assert np.abs(RADAR.times(probes.pulses.astype(float)) - 0.25).min() < 0.01
    # Unbiased: what is spread in any way is counted once.
    assert np.sum(1 / probes.density) == pytest.approx(RADAR.n_pulses, rel=0.25)


def test_probes_count_every_pulse_once_whatever_the_segments() -> None:
    """The last segment is shorter; powers and roughness differ."""
    rng = np.random.default_rng(5)
    for size, step in ((1003, 7), (50, 7), (3, 7), (400, 1)):
        counts = np.zeros(size)
        for _ in range(100):
            power, rough = rng.exponential(size=(2, -(-size // step)))
            probes = choose_probes(power, size, Roughness(step, rough))
            assert probes.total == pytest.approx(power.sum())
            np.add.at(counts, probes.pulses, 1 / probes.density / 100)
        assert counts.sum() == pytest.approx(size, rel=0.05)
        assert counts[-size // 3 :].mean() == pytest.approx(1, abs=0.2)


@pytest.mark.parametrize("lost", [0, 1, 2])
@pytest.mark.parametrize("step", [7, 18, 26, 45])
def test_probes_lie_at_ends_of_runs(step: int, lost: int) -> None:
    """In single precision an error grows until there, and a canceller sees it jump back."""
    size = 40 * step + 3
    power = np.append(np.full(40, float(step)), 3.0)
    probes = choose_probes(power, size, Roughness(step, np.ones(41)), lost)
    at_end = (probes.pulses % step + max(1, lost)) % run_length(step) < max(1, lost)
    at_end |= probes.pulses % step + max(1, lost) >= step
    assert 0.1 < at_end.mean() < 0.35
    jumps = at_end / probes.density
    assert jumps.sum() == pytest.approx(40 * max(1, lost) * -(-step // 20), rel=0.35)


def test_a_breakpoint_is_not_rough_where_the_stencil_avoids_it() -> None:
    """The kink that a source names is left to the shifted stencils and to exact pulses."""

    class Kinked(Fading):
        breakpoints = (0.2503,)

        def __call__(self, t: Float) -> Paths:
            delay = 1.3e-8 + 1e-12 * np.maximum(t - 0.2503, 0.0) + 1e-13 * np.sin(30 * t)
            return Paths(delay[None], np.ones((1, t.size)))

    found = resolve(Kinked([]), RADAR, SPACING)
    rough = found.roughness.squares
    t = RADAR.times(found.step * (np.arange(rough.size) + 0.5))
    assert rough[np.abs(t - 0.25) < 0.05].max() < 100 * np.median(rough)
