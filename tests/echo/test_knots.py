"""Where knots are placed."""

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.echo.knots import Spacing, resolve
from radhar_cli.echo.paths import Paths
from radhar_cli.radar.waveform import Waveform

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
