"""Local Lagrange interpolation from knots to pulses."""

import numpy as np
import pytest

from radhar_cli.echo.interpolation import (
    AFTER,
    BEFORE,
    NO_STENCIL,
    TAPS,
    shifts,
    stencils,
    upsample,
)

steps = pytest.mark.parametrize("step", [1, 3, 4, 20])


def knot_places(segments: int, step: int) -> np.ndarray:
    """Pulse numbers of the knots, those beyond both ends included."""
    return np.arange(-BEFORE, segments + AFTER) * float(step)


def unshifted(knots: np.ndarray) -> np.ndarray:
    return np.zeros(knots.size - BEFORE - AFTER, dtype=np.intp)


def dense(knots: np.ndarray, step: int) -> np.ndarray:
    return upsample(knots, step, unshifted(knots))


@steps
@pytest.mark.parametrize("shift", [-2, -1, 0, 1, 2])
def test_polynomial_of_degree_five_is_exact(step, shift):
    coefficients = np.random.default_rng(2).standard_normal((3, 6))
    at, pulses = knot_places(7, step), np.arange(7 * step)
    for c in coefficients:
        found = upsample(np.polyval(c, at / at[-1]), step, np.full(7, shift))
        assert found == pytest.approx(np.polyval(c, pulses / at[-1]), abs=1e-12)


@pytest.mark.parametrize("shift", [-2, -1, 0, 1, 2])
def test_degree_six_is_not(shift):
    """Six taps fix a polynomial of degree five and no more: the remainder is the textbook's."""
    at, pulses = knot_places(7, 10) / 10, np.arange(70) / 10
    part = pulses - np.floor(pulses)
    remainder = np.prod([part - node - shift for node in range(-2, 4)], axis=0)
    found = upsample(at**6, 10, np.full(7, shift))
    assert found == pytest.approx(pulses**6 - remainder, rel=1e-9, abs=1e-9)


@steps
def test_knots_are_kept(step):
    knots = np.random.default_rng(3).standard_normal(20)
    assert dense(knots, step)[::step] == pytest.approx(knots[BEFORE:-AFTER], abs=1e-14)


@pytest.mark.parametrize("cycles_per_knot", [0.01, 0.03, 0.1])
def test_error_of_a_sinusoid(cycles_per_knot):
    """At most 0.005 (2 pi f h)^6 of its amplitude, and not a tenth of it: the bound is sharp."""
    step, segments = 16, 400
    turn = 2 * np.pi * cycles_per_knot
    knots = np.sin(turn * knot_places(segments, step) / step)
    error = np.abs(dense(knots, step) - np.sin(turn * np.arange(segments * step) / step)).max()
    bound = 0.005 * turn**6
    assert 0.1 * bound < error < bound + 1e-15


class TestBreakpoints:
    """A breakpoint spoils the segment it lies in; beside it, stencils keep to their own side."""

    step, segments = 10, 20

    def times(self) -> np.ndarray:
        return knot_places(self.segments, self.step) / self.step

    @pytest.mark.parametrize("at", [0.0, 0.37, 5.0, 8.99, 17.5, 19.9, -0.5, 20.5])
    def test_only_its_own_segment_is_spoilt(self, at):
        def track(t):
            return np.where(t < at, t**2, at**2 + 3 * (t - at))

        shift = shifts(self.times(), (at,))
        pulses = np.arange(self.segments * self.step)
        error = np.abs(upsample(track(self.times()), self.step, shift) - track(pulses / self.step))
        spoilt = np.repeat(shift == NO_STENCIL, self.step)
        assert error[~spoilt].max() < 1e-11
        # One at a knot belongs to what follows, and so spoils the segment that ends there.
        holder = int(np.ceil(at)) - 1
        assert np.flatnonzero(shift == NO_STENCIL).tolist() == (
            [holder] if 0 <= holder < self.segments else []
        )

    @pytest.mark.parametrize("between", [0.5, 3.0, 6.0])
    def test_a_short_piece_is_not_interpolated(self, between):
        """Eight knots, for a stencil and one to spare on either side."""
        both = (5.1, 5.1 + between)
        spoilt = np.flatnonzero(shifts(self.times(), both) == NO_STENCIL)
        assert spoilt.tolist() == list(range(5, int(both[1]) + 1))

    def test_a_longer_piece_is_interpolated(self):
        shift = shifts(self.times(), (5.1, 5.1 + TAPS + 1))
        assert np.flatnonzero(shift == NO_STENCIL).tolist() == [5, 12]
        assert shift.tolist() == [
            0,
            0,
            0,
            -1,
            -2,
            NO_STENCIL,
            2,
            1,
            0,
            0,
            -1,
            -2,
            NO_STENCIL,
            2,
            1,
        ] + 5 * [0]

    def test_without_breakpoints_no_stencil_moves(self):
        assert not shifts(self.times(), ()).any()


@pytest.mark.parametrize("shift", [-2, 0, 1])
def test_precision_and_shape_are_kept(shift):
    knots = np.random.default_rng(4).standard_normal((30, 3)).astype(np.complex64)
    shifted = np.full(30 - BEFORE - AFTER, shift)
    found = stencils(knots, shifted)
    assert found.dtype == np.complex64
    assert found.shape == (TAPS, shifted.size, 3)
    assert found[..., 2] == pytest.approx(stencils(knots[:, 2], shifted), rel=1e-5)
