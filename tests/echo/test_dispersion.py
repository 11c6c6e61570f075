"""The beat of paths through a layered wall."""

import numpy as np
import pytest

from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.dispersion import beat_of, power_of
from radhar_cli.echo.motion_in_chirp import moving_beat_matrix
from radhar_cli.echo.paths import Paths, Through
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.layers import Layer, Layers

RADAR = Waveform(2e9, 1e9, 40e-6, 2.5e6, 200.0, 0.1)
WALL = Layers((Layer(0.05, "wood"), Layer(0.2, 7 - 0.1j)), parallel=True)


def paths(cosine: np.ndarray, layers: Layers = WALL) -> Paths:
    rng = np.random.default_rng(1)
    delay, amplitude = rng.uniform(1e-8, 6e-8, cosine.shape[1:]), rng.random(cosine.shape[1:])
    return Paths(delay, amplitude, Through(layers, cosine))


def by_definition(given: Paths) -> np.ndarray:
    f = RADAR.frequencies()[:, None, None]
    assert given.through is not None
    h = [
        np.where(
            np.isnan(one), 1, given.through.layers.transfer_function(f, np.nan_to_num(one, nan=1.0))
        )
        for one in given.through.cosine
    ]
    cycles = f * given.delay
    return (given.amplitude * h[0] * h[1] * np.exp(-2j * np.pi * cycles)).sum(axis=1)


@pytest.mark.parametrize("low", [0.05, 0.7, 0.999999])
def test_interpolating_over_the_angle_loses_nothing(low) -> None:
    given = paths(np.random.default_rng(2).uniform(low, 1, (2, 3, 7)))
    right = by_definition(given)
    assert np.abs(beat_of(given, RADAR) - right).max() < 1e-10 * np.abs(right).max()


def test_a_wall_that_rings_sharply_does_not_either() -> None:
    glass = Layers((Layer(0.02, 60 + 0j), Layer(0.15, 1 + 0j), Layer(0.02, 60 + 0j)), False)
    given = paths(np.random.default_rng(2).uniform(0.3, 1, (2, 3, 7)), glass)
    right = by_definition(given)
    assert np.abs(beat_of(given, RADAR) - right).max() < 1e-9 * np.abs(right).max()


def test_one_angle_and_legs_beside_the_wall() -> None:
    same = paths(np.full((2, 2, 4), 0.8))
    assert beat_of(same, RADAR) == pytest.approx(by_definition(same), abs=1e-10)
    cosine = np.full((2, 2, 4), 0.8)
    cosine[0, 1] = np.nan
    half = paths(cosine)
    assert beat_of(half, RADAR) == pytest.approx(by_definition(half), abs=1e-10)
    beside = paths(np.full((2, 2, 4), np.nan))
    assert beat_of(beside, RADAR) == pytest.approx(
        beat_matrix(beside.delay, beside.amplitude, RADAR), abs=1e-12
    )


def test_power_is_the_mean_over_the_chirp() -> None:
    given = paths(np.random.default_rng(2).uniform(0.5, 1, (2, 1, 4)))
    right = (np.abs(by_definition(given)) ** 2).mean(axis=0)
    assert power_of(given, RADAR) == pytest.approx(right, rel=1e-9)


class Still:
    """Paths that do not move."""

    breakpoints, highest_frequency, smooth = (), 1.0, True

    def __call__(self, t: np.ndarray) -> Paths:
        kept = paths(np.full((2, 2, 1), 0.6))
        assert kept.through is not None
        cosine = np.tile(kept.through.cosine, t.size)
        return Paths(
            np.tile(kept.delay, t.size), np.tile(kept.amplitude, t.size), Through(WALL, cosine)
        )


def test_paths_that_stand_still_are_the_same_within_a_chirp() -> None:
    moving = moving_beat_matrix(Still(), RADAR, np.arange(3.0))
    assert moving == pytest.approx(beat_of(Still()(np.arange(3.0)), RADAR), abs=1e-9)
