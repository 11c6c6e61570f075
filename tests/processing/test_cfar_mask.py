"""Cell-averaging CFAR against a loop over every cell, and its false alarms on noise."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from radhar_cli.processing.cfar_mask import CellAveraging, decibels_of, false_alarm_factor

PAIR = st.tuples(st.integers(0, 4), st.integers(0, 4))
CELLS = arrays(
    float,
    st.tuples(st.integers(1, 12), st.integers(1, 12)),
    elements=st.integers(0, 100).map(lambda n: n / 8),
)


def training_cells(cells: np.ndarray, row: int, column: int, window: CellAveraging) -> list[float]:
    """Every training cell of one cell, one after the other."""
    (guard_r, guard_c), (rows, columns) = window.guard, window.training
    found = []
    for r in range(row - guard_r - rows, row + guard_r + rows + 1):
        for c in range(column - guard_c - columns, column + guard_c + columns + 1):
            if abs(r - row) <= guard_r and abs(c - column) <= guard_c:
                continue
            if window.wrap:
                found.append(cells[r % cells.shape[0], c % cells.shape[1]])
            elif 0 <= r < cells.shape[0] and 0 <= c < cells.shape[1]:
                found.append(cells[r, c])
    return found


@given(CELLS, PAIR, PAIR, st.booleans(), st.booleans())
@settings(max_examples=150, deadline=None)
def test_as_a_loop_over_every_cell(cells, guard, training, wrap, decibel):
    """Windows larger than the map, without training cells and with all of them beyond the edges."""
    window = CellAveraging(guard, training, 0.2, decibel=decibel, wrap=wrap)
    found = window.is_set(cells)
    for place, cell in np.ndenumerate(cells):
        around = training_cells(cells, *place, window)
        assert window.training_cells(cells.shape)[place] == len(around)
        if not around:
            assert not found[place]
            continue
        count = len(around)
        level = count * (0.2 ** (-1 / count) - 1) * sum(around) / count
        if abs(cell - level) > 1e-9:  # on the border either is right
            assert found[place] == (cell > level)


@pytest.mark.parametrize("wrap", [False, True])
@pytest.mark.parametrize("pfa", [0.3, 0.03, 1e-3])
def test_false_alarms_of_white_noise(pfa, wrap):
    """Exponentially distributed cells exceed their threshold as often as asked, at edges too."""
    power = np.random.default_rng(1).exponential(size=(600, 500))
    alarms = CellAveraging((2, 1), (4, 3), pfa, wrap=wrap).is_set(power)
    for part in (alarms, alarms[:, :5], alarms[:8]):
        # Neighbours share training cells, so their alarms are not independent: 6 sd and a margin.
        sd = np.sqrt(pfa / part.size)
        assert abs(part.mean() - pfa) < 6 * sd + 0.02 * pfa


def test_the_factor_of_the_public_masks():
    """Guard [10, 2] and training [50, 10] are 2920 cells; P_fa = 0.31 makes them 1.171."""
    window = CellAveraging((10, 2), (50, 10), 0.31, wrap=True)
    count = window.training_cells((256, 256))
    assert (count == 121 * 25 - 21 * 5).all()
    assert false_alarm_factor(0.31, count) == pytest.approx(1.1714, abs=1e-4)


@given(st.floats(1e-6, 0.99), st.integers(1, 10_000))
def test_the_factor_is_that_of_the_formula(pfa, count):
    right = count * (pfa ** (-1 / count) - 1)
    assert false_alarm_factor(pfa, np.array(count)) == pytest.approx(right, rel=1e-6)


def test_power_of_any_scale_gives_the_same_mask():
    power = np.random.default_rng(2).exponential(size=(60, 50))
    window = CellAveraging((1, 1), (5, 4), 0.1)
    right = window.levels(power)
    assert set(np.unique(right)) == {0, 255}
    for scale in (2.0**-120, 2.0**90):
        assert np.array_equal(window.levels(power * scale), right)


def test_a_floor_makes_the_factor_of_decibels_independent_of_the_scale():
    """A higher floor is a higher threshold."""
    cells = decibels_of(np.random.default_rng(3).exponential(size=(60, 50)))

    def share(floor_db, shift=0.0):
        window = CellAveraging((1, 1), (5, 4), 0.3, decibel=True, floor_db=floor_db)
        return np.mean(window.levels(cells + shift) == 255)

    assert share(20, shift=-90) == pytest.approx(share(20), abs=1e-3)
    assert share(10) > share(20) > share(30) > 0


def test_a_strong_cell_does_not_raise_distant_thresholds():
    """Running sums forget a cell 100 dB above the noise once it is out of the window."""
    noise = np.random.default_rng(4).exponential(size=(200, 64))
    strong = noise.copy()
    strong[100, 30] = 1e10
    window = CellAveraging((2, 2), (6, 6), 0.1)
    far = np.abs(np.arange(200) - 100) > 8
    assert np.array_equal(window.is_set(strong)[far], window.is_set(noise)[far])


@pytest.mark.parametrize(("cell", "right"), [(0.0, -300.0), (1e-40, -300.0), (1.0, 0.0)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_decibels_of_zero_power_are_finite(cell, right, dtype):
    assert decibels_of(np.full((2, 2), cell, dtype)) == pytest.approx(np.full((2, 2), right))
